/// --camera-path: the cameras of a film, a line each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/framing.h"

namespace thimble::tools {

struct PathCamera {
  ViewWishes view;
  std::uint64_t line = 0;   ///< of the file, from 1
  bool is_between = false;  ///< on the way from there to the next
};

struct CameraPath {
  std::vector<PathCamera> cameras;  ///< one or more
  bool has_fov = false;             ///< whether the file says each camera's angle
};

/// The columns, for help and errors.
extern const char* const kPathColumns;

/// Reads all cameras; what the file does not say is that of `view`. Throws OutputError, which names the line, for
/// what is no number, not finite, out of range, too little, too much or too many (kMostFilmFrames), and for a file
/// that cannot be read.
CameraPath read_camera_path(const std::string& path, const ViewWishes& view);

/// So many frames from each camera of `keys` to the next: eye, target, up and angle go along Catmull-Rom splines, which
/// pass through the keys at a speed that does not jump (E. Catmull, R. Rom, "A class of local interpolating splines",
/// 1974), and a frame at the last one. Throws OutputError for more than kMostFilmFrames.
CameraPath smoothed(const std::string& path, const CameraPath& keys, int frames);

/// A camera each, in the world of `shape`. Throws OutputError, which names the line of a camera that cannot be set.
std::vector<Framing> frame_path(const std::string& path, const CameraPath& cameras, const SceneShape& shape);

}  // namespace thimble::tools
