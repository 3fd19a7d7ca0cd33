// How voxels lie in the bricks of a map, and how a ray counts its way from brick to brick. Internal to src/.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "../../base/bits.h"
#include "../../base/hot.h"
#include "../../tree/deep_map.h"
#include "thimble/base/vec.h"

namespace thimble::bricks {
namespace {

// One of two types, known when compiling: compilers for small chips come without <type_traits>.
template <bool kFirst, class First, class Second>
struct Chosen {
  using Type = First;
};
template <class First, class Second>
struct Chosen<false, First, Second> {
  using Type = Second;
};
template <bool kFirst, class First, class Second>
using Choose = typename Chosen<kFirst, First, Second>::Type;

// The two axes besides the fastest one, c; a is the lower of them.
constexpr int other_a(int c) {
  return c == 0 ? 1 : 0;
}
constexpr int other_b(int c) {
  return c == 2 ? 1 : 2;
}
template <int kC>
constexpr int kOtherA = other_a(kC);
template <int kC>
constexpr int kOtherB = other_b(kC);
// In place of an axis: it is read from the course at run time.
constexpr int kAnyAxis = -1;
// v[axis], for an axis that is known at run time only: a choice of three members is three times the code.
template <class T>
[[gnu::always_inline]] inline T component(const Vec3<T>& v, int axis) {
  T value;
  const auto* const bytes =
      reinterpret_cast<const unsigned char*>(&v) + sizeof(T) * static_cast<unsigned>(axis);
  __builtin_memcpy(&value, __builtin_assume_aligned(bytes, alignof(T)), sizeof(T));
  return value;
}

// A ray may start this many cells outside of the box on axes a and b.
constexpr int32_t kOutsideCells = 64;
constexpr int32_t kOutsideQ8 = kOutsideCells * Q8::kOne;

// One word counts the bricks that are left on three axes, ten bits each: 512 - (bricks from here to the far side).
// Bit 9 of a field is set once the ray has left the box, bit 31 while it may not have entered the box yet, bit 30
// while it is in the slab of voxels that it starts in.
constexpr uint32_t kLeft = uint32_t{1} << 9 | uint32_t{1} << 19 | uint32_t{1} << 29;
constexpr uint32_t kWaiting = uint32_t{1} << 31;
constexpr uint32_t kInside = uint32_t{1} << 30;
constexpr uint32_t kSpecial = kLeft | kWaiting | kInside;

constexpr uint32_t count_of(uint32_t counts, int axis) {
  return counts >> 10 * axis & 0x3FFU;
}

using bits::Half;
using bits::Word;

// The directory and the bricks are read as halfwords and words: they lie at multiples of 4. As bits::little does, but
// in place: a call, though it is inlined, would give the loops of the rays other registers.
[[maybe_unused]] uint32_t half_at(const uint8_t* bytes, int32_t offset) {
  // Through void: compilers for small chips warn of a cast that promises an alignment.
  const Half half = *static_cast<const Half*>(static_cast<const void*>(bytes + offset));
  return bits::kBigEndian ? __builtin_bswap16(half) : half;
}
uint32_t word_at(const uint8_t* bytes, int32_t offset) {
  const Word word = *static_cast<const Word*>(static_cast<const void*>(bytes + offset));
  return bits::kBigEndian ? __builtin_bswap32(word) : word;
}

// The number of the brick at a place in the directory: of kDeep, worlds of level 9 and 10, from its page.
template <bool kDeep>
[[gnu::always_inline]] inline uint32_t number_at(const uint8_t* directory, int32_t place) {
  if constexpr (kDeep) {
    const auto at = static_cast<uint32_t>(place);
    const auto* const table = static_cast<const Word*>(static_cast<const void*>(directory));
    const Word offset = table[deep_place::page_of(at)];
    const uint8_t* const page = directory + (bits::kBigEndian ? __builtin_bswap32(offset) : offset);
    const uint32_t own = page[4 + deep_place::entry_of(at)];
    const auto* const first = static_cast<const Word*>(static_cast<const void*>(page));
    return own == 0 ? 0 : (bits::kBigEndian ? __builtin_bswap32(*first) : *first) + own;
  } else {
    return half_at(directory, place);
  }
}

// What the directory of a box of level 9 or 10 says of pages that are empty; and whether all pages are that hold bricks from
// `low` to `high`.
[[maybe_unused]] uint32_t empty_page_of(const Vec3i& side) {
  const auto last =
      static_cast<uint32_t>((side.x - 1) * deep_place::kStride[0] + (side.y - 1) * deep_place::kStride[1] +
                            (side.z - 1) * deep_place::kStride[2]);
  return (4 * (deep_place::page_of(last) + 1) + 7) & ~uint32_t{7};
}
[[gnu::noinline, maybe_unused]] bool has_empty_pages(const uint8_t* directory, uint32_t empty_page,
                                                     const Vec3i& low, const Vec3i& high) {
  for (int32_t z = low.z >> 2; z <= high.z >> 2; ++z) {
    for (int32_t y = low.y >> 2; y <= high.y >> 2; ++y) {
      const int32_t row = z * 4096 + y * 64;
      for (int32_t x = low.x >> 2; x <= high.x >> 2; ++x) {
        if (word_at(directory, 4 * (row + x)) != empty_page) {
          return false;
        }
      }
    }
  }
  return true;
}

// A voxel's place in its brick: x and y are a shift within a halfword, z is the address of the halfword. Each
// axis has two bits, shifted by this.
constexpr int kPlaceShift[3] = {0, 2, 1};
template <int kAxis>
constexpr uint32_t kField = 3U << kPlaceShift[kAxis];

// The z part of the place, from the address of the halfword: bricks lie at multiples of 8.
[[maybe_unused]] uint32_t row_of(const uint8_t* at) {
  return static_cast<uint32_t>(reinterpret_cast<size_t>(at)) & 6U;
}

// Whether the core has an instruction to divide. (THIMBLE_NO_DIVIDER: tests say that it has none.)
#if defined(THIMBLE_NO_DIVIDER) || (defined(__arm__) && !defined(__ARM_FEATURE_IDIV))
constexpr bool kDivides = false;
#else
constexpr bool kDivides = true;
#endif
// Whether a reciprocal takes the place of a divider: the core counts leading zeros, and has products of 64 bits. Only
// brick_render.cpp asks for it, since frames with light would take 0.3 KB of flash more.
#if defined(THIMBLE_RECIPROCALS) && defined(__ARM_FEATURE_CLZ)
constexpr bool kHasReciprocals = true;
#else
constexpr bool kHasReciprocals = false;
#endif

// Whether code runs from a small RAM of the core's own (THIMBLE_FAST_RAM): then one ray loop for each axis reads the
// signs, where others have eight, and tiles are drawn by a function that fits there.
#ifdef THIMBLE_FAST_RAM
constexpr bool kFastRam = true;
#else
constexpr bool kFastRam = false;
#endif

// Tells the compiler which way a branch mostly goes.
[[gnu::always_inline]] constexpr bool seldom(bool condition) {
  return __builtin_expect(static_cast<long>(condition), 0) != 0;
}

}  // namespace
}  // namespace thimble::bricks
