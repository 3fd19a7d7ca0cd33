// The exit status, by semihosting (RISC-V Semihosting specification; SYS_EXIT_EXTENDED as on Arm).
#include <stdint.h>

#include "common/run.h"

namespace thimble {
namespace {

// The three instructions are the sign; they must be whole words that lie in one page.
[[gnu::noinline, gnu::aligned(16)]] void semihost(uint32_t operation, const uint32_t* block) {
  register uint32_t number asm("a0") = operation;
  register const uint32_t* argument asm("a1") = block;
  asm volatile(
      ".option push\n"
      ".option norvc\n"
      ".balign 16\n"
      "slli x0, x0, 0x1f\n"
      "ebreak\n"
      "srai x0, x0, 7\n"
      ".option pop\n"
      : "+r"(number)
      : "r"(argument)
      : "memory");
}

}  // namespace

void finish(int status) {
  if (thimble_semihosting != 0) {
    const uint32_t block[2] = {kApplicationExit, static_cast<uint32_t>(status)};
    semihost(kSysExitExtended, block);
  }
  for (;;) {
    asm volatile("wfi");
  }
}

}  // namespace thimble
