/// Decides which of several threads draws what: tiles while there are any, then parts of what other threads still
/// have to draw.
///
/// Nobody waits for a thread that has not started: each thread takes the next tile or a part, or leaves. A thread
/// waits only while another one is drawing, and a thread that draws waits for nobody.
#pragma once

#include <stdint.h>

#include <atomic>
#include <mutex>
#include <thread>

namespace thimble::wide {

/// Made for one frame. A `Taker` is what a thread draws with. It has the members `std::atomic<bool> given` and
/// `Taker* next_taker`, which only this class uses, and must live until the thread's last call has returned.
template <typename Taker>
class WorkSharing {
 public:
  static constexpr int kGiven = -1;
  static constexpr int kNothing = -2;

  explicit WorkSharing(int tiles) : tiles_(tiles), unfinished_(tiles) {}

  /// Returns the number of a tile that nobody else draws, from 0 up; kGiven when another thread has put a part into
  /// `taker`; kNothing when all is drawn. Waits while other threads draw. Call finish() after each tile and part.
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
      // When nothing is unfinished nobody can give anything, so this taker may stay in the list.
      if (unfinished_.load(std::memory_order_acquire) == 0) {
        return kNothing;
      }
      std::this_thread::yield();
    }
    return kGiven;
  }
  /// Notes that the tile or part that next() returned is drawn, except what was given away.
  void finish() { unfinished_.fetch_sub(1, std::memory_order_acq_rel); }

  /// Whether a thread waits. Costs next to nothing.
  bool is_wanted() const { return waiting_.load(std::memory_order_relaxed) != nullptr; }
  /// Takes a waiting taker off the list, for a thread that has something to give: fill the taker, then give() it.
  /// Returns null when others were faster.
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
  /// Resumes the taker. Afterwards the caller must not touch it.
  static void give(Taker* taker) { taker->given.store(true, std::memory_order_release); }

  /// How many parts were given. Call it when all threads have returned.
  uint32_t splits() const { return splits_; }

 private:
  alignas(64) std::atomic<Taker*> waiting_{nullptr};  ///< changed only under the mutex
  std::mutex mutex_;
  const int tiles_;
  std::atomic<int> next_tile_{0};
  std::atomic<int> unfinished_;  ///< tiles and parts that are not drawn yet
  uint32_t splits_ = 0;
};

}  // namespace thimble::wide
