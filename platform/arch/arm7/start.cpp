// Reset of an ARM7TDMI (ARM7TDMI Technical Reference Manual): ARM code, system mode, interrupts off. Code that
// runs from the core's own RAM is copied there first.
#include "common/run.h"

extern "C" {

[[noreturn]] void thimble_reset();

// 0xDF: system mode, both kinds of interrupt off.
[[gnu::naked, gnu::section(".vectors"), gnu::used, gnu::target("arm")]] void thimble_reset() {
  asm volatile(
      "msr cpsr_c, #0xDF\n"
      "ldr sp, =thimble_stack_top\n"
      "ldr r0, =thimble_fast_image\n"
      "ldr r1, =thimble_fast_start\n"
      "ldr r2, =thimble_fast_end\n"
      "1: cmp r1, r2\n"
      "ldrlo r3, [r0], #4\n"
      "strlo r3, [r1], #4\n"
      "blo 1b\n"
      "ldr r0, =thimble_run\n"
      "bx r0\n");
}
}
