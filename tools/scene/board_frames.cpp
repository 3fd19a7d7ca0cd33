#include "scene/board_frames.h"

#include <algorithm>
#include <cstring>

#include "boards/frame_costs.h"
#include "scene/baking.h"
#include "scene/board_fit.h"
#include "scene/framing.h"

namespace thimble::tools {
namespace {

// As `bake --board --effects none` does, with a map whatever its size.
std::uint64_t count(const platform::BoardFacts& board, const SceneSource& source, counted::FrameWork* work) {
  ViewWishes view;
  view.width_px = board.width_px;
  view.height_px = board.height_px;
  view.side = NamedView::kBest;
  view.fov_degrees = kPictureFov;
  BakingOptions options;
  options.brick_map = true;
  options.effects = {false};
  options.camera = [&](const CompactTree& tree) {
    return frame_round(view, source, shape_of(source, tree)).kept;
  };
  const BakedScene* const given = source.baked();
  const Baked made = given != nullptr ? Baked() : bake_scene(source, options);
  const ConstBytes bytes = (given != nullptr ? *given : made.scene).bytes();
  const bool is_ink = bits_per_pixel(board.format) == 1;
  return counted::count_frames(bytes.data, bytes.size, board.width_px, board.height_px, is_ink, work)
             ? bytes.size
             : 0;
}

}  // namespace

const BoardFrames::Counted& BoardFrames::counted(const platform::BoardFacts& board) {
  const auto [at, is_new] =
      counted_.try_emplace({board.width_px, board.height_px, bits_per_pixel(board.format) == 1});
  Counted& counted = at->second;
  if (is_new) {
    counted.bytes = count(board, source_, &counted.scene);
    SceneArguments arguments;
    arguments.scene = "demo";
    count(board, *open_scene(arguments), &counted.demo);
  }
  return counted;
}

std::uint64_t BoardFrames::instructions(const platform::BoardFacts& board) {
  const auto cost = std::find_if(std::begin(kFrameCosts), std::end(kFrameCosts),
                                 [&](const FrameCost& one) { return std::strcmp(one.cpu, board.cpu) == 0; });
  if (source_.level() > board.most_map_level || cost == std::end(kFrameCosts)) {
    return 0;
  }
  const Counted& work = counted(board);
  if (work.bytes == 0 || work.bytes > scene_flash_bytes(board)) {
    return 0;
  }
  const auto all = [&](const counted::FrameWork& one) {
    return static_cast<std::int64_t>(one.blocks * cost->block_hundredths / 100 + one.hits * cost->hit);
  };
  const std::int64_t frame = std::int64_t{board.frame_instructions} + all(work.scene) - all(work.demo);
  return static_cast<std::uint64_t>(std::max<std::int64_t>(frame, 1));
}

}  // namespace thimble::tools
