// The memory protection unit as a fence: flash can be read and executed, and what lies just below and above
// the RAM and past the flash is nobody's. Cores without the unit (Cortex-M0, some Cortex-M3) have the fence
// that the bus gives.
#include <stdint.h>

#include "common/run.h"
#include "cortex-m/system_control.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {

#if defined(__ARM_ARCH_6M__)

void raise_fence() {}

#else

namespace {

// MPU_RASR: XN 28 | AP 26..24 | TEX 21..19 | S 18 | C 17 | B 16 | SIZE 5..1 | ENABLE 0; a region has
// 2^(SIZE+1) bytes.
constexpr uint32_t kEnable = 1U << 0;
constexpr uint32_t kNoAccess = 1U << 28;
constexpr uint32_t kReadOnly = 6U << 24 | 1U << 17;  // normal memory, cached write-through
constexpr uint32_t kMaxGuardBytes = 65536;
constexpr uint32_t kRegions = 4;

constexpr uint32_t size_field(uint32_t bytes) {
  uint32_t log2 = 0;
  while ((1U << log2) < bytes) {
    ++log2;
  }
  return (log2 - 1) << 1;
}

// The largest guard that may start at `address`: a region is aligned to its size.
constexpr uint32_t guard_bytes(uint32_t address) {
  const uint32_t alignment = address & (~address + 1);
  return alignment == 0 || alignment > kMaxGuardBytes ? kMaxGuardBytes : alignment;
}

void set_region(uint32_t number, uint32_t base, uint32_t bytes, uint32_t access) {
  register32(cortex_m::kMpuRnr) = number;
  register32(cortex_m::kMpuRbar) = base;
  register32(cortex_m::kMpuRasr) = access | size_field(bytes) | kEnable;
}

constexpr uint32_t kFlashStart = static_cast<uint32_t>(board::kFlashOrigin);
constexpr uint32_t kFlashEnd = kFlashStart + board::kFacts.flash_bytes;
constexpr uint32_t kRamStart = static_cast<uint32_t>(board::kRamOrigin);
constexpr uint32_t kRamEnd = kRamStart + board::kFacts.ram_bytes;

}  // namespace

void raise_fence() {
  set_bits(cortex_m::kShcsr, cortex_m::kShcsrFaults);
  const uint32_t regions = (register32(cortex_m::kMpuType) >> 8) & 0xFFU;
  if (regions < kRegions) {
    return;
  }
  set_region(0, kFlashStart, board::kFacts.flash_bytes, kReadOnly);
  set_region(1, kFlashEnd, guard_bytes(kFlashEnd), kNoAccess);
  set_region(2, kRamStart - kMaxGuardBytes, kMaxGuardBytes, kNoAccess);
  set_region(3, kRamEnd, guard_bytes(kRamEnd), kNoAccess);
  asm volatile("dsb" ::: "memory");
  register32(cortex_m::kMpuCtrl) = cortex_m::kMpuCtrlEnable | cortex_m::kMpuCtrlDefaultMap;
  asm volatile("dsb\nisb" ::: "memory");
}

#endif

}  // namespace thimble
