// Shares and mixtures of colours; how bright lights are, what metals mirror, what occlusion takes. Internal to src/.
#pragma once

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

/// Sends a ray that comes out of another, where it can be seen.
inline void send(Frame& frame, const PendingRay& from, LitRayKind kind, int axis, const Ray& ray,
                 const Weight& weight, PendingRay* pending, size_t* count) {
  if (is_seen(weight)) {
    count_ray(frame, kind);
    pending[(*count)++] = {ray, weight, static_cast<uint8_t>(from.bounces + 1), kind,
                           static_cast<int8_t>(axis)};
  }
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

// --- Lights

/// Bits of a direction to a light: what the 32-bit tracer takes in worlds of up to 64, seen from within.
inline constexpr int kLightBits = 15;

/// The ray from a point to a light; false where there is none.
[[gnu::always_inline]] inline bool aim_at(const Light& light, const Vec3Q8& from, LightRay* ray) {
  ray->is_point = light.is_point;
  if (light.is_point) {
    const Vec3Q8 place{Q8::from_raw(light.place.x), Q8::from_raw(light.place.y), Q8::from_raw(light.place.z)};
    return ray_towards(from, place, kLightBits, &ray->ray, &ray->place);
  }
  ray->ray = {from, shorten(light.place)};
  return true;
}

/// Brightness of a point light at a distance: 1 / (1 + d / reach)^2, 2^16 = 1.
constexpr uint32_t falloff_q16(uint32_t distance, uint32_t reach) {
  if (reach == 0) {
    return 0;
  }
  const uint32_t ratio_q8 = 256 + distance / reach;
  return ratio_q8 > UINT16_MAX ? 0 : UINT32_MAX / (ratio_q8 * ratio_q8);
}

/// Sets the brightness of a ray that brings a share of its light (2^16 = 1); returns whether there is any.
[[gnu::always_inline]] inline bool set_brightness(const Light& light, uint32_t share_q16, LightRay* ray) {
  bool shines = false;
  for (int i = 0; i < 3; ++i) {
    ray->brightness[i] = (light.color_q8[i] * share_q16 + 2048) >> 12;  // 16 bits by 16
    shines = shines || ray->brightness[i] != 0;
  }
  return shines;
}

// --- Mirrors

/// Whether it mirrors any light.
constexpr bool is_mirror(const Surface& metal) {
  return metal.kind == SurfaceKind::kMetal && metal.mirror != 0;
}

/// Divides a ray's weight into what the metal mirrors and what it shows of itself. `cosine`: of the ray, Q14.
[[gnu::always_inline]] inline void divide_weight(const Surface& metal, int32_t cosine, Weight* own,
                                                 Weight* mirrored) {
  const uint32_t share = metal.mirror * 257U;  // 65535 = all
  for (int i = 0; i < 3; ++i) {
    const uint32_t reflected = fresnel_q16(cosine, channel_of(metal.albedo, i) * 257U);
    mirrored->c[i] = weighed(weighed(own->c[i], reflected), share + share / 65535);
    own->c[i] = weighed(own->c[i], 65535 - share);
  }
}

/// Whether a metal spreads what a ray of the camera sees in it over kRoughnessRays; each then has its part of the weight.
[[gnu::always_inline]] inline bool is_spread(const Surface& metal, const PendingRay& now, Weight* mirrored) {
  const bool rough = metal.roughness != 0 && now.bounces == 0;
  for (uint16_t& channel : mirrored->c) {
    channel = rough ? static_cast<uint16_t>(channel / kRoughnessRays) : channel;
  }
  return rough;
}

/// The direction of ray `number` of a rough metal, of what a smooth one would mirror at a face of `axis`.
[[gnu::always_inline]] inline Vec3i spread(const Vec3i& mirrored, const Surface& metal, int axis,
                                           bool towards_smaller, int number) {
  Vec3i direction = shorten(roughen(unit_q14(mirrored), metal.roughness, number));
  if (!leaves_face(direction, axis, towards_smaller)) {
    direction = reflect(direction, axis);  // back from the face
  }
  return direction;
}

// --- Occlusion

/// How much light comes by a ray that meets nothing.
inline constexpr uint32_t kOpenShare = 1U << 12;

/// How many rays a point sends.
constexpr int occlusion_rays(const Occlusion& occlusion) {
  return occlusion.rays < kOcclusionDirections ? occlusion.rays : kOcclusionDirections;
}

/// How open the way of one is that meets something at `way` (1/256 voxel) along an axis of which its direction has
/// `component`.
/// All directions of the pattern have one length, 7 bits; the way has 23.
[[gnu::always_inline]] inline uint32_t share_of_way(const Occlusion& occlusion, uint32_t way,
                                                    uint32_t component) {
  const uint32_t distance_q8 = way * kOcclusionLength / component;
  const uint32_t reach_q8 = uint32_t{occlusion.reach} << 8;
  return distance_q8 < reach_q8 ? (distance_q8 << 4) / occlusion.reach : kOpenShare;  // 24 bits by 4
}

/// Lets a face have as much light as its rays, of which `open` is the sum.
[[gnu::always_inline]] inline void darken(const Occlusion& occlusion, uint32_t open, int rays, Color* light) {
  const uint32_t closed = kOpenShare - open / static_cast<uint32_t>(rays);
  const uint32_t factor = kOpenShare - closed * occlusion.strength / 255;
  for (uint32_t& channel : light->c) {
    channel = ((channel < UINT16_MAX ? channel : UINT16_MAX) * factor) >> 12;
  }
}

}  // namespace thimble::lit
