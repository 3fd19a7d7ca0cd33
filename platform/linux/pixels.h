/// From the pixels of a band to those of a Linux framebuffer: any depth, any order of the channels, any
/// stride.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"

namespace thimble::linux_port {

/// Where a channel lies in a pixel: `length` bits from bit `offset` on.
struct Channel {
  uint32_t offset = 0;
  uint32_t length = 0;
};

/// What the bytes of a framebuffer mean (`fb_var_screeninfo` and `fb_fix_screeninfo` say the same in more
/// words).
struct Layout {
  int32_t width_px = 0;
  int32_t height_px = 0;
  size_t stride_bytes = 0;  ///< from one row to the next; may be odd, may be more than the pixels need
  int32_t bits_per_pixel = 0;
  Channel red;
  Channel green;
  Channel blue;

  size_t bytes() const { return stride_bytes * static_cast<size_t>(height_px); }
};

/// The usual order of channels for 16 (5-6-5), 24 or 32 bits a pixel (8-8-8, blue lowest).
Layout usual_layout(int32_t width_px, int32_t height_px, size_t stride_bytes, int32_t bits_per_pixel);

/// Null, or why pixels cannot be written in this layout, in a few words.
const char* fault_of(const Layout& layout);

/// Where a small picture lies on the screen: magnified by a whole number, in the middle.
struct Placement {
  int32_t left_px = 0;
  int32_t top_px = 0;
  int32_t scale = 1;
};
/// The largest whole magnification of a picture that fits, in the middle. Scale 0 where it does not fit at
/// all.
Placement place(int32_t picture_width_px, int32_t picture_height_px, const Layout& screen);

/// Draws a band of a picture `width_px` wide into `screen` (layout.bytes() of them). Bytes outside the
/// picture, the stride's slack among them, are not touched.
void put_band(const Band& band, int32_t width_px, const Layout& layout, const Placement& placement,
              Bytes screen);

}  // namespace thimble::linux_port
