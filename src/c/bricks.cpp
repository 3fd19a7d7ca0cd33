#include "picture.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/render.h"

namespace thimble::c_face {

extern "C" int32_t thimble_scene_bricks(const thimble_scene_t* scene, thimble_bricks_t* bricks) {
  const BakedScene* const from = held<BakedScene>(scene);
  if (from == nullptr || !stands(bricks)) {
    return number(Status::kBadArgument);
  }
  const ConstBytes section = from->section(SectionKind::kBrickMap);
  BrickMap map;
  return hold(section.empty() ? Status::kDamaged : BrickMap::open(section, &map), map, bricks);
}

namespace {

int32_t render_fast(const CompactTree* tree, const thimble_bricks_t* bricks, const thimble_camera_t* camera,
                    const thimble_shading_t* shading, const thimble_band_t* band) {
  const BrickMap* const map = held<BrickMap>(bricks);
  if (tree == nullptr || map == nullptr) {
    return number(Status::kBadArgument);
  }
  return draw_band(camera, shading, band,
                   [tree, map](const Camera& view, const Shading& look, const Band& rows) {
                     return render_band(*tree, *map, view, look, rows);
                   });
}

}  // namespace

extern "C" int32_t thimble_scene_render_fast(const thimble_scene_t* scene, const thimble_bricks_t* bricks,
                                             const thimble_camera_t* camera, const thimble_shading_t* shading,
                                             const thimble_band_t* band) {
  const BakedScene* const from = held<BakedScene>(scene);
  return render_fast(from == nullptr ? nullptr : &from->tree(), bricks, camera, shading, band);
}

extern "C" int32_t thimble_tree_render_fast(const thimble_tree_t* tree, const thimble_bricks_t* bricks,
                                            const thimble_camera_t* camera, const thimble_shading_t* shading,
                                            const thimble_band_t* band) {
  return render_fast(held<CompactTree>(tree), bricks, camera, shading, band);
}

}  // namespace thimble::c_face
