#include "scene/wide_renderer.h"

#include <algorithm>
#include <chrono>

#include "scene/built_scene.h"
#include "scene/workers.h"
#include "wide/raster/renderer.h"
#include "wide/rays/ray_map.h"
#include "wide/threads.h"

namespace thimble::tools {

std::vector<std::string> WideRenderer::instruction_sets() {
  std::vector<std::string> names;
  for (int i = 0; i < wide::instruction_set_count(); ++i) {
    wide::use_instruction_set(i);
    names.emplace_back(wide::instruction_set());
  }
  wide::use_instruction_set(-1);
  return names;
}

namespace {

// As many of the threads as have room beside the smaller one of the lists; at least one.
int threads_within(const CompactTree& tree, const Arena& arena, std::int32_t width_px, std::int32_t rows,
                   int threads) {
  const std::size_t box_bytes = wide::VoxelLists::bytes(tree, wide::ListKind::kBoxes);
  const auto fits = [&](std::size_t lists) {
    return wide::workspace_bytes(width_px, rows, threads) + WideRenderer::kWorkspaceAlignment + lists <=
           arena.free_bytes();
  };
  if (threads == 1 || fits(box_bytes)) {
    return threads;
  }
  const std::size_t least = std::min(box_bytes, wide::VoxelLists::bytes(tree));
  while (threads > 1 && !fits(least)) {
    --threads;
  }
  return threads;
}

class InArena final : public WideRenderer {
 public:
  InArena(const wide::VoxelLists& lists, Bytes workspace, std::int32_t rows, int threads, double seconds)
      : lists_(lists), workspace_(workspace), rows_(rows), threads_(threads), seconds_(seconds) {}

  std::int32_t rows() const override { return rows_; }
  int threads() const override { return threads_.count(); }
  double seconds() const override { return seconds_; }
  Status render(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                wide::Counts* work) override {
    wide::Options options;
    options.threads = &threads_;
    wide::Stats stats;
    const Status status = wide::render(lists_, camera, shading, band, workspace_, counts, options, &stats);
    work->add(stats.counts);
    return status;
  }

 private:
  wide::VoxelLists lists_;
  Bytes workspace_;
  std::int32_t rows_;
  wide::Threads threads_;
  double seconds_;
};

std::unique_ptr<WideRenderer> make_with(const CompactTree& tree, Arena* arena, std::int32_t width_px,
                                        std::int32_t height_px, int threads) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t mark = arena->used_bytes();
  const std::int32_t least_rows = std::min(height_px, WideRenderer::kLeastRows);
  const auto workspace = [&](std::int32_t rows) { return wide::workspace_bytes(width_px, rows, threads); };
  // What the least workspace leaves is the lists', and where the fastest do not fit, those of boxes alone may.
  // Lists are counted before they are made: what does not fit costs little time.
  const std::size_t kept = workspace(least_rows) + WideRenderer::kWorkspaceAlignment;
  if (arena->free_bytes() < kept) {
    return nullptr;
  }
  Arena part(arena->rest().subspan(0, arena->free_bytes() - kept));
  wide::VoxelLists lists;
  if (wide::VoxelLists::make(tree, &part, &lists) != Status::kOk &&
      wide::VoxelLists::make(tree, &part, &lists, wide::ListKind::kBoxes) != Status::kOk) {
    return nullptr;
  }
  arena->take(part.used_bytes(), 1);
  std::int32_t rows = height_px;
  while (rows > least_rows && workspace(rows) > arena->free_bytes()) {
    rows = std::max(least_rows, rows / 2);
  }
  const Bytes taken = arena->take(workspace(rows), WideRenderer::kWorkspaceAlignment);
  if (taken.empty()) {
    arena->rewind(mark);
    return nullptr;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return std::make_unique<InArena>(lists, taken, rows, threads, seconds);
}

}  // namespace

std::size_t WideRenderer::bytes(const CompactTree& tree, std::int32_t width_px, std::int32_t height_px,
                                int threads) {
  return wide::VoxelLists::bytes(tree) + kWorkspaceAlignment +
         wide::workspace_bytes(width_px, height_px, threads);
}

std::unique_ptr<WideRenderer> WideRenderer::make(const CompactTree& tree, Arena* arena, std::int32_t width_px,
                                                 std::int32_t height_px, int threads) {
  const int crew = threads_within(tree, *arena, width_px, std::min(height_px, kLeastRows), threads);
  auto renderer = make_with(tree, arena, width_px, height_px, crew);
  if (renderer == nullptr && crew > 1) {
    // Lists may take some bytes more, for where they begin.
    renderer = make_with(tree, arena, width_px, height_px, crew - 1);
  }
  return renderer;
}

FirstHits wide_first_hits(BuiltScene* built) {
  wide::RayMap map;
  if (built->structure() != StructureKind::kCompact || built->draws_from_file() ||
      wide::RayMap::make(built->compact(), &built->arena(), &map) != Status::kOk) {
    return nullptr;
  }
  return [map](Span<const Ray> rays, Span<Hit> hits) { return wide::first_hit(map, rays, hits); };
}

void each_task(std::size_t tasks, int threads,
               const std::function<void(std::size_t task, std::size_t worker)>& run) {
  wide::Threads(threads).each(static_cast<int>(tasks), [&](int task, int thread) {
    run(static_cast<std::size_t>(task), static_cast<std::size_t>(thread));
  });
}

}  // namespace thimble::tools
