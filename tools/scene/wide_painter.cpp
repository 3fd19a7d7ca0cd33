// Object order, with vectors and threads; its workspace is the scene's, its bands are the picture's.
#include "scene/painter.h"

namespace thimble::tools {
namespace {

class WidePainter final : public Painter {
 public:
  WidePainter(const BuiltScene& built, const Camera& camera, const Shading& shading, int threads)
      : built_(built), camera_(camera), shading_(shading), threads_(threads) {}

  const char* engine() const override { return "wide"; }
  int threads() const override { return threads_; }
  std::int32_t most_rows() const override { return built_.wide_rows(); }
  Bytes work() const override { return {}; }
  Status draw(const Band& band, PaintCounts* counts) override {
    return built_.render_wide(camera_, shading_, band, &counts->all, &counts->wide);
  }

 private:
  const BuiltScene& built_;
  const Camera& camera_;
  const Shading& shading_;
  int threads_;
};

}  // namespace

std::unique_ptr<Painter> make_wide_painter(const BuiltScene& built, const Camera& camera,
                                           const Shading& shading, int threads) {
  return std::make_unique<WidePainter>(built, camera, shading, threads);
}

}  // namespace thimble::tools
