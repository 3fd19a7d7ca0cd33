#include "host/packed_picture.h"

#include <cstddef>

namespace thimble::host {
namespace {

template <class Append>
void for_each_pixel(const PackedPicture& picture, const Append& append) {
  const auto width = static_cast<std::size_t>(picture.width_px);
  const std::size_t stride = row_bytes(picture.format, picture.width_px);
  for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height_px); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto row = static_cast<std::int32_t>(y);
      append(load_pixel(picture.bytes.data() + row_place(picture.format, row) * stride,
                        static_cast<std::int32_t>(x), row, picture.format));
    }
  }
}

}  // namespace

std::vector<std::uint8_t> expand_rgb(const PackedPicture& picture) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  for_each_pixel(picture, [&](const Rgb8& pixel) { rgb.insert(rgb.end(), {pixel.r, pixel.g, pixel.b}); });
  return rgb;
}

std::vector<std::uint8_t> expand_gray(const PackedPicture& picture) {
  std::vector<std::uint8_t> gray;
  gray.reserve(static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px));
  for_each_pixel(picture, [&](const Rgb8& pixel) { gray.push_back(pixel.r); });
  return gray;
}

}  // namespace thimble::host
