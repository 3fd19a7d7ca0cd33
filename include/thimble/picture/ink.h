/// @file ink.h
/// Ink: a picture for displays of one bit, where a dither over everything leaves nothing to be recognised.
///
/// Black stands behind the scene. Its faces are black, a checker or white, by what is dark, between and bright in
/// this picture; lines in white go round what stands before black, and round what stands before something else in
/// the same picture. No pattern changes within a face.
///
/// Whatever draws bands draws the two pictures that ink is made from, in 8 bits a pixel: tones (any shading, any
/// light; black behind) and depths (ShadeMode::kDepth), which say where something stands before something else.
///
///     InkPicture ink;                                   // works in `memory`: ink_bytes(width, height)
///     InkPicture::make(width, height, memory, &ink);
///     render_band(tree, camera, tones, ink.tones());
///     render_band(tree, camera, depths, ink.depths());  // mode kDepth, near and far of depth_range()
///     ink.finish();
///     ink.store(band);                                  // any format, in bands of any height
///
/// Integers alone; each pixel depends on both pictures, not on how they were drawn.
#ifndef THIMBLE_PICTURE_INK_H
#define THIMBLE_PICTURE_INK_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "pixel.h"
#include "render.h"

namespace thimble {

/// Bytes that an ink picture works in: two bytes a pixel, and two rows. 128 x 64: 16,640. SIZE_MAX when size_t
/// cannot say it.
constexpr size_t ink_bytes(int32_t width_px, int32_t height_px) {
  return width_px > 0 && height_px > 0 && band_bytes(PixelFormat::kGray8, width_px, height_px) < SIZE_MAX / 4
             ? 2 * band_bytes(PixelFormat::kGray8, width_px, height_px) + 2 * static_cast<size_t>(width_px)
             : SIZE_MAX;
}

class InkPicture {
 public:
  /// `memory` (any alignment) outlives the picture's use. Sides are 1 .. kMaxPicturePx.
  /// Errors, with nothing changed: kBadArgument (sides), kOutOfMemory.
  static Status make(int32_t width_px, int32_t height_px, Bytes memory, InkPicture* ink);

  /// Where the two pictures are drawn, all rows of both.
  Band tones() const { return {tones_, PixelFormat::kGray8, 0, 0, height_px_}; }
  Band depths() const { return {depths_, PixelFormat::kGray8, 0, 0, height_px_}; }

  /// Makes patterns of the tones, once both pictures are drawn and before `store`. Cost: four passes over the
  /// picture with 9 pixels each, and 500 64-bit divisions.
  void finish();

  /// Stores black and white in the band's rows, after `finish`.
  /// Errors, with nothing stored: kBadArgument (rows outside the picture or no multiple of `band_row_multiple`,
  /// stride too small), kOutOfMemory (pixels too small).
  Status store(const Band& band) const;

 private:
  bool is_white(int32_t x, int32_t y) const;
  int jump(const uint8_t* depth, ptrdiff_t towards, int32_t before, int32_t after) const;
  template <class Filter>
  void pass(Filter filter);

  Bytes tones_;
  Bytes depths_;
  Bytes rows_;
  int32_t width_px_ = 0;
  int32_t height_px_ = 0;
  int least_jump_ = 0;  ///< of depth, in greys, where one thing stands before another
};

}  // namespace thimble

#endif
