// Reset and exceptions of an ARM1176 (ARM1176JZF-S Technical Reference Manual; ARM Architecture Reference
// Manual, Armv6). Everything runs in supervisor mode with interrupts off.
#include <stdint.h>

#include "common/layout.h"
#include "common/run.h"

extern "C" {

[[noreturn]] void thimble_reset();
void thimble_vectors();
[[noreturn, gnu::used]] void thimble_exception_report(uint32_t kind, uint32_t pc, uint32_t stack_pointer);

// At the front of the image, where the loader jumps. 0xD3: supervisor mode, both kinds of interrupt off.
[[gnu::naked, gnu::section(".vectors"), gnu::used]] void thimble_reset() {
  asm volatile(
      "msr cpsr_c, #0xD3\n"
      "ldr sp, =thimble_stack_top\n"
      "ldr r0, =thimble_vectors\n"
      "mcr p15, 0, r0, c12, c0, 0\n"  // vector base address
      "bl thimble_run\n");
}

// One branch each 4 bytes: reset, undefined, svc, prefetch abort, data abort, unused, irq, fiq. Each leaves
// its number in r0, and the address of the instruction in r1.
[[gnu::naked, gnu::aligned(32), gnu::used]] void thimble_vectors() {
  asm volatile(
      "b thimble_reset\n"
      "b 1f\n"
      "b 2f\n"
      "b 3f\n"
      "b 4f\n"
      "b 5f\n"
      "b 5f\n"
      "b 5f\n"
      "1: mov r0, #1\n sub r1, lr, #4\n b 6f\n"
      "2: mov r0, #2\n sub r1, lr, #4\n b 6f\n"
      "3: mov r0, #3\n sub r1, lr, #4\n b 6f\n"
      "4: mov r0, #4\n sub r1, lr, #8\n b 6f\n"
      "5: mov r0, #5\n mov r1, lr\n"
      // Back to supervisor mode, whose stack pointer is the interesting one, and to the top of the stack.
      "6: msr cpsr_c, #0xD3\n"
      "mov r2, sp\n"
      "ldr sp, =thimble_stack_top\n"
      "b thimble_exception_report\n");
}
}

namespace thimble {
namespace {

// By the number that a vector leaves.
constexpr const char* kNames[] = {
    "",           "undefined instruction", "supervisor call without debugger", "prefetch abort",
    "data abort", "unexpected exception"};
constexpr uint32_t kDataAbort = 4;

}  // namespace
}  // namespace thimble

void thimble_exception_report(uint32_t kind, uint32_t pc, uint32_t stack_pointer) {
  uint32_t address = 0;
  asm volatile("mrc p15, 0, %0, c6, c0, 0" : "=r"(address));  // data fault address
  thimble::report_fault({thimble::kNames[kind], pc, address, kind == thimble::kDataAbort, stack_pointer});
}
