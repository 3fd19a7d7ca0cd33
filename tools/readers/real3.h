/// Three real numbers: points, directions and colours of the host, which may use floating point.
#pragma once

#include <array>

namespace thimble::tools {

using Real3 = std::array<double, 3>;

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
