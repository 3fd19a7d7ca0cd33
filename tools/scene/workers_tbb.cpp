// The threads of oneTBB, which stay from call to call.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "scene/workers.h"
#include "wide/threads.h"

namespace thimble::tools {

void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run) {
  threads = wide::startable_threads(threads);
  const oneapi::tbb::global_control allowed(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
  oneapi::tbb::task_arena arena(threads);
  arena.execute([&] {
    oneapi::tbb::parallel_for(
        oneapi::tbb::blocked_range<std::size_t>(0, tasks, 1),
        [&](const oneapi::tbb::blocked_range<std::size_t>& part) {
          for (std::size_t task = part.begin(); task != part.end(); ++task) {
            run(task, static_cast<std::size_t>(oneapi::tbb::this_task_arena::current_thread_index()));
          }
        },
        oneapi::tbb::simple_partitioner());
  });
}

}  // namespace thimble::tools
