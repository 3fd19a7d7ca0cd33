#include "host/packed_picture.h"

#include <cstddef>

namespace thimble::host {
namespace {

std::uint8_t gray_at(const std::uint8_t* row, std::size_t x, PixelFormat format) {
  if (format == PixelFormat::kMono1) {
    return (row[x / 8] >> (7 - x % 8) & 1) != 0 ? 255 : 0;
  }
  if (format == PixelFormat::kGray4) {
    return static_cast<std::uint8_t>((x % 2 == 0 ? row[x / 2] >> 4 : row[x / 2] & 15) * 17);
  }
  return row[x];
}

Rgb8 pixel_at(const std::uint8_t* row, std::size_t x, PixelFormat format) {
  if (format == PixelFormat::kRgb888) {
    return {row[3 * x], row[3 * x + 1], row[3 * x + 2]};
  }
  if (format == PixelFormat::kRgb565) {
    const unsigned packed = row[2 * x] | static_cast<unsigned>(row[2 * x + 1]) << 8;
    const unsigned r = packed >> 11;
    const unsigned g = packed >> 5 & 63;
    const unsigned b = packed & 31;
    return {static_cast<std::uint8_t>(r << 3 | r >> 2), static_cast<std::uint8_t>(g << 2 | g >> 4),
            static_cast<std::uint8_t>(b << 3 | b >> 2)};
  }
  const std::uint8_t gray = gray_at(row, x, format);
  return {gray, gray, gray};
}

template <class Append>
void for_each_pixel(const PackedPicture& picture, const Append& append) {
  const auto width = static_cast<std::size_t>(picture.width_px);
  const std::size_t stride = row_bytes(picture.format, picture.width_px);
  for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height_px); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      append(picture.bytes.data() + y * stride, x);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> expand_rgb(const PackedPicture& picture) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  for_each_pixel(picture, [&](const std::uint8_t* row, std::size_t x) {
    const Rgb8 pixel = pixel_at(row, x, picture.format);
    rgb.insert(rgb.end(), {pixel.r, pixel.g, pixel.b});
  });
  return rgb;
}

std::vector<std::uint8_t> expand_gray(const PackedPicture& picture) {
  std::vector<std::uint8_t> gray;
  gray.reserve(static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  for_each_pixel(picture, [&](const std::uint8_t* row, std::size_t x) {
    gray.push_back(gray_at(row, x, picture.format));
  });
  return gray;
}

}  // namespace thimble::host
