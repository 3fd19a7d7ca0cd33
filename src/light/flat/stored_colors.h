// Colours as they are stored, and the dither. Internal to src/.
#pragma once

#include "../../picture/bricks/tile_store.h"
#include "../../picture/panels.h"
#include "../exposure.h"
#include "thimble/light/render.h"

namespace thimble::lit {
namespace {

using namespace bricks;

// How a colour becomes a format's pixel.
enum class Storing : uint8_t { kNibbles, kBits, kHalfwords, kBytes, kAny };

Storing storing_of(PixelFormat format) {
  return format == PixelFormat::kGray4                                     ? Storing::kNibbles
         : format == PixelFormat::kMono1                                   ? Storing::kBits
         : is_halfword(format)                                             ? Storing::kHalfwords
         : format == PixelFormat::kGray8 || format == PixelFormat::kRgb888 ? Storing::kBytes
                                                                           : Storing::kAny;
}

// By a pixel's place in the dither: the least rest of a channel, out of kWhite, at which the next step is stored.
struct Thresholds {
  uint16_t at[64];
};
constexpr Thresholds thresholds() {
  Thresholds result{};
  for (int32_t i = 0; i < 64; ++i) {
    result.at[i] = static_cast<uint16_t>(kWhite - (128 - (2 * bayer_rank(i & 7, i >> 3) + 1)) * kWhite / 128);
  }
  return result;
}
constexpr Thresholds kDither = thresholds();

// A colour as it is stored. kNibbles, kBits: the step below it, and the rest, out of kWhite. kHalfwords: the pixel of the
// steps below it, and each channel's rest. kBytes: the pixel. kAny: the colour itself.
struct FlatInk {
  uint32_t low;
  uint16_t rest[3];
  uint16_t key;
};

uint8_t* line_of(const Band& band, size_t stride, int32_t y) {
  return band.pixels.data + stride * row_place(band.format, y - band.first_row);
}

// Stores the pixels of a band. What depends on no set of effects, once in an image.
class StoredPixels {
 protected:
  StoredPixels(const Frame& frame, const Band& band, size_t stride)
      : frame_(frame), band_(band), stride_(stride), storing_(storing_of(band.format)) {
    is_whole_ =
        storing_ == Storing::kHalfwords && ((reinterpret_cast<size_t>(band.pixels.data) | stride) & 1U) == 0;
  }

  uint8_t* line_of(int32_t y) const { return lit::line_of(band_, stride_, y); }
  static uint32_t count_of(const Pixels& pixels) {
    uint32_t count = 0;
    for (const uint32_t word : pixels.word) {
      count += bits::popcount32(word);
    }
    return count;
  }
  // Calls `call(x, y, pixel)` for pixels of the band's part of a tile.
  template <class Call>
  static void for_each(const TilePlace& place, const Pixels& pixels, const Call& call) {
    for (uint32_t i = 0; i < kTileWords; ++i) {
      for (uint32_t word = pixels.word[i]; word != 0; word &= word - 1) {
        const uint32_t pixel = 32 * i + bits::lowest_bit(word);
        call(place.x + static_cast<int32_t>(pixel % kTileAcrossPx),
             place.y + static_cast<int32_t>(pixel / kTileAcrossPx), pixel);
      }
    }
  }

  [[gnu::noinline]] void make_ink(const Color& color, FlatInk* ink) const {
    if (storing_ == Storing::kAny) {
      for (int i = 0; i < 3; ++i) {
        ink->rest[i] = static_cast<uint16_t>(color.c[i] < kMaxChannel ? color.c[i] : kMaxChannel);
      }
      return;
    }
    uint32_t channel[3];
    expose(color, &channel);
    ink->low = 0;
    if (storing_ == Storing::kBytes) {
      const Rgb8 stored = in_8_bits(channel);
      ink->low = band_.format == PixelFormat::kGray8
                     ? uint32_t{gray_of(stored)}
                     : uint32_t{stored.r} | uint32_t{stored.g} << 8 | uint32_t{stored.b} << 16;
      return;
    }
    const bool is_gray = storing_ <= Storing::kBits;
    if (is_gray) {
      channel[0] = (77 * channel[0] + 150 * channel[1] + 29 * channel[2]) >> 8;
    }
    // Without dither the nearest step is stored, and no rest is left.
    const bool dithers = frame_.options.dither;
    for (int i = 0; i < (is_gray ? 1 : 3); ++i) {
      const uint32_t levels = !is_gray ? (i == 1 ? 63 : 31) : storing_ == Storing::kNibbles ? 15 : 1;
      const uint32_t value = channel[is_format<PixelFormat::kBgr565>(band_.format) ? 2 - i : i] * levels +
                             (dithers ? 0 : kWhite / 2);
      ink->low |= value / kWhite << (is_gray || i == 2 ? 0 : i == 1 ? 5 : 11);
      ink->rest[i] = dithers ? static_cast<uint16_t>(value % kWhite) : 0;
    }
  }

  // The pixel of a halfword where the next step is stored from `limit` on.
  [[gnu::always_inline]] static uint32_t halfword(const FlatInk& ink, uint32_t limit, bool swaps) {
    const uint32_t value = ink.low + (ink.rest[0] >= limit ? 1U << 11 : 0U) +
                           (ink.rest[1] >= limit ? 1U << 5 : 0U) + (ink.rest[2] >= limit ? 1U : 0U);
    return swaps ? value >> 8 | value << 8 : value;
  }

  [[gnu::always_inline]] void store(int32_t x, int32_t y, const FlatInk& ink) {
    uint8_t* line = line_of(y);
    const uint32_t limit = kDither.at[(y & 7) << 3 | (x & 7)];
    const uint32_t step = ink.low + (ink.rest[0] >= limit ? 1U : 0U);  // of a grey
    if (storing_ == Storing::kNibbles) {
      line[x >> 1] = static_cast<uint8_t>(line[x >> 1] | step << ((x & 1) != 0 ? 0 : 4));
    } else if (storing_ == Storing::kBits) {
      line[x >> 3] = static_cast<uint8_t>(line[x >> 3] | step << (7 - (x & 7)));
    } else {
      store_color(line, x, y, limit, ink);
    }
  }

  // Stores an ink in the pixels of a tile that a mask selects.
  [[gnu::noinline]] void store(const TilePlace& place, const Pixels& pixels, const FlatInk& ink) {
    if (storing_ == Storing::kBytes) {
      const TilePlace bytes{line_of(place.y), stride_, place.x, place.y, place.across, place.down};
      if (band_.format == PixelFormat::kRgb888) {
        store_triples(bytes, pixels, ink.low);
      } else {
        store_whole<uint8_t>(bytes, pixels, ink.low);
      }
      return;
    }
    if (!is_whole_) {
      for_each(place, pixels, [&](int32_t x, int32_t y, uint32_t) { store(x, y, ink); });
      return;
    }
    const FlatInk own = ink;
    const bool swaps = is_big_endian() != bits::kBigEndian;
    const TilePlace halves{line_of(place.y), stride_, place.x, place.y, place.across, place.down};
    const uint8_t* row_end = nullptr;
    const uint16_t* limits = nullptr;
    store_runs<sizeof(Half)>(
        halves, pixels,
        [&](const uint8_t* end, int row) {
          row_end = end;
          limits = kDither.at + ((place.y + row) & 7) * 8;
        },
        [](const uint8_t*) { return false; }, [](uint8_t*) {},
        [&](uint8_t* to) {
          // A row ends at a multiple of eight columns.
          const uint32_t limit = limits[static_cast<size_t>(to - row_end) / 2 & 7];
          *static_cast<Half*>(static_cast<void*>(to)) = static_cast<Half>(halfword(own, limit, swaps));
        });
  }

  bool is_big_endian() const { return is_format<PixelFormat::kRgb565Be>(band_.format); }

  // Not inlined, since pixels of these formats are seldom drawn one by one.
  [[gnu::noinline]] void store_color(uint8_t* line, int32_t x, int32_t y, uint32_t limit,
                                     const FlatInk& ink) const {
    if (storing_ == Storing::kAny) {
      lit::store(frame_, band_, line, x, y, Color{{ink.rest[0], ink.rest[1], ink.rest[2]}});
    } else {
      store_ink(line, x, y, band_.format,
                storing_ == Storing::kHalfwords ? halfword(ink, limit, is_big_endian()) : ink.low);
    }
  }

  const Frame& frame_;
  const Band& band_;

 private:
  size_t stride_;
  Storing storing_;
  bool is_whole_;  // halfwords may be stored as such
};

}  // namespace
}  // namespace thimble::lit
