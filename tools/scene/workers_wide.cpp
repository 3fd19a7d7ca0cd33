#include "scene/workers.h"
#include "wide/threads.h"

namespace thimble::tools {

void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run) {
  wide::Threads(threads).each(static_cast<int>(tasks), [&](int task, int thread) {
    run(static_cast<std::size_t>(task), static_cast<std::size_t>(thread));
  });
}

}  // namespace thimble::tools
