// The drivers' face for C: each panel begins and shows what the C++ driver does, and refuses what is no panel, bus or band.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/panel_model.h"
#include "thimble/drivers/panel_c.h"

namespace {

using namespace thimble;
using tests::ColorModel;
using tests::PageModel;

// The model behind a bus of C.
thimble_panel_bus_t bus_of(tests::PanelModel& model) {
  const drivers::PanelBus bus = model.spi();
  return {bus.context, bus.command, bus.data, bus.wait_ms};
}

thimble_band_t band_of(std::vector<std::uint8_t>& bytes, std::int32_t format, std::int32_t rows) {
  return {bytes.data(), bytes.size(), 0, format, 0, rows};
}

TEST_CASE("C: panels of pages show a band") {
  using Begin = decltype(&thimble_ssd1306_begin);
  struct Kind {
    PageModel::Kind kind;
    Begin begin;
    int first_column;
  };
  for (const Kind& one : {Kind{PageModel::Kind::kSsd1306, thimble_ssd1306_begin, 0},
                          Kind{PageModel::Kind::kSh1106, thimble_sh1106_begin, 2},
                          Kind{PageModel::Kind::kSt7567, thimble_st7567_begin, 0}}) {
    PageModel model(one.kind, 128, 64, one.first_column);
    const thimble_panel_bus_t bus = bus_of(model);
    thimble_page_panel_t panel{};
    std::vector<std::uint8_t> page(128 * 8, 0xFF);
    const thimble_band_t band = band_of(page, THIMBLE_FORMAT_MONO1_PAGES, 64);
    CHECK_FALSE(thimble_page_panel_show(&panel, &band));  // not begun
    REQUIRE(one.begin(&panel, &bus, 128, 64, -1, 0));
    REQUIRE(thimble_page_panel_show(&panel, &band));
    CHECK(model.picture() == std::vector<bool>(128 * 64, true));
    CHECK(model.fault() == "");
    CHECK_FALSE(one.begin(&panel, &bus, 128, 64, -1, 1));  // by 90 degrees
    CHECK_FALSE(one.begin(&panel, &bus, 128, 64, -1, 4));
    CHECK_FALSE(one.begin(&panel, &bus, 0, 64, -1, 0));
    CHECK_FALSE(one.begin(&panel, nullptr, 128, 64, -1, 0));
    CHECK_FALSE(one.begin(nullptr, &bus, 128, 64, -1, 0));
  }
}

TEST_CASE("C: on I2C the bus puts control bytes before what is sent") {
  PageModel model(PageModel::Kind::kSsd1306, 128, 64, 0);
  const auto write = [](void* context, const std::uint8_t* bytes, std::size_t count) {
    return static_cast<PageModel*>(context)->i2c(bytes, count);
  };
  const auto wait = [](void* context, std::uint32_t ms) { static_cast<PageModel*>(context)->wait(ms); };
  thimble_panel_i2c_t wire;
  const thimble_panel_bus_t bus = thimble_panel_i2c_bus(&wire, &model, write, wait);
  thimble_page_panel_t panel{};
  REQUIRE(thimble_ssd1306_begin(&panel, &bus, 128, 64, -1, 2));
  std::vector<std::uint8_t> page(128, 0x01);
  const thimble_band_t band = band_of(page, THIMBLE_FORMAT_MONO1_PAGES, 8);
  REQUIRE(thimble_page_panel_show(&panel, &band));
  CHECK(model.fault() == "");
  CHECK(model.longest_transfer() == 32);
  CHECK(model.picture()[128 * 63]);  // turned by 180 degrees
  const thimble_panel_bus_t none = thimble_panel_i2c_bus(nullptr, &model, write, wait);
  CHECK_FALSE(thimble_ssd1306_begin(&panel, &none, 128, 64, -1, 0));
}

TEST_CASE("C: colour panels show a band in their format, and no other") {
  ColorModel model(ColorModel::Kind::kSt7789, {240, 240, 240, 320, 0, 0, false, false, false, true});
  const thimble_panel_bus_t bus = bus_of(model);
  thimble_color_panel_t panel{};
  std::vector<std::uint8_t> bytes(240 * 240 * 2, 0xFF);
  thimble_band_t band = band_of(bytes, THIMBLE_FORMAT_RGB565_BE, 240);
  CHECK_FALSE(thimble_color_panel_show(&panel, &band));  // not begun
  REQUIRE(thimble_st7789_begin(&panel, &bus, THIMBLE_ST7789_240X240, THIMBLE_FORMAT_RGB565_BE, 1));
  REQUIRE(thimble_color_panel_show(&panel, &band));
  CHECK(model.picture() == std::vector<std::uint8_t>(240 * 240 * 3, 0xFF));
  CHECK(model.fault() == "");
  band.format = THIMBLE_FORMAT_RGB444;
  CHECK_FALSE(thimble_color_panel_show(&panel, &band));
  band.format = 14;
  CHECK_FALSE(thimble_color_panel_show(&panel, &band));
  CHECK_FALSE(thimble_color_panel_show(&panel, nullptr));
  CHECK_FALSE(thimble_st7789_begin(&panel, &bus, 4, THIMBLE_FORMAT_RGB565_BE, 0));
  CHECK_FALSE(thimble_st7789_begin(&panel, &bus, -1, THIMBLE_FORMAT_RGB565_BE, 0));
  CHECK_FALSE(thimble_st7789_begin(&panel, &bus, THIMBLE_ST7789_240X240, THIMBLE_FORMAT_GRAY4, 0));
}

TEST_CASE("C: an ILI9341 and an ST7735 begin; the former has 16 bits a pixel alone") {
  ColorModel large(ColorModel::Kind::kIli9341, {240, 320, 240, 320, 0, 0, true, false, true, false});
  thimble_panel_bus_t bus = bus_of(large);
  thimble_color_panel_t panel{};
  CHECK(thimble_ili9341_begin(&panel, &bus, THIMBLE_FORMAT_RGB565_BE, 3));
  CHECK_FALSE(thimble_ili9341_begin(&panel, &bus, THIMBLE_FORMAT_RGB444, 0));
  ColorModel small(ColorModel::Kind::kSt7735, {128, 160, 132, 162, 2, 1, true, true, true, false});
  bus = bus_of(small);
  CHECK(thimble_st7735_begin(&panel, &bus, THIMBLE_ST7735_128X160_GREEN, THIMBLE_FORMAT_RGB444, 0));
  CHECK(large.fault() + small.fault() == "");
}

}  // namespace
