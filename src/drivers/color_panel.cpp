#include "thimble/drivers/panel.h"

namespace thimble::drivers {
namespace {

constexpr uint8_t kSoftwareReset = 0x01;
constexpr uint8_t kSleepIn = 0x10;
constexpr uint8_t kSleepOut = 0x11;
constexpr uint8_t kNormalMode = 0x13;
constexpr uint8_t kInverseOff = 0x20;
constexpr uint8_t kInverseOn = 0x21;
constexpr uint8_t kDisplayOff = 0x28;
constexpr uint8_t kDisplayOn = 0x29;
constexpr uint8_t kColumnRange = 0x2A;
constexpr uint8_t kRowRange = 0x2B;
constexpr uint8_t kWrite = 0x2C;
constexpr uint8_t kAddressControl = 0x36;
constexpr uint8_t kPixelFormat = 0x3A;

// Of kAddressControl.
constexpr uint8_t kMirrorRows = 0x80;
constexpr uint8_t kMirrorColumns = 0x40;
constexpr uint8_t kExchange = 0x20;
constexpr uint8_t kBgr = 0x08;

// After a reset the controller loads its factory settings; 120 ms pass before it may leave sleep, and 120 more before
// the next step that needs its voltages.
constexpr uint8_t kResetMs = 120;
constexpr uint8_t kSleepMs = 120;

// The code of a format on controllers with 12 and 16 bits; 0: it has none.
constexpr uint8_t code_of(PixelFormat format, uint8_t upper) {
  return format == PixelFormat::kRgb565Be ? static_cast<uint8_t>(upper | 5)
         : format == PixelFormat::kRgb444 ? static_cast<uint8_t>(upper | 3)
                                          : 0;
}

}  // namespace

bool ColorPanel::command(uint8_t code, const uint8_t* bytes, size_t count) {
  return bus_.command(bus_.context, &code, 1) && (count == 0 || bus_.data(bus_.context, bytes, count));
}

bool ColorPanel::begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
                       Rotation rotation, Span<const Step> steps, uint8_t pixel_code) {
  const ColorGeometry& g = geometry;
  if (bus.command == nullptr || bus.data == nullptr || bus.wait_ms == nullptr || pixel_code == 0 ||
      g.width_px < 1 || g.height_px < 1 || g.first_column < 0 || g.first_row < 0 ||
      g.first_column + g.width_px > g.memory_width || g.first_row + g.height_px > g.memory_height) {
    return false;
  }
  // A quarter clockwise: to the right is what was down, and down is what was to the left.
  const bool exchanged = rotation == Rotation::k90 || rotation == Rotation::k270;
  const bool flips_x = rotation == Rotation::k90 || rotation == Rotation::k180;
  const bool flips_y = rotation == Rotation::k180 || rotation == Rotation::k270;
  const bool mirrors_x = g.mirrors_x != flips_x;
  const bool mirrors_y = g.mirrors_y != flips_y;
  const int32_t column = mirrors_x ? g.memory_width - g.first_column - g.width_px : g.first_column;
  const int32_t row = mirrors_y ? g.memory_height - g.first_row - g.height_px : g.first_row;
  bus_ = bus;
  format_ = format;
  is_inverse_ = g.is_inverse;
  width_px_ = exchanged ? g.height_px : g.width_px;
  height_px_ = exchanged ? g.width_px : g.height_px;
  first_column_ = exchanged ? row : column;
  first_row_ = exchanged ? column : row;
  for (const Step& step : steps) {
    if (!command(step.command, step.data, step.count)) {
      return false;
    }
    if (step.wait_ms != 0) {
      bus_.wait_ms(bus_.context, step.wait_ms);
    }
  }
  const uint8_t control =
      static_cast<uint8_t>((mirrors_y ? kMirrorRows : 0) | (mirrors_x ? kMirrorColumns : 0) |
                           (exchanged ? kExchange : 0) | (g.is_bgr ? kBgr : 0));
  return command(kPixelFormat, &pixel_code, 1) && command(kAddressControl, &control, 1) && inverse(false) &&
         command(kNormalMode, nullptr, 0) && clear() && command(kDisplayOn, nullptr, 0);
}

bool ColorPanel::window(int32_t x, int32_t y, int32_t width_px, int32_t height_px) {
  if (x < 0 || y < 0 || width_px < 1 || height_px < 1 || x > width_px_ - width_px ||
      y > height_px_ - height_px || (format_ == PixelFormat::kRgb444 && width_px % 2 != 0)) {
    return false;
  }
  const auto range = [this](uint8_t code, int32_t first, int32_t count) {
    const int32_t last = first + count - 1;
    const uint8_t bytes[] = {static_cast<uint8_t>(first >> 8), static_cast<uint8_t>(first),
                             static_cast<uint8_t>(last >> 8), static_cast<uint8_t>(last)};
    return command(code, bytes, sizeof bytes);
  };
  return range(kColumnRange, first_column_ + x, width_px) && range(kRowRange, first_row_ + y, height_px) &&
         command(kWrite, nullptr, 0);
}

bool ColorPanel::show(const Band& band) {
  const size_t row = row_bytes(format_, width_px_);
  const size_t stride = band.stride_bytes == 0 ? row : band.stride_bytes;
  if (band.format != format_ || band.rows < 1 || stride < row ||
      band.pixels.size < stride * static_cast<size_t>(band.rows - 1) + row ||
      !window(0, band.first_row, width_px_, band.rows)) {
    return false;
  }
  if (stride == row) {
    return data(band.pixels.data, row * static_cast<size_t>(band.rows));
  }
  for (int32_t i = 0; i < band.rows; ++i) {
    if (!data(band.pixels.data + stride * static_cast<size_t>(i), row)) {
      return false;
    }
  }
  return true;
}

// The memory holds anything when the power comes on. Columns are even in number but for 135, where all pixels are two
// bytes.
bool ColorPanel::clear() {
  const uint8_t zeros[32] = {};
  if (!window(0, 0, width_px_, height_px_)) {
    return false;
  }
  size_t left = row_bytes(format_, width_px_) * static_cast<size_t>(height_px_);
  while (left > 0) {
    const size_t some = left < sizeof zeros ? left : sizeof zeros;
    if (!data(zeros, some)) {
      return false;
    }
    left -= some;
  }
  return true;
}

bool ColorPanel::inverse(bool on) {
  return command(on != is_inverse_ ? kInverseOn : kInverseOff, nullptr, 0);
}

bool ColorPanel::sleep(bool on) {
  if (on) {
    const bool sent = command(kDisplayOff, nullptr, 0) && command(kSleepIn, nullptr, 0);
    bus_.wait_ms(bus_.context, kSleepMs);
    return sent;
  }
  if (!command(kSleepOut, nullptr, 0)) {
    return false;
  }
  bus_.wait_ms(bus_.context, kSleepMs);
  return command(kDisplayOn, nullptr, 0);
}

bool St7735::begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
                   Rotation rotation) {
  // Frame rate in normal mode: 333 kHz / ((1 * 2 + 40) * (lines + 2C + 2D)), some 80 frames a second.
  static constexpr Step kSteps[] = {
      {kSoftwareReset, kResetMs, 0, {}}, {kSleepOut, kSleepMs, 0, {}}, {0xB1, 0, 3, {0x01, 0x2C, 0x2D}}};
  return ColorPanel::begin(bus, geometry, format, rotation, Span<const Step>(kSteps, 3), code_of(format, 0));
}

bool St7789::begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
                   Rotation rotation) {
  static constexpr Step kSteps[] = {{kSoftwareReset, kResetMs, 0, {}}, {kSleepOut, kSleepMs, 0, {}}};
  return ColorPanel::begin(bus, geometry, format, rotation, Span<const Step>(kSteps, 2),
                           code_of(format, 0x50));
}

bool Ili9341::begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
                    Rotation rotation) {
  // GVDD 4.6 V; VGH and VGL; VCOMH 4.25 V, VCOML -1.5 V, and their offset; 79 frames a second; 320 lines.
  static constexpr Step kSteps[] = {
      {kSoftwareReset, kResetMs, 0, {}}, {0xC0, 0, 1, {0x23}},        {0xC1, 0, 1, {0x10}},
      {0xC5, 0, 2, {0x3E, 0x28}},        {0xC7, 0, 1, {0x86}},        {0xB1, 0, 2, {0x00, 0x18}},
      {0xB6, 0, 3, {0x08, 0x82, 0x27}},  {kSleepOut, kSleepMs, 0, {}}};
  return ColorPanel::begin(bus, geometry, format, rotation, Span<const Step>(kSteps, 8),
                           format == PixelFormat::kRgb444 ? uint8_t{0} : code_of(format, 0x50));
}

}  // namespace thimble::drivers
