/// @file kernels.h
/// The loops that run over boxes and pixels, compiled for several instruction sets and chosen when the
/// program runs (Highway).
#ifndef THIMBLE_PLATFORM_HOST_WIDE_KERNELS_H
#define THIMBLE_PLATFORM_HOST_WIDE_KERNELS_H

#include <stddef.h>
#include <stdint.h>

#include "host/wide/frame.h"

namespace thimble::wide {

/// The nearest box of every pixel so far.
///
/// A box's key is the Morton code of its lowest corner, mirrored in every axis along which the pixel's ray
/// runs downwards. Of two boxes of an octree that a ray meets, the one met first has the smaller key: they
/// part at some node, in which the ray passes the children in the order of their mirrored numbers. So depth
/// is compared as integers, exactly.
struct Depths {
  uint64_t* nearest;  ///< per pixel: key << kEntryBits | entry; holds something only where `covered` says so
  uint64_t* covered;  ///< a bit a pixel, `words` words a row, the leftmost pixel in the lowest bit
  int32_t width_px;
  int32_t words;
};
inline constexpr int kEntryBits = 28;
inline constexpr int kKeyBits = 36;

struct Counts {
  uint64_t boxes = 0;       ///< projected
  uint64_t candidates = 0;  ///< pixels whose ray was tested against a box
  uint64_t exact = 0;       ///< of those, how many floats could not tell
  uint64_t hits = 0;        ///< tests that were met
  uint64_t nodes = 0;       ///< blocks looked at
  uint64_t crossing = 0;    ///< boxes in the eye's plane, tested pixel by pixel
};

/// A run of entries (voxel_lists.h) of the cube whose lowest corner is `corner` (in voxels).
struct Run {
  const uint32_t* entries;
  uint32_t count;
  uint32_t first;  ///< number of the first of them
  uint32_t corner[3];
  bool unit;  ///< whether all are one voxel
};

/// Draws the boxes of a run into `depths`.
void draw_run(const Frame& frame, const Run& run, const Depths& depths, Counts* counts);

/// Where up to 8 boxes may be seen: the pixels x0 .. x1 - 1, y0 .. y1 - 1 of the tile, none when x0 >= x1.
struct Rectangle {
  int32_t x0, y0, x1, y1;
};
/// Cubes of `side` voxels with lowest corners `x[i]`, `y[i]`, `z[i]`, i < 8.
void find_rectangles(const Frame& frame, const float* x, const float* y, const float* z, float side,
                     Rectangle* rectangles);

/// 64 pixels of a row, as the exact rays meet their nearest boxes.
struct WordHits {
  alignas(64) int32_t axis[64];       ///< -1: the ray starts inside
  alignas(64) int32_t numerator[64];  ///< t = numerator / (256 * |direction[axis]|)
  alignas(64) int32_t direction[3][64];
};
/// Fills in what `nearest` (64 of them, see Depths) says of columns 64 * word and on of row `y`. `levels`:
/// log2 of the boxes' sides, or null when all are one voxel. Pixels that are not covered get numbers without
/// meaning.
void resolve_word(const Frame& frame, int32_t y, int32_t word, const uint64_t* nearest, const int32_t* levels,
                  WordHits* hits);

/// Distances along the camera's forward vector, in 1/256 voxel (thimble/shading.h: planar_depth_q8), of 64
/// hits.
void find_depths(const WordHits& hits, int32_t depth_per_t_q8, int32_t* depths_q8);

/// The name of the instruction set in use.
const char* instruction_set();

}  // namespace thimble::wide

#endif
