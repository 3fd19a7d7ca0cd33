#include "picture.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::c_face {

extern "C" int32_t thimble_scene_trace(const thimble_scene_t* scene, const thimble_ray_t* ray,
                                       uint32_t max_visits, thimble_hit_t* hit) {
  const BakedScene* const from = held<BakedScene>(scene);
  return from == nullptr || ray == nullptr ? number(Status::kBadArgument)
                                           : trace_ray(&from->tree(), ray_of(*ray), max_visits, hit);
}

extern "C" int32_t thimble_tree_trace(const thimble_tree_t* tree, const thimble_ray_t* ray,
                                      uint32_t max_visits, thimble_hit_t* hit) {
  return ray == nullptr ? number(Status::kBadArgument)
                        : trace_ray(held<CompactTree>(tree), ray_of(*ray), max_visits, hit);
}

extern "C" int32_t thimble_scene_pick(const thimble_scene_t* scene, const thimble_camera_t* camera,
                                      int32_t px, int32_t py, thimble_hit_t* hit) {
  const BakedScene* const from = held<BakedScene>(scene);
  return pick(from == nullptr ? nullptr : &from->tree(), camera, px, py, hit);
}

extern "C" int32_t thimble_tree_pick(const thimble_tree_t* tree, const thimble_camera_t* camera, int32_t px,
                                     int32_t py, thimble_hit_t* hit) {
  return pick(held<CompactTree>(tree), camera, px, py, hit);
}

}  // namespace thimble::c_face
