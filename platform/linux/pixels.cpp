#include "linux/pixels.h"

#include <string.h>

namespace thimble::linux_port {
namespace {

// 8 bits to `length` bits, rounded to the nearest.
uint32_t narrowed(uint8_t value, uint32_t length) {
  const uint32_t most = (uint32_t{1} << length) - 1;
  return (value * most + 127) / 255;
}

uint32_t packed(Rgb8 color, const Layout& layout) {
  return narrowed(color.r, layout.red.length) << layout.red.offset |
         narrowed(color.g, layout.green.length) << layout.green.offset |
         narrowed(color.b, layout.blue.length) << layout.blue.offset;
}

// Little-endian, byte by byte: a stride may be odd, and 24 bits have no type.
void store(uint8_t* at, uint32_t value, int32_t bytes) {
  for (int32_t i = 0; i < bytes; ++i) {
    at[i] = static_cast<uint8_t>(value >> (8 * i));
  }
}

bool lies_within(const Channel& channel, int32_t bits) {
  return channel.length >= 1 && channel.length <= 8 &&
         channel.offset + channel.length <= static_cast<uint32_t>(bits);
}

}  // namespace

Layout usual_layout(int32_t width_px, int32_t height_px, size_t stride_bytes, int32_t bits_per_pixel) {
  if (bits_per_pixel == 16) {
    return {width_px, height_px, stride_bytes, 16, {11, 5}, {5, 6}, {0, 5}};
  }
  return {width_px, height_px, stride_bytes, bits_per_pixel, {16, 8}, {8, 8}, {0, 8}};
}

const char* fault_of(const Layout& layout) {
  if (layout.width_px < 1 || layout.height_px < 1) {
    return "it has no pixels";
  }
  if (layout.bits_per_pixel != 16 && layout.bits_per_pixel != 24 && layout.bits_per_pixel != 32) {
    return "only 16, 24 and 32 bits a pixel can be drawn";
  }
  if (!lies_within(layout.red, layout.bits_per_pixel) || !lies_within(layout.green, layout.bits_per_pixel) ||
      !lies_within(layout.blue, layout.bits_per_pixel)) {
    return "its colours do not lie within a pixel in 1 to 8 bits each";
  }
  const size_t row = static_cast<size_t>(layout.width_px) * static_cast<size_t>(layout.bits_per_pixel / 8);
  if (layout.stride_bytes < row) {
    return "its rows are shorter than their pixels";
  }
  return nullptr;
}

Placement place(int32_t picture_width_px, int32_t picture_height_px, const Layout& screen) {
  const int32_t across = screen.width_px / picture_width_px;
  const int32_t down = screen.height_px / picture_height_px;
  Placement placement;
  placement.scale = across < down ? across : down;
  placement.left_px = (screen.width_px - picture_width_px * placement.scale) / 2;
  placement.top_px = (screen.height_px - picture_height_px * placement.scale) / 2;
  return placement;
}

void put_band(const Band& band, int32_t width_px, const Layout& layout, const Placement& placement,
              Bytes screen) {
  const size_t band_stride = band.stride_bytes == 0 ? row_bytes(band.format, width_px) : band.stride_bytes;
  const int32_t pixel_bytes = layout.bits_per_pixel / 8;
  const size_t left = static_cast<size_t>(placement.left_px) * static_cast<size_t>(pixel_bytes);
  for (int32_t row = 0; row < band.rows; ++row) {
    const uint8_t* from = band.pixels.data + band_stride * row_place(band.format, row);
    const int32_t y = placement.top_px + (band.first_row + row) * placement.scale;
    uint8_t* first = screen.data + layout.stride_bytes * static_cast<size_t>(y) + left;
    uint8_t* to = first;
    for (int32_t x = 0; x < width_px; ++x) {
      const uint32_t value = packed(load_pixel(from, x, band.first_row + row, band.format), layout);
      for (int32_t copy = 0; copy < placement.scale; ++copy, to += pixel_bytes) {
        store(to, value, pixel_bytes);
      }
    }
    for (int32_t copy = 1; copy < placement.scale; ++copy) {
      memcpy(first + layout.stride_bytes * static_cast<size_t>(copy), first, static_cast<size_t>(to - first));
    }
  }
}

}  // namespace thimble::linux_port
