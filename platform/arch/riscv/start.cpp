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

// mcause (The RISC-V Instruction Set Manual, volume II, table 3.6).
enum Cause : uint32_t {
  kFetchMisaligned = 0,
  kFetchFault = 1,
  kIllegalInstruction = 2,
  kBreakpoint = 3,
  kLoadMisaligned = 4,
  kLoadFault = 5,
  kStoreMisaligned = 6,
  kStoreFault = 7,
};

const char* name_of(uint32_t cause) {
  switch (cause) {
    case kFetchMisaligned:
    case kFetchFault:
      return "instruction access fault";
    case kIllegalInstruction:
      return "illegal instruction";
    case kLoadMisaligned:
    case kLoadFault:
      return "load access fault";
    case kStoreMisaligned:
    case kStoreFault:
      return "store access fault";
    case kBreakpoint:
      return "breakpoint without debugger";
    default:
      return "unexpected trap";
  }
}

}  // namespace
}  // namespace thimble

void thimble_trap_report(uint32_t stack_pointer) {
  uint32_t cause = 0;
  uint32_t pc = 0;
  uint32_t value = 0;
  asm volatile("csrr %0, mcause\ncsrr %1, mepc\ncsrr %2, mtval" : "=r"(cause), "=r"(pc), "=r"(value));
  const bool is_access = cause == thimble::kLoadFault || cause == thimble::kStoreFault ||
                         cause == thimble::kLoadMisaligned || cause == thimble::kStoreMisaligned;
  thimble::report_fault({thimble::name_of(cause), pc, value, is_access, stack_pointer});
}
