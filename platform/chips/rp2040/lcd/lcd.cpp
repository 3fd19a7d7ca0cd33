// The display: 240 x 240 or 320 x 240 pixels behind an ST7789 (Sitronix data sheet V1.0), on SPI1. DMA sends a band from
// where it was drawn while the next one is drawn: a frame of SPI is a pixel of 16 bits, so that a halfword of
// the RAM arrives as the display wants it, high byte first, and nobody copies or swaps.
#include <stddef.h>
#include <stdint.h>

#include "board.h"
#include "registers.h"
#include "rp2040.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t pin_bit(uint32_t pin) {
  return 1U << pin;
}
constexpr uint32_t kDataPin = pin_bit(rp2040::kPinLcdData);
constexpr uint32_t kSelectPin = pin_bit(rp2040::kPinLcdSelect);
constexpr uint32_t kResetPin = pin_bit(rp2040::kPinLcdReset);
constexpr uint32_t kLightPin = pin_bit(rp2040::kPinLcdLight);

// 133 MHz / 4: the display takes a bit in 16 ns at least (7.4.2, serial interface).
constexpr uint32_t kSpiDivider = 4;

// Commands (9.1).
constexpr uint8_t kSleepOut = 0x11;
constexpr uint8_t kInvert = 0x21;  // this glass shows black where it gets the highest voltage
constexpr uint8_t kDisplayOn = 0x29;
constexpr uint8_t kColumns = 0x2A;
constexpr uint8_t kRows = 0x2B;
constexpr uint8_t kWrite = 0x2C;
constexpr uint8_t kOrder = 0x36;
constexpr uint8_t kAcross = 0x70;  // columns mirrored, rows and columns exchanged
constexpr uint8_t kPixels = 0x3A;
constexpr uint8_t k16Bits = 0x55;

// After its reset and when it wakes (9.1.12; 7.4.5, reset timing).
constexpr uint32_t kWakeMs = 120;

// Frames of 8 or 16 bits, SPI mode 0; not before the last bit is out, since the pins hold for whole frames.
void frames_of(uint32_t bits) {
  wait_for_clear(rp2040::kSpiStatus, rp2040::kSpiBusy);
  register32(rp2040::kSpiCr1) = 0;
  register32(rp2040::kSpiCr0) = bits;
  register32(rp2040::kSpiCr1) = rp2040::kSpiEnable;
}

void send(uint32_t frame) {
  wait_for_set(rp2040::kSpiStatus, rp2040::kSpiNotFull);
  register32(rp2040::kSpiData) = frame;
}

void command(uint8_t name) {
  wait_for_clear(rp2040::kSpiStatus, rp2040::kSpiBusy);
  register32(rp2040::kSioOutClear) = kDataPin;
  send(name);
  wait_for_clear(rp2040::kSpiStatus, rp2040::kSpiBusy);
  register32(rp2040::kSioOutSet) = kDataPin;
}

void command(uint8_t name, uint8_t value) {
  command(name);
  send(value);
}

void command(uint8_t name, int32_t first, int32_t last) {
  command(name);
  const int32_t ends[] = {first, last};
  for (const int32_t at : ends) {
    send(static_cast<uint32_t>(at) >> 8);
    send(static_cast<uint32_t>(at) & 0xFFU);
  }
}

// Whole rows from `first_row` on come next.
void open_window(int32_t first_row, int32_t rows) {
  frames_of(rp2040::kSpi8Bits);
  command(kColumns, 0, board::kFacts.display.width_px - 1);
  command(kRows, first_row, first_row + rows - 1);
  command(kWrite);
  frames_of(rp2040::kSpi16Bits);
}

// DMA sends `pixels` halfwords from `from` on, or always the same one.
void begin_pixels(const uint8_t* from, size_t pixels, uint32_t reads_on) {
  register32(rp2040::kDmaRead) = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(from));
  register32(rp2040::kDmaWrite) = rp2040::kSpiData;
  register32(rp2040::kDmaCount) = static_cast<uint32_t>(pixels);
  register32(rp2040::kDmaControl) =
      rp2040::kDmaEnable | rp2040::kDmaHalfwords | reads_on | rp2040::kDmaForSpi1 | rp2040::kDmaQuiet;
}

}  // namespace

void rp2040::start_display() {
  constexpr uint32_t kOutputs[] = {kPinLcdData, kPinLcdSelect, kPinLcdReset, kPinLcdLight};
  for (const uint32_t pin : kOutputs) {
    register32(pin_control(pin)) = kPinSio;
  }
  register32(kSioOutClear) = kResetPin | kLightPin;
  register32(kSioOutSet) = kSelectPin;
  register32(kSioEnableSet) = kDataPin | kSelectPin | kResetPin | kLightPin;
  register32(pin_control(kPinLcdClock)) = kPinSpi;
  register32(pin_control(kPinLcdDin)) = kPinSpi;
  register32(kSpiPrescale) = kSpiDivider;
  register32(kSpiDma) = kSpiDmaSends;
  wait_ms(1);
  register32(kSioOutSet) = kResetPin;
  wait_ms(kWakeMs);
  register32(kSioOutClear) = kSelectPin;
  frames_of(kSpi8Bits);
  command(kSleepOut);
  wait_ms(kWakeMs);
  command(kPixels, k16Bits);
  command(kOrder, kAcross);
  command(kInvert);
  const port::Display& display = board::kFacts.display;
  alignas(2) static constexpr uint8_t kBlack[2] = {};
  open_window(0, display.height_px);
  begin_pixels(kBlack, static_cast<size_t>(display.width_px) * static_cast<size_t>(display.height_px), 0);
  board::await_flush();
  frames_of(kSpi8Bits);
  command(kDisplayOn);
  register32(kSioOutSet) = kLightPin;
}

// Eight rows of 240 pixels take 1 ms; the whole picture 28, one of 320 x 240 pixels 37.
void board::await_flush() {
  wait_for_clear(rp2040::kDmaControl, rp2040::kDmaBusy);
}

void board::begin_flush(const Band& band) {
  await_flush();
  open_window(band.first_row, band.rows);
  begin_pixels(band.pixels.data, band.pixels.size / 2, rp2040::kDmaReadsOn);
}

}  // namespace thimble
