/// What is under the pointer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "readers/real3.h"
#include "viewer/finished_picture.h"
#include "viewer/open_scene.h"

namespace thimble::tools::viewer {

struct Picked {
  Hit hit;
  Real3 point;  ///< where the ray meets it, in voxels
};

/// What the ray of a pixel hits; nothing for none, and for pixels beyond the picture.
std::optional<Picked> pick(const OpenScene& scene, const Camera& camera, std::int32_t x_px,
                           std::int32_t y_px);

/// "voxel 12,3,40: its top face (+z), material 7, #a0522d glass".
std::string picked_text(const OpenScene& scene, const Camera& camera, const Picked& picked, std::int32_t x_px,
                        std::int32_t y_px);

}  // namespace thimble::tools::viewer
