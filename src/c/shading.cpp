#include "parts.h"
#include "picture.h"

namespace thimble::c_face {
namespace {

bool is_corner(const thimble_vec3_t& corner) {
  constexpr int32_t kSide = int32_t{1} << kMaxLevel;
  return corner.x >= 0 && corner.y >= 0 && corner.z >= 0 && corner.x <= kSide && corner.y <= kSide &&
         corner.z <= kSide;
}

constexpr int32_t kMaxTowardLight = int32_t{1} << 14;
bool is_short(int32_t component) {
  return component >= -kMaxTowardLight && component <= kMaxTowardLight;
}

}  // namespace

void tell_default_shading(ShadeMode mode, Span<const Rgb8> palette, thimble_shading_t* to) {
  const Shading from;
  to->palette_rgb = reinterpret_cast<const uint8_t*>(palette.data);
  to->palette_colors = static_cast<uint32_t>(palette.size);
  to->mode = static_cast<int32_t>(mode);
  to->near_q8 = from.near_q8;
  to->far_q8 = from.far_q8;
  for (int face = 0; face < 6; ++face) {
    to->face_light[face] = from.face_light[face];
  }
  __builtin_memcpy(to->default_rgb, &from.default_color, sizeof to->default_rgb);
  __builtin_memcpy(to->background_rgb, &from.background, sizeof to->background_rgb);
}

extern "C" void thimble_shading_default(thimble_shading_t* shading) {
  if (shading != nullptr) {
    tell_default_shading(ShadeMode::kDepth, {}, shading);
  }
}

extern "C" int32_t thimble_shading_planes(thimble_shading_t* shading, const thimble_camera_t* camera,
                                          const thimble_box_t* box) {
  const Camera* const from = held<Camera>(camera);
  if (shading == nullptr || from == nullptr || box == nullptr) {
    return number(Status::kBadArgument);
  }
  if (!is_corner(box->low) || !is_corner(box->high)) {
    return number(Status::kOutOfRange);
  }
  const DepthRange range = depth_range(*from, {vector_of(box->low), vector_of(box->high)});
  shading->near_q8 = range.near_q8;
  shading->far_q8 = range.far_q8;
  return number(Status::kOk);
}

extern "C" int32_t thimble_shading_light(thimble_shading_t* shading, int32_t x, int32_t y, int32_t z) {
  if (shading == nullptr || (x == 0 && y == 0 && z == 0)) {
    return number(Status::kBadArgument);
  }
  if (!is_short(x) || !is_short(y) || !is_short(z)) {
    return number(Status::kOutOfRange);
  }
  light_from({x, y, z}, shading->face_light);
  return number(Status::kOk);
}

}  // namespace thimble::c_face
