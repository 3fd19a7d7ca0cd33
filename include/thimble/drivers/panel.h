/// @file panel.h
/// What the drivers of displays have in common: three functions of the board's, and how the picture is turned.
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

}  // namespace thimble::drivers

#endif
