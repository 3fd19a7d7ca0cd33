#include "thimble/drivers/panel.h"

namespace thimble::drivers {
namespace {

// Commands that all three have.
constexpr uint8_t kColumnLow = 0x00;
constexpr uint8_t kColumnHigh = 0x10;
constexpr uint8_t kStartLine = 0x40;
constexpr uint8_t kContrast = 0x81;
constexpr uint8_t kSegmentsForward = 0xA0;
constexpr uint8_t kSegmentsBackward = 0xA1;
constexpr uint8_t kFromMemory = 0xA4;
constexpr uint8_t kNormal = 0xA6;
constexpr uint8_t kInverse = 0xA7;
constexpr uint8_t kOff = 0xAE;
constexpr uint8_t kOn = 0xAF;
constexpr uint8_t kPage = 0xB0;
constexpr uint8_t kRowsForward = 0xC0;
constexpr uint8_t kRowsBackward = 0xC8;
// SSD1306 and SH1106.
constexpr uint8_t kMultiplex = 0xA8;
constexpr uint8_t kOffset = 0xD3;
constexpr uint8_t kClock = 0xD5;
constexpr uint8_t kPrecharge = 0xD9;
constexpr uint8_t kRowPins = 0xDA;
constexpr uint8_t kVcomh = 0xDB;
// SSD1306.
constexpr uint8_t kAddressing = 0x20;
constexpr uint8_t kColumns = 0x21;
constexpr uint8_t kPages = 0x22;
constexpr uint8_t kChargePump = 0x8D;
constexpr uint8_t kScrollOff = 0x2E;
constexpr uint8_t kReference = 0xAD;
// SH1106.
constexpr uint8_t kPumpVoltage = 0x30;
constexpr uint8_t kConverter = 0xAD;
// ST7567.
constexpr uint8_t kRatio = 0x20;
constexpr uint8_t kPower = 0x28;
constexpr uint8_t kBias9 = 0xA2;
constexpr uint8_t kAllOn = 0xA5;
constexpr uint8_t kReset = 0xE2;

constexpr int32_t kMostRows = 64;

// The modules' rows that are wired in turns from both ends; those of 32 rows and less in sequence, but for 40 and 48.
constexpr uint8_t row_pins(int32_t rows) {
  return rows > 32 ? 0x12 : 0x02;
}

}  // namespace

bool PagePanel::begin(Kind kind, const PanelBus& bus, const PageGeometry& geometry, Rotation rotation) {
  const int32_t memory = kind == Kind::kSsd1306 ? 128 : 132;
  const int32_t usual = kind == Kind::kSh1106 ? 2 : 0;
  int32_t first = geometry.first_column == PageGeometry::kUsual ? usual : geometry.first_column;
  const bool turned = rotation == Rotation::k180;
  if (bus.command == nullptr || bus.data == nullptr || bus.wait_ms == nullptr ||
      (rotation != Rotation::kNone && !turned) || geometry.width_px < 1 || first < 0 ||
      geometry.width_px > memory - first || geometry.height_px < 8 || geometry.height_px > kMostRows ||
      geometry.height_px % 8 != 0) {
    return false;
  }
  // Counted from the other end, as many columns lie behind the last one that is shown.
  first = turned ? memory - geometry.width_px - first : first;
  bus_ = bus;
  kind_ = kind;
  geometry_ = {geometry.width_px, geometry.height_px, first};
  return true;
}

// Where the next data go: a window where the controller has them, else one page.
bool PagePanel::place(int32_t column, int32_t page, int32_t columns, int32_t pages) {
  const auto byte = [](int32_t value) { return static_cast<uint8_t>(value); };
  const int32_t first = geometry_.first_column + column;
  if (kind_ == Kind::kSsd1306) {
    return commands(
        {kColumns, byte(first), byte(first + columns - 1), kPages, byte(page), byte(page + pages - 1)});
  }
  return commands({byte(kPage | page), byte(kColumnHigh | first >> 4), byte(kColumnLow | (first & 15))});
}

bool PagePanel::show_part(int32_t x, int32_t y, int32_t width_px, int32_t height_px, const uint8_t* bytes,
                          size_t stride_bytes) {
  const size_t width = static_cast<size_t>(width_px);
  const size_t stride = stride_bytes == 0 ? width : stride_bytes;
  if (x < 0 || y < 0 || width_px < 1 || height_px < 1 || x > geometry_.width_px - width_px ||
      y > geometry_.height_px - height_px || y % 8 != 0 || height_px % 8 != 0 || stride < width) {
    return false;
  }
  const int32_t page = y / 8;
  const int32_t pages = height_px / 8;
  const bool has_windows = kind_ == Kind::kSsd1306;
  if (has_windows && !place(x, page, width_px, pages)) {
    return false;
  }
  for (int32_t i = 0; i < pages; ++i, bytes += stride) {
    if ((!has_windows && !place(x, page + i, width_px, 1)) || !bus_.data(bus_.context, bytes, width)) {
      return false;
    }
  }
  return true;
}

bool PagePanel::show(const Band& band) {
  const size_t stride = band.stride_bytes == 0 ? static_cast<size_t>(geometry_.width_px) : band.stride_bytes;
  if (band.format != PixelFormat::kMono1Pages || band.rows < 1 ||
      stride < static_cast<size_t>(geometry_.width_px) || band.rows % 8 != 0 ||
      band.pixels.size <
          stride * static_cast<size_t>(band.rows / 8 - 1) + static_cast<size_t>(geometry_.width_px)) {
    return false;
  }
  return show_part(0, band.first_row, geometry_.width_px, band.rows, band.pixels.data, stride);
}

// The memory holds anything when the power comes on.
bool PagePanel::clear() {
  const uint8_t zeros[16] = {};
  for (int32_t page = 0; page < geometry_.height_px / 8; ++page) {
    for (int32_t x = 0; x < geometry_.width_px; x += 16) {
      const int32_t left = geometry_.width_px - x;
      if (!show_part(x, 8 * page, left < 16 ? left : 16, 8, zeros)) {
        return false;
      }
    }
  }
  return true;
}

bool PagePanel::inverse(bool on) {
  return commands({on ? kInverse : kNormal});
}

bool PagePanel::sleep(bool on) {
  if (kind_ == Kind::kSt7567) {
    // All points on while off is the power save mode.
    return on ? commands({kOff, kAllOn}) : commands({kFromMemory, kOn});
  }
  return commands({on ? kOff : kOn});
}

bool PagePanel::contrast(uint8_t level) {
  return (kind_ != Kind::kSt7567 || level < 64) && commands({kContrast, level});
}

bool PagePanel::begin_oled(const Oled& oled, const PageGeometry& geometry, Rotation rotation) {
  const bool turned = rotation == Rotation::k180;
  if (!commands({kClock,
                 oled.clock,
                 kMultiplex,
                 static_cast<uint8_t>(geometry.height_px - 1),
                 kOffset,
                 0,
                 kStartLine,
                 oled.power[0],
                 oled.power[1],
                 oled.power[2],
                 oled.power[3],
                 turned ? kSegmentsForward : kSegmentsBackward,
                 turned ? kRowsForward : kRowsBackward,
                 kRowPins,
                 row_pins(geometry.height_px),
                 kContrast,
                 oled.contrast,
                 kPrecharge,
                 oled.precharge,
                 kVcomh,
                 oled.vcomh,
                 kFromMemory,
                 kNormal}) ||
      !clear() || !commands({kOn})) {
    return false;
  }
  wait(100);  // until the pump has its voltage
  return true;
}

bool Ssd1306::begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation) {
  // A reset of the board alone leaves a scroll running that somebody has started. The module of 72 x 40 has no resistor
  // for the segments' current, so that the controller's own reference sets it: 30 uA.
  constexpr Oled kOled{0x80, {kChargePump, 0x14, kAddressing, 0x00}, 0x7F, 0xF1, 0x20};
  return PagePanel::begin(Kind::kSsd1306, bus, geometry, rotation) && commands({kOff, kScrollOff}) &&
         (geometry.width_px != 72 || geometry.height_px != 40 || commands({kReference, 0x30})) &&
         begin_oled(kOled, geometry, rotation);
}

bool Sh1106::begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation) {
  constexpr Oled kOled{0x50, {kConverter, 0x8B, kPumpVoltage | 2, kOff}, 0x80, 0x22, 0x35};  // it is off
  return PagePanel::begin(Kind::kSh1106, bus, geometry, rotation) && commands({kOff}) &&
         begin_oled(kOled, geometry, rotation);
}

bool St7567::begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation) {
  const bool turned = rotation == Rotation::k180;
  if (!PagePanel::begin(Kind::kSt7567, bus, geometry, rotation) || !commands({kReset})) {
    return false;
  }
  wait(5);
  if (!commands({kBias9, turned ? kSegmentsBackward : kSegmentsForward, turned ? kRowsForward : kRowsBackward,
                 kStartLine, kRatio | 5, kContrast, 32})) {
    return false;
  }
  // Booster, regulator, follower: one after another, each when the one before is up.
  constexpr uint8_t kParts[] = {4, 6, 7};
  for (const uint8_t parts : kParts) {
    if (!commands({static_cast<uint8_t>(kPower | parts)})) {
      return false;
    }
    wait(50);
  }
  return clear() && commands({kFromMemory, kNormal, kOn});
}

}  // namespace thimble::drivers
