// An octree is drawn and traced apart from where it is changed: who does only one of them links only that.
#include "picture.h"
#include "thimble/tree/octree.h"

namespace thimble::c_face {

extern "C" int32_t thimble_octree_render(const thimble_octree_t* octree, const thimble_camera_t* camera,
                                         const thimble_shading_t* shading, const thimble_band_t* band) {
  return draw_structure(held<Octree>(octree), camera, shading, band);
}

extern "C" int32_t thimble_octree_trace(const thimble_octree_t* octree, const thimble_ray_t* ray,
                                        uint32_t max_visits, thimble_hit_t* hit) {
  return ray == nullptr ? number(Status::kBadArgument)
                        : trace_ray(held<Octree>(octree), ray_of(*ray), max_visits, hit);
}

}  // namespace thimble::c_face
