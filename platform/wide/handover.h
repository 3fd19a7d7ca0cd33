/// @file handover.h
/// Who of several threads draws what: tiles while there are any, then parts of what others still have.
///
/// Nobody waits for a thread that has not come: whoever comes takes the next tile, a part, or goes. A thread
/// waits only while another has something left, and that one needs no other to go on.
#ifndef THIMBLE_PLATFORM_HOST_WIDE_HANDOVER_H
#define THIMBLE_PLATFORM_HOST_WIDE_HANDOVER_H

#include <stdint.h>

#include <atomic>
#include <mutex>
#include <thread>

namespace thimble::wide {

/// Of one frame. `Taker`: what a thread draws with; it has `std::atomic<bool> given` and `Taker* next_taker`,
/// which are left to this class, and outlives the thread's last call.
template <typename Taker>
class Handover {
 public:
  static constexpr int kGiven = -1;
  static constexpr int kNothing = -2;

  explicit Handover(int tiles) : tiles_(tiles), unfinished_(tiles) {}

  /// The number of a tile that nobody else draws, from 0 up; kGiven: another thread has put a part into
  /// `taker`; kNothing: all is drawn. Waits while others draw. After a tile and a part: finish().
  int next(Taker* taker) {
    const int tile = next_tile_.fetch_add(1, std::memory_order_relaxed);
    if (tile < tiles_) {
      return tile;
    }
    taker->given.store(false, std::memory_order_relaxed);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      taker->next_taker = waiting_.load(std::memory_order_relaxed);
      waiting_.store(taker, std::memory_order_relaxed);
    }
    while (!taker->given.load(std::memory_order_acquire)) {
      // Once it is 0 there is nobody who could give, so that takers may be left in the list.
      if (unfinished_.load(std::memory_order_acquire) == 0) {
        return kNothing;
      }
      std::this_thread::yield();
    }
    return kGiven;
  }
  /// The tile or part that next() returned is drawn, but for what was given away.
  void finish() { unfinished_.fetch_sub(1, std::memory_order_acq_rel); }

  /// Whether anybody waits, by a look that costs nothing.
  bool is_wanted() const { return waiting_.load(std::memory_order_relaxed) != nullptr; }
  /// One that waits, for a thread that has something left; null: others were faster. It is to be filled and
  /// given.
  Taker* take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    Taker* const taker = waiting_.load(std::memory_order_relaxed);
    if (taker != nullptr) {
      waiting_.store(taker->next_taker, std::memory_order_relaxed);
      unfinished_.fetch_add(1, std::memory_order_relaxed);
      ++splits_;
    }
    return taker;
  }
  /// Nothing of `taker` may be touched any more.
  static void give(Taker* taker) { taker->given.store(true, std::memory_order_release); }

  /// How many parts were given. When all threads have gone.
  uint32_t splits() const { return splits_; }

 private:
  alignas(64) std::atomic<Taker*> waiting_{nullptr};  ///< changed only under the mutex
  std::mutex mutex_;
  const int tiles_;
  std::atomic<int> next_tile_{0};
  std::atomic<int> unfinished_;  ///< tiles and parts
  uint32_t splits_ = 0;
};

}  // namespace thimble::wide

#endif
