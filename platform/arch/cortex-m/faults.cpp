#include <stdint.h>

#include "common/layout.h"
#include "common/run.h"
#include "cortex-m/system_control.h"
#include "registers.h"

namespace thimble {
namespace {

constexpr uint32_t kHardFault = 3;
constexpr const char* kNames[] = {"HardFault", "MemManage fault (memory that is not ours)",
                                  "BusFault (nothing at this address)",
                                  "UsageFault (an instruction that cannot be)"};
constexpr uint32_t kFaults = sizeof kNames / sizeof kNames[0];

}  // namespace
}  // namespace thimble

// `stack_pointer` is that of the moment after the exception's push, which may have failed; `pc` is 0 then.
extern "C" [[noreturn, gnu::used]] void thimble_fault_report(uint32_t stack_pointer, uint32_t exception,
                                                             uint32_t pc) {
  using namespace thimble;
  const bool is_fault = exception - kHardFault < kFaults;
  Fault fault = {is_fault ? kNames[exception - kHardFault] : "unexpected exception", pc, 0, false,
                 stack_pointer};
#if !defined(__ARM_ARCH_6M__)
  const uint32_t status = register32(cortex_m::kCfsr);
  if ((status & cortex_m::kCfsrMemAddressValid) != 0) {
    fault.address = register32(cortex_m::kMmfar);
    fault.has_address = true;
  } else if ((status & cortex_m::kCfsrBusAddressValid) != 0) {
    fault.address = register32(cortex_m::kBfar);
    fault.has_address = true;
  }
  const uint32_t bottom = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(thimble_stack_bottom));
  if ((status & cortex_m::kCfsrStacking) != 0 && stack_pointer >= bottom) {
    fault.stack_pointer = bottom;  // the push ran into the fence
  }
#endif
  report_fault(fault);
}

// The stack may be what failed, so nothing is pushed before the stack pointer is back at the top. That may
// overwrite what the exception pushed (r0-r3, r12, lr, pc, xpsr), so its pc is taken first, if the frame lies
// in the stack.
extern "C" [[gnu::naked]] void thimble_fault();
void thimble_fault() {
  asm volatile(
      "mov r0, sp\n"
      "mrs r1, ipsr\n"
      "movs r2, #0\n"
      "ldr r3, =thimble_stack_bottom\n"
      "cmp r0, r3\n"
      "bcc 1f\n"
      "ldr r3, =thimble_stack_top - 32\n"
      "cmp r0, r3\n"
      "bhi 1f\n"
      "ldr r2, [r0, #24]\n"
      "1: ldr r3, =thimble_stack_top\n"
      "mov sp, r3\n"
      "bl thimble_fault_report\n");
}
