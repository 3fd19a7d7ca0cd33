#include "portable/runner.h"

#include "thimble/base/memory.h"

namespace thimble::portable {
namespace {

uint32_t followed_by(uint32_t crc, uint32_t value) {
  const uint8_t bytes[4] = {static_cast<uint8_t>(value), static_cast<uint8_t>(value >> 8),
                            static_cast<uint8_t>(value >> 16), static_cast<uint8_t>(value >> 24)};
  return thimble::crc32(bytes, crc);
}

}  // namespace

Runner* Runner::make(Bytes memory) {
  if (memory.size < runner_bytes()) {
    return nullptr;
  }
  return new (memory.data) Runner(memory.subspan(runner_bytes()));
}

const Failure* Runner::run(const Case& one) {
  // Exactly what it asked for: a case that needs more fails everywhere, not only on the smallest board.
  new (&check_) Check(memory_.subspan(0, one.arena_bytes));
  one.run(check_, one.index);
  crc_ = followed_by(crc_, check_.crc32());
  if (one.arena_bytes <= kCommonArenaBytes) {
    ++common_;
    common_crc_ = followed_by(common_crc_, check_.crc32());
  }
  if (check_.failed()) {
    ++failed_;
    return &check_.failure();
  }
  ++passed_;
  return nullptr;
}

}  // namespace thimble::portable
