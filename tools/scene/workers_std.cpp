// Threads of the C++ library, made for each call: what builds without the wide renderer have.
#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

#include "scene/workers.h"

namespace thimble::tools {

void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run) {
  std::atomic<std::size_t> next{0};
  const auto work = [&](std::size_t worker) {
    for (std::size_t task = next++; task < tasks; task = next++) {
      run(task, worker);
    }
  };
  std::vector<std::jthread> others;
  const std::size_t wanted = std::min(tasks, static_cast<std::size_t>(threads));
  try {
    for (std::size_t worker = 1; worker < wanted; ++worker) {
      others.emplace_back(work, worker);
    }
  } catch (const std::system_error&) {
    // The machine has no more threads to give: those that there are do the work.
  }
  work(0);
}

}  // namespace thimble::tools
