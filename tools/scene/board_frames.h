/// Frames a second of a scene on each board, before anybody has one.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "boards/board_table.h"
#include "counted/counted.h"
#include "scene/scene_source.h"

namespace thimble::tools {

class BoardFrames {
 public:
  explicit BoardFrames(const SceneSource& source) : source_(source) {}

  /// Instructions of a frame of the scene without light by the brick map, as `bench` counts them (the median of eight views),
  /// within a fifth (tests/budgets/scene_frames.csv); 0 where scene and map do not fit beside the program, or the world has no
  /// map. Bakes for each size of display once.
  std::uint64_t instructions(const platform::BoardFacts& board);

 private:
  struct Counted {
    std::uint64_t bytes = 0;  ///< baked, with a map; 0: it has none
    counted::FrameWork scene;
    counted::FrameWork demo;
  };
  const Counted& counted(const platform::BoardFacts& board);

  const SceneSource& source_;
  std::map<std::tuple<std::int32_t, std::int32_t, bool>, Counted> counted_;  ///< by width, height, ink
};

}  // namespace thimble::tools
