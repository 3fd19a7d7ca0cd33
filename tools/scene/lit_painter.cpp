// Lit pictures in bands of the scene's memory. Several samples a pixel are rows of the finer camera,
// averaged. A pixel is a function of the scene alone, so threads take rows as they come.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "scene/lit_setup.h"
#include "scene/painter.h"
#include "scene/workers.h"
#include "thimble/picture/render.h"

namespace thimble::tools {
namespace {

class LitPainter final : public BandPainter {
 public:
  LitPainter(const BuiltScene& built, const Camera& camera, const Shading& shading, PixelFormat format,
             const LitPicture& picture)
      : built_(built),
        camera_(camera),
        shading_(shading),
        picture_(picture),
        width_px_(camera.width_px() / picture.across),
        row_bytes_(std::max<std::size_t>(1, row_bytes(format, width_px_))),
        fine_bytes_(samples_bytes(width_px_, picture.across)) {}

  const char* engine() const override { return "lit"; }
  int threads() const override {
    return picture_.streams != nullptr ? picture_.streams->threads() : picture_.threads;
  }
  std::int32_t most_rows() const override {
    if (picture_.across != 1) {
      return static_cast<std::int32_t>(built_.band().size / (row_bytes_ + fine_bytes_));
    }
    if (!is_straight()) {
      return static_cast<std::int32_t>(built_.band().size / row_bytes_);
    }
    const std::int32_t rows = std::max(1, kMostPixelsAtOnce / width_px_);
    return rows < kSquarePx ? rows : rows / kSquarePx * kSquarePx;
  }
  Bytes work() const override { return is_straight() ? Bytes() : built_.band(); }
  Status draw(const Band& band, PaintCounts* counts) override {
    const Status status =
        picture_.across == 1 ? draw_band(band, &counts->lit) : draw_samples(band, &counts->lit);
    counts->all = totals_of(counts->lit);
    return status;
  }

 private:
  // At the end of each call of a stream its threads, which take squares, wait for one another, and what they keep of slopes
  // and lights goes. Between calls a person sees how far it is, and may end it.
  static constexpr std::int32_t kMostPixelsAtOnce = 1 << 18;
  static constexpr std::int32_t kSquarePx = 32;

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
    std::atomic<Status> worst{Status::kOk};
    const auto draw_row = [&](std::size_t row, std::size_t worker) {
      Band part = band;
      part.first_row += static_cast<std::int32_t>(row);
      part.rows = 1;
      part.pixels = band.pixels.subspan(line * row);
      const Status status = draw_rows(part, &of_workers[worker]);
      if (status != Status::kOk) {
        worst.store(status);
      }
    };
    each_task(static_cast<std::size_t>(band.rows), picture_.threads, draw_row);
    for (const LitCounts& part : of_workers) {
      add_counts(part, counts);
    }
    return worst;
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

}  // namespace

std::unique_ptr<BandPainter> make_lit_painter(const BuiltScene& built, const Camera& camera,
                                              const Shading& shading, PixelFormat format,
                                              const LitPicture& picture) {
  return std::make_unique<LitPainter>(built, camera, shading, format, picture);
}

std::unique_ptr<BandPainter> make_lit_edge_painter(const BuiltScene& built, const Camera& camera,
                                                   const Camera& fine, const Shading& shading,
                                                   PixelFormat format, const LitPicture& picture) {
  const auto draw = [&built, shading, picture](const SampleRun& run, Bytes samples, PaintCounts* counts) {
    return render_lit_band(picture.effects, built.compact(), run.camera, shading, picture.scene,
                           {samples, PixelFormat::kRgb888, 0, run.row, 1}, &counts->lit);
  };
  EdgeEngine engine{"lit", picture.threads, true, draw};
  if (picture.streams != nullptr) {
    engine.threads = picture.streams->threads();
    engine.draw_places = [shading, picture](const Camera& view, Span<const SamplePlace> places, Bytes samples,
                                            PaintCounts* counts) {
      return picture.streams->render_pixels(picture.effects, view, shading, picture.scene, places, samples,
                                            &counts->lit);
    };
  }
  return make_edge_painter(built, camera, fine, format, std::move(engine));
}

}  // namespace thimble::tools
