/// Registers of the Game Boy Advance that this board uses, 16 bits each (GBATEK, GBA I/O Map; its chapters are
/// named beside them).
#pragma once

#include <stdint.h>

namespace thimble::gba {

/// The 16-bit register at `address`.
inline volatile uint16_t& register16(uintptr_t address) {
  return *reinterpret_cast<volatile uint16_t*>(address);
}

// LCD I/O display control.
inline constexpr uintptr_t kDisplayControl = 0x04000000;
inline constexpr uint16_t kMode3 = 3;  ///< a picture of 240 x 160, 15 bits a pixel
inline constexpr uint16_t kForcedBlank = 1U << 7;
inline constexpr uint16_t kBackground2 = 1U << 10;
/// VRAM: a halfword a pixel, 0bbbbbgg gggrrrrr. It takes no single bytes.
inline constexpr uintptr_t kPicture = 0x06000000;

// Timers: each counts the core's clock, or the turns of the one below it.
constexpr uintptr_t timer_count(uint32_t timer) {
  return 0x04000100 + 4 * timer;
}
constexpr uintptr_t timer_control(uint32_t timer) {
  return 0x04000102 + 4 * timer;
}
inline constexpr uint16_t kTimerOn = 1U << 7;
inline constexpr uint16_t kTimerCountsTurns = 1U << 2;

// Serial port, UART mode.
inline constexpr uintptr_t kSerialControl = 0x04000128;
inline constexpr uint16_t kSerial115200 = 3;
inline constexpr uint16_t kSerialSendFull = 1U << 4;
inline constexpr uint16_t kSerialReceiveEmpty = 1U << 5;
inline constexpr uint16_t kSerial8Bits = 1U << 7;
inline constexpr uint16_t kSerialFifo = 1U << 8;
inline constexpr uint16_t kSerialSends = 1U << 10;
inline constexpr uint16_t kSerialReceives = 1U << 11;
inline constexpr uint16_t kSerialUart = 3U << 12;
inline constexpr uintptr_t kSerialData = 0x0400012A;
inline constexpr uintptr_t kSerialMode = 0x04000134;  ///< RCNT: 0, the mode that kSerialControl says

// Keypad: a bit a key, 0 while it is down.
inline constexpr uintptr_t kKeys = 0x04000130;
inline constexpr uint16_t kKeyA = 1U << 0;
inline constexpr uint16_t kKeyRight = 1U << 4;
inline constexpr uint16_t kKeyLeft = 1U << 5;
inline constexpr uint16_t kKeyUp = 1U << 6;
inline constexpr uint16_t kKeyDown = 1U << 7;

// System control.
inline constexpr uintptr_t kInterruptsOn = 0x04000208;
inline constexpr uintptr_t kWaits = 0x04000204;
/// The cartridge answers a first read after 3 cycles and those that follow after 1, and is read ahead: what
/// most cartridges take.
inline constexpr uint16_t kWaits3And1 = 5U << 2 | 1U << 14;

}  // namespace thimble::gba
