// Shares and mixtures of colours. Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_ARITHMETIC_H
#define THIMBLE_SRC_LIGHT_ARITHMETIC_H

#include <stdint.h>

#include "../base/integers.h"
#include "../base/wide_arithmetic.h"
#include "thimble/light/detail/pixel.h"
#include "thimble/light/host/optics.h"

namespace thimble::lit {

/// |component| / |direction|, 2^14 = 1.
inline uint32_t cosine_q14(const Vec3i& direction, int axis) {
  const uint32_t cosine = magnitude_32(unit_q14(direction)[axis]);
  return cosine < kUnitQ14 ? cosine : kUnitQ14;
}

constexpr Color color_of(const Rgb8& color) {
  return {{color.r * kLevel, color.g * kLevel, color.b * kLevel}};
}
constexpr uint8_t channel_of(const Rgb8& color, int channel) {
  return channel == 0 ? color.r : channel == 1 ? color.g : color.b;
}
/// From `from` to `to`, `part` of 2^12.
constexpr Color mixed(const Color& from, const Color& to, uint32_t part) {
  Color color;
  for (int i = 0; i < 3; ++i) {
    color.c[i] = (from.c[i] * (4096 - part) + to.c[i] * part) >> 12;
  }
  return color;
}

/// weight * share, 2^16 = 1.
constexpr uint16_t weighed(uint32_t weight, uint32_t share_q16) {
  return static_cast<uint16_t>((weight * share_q16) >> 16);  // 2^15 * 2^16
}
/// Whether a ray of that weight can still be seen.
constexpr bool is_seen(const Weight& weight) {
  return weight.c[0] >= kLeastWeight || weight.c[1] >= kLeastWeight || weight.c[2] >= kLeastWeight;
}

/// The length of the ray from `from` to the meeting, in 1/256 voxel.
inline uint32_t stretch_q8(const Ray& ray, const Leg& leg, const Meeting& meeting) {
  const int32_t end = distance_q8(ray.direction, meeting.hit.t_numerator, meeting.hit.t_denominator);
  const int32_t begin = leg.from.t_numerator == 0
                            ? 0
                            : distance_q8(ray.direction, leg.from.t_numerator, leg.from.t_denominator);
  return end > begin ? static_cast<uint32_t>(end - begin) : 0;
}

/// Halvings (2^16 = 1) on a way: density a voxel in 2^-16, at most 2^24, times a length in 1/256 voxel;
/// clamped to where nothing is left.
inline constexpr uint32_t kNothingLeft = 20U << 16;
constexpr uint32_t halvings_q16(uint32_t density_q16, uint32_t length) {
  const uint64_t halvings = wide_product_u(density_q16, length) >> 8;
  return halvings < kNothingLeft ? static_cast<uint32_t>(halvings) : kNothingLeft;
}

/// What is left of a channel after a length in a clear solid, a cloud or water, 2^16 = 1.
inline uint32_t left_q16(const Surface& surface, int channel, uint32_t length) {
  uint32_t density = uint32_t{surface.density_q8} << 8;
  if (surface.kind != SurfaceKind::kMedia) {
    density = uint32_t{surface.density_q8} * (255U - channel_of(surface.albedo, channel)) * 257 >> 8;
  }
  return transmittance_q16(halvings_q16(density, length));
}
/// brightness (up to 2^20) * share (2^16 = 1).
constexpr uint32_t weighed_32(uint32_t brightness, uint32_t share_q16) {
  return static_cast<uint32_t>(wide_product_u(brightness, share_q16) >> 16);
}

/// Whether one place on a ray comes before another: products below 2^24 * 2^28.
constexpr bool is_before(const RayPoint& one, const RayPoint& other) {
  return is_product_less(one.t_numerator, other.t_denominator, other.t_numerator, one.t_denominator);
}

/// Whether rays go through a material, with the effects that are on.
inline bool is_clear(const Frame& frame, uint8_t material) {
  const SurfaceKind kind = surface_of(frame, material).kind;
  return (kind == SurfaceKind::kGlass && (frame.effects & Effect::kGlass) != 0) ||
         (kind == SurfaceKind::kMedia && (frame.effects & Effect::kMedia) != 0);
}

}  // namespace thimble::lit

#endif
