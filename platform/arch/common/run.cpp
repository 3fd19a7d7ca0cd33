#include "common/run.h"

#include "board.h"
#include "common/layout.h"
#include "common/say.h"
#include "thimble_board_facts.h"

int thimble_application();

[[gnu::section(".semihosting"), gnu::used]] const uint32_t thimble_semihosting = 0;

namespace thimble {
namespace {

// Bytes below this function's own frame that are left unpainted: what painting itself may use.
constexpr uint32_t kPaintMarginBytes = 64;

void paint_stack() {
  uint8_t* const end = static_cast<uint8_t*>(__builtin_frame_address(0)) - kPaintMarginBytes;
  for (volatile uint8_t* byte = thimble_stack_bottom; byte < end; ++byte) {
    *byte = port::kStackPaint;
  }
}

void set_up_variables() {
  const uint32_t* from = thimble_data_image;
  for (uint32_t* word = thimble_data_start; word < thimble_data_end; ++word) {
    *word = *from++;
  }
  for (uint32_t* word = thimble_bss_start; word < thimble_bss_end; ++word) {
    *word = 0;
  }
}

// What the paint says, for whoever chooses the size of the stack.
void report_stack() {
  say("stack: ");
  say_decimal(port::stack_high_water());
  say(" of ");
  say_decimal(port::facts().stack_bytes);
  say(" bytes used\n");
}

// Whether an address lies in the stack or so close below it that only an overflow explains it.
bool is_stack_overflow(const Fault& fault) {
  const uint32_t bottom = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(thimble_stack_bottom));
  const uint32_t slack = 32;  // what an exception pushes may still have fitted
  return fault.stack_pointer < bottom + slack;
}

#if defined(THIMBLE_HOLDS)
bool has_held = false;  // said so already
#endif

}  // namespace

#if defined(THIMBLE_HOLDS)
bool port::holding() {
  if (!has_held) {
    say("holding\n");
  }
  has_held = true;
  return true;
}
#endif

void report_fault(const Fault& fault) {
  say("\nfault: ");
  say(fault.what);
  if (fault.has_address) {
    say(", address ");
    say_hex(fault.address);
  }
  say(", instruction ");
  say_hex(fault.pc);
  say(", stack pointer ");
  say_hex(fault.stack_pointer);
  say(is_stack_overflow(fault) ? ": the stack has overflowed\n" : "\n");
  finish(port::kFaultStatus);
}

}  // namespace thimble

void thimble_run() {
  thimble::paint_stack();
  thimble::set_up_variables();
  thimble::board::start();
  thimble::raise_fence();
  thimble::board::start_clock();
  const int status = thimble_application();
  thimble::report_stack();
#if defined(THIMBLE_HOLDS)
  if (!thimble::has_held) {
    while (thimble::port::holding() && thimble::board::get() != 'q') {
    }
  }
#endif
  thimble::finish(status);
}
