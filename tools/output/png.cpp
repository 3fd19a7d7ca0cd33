// stb_image_write chooses the filters and writes the file; zlib deflates, which takes a third of the time and leaves
// smaller files than the encoder's own. JPEGs are all the encoder's.
#include "output/image.h"

#include <zlib.h>

#include <cstdlib>
#include <new>

namespace {

// Beyond this level files get 2 per cent smaller for twice the time.
constexpr int kDeflateLevel = 4;

// Freed by the encoder; null when there is no memory.
[[maybe_unused]] unsigned char* deflated(unsigned char* data, int data_bytes, int* bytes, int /*quality*/) {
  uLongf size = compressBound(static_cast<uLong>(data_bytes));
  auto* const out = static_cast<unsigned char*>(std::malloc(size));
  if (out != nullptr && compress2(out, &size, data, static_cast<uLong>(data_bytes), kDeflateLevel) != Z_OK) {
    std::free(out);
    return nullptr;
  }
  *bytes = static_cast<int>(size);
  return out;
}

[[maybe_unused]] unsigned checksum(unsigned char* data, int bytes) {
  return static_cast<unsigned>(crc32(0, data, static_cast<uInt>(bytes)));
}

}  // namespace

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STBIW_ZLIB_COMPRESS deflated
#define STBIW_CRC32 checksum
#define STB_IMAGE_WRITE_STATIC
#ifndef __clang_analyzer__  // What the encoder loses when memory ends is the encoder's.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#endif
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace thimble::tools {
namespace {

void append(void* file, void* data, int count) {
  auto* out = static_cast<std::vector<unsigned char>*>(file);
  const auto* bytes = static_cast<const unsigned char*>(data);
  out->insert(out->end(), bytes, bytes + count);
}

}  // namespace

std::vector<unsigned char> png_file(std::int32_t width_px, std::int32_t height_px, int channels,
                                    std::span<const std::uint8_t> pixels) {
  std::vector<unsigned char> file;
  if (stbi_write_png_to_func(append, &file, width_px, height_px, channels, pixels.data(),
                             channels * width_px) == 0) {
    throw std::bad_alloc();
  }
  return file;
}

std::vector<unsigned char> jpeg_file(std::int32_t width_px, std::int32_t height_px,
                                     std::span<const std::uint8_t> pixels, int quality) {
  std::vector<unsigned char> file;
  if (stbi_write_jpg_to_func(append, &file, width_px, height_px, 3, pixels.data(), quality) == 0) {
    throw std::bad_alloc();
  }
  return file;
}

}  // namespace thimble::tools
