// The OLED: 128 x 64 pixels of 16 greys behind an SSD0323 (Solomon Systech data sheet), two pixels a byte,
// the left one in the high nibble, as PixelFormat::kGray4 has it. What the panel wants of the controller is OSRAM's
// (application note AN018), as the board's maker sends it (StellarisWare, boards/ek-lm3s6965, osram128x64x4.c).
#include <stddef.h>
#include <stdint.h>

#include "board.h"
#include "lm3s6965.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint8_t kSetColumns = 0x15;
constexpr uint8_t kSetRows = 0x75;
constexpr uint8_t kStartSequence[] = {
    0xAE,                                                  // display off
    0xA4,                                                  // shows its memory
    0xA0, 0x52,                                            // rows run upward and in turns, nibbles swapped
    0x81, 0x32,                                            // contrast
    0x85,                                                  // half of the current
    0xA8, 0x3F,                                            // 64 rows
    0xA1, 0x00,                                            // first row
    0xA2, 0x4C,                                            // of 80, by the way that 64 are wired
    0xB1, 0x22,                                            // phases of a row: 2 clocks each
    0xB2, 0x46,                                            // a row: 70 clocks
    0xB3, 0xF1,                                            // fastest oscillator, divided by 2
    0xBF, 0x0D,                                            // low voltage of segments
    0xBE, 0x02,                                            // high voltage of rows
    0xBC, 0x10,                                            // voltage before a phase
    0xB8, 0x01, 0x11, 0x22, 0x32, 0x43, 0x54, 0x65, 0x76,  // brightness of the 16 greys
    0xAD, 0x03,                                            // converter on
};
constexpr uint8_t kDisplayOn = 0xAF;
constexpr int32_t kMemoryRows = 80;
constexpr uint8_t kLastColumn = 63;  // of two pixels

constexpr uint32_t kDataPin = 1U << 7;    // C7
constexpr uint32_t kSelectPin = 1U << 0;  // D0

// Sends bytes, and throws away what the interface receives meanwhile. Its queues are eight deep both ways:
// eight bytes go whenever the one is empty, and as many places of the other are read, filled or not (an
// overrun there loses what nobody wants).
void send(const uint8_t* bytes, size_t count) {
  const uint8_t* const end = bytes + count;
  uint32_t patience = board::kPatience;
  while (bytes != end && patience != 0) {
    --patience;
    const uint32_t status = register32(lm3s6965::kSsiSr);
    if ((status & lm3s6965::kSsiSrSendEmpty) == 0) {
      continue;
    }
    if (end - bytes < static_cast<ptrdiff_t>(lm3s6965::kSsiQueue)) {
      register32(lm3s6965::kSsiDr) = *bytes++;
      static_cast<void>(static_cast<uint32_t>(register32(lm3s6965::kSsiDr)));
      continue;
    }
#pragma GCC unroll 8
    for (uint32_t i = 0; i < lm3s6965::kSsiQueue; ++i) {
      register32(lm3s6965::kSsiDr) = bytes[i];
    }
#pragma GCC unroll 8
    for (uint32_t i = 0; i < lm3s6965::kSsiQueue; ++i) {
      static_cast<void>(static_cast<uint32_t>(register32(lm3s6965::kSsiDr)));
    }
    bytes += lm3s6965::kSsiQueue;
  }
}

// The pin holds for whole bytes, so it must not change before the last one is out.
void choose(bool is_data) {
  wait_for_clear(lm3s6965::kSsiSr, lm3s6965::kSsiSrBusy);
  register32(lm3s6965::pins(lm3s6965::kPortC, kDataPin)) = is_data ? kDataPin : 0;
}

void send_window(int32_t first_row, int32_t rows) {
  const uint8_t window[] = {kSetColumns,
                            0,
                            kLastColumn,
                            kSetRows,
                            static_cast<uint8_t>(first_row),
                            static_cast<uint8_t>(first_row + rows - 1)};
  choose(false);
  send(window, sizeof(window));
  choose(true);
}

void start_output_pin(uintptr_t port, uint32_t pin) {
  set_bits(port + lm3s6965::kGpioDirection, pin);
  set_bits(port + lm3s6965::kGpioDigital, pin);
}

}  // namespace

void lm3s6965::start_display() {
  start_output_pin(kPortC, kDataPin);
  start_output_pin(kPortD, kSelectPin);
  register32(pins(kPortD, kSelectPin)) = kSelectPin;
  register32(kSsiCr1) = 0;
  register32(kSsiCpsr) = 14;  // 50 MHz / 14: a bit takes 280 ns, the display wants 250 at least
  register32(kSsiCr0) = kSsiCr08Bits;
  register32(kSsiCr1) = kSsiCr1Enable;
  choose(false);
  send(kStartSequence, sizeof(kStartSequence));
  send_window(0, kMemoryRows);
  static constexpr uint8_t kBlackRow[64] = {};
  for (int32_t row = 0; row < kMemoryRows; ++row) {
    send(kBlackRow, sizeof(kBlackRow));
  }
  choose(false);
  send(&kDisplayOn, 1);
}

void board::flush(const Band& band) {
  const size_t bytes = row_bytes(band.format, kFacts.display.width_px);
  send_window(band.first_row, band.rows);
  if (band.stride_bytes == 0 || band.stride_bytes == bytes) {
    send(band.pixels.data, bytes * static_cast<size_t>(band.rows));
    return;
  }
  for (int32_t row = 0; row < band.rows; ++row) {
    send(band.pixels.data + band.stride_bytes * static_cast<size_t>(row), bytes);
  }
}

}  // namespace thimble
