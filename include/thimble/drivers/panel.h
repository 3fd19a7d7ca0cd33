/// @file panel.h
/// Drivers of displays: SSD1306, SH1106, ST7567 (black and white, in pages), ST7735, ST7789, ILI9341 (colour),
/// over three functions of the board's.
///
/// A driver is a plain object: no virtual function, no heap, no static variable. It keeps a few numbers and sends
/// bytes by the board's functions; how they get to the panel (SPI with a D/C pin, I2C, a parallel bus) is the
/// board's. Reset is, too: hold the panel's RES low for 10 us and wait 120 ms before `begin`.
///
/// Every function of a driver returns false as soon as the board's function did, or where an argument is not one
/// that the panel takes; then nothing was sent.
#ifndef THIMBLE_DRIVERS_PANEL_H
#define THIMBLE_DRIVERS_PANEL_H

#include <stddef.h>
#include <stdint.h>

#include "../picture/render.h"

namespace thimble::drivers {

/// The board's functions. `context` is handed to each of them. They return whether the panel took the bytes, and may
/// not keep the pointer.
struct PanelBus {
  void* context = nullptr;
  bool (*command)(void* context, const uint8_t* bytes, size_t count) = nullptr;  ///< with D/C low
  bool (*data)(void* context, const uint8_t* bytes, size_t count) = nullptr;     ///< with D/C high
  void (*wait_ms)(void* context, uint32_t milliseconds) = nullptr;
};

/// The picture on the panel, turned clockwise.
enum class Rotation : uint8_t { kNone, k90, k180, k270 };

/// A panel on I2C: every transfer begins with a control byte, 0x00 before commands and 0x40 before data (SSD1306 data
/// sheet, Rev 1.1, section 8.1.5.2), and is kBytes long at most, the control byte in it: 32 is what many drivers of
/// I2C hold. The board supplies the write of one transfer to the panel's address (0x3C or 0x3D) and the wait.
template <size_t kBytes = 32>
class I2cPanel {
 public:
  static_assert(kBytes >= 2);
  using Write = bool (*)(void* context, const uint8_t* bytes, size_t count);
  using Wait = void (*)(void* context, uint32_t milliseconds);

  I2cPanel(void* context, Write write, Wait wait_ms) : context_(context), write_(write), wait_ms_(wait_ms) {}
  /// For a driver. This object outlives the driver's use.
  PanelBus bus() { return {this, command, data, wait}; }

 private:
  static bool command(void* self, const uint8_t* bytes, size_t count) {
    return static_cast<I2cPanel*>(self)->send(0x00, bytes, count);
  }
  static bool data(void* self, const uint8_t* bytes, size_t count) {
    return static_cast<I2cPanel*>(self)->send(0x40, bytes, count);
  }
  static void wait(void* self, uint32_t milliseconds) {
    I2cPanel* const panel = static_cast<I2cPanel*>(self);
    panel->wait_ms_(panel->context_, milliseconds);
  }
  bool send(uint8_t control, const uint8_t* bytes, size_t count) {
    uint8_t chunk[kBytes];
    chunk[0] = control;
    while (count > 0) {
      const size_t some = count < kBytes - 1 ? count : kBytes - 1;
      for (size_t i = 0; i < some; ++i) {
        chunk[i + 1] = bytes[i];
      }
      if (!write_(context_, chunk, some + 1)) {
        return false;
      }
      bytes += some;
      count -= some;
    }
    return true;
  }

  void* context_;
  Write write_;
  Wait wait_ms_;
};

// --- Black-and-white displays in pages of 8 rows, PixelFormat::kMono1Pages: SSD1306, SH1106, ST7567.
//
//     drivers::Ssd1306 panel;
//     panel.begin(bus, {128, 64}, drivers::Rotation::kNone);
//     for (Band band{pixels, PixelFormat::kMono1Pages, 0, 0, 8}; band.first_row < 64; band.first_row += 8) {
//       render_band(tree, camera, shading, band);
//       panel.show(band);
//     }
//
// These controllers turn the picture by 180 degrees, not by 90. Sources, by section:
//   SSD1306  Solomon Systech, SSD1306, Rev 1.1: 8.9 (power on), 9 and 10 (commands), appendix "Charge Pump Regulator";
//            the reference of 72 x 40: u8g2 issue 1047, Zephyr pull request 74885, and SSD1315, "Internal IREF Setting"
//   SH1106   Sino Wealth, SH1106, V2.3: "Commands", "Power On and Initialization"
//   ST7567   Sitronix, ST7567: "Instruction Table", "Operation Flow"

/// What a module shows of its controller's memory (SSD1306 128 columns, SH1106 and ST7567 132), all of 64 rows or the
/// first ones.
struct PageGeometry {
  static constexpr int32_t kUsual = -1;
  int32_t width_px = 128;
  int32_t height_px = 64;
  /// Columns of the memory before the first one that is shown, with the picture not turned; kUsual: SSD1306 0, SH1106
  /// 2, ST7567 0. Modules of 72 x 40 have 28, of 64 x 48 32.
  int32_t first_column = kUsual;
};

/// What the three share. 32 bytes on a 32-bit chip.
class PagePanel {
 public:
  /// Sends the rows of a band in kMono1Pages, as wide as the panel. Whole pages, or up to the panel's end.
  bool show(const Band& band);
  /// Sends a part: columns `x` on, rows `y` on, both multiples of 8 but the last. A page begins every `stride_bytes`
  /// (0: width_px) bytes.
  bool show_part(int32_t x, int32_t y, int32_t width_px, int32_t height_px, const uint8_t* bytes,
                 size_t stride_bytes = 0);
  /// Dark pixels lit and lit ones dark.
  bool inverse(bool on);
  /// The display off, with its memory kept, and on again.
  bool sleep(bool on);
  /// False, and nothing sent, above 63 on an ST7567, whose electronic volume it is.
  bool contrast(uint8_t level);

  int32_t width_px() const { return geometry_.width_px; }
  int32_t height_px() const { return geometry_.height_px; }

 protected:
  enum class Kind : uint8_t { kSsd1306, kSh1106, kSt7567 };
  /// What an OLED's controller is set to: its clock, what feeds the segments, and their levels.
  struct Oled {
    uint8_t clock;
    uint8_t power[4];
    uint8_t contrast;
    uint8_t precharge;
    uint8_t vcomh;
  };
  bool begin(Kind kind, const PanelBus& bus, const PageGeometry& geometry, Rotation rotation);
  /// The rest of `begin`, with the display off.
  bool begin_oled(const Oled& oled, const PageGeometry& geometry, Rotation rotation);
  bool commands(const uint8_t* bytes, size_t count) { return bus_.command(bus_.context, bytes, count); }
  template <size_t kCount>
  bool commands(const uint8_t (&bytes)[kCount]) {
    return commands(bytes, kCount);
  }
  void wait(uint32_t milliseconds) { bus_.wait_ms(bus_.context, milliseconds); }
  bool clear();

 private:
  bool place(int32_t column, int32_t page, int32_t columns, int32_t pages);

  PanelBus bus_;
  PageGeometry geometry_{0, 0, 0};
  Kind kind_ = Kind::kSsd1306;
};

/// 128 x 64, 128 x 32, 96 x 16, 72 x 40, 64 x 48; I2C or SPI.
class Ssd1306 : public PagePanel {
 public:
  /// Sets the panel up, clears it and turns it on. False also for a geometry or a rotation that it does not have.
  bool begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation = Rotation::kNone);
};

/// 128 x 64 in 132 columns.
class Sh1106 : public PagePanel {
 public:
  bool begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation = Rotation::kNone);
};

/// An LCD of 128 x 64 in 132 columns.
class St7567 : public PagePanel {
 public:
  bool begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation = Rotation::kNone);
};

// --- Colour displays: ST7735, ST7789, ILI9341; PixelFormat::kRgb565Be, or kRgb444 where the controller has 12 bits.
//
//     drivers::St7789 panel;
//     panel.begin(bus, drivers::St7789::k240x240, PixelFormat::kRgb565Be, drivers::Rotation::k90);
//     render_band(tree, camera, shading, band);
//     panel.show(band);                     // or: panel.window(x, y, w, h), then panel.data(bytes, size)
//
// Sources, by section:
//   ST7735   Sitronix, ST7735R, V0.2 and ST7735S, V1.1: "Address Control", "Command", "Power Level Definition"
//   ST7789   Sitronix, ST7789V, V1.0: "Address Control", "Command", "Power Level Definition"
//   ILI9341  ILI Technology, ILI9341, V1.11: 8.2 and 8.3 (commands), "MCU to memory write/read direction"

/// What a module shows of its controller's memory, not turned.
struct ColorGeometry {
  int16_t width_px;
  int16_t height_px;
  int16_t memory_width;
  int16_t memory_height;
  int16_t first_column;  ///< of the memory, counted from its own corner
  int16_t first_row;
  bool mirrors_x;  ///< how the glass sits on the memory
  bool mirrors_y;
  bool is_bgr;      ///< blue is the first subpixel
  bool is_inverse;  ///< glass that shows the inverse (IPS)
};

/// What the three share. 36 bytes on a 32-bit chip.
class ColorPanel {
 public:
  /// Where the next data go, row by row, pixels as wide as the format. In kRgb444 the width is even.
  bool window(int32_t x, int32_t y, int32_t width_px, int32_t height_px);
  bool data(const uint8_t* bytes, size_t count) { return bus_.data(bus_.context, bytes, count); }
  /// Sends the rows of a band in the panel's format, as wide as the turned panel.
  bool show(const Band& band);
  bool inverse(bool on);
  /// The display and its clocks off, the memory kept, and on again; takes 120 ms.
  bool sleep(bool on);

  /// As turned.
  int32_t width_px() const { return width_px_; }
  int32_t height_px() const { return height_px_; }

 protected:
  /// Steps of a set-up: a command with its data, then a wait.
  struct Step {
    uint8_t command;
    uint8_t wait_ms;
    uint8_t count;
    uint8_t data[5];
  };
  bool begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format, Rotation rotation,
             Span<const Step> steps, uint8_t pixel_code);

 private:
  bool command(uint8_t code, const uint8_t* bytes, size_t count);
  bool clear();

  PanelBus bus_;
  int32_t width_px_ = 0;
  int32_t height_px_ = 0;
  int32_t first_column_ = 0;
  int32_t first_row_ = 0;
  PixelFormat format_ = PixelFormat::kRgb565Be;
  bool is_inverse_ = false;
};

/// Modules of 1.8", 1.44" and 0.96". The colour of the tab on the protecting foil tells which, mostly. All but the black
/// one have blue first (Adafruit-ST7735-Library, initR; TFT_eSPI issues 213 and 56).
class St7735 : public ColorPanel {
 public:
  static constexpr ColorGeometry k128x160{128, 160, 128, 160, 0, 0, true, true, false, false};  ///< black
  static constexpr ColorGeometry k128x160Red{128, 160, 128, 160, 0, 0, true, true, true, false};
  static constexpr ColorGeometry k128x160Green{128, 160, 132, 162, 2, 1, true, true, true, false};
  static constexpr ColorGeometry k128x128Green{128, 128, 132, 132, 2, 1, true, true, true, false};
  static constexpr ColorGeometry k80x160{80, 160, 132, 162, 26, 1, true, true, true, true};
  /// Sets the panel up, clears it and turns it on.
  bool begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
             Rotation rotation = Rotation::kNone);
};

class St7789 : public ColorPanel {
 public:
  static constexpr ColorGeometry k240x320{240, 320, 240, 320, 0, 0, false, false, false, true};
  static constexpr ColorGeometry k240x240{240, 240, 240, 320, 0, 0, false, false, false, true};
  static constexpr ColorGeometry k135x240{135, 240, 240, 320, 52, 40, false, false, false, true};
  static constexpr ColorGeometry k170x320{170, 320, 240, 320, 35, 0, false, false, false, true};
  bool begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
             Rotation rotation = Rotation::kNone);
};

class Ili9341 : public ColorPanel {
 public:
  static constexpr ColorGeometry k240x320{240, 320, 240, 320, 0, 0, true, false, true, false};
  /// kRgb565Be only: it has 16 and 18 bits.
  bool begin(const PanelBus& bus, const ColorGeometry& geometry, PixelFormat format,
             Rotation rotation = Rotation::kNone);
};

}  // namespace thimble::drivers

#endif
