/// @file memory.h
/// How every function of the core is handed memory: a span, or an arena that hands out spans.
///
/// The core includes no C++ library header (the RISC-V toolchain has none), so it brings its own span.
///
/// How things come to be, everywhere in the core:
///
///   open   looks at bytes that hold the thing already, and writes nothing: CompactTree::open(bytes, &tree)
///   make   builds the thing in memory that it is given, bytes or an arena: Octree::make(level, bytes, &tree)
///   set    takes values: camera.set(view, level)
///
/// All of them answer with a `Status`; on anything but `kOk` the thing is as it was, and so is an arena. An
/// arena gives `make` exactly the bytes that the thing takes, and the padding before them that it wants.
#ifndef THIMBLE_BASE_MEMORY_H
#define THIMBLE_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include "status.h"

namespace thimble {

/// `size` elements starting at `data`, which it does not own. An empty span may have a null `data`.
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

/// One block of the caller's bytes, handed out front to back. The only allocator of the core.
///
/// Nothing is ever given back on its own; `rewind` drops everything taken since a mark. `used_bytes` and
/// `high_water_bytes` are always known.
class Arena {
 public:
  constexpr Arena() = default;
  /// All of `bytes`, which outlive the arena.
  explicit constexpr Arena(Bytes bytes) : bytes_(bytes) {}

  /// `size` bytes whose address is a multiple of `alignment` (a power of two), or an empty span and no change
  /// when they do not fit. Constant time. The bytes are not cleared. Alignments are sizes: `alignof` of a word
  /// is less than its size on some machines, and a brick map is at a multiple of 8 on all.
  Bytes take(size_t size, size_t alignment = sizeof(uint64_t)) {
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

/// `make` in an arena: the status of `make_in_bytes(bytes)`, which gets `size` bytes of the arena, or an empty
/// span when they do not fit. On anything but `kOk` the arena is as it was, its high water included.
template <class Make>
Status make_in(Arena& arena, size_t size, size_t alignment, Make make_in_bytes) {
  const Arena before = arena;
  const Status status = make_in_bytes(arena.take(size, alignment));
  if (status != Status::kOk) {
    arena = before;
  }
  return status;
}

/// CRC-32 as zlib, PNG and Ethernet compute it (polynomial 0xEDB88320, reflected, inverted in and out) of `bytes`
/// following `previous` (0 to begin): `crc32(b, crc32(a))` is that of a followed by b.
/// A 16-entry table of 64 bytes in flash; about 15 instructions a byte.
uint32_t crc32(ConstBytes bytes, uint32_t previous = 0);

}  // namespace thimble

#endif
