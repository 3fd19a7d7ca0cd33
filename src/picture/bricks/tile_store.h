// Stores one ink in the pixels of a tile that a mask selects. Internal to src/.
#pragma once

#include "half_plane.h"
#include "inks.h"

namespace thimble::bricks {
namespace {

// Where a tile's pixels are stored.
struct TilePlace {
  uint8_t* line;  // of the tile's first row
  size_t stride;
  int32_t x;
  int32_t y;
  int32_t across;
  int32_t down;
};

// Clears a tile of kGray4.
[[maybe_unused]] void clear(const TilePlace& place) {
  uint8_t* line = place.line;
  for (int32_t y = 0; y < place.down; ++y, line += place.stride) {
    for (int32_t x = place.x >> 1; x < (place.x + place.across + 1) >> 1; ++x) {
      line[x] = 0;
    }
  }
}

// Goes through pixels of kBytes each, four of a row at a time: `four(to)` stores all four, where `whole` are set, `one(to)`
// a single one.
template <size_t kBytes, class Four, class One>
[[gnu::always_inline]] inline void store_fours(const TilePlace& place, const Pixels& pixels, uint32_t whole,
                                               const Four& four, const One& one) {
  uint8_t* line = place.line + static_cast<size_t>(place.x) * kBytes;
  for (int i = 0; i < kTileWords; ++i) {
    uint32_t word = pixels.word[i];
    if (word == 0) {
      line += 2 * place.stride;
      continue;
    }
    for (int half = 0; half < 2; ++half, word >>= 16, line += place.stride) {
      uint32_t row = word & 0xFFFFU;
      if (row == 0) {
        continue;
      }
      uint8_t* to = line;
      for (; (row & 15U) == 0; row >>= 4) {
        to += 4 * kBytes;
      }
      for (; row != 0; row >>= 4, to += 4 * kBytes) {
        if ((row & 15U) == whole) {
          four(to);
          continue;
        }
        if ((row & 1U) != 0) {
          one(to);
        }
        if ((row & 2U) != 0) {
          one(to + kBytes);
        }
        if ((row & 4U) != 0) {
          one(to + 2 * kBytes);
        }
        if ((row & 8U) != 0) {
          one(to + 3 * kBytes);
        }
      }
    }
  }
}

// Stores pixels of one or two bytes each.
template <class Pixel>
[[gnu::noinline, THIMBLE_HOT]] void store_whole(const TilePlace& place, const Pixels& pixels, uint32_t ink) {
  const Pixel value = bits::little(static_cast<Pixel>(ink));
  const auto pixel = [](uint8_t* to) { return static_cast<Pixel*>(static_cast<void*>(to)); };
  store_fours<sizeof(Pixel)>(
      place, pixels, kFastRam ? 16 : 15,
      [&](uint8_t* to) {
        pixel(to)[0] = value;
        pixel(to)[1] = value;
        pixel(to)[2] = value;
        pixel(to)[3] = value;
      },
      [&](uint8_t* to) { *pixel(to) = value; });
}

// Stores pixels of three bytes.
[[gnu::noinline]] void store_triples(const TilePlace& place, const Pixels& pixels, uint32_t ink) {
  const uint32_t four[3] = {bits::little(ink | ink << 24), bits::little(ink >> 8 | ink << 16),
                            bits::little(ink >> 16 | ink << 8)};
  // Four pixels of a row are stored by words, where these are aligned.
  const bool aligned =
      ((reinterpret_cast<size_t>(place.line + 3 * static_cast<size_t>(place.x)) | place.stride) & 3U) == 0;
  store_fours<3>(
      place, pixels, aligned ? 15 : 16,
      [&](uint8_t* to) {
        Word* const whole = static_cast<Word*>(static_cast<void*>(to));
        whole[0] = four[0];
        whole[1] = four[1];
        whole[2] = four[2];
      },
      [ink](uint8_t* to) {
        to[0] = static_cast<uint8_t>(ink);
        to[1] = static_cast<uint8_t>(ink >> 8);
        to[2] = static_cast<uint8_t>(ink >> 16);
      });
}

// Stores pixels of any format; pixels of less than a byte have been cleared.
[[gnu::noinline]] void store_any(const TilePlace& place, const Pixels& pixels, PixelFormat format,
                                 uint32_t ink) {
  uint8_t* line = place.line;
  for (int row = 0; row < kTileDownPx; ++row, line += place.stride) {
    uint32_t bits = pixels.word[row >> 1] >> 16 * (row & 1) & 0xFFFFU;
    for (int32_t x = place.x; bits != 0; bits >>= 1, ++x) {
      if ((bits & 1U) != 0) {
        store_ink(line, x, place.y + row, format, ink);
      }
    }
  }
}

[[gnu::noinline, maybe_unused, THIMBLE_HOT]] void store_pixels(const TilePlace& place, const Pixels& pixels,
                                                               const BrickFrame& frame, uint32_t ink) {
  if (frame.halfwords) {
    store_whole<Half>(place, pixels, ink);
  } else if (is_byte(frame.format)) {
    store_whole<uint8_t>(place, pixels, ink);
  } else if (frame.format == PixelFormat::kRgb888) {
    store_triples(place, pixels, ink);
  } else {
    store_any(place, pixels, frame.format, ink);
  }
}

}  // namespace
}  // namespace thimble::bricks
