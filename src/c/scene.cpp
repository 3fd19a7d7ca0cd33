#include "thimble/bake/baked_scene.h"

#include "parts.h"

namespace thimble::c_face {

static_assert(THIMBLE_BAKED_VERSION == kBakedVersion);

extern "C" int32_t thimble_scene_open(thimble_scene_t* scene, const void* bytes, size_t size_bytes) {
  return bytes == nullptr ? number(Status::kBadArgument)
                          : make_held<BakedScene, const uint8_t>(scene, bytes, size_bytes, BakedScene::open);
}

extern "C" const char* thimble_scene_validate(const void* bytes, size_t size_bytes, uint32_t* place) {
  ConstBytes from;
  if (!take_bytes(bytes, size_bytes, &from)) {
    from = {};
  }
  return BakedScene::validate(from, place);
}

extern "C" int32_t thimble_scene_get_info(const thimble_scene_t* scene, thimble_scene_info_t* info) {
  return tell<BakedScene>(scene, info, [=](const BakedScene& from) {
    const ConstBytes name = from.section(SectionKind::kName);
    tell_tree(from.tree(), &info->tree);
    info->palette_rgb = reinterpret_cast<const uint8_t*>(from.palette().data);
    info->palette_colors = static_cast<uint32_t>(from.palette().size);
    info->crc32 = from.crc32();
    info->name = name.empty() ? nullptr : reinterpret_cast<const char*>(name.data);
    info->name_bytes = static_cast<uint32_t>(name.size);
    info->has_view = from.has_camera() ? 1 : 0;
    info->has_light = from.section(SectionKind::kLighting).empty() ? 0 : 1;
    info->has_bricks = from.section(SectionKind::kBrickMap).empty() ? 0 : 1;
  });
}

extern "C" int32_t thimble_scene_tree(const thimble_scene_t* scene, thimble_tree_t* tree) {
  const BakedScene* const from = held<BakedScene>(scene);
  return from == nullptr || !stands(tree) ? number(Status::kBadArgument)
                                          : hold(Status::kOk, from->tree(), tree);
}

extern "C" int32_t thimble_scene_view(const thimble_scene_t* scene, thimble_view_t* view) {
  const BakedScene* const from = held<BakedScene>(scene);
  if (from == nullptr || view == nullptr || !from->has_camera()) {
    return number(Status::kBadArgument);
  }
  tell_view(from->camera(), view);
  return number(Status::kOk);
}

extern "C" int32_t thimble_scene_camera(const thimble_scene_t* scene, const thimble_view_t* view,
                                        int32_t width_px, int32_t height_px, thimble_camera_t* camera) {
  const BakedScene* const from = held<BakedScene>(scene);
  if (from == nullptr || (view == nullptr && !from->has_camera())) {
    return number(Status::kBadArgument);
  }
  const int level = from->tree().level();
  return view == nullptr ? set_camera(from->camera(), width_px, height_px, level, camera)
                         : set_camera(*view, width_px, height_px, level, camera);
}

extern "C" int32_t thimble_scene_shading(const thimble_scene_t* scene, thimble_shading_t* shading) {
  return tell<BakedScene>(scene, shading, [=](const BakedScene& from) {
    tell_default_shading(ShadeMode::kColor, from.palette(), shading);
  });
}

}  // namespace thimble::c_face
