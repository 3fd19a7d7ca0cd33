#include "parts.h"
#include "picture.h"

namespace thimble::c_face {

void tell_view(const SceneCamera& from, thimble_view_t* to) {
  to->projection = from.is_perspective ? THIMBLE_PERSPECTIVE : THIMBLE_ORTHOGRAPHIC;
  to->direction_bits = from.direction_bits;
  to->eye_q8 = to_c(from.eye);
  to->target_q8 = to_c(from.target);
  to->forward = to_c(from.forward);
  to->up = to_c(from.up);
  to->fov_q16 = from.fov_degrees.raw;
  to->span_q14 = from.span.raw;
}

int32_t set_camera(const SceneCamera& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to) {
  if (!stands(to)) {
    return number(Status::kBadArgument);
  }
  Camera camera;
  return hold(thimble::set_camera(view, width_px, height_px, level, &camera), camera, to);
}

int32_t set_camera(const thimble_view_t& view, int32_t width_px, int32_t height_px, int32_t level,
                   thimble_camera_t* to) {
  if (!stands(to) || (view.projection != THIMBLE_PERSPECTIVE && view.projection != THIMBLE_ORTHOGRAPHIC)) {
    return number(Status::kBadArgument);
  }
  if (view.direction_bits < 0 || view.direction_bits > kMaxDirectionBits) {
    return number(Status::kOutOfRange);
  }
  SceneCamera from;
  from.is_perspective = view.projection == THIMBLE_PERSPECTIVE;
  from.direction_bits = static_cast<uint8_t>(view.direction_bits);
  from.eye = point_of(view.eye_q8);
  from.target = point_of(view.target_q8);
  from.forward = vector_of(view.forward);
  from.up = vector_of(view.up);
  from.fov_degrees = Q16::from_raw(view.fov_q16);
  from.span = Q14::from_raw(view.span_q14);
  return set_camera(from, width_px, height_px, level, to);
}

extern "C" void thimble_view_default(thimble_view_t* view) {
  if (view != nullptr) {
    SceneCamera from;
    from.target.y = Q8::saturate(1);
    from.span = Q14::saturate(1);
    tell_view(from, view);
  }
}

extern "C" int32_t thimble_camera_set(thimble_camera_t* camera, const thimble_view_t* view, int32_t width_px,
                                      int32_t height_px, int32_t level) {
  return view == nullptr ? number(Status::kBadArgument)
                         : set_camera(*view, width_px, height_px, level, camera);
}

extern "C" int32_t thimble_camera_size(const thimble_camera_t* camera, int32_t* width_px,
                                       int32_t* height_px) {
  const Camera* const from = held<Camera>(camera);
  if (from == nullptr || width_px == nullptr || height_px == nullptr) {
    return number(Status::kBadArgument);
  }
  *width_px = from->width_px();
  *height_px = from->height_px();
  return number(Status::kOk);
}

extern "C" int32_t thimble_camera_ray(const thimble_camera_t* camera, int32_t px, int32_t py,
                                      thimble_ray_t* ray) {
  const Camera* const from = held<Camera>(camera);
  if (from == nullptr || ray == nullptr) {
    return number(Status::kBadArgument);
  }
  if (px < 0 || py < 0 || px >= from->width_px() || py >= from->height_px()) {
    return number(Status::kOutOfRange);
  }
  const Ray through = from->ray(px, py);
  *ray = {to_c(through.origin), to_c(through.direction)};
  return number(Status::kOk);
}

}  // namespace thimble::c_face
