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

TEST_CASE("samples: one a pixel -> the picture itself; sixteen -> edges between, the rest unchanged") {
  const SceneUnderTest world({16, 16, 16}, {{3, 3, 3}, {4, 3, 3}, {8, 9, 10}, {12, 1, 2}});
  Shading shading;
  shading.mode = ShadeMode::kMono;
  const std::int32_t width = 40;
  const std::int32_t height = 30;
  const auto draw = [&](int across) {
    PerspectiveView view;
    view.eye = {Q8::saturate(-10), Q8::saturate(-12), Q8::saturate(14)};
    view.forward = {17, 19, -9};
    view.fov_degrees = Q16::saturate(25);
    view.width_px = width * across;
    view.height_px = height * across;
    Camera camera;
    REQUIRE(camera.set(view, world.level()) == Status::kOk);
    std::vector<std::uint8_t> picture;
    for (std::int32_t y = 0; y < height; ++y) {
      const HeapBytes fine(samples_bytes(width, across));
      REQUIRE(render_band(world.compact(), camera, shading,
                          {fine.span(), PixelFormat::kRgb888, 0, y * across, across}) == Status::kOk);
      const HeapBytes row(row_bytes(PixelFormat::kRgb888, width));
      REQUIRE(average_samples(fine.view(), across, width, y, PixelFormat::kRgb888, row.span()) ==
              Status::kOk);
      picture.insert(picture.end(), row.view().begin(), row.view().end());
    }
    std::vector<std::uint8_t> whole(band_bytes(PixelFormat::kRgb888, width, height));
    if (across == 1) {
      REQUIRE(render_band(world.compact(), camera, shading,
                          {Bytes(whole.data(), whole.size()), PixelFormat::kRgb888, 0, 0, height}) ==
              Status::kOk);
      CHECK(whole == picture);
    }
    return picture;
  };
  const auto one = draw(1);
  const auto sixteen = draw(4);
  std::size_t between = 0;
  std::size_t white = 0;
  for (std::size_t i = 0; i < sixteen.size(); i += 3) {
    between += sixteen[i] != 0 && sixteen[i] != 255 ? 1U : 0U;
    white += sixteen[i] == 255 && one[i] == 255 ? 1U : 0U;
  }
  CHECK(between > 20);
  CHECK(white > 20);
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
