#include "thimble/picture/shading.h"

#include "../base/bits.h"
#include "../base/ranges.h"
#include "../base/wide_arithmetic.h"

namespace thimble {
namespace {

// From full brightness to that of the far plane.
constexpr uint32_t kDepthFall = 255 - kFarBrightness;

// The camera's affine function at the middle of the picture, in 32.32.
int64_t at_middle(const Camera& camera, int axis) {
  const Camera::Affine& affine = camera.affine();
  return affine.base[axis] + (wide_multiple(affine.step_x[axis], camera.width_px() - 1) +
                              wide_multiple(affine.step_y[axis], camera.height_px() - 1)) /
                                 2;
}

uint8_t channel(uint8_t albedo, uint32_t light) {
  const uint32_t value = (albedo * light) >> 8;
  return static_cast<uint8_t>(value < 255 ? value : 255);
}

}  // namespace

DepthRange depth_range(const Camera& camera, const VoxelBox& bounds) {
  // Forward and its length in one unit: 1/4096 of the ray's integers for a perspective camera (a component is
  // below 2^32), 1/256 for an orthographic one (below 2^28).
  Vec3<int64_t> forward;
  uint64_t length = static_cast<uint32_t>(camera.depth_per_t_q8());
  if (camera.is_perspective()) {
    length <<= 4;
  }
  for (int axis = 0; axis < 3; ++axis) {
    forward[axis] =
        camera.is_perspective() ? at_middle(camera, axis) >> 20 : wide_product(camera.direction()[axis], 256);
  }
  if (length == 0 || bounds.empty()) {
    return {};
  }
  // Distances are below 2^24 and components below 2^32, so the sum of three products is below 2^58.
  int64_t near_dot = INT64_MAX;
  int64_t far_dot = INT64_MIN;
  for (unsigned corner = 0; corner < 8; ++corner) {
    int64_t dot = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t plane = ((corner >> axis) & 1U) != 0 ? bounds.high[axis] : bounds.low[axis];
      dot += wide_multiple(plane * Q8::kOne - camera.eye()[axis].raw, forward[axis]);
      THIMBLE_NOTE(Range::kDepthDot, Exact(dot));
    }
    near_dot = dot < near_dot ? dot : near_dot;
    far_dot = dot > far_dot ? dot : far_dot;
  }
  DepthRange range;
  range.near_q8 = near_dot <= 0 ? 0 : static_cast<int32_t>(divide(static_cast<uint64_t>(near_dot), length));
  range.far_q8 = far_dot <= 0 ? 0 : static_cast<int32_t>(divide(static_cast<uint64_t>(far_dot), length));
  if (range.far_q8 < range.near_q8 + Q8::kOne) {
    range.far_q8 = range.near_q8 + Q8::kOne;
  }
  return range;
}

void light_from(const Vec3i& toward_light, uint16_t (&face_light)[6]) {
  uint64_t square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    square += static_cast<uint64_t>(wide_product(toward_light[axis], toward_light[axis]));
  }
  // The root is taken of the square times 2^16 to keep 8 more bits of it.
  const int32_t length_q8 = static_cast<int32_t>(square_root_rounded(square << 16));
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t cosine_q8 = length_q8 == 0 ? 0 : toward_light[axis] * (1 << 16) / length_q8;
    face_light[2 * axis] = static_cast<uint16_t>((141 * 256 - 115 * cosine_q8) >> 8);
    face_light[2 * axis + 1] = static_cast<uint16_t>((141 * 256 + 115 * cosine_q8) >> 8);
  }
}

Face face_of(const Hit& hit, const Vec3i& direction) {
  int axis = int{hit.axis};
  if (axis < 0) {
    axis = 0;
    for (int other = 1; other < 3; ++other) {
      const int32_t size = direction[other] < 0 ? -direction[other] : direction[other];
      const int32_t largest = direction[axis] < 0 ? -direction[axis] : direction[axis];
      if (size > largest) {
        axis = other;
      }
    }
  }
  return {axis, direction[axis] > 0};
}

int32_t planar_depth_q8(const Hit& hit, const Camera& camera) {
  // depth = numerator * (depth_per_t / denominator), with the denominator 256 * direction. The dividend is
  // shifted until it fills 32 bits: the direction has at most 20, so the quotient has at least 12.
  const uint32_t direction = static_cast<uint32_t>(hit.t_denominator) >> 8;
  const uint32_t depth_per_t = static_cast<uint32_t>(camera.depth_per_t_q8());
  if (direction == 0 || depth_per_t == 0) {
    return 0;  // starts inside: t = 0
  }
  const int shift = 32 - bits::bit_length(depth_per_t);
  const uint32_t ratio = (depth_per_t << shift) / direction;
  THIMBLE_NOTE(Range::kDepth, Exact(hit.t_numerator) * Exact(ratio));
  const uint64_t depth = wide_product_u(static_cast<uint32_t>(hit.t_numerator), ratio) >> (shift + 8);
  return depth < INT32_MAX ? static_cast<int32_t>(depth) : INT32_MAX;
}

Rgb8 shade(const Hit& hit, const Ray& ray, const Camera& camera, const Shading& shading) {
  if (hit.kind != HitKind::kHit) {
    return shading.mode == ShadeMode::kMono ? Rgb8{0, 0, 0} : shading.background;
  }
  switch (shading.mode) {
    case ShadeMode::kMono:
      return {255, 255, 255};
    case ShadeMode::kDepth: {
      const int32_t depth = planar_depth_q8(hit, camera);
      // In this order, so that planes that coincide or are swapped make a step at the near one, not a
      // division by 0.
      uint32_t fall = 0;
      if (depth > shading.near_q8) {
        fall = kDepthFall;
        if (depth < shading.far_q8) {
          // Differences as unsigned numbers: planes may lie as far apart as int32_t reaches.
          const uint32_t near_plane = static_cast<uint32_t>(shading.near_q8);
          const uint32_t range = static_cast<uint32_t>(shading.far_q8) - near_plane;
          const uint32_t part = static_cast<uint32_t>(depth) - near_plane;
          // part <= range; cut to 24 bits where range has more, so that the product with 215 fits in 32.
          const int excess = range >= (1U << 24) ? 8 : 0;
          fall = (part >> excess) * kDepthFall / (range >> excess);
        }
      }
      const uint8_t gray = static_cast<uint8_t>(255U - fall);
      return {gray, gray, gray};
    }
    case ShadeMode::kNormal: {
      const Face face = face_of(hit, ray.direction);
      const uint8_t value = face.negative ? 0 : 255;
      return {face.axis == 0 ? value : uint8_t{128}, face.axis == 1 ? value : uint8_t{128},
              face.axis == 2 ? value : uint8_t{128}};
    }
    case ShadeMode::kColor: {
      const Rgb8 albedo =
          hit.material < shading.palette.size ? shading.palette[hit.material] : shading.default_color;
      const Face face = face_of(hit, ray.direction);
      const uint32_t light = shading.face_light[2 * face.axis + (face.negative ? 0 : 1)];
      return {channel(albedo.r, light), channel(albedo.g, light), channel(albedo.b, light)};
    }
  }
  return shading.background;
}

}  // namespace thimble
