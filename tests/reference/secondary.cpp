// Secondary rays, the plain way.
#include "reference/secondary.h"

#include <algorithm>

namespace thimble::reference {

namespace {

__extension__ typedef __int128 Int128;

Int128 floor_of(Int128 dividend, Int128 divisor) {  // divisor > 0
  const Int128 quotient = dividend / divisor;
  return quotient * divisor > dividend ? quotient - 1 : quotient;
}

// The coordinate at `time`, in 1/256 voxel, as a fraction with the denominator `time.denominator`.
Int128 coordinate_at(const Ray& ray, std::size_t axis, const Time& time) {
  return Int128{ray.origin_q8[axis]} * time.denominator + Int128{256} * ray.direction[axis] * time.numerator;
}

// When the ray comes to the plane by which it leaves `voxel` along `axis`.
Time leaves_at(const Ray& ray, const Voxel& voxel, std::size_t axis) {
  const std::int64_t direction = ray.direction[axis];
  const std::int64_t plane = voxel[axis] + (direction > 0 ? 1 : 0);
  const std::int64_t way_q8 = 256 * plane - ray.origin_q8[axis];
  return direction > 0 ? Time{way_q8, 256 * direction} : Time{-way_q8, -256 * direction};
}

bool before(const Time& a, const Time& b) {
  return Int128{a.numerator} * b.denominator < Int128{b.numerator} * a.denominator;
}

// Through the plane, or all the planes, that the ray comes to first.
Voxel next_voxel(const Ray& ray, const Voxel& voxel) {
  std::array<Time, 3> times;
  bool found = false;
  Time first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] != 0) {
      times[axis] = leaves_at(ray, voxel, axis);
      if (!found || before(times[axis], first)) {
        first = times[axis];
        found = true;
      }
    }
  }
  Voxel next = voxel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] != 0 && !before(first, times[axis])) {
      next[axis] += ray.direction[axis] > 0 ? 1 : -1;
    }
  }
  return next;
}

}  // namespace

PointQ8 start_on_face(const Ray& ray, const Hit& hit, int side) {
  if (hit.axis < 0) {
    return ray.origin_q8;
  }
  PointQ8 start{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{256} * hit.voxel[axis];
    const std::int64_t high = low + std::int64_t{256} * side;
    if (static_cast<int>(axis) == hit.axis) {
      start[axis] = ray.direction[axis] > 0 ? low : high;
      continue;
    }
    const Time time{hit.t_numerator, hit.t_denominator};
    const std::int64_t down =
        static_cast<std::int64_t>(floor_of(coordinate_at(ray, axis, time), time.denominator));
    start[axis] = std::clamp(down, low, high - 1);
  }
  return start;
}

Voxel voxel_after(const Ray& ray, const Time& time) {
  Voxel voxel{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Int128 unit = Int128{256} * time.denominator;
    const Int128 coordinate = coordinate_at(ray, axis, time);
    const Int128 index = floor_of(coordinate, unit);
    // On a plane, what comes down is in the voxel below.
    const bool below = ray.direction[axis] < 0 && index * unit == coordinate;
    voxel[axis] = static_cast<int>(index) - (below ? 1 : 0);
  }
  return voxel;
}

Hit first_voxel(const Ray& ray, const Time& from, const std::function<bool(const Voxel&)>& stops,
                const std::function<bool(const Voxel&)>& beyond) {
  check_ray(ray);
  for (Voxel voxel = voxel_after(ray, from);; voxel = next_voxel(ray, voxel)) {
    if (stops(voxel)) {
      return brute_force({voxel}, ray);
    }
    if (beyond(voxel)) {
      return Hit{};
    }
  }
}

}  // namespace thimble::reference
