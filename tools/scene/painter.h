/// Ways to draw a scene's picture. `thimble render` picks one and asks it for bands, row by row from the top.
///
///   wide painter     object order, with vectors and threads (platform/wide)
///   gpu painter      a GPU (platform/gpu)
///   square painter   one or more samples a pixel in a square, by a sampler
///   edge painter     samples where edges are, by a sampler
///
///   ray sampler      the core, ray by ray, with a cut-off or a depth
///   lit sampler      light, shadows, glass, water: the core's light/render.h, or the same by streams of rays
///
/// Without a cut-off, the first two give the picture of rays.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "output/image.h"
#include "readers/source.h"
#include "scene/built_scene.h"
#include "scene/edge_rows.h"
#include "scene/lit_streams.h"
#include "scene/wide_renderer.h"
#include "thimble/light/render.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

class GpuEngine;

// What trades a picture's error for time, beside the camera: samples a pixel, a cut-off, a depth.

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

struct PaintCounts {
  RenderCounts all;   ///< rays of every kind; of a lit picture once it is painted
  wide::Counts wide;  ///< of the wide painter, else 0
  LitCounts lit;      ///< of a lit picture by kind of ray, else 0
};

/// What a picture's bands are drawn with.
struct BandPainter {
  const char* engine;  ///< what draws, as --stats names it
  int threads;
  std::int32_t most_rows;  ///< of a band
  Bytes work;  ///< where bands are drawn: in the scene's budget. Empty: straight into the picture.
  /// Draws `band`, whose pixels are the front of `work` if there is one; `counts` is added to. Errors, with
  /// nothing counted: kBadArgument for a camera that it does not take, kTooFine for one that it leaves to rays.
  std::function<Status(const Band& band, PaintCounts* counts)> draw;
};

// What a painter or a sampler is made with must live as long as it does.

/// For pictures of the size that `renderer` was made for.
BandPainter wide_painter(WideRenderer* renderer, const Camera& camera, const Shading& shading);

/// Of the scene that `engine` was made for.
BandPainter gpu_painter(GpuEngine* engine, const Camera& camera, const Shading& shading);

/// What draws samples, whichever camera has them.
struct Sampler {
  const char* name;
  int threads;  ///< that may draw at a time, each with counts of its own; those of `draw_places` where there is one
  /// Draws rows of the picture's camera or of a finer one.
  std::function<Status(const Camera& camera, bool is_fine, const Band& band, PaintCounts* counts)> draw;
  /// Draws single pixels, three bytes each, by threads of its own, as `draw` then has.
  std::function<Status(const Camera& camera, Span<const SamplePlace> places, Bytes samples,
                       PaintCounts* counts)>
      draw_places = nullptr;
};

Sampler ray_sampler(const QualityFrame& frame, const TraceOptions& options);

/// What a lit picture is made of beside tree, camera and shading.
struct LitPicture {
  LitScene scene;
  EffectSet effects = Effect::kNone;
  int threads = 1;                ///< that draw, each with a state of its own (lit_render_bytes)
  LitStreams* streams = nullptr;  ///< made for these effects; null: the core draws, and those threads with it
};
/// For compact trees. Formats with fewer than 8 bits a channel are dithered.
Sampler lit_sampler(const BuiltScene& built, const Shading& shading, const LitPicture& picture);

/// `fine` has `across` x `across` samples for each pixel. Bands are as high as `work` has room for
/// (quality_band_bytes); one sample a pixel needs no work.
BandPainter square_painter(const Sampler& sampler, const Camera& fine, int across, PixelFormat format,
                           Bytes work);

/// Samples where edges are; `fine` has kEdgeGrid times the pixels of `camera` each way.
BandPainter edge_painter(const Sampler& sampler, const Camera& camera, const Camera& fine, PixelFormat format,
                         Bytes work);

// A whole picture by a painter, band by band.

struct Painting {
  Image image;
  PaintCounts counts;
  double seconds = 0;              ///< of drawing alone
  double preparation_seconds = 0;  ///< of what its painter wanted made first; counts as building
  std::string engine;
  int threads = 1;
};

/// Draws these rows of a picture from top to bottom into `painting`, whatever it held. The painter's first
/// error ends it.
Status paint(const BandPainter& painter, std::int32_t width_px, const RowRange& rows, PixelFormat format,
             const Progress& progress, Painting* painting);

}  // namespace thimble::tools
