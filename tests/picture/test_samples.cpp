// Several samples a pixel: a mean of a finer picture.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "support/formats.h"
#include "support/scene_under_test.h"
#include "thimble/picture/render.h"

namespace thimble::tests {
namespace {

TEST_CASE("samples: random fine rows -> each channel's mean to the nearest, halves up, in every format") {
  std::mt19937_64 random(5);
  for (int across = 1; across <= kMaxSamplesAcross; ++across) {
    for (const PixelFormat format : testing::kFormats) {
      const std::int32_t width = 13;
      const HeapBytes fine(samples_bytes(width, across));
      for (std::uint8_t& byte : fine.span()) {
        byte = static_cast<std::uint8_t>(random());
      }
      const HeapBytes row(row_bytes(format, width));
      const std::int32_t y = 3;
      REQUIRE(average_samples(fine.view(), across, width, y, format, row.span()) == Status::kOk);
      std::vector<std::uint8_t> expected(row_bytes(format, width));
      for (std::int32_t x = 0; x < width; ++x) {
        std::uint8_t mean[3] = {};
        for (int channel = 0; channel < 3; ++channel) {
          int sum = 0;
          for (int i = 0; i < across * across; ++i) {
            sum += fine.view()[static_cast<std::size_t>(
                3 * ((i / across) * width * across + x * across + i % across) + channel)];
          }
          // The least whole number not below the mean less a half.
          int rounded = 0;
          while (2 * across * across * rounded + across * across <= 2 * sum) {
            ++rounded;
          }
          mean[channel] = static_cast<std::uint8_t>(rounded);
        }
        store_pixel(expected.data(), x, y, format, {mean[0], mean[1], mean[2]});
      }
      const std::vector<std::uint8_t> got(row.view().begin(), row.view().end());
      CHECK(got == expected);
    }
  }
}

TEST_CASE("samples: limits -> an error and nothing written") {
  const HeapBytes fine(samples_bytes(10, 2));
  const HeapBytes row(row_bytes(PixelFormat::kRgb888, 10));
  row.span()[0] = 7;
  const auto attempt = [&](std::size_t fine_less, int across, std::int32_t width, std::size_t row_less) {
    return average_samples(fine.view().subspan(0, fine.view().size - fine_less), across, width, 0,
                           PixelFormat::kRgb888, row.span().subspan(0, row.span().size - row_less));
  };
  CHECK(attempt(0, 0, 10, 0) == Status::kOutOfRange);
  CHECK(attempt(0, kMaxSamplesAcross + 1, 1, 0) == Status::kOutOfRange);
  CHECK(attempt(0, 2, kMaxPicturePx / 2 + 1, 0) == Status::kOutOfRange);
  CHECK(attempt(0, 2, kMaxPicturePx / 2, 0) == Status::kOutOfMemory);
  for (const std::int32_t below : {-1, INT32_MIN}) {
    CHECK(attempt(0, below, 10, 0) == Status::kOutOfRange);
    CHECK(attempt(0, 2, below, 0) == Status::kOutOfRange);
  }
  CHECK(attempt(0, 2, 0, 0) == Status::kOk);
  CHECK(attempt(1, 2, 10, 0) == Status::kOutOfMemory);
  CHECK(attempt(0, 2, 10, 1) == Status::kOutOfMemory);
  CHECK(row.view()[0] == 7);
  CHECK(attempt(0, 2, 10, 0) == Status::kOk);
}

}  // namespace
}  // namespace thimble::tests
