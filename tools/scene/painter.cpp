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

// Lit pictures in bands of the scene's memory. Several samples a pixel are rows of the finer camera,
// averaged. A pixel is a function of the scene alone, so threads take rows as they come.
class LitPainter {
 public:
  LitPainter(const BuiltScene& built, const Camera& camera, const Shading& shading, PixelFormat format,
             const LitPicture& picture)
      : built_(built),
        camera_(camera),
        shading_(shading),
        picture_(picture),
        width_px_(camera.width_px() / picture.across),
        row_bytes_(row_bytes(format, width_px_)),
        fine_bytes_(samples_bytes(width_px_, picture.across)) {}

  int threads() const { return picture_.streams != nullptr ? picture_.streams->threads() : picture_.threads; }
  std::int32_t most_rows() const {
    if (picture_.across != 1 || !is_straight()) {
      const std::size_t bytes =
          std::max<std::size_t>(1, row_bytes_ + (picture_.across != 1 ? fine_bytes_ : 0));
      return static_cast<std::int32_t>(built_.band().size / bytes);
    }
    const std::int32_t rows = std::max(1, kMostPixelsAtOnce / width_px_);
    return rows < kSquarePx ? rows : rows / kSquarePx * kSquarePx;
  }
  Bytes work() const { return is_straight() ? Bytes() : built_.band(); }
  Status draw(const Band& band, PaintCounts* counts) const {
    const Status status =
        picture_.across == 1 ? draw_band(band, &counts->lit) : draw_samples(band, &counts->lit);
    counts->all = totals_of(counts->lit);
    return status;
  }

 private:
  // Streams need no band of the scene's memory: a pixel is written once.
  bool is_straight() const { return picture_.streams != nullptr && picture_.across == 1; }
  Status draw_rows(const Band& band, LitCounts* counts) const {
    return render_lit_band(picture_.effects, built_.compact(), camera_, shading_, picture_.scene, band,
                           counts);
  }
  Status draw_band(const Band& band, LitCounts* counts) const {
    if (picture_.streams != nullptr) {
      return picture_.streams->render(picture_.effects, camera_, shading_, picture_.scene, band, counts);
    }
    if (picture_.threads == 1) {
      return draw_rows(band, counts);
    }
    const std::size_t line = row_bytes(band.format, camera_.width_px());
    std::vector<LitCounts> of_workers(static_cast<std::size_t>(picture_.threads));
    const Status status =
        each_until_error(band.rows, picture_.threads, [&](std::int32_t row, std::size_t worker) {
          Band part = band;
          part.first_row += row;
          part.rows = 1;
          part.pixels = band.pixels.subspan(line * static_cast<std::size_t>(row));
          return draw_rows(part, &of_workers[worker]);
        });
    for (const LitCounts& part : of_workers) {
      add_counts(part, counts);
    }
    return status;
  }
  // The band's rows stand before those of its samples.
  Status draw_samples(const Band& band, LitCounts* counts) const {
    Band fine;
    fine.first_row = band.first_row * picture_.across;
    fine.rows = band.rows * picture_.across;
    fine.format = PixelFormat::kRgb888;
    fine.pixels = band.pixels.subspan(row_bytes_ * static_cast<std::size_t>(band.rows));
    Status status = draw_band(fine, counts);
    for (std::int32_t row = 0; row < band.rows && status == Status::kOk; ++row) {
      const auto at = static_cast<std::size_t>(row);
      status = average_samples(fine.pixels.subspan(fine_bytes_ * at, fine_bytes_), picture_.across, width_px_,
                               band.first_row + row, band.format,
                               band.pixels.subspan(row_bytes_ * at, row_bytes_));
    }
    return status;
  }

  const BuiltScene& built_;
  const Camera& camera_;
  const Shading& shading_;
  LitPicture picture_;
  std::int32_t width_px_;
  std::size_t row_bytes_;
  std::size_t fine_bytes_;  // of the samples of a row
};

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

// A painter of what is kept in `state`, which draws.
template <class State>
BandPainter painter_of(const char* engine, int threads, Bytes work, const std::shared_ptr<State>& state) {
  return {engine, threads, state->most_rows(), work,
          [state](const Band& band, PaintCounts* counts) { return state->draw(band, counts); }};
}

BandPainter edge_painter(const BuiltScene& built, const Camera& camera, const Camera& fine,
                         PixelFormat format, const EdgeEngine& engine) {
  return painter_of(engine.name, engine.threads, built.band(),
                    std::make_shared<EdgePainter>(built, camera, fine, format, engine));
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
  const auto painter = std::make_shared<LitPainter>(built, camera, shading, format, picture);
  return painter_of(picture.streams != nullptr ? picture.streams->name() : "lit", painter->threads(),
                    painter->work(), painter);
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
