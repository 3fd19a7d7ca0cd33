/// What trades a picture's error for time, beside the camera: samples a pixel, a cut-off, a depth.
#pragma once

#include <cstdint>

#include "scene/built_scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

inline constexpr int kMostCutoffPx = 64;

struct Quality {
  int across = 1;           ///< samples a pixel are its square; kEdgeGrid for samples where edges are
  bool at_edges = false;    ///< samples where edges are (edge_rows.h) instead of the square in each pixel
  bool is_sampled = false;  ///< whether somebody chose that
  Q16 cutoff;               ///< in pixels, up to kMostCutoffPx; 0: none
  int max_depth = 0;        ///< nodes that deep are solid through; 0: all levels

  int samples() const { return across * across; }
  /// Whether nodes are cut at all.
  bool cuts() const { return cutoff.raw != 0 || max_depth != 0; }
  bool plain() const { return across == 1 && !cuts(); }
  /// What tells the samples apart from others: parts of pictures are put together by it.
  int samples_key() const { return at_edges ? 0 : across; }
};

/// Bytes a sample of those that are added up.
inline constexpr int kSampleBytes = 3;

/// Bytes in which a square painter or, with samples at edges, an edge painter draws `rows` rows of pictures of `width_px` at
/// a time.
std::uint64_t quality_band_bytes(const Quality& quality, PixelFormat format, std::int32_t width_px,
                                 std::int32_t rows = 1, int threads = 1);

/// Draws pictures of a scene with a quality. The scene, and a colour table where one is needed, stay the
/// caller's.
class QualityFrame {
 public:
  /// `camera` is that of the picture, `fine` the same view `quality.across` times as wide and high.
  QualityFrame(const BuiltScene& built, const Quality& quality, const Camera& camera, const Camera& fine,
               const Shading& shading, const NodeColors& colors);

  /// Draws rows of a part of the picture's camera, or of the finer one, cut off as that is; `counts` is added to.
  Status draw(const Camera& camera, bool is_fine, const Band& band, RenderCounts* counts,
              const TraceOptions& options) const;
  /// What a ray of the picture's camera meets with this quality's cut-off.
  Status closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const;

 private:
  const BuiltScene& built_;
  Quality quality_;
  Shading shading_;
  NodeColors colors_;
  Cutoff fine_cutoff_;
  Cutoff cutoff_;
};

/// The mean colours that `quality` and `shading` call for, in the arena of `built`; none where none are
/// needed. Throws InputError when they do not fit the budget, or when the scene is no compact tree.
NodeColors take_node_colors(BuiltScene* built, const Quality& quality, const Shading& shading);

}  // namespace thimble::tools
