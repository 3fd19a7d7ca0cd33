// A GPU; its bands are the picture's.
#include "scene/gpu_engine.h"
#include "scene/painter.h"

namespace thimble::tools {
namespace {

class GpuPainter final : public BandPainter {
 public:
  GpuPainter(GpuEngine* engine, const Camera& camera, const Shading& shading)
      : engine_(*engine), camera_(camera), shading_(shading) {}

  const char* engine() const override { return "gpu"; }
  std::int32_t most_rows() const override { return GpuEngine::most_rows(camera_.width_px()); }
  Bytes work() const override { return {}; }
  Status draw(const Band& band, PaintCounts* counts) override {
    return engine_.draw(camera_, shading_, band, &counts->all);
  }

 private:
  GpuEngine& engine_;
  const Camera& camera_;
  const Shading& shading_;
};

}  // namespace

std::unique_ptr<BandPainter> make_gpu_painter(GpuEngine* engine, const Camera& camera,
                                              const Shading& shading) {
  return std::make_unique<GpuPainter>(engine, camera, shading);
}

}  // namespace thimble::tools
