/// @file page_panel.h
/// Black-and-white displays in pages of 8 rows, PixelFormat::kMono1Pages: SSD1306, SH1106, ST7567.
///
///     drivers::Ssd1306 panel;
///     panel.begin(bus, {128, 64}, drivers::Rotation::kNone);
///     for (Band band{pixels, PixelFormat::kMono1Pages, 0, 0, 8}; band.first_row < 64; band.first_row += 8) {
///       render_band(tree, camera, shading, band);
///       panel.show(band);
///     }
///
/// These controllers turn the picture by 180 degrees, not by 90. Sources, by section:
///   SSD1306  Solomon Systech, SSD1306, Rev 1.1: 8.9 (power on), 9 and 10 (commands), appendix "Charge Pump Regulator"
///   SH1106   Sino Wealth, SH1106, V2.3: "Commands", "Power On and Initialization"
///   ST7567   Sitronix, ST7567: "Instruction Table", "Operation Flow"
#ifndef THIMBLE_DRIVERS_PAGE_PANEL_H
#define THIMBLE_DRIVERS_PAGE_PANEL_H

#include "panel.h"

namespace thimble::drivers {

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

  int32_t width_px() const { return geometry_.width_px; }
  int32_t height_px() const { return geometry_.height_px; }

 protected:
  enum class Kind : uint8_t { kSsd1306, kSh1106, kSt7567 };
  bool begin(Kind kind, const PanelBus& bus, const PageGeometry& geometry, Rotation rotation);
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
  bool contrast(uint8_t level);
};

/// 128 x 64 in 132 columns.
class Sh1106 : public PagePanel {
 public:
  bool begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation = Rotation::kNone);
  bool contrast(uint8_t level);
};

/// An LCD of 128 x 64 in 132 columns.
class St7567 : public PagePanel {
 public:
  bool begin(const PanelBus& bus, const PageGeometry& geometry, Rotation rotation = Rotation::kNone);
  /// The electronic volume, 0 .. 63.
  bool contrast(uint8_t level);
};

}  // namespace thimble::drivers

#endif
