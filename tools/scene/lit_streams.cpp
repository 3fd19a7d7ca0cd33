#include "scene/lit_streams.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "wide/lit/lit_renderer.h"
#include "wide/rays/ray_map.h"
#include "wide/threads.h"

namespace thimble::tools {
namespace {

class WideLitStreams final : public LitStreams {
 public:
  WideLitStreams(const wide::RayMap& map, Bytes workspace, int threads, double seconds)
      : map_(map), workspace_(workspace), threads_(threads), seconds_(seconds) {}

  int threads() const override { return threads_.count(); }
  double seconds() const override { return seconds_; }
  Status render(const LitView& view, const Band& band, LitCounts* counts, Bytes /*shares*/) override {
    return wide::render_lit(view.effects, map_, view.camera, view.shading, view.scene, band, workspace_,
                            &threads_, counts);
  }
  Status render_pixels(const LitView& view, Span<const SamplePlace> places, Bytes rgb, LitCounts* counts,
                       Bytes /*shares*/) override {
    places_.resize(places.size);
    std::transform(places.data, places.data + places.size, places_.begin(), [](const SamplePlace& place) {
      return wide::PixelPlace{place.x, place.y};
    });
    return wide::render_lit_pixels(view.effects, map_, view.camera, view.shading, view.scene,
                                   {places_.data(), places_.size()}, rgb, workspace_, &threads_, counts);
  }
  Status any_hit(Span<const Ray> rays, Span<std::uint8_t> hits) const override {
    return wide::any_hit(map_, rays, hits);
  }
  Status first_entry_before(Span<const Ray> rays, RayPoint before, Span<RayPoint> entries) const override {
    return wide::first_entry_before(map_, rays, before, entries);
  }

 private:
  wide::RayMap map_;
  Bytes workspace_;
  wide::Threads threads_;
  double seconds_;
  std::vector<wide::PixelPlace> places_;
};

}  // namespace

std::size_t LitStreams::bytes(const CompactTree& tree, EffectSet effects, const LitScene& scene,
                              int threads) {
  return wide::RayMap::bytes(tree) +
         wide::lit_workspace_bytes(effects, scene) * static_cast<std::size_t>(threads);
}

std::unique_ptr<LitStreams> LitStreams::make(const CompactTree& tree, Arena* arena, EffectSet effects,
                                             const LitScene& scene, int threads) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t least = wide::least_lit_workspace_bytes(effects, scene);
  // Asked before the map is made: what does not fit costs no time.
  const std::size_t map_bytes = wide::RayMap::bytes(tree);
  if (effects == Effect::kNone || map_bytes > arena->free_bytes() ||
      arena->free_bytes() - map_bytes < least) {
    return nullptr;
  }
  const std::size_t mark = arena->used_bytes();
  wide::RayMap map;
  if (wide::RayMap::make(tree, arena, &map) != Status::kOk) {
    return nullptr;
  }
  const std::size_t wanted = wide::lit_workspace_bytes(effects, scene) * static_cast<std::size_t>(threads);
  const Bytes workspace = arena->take(std::min(wanted, arena->free_bytes()), 1);
  if (workspace.size < least) {
    arena->rewind(mark);
    return nullptr;
  }
  const auto most_threads =
      static_cast<int>(std::min<std::size_t>(workspace.size / least, wide::kMaxThreads));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return std::make_unique<WideLitStreams>(map, workspace, std::min(threads, most_threads), seconds);
}

}  // namespace thimble::tools
