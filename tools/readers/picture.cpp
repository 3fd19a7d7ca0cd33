#include "readers/picture.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "readers/file_bytes.h"

namespace thimble::tools {
namespace {

/// Memory for the decoder, which knows no bound: what a picture holds behind its header may be far more than its pixels.
/// A block's size stands before it.
constexpr std::size_t kBeforeBlock = alignof(std::max_align_t);
thread_local std::size_t room_bytes = 0;

void* take_block(std::size_t size) {
  if (size > room_bytes) {
    return nullptr;
  }
  auto* const block = static_cast<std::uint8_t*>(std::malloc(size + kBeforeBlock));
  if (block == nullptr) {
    return nullptr;
  }
  room_bytes -= size;
  *reinterpret_cast<std::size_t*>(block) = size;
  return block + kBeforeBlock;
}
void free_block(void* block) {
  if (block != nullptr) {
    void* const whole = static_cast<std::uint8_t*>(block) - kBeforeBlock;
    room_bytes += *static_cast<std::size_t*>(whole);
    std::free(whole);
  }
}
// The analyzer does not see the decoder, which alone calls it.
[[maybe_unused]] void* move_block(void* block, std::size_t old_size, std::size_t size) {
  void* const moved = take_block(size);
  if (moved != nullptr && block != nullptr) {
    std::copy_n(static_cast<const std::uint8_t*>(block), std::min(old_size, size),
                static_cast<std::uint8_t*>(moved));
    free_block(block);
  }
  return moved;
}

}  // namespace
}  // namespace thimble::tools

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
#define STBI_ONLY_PNM
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STBI_MALLOC(size) thimble::tools::take_block(size)
#define STBI_REALLOC_SIZED(block, old_size, size) thimble::tools::move_block(block, old_size, size)
#define STBI_FREE(block) thimble::tools::free_block(block)
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace thimble::tools {
namespace {

/// As many bytes as the decoder can count.
int counted(std::span<const std::uint8_t> bytes) {
  return static_cast<int>(std::min<std::size_t>(bytes.size(), std::numeric_limits<int>::max()));
}

}  // namespace

std::array<int, 2> picture_size(std::span<const std::uint8_t> encoded) {
  std::array<int, 2> size{};
  int channels = 0;
  room_bytes = std::size_t{1} << 20;
  const bool is_known =
      stbi_info_from_memory(encoded.data(), counted(encoded), &size[0], &size[1], &channels) != 0;
  return is_known ? size : std::array<int, 2>{};
}

std::shared_ptr<std::uint8_t> decode_picture(std::span<const std::uint8_t> encoded, int channels,
                                             const std::string& place) {
  auto [width, height] = picture_size(encoded);
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  room_bytes = static_cast<std::size_t>(5 * 4 * pixels + 3 * encoded.size() + (std::uint64_t{1} << 20));
  int in_file = 0;
  std::shared_ptr<std::uint8_t> decoded(
      stbi_load_from_memory(encoded.data(), counted(encoded), &width, &height, &in_file, channels),
      free_block);
  fail_if(decoded == nullptr, place, "is damaged: ", stbi_failure_reason());
  return decoded;
}

Image read_picture(const std::string& path, std::int32_t width_px, std::int32_t height_px) {
  const SharedBytes file = load_file(path, std::uint64_t{256} << 20);
  const auto [width, height] = picture_size(file.bytes);
  fail_if(width < 1 || height < 1, "is no PNG, JPEG, PPM or PGM");
  fail_if(width != width_px || height != height_px, "is ", width, " x ", height, " pixels, not ", width_px,
          " x ", height_px);
  const std::shared_ptr<std::uint8_t> pixels = decode_picture(file.bytes, 3);
  Image image{width, height, PixelFormat::kRgb888, {}};
  image.pixels.assign(pixels.get(),
                      pixels.get() + 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

}  // namespace thimble::tools
