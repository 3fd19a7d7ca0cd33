// What a build without the wide renderer has in its place: nothing of it is made, so that the core draws and traces, and
// threads of the C++ library, made for each call.
#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

#include "scene/lit_streams.h"
#include "scene/wide_renderer.h"
#include "scene/workers.h"

namespace thimble::tools {

std::vector<std::string> WideRenderer::instruction_sets() {
  return {};
}

std::size_t WideRenderer::bytes(const CompactTree& /*tree*/, std::int32_t /*width_px*/,
                                std::int32_t /*height_px*/, int /*threads*/) {
  return SIZE_MAX;
}

std::unique_ptr<WideRenderer> WideRenderer::make(const CompactTree& /*tree*/, Arena* /*arena*/,
                                                 std::int32_t /*width_px*/, std::int32_t /*height_px*/,
                                                 int /*threads*/) {
  return nullptr;
}

FirstHits wide_first_hits(BuiltScene* /*built*/) {
  return nullptr;
}

std::unique_ptr<LitStreams> LitStreams::make(const CompactTree& /*tree*/, Arena* /*arena*/,
                                             EffectSet /*effects*/, const LitScene& /*scene*/,
                                             int /*threads*/) {
  return nullptr;
}

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
