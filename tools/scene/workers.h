/// @file workers.h
/// Threads for what falls into tasks that do not know of one another.
#ifndef THIMBLE_TOOLS_SCENE_WORKERS_H
#define THIMBLE_TOOLS_SCENE_WORKERS_H

#include <cstddef>
#include <functional>

namespace thimble::tools {

/// Calls run(task, worker) once for each task of 0 .. tasks - 1, on up to `threads` threads of which the calling
/// one is one, and returns when all calls have returned. `worker` is less than `threads`, and no two calls at a
/// time have the same. More threads than processors are no gain, but are what was asked for. `run` throws nothing.
void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run);

}  // namespace thimble::tools

#endif
