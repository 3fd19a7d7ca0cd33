// The exit status, by semihosting (Semihosting for AArch32 and AArch64, SYS_EXIT_EXTENDED).
#include <stdint.h>

#include "common/run.h"

namespace thimble {
void finish(int status) {
  if (thimble_semihosting != 0) {
    const uint32_t block[2] = {kApplicationExit, static_cast<uint32_t>(status)};
    register uint32_t operation asm("r0") = kSysExitExtended;
    register const uint32_t* argument asm("r1") = block;
    asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  }
  for (;;) {
    asm volatile("wfi");
  }
}

}  // namespace thimble
