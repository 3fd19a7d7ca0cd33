/// Three real numbers: points, directions and colours of the host, which may use floating point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "thimble/base/vec.h"

namespace thimble::tools {

using Real3 = std::array<double, 3>;

/// The nearest integer to `value` in units of 1 / `one`.
inline std::int32_t to_fixed(double value, double one) {
  return static_cast<std::int32_t>(std::lround(value * one));
}
inline Vec3Q8 to_q8(const Real3& point) {
  const auto q8 = [](double value) { return Q8::from_raw(to_fixed(value, Q8::kOne)); };
  return {q8(point[0]), q8(point[1]), q8(point[2])};
}
inline double largest(const Real3& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}
/// The direction, which is not zero, as integers up to `most`.
inline Vec3i to_integers(const Real3& v, double most) {
  const double scale = largest(v);
  return {to_fixed(v[0] / scale, most), to_fixed(v[1] / scale, most), to_fixed(v[2] / scale, most)};
}

// Of double and long double alike.
template <class Real>
Real dot(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Real>
std::array<Real, 3> cross(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class Real>
std::array<Real, 3> plus(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class Real>
std::array<Real, 3> minus(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class Real>
std::array<Real, 3> scaled(const std::array<Real, 3>& a, Real factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

}  // namespace thimble::tools
