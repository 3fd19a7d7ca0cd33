/// The one block of bytes that a scene lives in on the host.
#pragma once

#include <cstddef>
#include <utility>

#include "thimble/base/memory.h"

namespace thimble::tools {

/// Address space whose pages take memory only once they are written. It stands for a board's RAM, so it is
/// one contiguous block that never grows.
class HostMemory {
 public:
  HostMemory() = default;
  /// Exactly `size` bytes. Throws std::bad_alloc when the system refuses.
  explicit HostMemory(std::size_t size);
  /// As many bytes as the system lets us reserve, 64 GiB at most: for a scene without a budget.
  static HostMemory largest();
  ~HostMemory();
  HostMemory(HostMemory&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  HostMemory& operator=(HostMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }

  Bytes bytes() const { return {data_, size_}; }
  /// Keeps the first `size` bytes, which may then be elsewhere, and gives the system what it can of the rest.
  void keep(std::size_t size);

 private:
  uint8_t* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace thimble::tools
