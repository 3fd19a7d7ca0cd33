/// @file packed.h
/// Numbers as the bytes of a file hold them: little-endian, at any address. A struct made of these and of
/// bytes has the same layout on every machine and no padding, so tables in flash are used where they lie.
///
/// They convert to plain integers and back by themselves. Reading one is a load a byte and a shift on chips
/// that load only aligned words (Cortex-M0: 4 instructions for 16 bits, 10 for 32), else a single load.
#ifndef THIMBLE_PACKED_H
#define THIMBLE_PACKED_H

#include <stdint.h>

#include "thimble/vec.h"

namespace thimble {

/// 16 bits without a sign.
class PackedU16 {
 public:
  constexpr PackedU16() = default;
  constexpr PackedU16(uint16_t value)
      : low_(static_cast<uint8_t>(value)), high_(static_cast<uint8_t>(value >> 8)) {}
  constexpr operator uint16_t() const { return static_cast<uint16_t>(low_ | high_ << 8); }

 private:
  uint8_t low_ = 0;
  uint8_t high_ = 0;
};

/// 32 bits with a sign, in two's complement.
class PackedI32 {
 public:
  constexpr PackedI32() = default;
  constexpr PackedI32(int32_t value)
      : low_(static_cast<uint16_t>(static_cast<uint32_t>(value) & 0xFFFFU)),
        high_(static_cast<uint16_t>(static_cast<uint32_t>(value) >> 16)) {}
  constexpr operator int32_t() const {
    return static_cast<int32_t>(static_cast<uint32_t>(low_) | static_cast<uint32_t>(high_) << 16);
  }

 private:
  PackedU16 low_;
  PackedU16 high_;
};

/// Three of them.
struct PackedVec3i {
  PackedI32 x;
  PackedI32 y;
  PackedI32 z;

  constexpr PackedVec3i() = default;
  constexpr PackedVec3i(int32_t x_value, int32_t y_value, int32_t z_value)
      : x(x_value), y(y_value), z(z_value) {}
  constexpr PackedVec3i(const Vec3i& vector) : x(vector.x), y(vector.y), z(vector.z) {}
  constexpr operator Vec3i() const { return {x, y, z}; }
  /// Component `axis` (0 = x, 1 = y, 2 = z).
  constexpr int32_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const PackedVec3i& a, const PackedVec3i& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

static_assert(sizeof(PackedU16) == 2 && alignof(PackedU16) == 1);
static_assert(sizeof(PackedI32) == 4 && alignof(PackedI32) == 1);
static_assert(sizeof(PackedVec3i) == 12 && alignof(PackedVec3i) == 1);

}  // namespace thimble

#endif
