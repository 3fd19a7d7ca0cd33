// Rays, hits, shading and bands between C and the core. Internal to src/c.
#pragma once

#include "handle.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"

namespace thimble::c_face {

inline Ray ray_of(const thimble_ray_t& from) {
  return {point_of(from.origin_q8), vector_of(from.direction)};
}

/// picture.cpp. A hit as C sees it.
void tell_hit(const Ray& ray, const Hit& hit, thimble_hit_t* to);

constexpr bool is_format(int32_t format) {
  return format >= 0 && format < kPixelFormats && has_format(static_cast<PixelFormat>(format));
}

/// False for null, an unknown mode, or a palette that is not there.
bool take_shading(const thimble_shading_t* from, Shading* to);
/// False for null, an unknown format, or pixels that are not there.
bool take_band(const thimble_band_t* from, Band* to);

/// What all functions that draw a band do with their arguments; `draw(camera, shading, band)`.
template <class Draw>
int32_t draw_band(const thimble_camera_t* camera, const thimble_shading_t* shading,
                  const thimble_band_t* band, Draw&& draw) {
  const Camera* const view = held<Camera>(camera);
  Shading look;
  Band rows;
  if (view == nullptr || !take_shading(shading, &look) || !take_band(band, &rows)) {
    return number(Status::kBadArgument);
  }
  return number(draw(*view, look, rows));
}

/// The same where a structure, which may be null, is all that is drawn.
template <class Structure>
int32_t draw_structure(const Structure* structure, const thimble_camera_t* camera,
                       const thimble_shading_t* shading, const thimble_band_t* band) {
  return structure == nullptr ? number(Status::kBadArgument)
                              : draw_band(camera, shading, band,
                                          [=](const Camera& view, const Shading& look, const Band& rows) {
                                            return render_band(*structure, view, look, rows);
                                          });
}

/// The same for functions that trace a ray.
template <class Structure>
int32_t trace_ray(const Structure* structure, const Ray& ray, uint32_t max_visits, thimble_hit_t* to) {
  if (structure == nullptr || to == nullptr) {
    return number(Status::kBadArgument);
  }
  Hit hit;
  const Status status = closest_hit(*structure, ray, &hit, {max_visits, Width::kAuto});
  if (status == Status::kOk) {
    tell_hit(ray, hit, to);
  }
  return number(status);
}

/// The same for the ray through a pixel of the camera's picture, which may be null.
template <class Structure>
int32_t pick(const Structure* structure, const thimble_camera_t* camera, int32_t px, int32_t py,
             thimble_hit_t* to) {
  const Camera* const view = held<Camera>(camera);
  if (structure == nullptr || to == nullptr || view == nullptr || view->level() != structure->level()) {
    return number(Status::kBadArgument);
  }
  if (px < 0 || py < 0 || px >= view->width_px() || py >= view->height_px()) {
    return number(Status::kOutOfRange);
  }
  return trace_ray(structure, view->ray(px, py), UINT32_MAX, to);
}

}  // namespace thimble::c_face
