// Physical memory protection: the flash can be read and executed, not written. Below and above the RAM of the
// boards here nothing answers, so the bus is the fence there.
#include <stdint.h>

#include "common/run.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

// pmpcfg: lock, which makes an entry hold for machine mode too; naturally aligned power of two; execute and
// read.
constexpr uint32_t kLock = 1U << 7;
constexpr uint32_t kAligned = 3U << 3;
constexpr uint32_t kExecute = 1U << 2;
constexpr uint32_t kRead = 1U << 0;

constexpr uint32_t kFlashBytes = board::kFacts.flash_bytes;
static_assert((kFlashBytes & (kFlashBytes - 1)) == 0 && board::kFlashOrigin % kFlashBytes == 0);

}  // namespace

void raise_fence() {
  const uint32_t region = static_cast<uint32_t>(board::kFlashOrigin) >> 2 | ((kFlashBytes >> 3) - 1);
  const uint32_t access = kLock | kAligned | kExecute | kRead;
  asm volatile("csrw pmpaddr0, %0\ncsrw pmpcfg0, %1" ::"r"(region), "r"(access) : "memory");
}

}  // namespace thimble
