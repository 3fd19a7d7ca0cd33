/// What a command line says of a scene, before anything is opened.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "readers/file_bytes.h"

namespace thimble::tools {

/// What is opened.
struct SceneArguments {
  std::string scene;                     ///< a file's path or a generator
  std::optional<SharedBytes> content{};  ///< the file's bytes, decompressed, where they are not to be read
  std::optional<int> depth;              ///< --depth
  bool as_voxels = false;                ///< --as-voxels
  bool z_up = false;                     ///< --z-up
  std::optional<std::uint32_t> frame{};  ///< --frame
  bool as_points = false;                ///< --as-points
  bool as_heights = false;               ///< --as-heights
  std::uint16_t full_color = 0;          ///< --colors
  std::optional<double> fit_percent{};   ///< --fit
  std::optional<std::array<double, 6>> clip{};  ///< --clip: the box's low corner, its high one
  int mesh_depth = 9;                           ///< of a mesh, without --depth
};

/// What is built of it, and traced.
enum class StructureKind : std::uint8_t { kDense, kPool, kCompact };

}  // namespace thimble::tools
