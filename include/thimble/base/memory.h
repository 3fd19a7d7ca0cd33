/// @file memory.h
/// A pointer and a count: how every function of the core is handed memory.
///
/// The core includes no C++ library header (the RISC-V toolchain has none), so it brings its own span. It
/// does not own what it points to.
///
/// One block of the caller's bytes, handed out front to back. The only allocator of the project's core.
///
/// Nothing is ever given back on its own; `rewind` drops everything taken since a mark. `used_bytes` and
/// `high_water_bytes` are always known.
#ifndef THIMBLE_BASE_MEMORY_H
#define THIMBLE_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

namespace thimble {

/// `size` elements starting at `data`. An empty span may have a null `data`.
template <class T>
struct Span {
  T* data = nullptr;
  size_t size = 0;

  constexpr Span() = default;
  constexpr Span(T* first, size_t count) : data(first), size(count) {}
  /// A span of the whole array.
  template <size_t kCount>
  constexpr Span(T (&array)[kCount]) : data(array), size(kCount) {}
  /// A span of `T` serves where a span of `const T` is wanted.
  constexpr operator Span<const T>() const { return {data, size}; }

  constexpr bool empty() const { return size == 0; }
  constexpr T* begin() const { return data; }
  constexpr T* end() const { return data + size; }
  /// Element `index`; the caller keeps `index < size`.
  constexpr T& operator[](size_t index) const { return data[index]; }
  /// `count` elements from `first` on, cut off at the end of this span.
  constexpr Span subspan(size_t first, size_t count = SIZE_MAX) const {
    const size_t from = first < size ? first : size;
    const size_t left = size - from;
    return {data + from, count < left ? count : left};
  }
};

using Bytes = Span<uint8_t>;
using ConstBytes = Span<const uint8_t>;

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
