// What a scene, a tree and a camera tell C of themselves, each by the file of its name. Internal to src/c.
#pragma once

#include "handle.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::c_face {

void tell_tree(const CompactTree& tree, thimble_tree_info_t* to);

/// The core's default with that mode and palette.
void tell_default_shading(ShadeMode mode, Span<const Rgb8> palette, thimble_shading_t* to);

void tell_view(const SceneCamera& from, thimble_view_t* to);

/// camera.cpp. thimble_camera_set; `view` is there, `to` may be null.
int32_t set_camera(const thimble_view_t& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to);
/// The same with a view of the core.
int32_t set_camera(const SceneCamera& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to);

}  // namespace thimble::c_face
