/// @file operation_sweep.h
/// What sweeps of fixed-point operations share: exact arithmetic (long double stands in for it), random
/// integers, and an operation's entry.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_OPERATION_SWEEP_H
#define THIMBLE_TOOLS_INSTRUMENTS_OPERATION_SWEEP_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "readers/real3.h"
#include "thimble/base/vec.h"

namespace thimble::tools::sweep {

using Real = long double;
using Exact3 = std::array<Real, 3>;  // with the products of readers/real3.h

inline constexpr Real kPi = 3.14159265358979323846264338327950288L;

/// Random integers that are the same in every library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  std::int64_t from(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random_() % (static_cast<std::uint64_t>(high - low) + 1));
  }
  std::int32_t from32(std::int64_t low, std::int64_t high) {
    return static_cast<std::int32_t>(from(low, high));
  }
  /// With as many large as small ones: 1 .. 2^bits - 1.
  std::int32_t any_size(int bits) { return from32(1, (std::int64_t{1} << from(1, bits)) - 1); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }

 private:
  std::mt19937_64 random_;
};

/// What one sweep found.
struct Found {
  Real error = 0;
  std::uint64_t cases = 0;

  void see(Real error_seen) {
    error = std::max(error, std::abs(error_seen));
    ++cases;
  }
};

inline Exact3 real(const Vec3i& v) {
  return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}
inline Exact3 unit(const Exact3& a) {
  const Real length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
/// a + b * factor
inline Exact3 along(const Exact3& a, const Exact3& b, Real factor) {
  return {a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor};
}
inline Real length(const Exact3& a) {
  return std::sqrt(dot(a, a));
}

/// Components of up to `bits` bits, some of them 0, not all.
inline Vec3i any_vector(Draw& draw, int bits) {
  Vec3i vector;
  while (vector == Vec3i{}) {
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = draw.from(0, 7) == 0 ? 0 : (draw.from(0, 1) == 0 ? -1 : 1) * draw.any_size(bits);
    }
  }
  return vector;
}

struct Operation {
  const char* name;
  const char* bound_name;
  const char* unit;
  double bound;
  Found (*sweep)(Draw& draw, std::uint64_t cases);
};

/// Those of thimble/light/host/optics.h.
std::vector<Operation> optics_operations();

}  // namespace thimble::tools::sweep

#endif
