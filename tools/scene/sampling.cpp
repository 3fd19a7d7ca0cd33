#include "scene/sampling.h"

#include <algorithm>

#include "output/units.h"
#include "readers/source.h"
#include "scene/edge_rows.h"

namespace thimble::tools {

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

}  // namespace thimble::tools
