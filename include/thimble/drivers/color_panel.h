/// @file color_panel.h
/// Colour displays: ST7735, ST7789, ILI9341; PixelFormat::kRgb565Be, or kRgb444 where the controller has 12 bits.
///
///     drivers::St7789 panel;
///     panel.begin(bus, drivers::St7789::k240x240, PixelFormat::kRgb565Be, drivers::Rotation::k90);
///     render_band(tree, camera, shading, band);
///     panel.show(band);                     // or: panel.window(x, y, w, h), then panel.data(bytes, size)
///
/// Sources, by section:
///   ST7735   Sitronix, ST7735R, V0.2 and ST7735S, V1.1: "Address Control", "Command", "Power Level Definition"
///   ST7789   Sitronix, ST7789V, V1.0: "Address Control", "Command", "Power Level Definition"
///   ILI9341  ILI Technology, ILI9341, V1.11: 8.2 and 8.3 (commands), "MCU to memory write/read direction"
#ifndef THIMBLE_DRIVERS_COLOR_PANEL_H
#define THIMBLE_DRIVERS_COLOR_PANEL_H

#include "panel.h"

namespace thimble::drivers {

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

/// Modules of 1.8", 1.44" and 0.96". The colour of the tab on the protecting foil tells which.
class St7735 : public ColorPanel {
 public:
  static constexpr ColorGeometry k128x160{128, 160,  128,  160,   0,
                                          0,   true, true, false, false};  ///< black, red
  static constexpr ColorGeometry k128x160Green{128, 160, 132, 162, 2, 1, true, true, false, false};
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
