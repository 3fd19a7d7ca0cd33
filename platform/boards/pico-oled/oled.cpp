// The display: a module of 128 x 64 pixels of one bit behind an SSD1306 (Solomon Systech data sheet Rev 1.1) at address
// 3Ch of I2C0, SDA on GP4 and SCL on GP5. Modules have no reset pin: an RC element does that.
#include <stddef.h>
#include <stdint.h>

#include "board.h"
#include "registers.h"
#include "rp2040.h"
#include "thimble/drivers/panel.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t kPinSda = 4;
constexpr uint32_t kPinScl = 5;
constexpr uint32_t kAddress = 0x3C;
constexpr uint32_t kAfterPowerMs = 120;

// Clocks of the core in a bit, of which three fifths are low: the display takes one in 2.5 us at least (table 13-6).
// The RP2040 adds to the counts that it is given (4.3.14.2): one to the low phase, the spike filter's and 7 to the high one.
constexpr uint32_t kBitClocks = (board::kClockMhz * 5 + 1) / 2;
constexpr uint32_t kLowClocks = kBitClocks * 3 / 5;
constexpr uint32_t kSpikeClocks = (board::kClockMhz + 19) / 20;    // 50 ns
constexpr uint32_t kHoldClocks = (board::kClockMhz * 3 + 9) / 10;  // 300 ns, table 13-6

constinit drivers::Ssd1306 panel;

// One transfer: the control byte (8.1.5.2), then the bytes. Nobody at the address, or a byte that is not taken, ends it; the
// interface throws away what comes until that is cleared.
bool send(uint32_t control, const uint8_t* bytes, size_t count) {
  for (size_t i = 0; i <= count; ++i) {
    const uint32_t byte = i == 0 ? control : bytes[i - 1];
    wait_for_set(rp2040::kI2cStatus, rp2040::kI2cNotFull);
    register32(rp2040::kI2cData) = i == count ? byte | rp2040::kI2cStop : byte;
  }
  wait_for_set(rp2040::kI2cEvents, rp2040::kI2cStopped);
  const bool taken = (register32(rp2040::kI2cEvents) & rp2040::kI2cAborted) == 0;
  static_cast<void>(static_cast<uint32_t>(register32(rp2040::kI2cClearEvents)));
  return taken;
}

constexpr drivers::PanelBus kBus = {
    nullptr, [](void*, const uint8_t* bytes, size_t count) { return send(0x00, bytes, count); },
    [](void*, const uint8_t* bytes, size_t count) { return send(0x40, bytes, count); },
    [](void*, uint32_t ms) { rp2040::wait_ms(ms); }};

}  // namespace

void rp2040::start_display() {
  constexpr uint32_t kPins[] = {kPinSda, kPinScl};
  for (const uint32_t pin : kPins) {
    register32(pad(pin)) = kPadInputPulledUp;
    register32(pin_control(pin)) = kPinI2c;
  }
  register32(kI2cEnable) = 0;
  register32(kI2cControl) = kI2cFastMaster;
  register32(kI2cTarget) = kAddress;
  register32(kI2cHighCount) = kBitClocks - kLowClocks - kSpikeClocks - 7;
  register32(kI2cLowCount) = kLowClocks - 1;
  register32(kI2cSpikeCount) = kSpikeClocks;
  register32(kI2cHoldCount) = kHoldClocks;
  register32(kI2cEnable) = 1;
  wait_ms(kAfterPowerMs);
  panel.begin(kBus, {board::kFacts.display.width_px, board::kFacts.display.height_px});
}

// A page takes 3 ms, the whole picture 24.
void board::flush(const Band& band) {
  panel.show(band);
}

}  // namespace thimble
