/// @file painter.h
/// Ways to draw a scene's picture. `thimble render` picks one and asks it for bands, row by row from the top.
///
///   ray painter      the core, ray by ray
///   quality painter  the same with several samples a pixel, a cut-off or a depth
///   edge painter     samples where edges are, of rays or of light
///   wide painter     object order, with vectors and threads (platform/wide)
///   gpu painter      a GPU (platform/gpu)
///   lit painter      light, shadows, glass, water: the core's light/render.h, or the same by streams of rays
///
/// The first three give the same picture where their options are the same.
#ifndef THIMBLE_TOOLS_SCENE_PAINTER_H
#define THIMBLE_TOOLS_SCENE_PAINTER_H

#include <cstdint>
#include <functional>
#include <memory>

#include "scene/built_scene.h"
#include "scene/edge_rows.h"
#include "scene/lit_streams.h"
#include "scene/quality.h"
#include "scene/wide_renderer.h"
#include "thimble/light/render.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

class GpuEngine;

struct PaintCounts {
  RenderCounts all;   ///< rays of every kind
  wide::Counts wide;  ///< of the wide painter, else 0
  LitCounts lit;      ///< of the lit painter by kind of ray, else 0
};

class BandPainter {
 public:
  virtual ~BandPainter() = default;
  /// What draws, as --stats names it.
  virtual const char* engine() const = 0;
  virtual int threads() const { return 1; }
  /// Most rows of a band.
  virtual std::int32_t most_rows() const = 0;
  /// Where bands are drawn: in the scene's budget. Empty: straight into the picture.
  virtual Bytes work() const = 0;
  /// Draws `band`, whose pixels are the front of `work()` if there is one; `counts` is added to. Errors, with
  /// nothing counted: kBadArgument for a camera that it does not take, kTooFine for one that it leaves to the
  /// ray painter.
  virtual Status draw(const Band& band, PaintCounts* counts) = 0;
};

// What a painter is made with must live as long as it does.

/// Bands as high as the scene's own has room for.
std::unique_ptr<BandPainter> make_ray_painter(const BuiltScene& built, const Camera& camera,
                                              const Shading& shading, PixelFormat format,
                                              const TraceOptions& options);

/// A row at a time.
std::unique_ptr<BandPainter> make_quality_painter(const BuiltScene& built, const QualityFrame& frame,
                                                  const TraceOptions& options);

/// The same with samples where edges are.
std::unique_ptr<BandPainter> make_ray_edge_painter(const BuiltScene& built, const QualityFrame& frame,
                                                   const Camera& camera, const Camera& fine,
                                                   PixelFormat format, const TraceOptions& options);

/// For pictures of the size that `renderer` was made for.
std::unique_ptr<BandPainter> make_wide_painter(WideRenderer* renderer, const Camera& camera,
                                               const Shading& shading);

/// Of the scene that `engine` was made for.
std::unique_ptr<BandPainter> make_gpu_painter(GpuEngine* engine, const Camera& camera,
                                              const Shading& shading);

/// What a lit picture is made of beside tree, camera and shading.
struct LitPicture {
  LitScene scene;
  EffectSet effects = Effect::kNone;
  /// Samples a pixel are its square; the band then has room for them (quality_band_bytes), and the camera is
  /// that of a picture so many times as wide and high.
  int across = 1;
  int threads = 1;  ///< that draw rows of a band, each with a state of its own (lit_render_bytes)
  LitStreams* streams = nullptr;  ///< made for these effects; null: the core draws, and those threads with it
};

/// Who draws the samples of an edge painter.
struct EdgeEngine {
  const char* name;
  int threads;
  bool is_lit;  ///< whether it counts by kind of ray
  /// A row of a camera in kRgb888; called by so many threads at a time, each with counts of its own.
  std::function<Status(const SampleRun& run, Bytes samples, PaintCounts* counts)> draw;
  /// In place of `draw`, where it is set: single pixels, by threads of its own.
  std::function<Status(const Camera& camera, Span<const SamplePlace> places, Bytes samples,
                       PaintCounts* counts)>
      draw_places = nullptr;
};
/// Of such pictures, for `fine` with kEdgeGrid times the pixels of `camera` each way.
std::unique_ptr<BandPainter> make_edge_painter(const BuiltScene& built, const Camera& camera,
                                               const Camera& fine, PixelFormat format, EdgeEngine engine);
/// Bytes of a band in which it draws `rows` rows at a time.
std::uint64_t edge_band_bytes(PixelFormat format, std::int32_t width_px, std::int32_t rows, int threads);

/// As make_lit_painter, with samples where edges are; `picture.across` is not looked at.
std::unique_ptr<BandPainter> make_lit_edge_painter(const BuiltScene& built, const Camera& camera,
                                                   const Camera& fine, const Shading& shading,
                                                   PixelFormat format, const LitPicture& picture);

/// For compact trees. Formats with fewer than 8 bits a channel are dithered.
std::unique_ptr<BandPainter> make_lit_painter(const BuiltScene& built, const Camera& camera,
                                              const Shading& shading, PixelFormat format,
                                              const LitPicture& picture);

}  // namespace thimble::tools

#endif
