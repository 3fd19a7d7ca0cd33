/// The wide renderer (platform/wide) made ready for pictures of one size: its lists of voxels and its
/// workspace in an arena. A build without it (-DTHIMBLE_WIDE=OFF) has wide_absent.cpp, which makes none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"
#include "wide/raster/kernels.h"

namespace thimble::tools {

class BuiltScene;

class WideRenderer {
 public:
  static constexpr std::int32_t kLeastRows = 16;
  static constexpr std::size_t kWorkspaceAlignment = 64;

  virtual ~WideRenderer() = default;

  /// Names the instruction sets that this machine has and this build is compiled for, the best one first;
  /// empty where the build has no wide renderer. Not while anything is drawn.
  static std::vector<std::string> instruction_sets();
  /// What `make` takes of an arena for all rows, at most, and for aligning it.
  static std::size_t bytes(const CompactTree& tree, std::int32_t width_px, std::int32_t height_px,
                           int threads);

  /// Makes the lists of `tree`, which outlives the result as `arena` does, and takes a workspace: for all
  /// rows of pictures of this size, or for as many as there is room for, and for fewer threads where that is too little
  /// for kLeastRows. Null, and nothing taken, when there is room for fewer than these with one.
  static std::unique_ptr<WideRenderer> make(const CompactTree& tree, Arena* arena, std::int32_t width_px,
                                            std::int32_t height_px, int threads);

  /// Most rows in a band for `render`.
  virtual std::int32_t rows() const = 0;
  virtual int threads() const = 0;
  /// What making it took.
  virtual double seconds() const = 0;
  /// The pixels of `render_band`; Status::kTooFine for cameras that are left to it. `counts` may be null.
  virtual Status render(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                        wide::Counts* work) = 0;
};

/// What each ray of many enters first, as the core says, by vectors; `visits` are steps of this engine. Any number of
/// threads at a time. Status as `closest_hit`.
using FirstHits = std::function<Status(Span<const Ray> rays, Span<Hit> hits)>;
/// Takes the bytes of the map that it needs from the scene's arena. Empty where they do not fit, where the structure is
/// not a compact tree, and in a build without vectors: the core then traces.
FirstHits wide_first_hits(BuiltScene* built);

}  // namespace thimble::tools
