/// @file edge_samples.h
/// Samples where edges are: which pixels of a picture get more than one, and where in the pixel these lie.
///
/// The picture of one sample a pixel says where. A pixel's *strength* is the largest difference, in any
/// channel, between it and a pixel that shares a side with it. From kEdgeStrength on it is an edge. Each row
/// is cut into segments of kEdgeSegmentPx pixels, and a segment may spend kEdgeSegmentSamples samples (the
/// last one of a row its share of them). Its edges get 2 more each while they last, the strongest first and
/// among equals the leftmost; then 2 more again. So a row takes at most 1 + 9/8 samples a pixel whatever the
/// scene is, and a few edges get more each than many.
///
/// The samples of a pixel are its one sample, at the centre, and the first 2 or 4 of four places on a grid of
/// 4 x 4 (`edge_sample_place`): pairs that face each other across the centre, no two of the four in one row
/// or column, since edges of voxels are often nearly upright or level. The colour is their mean, to the
/// nearest. All other pixels are those of the picture of one sample, byte for byte.
///
/// A pixel's samples are thus a function of its row and of the rows above and below it, in integers: whatever
/// engine draws them, bands of any height and parts of a picture come out the same, if the rows next to a
/// band are drawn for it too. What no ray of the picture of one sample meets, and what differs by less than
/// kEdgeStrength, is not found: thin lines and lone points between the centres want samples in each pixel
/// (render.h).
///
///     Camera fine;   // the same view, kEdgeGrid * width x kEdgeGrid * height pixels
///     edge_strengths(above, row, below, 3, width, strengths);     // three rows of one sample a pixel
///     place_edge_samples(strengths, width, samples);
///     for (int32_t x = 0; x < width; ++x) {
///       for (int i = 0; i < samples[x]; ++i) {
///         render_band(tree, edge_sample_row(fine, x, y, 1, i), shading, one_pixel);   // adds it up
///       }
///     }
#ifndef THIMBLE_PICTURE_EDGE_SAMPLES_H
#define THIMBLE_PICTURE_EDGE_SAMPLES_H

#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "camera.h"

namespace thimble {

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
