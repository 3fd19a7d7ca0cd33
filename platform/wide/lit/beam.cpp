#include "wide/lit/beam.h"

#include <algorithm>
#include <cmath>

namespace thimble::wide {
namespace {

// Numbers are below 2^30, so doubles are off by less than 2^-20.
constexpr double kMargin = 0x1p-16;

template <class T>
Vec3<double> times(double factor, const Vec3<T>& of) {
  return {factor * static_cast<double>(of.x), factor * static_cast<double>(of.y),
          factor * static_cast<double>(of.z)};
}

int axis_of_largest(const Vec3<double>& of) {
  const int axis = std::abs(of.y) > std::abs(of.x) ? 1 : 0;
  return std::abs(of.z) > std::abs(of[axis]) ? 2 : axis;
}

int32_t rounded_down(double number) {
  constexpr int32_t kFar = 1 << 20;
  return static_cast<int32_t>(std::clamp<double>(number, -kFar, kFar) + kFar) - kFar;
}

// Numbers that lie between two.
struct Range {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;

  void add(double number, double slack) {
    low = std::min(low, number - slack);
    high = std::max(high, number + slack);
  }
};

// All places on a beam's rays: on an axis across, after a way of `s` voxels along the beam's own, from `at` + s * `per` low
// to high.
struct Across {
  Range at;
  Range per;

  // The voxels that the rays come to between two such ways.
  void find(double from, double to, int32_t* low, int32_t* end) const {
    const double least = std::min(at.low + from * per.low, at.low + to * per.low);
    const double most = std::max(at.high + from * per.high, at.high + to * per.high);
    *low = rounded_down(least - kMargin);
    *end = rounded_down(most + kMargin) + 1;
  }
};

}  // namespace

Beams::Beams(const Camera& camera, const RayMap& map)
    : map_(map),
      is_perspective_(camera.is_perspective()),
      eye_{times(1.0 / Q8::kOne, Vec3i{camera.eye().x.raw, camera.eye().y.raw, camera.eye().z.raw})},
      direction_(times(1, camera.direction())),
      base_(times(0x1p-32, camera.affine().base)),
      step_x_(times(0x1p-32, camera.affine().step_x)),
      step_y_(times(0x1p-32, camera.affine().step_y)) {}

// The rays' directions, or origins, are the camera's affine function of the pixel, each component rounded: off by a half at
// most. Quotients of two such components are extreme at the corners.
FirstPlane Beams::first_plane(const PixelBox& pixels, const FirstPlane& more) const {
  if (map_.cells() == nullptr || more.is_clear) {
    return more;
  }
  Vec3d corners[4];
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 == 0 ? pixels.x0 : pixels.x1 - 1;
    const double y = i / 2 == 0 ? pixels.y0 : pixels.y1 - 1;
    for (int axis = 0; axis < 3; ++axis) {
      corners[i][axis] = base_[axis] + x * step_x_[axis] + y * step_y_[axis];
    }
  }
  const Vec3d& some = is_perspective_ ? corners[0] : direction_;
  FirstPlane plane;
  plane.axis = axis_of_largest(some);
  const double sign = some[plane.axis] < 0 ? -1 : 1;
  Across across[3];
  for (const Vec3d& corner : corners) {
    const double along = sign * (is_perspective_ ? corner : direction_)[plane.axis];
    if (along < 16) {
      return {};
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double per = (is_perspective_ ? corner : direction_)[axis] / along;
      const double slack = 0.5 * (1 + std::abs(per));
      across[axis].per.add(per, is_perspective_ ? slack / (along - 0.5) : 0);
      const double aside = is_perspective_ ? 0 : (corner[axis] - sign * corner[plane.axis] * per) / Q8::kOne;
      across[axis].at.add(eye_[axis] + aside, is_perspective_ ? 0 : slack / Q8::kOne);
    }
  }
  const VoxelBox& bounds = map_.tree().bounds();
  const double eye = sign * eye_[plane.axis];
  plane.sign = static_cast<int32_t>(sign);
  const int32_t near = plane.sign > 0 ? bounds.low[plane.axis] : -bounds.high[plane.axis];
  const int32_t far = plane.sign > 0 ? bounds.high[plane.axis] : -bounds.low[plane.axis];
  const auto is_empty = [&](int32_t first, int32_t end) {
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == plane.axis) {
        box.low[axis] = plane.sign > 0 ? first : -end;
        box.high[axis] = plane.sign > 0 ? end : -first;
      } else {
        const double least = is_perspective_ ? 0 : -HUGE_VAL;
        across[axis].find(std::max(first - eye, least), std::max(end - eye, least), &box.low[axis],
                          &box.high[axis]);
      }
    }
    return map_.is_empty(box);
  };
  constexpr int32_t kCube = 16;
  constexpr int32_t kLeaf = 4;
  plane.at = std::max(near, is_perspective_ ? rounded_down(eye) : near) & -kCube;
  if (more.sign == plane.sign && more.axis == plane.axis) {
    plane.at = std::max(plane.at, more.at & -kCube);
  }
  for (; plane.at < far; plane.at += kCube) {
    if (is_empty(plane.at, plane.at + kCube)) {
      continue;
    }
    for (int32_t first = plane.at; first < plane.at + kCube; first += kLeaf) {
      if (!is_empty(first, first + kLeaf)) {
        plane.at = first;
        return plane;
      }
    }
  }
  plane.is_clear = true;
  return plane;
}

}  // namespace thimble::wide
