#include "readers/gltf_picture.h"

#include <cmath>
#include <limits>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wcast-align"
#pragma GCC diagnostic ignored "-Wunused-function"
#ifndef __clang_analyzer__  // what it finds in the library is not ours to change
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#endif
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace thimble::tools {
namespace {

/// The whole number from 0 to `count` - 1 that a coordinate from 0 to 1, repeated, falls on.
std::int32_t texel(double coordinate, std::int32_t count) {
  const double part = coordinate - std::floor(coordinate);
  if (!(part >= 0)) {
    return 0;  // not finite
  }
  const auto index = static_cast<std::int32_t>(part * count);
  return index < count ? index : count - 1;
}

}  // namespace

GltfPicture::GltfPicture(std::span<const std::uint8_t> encoded, std::uint64_t limit_bytes) {
  if (encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return;
  }
  const auto size = static_cast<int>(encoded.size());
  int channels = 0;
  if (stbi_info_from_memory(encoded.data(), size, &width_, &height_, &channels) == 0 || width_ < 1 ||
      height_ < 1 ||
      static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_) * 6 > limit_bytes) {
    return;
  }
  pixels_.reset(stbi_load_from_memory(encoded.data(), size, &width_, &height_, &channels, 3),
                [](const std::uint8_t* pixels) { stbi_image_free(const_cast<std::uint8_t*>(pixels)); });
}

Rgb GltfPicture::at(double u, double v) const {
  if (is_empty()) {
    return {};
  }
  const auto row = static_cast<std::size_t>(texel(v, height_));
  const std::uint8_t* pixel = pixels_.get() + 3 * (row * static_cast<std::size_t>(width_) +
                                                   static_cast<std::size_t>(texel(u, width_)));
  return {pixel[0], pixel[1], pixel[2]};
}

}  // namespace thimble::tools
