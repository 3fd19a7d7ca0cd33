// Pictures as PNG: what the standard's own rules make of the file is what went in.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "output/png.h"
#include "support/ray_cases.h"

namespace thimble::tests {
namespace {

std::uint32_t number_at(const std::vector<unsigned char>& file, std::size_t at) {
  return std::uint32_t{file[at]} << 24 | std::uint32_t{file[at + 1]} << 16 |
         std::uint32_t{file[at + 2]} << 8 | std::uint32_t{file[at + 3]};
}

struct Decoded {
  std::vector<std::uint8_t> pixels;
  std::vector<int> filters;  // how often each was taken
};

// Reads a file of chunks IHDR, IDAT, IEND, each with its CRC, and takes the filters off again, byte by byte.
Decoded decoded(const std::vector<unsigned char>& file, std::size_t width, std::size_t height,
                std::size_t channels) {
  REQUIRE(std::string(file.begin(), file.begin() + 8) == "\x89PNG\r\n\x1A\n");
  std::vector<std::string> names;
  std::vector<unsigned char> packed;
  std::size_t at = 8;
  while (at < file.size()) {
    const std::size_t size = number_at(file, at);
    REQUIRE(at + 12 + size <= file.size());
    names.emplace_back(file.begin() + static_cast<std::ptrdiff_t>(at + 4),
                       file.begin() + static_cast<std::ptrdiff_t>(at + 8));
    CHECK(number_at(file, at + 8 + size) == crc32_z(0, file.data() + at + 4, size + 4));
    if (names.back() == "IHDR") {
      CHECK(number_at(file, at + 8) == width);
      CHECK(number_at(file, at + 12) == height);
      CHECK(file[at + 16] == 8);
      CHECK(file[at + 17] == (channels == 3 ? 2 : 6));
    }
    if (names.back() == "IDAT") {
      packed.assign(file.begin() + static_cast<std::ptrdiff_t>(at + 8),
                    file.begin() + static_cast<std::ptrdiff_t>(at + 8 + size));
    }
    at += 12 + size;
  }
  CHECK(names == std::vector<std::string>{"IHDR", "IDAT", "IEND"});
  const std::size_t row = width * channels;
  std::vector<std::uint8_t> rows((row + 1) * height);
  uLongf size = rows.size();
  REQUIRE(uncompress(rows.data(), &size, packed.data(), packed.size()) == Z_OK);
  REQUIRE(size == rows.size());
  Decoded result{std::vector<std::uint8_t>(row * height), std::vector<int>(5)};
  for (std::size_t y = 0; y < height; ++y) {
    const unsigned filter = rows[y * (row + 1)];
    REQUIRE(filter < 5);
    ++result.filters[filter];
    for (std::size_t i = 0; i < row; ++i) {
      std::uint8_t* const pixel = result.pixels.data() + y * row + i;
      const int left = i < channels ? 0 : *(pixel - channels);
      const int above = y == 0 ? 0 : *(pixel - row);
      const int corner = i < channels || y == 0 ? 0 : *(pixel - row - channels);
      const int guess = left + above - corner;
      const int paeth = std::abs(guess - left) <= std::abs(guess - above) &&
                                std::abs(guess - left) <= std::abs(guess - corner)
                            ? left
                        : std::abs(guess - above) <= std::abs(guess - corner) ? above
                                                                              : corner;
      const int expected[5] = {0, left, above, (left + above) / 2, paeth};
      *pixel = static_cast<std::uint8_t>(rows[y * (row + 1) + 1 + i] + expected[filter]);
    }
  }
  return result;
}

}  // namespace

TEST_CASE("png: pictures of all sorts and sizes -> the same pixels again, by every filter") {
  std::mt19937_64 random(31);
  std::vector<int> filters(5);
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
    const Decoded result =
        decoded(tools::png_file(static_cast<std::int32_t>(width), static_cast<std::int32_t>(height),
                                static_cast<int>(channels), pixels),
                width, height, channels);
    CHECK(result.pixels == pixels);
    for (std::size_t filter = 0; filter < 5; ++filter) {
      filters[filter] += result.filters[filter];
    }
  }
  for (const int count : filters) {
    CHECK(count > 0);
  }
}

}  // namespace thimble::tests
