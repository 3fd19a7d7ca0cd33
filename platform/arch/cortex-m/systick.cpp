// Time and instructions from SysTick, which counts the core's clock down from a reload value, 24 bits at
// most. Its exception counts the turns.
//
// Under QEMU with `-icount shift=S` an instruction takes 2^S ns, so the clock counts instructions; without
// it, and on a chip, instructions() is time in units of 2^S ns.
#include <stdint.h>

#include "board.h"
#include "cortex-m/system_control.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t greatest_common_divisor(uint32_t a, uint32_t b) {
  while (b != 0) {
    const uint32_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

// An instruction is kInstructionDivisor / kInstructionFactor ticks: 1000 / MHz ns are a tick, 2^shift an
// instruction.
constexpr uint32_t kTicksScale = board::kClockMhz << board::kIcountShift;
constexpr uint32_t kCommon = greatest_common_divisor(1000, kTicksScale);
constexpr uint32_t kInstructionFactor = 1000 / kCommon;
constexpr uint32_t kInstructionDivisor = kTicksScale / kCommon;

// A turn is a whole number of instructions and of microseconds, so that turns can be added without a
// remainder.
constexpr uint32_t kStep = kInstructionDivisor * board::kClockMhz;
constexpr uint32_t kTurnTicks = (1U << 24) / kStep * kStep;
static_assert(kTurnTicks != 0);
static_assert(kTurnTicks <= UINT32_MAX / kInstructionFactor, "ticks of a turn times the factor fit");
constexpr uint32_t kTurnInstructions = kTurnTicks / kInstructionDivisor * kInstructionFactor;
constexpr uint32_t kTurnMicroseconds = kTurnTicks / board::kClockMhz;

volatile uint32_t turns = 0;

struct Ticks {
  uint32_t turns;
  uint32_t within;  // of the current turn, below kTurnTicks
};

Ticks now() {
  // A turn may end between the two reads; not twice in a row.
  Ticks ticks = {turns, kTurnTicks - 1 - register32(cortex_m::kSystCvr)};
  if (ticks.turns != turns) {
    ticks = {turns, kTurnTicks - 1 - register32(cortex_m::kSystCvr)};
  }
  return ticks;
}

}  // namespace

namespace board {

void start_clock() {
  register32(cortex_m::kSystRvr) = kTurnTicks - 1;
  register32(cortex_m::kSystCvr) = 0;
  register32(cortex_m::kSystCsr) =
      cortex_m::kSystCsrEnable | cortex_m::kSystCsrInterrupt | cortex_m::kSystCsrCoreClock;
}

}  // namespace board

namespace port {

uint32_t instructions() {
  const Ticks ticks = now();
  return ticks.turns * kTurnInstructions + ticks.within * kInstructionFactor / kInstructionDivisor;
}

uint32_t microseconds() {
  const Ticks ticks = now();
  return ticks.turns * kTurnMicroseconds + ticks.within / board::kClockMhz;
}

}  // namespace port
}  // namespace thimble

extern "C" void thimble_systick() {
  thimble::turns = thimble::turns + 1;
}
