#include "wide/lit/lit_renderer.h"

#include <algorithm>
#include <atomic>

#include "wide/lit/opaque_stream.h"
#include "wide/lit/stream.h"

namespace thimble::wide {
namespace {

// Enough rays for vectors to be full most of the time, few enough for a second-level cache.
constexpr uint32_t kSlots = 1024;
constexpr uint32_t kLeastSlots = 64;

// The rows of a task: enough for all slots, and whole bytes.
int32_t rows_of_task(const Band& band, int32_t width_px, uint32_t slots) {
  const int32_t rows = static_cast<int32_t>(slots) / std::max(width_px, 1) + 1;
  return has_pages(band.format) ? (rows + 7) / 8 * 8 : rows;
}

// Either kind of stream fits in what was asked for, so that a workspace serves all sets of effects within one.
size_t most_bytes(EffectSet effects, const LitScene& scene, uint32_t slots) {
  return std::max(StreamShape(effects, scene, slots).bytes(), OpaqueShape(effects, scene, slots).bytes());
}

template <class Stream, class Shape>
Status draw_by(const lit::Frame& frame, const RayMap& map, const Band& band, size_t stride, Bytes workspace,
               Threads* threads, LitCounts* counts) {
  // As many threads as there is room for; then as many pixels at once.
  size_t workers = threads == nullptr ? 1 : static_cast<size_t>(threads->count());
  workers = std::min(workers, workspace.size / least_lit_workspace_bytes(frame.effects, frame.scene));
  if (workers == 0) {
    return Status::kOutOfMemory;
  }
  uint32_t slots = kSlots;
  while (slots > kLeastSlots && Shape(frame.effects, frame.scene, slots).bytes() * workers > workspace.size) {
    slots /= 2;
  }
  const Shape shape(frame.effects, frame.scene, slots);
  const int32_t rows = rows_of_task(band, frame.camera.width_px(), slots);
  std::atomic<int32_t> next{0};
  std::atomic_flag adding;
  const auto work = [&](int worker) {
    Stream stream(frame, map, shape,
                  workspace.subspan(static_cast<size_t>(worker) * shape.bytes(), shape.bytes()));
    for (int32_t first = next.fetch_add(rows); first < band.rows; first = next.fetch_add(rows)) {
      stream.draw(band, stride, first, std::min(first + rows, band.rows));
    }
    while (adding.test_and_set()) {
    }
    if (counts != nullptr) {
      lit::add_counts(stream.counts(), counts);
    }
    adding.clear();
  };
  if (workers == 1) {
    work(0);
  } else {
    threads->each(static_cast<int>(workers), work);
  }
  return Status::kOk;
}

}  // namespace

size_t lit_workspace_bytes(EffectSet effects, const LitScene& scene) {
  return most_bytes(effects, scene, kSlots);
}
size_t least_lit_workspace_bytes(EffectSet effects, const LitScene& scene) {
  return most_bytes(effects, scene, kLeastSlots);
}

Status render_lit(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                  const LitScene& scene, const Band& band, Bytes workspace, Threads* threads,
                  LitCounts* counts, const LitOptions& options) {
  effects &= Effect::kAll;
  if (effects == Effect::kNone || options.max_visits != UINT32_MAX) {
    // Without light there is nothing to stream, and only the core counts its visits.
    return render_lit_band(effects, map.tree(), camera, shading, scene, band, counts, options);
  }
  const lit::Frame frame{map.tree(), camera, shading, scene, options, effects};
  size_t stride = 0;
  const Status status = lit::check_frame(frame, band, &stride);
  if (status != Status::kOk) {
    return status;
  }
  return is_opaque(effects, scene)
             ? draw_by<OpaqueStream, OpaqueShape>(frame, map, band, stride, workspace, threads, counts)
             : draw_by<Stream, StreamShape>(frame, map, band, stride, workspace, threads, counts);
}

}  // namespace thimble::wide
