/// Runs cases and adds up what they gave; says nothing itself.
#pragma once

#include "portable/groups.h"

namespace thimble::portable {

/// Lies in the caller's memory rather than on the stack, because a case wants most of that.
class Runner {
 public:
  /// At the front of `memory` (aligned to 8); the cases get what is behind. Null when `memory` is too small
  /// for the runner itself.
  static Runner* make(Bytes memory);

  /// Whether a case's memory is there.
  bool fits(const Case& one) const { return one.arena_bytes <= memory_.size; }
  /// Runs a case that fits. Returns what failed first, or null.
  const Failure* run(const Case& one);

  int passed() const { return passed_; }
  int failed() const { return failed_; }
  /// How many of those run need no more than kCommonArenaBytes.
  int common() const { return common_; }
  /// CRC-32 of the CRC-32s of the cases run, in order: of all, and of those that every board runs.
  uint32_t crc32() const { return crc_; }
  uint32_t common_crc32() const { return common_crc_; }
  /// Bytes that a case may have here.
  size_t case_bytes() const { return memory_.size; }

 private:
  static void* operator new(size_t, void* at) { return at; }
  static void operator delete(void*, void*) {}
  explicit Runner(Bytes memory) : check_(memory), memory_(memory) {}

  Check check_;
  Bytes memory_;
  int passed_ = 0;
  int failed_ = 0;
  int common_ = 0;
  uint32_t crc_ = 0;
  uint32_t common_crc_ = 0;
};

/// Bytes that a runner takes besides a case's own.
constexpr uint32_t runner_bytes() {
  return (sizeof(Runner) + 7) & ~size_t{7};
}

}  // namespace thimble::portable
