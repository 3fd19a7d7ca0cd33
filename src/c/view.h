// Views between C and the core. Internal to src/c.
#pragma once

#include "kinds.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::c_face {

void tell_view(const SceneCamera& from, thimble_view_t* to);

/// camera.cpp. thimble_camera_set; `view` is there, `to` may be null.
int32_t set_camera(const thimble_view_t& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to);
/// The same with a view of the core.
int32_t set_camera(const SceneCamera& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to);

}  // namespace thimble::c_face
