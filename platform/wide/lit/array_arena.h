/// Arrays from bytes that the caller gave.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <new>

namespace thimble::wide {

/// Takes arrays from bytes that begin at a multiple of kAlignment; of null, only counts them.
class ArrayArena {
 public:
  static constexpr size_t kAlignment = 64;

  explicit ArrayArena(uint8_t* at) : at_(at) {}

  /// Where the first multiple of kAlignment is in bytes at any address.
  static uint8_t* aligned(uint8_t* at) {
    const size_t skew = reinterpret_cast<uintptr_t>(at) % kAlignment;
    return at + (skew == 0 ? 0 : kAlignment - skew);
  }

  template <typename T>
  T* take(size_t count) {
    used_ = (used_ + kAlignment - 1) / kAlignment * kAlignment;
    T* array = at_ == nullptr ? nullptr : reinterpret_cast<T*>(at_ + used_);
    used_ += count * sizeof(T);
    for (size_t i = 0; array != nullptr && i < count; ++i) {
      new (array + i) T;
    }
    return array;
  }
  size_t used() const { return used_; }

  /// Lays out the arrays of `parts` from `bytes` on; returns what further arrays are taken from.
  template <class Shape, class Parts>
  static ArrayArena laid_out(const Shape& shape, uint8_t* bytes, Parts* parts) {
    ArrayArena arena(bytes == nullptr ? nullptr : aligned(bytes));
    parts->lay_out(shape, &arena);
    return arena;
  }
  /// The bytes that two sets of arrays, one behind the other, take at any address.
  template <class Parts, class MoreParts, class Shape, class MoreShape>
  static size_t bytes_of(const Shape& shape, const MoreShape& more) {
    Parts parts;
    MoreParts more_parts;
    ArrayArena arena = laid_out(shape, nullptr, &parts);
    more_parts.lay_out(more, &arena);
    return arena.used() + kAlignment;
  }

 private:
  uint8_t* at_;
  size_t used_ = 0;
};

}  // namespace thimble::wide
