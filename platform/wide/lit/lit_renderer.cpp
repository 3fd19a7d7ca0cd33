#include "wide/lit/lit_renderer.h"

#include <algorithm>
#include <atomic>

#include "wide/lit/pixel_queue.h"
#include "wide/lit/stream.h"

namespace thimble::wide {
namespace {

// So many rays keep vectors full most of the time, and fit a second-level cache.
constexpr uint32_t kSlots = 1024;
constexpr uint32_t kLeastSlots = 64;

Status draw(const lit::Frame& frame, const RayMap& map, PixelQueue queue, Bytes workspace, Threads* threads,
            LitCounts* counts) {
  // As many threads as there is room for; then as many pixels at once as there is room for.
  size_t workers = threads == nullptr ? 1 : static_cast<size_t>(threads->count());
  workers = std::min(workers, workspace.size / least_lit_workspace_bytes(frame.effects, frame.scene));
  if (workers == 0) {
    return Status::kOutOfMemory;
  }
  uint32_t slots = kSlots;
  while (slots > kLeastSlots &&
         StreamShape(frame.effects, frame.scene, slots).bytes() * workers > workspace.size) {
    slots /= 2;
  }
  const StreamShape shape(frame.effects, frame.scene, slots);
  queue.clear();
  std::atomic_flag adding;
  const auto work = [&](int worker) {
    Stream stream(frame, map, shape,
                  workspace.subspan(static_cast<size_t>(worker) * shape.bytes(), shape.bytes()));
    stream.draw(&queue);
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

LitMedia lit_media(EffectSet effects, const LitScene& scene) {
  LitMedia media;
  for (size_t material = 0; material < std::min<size_t>(scene.surfaces.size, 256); ++material) {
    const SurfaceKind kind = scene.surfaces[material].kind;
    if ((kind == SurfaceKind::kGlass && (effects & Effect::kGlass) != 0) ||
        (kind == SurfaceKind::kMedia && (effects & Effect::kMedia) != 0)) {
      media.materials[media.count++] = static_cast<uint8_t>(material);
    }
  }
  return media;
}

size_t lit_workspace_bytes(EffectSet effects, const LitScene& scene) {
  return StreamShape(effects, scene, kSlots).bytes();
}
size_t least_lit_workspace_bytes(EffectSet effects, const LitScene& scene) {
  return StreamShape(effects, scene, kLeastSlots).bytes();
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
  return draw(frame, map, PixelQueue(frame, band, stride), workspace, threads, counts);
}

Status render_lit_pixels(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                         const LitScene& scene, Span<const PixelPlace> places, Bytes rgb, Bytes workspace,
                         Threads* threads, LitCounts* counts, const LitOptions& options) {
  effects &= Effect::kAll;
  if (rgb.size / 3 < places.size) {
    return Status::kOutOfMemory;
  }
  if (effects == Effect::kNone || options.max_visits != UINT32_MAX) {
    for (size_t i = 0; i < places.size; ++i) {
      const Status status = render_lit_band(
          effects, map.tree(), camera.window(places.data[i].x, places.data[i].y, 1, 1), shading, scene,
          {rgb.subspan(3 * i, 3), PixelFormat::kRgb888, 0, 0, 1}, counts, options);
      if (status != Status::kOk) {
        return status;
      }
    }
    return Status::kOk;
  }
  const lit::Frame frame{map.tree(), camera, shading, scene, options, effects};
  size_t stride = 0;
  const Status status = lit::check_frame(frame, {{}, PixelFormat::kRgb888, 0, 0, 0}, &stride);
  if (status != Status::kOk) {
    return status;
  }
  return draw(frame, map, PixelQueue(frame, places, rgb), workspace, threads, counts);
}

}  // namespace thimble::wide
