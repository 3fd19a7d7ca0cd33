/// @file samples.h
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
#ifndef THIMBLE_SAMPLES_H
#define THIMBLE_SAMPLES_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/pixel.h"
#include "thimble/render.h"
#include "thimble/span.h"
#include "thimble/status.h"

namespace thimble {

/// Samples a pixel are 1, 4, 9, ... 64: the squares of 1 .. kMaxSamplesAcross.
inline constexpr int kMaxSamplesAcross = 8;
/// Bound on the difference between a channel of a mean and the exact one, in 1/256 of 1/255.
inline constexpr int kSampleMeanErrorQ8 = 128;

/// Bytes of the `across` fine rows, in kRgb888, that make one row of `width_px` pixels; SIZE_MAX when size_t
/// cannot say it.
constexpr size_t samples_bytes(int32_t width_px, int across) {
  return band_bytes(PixelFormat::kRgb888, width_px * across, across);
}

/// Averages `fine_rows` (kRgb888, samples_bytes(width_px, across), without gaps) into row `y` of the picture
/// and stores it in `row` (row_bytes(format, width_px)), which must not overlap them. Cost: 3 * across^2
/// additions and three 32-bit divisions a pixel.
/// Errors, with nothing written: kOutOfRange (across, width_px * across beyond kMaxPicturePx), kOutOfMemory
/// (either span too small).
Status average_samples(ConstBytes fine_rows, int across, int32_t width_px, int32_t y, PixelFormat format,
                       Bytes row);

}  // namespace thimble

#endif
