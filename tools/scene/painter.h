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
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "output/image.h"
#include "readers/source.h"
#include "scene/built_scene.h"
#include "scene/edge_rows.h"
#include "scene/lit_streams.h"
#include "scene/sampling.h"
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

/// What a picture's bands are drawn with.
struct BandPainter {
  const char* engine;  ///< what draws, as --stats names it
  int threads;
  std::int32_t most_rows;  ///< of a band
  Bytes work;  ///< where bands are drawn: in the scene's budget. Empty: straight into the picture.
  /// Draws `band`, whose pixels are the front of `work` if there is one; `counts` is added to. Errors, with
  /// nothing counted: kBadArgument for a camera that it does not take, kTooFine for one that it leaves to the
  /// ray painter.
  std::function<Status(const Band& band, PaintCounts* counts)> draw;
};

// What a painter is made with must live as long as it does.

/// Bands as high as the scene's own has room for.
BandPainter ray_painter(const BuiltScene& built, const Camera& camera, const Shading& shading,
                        PixelFormat format, const TraceOptions& options);

/// A row at a time.
BandPainter quality_painter(const BuiltScene& built, const QualityFrame& frame, const TraceOptions& options);

/// The same with samples where edges are.
BandPainter ray_edge_painter(const BuiltScene& built, const QualityFrame& frame, const Camera& camera,
                             const Camera& fine, PixelFormat format, const TraceOptions& options);

/// For pictures of the size that `renderer` was made for.
BandPainter wide_painter(WideRenderer* renderer, const Camera& camera, const Shading& shading);

/// Of the scene that `engine` was made for.
BandPainter gpu_painter(GpuEngine* engine, const Camera& camera, const Shading& shading);

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

/// Bytes of a band in which an edge painter draws `rows` rows at a time.
std::uint64_t edge_band_bytes(PixelFormat format, std::int32_t width_px, std::int32_t rows, int threads);

/// As lit_painter, with samples where edges are; `picture.across` is not looked at.
BandPainter lit_edge_painter(const BuiltScene& built, const Camera& camera, const Camera& fine,
                             const Shading& shading, PixelFormat format, const LitPicture& picture);

/// For compact trees. Formats with fewer than 8 bits a channel are dithered.
BandPainter lit_painter(const BuiltScene& built, const Camera& camera, const Shading& shading,
                        PixelFormat format, const LitPicture& picture);

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
