#include "wide/lit/row_spans.h"

#include <algorithm>
#include <cmath>

namespace thimble::wide {
namespace {

using Vec3d = Vec3<double>;

double cross(const Vec3d& a, const Vec3d& b, int u, int v) {
  return a[u] * b[v] - a[v] * b[u];
}

template <class T>
Vec3d times(double factor, const Vec3<T>& of) {
  return {factor * static_cast<double>(of.x), factor * static_cast<double>(of.y),
          factor * static_cast<double>(of.z)};
}

}  // namespace

// Camera rounds each component of direction, or origin, by half a unit at most: so the product with a corner
// is off by at most half of `slack`. Doubles add below 2^-24 of it: components are below 2^25.
RowSpans::RowSpans(const Camera& camera, const VoxelBox& box) : width_(camera.width_px()) {
  const Vec3d base = times(0x1p-32, camera.affine().base);
  const Vec3d step_x = times(0x1p-32, camera.affine().step_x);
  const Vec3d step_y = times(0x1p-32, camera.affine().step_y);
  const Vec3d direction = times(1, camera.direction());
  for (int axis = 0; axis < 3; ++axis) {
    const int u = axis;
    const int v = (axis + 1) % 3;
    for (int number = 0; number < 4; ++number) {
      Vec3d way{0, 0, 0};  // from the eye
      way[u] = ((number & 1) != 0 ? box.high : box.low)[u] * Q8::kOne - camera.eye()[u].raw;
      way[v] = ((number & 2) != 0 ? box.high : box.low)[v] * Q8::kOne - camera.eye()[v].raw;
      Corner& corner = corners_[axis][number];
      if (camera.is_perspective()) {
        corner = {cross(base, way, u, v), cross(step_x, way, u, v), cross(step_y, way, u, v),
                  std::abs(way[u]) + std::abs(way[v])};
      } else {
        way[u] -= base[u];
        way[v] -= base[v];
        corner = {cross(direction, way, u, v), -cross(direction, step_x, u, v),
                  -cross(direction, step_y, u, v), std::abs(direction[u]) + std::abs(direction[v])};
      }
    }
  }
}

RowSpans::Columns RowSpans::of_row(int32_t row) const {
  // A line misses a box if in one of three planes all corners lie on one side of it: for either side that is
  // so from one column to another.
  double lows[6];
  double highs[6];
  for (int number = 0; number < 6; ++number) {
    const double sign = number < 3 ? 1 : -1;
    double low = 0;
    double high = width_ - 1;
    for (const Corner& corner : corners_[number % 3]) {
      const double side = sign * (corner.at + row * corner.per_row) - corner.slack;
      const double slope = sign * corner.per_column;
      if (slope > 0) {
        low = std::max(low, std::floor(-side / slope) + 1);
      } else if (slope < 0) {
        high = std::min(high, std::ceil(-side / slope) - 1);
      } else if (side <= 0) {
        high = -1;
      }
    }
    lows[number] = low;
    highs[number] = high;
  }
  double first = 0;
  double end = width_;
  for (bool moves = true; moves && first < end;) {
    moves = false;
    for (int number = 0; number < 6; ++number) {
      if (lows[number] <= first && highs[number] >= first) {
        first = highs[number] + 1;
        moves = true;
      }
      if (highs[number] >= end - 1 && lows[number] < end) {
        end = lows[number];
        moves = true;
      }
    }
  }
  return first < end ? Columns{static_cast<int32_t>(first), static_cast<int32_t>(end)} : Columns{0, 0};
}

}  // namespace thimble::wide
