// Pictures as PNG: what another reader finds in the file is what went in.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "output/image.h"
#include "support/pictures.h"
#include "support/ray_cases.h"

namespace thimble::tests {
namespace {

std::uint32_t number_at(const std::string& file, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number = number << 8 | static_cast<std::uint8_t>(file[at + i]);
  }
  return number;
}

// Looks at a file of chunks IHDR, IDAT, IEND, each with its CRC, which readers may leave unread.
void check_chunks(const std::string& file, std::size_t width, std::size_t height, std::size_t channels) {
  std::vector<std::string> names;
  for (std::size_t at = 8; at < file.size(); at += 12 + number_at(file, at)) {
    const std::size_t size = number_at(file, at);
    REQUIRE(at + 12 + size <= file.size());
    names.push_back(file.substr(at + 4, 4));
    CHECK(number_at(file, at + 8 + size) ==
          crc32_z(0, reinterpret_cast<const unsigned char*>(file.data()) + at + 4, size + 4));
    if (names.back() == "IHDR") {
      CHECK(number_at(file, at + 8) == width);
      CHECK(number_at(file, at + 12) == height);
      CHECK(file[at + 16] == 8);
      CHECK(file[at + 17] == (channels == 3 ? 2 : 6));
    }
  }
  CHECK(names == std::vector<std::string>{"IHDR", "IDAT", "IEND"});
}

}  // namespace

TEST_CASE("png: pictures of all sorts and sizes -> the same pixels again") {
  std::mt19937_64 random(31);
  for (int i = 0; i < 300; ++i) {
    CAPTURE(i);
    const auto width = static_cast<std::size_t>(pick(random, 1, i < 280 ? 90 : 900));
    const auto height = static_cast<std::size_t>(pick(random, 1, i < 280 ? 40 : 300));
    const std::size_t channels = i % 2 == 0 ? 3 : 4;
    std::vector<std::uint8_t> pixels(width * height * channels);
    const auto kind = pick(random, 0, 4);
    for (std::size_t y = 0; y < height; ++y) {
      for (std::size_t x = 0; x < width * channels; ++x) {
        const auto noise = static_cast<std::size_t>(pick(random, 0, 255));
        pixels[y * width * channels + x] = static_cast<std::uint8_t>(kind == 0   ? noise
                                                                     : kind == 1 ? 77
                                                                     : kind == 2 ? x + noise % 3
                                                                     : kind == 3 ? 3 * y * (x % 5)
                                                                                 : x * y);
      }
    }
    const auto bytes = tools::png_file(static_cast<std::int32_t>(width), static_cast<std::int32_t>(height),
                                       static_cast<int>(channels), pixels);
    const std::string file(bytes.begin(), bytes.end());
    check_chunks(file, width, height, channels);
    CHECK(read_png(file).frames[0] == std::string(pixels.begin(), pixels.end()));
  }
}

}  // namespace thimble::tests
