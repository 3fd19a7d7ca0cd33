#include "output/hit_csv.h"

#include "output/units.h"

namespace thimble::tools {

void append_hit(std::string* text, const Ray& ray, const Hit& hit) {
  if (hit.kind == HitKind::kHit) {
    *text += "1,";
    for (int axis = 0; axis < 3; ++axis) {
      *text += std::to_string(hit.voxel[axis]) + ',';
    }
    *text += digits17(hit_t(hit)) + ',' + std::to_string(hit.axis) + ',';
  } else {
    *text += "0,,,,,,";
  }
  *text += std::to_string(hit.visits);
  for (int axis = 0; axis < 3; ++axis) {
    *text += ',' + std::to_string(ray.origin[axis].raw);
  }
  for (int axis = 0; axis < 3; ++axis) {
    *text += ',' + std::to_string(ray.direction[axis]);
  }
  *text += '\n';
}

}  // namespace thimble::tools
