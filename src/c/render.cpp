#include "picture.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::c_face {

extern "C" int32_t thimble_scene_render(const thimble_scene_t* scene, const thimble_camera_t* camera,
                                        const thimble_shading_t* shading, const thimble_band_t* band) {
  const BakedScene* const from = held<BakedScene>(scene);
  return draw_structure(from == nullptr ? nullptr : &from->tree(), camera, shading, band);
}

extern "C" int32_t thimble_tree_render(const thimble_tree_t* tree, const thimble_camera_t* camera,
                                       const thimble_shading_t* shading, const thimble_band_t* band) {
  return draw_structure(held<CompactTree>(tree), camera, shading, band);
}

}  // namespace thimble::c_face
