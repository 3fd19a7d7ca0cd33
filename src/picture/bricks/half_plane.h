// Which pixels of a tile meet one plane of voxels before another, as bits. Internal to src/.
//
// A ray from the eye meets plane I of axis i at t_i(I) = s_i / d_i, with s_i its distance. So it meets plane I
// of i before plane J of j where f = s_j d_i - s_i d_j is positive. Directions are an affine function of the
// pixel, rounded, so f is within (s_i + s_j) / 2 of an affine function F: the pixels where F is above that
// bound are certain, those within it on either side are open, and their own rays decide.
#pragma once

#include "../../base/bits.h"
#include "../../base/ranges.h"
#include "edge_quotient.h"
#include "layout.h"
#include "thimble/picture/camera.h"
#include "tile.h"

namespace thimble::bricks {
namespace {

// Bit x + 16 y of 128 is a pixel.
constexpr int kTileWords = kTileAcrossPx * kTileDownPx / 32;

// The pixels of a tile.
struct Pixels {
  uint32_t columns() const { return word[0] | word[1] | word[2] | word[3]; }
  uint32_t word[kTileWords];
};

// Loads four words: on an ARM7, by one instruction in half the time. (Elsewhere a copy would be put on the stack.)
#if defined(__ARM_ARCH_4T__) && !defined(__thumb__)
[[gnu::always_inline]] inline Pixels words_of(const Pixels& pixels) {
  register uint32_t a asm("r0");
  register uint32_t b asm("r1");
  register uint32_t c asm("r2");
  register uint32_t d asm("r3");
  asm("ldmia %4, {r0-r3}" : "=r"(a), "=r"(b), "=r"(c), "=r"(d) : "r"(&pixels), "m"(pixels));
  return {{a, b, c, d}};
}
#else
[[gnu::always_inline]] inline const Pixels& words_of(const Pixels& pixels) {
  return pixels;
}
#endif

// The directions of a tile, mirrored and in the order a, b, c: base + rest + x * step_x + y * step_y, of which
// `base` is whole and the others have `fraction_bits` behind the point.
struct TileRays {
  int32_t base[3];
  int32_t rest[3];
  int32_t step_x[3];
  int32_t step_y[3];
  int fraction_bits;
  int32_t unit;   // rounding changes f by at most (s_i + s_j) times this
  int32_t reach;  // |rest + x * step_x + y * step_y| is at most this, which is below 2^15
};

// A number with 32 bits behind the point in two parts, so that a few times it takes products of 32 bits: all from
// 1/2^16 on, of which 16 bits stand before the point, and the 16 bits below.
struct SplitQ32 {
  uint32_t high;
  uint32_t low;
};
SplitQ32 split(int64_t value) {
  return {static_cast<uint32_t>(value >> 16), static_cast<uint32_t>(value) & 0xFFFFU};
}

// The pixels at which f is certainly positive, and those at which it is not certainly negative.
struct HalfPlane {
  Pixels certain;
  Pixels possible;
};

// Before F is computed from distances they are cut to this many bits.
constexpr int kDistanceBits = 13;

// `divide_edge` does as `walk_edge` with three quotients instead of loops: it finds where an edge crosses the rows,
// in 1/2^kCrossingBits pixel. It returns false for edges that are far from upright. `fx` is positive.
//
// All quotients (edge_quotient.h) are wrong by at most 2 units and, together, by 2^-13 of them. With |crossing| <= 17
// pixels where it matters that is at most 21 units: 1 + 7 quotients, and 5.
constexpr int32_t kCrossingSlack = 24;
// Whether edges are divided.
constexpr bool kDividesEdges = kDivides || kHasReciprocals;

// The pixels of a row from a crossing on. The place is limited to 31, so that one shift finds them.
[[gnu::always_inline]] inline uint32_t row_from(int32_t crossing) {
  const int32_t place = crossing >> kCrossingBits;
  const int32_t positive = place < 0 ? 0 : place;
  return 0xFFFFU << (positive > 31 ? 31 : positive);
}

// Puts rows that were stored as halfwords, from the first on, where `Pixels` has them: on big-endian machines the first
// of two is the upper half of its word.
[[gnu::always_inline]] inline void order_rows([[maybe_unused]] HalfPlane* plane) {
  if constexpr (bits::kBigEndian) {
    for (int i = 0; i < kTileWords; ++i) {
      plane->certain.word[i] = plane->certain.word[i] << 16 | plane->certain.word[i] >> 16;
      plane->possible.word[i] = plane->possible.word[i] << 16 | plane->possible.word[i] >> 16;
    }
  }
}

// Sets the rows of two masks; those of `invert` are of their complements. Without a divider there is no flash to unroll.
[[gnu::always_inline]] inline void fill_rows(int32_t at, int32_t slope, int32_t back, uint32_t invert,
                                             Pixels* first, Pixels* second) {
  Half* to = static_cast<Half*>(static_cast<void*>(first));
  Half* also = static_cast<Half*>(static_cast<void*>(second));
#pragma GCC unroll(kDivides ? 8 : 1)
  for (int row = 0; row < kTileDownPx; ++row, at -= slope) {
    to[row] = static_cast<Half>(row_from(at) ^ invert);
    also[row] = static_cast<Half>(row_from(at - back) ^ invert);
  }
}

bool divide_edge(int32_t f, int32_t fx, int32_t fy, int32_t bound, bool flip, HalfPlane* plane) {
  const int32_t ahead = bound - f;
  if ((ahead < 0 ? -ahead : ahead) >> 6 >= fx || (fy < 0 ? -fy : fy) >> 4 > fx || bound >> 2 > fx ||
      fx < EdgeQuotient<kDivides>::kLeast) {
    return false;
  }
  const EdgeQuotient<kDivides> quotient(fx);
  int32_t at = quotient(ahead);
  const int32_t slope = quotient(fy);
  // How far the first possible pixel's crossing lies before that of the first certain one, slack included.
  const int32_t back = quotient(2 * bound) + 2 * kCrossingSlack + 1;
  at += kCrossingSlack + (1 << kCrossingBits);
  fill_rows(at, slope, back, flip ? UINT32_MAX : 0, flip ? &plane->possible : &plane->certain,
            flip ? &plane->certain : &plane->possible);
  order_rows(plane);
  return true;
}

// Walks along an edge of an F that grows to the right and, if `step` is 1, downwards; `f` is its least value in the tile,
// times 2^fraction_bits and scaled, `fx` and `fy` are its steps. Exactly the pixels above `bound` become certain, those
// from -bound on possible; where F was turned, it is the other way round.
void walk_edge(int32_t f, int32_t fx, int32_t fy, int32_t bound, bool flip, int step, HalfPlane* plane) {
  Half* certain = static_cast<Half*>(static_cast<void*>(flip ? &plane->possible : &plane->certain));
  Half* possible = static_cast<Half*>(static_cast<void*>(flip ? &plane->certain : &plane->possible));
  if (step < 0) {
    certain += kTileDownPx - 1;
    possible += kTileDownPx - 1;
  }
  // The lower half of `mask` is a row: its certain pixels, or where F is turned those that are not possible, of which a
  // shift adds one. `at` is F of the pixel that is added next, less the bound.
  const auto is_full = [](int32_t row) { return row == row >> 1; };
  int32_t mask = flip ? 0xFFFF : ~0xFFFF;
  int32_t at = f + (kTileAcrossPx - 1) * fx - bound;
#pragma GCC unroll 2
  for (int jump = 8; jump >= 4; jump >>= 1) {
    if (at - (jump - 1) * fx > 0) {
      mask >>= jump;
      at -= jump * fx;
    }
  }
  for (int row = 0; row < kTileDownPx; ++row) {
    while (at > 0 && !is_full(mask)) {
      mask >>= 1;
      at -= fx;
    }
    int32_t open = mask;
    int32_t there = at + 2 * bound;
    if (seldom(there >= 0)) {
      open >>= 1;
      for (there -= fx; seldom(there >= 0 && !is_full(open)); there -= fx) {
        open >>= 1;
      }
    }
    *certain = static_cast<Half>(mask);
    *possible = static_cast<Half>(open);
    certain += step;
    possible += step;
    at += fy;
  }
  order_rows(plane);
}

// The number of bits of a distance times a direction, signed.
template <bool kDeep>
using WholeOf = Choose<kDeep, int64_t, int32_t>;

[[gnu::noinline, THIMBLE_HOT]] void set_all(HalfPlane* plane, uint32_t word) {
  for (int i = 0; i < kTileWords; ++i) {
    plane->certain.word[i] = word;
    plane->possible.word[i] = word;
  }
}

// Finds the pixels that meet the plane of axis i (0 a, 1 b, 2 c) at distance `s_i` before that of axis j at `s_j`.
// Planes at or behind the eye count as met before all others.
template <bool kDeep>
[[gnu::noinline, THIMBLE_HOT]] void find_half_plane(const TileRays& rays, int i, int j, int32_t s_i,
                                                    int32_t s_j, HalfPlane* plane) {
  if (((s_i - 1) | (s_j - 1)) < 0) {
    set_all(plane, s_i <= 0 ? UINT32_MAX : 0);
    return;
  }
  // Products of worlds of level 9 and 10 take more than 31 bits.
  using Whole = WholeOf<kDeep>;
  const Whole exact = Whole{s_j} * rays.base[i] - Whole{s_i} * rays.base[j];
  THIMBLE_NOTE(kDeep ? Range::kDeepOrder : Range::kFaceOrder,
               Exact(s_j) * Exact(rays.base[i]) - Exact(s_i) * Exact(rays.base[j]));
  int cut = 0;
  for (int32_t most = s_i > s_j ? s_i : s_j; most >= 1 << kDistanceBits; most >>= 2) {
    cut += 2;
  }
  const int bits = rays.fraction_bits;
  const Whole size = exact < 0 ? -exact : exact;
  if (size >> cut >= 1 << (30 - bits)) {
    set_all(plane, exact > 0 ? UINT32_MAX : 0);
    return;
  }
  const int32_t half = cut == 0 ? 0 : 1 << (cut - 1);
  s_i = (s_i + half) >> cut;
  s_j = (s_j + half) >> cut;
  const int32_t bound = (s_i + s_j + 1) * rays.unit + (cut == 0 ? 2 : rays.reach + 2);
  int32_t f = static_cast<int32_t>(bits >= cut ? exact * (1 << (bits - cut)) : exact >> (cut - bits)) +
              s_j * rays.rest[i] - s_i * rays.rest[j];
  int32_t fx = s_j * rays.step_x[i] - s_i * rays.step_x[j];
  int32_t fy = s_j * rays.step_y[i] - s_i * rays.step_y[j];
  [[maybe_unused]] const int32_t across = (kTileAcrossPx - 1) * fx;
  [[maybe_unused]] const int32_t below = (kTileDownPx - 1) * fy;
  THIMBLE_NOTE(Range::kFaceBound,
               Exact(s_i + s_j + 1) * Exact(rays.unit) + Exact(cut == 0 ? 2 : rays.reach + 2));
  THIMBLE_NOTE(Range::kFaceAffine,
               (bits >= cut ? Exact(exact) * Exact(1 << (bits - cut)) : Exact(exact >> (cut - bits))) +
                   Exact(s_j) * Exact(rays.rest[i]) - Exact(s_i) * Exact(rays.rest[j]) +
                   Exact(across < 0 ? across : 0) + Exact(below < 0 ? below : 0));
  THIMBLE_NOTE(Range::kFaceAffine,
               (bits >= cut ? Exact(exact) * Exact(1 << (bits - cut)) : Exact(exact >> (cut - bits))) +
                   Exact(s_j) * Exact(rays.rest[i]) - Exact(s_i) * Exact(rays.rest[j]) +
                   Exact(across < 0 ? 0 : across) + Exact(below < 0 ? 0 : below));
  // Turns F so that it grows to the right.
  const bool flip = fx < 0;
  if (flip) {
    f = -f;
    fx = -fx;
    fy = -fy;
  }
  const int32_t down = (kTileDownPx - 1) * fy;
  const int32_t least = f + (down < 0 ? down : 0);
  const int32_t greatest = f + (kTileAcrossPx - 1) * fx + (down < 0 ? 0 : down);
  if (least > bound || greatest < -bound) {
    set_all(plane, (least > bound) != flip ? UINT32_MAX : 0);
    return;
  }
  if (kDividesEdges && divide_edge(f, fx, fy, bound, flip, plane)) {
    return;
  }
  walk_edge(least, fx, fy < 0 ? -fy : fy, bound, flip, fy < 0 ? -1 : 1, plane);
}

}  // namespace
}  // namespace thimble::bricks
