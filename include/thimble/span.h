/// @file span.h
/// A pointer and a count: how every function of the core is handed memory.
///
/// The core includes no C++ library header (the RISC-V toolchain has none), so it brings its own span. It
/// does not own what it points to.
#ifndef THIMBLE_SPAN_H
#define THIMBLE_SPAN_H

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

}  // namespace thimble

#endif
