#include "scene/sampling.h"

#include <algorithm>

#include "output/units.h"
#include "readers/source.h"
#include "scene/painter.h"

namespace thimble::tools {

std::uint64_t quality_band_bytes(const Quality& quality, PixelFormat format, std::int32_t width_px) {
  if (quality.at_edges) {
    return edge_band_bytes(format, width_px, 1, 1);
  }
  const std::uint64_t row = row_bytes(format, width_px);
  return quality.across == 1 ? row : row + samples_bytes(width_px, quality.across);
}

QualityFrame::QualityFrame(const BuiltScene& built, const Quality& quality, const Camera& camera,
                           const Camera& fine, const Shading& shading, const NodeColors& colors)
    : built_(built), quality_(quality), fine_(fine), shading_(shading), colors_(colors) {
  static_assert(Q16::saturate(kMostCutoffPx * kMaxSamplesAcross) <= kMaxCutoff);
  // Each camera's rays are measured in its own integers.
  const int level = quality.max_depth == 0 ? 0 : std::max(0, built.level() - quality.max_depth);
  if (cutoff_.set(camera, quality.cutoff) != Status::kOk ||
      fine_cutoff_.set(fine, Q16::from_raw(quality.cutoff.raw * quality.across)) != Status::kOk ||
      cutoff_.set_level(level) != Status::kOk || fine_cutoff_.set_level(level) != Status::kOk) {
    throw InputError("internal error: the cut-off does not suit the camera");
  }
}

Status QualityFrame::draw_row(std::int32_t y, PixelFormat format, Bytes work, RenderCounts* counts,
                              const TraceOptions& options) const {
  const std::int32_t width_px = fine_.width_px() / quality_.across;
  const std::size_t row = row_bytes(format, width_px);
  Band band;
  band.first_row = y * quality_.across;
  band.rows = quality_.across;
  band.format = quality_.across == 1 ? format : PixelFormat::kRgb888;
  band.pixels = quality_.across == 1 ? work : work.subspan(row);
  const Status status = draw_band(fine_, fine_cutoff_, band, counts, options);
  if (status != Status::kOk || quality_.across == 1) {
    return status;
  }
  return average_samples(band.pixels, quality_.across, width_px, y, format, work.subspan(0, row));
}

Status QualityFrame::draw_run(const SampleRun& run, Bytes samples, RenderCounts* counts,
                              const TraceOptions& options) const {
  return draw_band(run.camera, run.is_fine ? fine_cutoff_ : cutoff_,
                   {samples, PixelFormat::kRgb888, 0, run.row, 1}, counts, options);
}

Status QualityFrame::draw_band(const Camera& camera, const Cutoff& cutoff, const Band& band,
                               RenderCounts* counts, const TraceOptions& options) const {
  return quality_.cuts()
             ? render_band_cut(built_.compact(), camera, shading_, cutoff, colors_, band, counts, options)
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
  if (built->structure() != StructureKind::kCompact) {
    throw InputError("--cutoff and --max-depth want --structure compact");
  }
  const std::size_t size = node_colors_bytes(built->compact());
  if (shading.mode != ShadeMode::kColor || size == 0) {
    return colors;
  }
  const Bytes table = built->arena().take(size);
  if (table.empty()) {
    throw InputError(
        "the mean colours of ", grouped(built->compact().node_count()), " nodes need ", grouped(size),
        " bytes beside the scene, more than the budget has left; give it more, or another --shade");
  }
  if (NodeColors::make(built->compact(), shading.palette, shading.default_color, table, &colors) !=
      Status::kOk) {
    throw InputError("the tree is damaged: its counts contradict each other");
  }
  return colors;
}

}  // namespace thimble::tools
