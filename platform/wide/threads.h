/// The threads that draw. Keep them from frame to frame: a thread that has to be woken for each frame starts a tenth of
/// a millisecond late, and one that drew the frame before starts at once.
#pragma once

#include <stddef.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#ifndef THIMBLE_STD_THREADS
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <optional>
#endif

#include "wide/limits.h"

namespace thimble::wide {

/// How many of `wanted` threads, of which the calling one is one, the system gives at a time: at least 1. Where it gives
/// fewer oneTBB throws in the middle of its work, so they are tried first, once.
inline int startable_threads(int wanted) {
  static std::mutex mutex;
  static int tried = 1;
  static int started = 1;
  const std::lock_guard lock(mutex);
  if (wanted > tried) {
    std::atomic<bool> ended{false};
    std::vector<std::jthread> others;
    try {
      while (static_cast<int>(others.size()) < wanted - 1) {
        others.emplace_back([&] { ended.wait(false); });
      }
    } catch (const std::exception&) {
      // These are all.
    }
    ended = true;
    ended.notify_all();
    tried = wanted;
    started = static_cast<int>(others.size()) + 1;
  }
  return std::min(wanted, started);
}

#ifdef THIMBLE_STD_THREADS
/// The same with threads of the C++ library, made for each call: ThreadSanitizer sees into these.
class Threads {
 public:
  explicit Threads(int count) : count_(startable_threads(std::clamp(count, 1, kMaxThreads))) {}

  int count() const { return count_; }

  template <typename Run>
  void each(int tasks, const Run& run) {
    std::atomic<int> next{0};
    const auto work = [&] {
      for (int task = next++; task < tasks; task = next++) {
        run(task);
      }
    };
    std::vector<std::jthread> others;
    for (int thread = 1; thread < std::min(count_, tasks); ++thread) {
      others.emplace_back(work);
    }
    work();
  }

 private:
  int count_;
};
#else
/// Not to be copied; draws one frame at a time.
class Threads {
 public:
  /// `count` includes the calling thread and is limited to 1 .. kMaxThreads and to what the system gives. More threads than processors are made if
  /// asked for, but gain nothing.
  explicit Threads(int count) : count_(startable_threads(std::clamp(count, 1, kMaxThreads))), arena_(count_) {
    if (count_ > oneapi::tbb::info::default_concurrency()) {
      allowed_.emplace(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<size_t>(count_));
    }
  }

  int count() const { return count_; }

  /// Calls run(0) .. run(tasks - 1), each once; the calling thread takes its part. Returns when all calls have
  /// returned. No task may wait for another one to begin.
  template <typename Run>
  void each(int tasks, const Run& run) {
    arena_.execute([&] { oneapi::tbb::parallel_for(0, tasks, run); });
  }

 private:
  int count_;
  std::optional<oneapi::tbb::global_control> allowed_;
  oneapi::tbb::task_arena arena_;
};
#endif

}  // namespace thimble::wide
