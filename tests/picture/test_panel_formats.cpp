// The formats of panels: each picture is what a straight encoder, written from the layouts' words alone, makes of the same
// picture in kRgb888. Any band height, stride, odd width and last page. Other engines: test_frames.cpp, test_wide.cpp.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "support/lit_world.h"
#include "support/scene_under_test.h"
#include "support/wide_cases.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using testing::LitWorld;
using Picture = std::vector<std::uint8_t>;

constexpr int kBase = 5;

std::vector<PixelFormat> panel_formats() {
  std::vector<PixelFormat> all;
  for (int number = kBase; number < kPixelFormats; ++number) {
    all.push_back(static_cast<PixelFormat>(number));
  }
  return all;
}

// ---- the straight encoder

// Bayer's matrix by its definition: 0, 2 / 3, 1 in each of its quarters.
int bayer(int side, int x, int y) {
  if (side == 1) {
    return 0;
  }
  constexpr int kQuarter[2][2] = {{0, 3}, {2, 1}};
  const int half = side / 2;
  return 4 * bayer(half, x % half, y % half) + kQuarter[y / half % 2][x / half % 2];
}
int level_of(int value, int most) {
  return (2 * value * most + 255) / 510;  // nearest
}

// The number of the paper's colour that comes first whose share of the cell reaches beyond the threshold.
int paper_color(std::array<int, 3> rgb, int threshold) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rgb[a] > rgb[b]; });
  const int greatest = rgb[order[0]];
  const int middle = rgb[order[1]];
  const int least = rgb[order[2]];
  constexpr int kPrimary[3] = {4, 2, 3};  // red, green, blue
  const bool no_pair = order[2] != 2;     // cyan or magenta would be the pair
  const int taking_turns = (threshold / 32 % 2) != 0 ? 3 : (order[2] == 0 ? 2 : 4);
  if (threshold < least) {
    return 1;
  }
  if (!no_pair && order[0] == 0) {  // red, then green: orange around where yellow becomes red
    const int share = std::min(middle - least, greatest - middle);
    if (threshold >= middle - share && threshold < middle + share) {
      return 6;
    }
  }
  if (threshold < middle) {
    return no_pair ? taking_turns : 5;
  }
  return threshold < greatest ? kPrimary[order[0]] : 0;
}

// All bits of a pixel, and where the first of them lies: its byte's highest bit is 0.
class BitWriter {
 public:
  BitWriter(Picture& bytes, std::size_t first) : bytes_(bytes), at_(8 * first) {}
  void put(unsigned value, int bits) {
    for (int i = bits - 1; i >= 0; --i, ++at_) {
      if ((value >> i & 1U) != 0) {
        bytes_[at_ / 8] = static_cast<std::uint8_t>(bytes_[at_ / 8] | 0x80U >> at_ % 8);
      }
    }
  }

 private:
  Picture& bytes_;
  std::size_t at_;
};

void encode_row(const std::uint8_t* rgb, int width, int y, PixelFormat format, Picture& out,
                std::size_t row) {
  BitWriter bits(out, row * static_cast<std::size_t>(y));
  for (int x = 0; x < width; ++x, rgb += 3) {
    const int r = rgb[0];
    const int g = rgb[1];
    const int b = rgb[2];
    const int gray = (77 * r + 150 * g + 29 * b) / 256;
    const int threshold = 2 + 4 * bayer(8, x % 8, y % 8);
    const auto column = static_cast<std::size_t>(x);
    switch (format) {
      case PixelFormat::kRgb565Be:
        bits.put(static_cast<unsigned>(r / 8 * 2048 + g / 4 * 32 + b / 8), 16);
        break;
      case PixelFormat::kBgr565: {
        const int packed = b / 8 * 2048 + g / 4 * 32 + r / 8;
        bits.put(static_cast<unsigned>(packed % 256 * 256 + packed / 256), 16);
        break;
      }
      case PixelFormat::kRgb444:
        bits.put(static_cast<unsigned>(level_of(r, 15) * 256 + level_of(g, 15) * 16 + level_of(b, 15)), 12);
        break;
      case PixelFormat::kMono1Pages:
        if (gray > threshold) {
          std::uint8_t& byte =
              out[static_cast<std::size_t>(y / 8) * static_cast<std::size_t>(width) + column];
          byte = static_cast<std::uint8_t>(byte | 1U << y % 8);
        }
        break;
      case PixelFormat::kGray4Low: {
        std::uint8_t& byte = out[row * static_cast<std::size_t>(y) + column / 2];
        byte = static_cast<std::uint8_t>(byte + level_of(gray, 15) * (x % 2 == 0 ? 1 : 16));
        break;
      }
      case PixelFormat::kGray2:
        bits.put(static_cast<unsigned>(gray * 3 / 255 + (gray * 3 % 255 > threshold ? 1 : 0)), 2);
        break;
      case PixelFormat::kPaper3: {
        const int other = std::min(r, std::max(g, b));
        const int white = (77 * other + 150 * g + 29 * b) / 256;
        const bool is_white = threshold < white;
        const bool is_red = !is_white && threshold < white + r - other;
        std::uint8_t* const pair = out.data() + row * static_cast<std::size_t>(y) + column / 8 * 2;
        pair[0] = static_cast<std::uint8_t>(pair[0] | (is_white ? 0x80U >> x % 8 : 0U));
        pair[1] = static_cast<std::uint8_t>(pair[1] | (is_red ? 0x80U >> x % 8 : 0U));
        break;
      }
      case PixelFormat::kPaper7:
        bits.put(static_cast<unsigned>(paper_color({r, g, b}, threshold)), 4);
        break;
      case PixelFormat::kRgb332:
        bits.put(static_cast<unsigned>(level_of(r, 7) * 32 + level_of(g, 7) * 4 + level_of(b, 3)), 8);
        break;
      default:
        FAIL("not a format of panels");
    }
  }
}

std::size_t bytes_of_row(PixelFormat format, int width) {
  const auto w = static_cast<std::size_t>(width);
  switch (format) {
    case PixelFormat::kRgb565Be:
    case PixelFormat::kBgr565:
      return 2 * w;
    case PixelFormat::kRgb444:
      return (3 * w + 1) / 2;
    case PixelFormat::kMono1Pages:
    case PixelFormat::kRgb332:
      return w;
    case PixelFormat::kGray4Low:
    case PixelFormat::kPaper7:
      return (w + 1) / 2;
    case PixelFormat::kGray2:
      return (w + 3) / 4;
    case PixelFormat::kPaper3:
      return (w + 7) / 8 * 2;
    default:
      return 0;
  }
}

Picture encoded(const Picture& rgb, int width, int height, PixelFormat format) {
  const std::size_t row = bytes_of_row(format, width);
  const int rows = format == PixelFormat::kMono1Pages ? (height + 7) / 8 : height;
  Picture out(row * static_cast<std::size_t>(rows));
  for (int y = 0; y < height; ++y) {
    encode_row(rgb.data() + 3 * static_cast<std::size_t>(width * y), width, y, format, out, row);
  }
  return out;
}

// ---- the pictures

// Stairs of all colours of a palette that no format holds.
std::vector<Rgb8> palette_of_many() {
  std::vector<Rgb8> palette;
  for (unsigned i = 0; i < 16; ++i) {
    palette.push_back({static_cast<std::uint8_t>(255 - i * 7 % 256), static_cast<std::uint8_t>(i * 37 + 60),
                       static_cast<std::uint8_t>(i * i * 11)});
  }
  palette[3] = {255, 150, 0};
  palette[4] = {0, 180, 200};
  palette[5] = {210, 20, 190};
  return palette;
}

struct Stairs {
  LitWorld world;
  std::vector<Rgb8> palette = palette_of_many();

  Stairs() {
    for (int i = 0; i < 16; ++i) {
      world.box({2 * i, 0, 0}, {2 * i + 2, 32 - i, 2 + i}, i);
    }
    world.box({10, 4, 14}, {20, 9, 28}, 4);
    world.finish();
    world.shading.mode = ShadeMode::kColor;
    world.shading.palette = {palette.data(), palette.size()};
    world.shading.background = {40, 90, 160};
  }
  const Camera& look(int width, int height) {
    world.look({9000, -9000, 11000}, {4096, 4096, 2048}, 50, width, height);
    return world.camera;
  }
};

// Draws bands of `rows` rows at any stride, guards between and behind; returns the rows without gaps.
template <class Draw>
Picture in_bands(int width, int height, PixelFormat format, int rows, std::size_t gap, const Draw& draw) {
  const std::size_t row = row_bytes(format, width);
  const std::size_t stride = row + gap;
  Picture all;
  for (int y = 0; y < height; y += rows) {
    const int count = std::min(rows, height - y);
    const std::size_t places = row_place(format, whole_rows(format, count));
    Picture bytes(stride * places + 3, 0x5A);
    const Band band{{bytes.data(), stride * (places - 1) + row}, format, gap == 0 ? 0 : stride, y, count};
    REQUIRE(draw(band) == Status::kOk);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i % stride >= row || i >= stride * places) {
        REQUIRE(bytes[i] == 0x5A);
      }
    }
    for (std::size_t i = 0; i < places; ++i) {
      all.insert(all.end(), bytes.begin() + static_cast<std::ptrdiff_t>(stride * i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(stride * i + row));
    }
  }
  return all;
}

struct Size {
  int width;
  int height;
};
constexpr Size kSizes[] = {{1, 1}, {2, 9}, {3, 8}, {7, 17}, {9, 7}, {61, 37}, {84, 48}, {128, 64}};

template <class Draw>
void expect_encoded(const Size& size, const Picture& rgb, const Draw& draw) {
  for (const PixelFormat format : panel_formats()) {
    CAPTURE(static_cast<int>(format));
    CAPTURE(size.width);
    const Picture wanted = encoded(rgb, size.width, size.height, format);
    REQUIRE(wanted.size() == band_bytes(format, size.width, size.height));
    for (const int rows : {8, 24, size.height}) {
      CHECK(in_bands(size.width, size.height, format, rows, rows == 24 ? 5 : 0, draw) == wanted);
    }
    if (format != PixelFormat::kMono1Pages) {
      CHECK(in_bands(size.width, size.height, format, 3, 1, draw) == wanted);
    }
  }
}

template <class Draw>
Picture in_rgb(const Size& size, const Draw& draw) {
  return in_bands(size.width, size.height, PixelFormat::kRgb888, size.height, 0, draw);
}

TEST_CASE("panel formats: render_band, any size and band -> what a straight encoder makes of the picture") {
  Stairs stairs;
  for (const Size& size : kSizes) {
    const Camera& camera = stairs.look(size.width, size.height);
    const auto draw = [&](const Band& band) {
      return render_band(stairs.world.tree, camera, stairs.world.shading, band);
    };
    expect_encoded(size, in_rgb(size, draw), draw);
  }
}

TEST_CASE(
    "panel formats: any-time frames, done -> the same; before -> whole pages, and errors within bounds") {
  Stairs stairs;
  const Size size{61, 37};
  const Camera& camera = stairs.look(size.width, size.height);
  const Picture rgb = in_rgb(size, [&](const Band& band) {
    return render_band(stairs.world.tree, camera, stairs.world.shading, band);
  });
  for (const PixelFormat format : panel_formats()) {
    CAPTURE(static_cast<int>(format));
    const Picture wanted = encoded(rgb, size.width, size.height, format);
    Picture memory(anytime_bytes(size.width, size.height, format));
    AnytimeFrame frame;
    REQUIRE(AnytimeFrame::make(stairs.world.tree, camera, stairs.world.shading, format,
                               {memory.data(), memory.size()}, &frame) == Status::kOk);
    while (!frame.done()) {
      const Band all = frame.band(0, size.height);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          const std::size_t place = row_place(format, y) * row_bytes(format, size.width);
          const Rgb8 is = load_pixel(all.pixels.data + place, x, y, format);
          const Rgb8 should = load_pixel(wanted.data() + place, x, y, format);
          if (frame.exact(x, y)) {
            REQUIRE(is == should);
          }
          REQUIRE(std::abs(int{gray_of(is)} - int{gray_of(should)}) <= frame.gray_range());
        }
      }
      REQUIRE(frame.refine(stairs.world.tree, 3000) == Status::kOk);
    }
    const Band all = frame.band(0, size.height);
    CHECK(Picture(all.pixels.begin(), all.pixels.end()) == wanted);
  }
}

TEST_CASE("panel formats: samples -> the encoder's, rows of a page one after another") {
  Stairs stairs;
  const Size size{61, 37};
  const Camera fine = stairs.look(3 * size.width, 3 * size.height);
  Picture rows(samples_bytes(size.width, 3));
  const auto draw = [&](const Band& band) {
    for (int row = 0; row < band.rows; ++row) {
      const int y = band.first_row + row;
      REQUIRE(render_band(stairs.world.tree, fine, stairs.world.shading,
                          {{rows.data(), rows.size()}, PixelFormat::kRgb888, 0, 3 * y, 3}) == Status::kOk);
      const std::size_t line = row_bytes(band.format, size.width);
      const std::size_t stride = band.stride_bytes == 0 ? line : band.stride_bytes;
      const Bytes to = band.pixels.subspan(stride * row_place(band.format, row), line);
      const Status status = average_samples({rows.data(), rows.size()}, 3, size.width, y, band.format, to);
      if (status != Status::kOk) {
        return status;
      }
    }
    return Status::kOk;
  };
  expect_encoded(size, in_rgb(size, draw), draw);
}

TEST_CASE(
    "panel formats: lit pictures -> the dithered levels of their formats, whatever the order of bytes") {
  Stairs stairs;
  stairs.world.lights.push_back(testing::sun({-3, -5, 9}, 300));
  for (std::size_t i = 0; i < 16; ++i) {
    stairs.world.surfaces[i] = testing::surface(SurfaceKind::kDiffuse, stairs.palette[i]);
  }
  stairs.world.finish();
  const Size size{61, 37};
  const Camera& camera = stairs.look(size.width, size.height);
  for (const bool dither : {true, false}) {
    LitOptions options;
    options.dither = dither;
    const auto draw = [&](const Band& band) {
      return render_lit_band(Effect::kDirectLight | Effect::kShadows, stairs.world.tree, camera,
                             stairs.world.shading, stairs.world.scene, band, nullptr, options);
    };
    const auto shown = [&](PixelFormat format) {
      const Picture bytes = in_bands(size.width, size.height, format, 8, 0, draw);
      REQUIRE(bytes == in_bands(size.width, size.height, format, size.height, 2, draw));
      std::vector<Rgb8> colors;
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          colors.push_back(
              load_pixel(bytes.data() + row_place(format, y) * row_bytes(format, size.width), x, y, format));
        }
      }
      return colors;
    };
    CHECK(shown(PixelFormat::kRgb565Be) == shown(PixelFormat::kRgb565));
    CHECK(shown(PixelFormat::kBgr565) == shown(PixelFormat::kRgb565));
    CHECK(shown(PixelFormat::kMono1Pages) == shown(PixelFormat::kMono1));
    CHECK(shown(PixelFormat::kGray4Low) == shown(PixelFormat::kGray4));
    // Each of the others is within a level of the picture in 8 bits, everywhere, or half of one without dither.
    const std::vector<Rgb8> exact = shown(PixelFormat::kRgb888);
    const auto most_error = [&](PixelFormat format, bool by_gray) {
      const std::vector<Rgb8> colors = shown(format);
      int most = 0;
      for (std::size_t i = 0; i < colors.size(); ++i) {
        const Rgb8 is = colors[i];
        const Rgb8 should = exact[i];
        most = std::max(most, by_gray ? std::abs(is.r - gray_of(should))
                                      : std::max(std::abs(is.r - should.r), std::abs(is.g - should.g)));
      }
      return most;
    };
    CHECK(most_error(PixelFormat::kRgb444, false) <= (dither ? 18 : 10));
    CHECK(most_error(PixelFormat::kRgb332, false) <= (dither ? 37 : 20));
    CHECK(most_error(PixelFormat::kGray2, true) <= (dither ? 86 : 45));
    // Paper is dithered from 8 bits, so it is what the encoder makes of those.
    if (dither) {
      const Picture rgb = in_rgb(size, draw);
      for (const PixelFormat format : {PixelFormat::kPaper3, PixelFormat::kPaper7}) {
        CHECK(in_bands(size.width, size.height, format, 8, 0, draw) ==
              encoded(rgb, size.width, size.height, format));
      }
    }
  }
}

TEST_CASE("panel formats: parts of pages -> kBadArgument, nothing drawn; a format that is none -> refused") {
  Stairs stairs;
  const Camera& camera = stairs.look(16, 20);
  Picture bytes(1000, 0x5A);
  const auto status_of = [&](int first, int rows, std::size_t size, std::size_t stride = 0) {
    return render_band(stairs.world.tree, camera, stairs.world.shading,
                       {{bytes.data(), size}, PixelFormat::kMono1Pages, stride, first, rows});
  };
  CHECK(status_of(4, 8, 1000) == Status::kBadArgument);
  CHECK(status_of(1, 19, 1000) == Status::kBadArgument);
  CHECK(status_of(0, 4, 1000) == Status::kBadArgument);
  CHECK(status_of(8, 9, 1000) == Status::kBadArgument);
  CHECK(status_of(0, 8, 15) == Status::kOutOfMemory);
  CHECK(status_of(0, 20, 47) == Status::kOutOfMemory);
  CHECK(status_of(0, 20, 48, 15) == Status::kBadArgument);
  CHECK(status_of(0, 20, 55, 20) == Status::kOutOfMemory);
  CHECK(std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0x5A; }));
  CHECK(status_of(16, 4, 16) == Status::kOk);
  CHECK(status_of(0, 20, 56, 20) == Status::kOk);
  const Band wrong{{bytes.data(), bytes.size()}, static_cast<PixelFormat>(kPixelFormats), 0, 0, 1};
  CHECK(render_band(stairs.world.tree, camera, stairs.world.shading, wrong) == Status::kOutOfMemory);
}

}  // namespace
