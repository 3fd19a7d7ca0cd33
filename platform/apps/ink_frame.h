/// Frames in ink (picture/ink.h), where the display is of one bit and the arena holds the two pictures that they are made
/// from. Programs for other displays have nothing of it: THIMBLE_INK.
#pragma once

#include <stddef.h>

#include "apps/band_turns.h"
#include "thimble/base/memory.h"
#include "thimble/picture/ink.h"
#include "thimble/picture/render.h"

namespace thimble::apps {

#if defined(THIMBLE_INK)
struct InkFrame {
  InkPicture picture;
  bool is_there = false;

  void take(Arena* arena) {
    const port::Display& screen = display();
    const size_t bytes = ink_bytes(screen.width_px, screen.height_px);
    is_there =
        bits_per_pixel(screen.format) == 1 && bytes <= arena->free_bytes() / 2 &&
        InkPicture::make(screen.width_px, screen.height_px, arena->take(bytes), &picture) == Status::kOk;
  }

  /// Draws what bands are taken from: `draw_tones(band)`, then `draw_plain(shading, band)` for the depths.
  template <class DrawTones, class DrawPlain>
  Status draw(const Camera& camera, const VoxelBox& bounds, DrawTones draw_tones, DrawPlain draw_plain) {
    Status status = draw_tones(picture.tones());
    if (status == Status::kOk) {
      Shading depths;
      const DepthRange range = depth_range(camera, bounds);
      depths.near_q8 = range.near_q8;
      depths.far_q8 = range.far_q8;
      status = draw_plain(depths, picture.depths());
    }
    if (status == Status::kOk) {
      picture.finish();
    }
    return status;
  }

  Status store(const Band& band) const { return picture.store(band); }
};
#else
struct InkFrame {
  static constexpr bool is_there = false;

  void take(Arena* /*arena*/) {}
  template <class DrawTones, class DrawPlain>
  Status draw(const Camera& /*camera*/, const VoxelBox& /*bounds*/, DrawTones /*tones*/,
              DrawPlain /*plain*/) {
    return Status::kOk;
  }
  Status store(const Band& /*band*/) const { return Status::kOk; }
};
#endif

}  // namespace thimble::apps
