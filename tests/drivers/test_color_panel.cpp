// ST7735, ST7789 and ILI9341 by their drivers, on models that know the controllers' commands, times and memory: what
// is seen is the picture, at every rotation and offset, in parts, in 16 and 12 bits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/panel_model.h"
#include "thimble/drivers/panel.h"

namespace {

using namespace thimble;
using namespace thimble::drivers;
using tests::ColorModel;

constexpr Rotation kRotations[] = {Rotation::kNone, Rotation::k90, Rotation::k180, Rotation::k270};

struct Module {
  ColorModel::Kind kind;
  ColorGeometry geometry;
};
const Module kModules[] = {
    {ColorModel::Kind::kSt7735, St7735::k128x160},      {ColorModel::Kind::kSt7735, St7735::k128x160Red},
    {ColorModel::Kind::kSt7735, St7735::k128x160Green}, {ColorModel::Kind::kSt7735, St7735::k128x128Green},
    {ColorModel::Kind::kSt7735, St7735::k80x160},       {ColorModel::Kind::kSt7789, St7789::k240x320},
    {ColorModel::Kind::kSt7789, St7789::k240x240},      {ColorModel::Kind::kSt7789, St7789::k135x240},
    {ColorModel::Kind::kSt7789, St7789::k170x320},      {ColorModel::Kind::kIli9341, Ili9341::k240x320},
};

ColorModel::Glass glass_of(const ColorGeometry& g) {
  return {g.width_px,  g.height_px, g.memory_width, g.memory_height, g.first_column,
          g.first_row, g.mirrors_x, g.mirrors_y,    g.is_bgr,        g.is_inverse};
}

// A glass is made of what the driver says of it, so that what the modules are is said once more: which have blue first
// (Adafruit-ST7735-Library, initR: all but the black tab; ILI9341: all that are sold).
TEST_CASE(
    "colour panels: the modules' order of subpixels -> blue first on red and green tabs and the ILI9341") {
  CHECK_FALSE(St7735::k128x160.is_bgr);
  for (const ColorGeometry& blue_first : {St7735::k128x160Red, St7735::k128x160Green, St7735::k128x128Green,
                                          St7735::k80x160, Ili9341::k240x320}) {
    CHECK(blue_first.is_bgr);
  }
  for (const ColorGeometry& red_first :
       {St7789::k240x320, St7789::k240x240, St7789::k135x240, St7789::k170x320}) {
    CHECK_FALSE(red_first.is_bgr);
  }
}

// A picture in a format, and what is seen of it before a glass that is turned back.
struct Picture {
  int width;
  int height;
  PixelFormat format;
  std::vector<std::uint8_t> bytes;

  Picture(int w, int h, PixelFormat f, unsigned seed)
      : width(w), height(h), format(f), bytes(band_bytes(f, w, h)) {
    std::mt19937 random(seed);
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const unsigned value = static_cast<unsigned>(random());
        put(x, y,
            {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
             static_cast<std::uint8_t>(x + 3 * y)});
      }
    }
  }
  std::uint8_t* row(int y) { return bytes.data() + row_bytes(format, width) * static_cast<std::size_t>(y); }
  void put(int x, int y, const Rgb8& color) {
    clear_panel_pixel(row(y), x, y, format);
    store_pixel(row(y), x, y, format, color);
  }
  Band band(int first, int rows) {
    const std::size_t at = row_bytes(format, width) * static_cast<std::size_t>(first);
    return {{bytes.data() + at, bytes.size() - at}, format, 0, first, rows};
  }
  // Turned by so many quarters clockwise: the top left goes to the top right.
  std::vector<std::uint8_t> seen(Rotation rotation) {
    const int quarters = static_cast<int>(rotation);
    const int across = quarters % 2 == 0 ? width : height;
    const int down = quarters % 2 == 0 ? height : width;
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < down; ++y) {
      for (int x = 0; x < across; ++x) {
        const int from_x = quarters == 0   ? x
                           : quarters == 1 ? y
                           : quarters == 2 ? width - 1 - x
                                           : width - 1 - y;
        const int from_y = quarters == 0   ? y
                           : quarters == 1 ? height - 1 - x
                           : quarters == 2 ? height - 1 - y
                                           : x;
        const Rgb8 color = load_pixel(row(from_y), from_x, from_y, format);
        rgb.insert(rgb.end(), {color.r, color.g, color.b});
      }
    }
    return rgb;
  }
};

TEST_CASE(
    "colour panels: set-up, every module and rotation, bands in any order -> what is seen is the picture") {
  for (const Module& module : kModules) {
    for (const Rotation rotation : kRotations) {
      for (const PixelFormat format : {PixelFormat::kRgb565Be, PixelFormat::kRgb444}) {
        CAPTURE(static_cast<int>(module.kind));
        CAPTURE(module.geometry.width_px);
        CAPTURE(static_cast<int>(rotation));
        CAPTURE(static_cast<int>(format));
        const bool exchanged = rotation == Rotation::k90 || rotation == Rotation::k270;
        const int width = exchanged ? module.geometry.height_px : module.geometry.width_px;
        const int height = exchanged ? module.geometry.width_px : module.geometry.height_px;
        const bool has =
            format == PixelFormat::kRgb565Be || (module.kind != ColorModel::Kind::kIli9341 && width % 2 == 0);
        ColorModel model(module.kind, glass_of(module.geometry));
        tests::with_panel<St7735, St7789, Ili9341>(module.kind, [&](auto& panel) {
          REQUIRE(panel.begin(model.spi(), module.geometry, format, rotation) == has);
          if (!has) {
            return;
          }
          CHECK(panel.width_px() == width);
          CHECK(panel.height_px() == height);
          CHECK(model.is_on());
          CHECK(model.picture() ==
                std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), 0));
          Picture picture(width, height, format, 5);
          for (int row = (height - 1) / 16 * 16; row >= 0; row -= 16) {
            REQUIRE(panel.show(picture.band(row, std::min(16, height - row))));
          }
          CHECK(model.picture() == picture.seen(rotation));
          // A part: a window of 10 x 3 in the middle, white.
          REQUIRE(panel.window(width / 2, height / 3, 10, 3));
          const std::vector<std::uint8_t> white(row_bytes(format, 10) * 3, 0xFF);
          REQUIRE(panel.data(white.data(), white.size()));
          for (int i = 0; i < 30; ++i) {
            picture.put(width / 2 + i % 10, height / 3 + i / 10, {255, 255, 255});
          }
          CHECK(model.picture() == picture.seen(rotation));
        });
        CHECK(model.fault() == "");
      }
    }
  }
}

TEST_CASE("colour panels: rows with gaps, inverse, sleep -> as asked for") {
  ColorModel model(ColorModel::Kind::kSt7789, glass_of(St7789::k240x240));
  St7789 panel;
  REQUIRE(panel.begin(model.spi(), St7789::k240x240, PixelFormat::kRgb565Be, Rotation::k90));
  Picture picture(240, 240, PixelFormat::kRgb565Be, 9);
  std::vector<std::uint8_t> wide(490 * 8);
  for (int y = 0; y < 240; y += 8) {
    for (int row = 0; row < 8; ++row) {
      std::copy_n(picture.row(y + row), 480, wide.begin() + 490 * row);
    }
    REQUIRE(panel.show({{wide.data(), wide.size()}, PixelFormat::kRgb565Be, 490, y, 8}));
  }
  const std::vector<std::uint8_t> seen = picture.seen(Rotation::k90);
  CHECK(model.picture() == seen);
  REQUIRE(panel.inverse(true));
  CHECK(model.picture()[0] == 255 - seen[0]);
  REQUIRE(panel.inverse(false));
  REQUIRE(panel.sleep(true));
  CHECK(!model.is_on());
  REQUIRE(panel.sleep(false));
  CHECK(model.picture() == seen);
  CHECK(model.fault() == "");
}

TEST_CASE("colour panels: what they do not have -> false, and nothing sent") {
  ColorModel model(ColorModel::Kind::kSt7789, glass_of(St7789::k240x320));
  St7789 panel;
  CHECK_FALSE(panel.begin(model.spi(), St7789::k240x320, PixelFormat::kRgb565));
  CHECK_FALSE(panel.begin(model.spi(), St7789::k240x320, PixelFormat::kMono1Pages));
  CHECK_FALSE(panel.begin({}, St7789::k240x320, PixelFormat::kRgb565Be));
  ColorGeometry beyond = St7789::k240x320;
  beyond.first_row = 1;
  CHECK_FALSE(panel.begin(model.spi(), beyond, PixelFormat::kRgb565Be));
  CHECK(model.bytes_sent() == 0);
  REQUIRE(panel.begin(model.spi(), St7789::k240x320, PixelFormat::kRgb444));
  const std::uint64_t sent = model.bytes_sent();
  CHECK_FALSE(panel.window(0, 0, 3, 3));  // half a byte would be left
  CHECK_FALSE(panel.window(-1, 0, 2, 2));
  CHECK_FALSE(panel.window(239, 0, 2, 2));
  CHECK_FALSE(panel.window(0, 319, 2, 2));
  CHECK_FALSE(panel.window(0, 0, INT32_MAX - 1, 2));
  Picture picture(240, 320, PixelFormat::kRgb444, 1);
  Band band = picture.band(0, 8);
  band.format = PixelFormat::kRgb565Be;
  CHECK_FALSE(panel.show(band));
  band = picture.band(312, 9);
  CHECK_FALSE(panel.show(band));
  band = picture.band(0, 8);
  band.pixels.size = 8 * 360 - 1;
  CHECK_FALSE(panel.show(band));
  CHECK(model.bytes_sent() == sent);
  CHECK(model.fault() == "");
}

TEST_CASE("colour panels: the model tells what a controller does not forgive") {
  struct Step {
    std::uint8_t command;
    std::vector<std::uint8_t> data;
    std::uint32_t wait;
  };
  const auto fault_of = [](const std::vector<Step>& steps) {
    ColorModel model(ColorModel::Kind::kSt7789, glass_of(St7789::k240x240));
    const PanelBus bus = model.spi();
    for (const Step& step : steps) {
      bus.command(bus.context, &step.command, 1);
      bus.data(bus.context, step.data.data(), step.data.size());
      bus.wait_ms(bus.context, step.wait);
    }
    return model.fault();
  };
  CHECK(fault_of({{0x11, {}, 0}}) == "a command before the reset");
  CHECK(fault_of({{0x01, {}, 0}, {0x11, {}, 0}}) == "a command, the reset having come, after 0 ms");
  CHECK(fault_of({{0x01, {}, 100}, {0x11, {}, 0}}) == "out of sleep, the reset having come, after 100 ms");
  CHECK(fault_of({{0x01, {}, 120}, {0x11, {}, 5}, {0x29, {}, 0}}) == "on, out of sleep after 5 ms");
  CHECK(fault_of({{0x01, {}, 120}, {0x29, {}, 0}}) == "on while asleep");
  CHECK(fault_of({{0x01, {}, 120}, {0xB1, {}, 0}}) == "unknown command 177");
  CHECK(fault_of({{0x01, {}, 120}, {0x2A, {0, 0, 0, 240}, 0}}) == "a window beyond the memory");
  CHECK(fault_of({{0x01, {}, 120}, {0x3A, {0x56}, 0}}) == "a pixel format that it does not have");
  CHECK(fault_of({{0x01, {}, 120},
                  {0x3A, {0x55}, 0},
                  {0x2A, {0, 0, 0, 0}, 0},
                  {0x2B, {0, 0, 0, 0}, 0},
                  {0x2C, {1, 2, 3, 4}, 0}}) == "more pixels than the window has");
}

}  // namespace
