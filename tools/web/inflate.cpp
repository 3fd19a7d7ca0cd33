// What readers inflate inside a file (readers/file_bytes.h), by stb's decoder in place of zlib, which Debian has
// compiled for the host alone. It does not compare check sums. And the blocks of `.gox`, which are PNGs.
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "readers/file_bytes.h"
#include "readers/picture.h"

#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Weverything"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_JPEG
#define STBI_NO_BMP
#define STBI_NO_PSD
#define STBI_NO_TGA
#define STBI_NO_GIF
#define STBI_NO_HDR
#define STBI_NO_PIC
#define STBI_NO_PNM
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#define STBI_NO_THREAD_LOCALS
#define STBI_NO_SIMD
#define STBI_SUPPORT_ZLIB
#include <stb/stb_image.h>
#pragma clang diagnostic pop

namespace thimble::tools {
namespace {

struct Inflated {
  SharedBytes file;
  bool is_whole = false;
};

/// Into `room` bytes, and more where they may `grow`.
Inflated inflate(std::span<const std::uint8_t> packed, Deflated frame, std::size_t room, bool grow) {
  auto* const first = static_cast<char*>(std::malloc(room));
  if (first == nullptr || packed.size() > INT32_MAX) {
    throw InputError("does not fit the memory that the browser gives");
  }
  // The decoder looks two bytes past the last code; zlib's frame has four there.
  std::vector<stbi_uc> padded;
  if (frame == Deflated::kBare) {
    padded.reserve(packed.size() + sizeof(std::uint32_t));
    padded.assign(packed.begin(), packed.end());
    padded.resize(packed.size() + sizeof(std::uint32_t));
    packed = padded;
  }
  stbi__zbuf buffer{};
  buffer.zbuffer = const_cast<stbi_uc*>(packed.data());
  buffer.zbuffer_end = buffer.zbuffer + packed.size();
  const bool is_whole = stbi__do_zlib(&buffer, first, static_cast<int>(room), grow ? 1 : 0,
                                      frame == Deflated::kZlib ? 1 : 0) != 0;
  const std::shared_ptr<const char> made(buffer.zout_start, std::free);
  return {{{reinterpret_cast<const std::uint8_t*>(made.get()),
            static_cast<std::size_t>(buffer.zout - buffer.zout_start)},
           made},
          is_whole};
}

}  // namespace

SharedBytes inflate_bytes(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t limit_bytes,
                          const std::string& place) {
  const auto [file, is_whole] = inflate(packed, frame, std::size_t{1} << 16, true);
  if (!is_whole) {
    throw InputError(place + ": the deflated data is damaged or truncated");
  }
  if (file.bytes.size() > limit_bytes) {
    throw InputError("holds more than the limit of " + std::to_string(limit_bytes) + " bytes");
  }
  return file;
}

SharedBytes inflate_beginning(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t count) {
  return inflate(packed, frame, static_cast<std::size_t>(count), false).file;
}

std::array<int, 2> picture_size(std::span<const std::uint8_t> encoded) {
  std::array<int, 2> size{};
  int channels = 0;
  const bool is_known =
      encoded.size() <= INT32_MAX && stbi_info_from_memory(encoded.data(), static_cast<int>(encoded.size()),
                                                           &size[0], &size[1], &channels) != 0;
  return is_known ? size : std::array<int, 2>{};
}

std::shared_ptr<std::uint8_t> decode_picture(std::span<const std::uint8_t> encoded, int channels,
                                             const std::string& place) {
  int width = 0;
  int height = 0;
  int in_file = 0;
  std::shared_ptr<std::uint8_t> decoded(
      stbi_load_from_memory(encoded.data(), static_cast<int>(encoded.size()), &width, &height, &in_file,
                            channels),
      std::free);
  if (decoded == nullptr) {
    throw InputError(place + "is damaged");
  }
  return decoded;
}

}  // namespace thimble::tools
