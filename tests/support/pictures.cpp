#include "support/pictures.h"

#include <doctest/doctest.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wcast-align"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#define STB_IMAGE_STATIC
#define STBI_ONLY_GIF
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace thimble::tests {
namespace {

const unsigned char* bytes_of(const std::string& file) {
  return reinterpret_cast<const unsigned char*>(file.data());
}

// Takes the frames that stb has read, one behind the other.
void take_frames(unsigned char* pixels, int frames, ReadPicture* picture) {
  REQUIRE(pixels != nullptr);
  const std::size_t size = static_cast<std::size_t>(picture->width) *
                           static_cast<std::size_t>(picture->height) *
                           static_cast<std::size_t>(picture->channels);
  for (int frame = 0; frame < frames; ++frame) {
    picture->frames.emplace_back(
        reinterpret_cast<const char*>(pixels) + size * static_cast<std::size_t>(frame), size);
  }
  stbi_image_free(pixels);
}

}  // namespace

ReadPicture read_png(const std::string& file) {
  REQUIRE(file.starts_with("\x89PNG"));
  ReadPicture picture;
  take_frames(stbi_load_from_memory(bytes_of(file), static_cast<int>(file.size()), &picture.width,
                                    &picture.height, &picture.channels, 0),
              1, &picture);
  return picture;
}

ReadPicture read_gif(const std::string& file) {
  REQUIRE(file.starts_with("GIF89a"));
  ReadPicture picture;
  picture.channels = 3;
  int* delays = nullptr;
  int frames = 0;
  int own_channels = 0;
  unsigned char* const pixels =
      stbi_load_gif_from_memory(bytes_of(file), static_cast<int>(file.size()), &delays, &picture.width,
                                &picture.height, &frames, &own_channels, 3);
  take_frames(pixels, frames, &picture);
  picture.delays_ms.assign(delays, delays + frames);
  stbi_image_free(delays);
  return picture;
}

}  // namespace thimble::tests
