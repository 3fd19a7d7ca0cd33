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

// Goes through pixels of kBytes each, row by row, from right to left: the pixels of a row are the upper bits of a word,
// which are shifted out. `begin(end, row)` gets the end of a row and its number in the tile; `four(to)` stores four
// pixels side by side where `fours(to)` allows that, `one(to)` a single one.
template <size_t kBytes, class Row, class Fours, class Four, class One>
[[gnu::always_inline]] inline void store_runs(const TilePlace& place, const Pixels& pixels, const Row& begin,
                                              const Fours& fours, const Four& four, const One& one) {
  uint8_t* end = place.line + static_cast<size_t>(place.x + kTileAcrossPx) * kBytes;
  for (int i = 0; i < kTileWords; ++i) {
    uint32_t word = pixels.word[i];
    if (word == 0) {
      end += 2 * place.stride;
      continue;
    }
    for (int half = 0; half < 2; ++half, word >>= 16, end += place.stride) {
      uint32_t row = word << 16;
      if (row == 0) {
        continue;
      }
      begin(end, 2 * i + half);
      for (uint8_t* to = end; row != 0;) {
        if constexpr (bits::kCountsZeros) {
          const int none = 31 - bits::highest_bit(row);
          row <<= none;
          to -= static_cast<size_t>(none) * kBytes;
        } else {
          for (; row >> 28 == 0; row <<= 4) {
            to -= 4 * kBytes;
          }
          for (; row >> 31 == 0; row <<= 1) {
            to -= kBytes;
          }
        }
        for (; row >= 15U << 28 && fours(to); row <<= 4) {
          to -= 4 * kBytes;
          four(to);
        }
        for (; row >> 31 != 0; row <<= 1) {
          to -= kBytes;
          one(to);
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
  store_runs<sizeof(Pixel)>(
      place, pixels, [](const uint8_t*, int) {}, [](const uint8_t*) { return !kFastRam; },
      [&](uint8_t* to) {
        pixel(to)[0] = value;
        pixel(to)[1] = value;
        pixel(to)[2] = value;
        pixel(to)[3] = value;
      },
      [&](uint8_t* to) { *pixel(to) = value; });
}

// Stores pixels of three bytes; four of them by words, where these are aligned.
[[gnu::noinline]] void store_triples(const TilePlace& place, const Pixels& pixels, uint32_t ink) {
  const uint32_t four[3] = {bits::little(ink | ink << 24), bits::little(ink >> 8 | ink << 16),
                            bits::little(ink >> 16 | ink << 8)};
  store_runs<3>(
      place, pixels, [](const uint8_t*, int) {},
      [](const uint8_t* to) { return (reinterpret_cast<size_t>(to) & 3U) == 0; },
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
