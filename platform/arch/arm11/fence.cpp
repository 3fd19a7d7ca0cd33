// The memory management unit as a fence: one table of sections of 1 MiB, each address meaning itself. Image
// read-only, RAM, the board's windows; everything else aborts. Both caches are on, for image and RAM (ARM1176JZF-S
// Technical Reference Manual, 6.6 and 3.2.7); a display's memory is a window without cache, so nobody needs to clean it.
#include "arm11/fence.h"

#include <stddef.h>

#include "common/run.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

// The table: 4096 words below the image, which starts at 32 KiB.
constexpr uintptr_t kTable = 0x4000;
constexpr uint32_t kSections = 4096;
constexpr uint32_t kSectionShift = 20;
static_assert(board::kFlashOrigin >= kTable + kSections * sizeof(uint32_t));

// Section descriptor: base 31..20 | APX 15 | TEX 14..12 | AP 11..10 | domain 8..5 | XN 4 | C 3 | B 2 | 1 0.
constexpr uint32_t kSection = 2;
constexpr uint32_t kNeverExecuted = 1U << 4;
constexpr uint32_t kReadWrite = 3U << 10;
constexpr uint32_t kReadOnly = 1U << 15 | 1U << 10;
constexpr uint32_t kCached = 3U << 2;     // memory, written back
constexpr uint32_t kUncached = 1U << 12;  // memory
constexpr uint32_t kShared = 1U << 2;     // device

struct Opened {
  uint32_t address;
  uint32_t bytes;
  uint32_t attributes;
};
Opened opened[4];
size_t opened_count = 0;

void map(uint32_t address, uint32_t bytes, uint32_t attributes) {
  uint32_t* const table = reinterpret_cast<uint32_t*>(kTable);
  const uint32_t last = (address + bytes - 1) >> kSectionShift;
  for (uint32_t section = address >> kSectionShift; section <= last; ++section) {
    table[section] = section << kSectionShift | attributes | kSection;
  }
}

// Control register: MMU, both caches, descriptors in the form of Armv6.
constexpr uint32_t kControlMmu = 1U << 0;
constexpr uint32_t kControlDataCache = 1U << 2;
constexpr uint32_t kControlInstructionCache = 1U << 12;
constexpr uint32_t kControlArmv6 = 1U << 23;

}  // namespace

void arm11::open_window(Window kind, uint32_t address, uint32_t bytes) {
  if (opened_count < sizeof(opened) / sizeof(opened[0])) {
    opened[opened_count] = {address, bytes,
                            kReadWrite | kNeverExecuted | (kind == Window::kDevice ? kShared : kUncached)};
    ++opened_count;
  }
}

void raise_fence() {
  uint32_t* const table = reinterpret_cast<uint32_t*>(kTable);
  for (uint32_t section = 0; section < kSections; ++section) {
    table[section] = 0;
  }
  map(0, static_cast<uint32_t>(board::kFlashOrigin) + board::kFacts.flash_bytes, kReadOnly | kCached);
  map(static_cast<uint32_t>(board::kRamOrigin), board::kFacts.ram_bytes,
      kReadWrite | kNeverExecuted | kCached);
  for (size_t i = 0; i < opened_count; ++i) {
    map(opened[i].address, opened[i].bytes, opened[i].attributes);
  }
  const uint32_t zero = 0;
  const uint32_t client = 1;  // domain 0 heeds the permissions
  uint32_t control = 0;
  asm volatile(
      "mcr p15, 0, %1, c7, c10, 4\n"  // everything written
      "mcr p15, 0, %1, c8, c7, 0\n"   // no translation remembered
      "mcr p15, 0, %1, c7, c5, 0\n"   // no instruction either
      "mcr p15, 0, %1, c7, c6, 0\n"   // no data
      "mcr p15, 0, %2, c2, c0, 0\n"   // table
      "mcr p15, 0, %3, c3, c0, 0\n"   // domains
      "mrc p15, 0, %0, c1, c0, 0\n"
      : "=&r"(control)
      : "r"(zero), "r"(table), "r"(client)
      : "memory");
  control |= kControlMmu | kControlDataCache | kControlInstructionCache | kControlArmv6;
  asm volatile(
      "mcr p15, 0, %0, c1, c0, 0\n"
      "mcr p15, 0, %1, c7, c5, 4\n"  // and from here on
      :
      : "r"(control), "r"(zero)
      : "memory");
}

}  // namespace thimble
