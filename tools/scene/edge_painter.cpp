// Samples where edges are, by whatever draws the samples: rays or light.
#include <algorithm>
#include <utility>
#include <vector>

#include "scene/edge_rows.h"
#include "scene/lit_setup.h"
#include "scene/painter.h"

namespace thimble::tools {
namespace {

constexpr int kChannels = 3;

class EdgePainter final : public BandPainter {
 public:
  EdgePainter(const BuiltScene& built, const Camera& camera, const Camera& fine, PixelFormat format,
              EdgeEngine engine)
      : built_(built),
        engine_(std::move(engine)),
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

  const char* engine() const override { return engine_.name; }
  int threads() const override { return engine_.threads; }
  std::int32_t most_rows() const override { return rows_; }
  Bytes work() const override { return built_.band(); }

  Status draw(const Band& band, PaintCounts* counts) override {
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

  const BuiltScene& built_;
  EdgeEngine engine_;
  PixelFormat format_;
  std::size_t row_bytes_;
  std::int32_t rows_;
  Bytes pixels_;
  std::int32_t first_row_ = 0;
  std::vector<PaintCounts> counts_;  // of each worker
  EdgeRows edges_;
};

}  // namespace

std::uint64_t edge_band_bytes(PixelFormat format, std::int32_t width_px, std::int32_t rows, int threads) {
  return EdgeRows::work_bytes(kChannels, width_px, rows, threads) +
         static_cast<std::uint64_t>(rows) * row_bytes(format, width_px);
}

std::unique_ptr<BandPainter> make_edge_painter(const BuiltScene& built, const Camera& camera,
                                               const Camera& fine, PixelFormat format, EdgeEngine engine) {
  return std::make_unique<EdgePainter>(built, camera, fine, format, std::move(engine));
}

}  // namespace thimble::tools
