/// Threads for what falls into tasks that do not know of one another.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "thimble/base/status.h"

namespace thimble::tools {

/// Calls run(task, worker) once for each task of 0 .. tasks - 1, on up to `threads` threads of which the calling
/// one is one, and returns when all calls have returned. `worker` is less than `threads`, and no two calls at a
/// time have the same. More threads than processors are no gain, but are started. `run` throws nothing.
void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run);

/// The same for tasks that may fail: run(task, worker) returns a Status, and after an error no other task begins.
template <class Run>
Status each_until_error(std::int32_t tasks, int threads, const Run& run) {
  std::atomic<Status> worst{Status::kOk};
  each_task(static_cast<std::size_t>(tasks), threads, [&](std::size_t task, std::size_t worker) {
    const Status status =
        worst.load() == Status::kOk ? run(static_cast<std::int32_t>(task), worker) : Status::kOk;
    if (status != Status::kOk) {
      worst.store(status);
    }
  });
  return worst;
}

}  // namespace thimble::tools
