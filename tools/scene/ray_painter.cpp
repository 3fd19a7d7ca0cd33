// The core's own order: ray by ray, in bands of the scene's memory.
#include <algorithm>

#include "scene/painter.h"

namespace thimble::tools {
namespace {

class RayPainter final : public BandPainter {
 public:
  RayPainter(const BuiltScene& built, const Camera& camera, const Shading& shading, PixelFormat format,
             const TraceOptions& options)
      : built_(built),
        camera_(camera),
        shading_(shading),
        options_(options),
        // At least a byte a row: a picture is at least a pixel wide.
        rows_(static_cast<std::int32_t>(built.band().size /
                                        std::max<std::size_t>(1, row_bytes(format, camera.width_px())))) {}

  const char* engine() const override { return options_.width == Width::k32 ? "ray32" : "ray64"; }
  std::int32_t most_rows() const override { return rows_; }
  Bytes work() const override { return built_.band(); }
  Status draw(const Band& band, PaintCounts* counts) override {
    return built_.render_band(camera_, shading_, band, &counts->all, options_);
  }

 private:
  const BuiltScene& built_;
  const Camera& camera_;
  const Shading& shading_;
  TraceOptions options_;
  std::int32_t rows_;
};

}  // namespace

std::unique_ptr<BandPainter> make_ray_painter(const BuiltScene& built, const Camera& camera,
                                              const Shading& shading, PixelFormat format,
                                              const TraceOptions& options) {
  return std::make_unique<RayPainter>(built, camera, shading, format, options);
}

}  // namespace thimble::tools
