// Object order, with vectors and threads; its bands are the picture's.
#include "scene/painter.h"

namespace thimble::tools {
namespace {

class WidePainter final : public BandPainter {
 public:
  WidePainter(WideRenderer* renderer, const Camera& camera, const Shading& shading)
      : renderer_(*renderer), camera_(camera), shading_(shading) {}

  const char* engine() const override { return "wide"; }
  int threads() const override { return renderer_.threads(); }
  std::int32_t most_rows() const override { return renderer_.rows(); }
  Bytes work() const override { return {}; }
  Status draw(const Band& band, PaintCounts* counts) override {
    return renderer_.render(camera_, shading_, band, &counts->all, &counts->wide);
  }

 private:
  WideRenderer& renderer_;
  const Camera& camera_;
  const Shading& shading_;
};

}  // namespace

std::unique_ptr<BandPainter> make_wide_painter(WideRenderer* renderer, const Camera& camera,
                                               const Shading& shading) {
  return std::make_unique<WidePainter>(renderer, camera, shading);
}

}  // namespace thimble::tools
