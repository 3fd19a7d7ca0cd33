// Clocks, UART and keys of a Raspberry Pi Pico on a carrier with a display.
#include "board.h"

#include <stdint.h>

#include "cortex-m/system_control.h"
#include "registers.h"
#include "rp2040.h"
#include "thimble_board_facts.h"

namespace thimble {

// SysTick wakes the core. A turn of it holds 126 ms.
void rp2040::wait_ms(uint32_t ms) {
  constexpr uint32_t kCountFlag = 1U << 16;
  register32(cortex_m::kSystRvr) = board::kClockMhz * 1000 * ms - 1;
  register32(cortex_m::kSystCvr) = 0;
  register32(cortex_m::kSystCsr) =
      cortex_m::kSystCsrEnable | cortex_m::kSystCsrInterrupt | cortex_m::kSystCsrCoreClock;
  static_cast<void>(static_cast<uint32_t>(register32(cortex_m::kSystCsr)));  // a flag from before goes
  while ((register32(cortex_m::kSystCsr) & kCountFlag) == 0) {
    asm volatile("wfi");
  }
  register32(cortex_m::kSystCsr) = 0;
}

namespace board {
namespace {

constexpr uint32_t kBlocks = rp2040::kBlockDma | rp2040::kBlockI2c0 | rp2040::kBlockPins |
                             rp2040::kBlockPads | rp2040::kBlockSpi1 | rp2040::kBlockUart0;

// A key of a carrier: its pin is low while it is down.
struct Key {
  uint32_t pin;
  port::Button button;
};
constexpr Key kKeys[] = {THIMBLE_KEYS};

// Through a reset, so that a block is as the data sheet says, whatever ran before us.
void restart(uint32_t blocks) {
  set_bits(rp2040::kReset, blocks);
  clear_bits(rp2040::kReset, blocks);
  for (uint32_t i = 0; i < kPatience && (register32(rp2040::kResetDone) & blocks) != blocks; ++i) {
  }
}

// The reference clock from the crystal, then the core's from the PLL. It runs from the reference clock
// meanwhile, since the PLL may be what it runs from.
void start_core_clock() {
  register32(rp2040::kXoscStartup) = rp2040::kXoscStartup1Ms;
  register32(rp2040::kXoscCtrl) = rp2040::kXoscEnable;
  wait_for_set(rp2040::kXoscStatus, rp2040::kXoscStable);
  register32(rp2040::kClkSysCtrl) = rp2040::kClkSysRef;
  wait_for_set(rp2040::kClkSysSelected, 1U << rp2040::kClkSysRef);
  register32(rp2040::kClkRefCtrl) = rp2040::kClkRefXosc;
  wait_for_set(rp2040::kClkRefSelected, 1U << rp2040::kClkRefXosc);
  restart(rp2040::kBlockPllSys);
  register32(rp2040::kPllCs) = rp2040::kPllRefDiv1;
  register32(rp2040::kPllFeedback) = rp2040::kPllTimes;
  clear_bits(rp2040::kPllPower, rp2040::kPllPowerDown);
  if (wait_for_set(rp2040::kPllCs, rp2040::kPllLocked)) {
    register32(rp2040::kPllPrim) = rp2040::kPllBy12;
    clear_bits(rp2040::kPllPower, rp2040::kPllPostDown);
    register32(rp2040::kClkSysCtrl) = rp2040::kClkSysPll;
    wait_for_set(rp2040::kClkSysSelected, 1U << rp2040::kClkSysPll);
  }
  register32(rp2040::kClkPeriCtrl) = rp2040::kClkPeriSys;
}

}  // namespace

void start() {
  start_core_clock();
  restart(kBlocks);
  register32(rp2040::pin_control(rp2040::kPinUartSends)) = rp2040::kPinUart;
  register32(rp2040::pin_control(rp2040::kPinUartReceives)) = rp2040::kPinUart;
  start_uart(kClockMhz * 1000000);
  for (const Key& key : kKeys) {
    register32(rp2040::pad(key.pin)) = rp2040::kPadInputPulledUp;
    register32(rp2040::pin_control(key.pin)) = rp2040::kPinSio;
  }
  rp2040::start_display();
}

uint32_t buttons() {
  const uint32_t high = register32(rp2040::kSioIn);
  uint32_t down = 0;
  for (const Key& key : kKeys) {
    if ((high >> key.pin & 1U) == 0) {
      down |= key.button;
    }
  }
  return down;
}

}  // namespace board
}  // namespace thimble
