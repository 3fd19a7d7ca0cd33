/// @file arena.h
/// One block of the caller's bytes, handed out front to back. The only allocator of the project's core.
///
/// Nothing is ever given back on its own; `rewind` drops everything taken since a mark. `used_bytes` and
/// `high_water_bytes` are always known.
#ifndef THIMBLE_ARENA_H
#define THIMBLE_ARENA_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/span.h"

namespace thimble {

class Arena {
 public:
  constexpr Arena() = default;
  /// All of `bytes`, which outlive the arena.
  explicit constexpr Arena(Bytes bytes) : bytes_(bytes) {}

  /// `size` bytes whose address is a multiple of `alignment` (a power of two), or an empty span and no change
  /// when they do not fit. Constant time. The bytes are not cleared.
  Bytes take(size_t size, size_t alignment = alignof(uint64_t)) {
    const size_t address = reinterpret_cast<size_t>(bytes_.data) + used_;
    const size_t padding = (0 - address) & (alignment - 1);
    const size_t left = bytes_.size - used_;
    if (size == 0 || padding > left || size > left - padding) {
      return {};
    }
    const size_t first = used_ + padding;
    used_ = first + size;
    if (used_ > high_water_) {
      high_water_ = used_;
    }
    return bytes_.subspan(first, size);
  }

  /// The bytes not taken yet, for a structure whose size shows only as it grows; it then takes what it used.
  Bytes rest() const { return bytes_.subspan(used_); }

  /// Gives back everything taken since `used_bytes()` was `mark`.
  void rewind(size_t mark) {
    if (mark < used_) {
      used_ = mark;
    }
  }
  /// Records that a user of the bytes behind `used_bytes()` reached `bytes` beyond it.
  void note_scratch(size_t bytes) {
    if (used_ + bytes > high_water_) {
      high_water_ = used_ + bytes;
    }
  }

  size_t used_bytes() const { return used_; }
  size_t high_water_bytes() const { return high_water_; }
  size_t capacity_bytes() const { return bytes_.size; }
  size_t free_bytes() const { return bytes_.size - used_; }

 private:
  Bytes bytes_;
  size_t used_ = 0;
  size_t high_water_ = 0;
};

}  // namespace thimble

#endif
