/// Where a voxel may be seen: what the loops over voxels share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "benchmarks/peers/peer.h"

namespace thimble::benchmarks {

/// The pixels x0 .. x1, y0 .. y1; none where x0 > x1 or y0 > y1.
struct Extent {
  std::int32_t x0, x1, y0, y1;
};

/// How many pixels a voxel reaches from its middle: wide/raster/frame.h.
struct Reach {
  float x, y;
};
inline Reach reach_of(const wide::WideFrame& frame, float column, float row, float per_depth) {
  const float k = 0.5F * per_depth + frame.per_direction * (1 + frame.half_w * per_depth);
  const float r = k * frame.norm_w;
  if (!frame.perspective || r > 0.125F) {
    return {frame.reach_x * per_depth + frame.rounding_x * per_depth + frame.slack_x,
            frame.reach_y * per_depth + frame.rounding_y * per_depth + frame.slack_y};
  }
  const float factor = k * (r * 1.152F + 1.001F);
  float across = 0;
  float down = 0;
  for (int axis = 0; axis < 3; ++axis) {
    across += std::abs(frame.u[axis] - column * frame.w[axis]);
    down += std::abs(frame.v[axis] - row * frame.w[axis]);
  }
  return {across * factor + frame.rounding_x * per_depth + frame.spread_x,
          down * factor + frame.rounding_y * per_depth + frame.spread_y};
}

/// `low`: the voxel's lowest corner. None for what lies in the eye's plane or behind it: the views here have
/// no such voxels in sight.
template <bool kPerspective>
inline Extent extent_of(const View& view, const float (&low)[3]) {
  constexpr Extent kNone{0, -1, 0, -1};
  const wide::WideFrame& frame = view.frame;
  const auto apply = [&](const float(&of)[4]) {
    return of[0] * (low[0] + 0.5F) + of[1] * (low[1] + 0.5F) + of[2] * (low[2] + 0.5F) + of[3];
  };
  float per_depth = 1;
  if (kPerspective) {
    const float depth = apply(frame.w);
    if (depth <= frame.half_w) {
      return kNone;
    }
    per_depth = 1 / depth;
  }
  const float column = apply(frame.u) * per_depth;
  const float row = apply(frame.v) * per_depth;
  const Reach reach = reach_of(frame, column, row, per_depth);
  const float x0 = std::max(column - reach.x, 0.0F);
  const float x1 = std::min(column + reach.x, static_cast<float>(view.width_px - 1));
  const float y0 = std::max(row - reach.y, 0.0F);
  const float y1 = std::min(row + reach.y, static_cast<float>(view.height_px - 1));
  if (!(x0 <= x1 && y0 <= y1)) {
    return kNone;
  }
  return {static_cast<std::int32_t>(x0 + 0.9999999F), static_cast<std::int32_t>(x1),
          static_cast<std::int32_t>(y0 + 0.9999999F), static_cast<std::int32_t>(y1)};
}

}  // namespace thimble::benchmarks
