/// A small picture of a file that nobody vouches for: drawn by a process of its own, whose memory and time are limited, so
/// that whatever the file does ends nothing but that process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "output/image.h"

namespace thimble::tools {

struct PictureLimits {
  int seconds = 1;                 ///< of processor time; the process waits 19 s more at most
  std::uint64_t memory_bytes = 0;  ///< all of the process: program, file, voxels and picture
  bool coarse = false;             ///< a mesh has no more voxels a side than the picture has pixels
  std::size_t scene_bytes = 0;     ///< of the scene for a page, which is merged to keep that; 0 for none
};

/// A square picture in the scene's own look, or why there is none.
struct SmallPicture {
  std::string error;  ///< a sentence without its subject; empty where there is a picture
  std::uint64_t voxels = 0;
  Image image;
  std::vector<std::uint8_t> scene;  ///< for a page; empty where it cannot be had
};

class LimitedPicture {
 public:
  /// Starts the process, which has one thread and ends with the calling one. Throws OutputError where the system starts none.
  LimitedPicture(const std::string& path, std::int32_t side_px, const PictureLimits& limits);
  /// Ends the process if it still runs.
  ~LimitedPicture();
  LimitedPicture(const LimitedPicture&) = delete;
  LimitedPicture& operator=(const LimitedPicture&) = delete;

  /// Whether the process has ended; `waits`: once it has. True only once, with the picture.
  bool take(SmallPicture* picture, bool waits = false);

 private:
  struct Shared;

  std::int32_t side_px_;
  PictureLimits limits_;
  std::size_t picture_bytes_;
  std::size_t bytes_;
  Shared* shared_;  ///< what both processes see: facts, behind them pixels, then the scene
  int process_ = -1;
};

}  // namespace thimble::tools
