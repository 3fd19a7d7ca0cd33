#include "wide/lit/miss_shader.h"

#include <algorithm>

namespace thimble::wide {
namespace {

lit::Color color_of(const Rgb8& color) {
  return {{color.r * lit::kLevel, color.g * lit::kLevel, color.b * lit::kLevel}};
}

}  // namespace

void SkyColumns::lay_out(uint32_t count, ArrayArena* arena) {
  for (int32_t*& column : of) {
    column = arena->take<int32_t>(count + kMostLightLanes);
  }
}

// The core, which traces where there is no map, counts its visits of all rays.
MissShader::MissShader(const lit::Frame& frame, const RayMap& map, const SkyColumns& columns, uint32_t most)
    : frame_(frame),
      beams_(frame.camera, map),
      columns_(columns),
      most_(most),
      background_(lit::background(frame)),
      horizon_(color_of(frame.scene.sky.horizon)) {
  const lit::Color beyond[2] = {color_of(frame.scene.sky.zenith), color_of(frame.scene.sky.ground)};
  for (int side = 0; side < 2; ++side) {
    for (int c = 0; c < 3; ++c) {
      change_[side][c] = beyond[side].c[c] - horizon_.c[c];
    }
  }
}

void MissShader::look(const PixelReader& pixels, const PixelColumns& whole) {
  const int32_t rows = pixels.row() / kBeam;
  if (left_ == whole.first && rows_ == rows) {
    return;
  }
  if (left_ != whole.first || rows % (PixelQueue::kSquare / kBeam) == 0) {
    of_square_ = beams_.first_plane(
        {whole.first, pixels.camera_row(), whole.end, pixels.camera_row() + PixelQueue::kSquare});
  }
  left_ = whole.first;
  rows_ = rows;
  const int32_t first_row = pixels.camera_row() - pixels.row() % kBeam;
  for (int32_t x = whole.first; x < whole.end; x += kBeam) {
    planes_[(x - left_) / kBeam] =
        beams_.first_plane({x, first_row, std::min(x + kBeam, whole.end), first_row + kBeam}, of_square_);
  }
}

bool MissShader::begin_row(PixelReader* pixels, LitCounts* counts) {
  if (!pixels->begin_row()) {
    return false;
  }
  if (pixels->is_row()) {
    const PixelColumns whole = pixels->columns();
    look(*pixels, whole);
    const auto is_clear = [&](int32_t x) { return planes_[(x - left_) / kBeam].is_clear; };
    int32_t first = whole.first;
    int32_t end = whole.end;
    while (first < end && is_clear(first)) {
      first = std::min(first + kBeam, end);
    }
    while (first < end && is_clear(end - 1)) {
      end = left_ + (end - 1 - left_) / kBeam * kBeam;
    }
    show_row(*pixels, whole.first, first);
    show_row(*pixels, end, whole.end);
    pixels->narrow(first, end);
    counts->rays[static_cast<int>(LitRayKind::kPrimary)] +=
        static_cast<uint32_t>(whole.end - whole.first - (end - first));
  }
  return true;
}

void MissShader::show_row(const PixelReader& pixels, int32_t first, int32_t end) const {
  RowRays rays(frame_.camera, first, pixels.camera_row());
  const auto most = static_cast<int32_t>(most_);
  for (int32_t x = first; x < end; x += most) {
    const auto count = static_cast<uint32_t>(std::min(most, end - x));
    for (uint32_t i = 0; i < count && (frame_.effects & Effect::kSky) != 0; ++i, rays.next()) {
      columns_.put(i, rays.ray().direction);
    }
    uint8_t* const rgb = pixels.rgb_of({x, pixels.row()});
    each_color(count, [&](uint32_t i, const lit::Color& color) {
      if (rgb != nullptr) {
        PixelReader::store_rgb(color, rgb + 3 * i);
      } else {
        pixels.store({x + static_cast<int32_t>(i), pixels.row()}, color);
      }
    });
  }
}

}  // namespace thimble::wide
