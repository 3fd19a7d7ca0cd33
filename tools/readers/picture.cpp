#include "readers/picture.h"

#include <limits>
#include <memory>

#include "readers/file_bytes.h"

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
#define STBI_ONLY_PNM
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace thimble::tools {

Image read_picture(const std::string& path, std::int32_t width_px, std::int32_t height_px) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20;
  static_assert(kMostBytes < std::numeric_limits<int>::max());
  const FileBytes file = load_file(path, kMostBytes);
  const auto* bytes = file.bytes().data();
  const auto size = static_cast<int>(file.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(bytes, size, &width, &height, &channels) == 0) {
    throw InputError("is no PNG, PPM or PGM");
  }
  if (width != width_px || height != height_px) {
    throw InputError("is " + std::to_string(width) + " x " + std::to_string(height) + " pixels, not " +
                     std::to_string(width_px) + " x " + std::to_string(height_px));
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes, size, &width, &height, &channels, 3), stbi_image_free);
  if (pixels == nullptr) {
    throw InputError(std::string("is damaged: ") + stbi_failure_reason());
  }
  Image image{width, height, PixelFormat::kRgb888, {}};
  image.pixels.assign(pixels.get(),
                      pixels.get() + 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

}  // namespace thimble::tools
