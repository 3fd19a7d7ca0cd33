/// Bytes from one thread to one other, without locks.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace thimble::host {

/// Holds up to `kBytes`, a power of two.
template <std::size_t kBytes>
class ByteQueue {
 public:
  static_assert((kBytes & (kBytes - 1)) == 0);

  /// False when it is full. For the one thread that writes.
  bool put(std::uint8_t byte) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kBytes) {
      return false;
    }
    bytes_[end % kBytes] = byte;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  /// The oldest byte, or -1. For the one thread that reads.
  int take() {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) {
      return -1;
    }
    const int byte = bytes_[begin % kBytes];
    begin_.store(begin + 1, std::memory_order_release);
    return byte;
  }

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
  std::atomic<std::size_t> begin_{0};
  std::atomic<std::size_t> end_{0};
};

}  // namespace thimble::host
