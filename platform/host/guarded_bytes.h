/// Bytes whose neighbours cannot be touched: exactly so many, ended by a page that faults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "thimble/base/memory.h"

namespace thimble::host {

/// The bytes end where a page ends, so the first one behind them faults. In front of them the rest of a page
/// holds a pattern, which `front_is_whole` looks at, and before that another page faults. Throws
/// std::bad_alloc.
class GuardedBytes {
 public:
  /// `size` bytes, each of value `fill`, at an address that is a multiple of 8 if `size` is one.
  GuardedBytes(std::size_t size, std::uint8_t fill);
  ~GuardedBytes();
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  Bytes bytes() const { return {first_, size_}; }
  /// From now on writing to them faults.
  void make_read_only();
  bool front_is_whole() const;
  /// Whether an address lies in the bytes or in what guards them; if so, where, counted from the first byte.
  std::optional<std::ptrdiff_t> offset_of(std::uintptr_t address) const;

 private:
  std::uint8_t* mapping_ = nullptr;
  std::size_t mapped_bytes_ = 0;
  std::uint8_t* first_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace thimble::host
