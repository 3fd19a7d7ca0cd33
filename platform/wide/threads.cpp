#include "wide/threads.h"

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

namespace thimble::wide {
namespace {

// How many of `wanted` threads, of which the calling one is one, the system gives at a time: at least 1. Where it gives
// fewer oneTBB throws in the middle of its work, so they are tried first, once.
int startable_threads(int wanted) {
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

}  // namespace

#ifdef THIMBLE_STD_THREADS
/// Threads of the C++ library, made for each call: ThreadSanitizer sees into these.
struct Threads::Pool {
  explicit Pool(int count) : count(count) {}

  void each(int tasks, const std::function<void(int task, int thread)>& run) const {
    std::atomic<int> next{0};
    const auto work = [&](int thread) {
      for (int task = next++; task < tasks; task = next++) {
        run(task, thread);
      }
    };
    std::vector<std::jthread> others;
    for (int thread = 1; thread < std::min(count, tasks); ++thread) {
      others.emplace_back(work, thread);
    }
    work(0);
  }

  int count;
};
#else
struct Threads::Pool {
  explicit Pool(int count) : arena(count) {
    if (count > oneapi::tbb::info::default_concurrency()) {
      allowed.emplace(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<size_t>(count));
    }
  }

  void each(int tasks, const std::function<void(int task, int thread)>& run) {
    arena.execute([&] {
      oneapi::tbb::parallel_for(
          0, tasks, [&](int task) { run(task, oneapi::tbb::this_task_arena::current_thread_index()); },
          oneapi::tbb::simple_partitioner());
    });
  }

  std::optional<oneapi::tbb::global_control> allowed;
  oneapi::tbb::task_arena arena;
};
#endif

Threads::Threads(int count)
    : count_(startable_threads(std::clamp(count, 1, kMaxThreads))), pool_(std::make_unique<Pool>(count_)) {}

Threads::~Threads() = default;

void Threads::each(int tasks, const std::function<void(int task, int thread)>& run) {
  pool_->each(tasks, run);
}

void Threads::each(int tasks, const std::function<void(int task)>& run) {
  pool_->each(tasks, [&](int task, int /*thread*/) { run(task); });
}

}  // namespace thimble::wide
