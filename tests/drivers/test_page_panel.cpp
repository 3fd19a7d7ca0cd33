// SSD1306, SH1106 and ST7567 by their drivers, on models that know the controllers' commands: what is seen is the
// picture, at every rotation, in parts, over SPI and I2C.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "support/panel_model.h"
#include "thimble/drivers/panel.h"

namespace {

using namespace thimble;
using namespace thimble::drivers;
using tests::PageModel;

// Any picture, in pages and as what is to be seen.
struct PagePicture {
  int width;
  int height;
  std::vector<std::uint8_t> pages;

  PagePicture(int w, int h, unsigned seed)
      : width(w), height(h), pages(band_bytes(PixelFormat::kMono1Pages, w, h)) {
    std::mt19937 random(seed);
    for (std::uint8_t& byte : pages) {
      byte = static_cast<std::uint8_t>(random());
    }
  }
  Band band(int first, int rows) {
    const auto at = static_cast<std::size_t>(first / 8 * width);
    return {{pages.data() + at, pages.size() - at}, PixelFormat::kMono1Pages, 0, first, rows};
  }
  std::vector<bool> seen(bool turned = false) const {
    std::vector<bool> lit;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        lit.push_back((pages[static_cast<std::size_t>(y / 8 * width + x)] >> y % 8 & 1) != 0);
      }
    }
    if (turned) {
      std::reverse(lit.begin(), lit.end());
    }
    return lit;
  }
};

struct PageModule {
  PageModel::Kind kind;
  PageGeometry geometry;
  int first_column;
};
const PageModule kPageModules[] = {
    {PageModel::Kind::kSsd1306, {128, 64}, 0},     {PageModel::Kind::kSsd1306, {128, 32}, 0},
    {PageModel::Kind::kSsd1306, {72, 40, 28}, 28}, {PageModel::Kind::kSsd1306, {64, 48, 32}, 32},
    {PageModel::Kind::kSsd1306, {96, 16, 0}, 0},   {PageModel::Kind::kSh1106, {128, 64}, 2},
    {PageModel::Kind::kSt7567, {128, 64}, 0},
};

TEST_CASE("page panels: set-up, bands in any order, both rotations -> what is seen is the picture") {
  for (const PageModule& module : kPageModules) {
    for (const Rotation rotation : {Rotation::kNone, Rotation::k180}) {
      CAPTURE(static_cast<int>(module.kind));
      CAPTURE(module.geometry.width_px);
      const int width = module.geometry.width_px;
      const int height = module.geometry.height_px;
      PageModel model(module.kind, width, height, module.first_column);
      PagePicture picture(width, height, 7);
      tests::with_panel<Ssd1306, Sh1106, St7567>(module.kind, [&](auto& panel) {
        REQUIRE(panel.begin(model.spi(), module.geometry, rotation));
        CHECK(model.is_on());
        CHECK(model.picture() == std::vector<bool>(static_cast<std::size_t>(width * height)));  // cleared
        for (int row = height - 8; row >= 0; row -= 8) {
          REQUIRE(panel.show(picture.band(row, 8)));
        }
        CHECK(model.picture() == picture.seen(rotation == Rotation::k180));
        PagePicture other(width, height, 8);
        REQUIRE(panel.show(other.band(0, height)));
        CHECK(model.picture() == other.seen(rotation == Rotation::k180));
        // A part, with a stride of its own.
        const int x = width / 3;
        REQUIRE(panel.show_part(x, 8, width / 2, 8, picture.pages.data(), static_cast<std::size_t>(width)));
        for (int i = 0; i < width / 2; ++i) {
          other.pages[static_cast<std::size_t>(width + x + i)] = picture.pages[static_cast<std::size_t>(i)];
        }
        CHECK(model.picture() == other.seen(rotation == Rotation::k180));
        REQUIRE(panel.inverse(true));
        std::vector<bool> inverse = other.seen(rotation == Rotation::k180);
        inverse.flip();
        CHECK(model.picture() == inverse);
        REQUIRE(panel.inverse(false));
        REQUIRE(panel.sleep(true));
        CHECK(!model.is_on());
        REQUIRE(panel.sleep(false));
        CHECK(model.picture() == other.seen(rotation == Rotation::k180));
        REQUIRE(panel.contrast(40));
        CHECK(model.contrast() == 40);
      });
      CHECK(model.fault() == "");
    }
  }
}

TEST_CASE(
    "page panels over I2C: control bytes, no transfer beyond 32 bytes -> the same; a panel that is not "
    "there") {
  PageModel model(PageModel::Kind::kSsd1306, 128, 64, 0);
  I2cPanel<> wire(
      &model,
      [](void* self, const std::uint8_t* bytes, std::size_t count) {
        return static_cast<PageModel*>(self)->i2c(bytes, count);
      },
      [](void* self, std::uint32_t ms) { static_cast<PageModel*>(self)->wait(ms); });
  Ssd1306 panel;
  PagePicture picture(128, 64, 3);
  REQUIRE(panel.begin(wire.bus(), {128, 64}));
  REQUIRE(panel.show(picture.band(0, 64)));
  CHECK(model.picture() == picture.seen());
  CHECK(model.longest_transfer() == 32);
  CHECK(model.fault() == "");

  I2cPanel<> cut(
      nullptr, [](void*, const std::uint8_t*, std::size_t) { return false; }, [](void*, std::uint32_t) {});
  CHECK_FALSE(panel.begin(cut.bus(), {128, 64}));
  CHECK_FALSE(panel.show(picture.band(0, 8)));
  CHECK_FALSE(panel.contrast(1));
}

TEST_CASE("page panels: what they do not have -> false, and nothing sent") {
  PageModel model(PageModel::Kind::kSh1106, 128, 64, 2);
  Sh1106 panel;
  CHECK_FALSE(panel.begin(model.spi(), {128, 64}, Rotation::k90));
  CHECK_FALSE(panel.begin(model.spi(), {128, 64}, Rotation::k270));
  CHECK_FALSE(panel.begin(model.spi(), {0, 64}));
  CHECK_FALSE(panel.begin(model.spi(), {131, 64}));
  CHECK_FALSE(panel.begin(model.spi(), {128, 60}));
  CHECK_FALSE(panel.begin(model.spi(), {128, 72}));
  CHECK_FALSE(panel.begin(model.spi(), {128, 64, -2}));
  CHECK_FALSE(panel.begin({}, {128, 64}));
  CHECK(model.bytes_sent() == 0);
  REQUIRE(panel.begin(model.spi(), {128, 64}));
  const std::uint64_t sent = model.bytes_sent();
  PagePicture picture(128, 64, 3);
  Band band = picture.band(0, 8);
  band.rows = 4;
  CHECK_FALSE(panel.show(band));
  band = picture.band(0, 8);
  band.format = PixelFormat::kMono1;
  CHECK_FALSE(panel.show(band));
  band = picture.band(8, 64);
  CHECK_FALSE(panel.show(band));
  band = picture.band(0, 8);
  band.pixels.size = 127;
  CHECK_FALSE(panel.show(band));
  band = picture.band(0, 16);
  band.stride_bytes = 100;
  CHECK_FALSE(panel.show(band));
  const std::uint8_t bytes[128] = {};
  CHECK_FALSE(panel.show_part(-1, 0, 8, 8, bytes));
  CHECK_FALSE(panel.show_part(121, 0, 8, 8, bytes));
  CHECK_FALSE(panel.show_part(0, 4, 8, 8, bytes));
  CHECK_FALSE(panel.show_part(0, 0, 8, 4, bytes));
  CHECK_FALSE(panel.show_part(0, 64, 8, 8, bytes));
  CHECK_FALSE(panel.show_part(0, 0, INT32_MAX, 8, bytes));
  CHECK(model.bytes_sent() == sent);
  St7567 lcd;
  PageModel lcd_model(PageModel::Kind::kSt7567, 128, 64, 0);
  REQUIRE(lcd.begin(lcd_model.spi(), {128, 64}));
  CHECK_FALSE(lcd.contrast(64));
  CHECK(model.fault() == "");
  CHECK(lcd_model.fault() == "");
}

TEST_CASE("page panels: the model tells a set-up without its steps") {
  const auto fault_of = [](PageModel::Kind kind, const std::vector<std::uint8_t>& bytes) {
    PageModel model(kind, 128, 64, kind == PageModel::Kind::kSh1106 ? 2 : 0);
    const PanelBus bus = model.spi();
    bus.command(bus.context, bytes.data(), bytes.size());
    return model.fault();
  };
  CHECK(fault_of(PageModel::Kind::kSsd1306, {0x81, 1, 0xAF}) == "on without the pump");
  CHECK(fault_of(PageModel::Kind::kSsd1306, {0x8D, 0x14, 0xDA, 0x12, 0x81, 1, 0xAF}) ==
        "on while it may scroll");
  CHECK(fault_of(PageModel::Kind::kSsd1306, {0x2E, 0x8D, 0x14, 0xDA, 0x02, 0x81, 1, 0xAF}) ==
        "on with the rows of another panel");
  CHECK(fault_of(PageModel::Kind::kSsd1306, {0x2E, 0x8D, 0x14, 0xDA, 0x12, 0x81, 1, 0xAF}) ==
        "on with a memory that was never written");
  CHECK(fault_of(PageModel::Kind::kSsd1306, {0x20, 0x00, 0x21, 10, 128}) == "a window beyond the memory");
  CHECK(fault_of(PageModel::Kind::kSh1106, {0x21, 0, 127}) == "unknown command 21");
  CHECK(fault_of(PageModel::Kind::kSt7567, {0x81, 1, 0x2C, 0x2E}) ==
        "the supplies were not started one after another");
  CHECK(fault_of(PageModel::Kind::kSt7567, {0xD5}) == "unknown command D5");
}

}  // namespace
