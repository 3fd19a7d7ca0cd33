#include "wide/raster/gray_scale.h"

#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"

namespace thimble::wide {

static_assert(kMostFall == 255 - kFarBrightness);

GrayScale gray_scale_of(const Camera& camera, const Shading& shading) {
  GrayScale made{};
  const int32_t depth_per_t_q8 = camera.depth_per_t_q8();
  while (depth_per_t_q8 > 0 && (static_cast<uint32_t>(depth_per_t_q8) << made.shift & 0x80000000U) == 0) {
    ++made.shift;
  }
  const uint32_t dividend = static_cast<uint32_t>(depth_per_t_q8) << made.shift;
  made.dividend = static_cast<double>(dividend);
  made.scale = 1.0 / static_cast<double>(uint64_t{1} << (made.shift + 8));
  const uint32_t range = shading.far_q8 > shading.near_q8
                             ? static_cast<uint32_t>(shading.far_q8) - static_cast<uint32_t>(shading.near_q8)
                             : 1;
  const int excess = range >= (1U << 24) ? 8 : 0;
  made.near_q8 = static_cast<double>(shading.near_q8);
  made.far_q8 = static_cast<double>(shading.far_q8);
  made.cut = excess == 0 ? 1.0 : 1.0 / 256;
  made.inverse = 1.0 / static_cast<double>(range >> excess);
  const double per_depth = static_cast<double>(kMostFall) / range;
  made.float_dividend = static_cast<float>(made.dividend);
  made.float_scale = static_cast<float>(made.scale);
  made.float_near = static_cast<float>(made.near_q8);
  made.float_per_depth = static_cast<float>(per_depth);
  made.int_dividend = static_cast<int32_t>(dividend);
  const double greatest = made.near_q8 + 1.01 * range;
  made.margin = static_cast<float>(per_depth * (1.01 + greatest / (1 << 19)) + 1.0 / (1 << 12));
  made.floats_tell = depth_per_t_q8 > 0 && depth_per_t_q8 < 1 << 24 && excess == 0 && shading.near_q8 >= 0 &&
                     shading.far_q8 > shading.near_q8 && made.margin < 0.05F;
  for (int axis = 0; axis < 3 && !camera.is_perspective(); ++axis) {
    const int32_t step = camera.direction()[axis];
    const uint32_t speed = static_cast<uint32_t>(step < 0 ? -step : step);
    const uint32_t ratio = speed == 0 ? 0 : dividend / speed;
    made.axis_ratio[axis] = static_cast<float>(ratio);
  }
  return made;
}

uint8_t code_of(GrayScale::Code code, const Hit& hit, const Ray& ray, const Camera& camera,
                const Shading& shading) {
  if (code == GrayScale::Code::kFace) {
    const Face face = face_of(hit, ray.direction);
    return static_cast<uint8_t>(1 + 2 * face.axis + (face.negative ? 0 : 1));
  }
  return shade(hit, ray, camera, shading).r;
}

uint8_t code_exactly(const Camera& camera, const Shading& shading, GrayScale::Code code, int32_t x, int32_t y,
                     uint32_t entry, const uint32_t (&cube)[3]) {
  const Ray ray = camera.ray(x, y);
  // The ray enters through the latest of the nearer planes, on a tie that of the lowest axis; it does not enter through
  // a plane at or behind the origin.
  int64_t numerator = 0;
  int64_t speed = 1;
  Hit hit;
  hit.axis = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t direction = ray.direction[axis];
    const int64_t low = int64_t{256} * (cube[axis] + (entry >> (10 * axis) & 1023U)) - ray.origin[axis].raw;
    const int64_t distance = direction < 0 ? -(low + 256) : low;
    const int64_t step = direction < 0 ? -direction : direction;
    if (step != 0 && distance > 0 && distance * speed > numerator * step) {
      numerator = distance;
      speed = step;
      hit.axis = static_cast<int8_t>(axis);
    }
  }
  hit.kind = HitKind::kHit;
  hit.t_numerator = static_cast<int32_t>(numerator);
  hit.t_denominator = numerator == 0 ? 1 : static_cast<int32_t>(256 * speed);
  return code_of(code, hit, ray, camera, shading);
}

}  // namespace thimble::wide
