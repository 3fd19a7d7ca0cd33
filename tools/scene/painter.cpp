#include "scene/painter.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "output/units.h"
#include "scene/gpu_engine.h"
#include "scene/lit_description.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

// At the end of each call of a stream its threads, which take squares, wait for one another, and what they keep of slopes
// and lights goes. Between calls a person sees how far it is, and may end it.
constexpr std::int32_t kMostPixelsAtOnce = 1 << 18;
constexpr std::int32_t kSquarePx = 32;

void add(const PaintCounts& part, PaintCounts* counts) {
  lit::add_counts(part.lit, &counts->lit);
  counts->all.rays += part.all.rays;
  counts->all.hits += part.all.hits;
  counts->all.node_visits += part.all.node_visits;
  counts->all.step_limited += part.all.step_limited;
}

// A pixel is a function of the scene alone, so threads take rows as they come.
Status draw_rows(const Sampler& sampler, const Camera& camera, bool is_fine, const Band& band,
                 PaintCounts* counts) {
  if (sampler.threads == 1 || sampler.draw_places) {
    return sampler.draw(camera, is_fine, band, counts);
  }
  const std::size_t line = row_bytes(band.format, camera.width_px());
  std::vector<PaintCounts> of_workers(static_cast<std::size_t>(sampler.threads));
  const Status status =
      each_until_error(band.rows, sampler.threads, [&](std::int32_t row, std::size_t worker) {
        Band part = band;
        part.first_row += row;
        part.rows = 1;
        part.pixels = band.pixels.subspan(line * static_cast<std::size_t>(row));
        return sampler.draw(camera, is_fine, part, &of_workers[worker]);
      });
  for (const PaintCounts& part : of_workers) {
    add(part, counts);
  }
  return status;
}

}  // namespace

std::uint64_t quality_band_bytes(const Quality& quality, PixelFormat format, std::int32_t width_px,
                                 std::int32_t rows, int threads) {
  if (!quality.at_edges && quality.across == 1) {
    return band_bytes(format, width_px, rows);
  }
  const std::uint64_t lines = static_cast<std::uint64_t>(rows) * row_bytes(format, width_px);
  return lines + (quality.at_edges
                      ? EdgeRows::work_bytes(kSampleBytes, width_px, rows, threads)
                      : static_cast<std::uint64_t>(rows) * samples_bytes(width_px, quality.across));
}

QualityFrame::QualityFrame(const BuiltScene& built, const Quality& quality, const Camera& camera,
                           const Camera& fine, const Shading& shading, const NodeColors& colors)
    : built_(built), quality_(quality), shading_(shading), colors_(colors) {
  static_assert(Q16::saturate(kMostCutoffPx * kMaxSamplesAcross) <= kMaxCutoff);
  // Each camera's rays are measured in its own integers.
  const int level = quality.max_depth == 0 ? 0 : std::max(0, built.level() - quality.max_depth);
  fail_if(cutoff_.set(camera, quality.cutoff) != Status::kOk ||
              fine_cutoff_.set(fine, Q16::from_raw(quality.cutoff.raw * quality.across)) != Status::kOk ||
              cutoff_.set_level(level) != Status::kOk || fine_cutoff_.set_level(level) != Status::kOk,
          "internal error: the cut-off does not suit the camera");
}

Status QualityFrame::draw(const Camera& camera, bool is_fine, const Band& band, RenderCounts* counts,
                          const TraceOptions& options) const {
  return quality_.cuts() ? render_band_cut(built_.compact(), camera, shading_,
                                           is_fine ? fine_cutoff_ : cutoff_, colors_, band, counts, options)
                         : built_.render_band(camera, shading_, band, counts, options);
}

Status QualityFrame::closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const {
  if (!quality_.cuts()) {
    return built_.closest_hit(ray, hit, options);
  }
  CutHit cut;
  const Status status = closest_hit_cut(built_.compact(), ray, cutoff_, &cut, options);
  if (status == Status::kOk) {
    *hit = cut.hit;
  }
  return status;
}

NodeColors take_node_colors(BuiltScene* built, const Quality& quality, const Shading& shading) {
  NodeColors colors;
  if (!quality.cuts()) {
    return colors;
  }
  fail_if(built->structure() != StructureKind::kCompact, "--cutoff and --max-depth want --structure compact");
  const std::size_t size = node_colors_bytes(built->compact());
  if (shading.mode != ShadeMode::kColor || size == 0) {
    return colors;
  }
  const Bytes table = built->arena().take(size);
  fail_if(table.empty(), "the mean colours of ", grouped(built->compact().node_count()), " nodes need ",
          grouped(size),
          " bytes beside the scene, more than the budget has left; give it more, or another --shade");
  fail_if(NodeColors::make(built->compact(), shading.palette, shading.default_color, table, &colors) !=
              Status::kOk,
          "the tree is damaged: its counts contradict each other");
  return colors;
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

Sampler ray_sampler(const QualityFrame& frame, const TraceOptions& options) {
  return {options.width == Width::k32 ? "ray32" : "ray64", 1,
          [&frame, options](const Camera& camera, bool is_fine, const Band& band, PaintCounts* counts) {
            return frame.draw(camera, is_fine, band, &counts->all, options);
          }};
}

Sampler lit_sampler(const BuiltScene& built, const Shading& shading, const LitPicture& picture) {
  if (LitStreams* const streams = picture.streams; streams != nullptr) {
    return {streams->name(), streams->threads(),
            [=, &shading](const Camera& camera, bool /*is_fine*/, const Band& band, PaintCounts* counts) {
              return streams->render({picture.effects, camera, shading, picture.scene}, band, &counts->lit);
            },
            [=, &shading](const Camera& camera, Span<const SamplePlace> places, Bytes samples,
                          PaintCounts* counts) {
              return streams->render_pixels({picture.effects, camera, shading, picture.scene}, places,
                                            samples, &counts->lit);
            }};
  }
  return {
      "lit", picture.threads,
      [=, &built, &shading](const Camera& camera, bool /*is_fine*/, const Band& band, PaintCounts* counts) {
        return render_lit_band(picture.effects, built.compact(), camera, shading, picture.scene, band,
                               &counts->lit);
      }};
}

BandPainter square_painter(const Sampler& sampler, const Camera& fine, int across, PixelFormat format,
                           Bytes work) {
  const std::int32_t width_px = fine.width_px() / across;
  const std::size_t line = row_bytes(format, width_px);
  const std::size_t fine_lines = across == 1 ? 0 : samples_bytes(width_px, across);  // the samples of a row
  std::int32_t rows = std::max(1, kMostPixelsAtOnce / width_px);
  if (!work.empty()) {
    rows = static_cast<std::int32_t>(work.size / std::max<std::size_t>(1, line + fine_lines));
  } else if (rows >= kSquarePx) {
    rows = rows / kSquarePx * kSquarePx;
  }
  // Several samples a pixel are rows of the finer camera, averaged: the band's rows stand before those of its samples.
  return {sampler.name, sampler.threads, rows, work, [=, &fine](const Band& band, PaintCounts* counts) {
            if (across == 1) {
              return draw_rows(sampler, fine, false, band, counts);
            }
            const Bytes samples = band.pixels.subspan(line * static_cast<std::size_t>(band.rows));
            Status status = draw_rows(
                sampler, fine, true,
                {samples, PixelFormat::kRgb888, 0, band.first_row * across, band.rows * across}, counts);
            for (std::int32_t row = 0; row < band.rows && status == Status::kOk; ++row) {
              const auto at = static_cast<std::size_t>(row);
              status = average_samples(samples.subspan(fine_lines * at, fine_lines), across, width_px,
                                       band.first_row + row, format, band.pixels.subspan(line * at, line));
            }
            return status;
          }};
}

BandPainter edge_painter(const Sampler& sampler, const Camera& camera, const Camera& fine, PixelFormat format,
                         Bytes work) {
  struct Drawn {
    Sampler sampler;
    std::vector<PaintCounts> counts;  // of each worker
    Band band;
    std::optional<EdgeRows> edges;
  };
  const auto drawn = std::make_shared<Drawn>();
  drawn->sampler = sampler;
  drawn->counts.resize(static_cast<std::size_t>(sampler.threads));
  const std::size_t line = row_bytes(format, camera.width_px());
  EdgeRowsHooks hooks;
  hooks.draw = [now = drawn.get()](const SampleRun& run, Bytes samples, std::size_t worker) {
    return now->sampler.draw(run.camera, run.is_fine, {samples, PixelFormat::kRgb888, 0, run.row, 1},
                             &now->counts[worker]);
  };
  hooks.finish = [now = drawn.get(), line, format](std::int32_t px, std::int32_t py,
                                                   const std::uint32_t* sums, std::uint32_t count) {
    store_pixel(
        now->band.pixels.data + line * static_cast<std::size_t>(py - now->band.first_row), px, py, format,
        {mean_of_samples(sums[0], count), mean_of_samples(sums[1], count), mean_of_samples(sums[2], count)});
  };
  if (sampler.draw_places) {
    hooks.draw_places = [now = drawn.get()](const Camera& view, Span<const SamplePlace> places,
                                            Bytes samples) {
      return now->sampler.draw_places(view, places, samples, &now->counts[0]);
    };
  }
  drawn->edges.emplace(camera, fine, kSampleBytes, sampler.threads, hooks);
  const std::int32_t most_rows =
      EdgeRows::rows_within(work.size, kSampleBytes, camera.width_px(), sampler.threads, line);
  return {sampler.name, sampler.threads, most_rows, work,
          [drawn, line, most_rows](const Band& band, PaintCounts* counts) {
            drawn->band = band;
            std::fill_n(band.pixels.data, line * static_cast<std::size_t>(band.rows), std::uint8_t{0});
            const Status status = drawn->edges->draw(
                band.first_row, band.rows, band.pixels.subspan(line * static_cast<std::size_t>(most_rows)));
            for (PaintCounts& part : drawn->counts) {
              add(part, counts);
              part = {};
            }
            return status;
          }};
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
    tell(progress, static_cast<double>(y) / rows.count);
  }
  if (const RenderCounts lit = totals_of(painting->counts.lit); lit.rays != 0) {
    painting->counts.all = lit;
  }
  return Status::kOk;
}

}  // namespace thimble::tools
