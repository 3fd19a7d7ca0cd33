#include "viewer/sample_passes.h"

#include <algorithm>

namespace thimble::tools::viewer {
namespace {

constexpr std::size_t kChannels = 4;

}  // namespace

SamplePass::SamplePass(const LookRows& look, const Camera& fine, int across, int step, KeptSamples* kept)
    : look_(look),
      fine_(fine),
      across_(across),
      step_(step),
      width_px_(fine.width_px() / across),
      kept_(kept) {
  kept_->drawn.resize(static_cast<std::size_t>(width_px_) *
                      static_cast<std::size_t>(fine.height_px() / across));
}

// Calls visit(x, y, px, py, known) for each pixel (x, y) of some rows of the pass's picture, which is (px, py) of the
// finished one: its first sample's place, and whether that was drawn before. By columns of pixels, so that what lies
// side by side is drawn together.
template <class Visit>
void SamplePass::each_pixel(std::int32_t first, std::int32_t rows, std::int32_t columns,
                            const Visit& visit) const {
  constexpr std::int32_t kColumns = 8;
  const std::int32_t every = std::max(step_, 1);
  for (std::int32_t left = 0; left < columns; left += kColumns) {
    for (std::int32_t y = first; y < first + rows; ++y) {
      for (std::int32_t x = left; x < std::min(left + kColumns, columns); ++x) {
        const std::int32_t px = x * every;
        const std::int32_t py = y * every;
        const bool known = kept_->step != 0 && px % kept_->step == 0 && py % kept_->step == 0;
        visit(x, y, px, py, known);
      }
    }
  }
}

Status SamplePass::draw(std::int32_t first, std::int32_t rows, Image* image) {
  const std::int32_t across = step_ == 0 ? across_ : 1;  // of the samples that a pixel gets
  places_.clear();
  each_pixel(first, rows, image->width_px,
             [&](std::int32_t /*x*/, std::int32_t /*y*/, std::int32_t px, std::int32_t py, bool known) {
               for (std::int32_t i = known ? 1 : 0; i < across * across; ++i) {
                 places_.push_back({px * across_ + i % across, py * across_ + i / across, px, py});
               }
             });
  colors_.resize(3 * places_.size());
  samples_.resize(kChannels * places_.size());
  const Status status =
      look_.draw_places(fine_, {places_.data(), places_.size()}, Bytes(colors_.data(), colors_.size()),
                        Bytes(samples_.data(), samples_.size()), nullptr);
  const std::uint8_t* next = samples_.data();
  each_pixel(first, rows, image->width_px,
             [&](std::int32_t x, std::int32_t y, std::int32_t px, std::int32_t py, bool known) {
               std::array<std::uint8_t, kChannels>& kept =
                   kept_->drawn[static_cast<std::size_t>(py) * static_cast<std::size_t>(width_px_) +
                                static_cast<std::size_t>(px)];
               if (!known) {
                 std::copy_n(next, kChannels, kept.begin());
                 next += kChannels;
               }
               std::array<std::uint32_t, kChannels> sums{kept[0], kept[1], kept[2], kept[3]};
               for (std::int32_t i = 1; i < across * across; ++i, next += kChannels) {
                 for (std::size_t channel = 0; channel < kChannels; ++channel) {
                   sums[channel] += next[channel];
                 }
               }
               LookRows::finish_sums(x, y, sums.data(), static_cast<std::uint32_t>(across * across), image);
             });
  return status;
}

void SamplePass::end() {
  kept_->step = std::max(step_, 1);
}

}  // namespace thimble::tools::viewer
