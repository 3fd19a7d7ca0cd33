// Reset, and the vector table that leads to it.
#include <stdint.h>

#include "common/layout.h"
#include "common/run.h"

extern "C" {

[[noreturn]] void thimble_reset();
void thimble_fault();  // where every exception but SysTick ends (faults.cpp)
// Only where SysTick is the clock (systick.cpp).
[[gnu::weak]] void thimble_systick();

// The core has loaded the stack pointer from the table; a loader or a debugger that jumps here may not have.
// The floating-point unit is on where there is one, for firmware around us that uses it.
[[gnu::naked]] void thimble_reset() {
  asm volatile(
      "cpsid i\n"
      "ldr r0, =thimble_stack_top\n"
      "mov sp, r0\n"
#if defined(__ARM_ARCH_7EM__)
      "ldr r0, =0xE000ED88\n"  // CPACR
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
#endif
      "cpsie i\n"
      "bl thimble_run\n");
}
}

namespace {

// Armv6-M and Armv7-M number their exceptions alike. Interrupts of devices are not used. Reserved words are 0: on
// Armv6-M those of MemManage, BusFault and UsageFault, too, by which the drive of a micro:bit V2 knows an image for the V1
// and refuses it (DAPLink, board_detect_incompatible_image).
union Vector {
  const void* stack;
  void (*handler)();
};

constexpr Vector kReserved = {.handler = nullptr};
#if defined(__ARM_ARCH_6M__)
constexpr Vector kArmv7 = kReserved;
#else
constexpr Vector kArmv7 = {.handler = thimble_fault};
#endif

[[gnu::section(".vectors"), gnu::used]] const Vector kVectors[16] = {
    {.stack = thimble_stack_top},
    {.handler = thimble_reset},
    {.handler = thimble_fault},  // NMI
    {.handler = thimble_fault},  // HardFault
    kArmv7,                      // MemManage
    kArmv7,                      // BusFault
    kArmv7,                      // UsageFault
    kReserved,
    kReserved,
    kReserved,
    kReserved,
    {.handler = thimble_fault},  // SVCall
    kArmv7,                      // DebugMonitor
    kReserved,
    {.handler = thimble_fault},  // PendSV
    {.handler = thimble_systick},
};

}  // namespace
