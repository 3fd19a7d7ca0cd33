/// @file render.h
/// A band of rows of the picture into the caller's bytes.
///
/// Each pixel is a function of the tree, the camera and the shading alone. So bands of any height, drawn in
/// any order, by one core or many, give the same picture as one whole frame; a board sends a few rows at a
/// time to its display and never holds a frame.
///
/// Several samples a pixel: the picture is traced k times as wide and k times as high, and squares of k x k
/// of its pixels are averaged.
///
///     Camera fine;                                    // the same view, k * width x k * height pixels
///     for (int32_t y = 0; y < height; ++y) {
///       render_band(tree, fine, shading, {fine_rows, PixelFormat::kRgb888, 0, y * k, k});
///       average_samples(fine_rows, k, width, y, format, row);
///     }
///
/// So the samples of pixel (px, py) lie at its fixed places px + (i + 1/2) / k, py + (j + 1/2) / k, i and j
/// from 0 to k - 1: a regular grid, the same on every machine and in every frame, with the one sample at the
/// centre for k = 1. Any engine that draws bands can draw them. Memory: one band of k fine rows,
/// `samples_bytes`.
///
/// The mean is taken of the numbers that a display is sent (not of light), channel by channel, rounded to the
/// nearest, halves up. With k = 1 it is the picture itself, byte for byte.
#ifndef THIMBLE_PICTURE_RENDER_H
#define THIMBLE_PICTURE_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../trace/ray.h"
#include "../tree/brick_map.h"
#include "../tree/compact_tree.h"
#include "camera.h"
#include "pixel.h"
#include "shading.h"

namespace thimble {

/// Where a band goes: rows first_row .. first_row + rows - 1 of the picture, the first one at the front of
/// `pixels`.
struct Band {
  Bytes pixels;
  PixelFormat format = PixelFormat::kRgb888;
  /// Bytes from one row to the next (of kMono1Pages: from one page to the next), at least row_bytes(format,
  /// width); 0 means just that. Bytes between the rows are not touched.
  size_t stride_bytes = 0;
  int32_t first_row = 0;
  int32_t rows = 0;
};

/// Bytes for `rows` rows of `width_px` pixels without gaps, the rows rounded up to what the format keeps
/// together; SIZE_MAX when size_t cannot say it.
constexpr size_t band_bytes(PixelFormat format, int32_t width_px, int32_t rows) {
  const size_t one = row_bytes(format, width_px);
  const size_t all = static_cast<size_t>(rows);
  const size_t count = has_pages(format) ? all / 8 + (all % 8 != 0 ? 1 : 0) : all;
  return one != 0 && count > SIZE_MAX / one ? SIZE_MAX : one * count;
}

/// What a renderer keeps between bands besides the tree and the band: camera, shading and counters. The stack
/// of a ray is not in it (tests/budgets/stack.csv).
struct RenderCounts {
  uint64_t rays = 0;
  uint64_t hits = 0;
  uint64_t node_visits = 0;
  uint64_t step_limited = 0;  ///< rays stopped by TraceOptions::max_visits; their pixels look like misses
};
constexpr size_t render_bytes() {
  return sizeof(Camera) + sizeof(Shading) + sizeof(RenderCounts);
}

/// Draws the band. `counts` (may be null) is added to. The camera was set up for the structure's level.
/// Errors, with nothing drawn: kBadArgument (camera without pixels or for another level, rows outside the
/// picture or no multiple of `band_row_multiple`, stride too small, Width::k32 for rays that it does not
/// take), kOutOfMemory (pixels too small).
Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const SharedTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const DenseGrid& grid, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});

/// Draws the band with 32-bit products only, as `closest_hit_32` traces: no code and no stack of the 64-bit
/// path. Errors: also kBadArgument for a camera with rays that it does not take (`accepts_32`).
Status render_band_32(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                      RenderCounts* counts = nullptr, uint32_t max_visits = UINT32_MAX);

// --- The same picture in a thirteenth of the instructions, for chips that draw frames: a compact tree with a
// brick map beside it.
//
// The pixels are those of `render_band` for the tree, bit for bit, whatever the camera, shading, format and
// band: `render_band` draws what the fast way does not take, single rays or whole frames. Nothing is kept
// between bands, so bands may be drawn in any order and side by side.
//
// The fast way takes perspective cameras whose products of distances and directions fit in 32 bits
// (`draws_fast`): in a world of 64 pictures of up to 1,200 pixels a side from within it and up to two world
// sizes away, of 600 from farther; in one of 128 1,200 from up to half its size away, 600 from two; in one of
// 256 half as many. Bands of many rows that start at a multiple of kBrickTilePx are cheapest, in
// pictures whose width is a multiple of 16. kDepth costs a division a pixel, and is drawn ray by ray.
//
// A tile is drawn face by face where faces cover several pixels, else ray by ray.
//
// Cost on a Cortex-M3: some 360 instructions a pixel of 128 x 64 pixels, 161 of 320 x 240, 88 of 640 x 480;
// 1.7 to 1.9 times that on a Cortex-M0 (src/picture/BRICKS.md, "Frames on a chip"). Stack: 6 KiB
// (tests/budgets/stack.csv), most of it half-planes, colours and the state of a tile. Code: about 48 KB.
//
// Options with which the core is compiled (of a board: BOARD_FRAMES) choose what an image has:
//   THIMBLE_SMALL_FRAMES   no tile is drawn face by face, directions have up to 12 bits (pictures of 160 x
//                          128): 3 KiB of stack and 9 KB of code less. Who reads the number below is compiled
//                          with the same options.
//   THIMBLE_SWEEP_SLOTS    16 (the default), 8 or 4: each halving takes 0.9 KiB of stack away, then 0.4

#ifdef THIMBLE_SMALL_FRAMES
inline constexpr int kMaxBrickDirectionBits = 12;
#else
inline constexpr int kMaxBrickDirectionBits = 15;
#endif
/// Rows of a tile. The rays of a tile start where the first of them may meet something.
inline constexpr int32_t kBrickTilePx = 8;

/// Whether frames of that camera take the fast way: a perspective of the map's level, n <= kMaxBrickDirectionBits
/// direction bits, and an eye less than 2^(23 - n) voxels from every side of the world, and at least 32 less than
/// that from every side of the box of bricks that holds what is solid. In worlds of level 9 and 10, where the core has
/// THIMBLE_DEEP_WORLDS (brick_map.h): an eye at most 2,046 voxels from every side of the world.
bool draws_fast(const BrickMap& map, const Camera& camera);

/// As `render_band` above with `map`, which belongs to `tree`; the counters of nodes stay as they are
/// for rays that read none. Errors, with nothing drawn: those of `render_band`, and kDamaged when the map is
/// another tree's.
Status render_band(const CompactTree& tree, const BrickMap& map, const Camera& camera, const Shading& shading,
                   const Band& band, RenderCounts* counts = nullptr);

/// The same for cameras that `draws_fast` in worlds up to level 8; kBadArgument for others. A firmware that calls this
/// one only has nothing of the 64-bit tracer in its flash and on its stack.
Status render_band_32(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                      const Shading& shading, const Band& band, RenderCounts* counts = nullptr);

// --- Several samples a pixel.

/// Samples a pixel are 1, 4, 9, ... 64: the squares of 1 .. kMaxSamplesAcross.
inline constexpr int kMaxSamplesAcross = 8;
/// Bound on the difference between a channel of a mean and the exact one, in 1/256 of 1/255.
inline constexpr int kSampleMeanErrorQ8 = 128;

/// Bytes of the `across` fine rows, in kRgb888, that make one row of `width_px` pixels; 0 for what
/// `average_samples` refuses.
constexpr size_t samples_bytes(int32_t width_px, int across) {
  if (across < 1 || across > kMaxSamplesAcross || width_px < 0 || width_px > kMaxPicturePx / across) {
    return 0;
  }
  return band_bytes(PixelFormat::kRgb888, width_px * across, across);
}

/// Averages `fine_rows` (kRgb888, samples_bytes(width_px, across), without gaps) into row `y` of the picture
/// and stores it in `row` (row_bytes(format, width_px)), which must not overlap them. Rows that share their
/// bytes (kMono1Pages) are averaged into them from the first down: it clears them. Cost: 3 * across^2
/// additions and three 32-bit divisions a pixel.
/// Errors, with nothing written: kOutOfRange (across, width_px * across beyond kMaxPicturePx), kOutOfMemory
/// (either span too small).
Status average_samples(ConstBytes fine_rows, int across, int32_t width_px, int32_t y, PixelFormat format,
                       Bytes row);

// --- Samples where edges are: which pixels of a picture get more than one, and where in the pixel these lie.
//
// The picture of one sample a pixel says where. A pixel's *strength* is the largest difference, in any
// channel, between it and a pixel that shares a side with it. From kEdgeStrength on it is an edge. Each row
// is cut into segments of kEdgeSegmentPx pixels, and a segment may spend kEdgeSegmentSamples samples (the
// last one of a row its share of them). Its edges get 2 more each while they last, the strongest first and
// among equals the leftmost; then 2 more again. So a row takes at most 1 + 9/8 samples a pixel whatever the
// scene is, and a few edges get more each than many.
//
// The samples of a pixel are its one sample, at the centre, and the first 2 or 4 of four places on a grid of
// 4 x 4 (`edge_sample_place`): pairs that face each other across the centre, no two of the four in one row
// or column, since edges of voxels are often nearly upright or level. The colour is their mean, to the
// nearest. All other pixels are those of the picture of one sample, byte for byte.
//
// A pixel's samples are thus a function of its row and of the rows above and below it, in integers: whatever
// engine draws them, bands of any height and parts of a picture come out the same, if the rows next to a
// band are drawn for it too. What no ray of the picture of one sample meets, and what differs by less than
// kEdgeStrength, is not found: thin lines and lone points between the centres want samples in each pixel.
//
//     Camera fine;   // the same view, kEdgeGrid * width x kEdgeGrid * height pixels
//     edge_strengths(above, row, below, 3, width, strengths);     // three rows of one sample a pixel
//     place_edge_samples(strengths, width, samples);
//     for (int32_t x = 0; x < width; ++x) {
//       for (int i = 0; i < samples[x]; ++i) {
//         render_band(tree, edge_sample_row(fine, x, y, 1, i), shading, one_pixel);   // adds it up
//       }
//     }

/// Least difference of a channel that is an edge, in steps of 1/255.
inline constexpr int kEdgeStrength = 16;
/// Samples are placed on a grid of so many places across a pixel.
inline constexpr int kEdgeGrid = 4;
/// Pixels of a row that share samples, counted from its left end, and the samples that they share beside one
/// each. A last segment of n pixels has kEdgeSegmentSamples * n / kEdgeSegmentPx, rounded down.
inline constexpr int32_t kEdgeSegmentPx = 64;
inline constexpr int kEdgeSegmentSamples = 72;
/// Samples of a pixel, beside its one, are none, 2 or 4.
inline constexpr int kMostEdgeSamples = 4;

/// Strengths of the pixels of a row: `channels` bytes a pixel (3 for kRgb888, 1 for greys, 4 with a share of
/// cover), `width_px` pixels a row without gaps; `above` or `below` is empty at the picture's rim. `strengths`
/// gets a byte a pixel. Cost: some 30 instructions a byte at most.
/// Errors, with nothing written: kBadArgument (channels not 1 to 4), kOutOfRange (width below 0 or beyond
/// kMaxPicturePx), kOutOfMemory (any span too small).
Status edge_strengths(ConstBytes above, ConstBytes row, ConstBytes below, int channels, int32_t width_px,
                      Bytes strengths);

/// Says for each pixel of a row of such strengths how many samples it gets beside its one: 0, 2 or 4, a byte
/// each. `samples` may be the bytes of `strengths`. Cost: some 20 instructions a pixel in a segment
/// without edges, at most 150.
/// Errors as above.
Status place_edge_samples(ConstBytes strengths, int32_t width_px, Bytes samples);

/// Where in the pixel sample `index` (0 .. kMostEdgeSamples - 1) lies: the place of the grid, x to the right
/// and y down, whose middle is ((x + 1/2) / kEdgeGrid, (y + 1/2) / kEdgeGrid).
struct EdgeSamplePlace {
  uint8_t x = 0;
  uint8_t y = 0;
};
constexpr EdgeSamplePlace edge_sample_place(int index) {
  constexpr EdgeSamplePlace kPlaces[kMostEdgeSamples] = {{1, 0}, {2, 3}, {3, 1}, {0, 2}};
  return kPlaces[index];
}

/// A camera of one row: sample `index` of the pixels (px .. px + count - 1, py) of the picture, whose camera
/// with kEdgeGrid times the pixels each way is `fine`.
inline Camera edge_sample_row(const Camera& fine, int32_t px, int32_t py, int32_t count, int index) {
  const EdgeSamplePlace place = edge_sample_place(index);
  return fine.window(px * kEdgeGrid + place.x, py * kEdgeGrid + place.y, (count - 1) * kEdgeGrid + 1, 1)
      .thinned(kEdgeGrid);
}

/// The mean of a channel of `count` samples (at least 1), to the nearest, halves up.
constexpr uint8_t mean_of_samples(uint32_t sum, uint32_t count) {
  return static_cast<uint8_t>((2 * sum + count) / (2 * count));
}

}  // namespace thimble

#endif
