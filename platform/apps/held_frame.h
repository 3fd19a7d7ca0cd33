/// What it takes to hold a rate of frames: while the camera moves a frame gets no more work than there is
/// time for, and when it stands still it becomes exact.
///
/// The work depends on the board's facts and the rate alone, never on a clock, so that the pictures are the
/// same on the board and in the simulator. Two ways, whichever serves better:
///   - rays through a tree: an any-time frame (thimble/picture/anytime.h) of so many node visits;
///   - with a brick map, a thirteenth of the instructions a pixel: the thinned camera's picture, every 2nd to
///     8th pixel both ways by the map, each as a square; the exact picture when the camera stands still.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "apps/place.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/render.h"

namespace thimble::apps {

#ifdef THIMBLE_NO_HOLD
inline constexpr bool kCanHold = false;
#else
inline constexpr bool kCanHold = true;
#endif

/// The rate where nothing else was said.
inline constexpr uint32_t kHoldFps = 30;
/// The coarsest thinned picture.
inline constexpr int32_t kMostThinned = 8;

struct HeldFrame : Placed {
  AnytimeFrame frame;
  Bytes frame_bytes;
  Camera thin_camera;
  Bytes thin_bytes;  ///< kBrickTilePx rows of the thinned picture
};

/// Whether this board can: its rays have been counted.
inline bool can_hold() {
  return kCanHold && port::facts().visits_a_second != 0;
}

inline uint32_t display_pixels() {
  const port::Display& screen = port::facts().display;
  return static_cast<uint32_t>(screen.width_px) * static_cast<uint32_t>(screen.height_px);
}

/// Node visits for a frame: what the rate leaves, less what clearing, flushing and the camera take, a
/// sixteenth of a visit a pixel; where the rate is beyond the board, that much at least.
inline uint32_t visits_a_frame(uint32_t fps) {
  const uint32_t other = display_pixels() / 16;
  const uint32_t visits = port::facts().visits_a_second / fps;
  return visits > 2 * other ? visits - other : other;
}
/// The same for a tree in a pool, whose visits take more: children there are chains. While it is being built
/// that takes time too, and the first rays, which read little, are mostly set-up.
constexpr uint32_t pool_visits(uint32_t visits, bool is_growing) {
  return is_growing ? visits / 3 : visits * 5 / 8;
}

/// The least thinning whose rays through the brick map the rate leaves time for, less what squares, flushing
/// and the camera take, a 64th of a ray a pixel.
inline int32_t thinning_for(uint32_t fps) {
  const port::Display& screen = port::facts().display;
  const uint32_t rays = port::facts().map_rays_a_second / fps;
  const uint32_t other = display_pixels() / 64;
  for (int32_t step = 1; step < kMostThinned; ++step) {
    const int32_t columns = (screen.width_px + step - 1) / step;
    const int32_t rows = (screen.height_px + step - 1) / step;
    if (static_cast<uint32_t>(columns * rows) + other <= rays) {
      return step;
    }
  }
  return kMostThinned;
}

/// Bytes of a pixel that is widened as it is, a row for all rows of its square, where pictures are large: a fiftieth
/// of the time. 0: each pixel is stored by itself.
inline size_t widened_bytes(PixelFormat format) {
  if (kMaxBrickDirectionBits <= 12) {
    return 0;
  }
  if (format == PixelFormat::kRgb888) {
    return 3;
  }
  return format == PixelFormat::kRgb565 || format == PixelFormat::kRgb565Be || format == PixelFormat::kBgr565
             ? 2
             : 0;
}

/// The format of a thinned picture, from which the display's pixels follow exactly.
inline PixelFormat thin_format(PixelFormat format) {
  if (is_gray(format)) {
    return PixelFormat::kGray8;
  }
  if (widened_bytes(format) != 0) {
    return format;
  }
  if (!kHasPanelFormats || format <= PixelFormat::kRgb888) {
    return format;
  }
  return format == PixelFormat::kRgb565Be || format == PixelFormat::kBgr565 ? PixelFormat::kRgb565
                                                                            : PixelFormat::kRgb888;
}

/// Takes what holding needs; null, and nothing taken, where the arena does not have it.
[[gnu::noinline]] inline HeldFrame* place_held_frame(Arena* arena) {
  const port::Display& screen = port::facts().display;
  const size_t mark = arena->used_bytes();
  HeldFrame* const held = place<HeldFrame>(arena);
  if (held == nullptr) {
    return nullptr;
  }
  held->frame_bytes = arena->take(anytime_bytes(screen.width_px, screen.height_px, screen.format));
  held->thin_bytes =
      arena->take(band_bytes(thin_format(screen.format), (screen.width_px + 1) / 2, kBrickTilePx));
  if (held->frame_bytes.empty() || held->thin_bytes.empty()) {
    arena->rewind(mark);
    return nullptr;
  }
  return held;
}

/// The colour of a stored pixel of a thinned picture.
inline Rgb8 thin_color(const uint8_t* row, int32_t x, PixelFormat format) {
  const auto column = static_cast<size_t>(x);
  if (format == PixelFormat::kGray8) {
    return {row[column], row[column], row[column]};
  }
  if (format == PixelFormat::kRgb565) {
    const unsigned packed = row[2 * column] | static_cast<unsigned>(row[2 * column + 1]) << 8;
    return {static_cast<uint8_t>(packed >> 8 & 0xF8U), static_cast<uint8_t>(packed >> 3 & 0xFCU),
            static_cast<uint8_t>(packed << 3 & 0xF8U)};
  }
  return {row[3 * column], row[3 * column + 1], row[3 * column + 2]};
}

/// Each pixel of kBytes, aligned to kAlignment, `step` times, until the row has `width`.
template <size_t kBytes, size_t kAlignment>
[[gnu::noinline, gnu::hot]] void widen_pixels(const uint8_t* thin, int32_t step, int32_t width,
                                              uint8_t* row) {
  for (int32_t x = 0; x < width; thin += kBytes) {
    uint8_t pixel[kBytes];
    __builtin_memcpy(pixel, __builtin_assume_aligned(thin, kAlignment), kBytes);
    const int32_t end = x + step < width ? x + step : width;
    if constexpr (kBytes == 2) {
      // Two at a time, in words.
      uint16_t one = 0;
      __builtin_memcpy(&one, pixel, 2);
      const uint32_t two = one | static_cast<uint32_t>(one) << 16;
      if ((reinterpret_cast<uintptr_t>(row) & 2U) != 0) {
        __builtin_memcpy(__builtin_assume_aligned(row, 2), &one, 2);
        row += 2;
        ++x;
      }
      for (; x + 1 < end; x += 2, row += 4) {
        __builtin_memcpy(__builtin_assume_aligned(row, 4), &two, 4);
      }
      if (x < end) {
        __builtin_memcpy(__builtin_assume_aligned(row, 2), &one, 2);
        row += 2;
        ++x;
      }
    } else {
      for (; x < end; ++x) {
        __builtin_memcpy(__builtin_assume_aligned(row, kAlignment), pixel, kBytes);
        row += kBytes;
      }
    }
  }
}

/// Row `y` of the display from row y / step of the thinned picture; rows that share bytes from the first down.
[[gnu::noinline]] inline void widen_row(const uint8_t* thin, PixelFormat from, int32_t step, int32_t y,
                                        uint8_t* row) {
  const port::Display& screen = port::facts().display;
  switch (widened_bytes(from)) {
    case 2:
      return widen_pixels<2, 2>(thin, step, screen.width_px, row);
    case 3:
      return widen_pixels<3, 1>(thin, step, screen.width_px, row);
    default:
      break;
  }
  const size_t bytes = begins_bytes(screen.format, y) ? row_bytes(screen.format, screen.width_px) : 0;
  for (size_t i = 0; i < bytes; ++i) {
    row[i] = 0;
  }
  for (int32_t x = 0; x < screen.width_px;) {
    const Rgb8 color = thin_color(thin, x / step, from);
    for (const int32_t end = x + step < screen.width_px ? x + step : screen.width_px; x < end; ++x) {
      store_pixel(row, x, y, screen.format, color);
    }
  }
}

}  // namespace thimble::apps
