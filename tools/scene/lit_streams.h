/// Lit pictures by streams of rays (platform/wide/lit) made ready for one scene: the map of its tree and a workspace in
/// an arena. A build without it (-DTHIMBLE_WIDE=OFF) has wide_absent.cpp, which makes none.
#pragma once

#include <cstddef>
#include <memory>

#include "scene/backdrop.h"
#include "scene/edge_rows.h"
#include "thimble/base/memory.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// What light is drawn of. Effects and lights are at most those of `LitStreams::make`.
struct LitView {
  EffectSet effects;
  const Camera& camera;
  const Shading& shading;
  const LitScene& scene;
  const Ground* ground = nullptr;  ///< behind it, for `shares`
};

/// Draws one band at a time, and traces rays through the same map.
class LitStreams {
 public:
  virtual ~LitStreams() = default;

  /// Makes the map of `tree`, which outlives the result as `arena` does, and takes a workspace for pictures with
  /// these effects: for `threads`, or as many as there is room for. Null, and nothing taken, when there is room for
  /// none, when the tree is damaged, and without effects.
  static std::unique_ptr<LitStreams> make(const CompactTree& tree, Arena* arena, EffectSet effects,
                                          const LitScene& scene, int threads);

  /// What `make` takes at most.
  static std::size_t bytes(const CompactTree& tree, EffectSet effects, const LitScene& scene, int threads);

  /// The engine, as --stats names it.
  virtual const char* name() const { return "lit"; }
  /// Threads that draw.
  virtual int threads() const = 0;
  /// What making it took.
  virtual double seconds() const = 0;
  /// Whether `ground` means anything to it.
  virtual bool finds_shares() const { return false; }
  /// The pixels of `render_lit_band`, and its errors. `counts` (may be null) is added to. With a ground, in kRgb888,
  /// `shares` gets what `light_behind` (scene/backdrop.h) finds at each pixel.
  virtual Status render(const LitView& view, const Band& band, LitCounts* counts, Bytes shares = {}) = 0;
  /// The same of single pixels, three bytes each. Where it `finds_shares` nothing is counted.
  virtual Status render_pixels(const LitView& view, Span<const SamplePlace> places, Bytes rgb,
                               LitCounts* counts, Bytes shares = {}) = 0;
  // What an engine does not do is a kBadArgument, and then the core's.

  /// Whether each ray meets anything, 1 or 0, as the core's `any_hit`. This and the next: any number of threads at a
  /// time, each with rays of its own. An error of a ray is the call's; the others are answered.
  virtual Status any_hit(Span<const Ray> /*rays*/, Span<std::uint8_t> /*hits*/) const {
    return Status::kBadArgument;
  }
  /// Where each ray enters something solid, if before the point `before`: t as in the core's `Hit`; denominator 0 for
  /// a miss.
  virtual Status first_entry_before(Span<const Ray> /*rays*/, RayPoint /*before*/,
                                    Span<RayPoint> /*entries*/) const {
    return Status::kBadArgument;
  }
};

}  // namespace thimble::tools
