// Several samples a pixel, a cut-off or a depth: the rows of a QualityFrame.
#include "scene/painter.h"

namespace thimble::tools {
namespace {

class QualityPainter final : public BandPainter {
 public:
  QualityPainter(const BuiltScene& built, const QualityFrame& frame, const TraceOptions& options)
      : built_(built), frame_(frame), options_(options) {}

  const char* engine() const override { return options_.width == Width::k32 ? "ray32" : "ray64"; }
  std::int32_t most_rows() const override { return 1; }
  Bytes work() const override { return built_.band(); }
  Status draw(const Band& band, PaintCounts* counts) override {
    return frame_.draw_row(band.first_row, band.format, band.pixels, &counts->all, options_);
  }

 private:
  const BuiltScene& built_;
  const QualityFrame& frame_;
  TraceOptions options_;
};

}  // namespace

std::unique_ptr<BandPainter> make_ray_edge_painter(const BuiltScene& built, const QualityFrame& frame,
                                                   const Camera& camera, const Camera& fine,
                                                   PixelFormat format, const TraceOptions& options) {
  const auto draw = [&frame, options](const SampleRun& run, Bytes samples, PaintCounts* counts) {
    return frame.draw_run(run, samples, &counts->all, options);
  };
  const char* const name = options.width == Width::k32 ? "ray32" : "ray64";
  return make_edge_painter(built, camera, fine, format, {name, 1, false, draw});
}

std::unique_ptr<BandPainter> make_quality_painter(const BuiltScene& built, const QualityFrame& frame,
                                                  const TraceOptions& options) {
  return std::make_unique<QualityPainter>(built, frame, options);
}

}  // namespace thimble::tools
