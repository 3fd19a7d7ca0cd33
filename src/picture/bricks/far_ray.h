// Takes a ray whose tile gave no start through the air, a layer of bricks at a time. For code in fast RAM. Internal to src/.
//
// The search for a tile's first slab ends where its beam is too wide. In thinned pictures (camera.thinned) that is far
// from anything, and rays would go from voxel to voxel through empty bricks.
#pragma once

#include "../../base/wide_arithmetic.h"
#include "course.h"

namespace thimble::bricks {
namespace {

// A ray on one axis, where it enters a layer of bricks: the brick, which may lie outside of the box, and the distance from
// that brick's far plane times 256 * d_c, which is negative.
struct FarPlace {
  int32_t brick;
  int32_t rest;
};

// From the distance to the box's near side, times 256 * d_c: 35 bits at most, so 25 in bricks.
[[gnu::always_inline]] inline FarPlace far_place(int64_t place, uint32_t d_c) {
  const auto bricks = static_cast<int32_t>(place >> 10);
  const int32_t brick = bricks < 0 ? -1 - static_cast<int32_t>(static_cast<uint32_t>(-1 - bricks) / d_c)
                                   : static_cast<int32_t>(static_cast<uint32_t>(bricks) / d_c);
  return {brick, static_cast<int32_t>(place - wide_product(brick + 1, static_cast<int32_t>(d_c << 10)))};
}

// The first slab of voxels from `slab` on in which a ray of direction (d_a, d_b, d_c) may meet something, or the number of
// slabs if there is none. A ray that is faster on a or b than on c may enter several bricks of a layer: its start is
// `slab`.
[[gnu::noinline, maybe_unused, THIMBLE_HOT]] int32_t far_slab(const Course& course, int32_t slab,
                                                              uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  if (d_a > d_c || d_b > d_c) {
    return slab;
  }
  const int c = course.c;
  const int axis_a = course.axis[0];
  const int axis_b = course.axis[1];
  const int32_t layers = component(course.frame->side, c);
  int32_t layer = slab >> 2;
  // Behind the point where the ray starts within the layer: then it looks at more bricks than it enters.
  const int32_t plane = layer * (4 * Q8::kOne) - course.origin[c];
  int64_t place[2] = {};
  // All layers in which it is still outside on a or b are empty.
  uint32_t outside = 0;
  for (int i = 0; i < 2; ++i) {
    const uint32_t d = i == 0 ? d_a : d_b;
    const int32_t origin = course.origin[i == 0 ? axis_a : axis_b] - kOutsideQ8;
    place[i] = wide_product(origin, static_cast<int32_t>(d_c)) + wide_product(plane, static_cast<int32_t>(d));
    if (place[i] < 0) {
      const auto lack = static_cast<uint32_t>(-1 - (place[i] >> 10));
      const uint32_t more = d == 0 ? static_cast<uint32_t>(layers) : lack / d;
      outside = more > outside ? more : outside;
    }
  }
  if (outside >= static_cast<uint32_t>(layers - layer)) {
    return 4 * layers;
  }
  layer += static_cast<int32_t>(outside);
  FarPlace a = far_place(place[0] + static_cast<int64_t>(wide_product_u(outside, d_a << 10)), d_c);
  FarPlace b = far_place(place[1] + static_cast<int64_t>(wide_product_u(outside, d_b << 10)), d_c);
  const int32_t side_a = component(course.frame->side, axis_a);
  const int32_t side_b = component(course.frame->side, axis_b);
  if (a.brick >= side_a || b.brick >= side_b) {
    return 4 * layers;
  }
  const int32_t stride_a = course.stride[axis_a];
  const int32_t stride_b = course.stride[axis_b];
  const uint8_t* const directory = course.directory;
  const int32_t onward = course.stride[c];
  int32_t cell = course.base + layer * onward + (a.brick + kOutsideCells / 4) * stride_a +
                 (b.brick + kOutsideCells / 4) * stride_b;
  // A brick of -1 lies outside; the ray leaves the box before it would be less.
  for (; layer < layers; ++layer) {
    a.rest += static_cast<int32_t>(d_a << 10);
    b.rest += static_cast<int32_t>(d_b << 10);
    if ((a.brick | b.brick) >= 0 && half_at(directory, cell) != 0) {
      break;
    }
    int32_t next = cell + onward;
    int32_t last_a = a.brick;
    if (a.rest >= 0) {
      a.rest -= static_cast<int32_t>(d_c << 10);
      next += stride_a;
      ++last_a;
      if (last_a < side_a && b.brick >= 0 && half_at(directory, cell + stride_a) != 0) {
        break;
      }
    }
    if (b.rest >= 0) {
      b.rest -= static_cast<int32_t>(d_c << 10);
      next += stride_b;
      if (b.brick + 1 < side_b &&
          ((a.brick >= 0 && half_at(directory, cell + stride_b) != 0) ||
           (last_a != a.brick && last_a < side_a && half_at(directory, next - onward) != 0))) {
        break;
      }
      ++b.brick;
    }
    if (last_a >= side_a || b.brick >= side_b) {
      return 4 * layers;
    }
    a.brick = last_a;
    cell = next;
  }
  return 4 * layer > slab ? 4 * layer : slab;
}

}  // namespace
}  // namespace thimble::bricks
