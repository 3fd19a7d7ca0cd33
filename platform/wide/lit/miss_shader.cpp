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
      has_spans_(map.cells() != nullptr),
      spans_(frame.camera, map.tree().bounds()),
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

bool MissShader::begin_row(PixelReader* pixels, LitCounts* counts) const {
  if (!pixels->begin_row()) {
    return false;
  }
  if (pixels->is_row() && has_spans_) {
    const RowSpans::Columns whole = pixels->columns();
    const RowSpans::Columns columns = spans_.of_row(pixels->camera_row());
    const int32_t first = std::clamp(columns.first, whole.first, whole.end);
    const int32_t end = std::clamp(columns.end, first, whole.end);
    show_row(*pixels, whole.first, first);
    show_row(*pixels, end, whole.end);
    pixels->narrow(first, end);
    counts->rays[static_cast<int>(LitRayKind::kPrimary)] +=
        static_cast<uint32_t>(whole.end - whole.first - (end - first));
  }
  return true;
}

void MissShader::show_row(const PixelReader& pixels, int32_t first, int32_t end) const {
  const Camera& camera = frame_.camera;
  const Camera::Affine& affine = camera.affine();
  const auto most = static_cast<int32_t>(most_);
  for (int32_t x = first; x < end; x += most) {
    const auto count = static_cast<uint32_t>(std::min(most, end - x));
    for (int axis = 0; axis < 3 && (frame_.effects & Effect::kSky) != 0; ++axis) {
      int64_t value = int64_t{camera.direction()[axis]} << 32;
      int64_t step = 0;
      if (camera.is_perspective()) {
        step = affine.step_x[axis];
        value = affine.base[axis] + x * step + pixels.camera_row() * affine.step_y[axis];
      }
      round_along_row(value, step, count, columns_.of[axis]);
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
