// Makes the kernels' text C++: the types and functions of GLSL that it uses. Every read of a buffer is checked: outside
// it is 0, as robust buffer access allows, and counted.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "gpu/kernel/parameters.h"

namespace thimble::gpu::kernel {

struct ivec3 {
  int x = 0;
  int y = 0;
  int z = 0;
  ivec3() = default;
  ivec3(int a, int b, int c) : x(a), y(b), z(c) {}
  int& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  int operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  friend ivec3 operator+(ivec3 a, ivec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
};

inline void umulExtended(uint a, uint b, uint& hi, uint& lo) {  // NOLINT: GLSL's name
  const std::uint64_t product = std::uint64_t{a} * b;
  hi = static_cast<uint>(product >> 32);
  lo = static_cast<uint>(product);
}
inline int findMSB(uint v) {
  return 31 - std::countl_zero(v);
}  // NOLINT: GLSL's name
inline int findLSB(uint v) {
  return v == 0 ? -1 : std::countr_zero(v);
}  // NOLINT: GLSL's name
inline int bitCount(uint v) {
  return std::popcount(v);
}  // NOLINT: GLSL's name
using std::abs;
using std::max;
using std::min;

/// What a kernel reads and writes.
struct Buffers {
  std::span<const uint> parameters;
  std::span<const uint> scene;
  std::span<uint> output;
  mutable std::uint64_t outside = 0;  ///< reads and writes beyond a buffer

  uint scene_word(uint i) const { return i < scene.size() ? scene[i] : (++outside, 0U); }
  uint output_word(uint i) const { return i < output.size() ? output[i] : (++outside, 0U); }
  void store(uint i, uint value) const {
    if (i < output.size()) {
      output[i] = value;
    } else {
      ++outside;
    }
  }
};

}  // namespace thimble::gpu::kernel
