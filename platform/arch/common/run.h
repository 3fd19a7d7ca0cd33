/// From reset to the application and out again, common to all kinds of core.
#pragma once

#include <stdint.h>

/// Called by the reset code with the stack pointer at thimble_stack_top and nothing else set up: memory, the
/// board, the application, the exit.
extern "C" [[noreturn]] void thimble_run();

/// Whether something outside takes the exit status. 0 in an image for a board: without a debugger the call is a fault,
/// and a Cortex-M0 cannot ask whether there is one. APP.emulated.elf is the same image with another number here
/// (image.cmake).
extern "C" const uint32_t thimble_semihosting;

namespace thimble {

/// Supplied by each kind of core: makes the RAM end where it ends, as well as the core can (MPU, PMP, MMU),
/// and faults arrive at their handlers.
void raise_fence();

/// Supplied by each kind of core: tells an emulator the exit status (semihosting), if thimble_semihosting says so;
/// then stops.
[[noreturn]] void finish(int status);
inline constexpr uint32_t kSysExitExtended = 0x20;  ///< with a block of this reason and the status
inline constexpr uint32_t kApplicationExit = 0x20026;

/// What a fault handler found out.
struct Fault {
  const char* what;  ///< in words
  uint32_t pc;       ///< the instruction
  uint32_t address;  ///< the byte it wanted, if `has_address`
  bool has_address;
  uint32_t stack_pointer;
};
/// Says what happened over the UART and ends with port::kFaultStatus. The handler has moved the stack pointer
/// back to the top of the stack: what lay there is lost.
[[noreturn]] void report_fault(const Fault& fault);

}  // namespace thimble
