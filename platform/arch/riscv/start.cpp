// Reset and traps of a bare RISC-V core in machine mode.
#include <stdint.h>

#include "common/layout.h"
#include "common/run.h"

extern "C" {

[[noreturn]] void thimble_reset();
void thimble_trap();

// At the very front of the flash: the core starts there.
[[gnu::naked, gnu::section(".vectors"), gnu::used]] void thimble_reset() {
  asm volatile(
      "csrw mie, zero\n"
      "la sp, thimble_stack_top\n"
      "la t0, thimble_trap\n"
      "csrw mtvec, t0\n"
      "j thimble_run\n");
}

// mtvec wants an address of whole words. The stack may be what failed, so its pointer goes back to the top
// first.
[[gnu::naked, gnu::aligned(4), gnu::used]] void thimble_trap() {
  asm volatile(
      "mv a0, sp\n"
      "la sp, thimble_stack_top\n"
      "j thimble_trap_report\n");
}

[[noreturn, gnu::used]] void thimble_trap_report(uint32_t stack_pointer);
}

namespace thimble {
namespace {

// By mcause (The RISC-V Instruction Set Manual, volume II, table 3.6); an address that is misaligned comes before one where
// nothing answers.
constexpr const char* kNames[] = {"instruction access fault", "instruction access fault",
                                  "illegal instruction",      "breakpoint without debugger",
                                  "load access fault",        "load access fault",
                                  "store access fault",       "store access fault"};
constexpr uint32_t kFirstLoad = 4;
constexpr uint32_t kCauses = sizeof kNames / sizeof kNames[0];

}  // namespace
}  // namespace thimble

void thimble_trap_report(uint32_t stack_pointer) {
  uint32_t cause = 0;
  uint32_t pc = 0;
  uint32_t value = 0;
  asm volatile("csrr %0, mcause\ncsrr %1, mepc\ncsrr %2, mtval" : "=r"(cause), "=r"(pc), "=r"(value));
  const bool is_known = cause < thimble::kCauses;
  thimble::report_fault({is_known ? thimble::kNames[cause] : "unexpected trap", pc, value,
                         is_known && cause >= thimble::kFirstLoad, stack_pointer});
}
