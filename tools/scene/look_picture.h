/// Paints a look (default_look.h): light on what the scene holds, the backdrop behind it, then the tone.
///
/// A pixel is a function of tree, look, camera and exposure alone, in integers; threads take rows as they
/// come. `thimble render`, films and the viewer paint with it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "output/image.h"
#include "scene/default_look.h"
#include "scene/edge_rows.h"
#include "scene/lit_streams.h"
#include "scene/painter.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// Bytes of work for each pixel of stars: sums of light.
inline constexpr std::size_t kStarBytes = 12;
/// Bytes of work for a row of the picture: `look_work_bytes(...) * rows` for so many at once.
constexpr std::size_t look_work_bytes(std::int32_t width_px, int across) {
  // A colour and a share of light behind for each sample; sums of light for each pixel of stars.
  const auto samples = static_cast<std::size_t>(across) * static_cast<std::size_t>(across);
  return static_cast<std::size_t>(width_px) * (samples < 3 ? kStarBytes : 4 * samples);
}

/// The same of a picture with samples where edges are: for `rows` rows at a time, on so many threads.
constexpr std::size_t look_edge_bytes(std::int32_t width_px, std::int32_t rows, int threads) {
  return EdgeRows::work_bytes(4, width_px, rows, threads);
}

/// What a picture of a look is painted with. What it refers to must live as long as it does.
struct LookCanvas {
  const CompactTree* tree = nullptr;
  const Look* look = nullptr;
  const Framing* framing = nullptr;  ///< of the picture
  Camera fine;                       ///< fine_camera
  Bytes work;                        ///< look_work_bytes for at least one row
  int threads = 1;
  RowRange rows{};                ///< what is painted of the picture; a count of 0: all
  LitStreams* streams = nullptr;  ///< made for the look's effects; null: the core draws
};

/// The view of a picture's samples: `look->across` times as wide and high. Where that is too large, or a camera without rays
/// between the pixels', the look gets one sample a pixel.
Camera fine_camera(const Framing& framing, Look* look);

/// A picture of a look by rows, for whoever shows it as it grows: those of `paint_look`. `camera` is
/// `canvas.fine`, or a thinned one of a look with one sample a pixel. Not for stars, which shine over rows.
class LookRows {
 public:
  LookRows(const LookCanvas& canvas, const Camera& camera, std::uint32_t exposure_q8);
  /// `rows` rows of the picture from `y` on, whose size is the camera's, a pixel for all samples, into `image`, which
  /// holds them: by `canvas.streams`, or row by row by the core. `work` holds look_work_bytes for each; `counts` are those
  /// of each thread.
  Status draw(std::int32_t y, std::int32_t rows, Bytes work, Image* image, LitCounts* counts) const;

  /// What an edge painter draws: samples with their tone and what is behind them, red, green, blue and cover,
  /// a byte each.
  Status draw_run(const SampleRun& run, Bytes samples, LitCounts* counts) const;
  /// The same of single pixels of a camera, by `canvas.streams` and its threads, or ray by ray. `colors` has three bytes
  /// for each. Without `counts` (with them there must be streams) nothing is traced twice that meets nothing.
  Status draw_places(const Camera& camera, Span<const SamplePlace> places, Bytes colors, Bytes samples,
                     LitCounts* counts) const;
  /// The pixel of such samples' sums.
  static void finish_sums(std::int32_t x, std::int32_t y, const std::uint32_t* sums, std::uint32_t count,
                          Image* image);

  /// The samples of rows of a camera, and what light is behind each (kFullShare of backdrop.h, or
  /// kNothingBehind), from `first_row` on.
  Status trace(const Camera& camera, std::int32_t first_row, std::int32_t rows, Bytes colors, Bytes shares,
               LitCounts* counts) const;

 private:
  LitView view_of(const Camera& camera) const;
  // Also the shares, if `finds_shares_`.
  Status trace_colors(const Camera& camera, std::int32_t first_row, std::int32_t rows, Bytes colors,
                      Bytes shares, LitCounts* counts) const;
  Status trace_places(const Camera& camera, Span<const SamplePlace> places, Bytes colors, Bytes shares,
                      LitCounts* counts) const;
  void find_shares(const Camera& camera, std::int32_t first_row, std::int32_t rows, Bytes shares) const;
  void finish(std::int32_t x, std::int32_t y, Bytes colors, Bytes shares, Image* image) const;
  void put_sample(const std::uint8_t* color, std::uint8_t share, Rgb8 behind, std::uint8_t* to) const;

  const LookCanvas& canvas_;
  Camera camera_;
  Shading shading_;
  LitScene scene_;
  ToneTable tone_;
  bool finds_shares_;  // with the colours
};

/// What the rays of every so manyth pixel, at most 96 x 96 of them, say of this picture.
struct LookMeasure {
  std::uint32_t exposure_q8 = 256;  ///< stars have none: 256
  std::uint64_t rays = 0;           ///< that four samples a pixel would take

  bool allows_four() const { return rays <= kMostLookRays; }
};
LookMeasure measure_look(const LookCanvas& canvas);

/// Paints the picture, or `canvas.rows` of it, in Rgb888, with `Image::alpha` where the background is none. Errors: those of the
/// core's lit renderer (lights or surfaces beyond its limits).
Status paint_look(const LookCanvas& canvas, std::uint32_t exposure_q8, const Progress& progress,
                  Painting* painting);

/// The same for points that shine (stars.cpp).
Status paint_stars(const LookCanvas& canvas, const Progress& progress, Painting* painting);

// The light behind a scene for many pixels at a time, in vectors where there are any.

/// `light_behind` of many rays, kNothingBehind where they hit; by the vectors of `streams`, unless it is null.
void find_light_behind(const CompactTree& tree, const Look& look, const LitStreams* streams,
                       Span<const Ray> rays, std::uint8_t* shares);

}  // namespace thimble::tools
