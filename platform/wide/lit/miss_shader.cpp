#include "wide/lit/miss_shader.h"

#include <algorithm>
#include <cmath>

namespace thimble::wide {
namespace {

lit::Color color_of(const Rgb8& color) {
  return {{color.r * lit::kLevel, color.g * lit::kLevel, color.b * lit::kLevel}};
}

using Vec3d = Vec3<double>;

template <class T>
Vec3d times(double factor, const Vec3<T>& of) {
  return {factor * static_cast<double>(of.x), factor * static_cast<double>(of.y),
          factor * static_cast<double>(of.z)};
}
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace

// A way from the eye to a corner is a sum of the camera's three vectors (Cramer's rule). Rays are as near to their pixels as
// the camera says; doubles are off by far less than the pixel more.
PixelBox pixels_that_show(const Camera& camera, const VoxelBox& box) {
  const Camera::Affine& affine = camera.affine();
  const Vec3d base = times(0x1p-32, affine.base);
  const Vec3d step_x = times(0x1p-32, affine.step_x);
  const Vec3d step_y = times(0x1p-32, affine.step_y);
  const Vec3d onward = camera.is_perspective() ? base : times(1, camera.direction());
  const double volume = dot(step_x, cross(step_y, onward));
  const PixelBox all{0, 0, camera.width_px(), camera.height_px()};
  double low[2] = {HUGE_VAL, HUGE_VAL};
  double high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3d way;
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = ((corner >> axis & 1U) != 0 ? box.high : box.low)[axis] * Q8::kOne -
                  camera.eye()[axis].raw - (camera.is_perspective() ? 0 : base[axis]);
    }
    const double depth = camera.is_perspective() ? dot(way, cross(step_x, step_y)) / volume : 1;
    if (!(depth > 0)) {
      return all;
    }
    const double place[2] = {dot(way, cross(step_y, onward)) / volume / depth,
                             dot(way, cross(onward, step_x)) / volume / depth};
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], place[i]);
      high[i] = std::max(high[i], place[i]);
    }
  }
  const double margin = 1 + camera.error_bound_px_q16() / 65536.0;
  const auto pixel = [](double place, int32_t most) {
    return static_cast<int32_t>(std::clamp(place, 0.0, static_cast<double>(most)));
  };
  return {pixel(low[0] - margin, all.x1), pixel(low[1] - margin, all.y1), pixel(high[0] + margin + 1, all.x1),
          pixel(high[1] + margin + 1, all.y1)};
}

void SkyColumns::lay_out(uint32_t count, ArrayArena* arena) {
  for (int32_t*& column : of) {
    column = arena->take<int32_t>(count + kMostLightLanes);
  }
}

// The core, which traces where there is no map, counts its visits of all rays.
MissShader::MissShader(const lit::Frame& frame, const RayMap& map, const SkyColumns& columns, uint32_t most)
    : frame_(frame),
      shown_(map.cells() != nullptr ? pixels_that_show(frame.camera, map.tree().bounds())
                                    : PixelBox{0, 0, frame.camera.width_px(), frame.camera.height_px()}),
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
  if (pixels->is_row()) {
    const PixelColumns whole = pixels->columns();
    const bool is_shown = shown_.y0 <= pixels->camera_row() && pixels->camera_row() < shown_.y1;
    const int32_t first = std::clamp(is_shown ? shown_.x0 : whole.end, whole.first, whole.end);
    const int32_t end = std::clamp(shown_.x1, first, whole.end);
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
