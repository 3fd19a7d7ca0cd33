/// How large the numbers of the tracing path may become, and a build that measures how large they do. Internal to
/// src/ and to tests/ranges.
///
/// Each row below is a promise of the pages and comments of src. Where such a number is made, the same is said once
/// more in `Exact`, which has 128 bits:
///
///     THIMBLE_NOTE(Range::kState64, Exact(d) * a - Exact(e) * b);
///
/// That is nothing to the compiler but in the build that measures (THIMBLE_RANGES): there the least and the greatest
/// number of each row are kept, and held to the promise: `make ranges`.
#pragma once

#include <stdint.h>

// NAME, SIGNED, BITS, PAGE, WHAT: below 2^BITS, and above -2^BITS where signed, else not below 0.
#define THIMBLE_RANGES_OF(ROW)                                                                            \
  ROW(kOrigin, true, 23, "trace", "origin of a ray, mirrored, 1/256 voxel")                               \
  ROW(kDirection, false, 20, "trace", "component of a direction, mirrored")                               \
  ROW(kDistance, true, 23, "trace", "from the origin to a plane of the world, 1/256 voxel")               \
  ROW(kProduct64, true, 43, "trace", "distance times direction, 64-bit path")                             \
  ROW(kProduct32, true, 31, "trace", "distance times direction, 32-bit path")                             \
  ROW(kState64, false, 42, "trace", "state of a pair of axes, and what it is compared with, 64-bit path") \
  ROW(kState32, false, 32, "trace", "the same, 32-bit path")                                              \
  ROW(kOrder64, true, 43, "trace", "order of two planes of a cell, 64-bit path")                          \
  ROW(kOrder32, true, 31, "trace", "the same, 32-bit path")                                               \
  ROW(kNumerator, false, 23, "trace", "t of a hit: numerator")                                            \
  ROW(kDenominator, false, 28, "trace", "t of a hit: denominator")                                        \
  ROW(kStart, true, 45, "trace", "start on a face: place times speed")                                    \
  ROW(kStartInside, false, 31, "trace", "start on a face: the same within a block of up to 8 voxels")     \
  ROW(kPlaces, true, 59, "trace", "t against t")                                                          \
  ROW(kCross, true, 62, "camera", "product of two view vectors")                                          \
  ROW(kSquares, false, 64, "camera", "sum of squares under a root")                                       \
  ROW(kFocal, false, 60, "camera", "focal length in pixels, 2^-39")                                       \
  ROW(kExtent, false, 63, "camera", "largest component on the picture")                                   \
  ROW(kTerm, false, 63, "camera", "component times size, of the affine function")                         \
  ROW(kAffine, true, 58, "camera", "affine function of the pixel, 2^-32")                                 \
  ROW(kShear, false, 60, "camera", "world's depth times a direction's error")                             \
  ROW(kDepthDot, true, 58, "camera", "corner of the world along the view")                                \
  ROW(kDepth, false, 55, "camera", "depth of a hit: numerator times depth a t")                           \
  ROW(kAllMiss, true, 44, "camera", "a run of pixels against the box: distance times direction")          \
  ROW(kBrickPlace, true, 31, "chip", "place times den: o_a d_c + s_c d_a")                                \
  ROW(kDeepPlace, false, 25, "chip", "place times den, of level 9 and 10: less whole voxels")             \
  ROW(kBrickRest, true, 23, "chip", "rest: distance to the next plane times den")                         \
  ROW(kBrickTime, false, 38, "chip", "rest times direction")                                              \
  ROW(kBrickFan, true, 30, "chip", "direction of a tile, 2^-12")                                          \
  ROW(kBrickSlope, true, 30, "chip", "slope times distance, of a beam")                                   \
  ROW(kFaceOrder, true, 31, "chip", "order of two planes at a tile's first pixel: the whole part")        \
  ROW(kDeepOrder, true, 34, "chip", "the same, of level 9 and 10")                                        \
  ROW(kFaceAffine, true, 31, "chip", "order of two planes in a tile, with its fraction")                  \
  ROW(kFaceBound, false, 26, "chip", "bound of what rounding does to it")                                 \
  ROW(kDot, true, 31, "light", "product of two vectors, Q14 each")                                        \
  ROW(kReflected, true, 60, "light", "product of vectors over a square, 2^-41")                           \
  ROW(kTangent, false, 64, "light", "eta^2 times a square")                                               \
  ROW(kOnward, true, 62, "light", "refracted component over a square, 2^-87")                             \
  ROW(kRefracted, true, 37, "light", "refracted direction, Q32: two terms below 2^36")                    \
  ROW(kLength, false, 57, "light", "numerator of t times length a component, 2^-16")                      \
  ROW(kSquareSum, false, 32, "light", "sum of squares of a direction of 15 bits")

#ifdef THIMBLE_RANGES

namespace thimble {

enum class Range : uint8_t {
#define THIMBLE_RANGE_NAME(name, is_signed, bits, page, what) name,
  THIMBLE_RANGES_OF(THIMBLE_RANGE_NAME)
#undef THIMBLE_RANGE_NAME
      kCount
};

__extension__ typedef __int128 Exact;

/// What was seen of each row; the program that measures defines it.
struct Extremes {
  Exact least;
  Exact greatest;
  uint64_t count;
};
extern Extremes measured_ranges[static_cast<int>(Range::kCount)];

inline void keep_range(Range range, Exact value) {
  Extremes& seen = measured_ranges[static_cast<int>(range)];
  if (seen.count++ == 0) {
    seen.least = value;
    seen.greatest = value;
  }
  seen.least = value < seen.least ? value : seen.least;
  seen.greatest = value > seen.greatest ? value : seen.greatest;
}
constexpr void note(Range range, Exact value) {
  if (!__builtin_is_constant_evaluated()) {
    keep_range(range, value);
  }
}

/// The rows of numbers that are made in either width.
template <class Word>
constexpr Range state_range() {
  return sizeof(Word) == 4 ? Range::kState32 : Range::kState64;
}
template <class Word>
constexpr Range order_range() {
  return sizeof(Word) == 4 ? Range::kOrder32 : Range::kOrder64;
}

}  // namespace thimble

#define THIMBLE_NOTE(range, ...) ::thimble::note(range, __VA_ARGS__)

#else

#define THIMBLE_NOTE(range, ...) static_cast<void>(0)

#endif
