#include "scene/painter.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

#include "scene/gpu_engine.h"
#include "scene/lit_description.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

const char* ray_engine(const TraceOptions& options) {
  return options.width == Width::k32 ? "ray32" : "ray64";
}

// At the end of each call of a stream its threads, which take squares, wait for one another, and what they keep of slopes
// and lights goes. Between calls a person sees how far it is, and may end it.
constexpr std::int32_t kMostPixelsAtOnce = 1 << 18;
constexpr std::int32_t kSquarePx = 32;

// Rows of a lit picture. A pixel is a function of the scene alone, so threads take rows as they come.
Status draw_lit(const BuiltScene& built, const Camera& camera, const Shading& shading,
                const LitPicture& picture, const Band& band, LitCounts* counts) {
  if (picture.streams != nullptr) {
    return picture.streams->render(picture.effects, camera, shading, picture.scene, band, counts);
  }
  const auto draw = [&](const Band& part, LitCounts* of_part) {
    return render_lit_band(picture.effects, built.compact(), camera, shading, picture.scene, part, of_part);
  };
  if (picture.threads == 1) {
    return draw(band, counts);
  }
  const std::size_t line = row_bytes(band.format, camera.width_px());
  std::vector<LitCounts> of_workers(static_cast<std::size_t>(picture.threads));
  const Status status =
      each_until_error(band.rows, picture.threads, [&](std::int32_t row, std::size_t worker) {
        Band part = band;
        part.first_row += row;
        part.rows = 1;
        part.pixels = band.pixels.subspan(line * static_cast<std::size_t>(row));
        return draw(part, &of_workers[worker]);
      });
  for (const LitCounts& part : of_workers) {
    add_counts(part, counts);
  }
  return status;
}

constexpr int kChannels = 3;

// Who draws the samples of an edge painter.
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

// Samples where edges are, by whatever draws the samples: rays or light.
class EdgePainter {
 public:
  EdgePainter(const BuiltScene& built, const Camera& camera, const Camera& fine, PixelFormat format,
              EdgeEngine engine)
      : engine_(std::move(engine)),
        format_(format),
        row_bytes_(row_bytes(format, camera.width_px())),
        rows_(EdgeRows::rows_within(built.band().size, kChannels, camera.width_px(), engine_.threads,
                                    row_bytes_)),
        counts_(static_cast<std::size_t>(engine_.threads)),
        edges_(camera, fine, kChannels, engine_.threads,
               {[this](const SampleRun& run, Bytes samples, std::size_t worker) {
                  return engine_.draw(run, samples, &counts_[worker]);
                },
                [this](std::int32_t px, std::int32_t py, const std::uint32_t* sums, std::uint32_t count) {
                  store(px, py, sums, count);
                },
                places_hook()}) {}

  std::int32_t most_rows() const { return rows_; }
  Status draw(const Band& band, PaintCounts* counts) {
    pixels_ = band.pixels;
    first_row_ = band.first_row;
    const std::size_t front = row_bytes_ * static_cast<std::size_t>(rows_);
    std::fill_n(pixels_.begin(), row_bytes_ * static_cast<std::size_t>(band.rows), std::uint8_t{0});
    const Status status = edges_.draw(band.first_row, band.rows, band.pixels.subspan(front));
    for (PaintCounts& part : counts_) {
      add_counts(part.lit, &counts->lit);
      counts->all.rays += part.all.rays;
      counts->all.hits += part.all.hits;
      counts->all.node_visits += part.all.node_visits;
      counts->all.step_limited += part.all.step_limited;
      part = {};
    }
    if (engine_.is_lit) {
      counts->all = totals_of(counts->lit);
    }
    return status;
  }

 private:
  DrawPlaces places_hook() {
    if (!engine_.draw_places) {
      return nullptr;
    }
    return [this](const Camera& camera, Span<const SamplePlace> places, Bytes samples) {
      return engine_.draw_places(camera, places, samples, &counts_[0]);
    };
  }
  void store(std::int32_t px, std::int32_t py, const std::uint32_t* sums, std::uint32_t count) const {
    std::uint8_t* const row = pixels_.data + row_bytes_ * static_cast<std::size_t>(py - first_row_);
    store_pixel(
        row, px, py, format_,
        {mean_of_samples(sums[0], count), mean_of_samples(sums[1], count), mean_of_samples(sums[2], count)});
  }

  EdgeEngine engine_;
  PixelFormat format_;
  std::size_t row_bytes_;
  std::int32_t rows_;
  Bytes pixels_;
  std::int32_t first_row_ = 0;
  std::vector<PaintCounts> counts_;  // of each worker
  EdgeRows edges_;
};

BandPainter edge_painter(const BuiltScene& built, const Camera& camera, const Camera& fine,
                         PixelFormat format, const EdgeEngine& engine) {
  const auto painter = std::make_shared<EdgePainter>(built, camera, fine, format, engine);
  return {engine.name, engine.threads, painter->most_rows(), built.band(),
          [painter](const Band& band, PaintCounts* counts) { return painter->draw(band, counts); }};
}

}  // namespace

std::uint64_t edge_band_bytes(PixelFormat format, std::int32_t width_px, std::int32_t rows, int threads) {
  return EdgeRows::work_bytes(kChannels, width_px, rows, threads) +
         static_cast<std::uint64_t>(rows) * row_bytes(format, width_px);
}

BandPainter ray_painter(const BuiltScene& built, const Camera& camera, const Shading& shading,
                        PixelFormat format, const TraceOptions& options) {
  // At least a byte a row: a picture is at least a pixel wide.
  const std::size_t row = std::max<std::size_t>(1, row_bytes(format, camera.width_px()));
  return {ray_engine(options), 1, static_cast<std::int32_t>(built.band().size / row), built.band(),
          [&built, &camera, &shading, options](const Band& band, PaintCounts* counts) {
            return built.render_band(camera, shading, band, &counts->all, options);
          }};
}

BandPainter quality_painter(const BuiltScene& built, const QualityFrame& frame, const TraceOptions& options) {
  return {ray_engine(options), 1, 1, built.band(), [&frame, options](const Band& band, PaintCounts* counts) {
            return frame.draw_row(band.first_row, band.format, band.pixels, &counts->all, options);
          }};
}

BandPainter ray_edge_painter(const BuiltScene& built, const QualityFrame& frame, const Camera& camera,
                             const Camera& fine, PixelFormat format, const TraceOptions& options) {
  const auto draw = [&frame, options](const SampleRun& run, Bytes samples, PaintCounts* counts) {
    return frame.draw_run(run, samples, &counts->all, options);
  };
  return edge_painter(built, camera, fine, format, {ray_engine(options), 1, false, draw});
}

BandPainter wide_painter(WideRenderer* renderer, const Camera& camera, const Shading& shading) {
  return {"wide",
          renderer->threads(),
          renderer->rows(),
          {},
          [renderer, &camera, &shading](const Band& band, PaintCounts* counts) {
            return renderer->render(camera, shading, band, &counts->all, &counts->wide);
          }};
}

BandPainter gpu_painter(GpuEngine* engine, const Camera& camera, const Shading& shading) {
  return {"gpu",
          1,
          engine->most_rows(camera.width_px()),
          {},
          [engine, &camera, &shading](const Band& band, PaintCounts* counts) {
            return engine->draw(camera, shading, band, &counts->all);
          }};
}

BandPainter lit_painter(const BuiltScene& built, const Camera& camera, const Shading& shading,
                        PixelFormat format, const LitPicture& picture) {
  const int across = picture.across;
  const std::int32_t width_px = camera.width_px() / across;
  const std::size_t line = row_bytes(format, width_px);
  const std::size_t fine_lines = across == 1 ? 0 : samples_bytes(width_px, across);  // the samples of a row
  // Several samples a pixel are rows of the finer camera, averaged: the band's rows stand before those of its samples.
  const auto draw = [=, &built, &camera, &shading](const Band& band, PaintCounts* counts) {
    Band fine = band;
    if (across != 1) {
      fine.first_row *= across;
      fine.rows *= across;
      fine.format = PixelFormat::kRgb888;
      fine.pixels = band.pixels.subspan(line * static_cast<std::size_t>(band.rows));
    }
    Status status = draw_lit(built, camera, shading, picture, fine, &counts->lit);
    for (std::int32_t row = 0; across != 1 && row < band.rows && status == Status::kOk; ++row) {
      const auto at = static_cast<std::size_t>(row);
      status = average_samples(fine.pixels.subspan(fine_lines * at, fine_lines), across, width_px,
                               band.first_row + row, band.format, band.pixels.subspan(line * at, line));
    }
    counts->all = totals_of(counts->lit);
    return status;
  };
  if (picture.streams == nullptr || across != 1) {
    const std::size_t bytes = std::max<std::size_t>(1, line + fine_lines);
    return {picture.streams == nullptr ? "lit" : picture.streams->name(),
            picture.streams == nullptr ? picture.threads : picture.streams->threads(),
            static_cast<std::int32_t>(built.band().size / bytes), built.band(), draw};
  }
  // Streams need no band of the scene's memory: a pixel is written once.
  const std::int32_t rows = std::max(1, kMostPixelsAtOnce / width_px);
  return {picture.streams->name(),
          picture.streams->threads(),
          rows < kSquarePx ? rows : rows / kSquarePx * kSquarePx,
          {},
          draw};
}

BandPainter lit_edge_painter(const BuiltScene& built, const Camera& camera, const Camera& fine,
                             const Shading& shading, PixelFormat format, const LitPicture& picture) {
  const auto draw = [&built, shading, picture](const SampleRun& run, Bytes samples, PaintCounts* counts) {
    return render_lit_band(picture.effects, built.compact(), run.camera, shading, picture.scene,
                           {samples, PixelFormat::kRgb888, 0, run.row, 1}, &counts->lit);
  };
  EdgeEngine engine{"lit", picture.threads, true, draw};
  if (picture.streams != nullptr) {
    engine.threads = picture.streams->threads();
    engine.draw_places = [shading, picture](const Camera& view, Span<const SamplePlace> places, Bytes samples,
                                            PaintCounts* counts) {
      return picture.streams->render_pixels(picture.effects, view, shading, picture.scene, places, nullptr,
                                            samples, {}, &counts->lit);
    };
  }
  return edge_painter(built, camera, fine, format, engine);
}

Status paint(const BandPainter& painter, std::int32_t width_px, const RowRange& rows, PixelFormat format,
             const Progress& progress, Painting* painting) {
  *painting = {};
  painting->image = {width_px, rows.count,
                     format,   std::vector<std::uint8_t>(band_bytes(format, width_px, rows.count)),
                     {},       rows.first};
  painting->engine = painter.engine;
  painting->threads = painter.threads;
  const std::size_t line = row_bytes(format, width_px);
  const Bytes pixels(painting->image.pixels.data(), painting->image.pixels.size());
  for (std::int32_t y = 0; y < rows.count; y += painter.most_rows) {
    Band band;
    band.format = format;
    band.first_row = rows.first + y;
    band.rows = std::min(painter.most_rows, rows.count - y);
    const Bytes target =
        pixels.subspan(line * static_cast<std::size_t>(y), line * static_cast<std::size_t>(band.rows));
    band.pixels = painter.work.empty() ? target : painter.work;
    const auto start = std::chrono::steady_clock::now();
    const Status status = painter.draw(band, &painting->counts);
    painting->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (status != Status::kOk) {
      return status;
    }
    if (!painter.work.empty()) {
      std::memcpy(target.data, painter.work.data, target.size);
    }
    if (progress) {
      progress(static_cast<double>(y) / rows.count);
    }
  }
  return Status::kOk;
}

}  // namespace thimble::tools
