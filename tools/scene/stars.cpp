// Points that shine: each voxel is a soft disc of light, and light adds up. Sums of integers, so that neither
// the order of the points nor the height of a band makes a difference.
#include <algorithm>
#include <cmath>
#include <vector>

#include "readers/oct.h"
#include "scene/look_picture.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

constexpr int kAxisBits = 20;
constexpr Rgb8 kNear{255, 216, 172};  // of points without colours
constexpr Rgb8 kFar{100, 136, 255};
constexpr Rgb8 kNight{3, 4, 9};
constexpr std::int32_t kDimmest = 72;  // of a star's brightest channel, before its depth

struct Axis {
  std::int64_t x, y, z;
  std::int64_t along(const Axis& way) const { return (x * way.x + y * way.y + z * way.z) >> kAxisBits; }
};

Axis axis_of(const Real3& v) {
  const double scale = static_cast<double>(1 << kAxisBits) / std::sqrt(dot(v, v));
  return {std::llround(v[0] * scale), std::llround(v[1] * scale), std::llround(v[2] * scale)};
}

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

// Where points lie on the picture, in 1/256 pixel, and how they shine there.
class Sky {
 public:
  Sky(const LookCanvas& canvas, std::uint64_t points)
      : canvas_(canvas), camera_(canvas.framing->camera), eye_(canvas.framing->kept.eye) {
    const SceneCamera& kept = canvas.framing->kept;
    const PictureAxes axes(kept);
    forward_ = axis_of(axes.forward);
    right_ = axis_of(axes.right);
    down_ = axis_of(cross(axes.forward, axes.right));
    const double half = kept.fov_degrees.raw / 65536.0 * 3.14159265358979323846 / 360;
    pixels_q8_ =
        kept.is_perspective
            ? std::llround(camera_.height_px() / 2.0 / std::tan(half) * 256)
            : std::llround(camera_.width_px() / (static_cast<double>(kept.span.raw) / Q14::kOne) * 256);
    // As large as leaves a hundred times their room.
    const double area = static_cast<double>(camera_.width_px()) * camera_.height_px();
    radius_q8_ = std::clamp(
        std::llround(256 *
                     std::sqrt(area / (100.0 * static_cast<double>(std::max<std::uint64_t>(1, points))))),
        200LL, 1100LL);
    near_ = INT64_MAX;
    far_ = INT64_MIN;
    for (const Vec3i& corner : box_corners(canvas.tree->bounds())) {
      const std::int64_t depth = forward_.along(from_eye_to(corner, 0));
      near_ = std::min(near_, depth);
      far_ = std::max(far_, depth);
    }
    near_ = std::max<std::int64_t>(near_, 1);
    far_ = std::max(far_, near_ + 256);
    middle_ = (near_ + far_) / 2;
  }

  struct Star {
    std::int64_t x_q8, y_q8;  // of its middle
    std::int64_t radius_q8;   // where its light ends
    std::int64_t light[3];    // at its middle, 65,536 for a white one half way
  };

  // False where it lies behind the eye or beside those rows of the picture.
  bool shine(const Vec3i& corner, int level, std::uint8_t material, RowRange rows, Star* star) const {
    const std::int64_t half = std::int64_t{Q8::kOne / 2} << level;
    const Axis from_eye = from_eye_to(corner, half);
    const std::int64_t depth = forward_.along(from_eye);
    const bool perspective = canvas_.framing->kept.is_perspective;
    if (perspective && depth < Q8::kOne / 4) {
      return false;
    }
    const std::int64_t divisor = perspective ? depth : Q8::kOne;
    star->y_q8 = camera_.height_px() * 128 + floor_divide(down_.along(from_eye) * pixels_q8_, divisor);
    const std::int64_t side =
        (pixels_q8_ << level) * (perspective ? Q8::kOne : 1) / (perspective ? divisor : 1);
    const std::int64_t ratio_q8 =
        perspective ? std::clamp<std::int64_t>(middle_ * 256 / depth, 96, 700) : 256;
    star->radius_q8 = std::max({radius_q8_ * ratio_q8 / 256 * 2, side * 3 / 4, std::int64_t{300}});
    if (star->y_q8 + star->radius_q8 <= rows.first * 256LL ||
        star->y_q8 - star->radius_q8 >= (rows.first + rows.count) * 256LL) {
      return false;
    }
    star->x_q8 = camera_.width_px() * 128 + floor_divide(right_.along(from_eye) * pixels_q8_, divisor);
    if (star->x_q8 + star->radius_q8 <= 0 || star->x_q8 - star->radius_q8 >= camera_.width_px() * 256LL) {
      return false;
    }
    const std::int64_t place = std::clamp<std::int64_t>((far_ - depth) * 256 / (far_ - near_), 0, 256);
    const std::int64_t bright = ratio_q8 * ratio_q8 / 256 * (96 + place * 160 / 256) / 256;
    const Rgb8 color = canvas_.look->palette.empty() ? kNear : canvas_.look->palette[material];
    // What has the night's colour would be a hole in it.
    const std::int64_t lift = std::max<std::int64_t>(0, kDimmest - std::max({color.r, color.g, color.b}));
    const std::int64_t channels[3] = {color.r + lift, color.g + lift, color.b + lift};
    const std::int64_t near_colors[3] = {kNear.r, kNear.g, kNear.b};
    const std::int64_t far_colors[3] = {kFar.r, kFar.g, kFar.b};
    for (int c = 0; c < 3; ++c) {
      const std::int64_t own = canvas_.look->has_own_colors
                                   ? channels[c]
                                   : (near_colors[c] * place + far_colors[c] * (256 - place)) / 256;
      star->light[c] = own * bright;
    }
    return true;
  }

 private:
  // In 1/256 voxel, to what lies `half` of them beyond the corner on each axis.
  Axis from_eye_to(const Vec3i& corner, std::int64_t half) const {
    const auto way = [&](int axis) { return std::int64_t{corner[axis]} * Q8::kOne + half - eye_[axis].raw; };
    return {way(0), way(1), way(2)};
  }

  const LookCanvas& canvas_;
  const Camera& camera_;
  Vec3Q8 eye_;
  Axis right_{};
  Axis down_{};
  Axis forward_{};
  std::int64_t pixels_q8_ = 0;  // a voxel at a depth of one
  std::int64_t radius_q8_ = 0;
  std::int64_t near_ = 0;
  std::int64_t far_ = 0;
  std::int64_t middle_ = 0;
};

// Adds a star's light to those rows.
void add_star(const Sky::Star& star, std::int32_t width, RowRange rows, std::uint32_t* sums) {
  const std::int64_t r = star.radius_q8;
  const std::int64_t square = r * r;
  const std::int32_t first = rows.first;
  const auto y_from = std::max<std::int64_t>(first, floor_divide(star.y_q8 - r, 256));
  const auto y_to = std::min<std::int64_t>(first + rows.count - 1, floor_divide(star.y_q8 + r, 256));
  const auto x_from = std::max<std::int64_t>(0, floor_divide(star.x_q8 - r, 256));
  const auto x_to = std::min<std::int64_t>(width - 1, floor_divide(star.x_q8 + r, 256));
  for (std::int64_t y = y_from; y <= y_to; ++y) {
    const std::int64_t dy = y * 256 + 128 - star.y_q8;
    for (std::int64_t x = x_from; x <= x_to; ++x) {
      const std::int64_t dx = x * 256 + 128 - star.x_q8;
      const std::int64_t inside = square - dx * dx - dy * dy;
      if (inside <= 0) {
        continue;
      }
      const std::int64_t share = inside * 1024 / square;  // 0 .. 1024
      std::uint32_t* const sum = sums + 3 * ((y - first) * width + x);
      for (int c = 0; c < 3; ++c) {
        const std::int64_t light = star.light[c] * share / 1024 * share / 1024 / 16;
        sum[c] = static_cast<std::uint32_t>(std::min<std::int64_t>(UINT32_MAX, sum[c] + light));
      }
    }
  }
}

// Greys of logarithmic steps, to find a middle among them.
int step_of(std::uint32_t value) {
  int bits = 0;
  while (value >> bits > 15) {
    ++bits;
  }
  return 16 * bits + static_cast<int>(value >> bits);
}

}  // namespace

Status paint_stars(const LookCanvas& canvas, const Progress& progress, Painting* painting) {
  painting->engine = "stars";
  painting->threads = canvas.threads;
  Image& image = painting->image;
  const std::int32_t width = image.width_px;
  const std::int32_t height = canvas.framing->camera.height_px();
  const auto at_once = static_cast<std::int32_t>(std::min<std::size_t>(
      canvas.work.size / (kStarBytes * static_cast<std::size_t>(width)), static_cast<std::size_t>(height)));
  const Sky sky(canvas, canvas.tree->voxel_count());
  auto* const sums = reinterpret_cast<std::uint32_t*>(canvas.work.data);
  const std::size_t line = 3 * static_cast<std::size_t>(width);
  // The light of some rows, a part of them on each thread. Sums do not depend on who adds to them when.
  const auto gather = [&](std::int32_t first, std::int32_t rows) {
    const auto parts = std::min(canvas.threads, rows);
    each_task(static_cast<std::size_t>(parts), canvas.threads, [&](std::size_t part, std::size_t) {
      const auto cut = [&](std::size_t number) {
        return static_cast<std::int32_t>(static_cast<std::int64_t>(number) * rows / parts);
      };
      const RowRange own{first + cut(part), cut(part + 1) - cut(part)};
      std::uint32_t* const own_sums = sums + line * static_cast<std::size_t>(own.first - first);
      std::fill_n(own_sums, line * static_cast<std::size_t>(own.count), 0U);
      walk_blocks(*canvas.tree, [&](const Vec3i& corner, int level, std::uint8_t material) {
        Sky::Star star{};
        if (sky.shine(corner, level, material, own, &star)) {
          add_star(star, width, own, own_sums);
        }
      });
    });
  };
  // First the light that is half way to white: three fifths of the pixels that have any have less.
  std::vector<std::uint64_t> counts(16 * 33);
  std::uint64_t lit = 0;
  for (std::int32_t y = 0; y < height; y += at_once) {
    const std::int32_t rows = std::min(at_once, height - y);
    gather(y, rows);
    for (std::size_t i = 0; i < line * static_cast<std::size_t>(rows); i += 3) {
      const std::uint32_t value = std::max({sums[i], sums[i + 1], sums[i + 2]});
      counts[static_cast<std::size_t>(step_of(value))] += value != 0 ? 1 : 0;
      lit += value != 0 ? 1 : 0;
    }
    tell(progress, static_cast<double>(y) / height / 2);
  }
  std::size_t step = 0;
  std::uint64_t below = counts[0];
  while (step + 1 < counts.size() && 5 * below < 3 * lit) {
    below += counts[++step];
  }
  const std::uint64_t half_way = std::max<std::uint64_t>(64, std::uint64_t{step % 16} << (step / 16));
  const Background& own = canvas.look->background;
  const Rgb8 back = own.kind == BackgroundKind::kColor ? own.color : kNight;
  const std::array<std::uint32_t, 3> behind{back.r, back.g, back.b};
  const std::int32_t end = image.first_row + image.height_px;
  for (std::int32_t y = image.first_row; y < end; y += at_once) {
    const std::int32_t rows = std::min(at_once, end - y);
    if (at_once < height || image.first_row != 0) {
      gather(y, rows);
    }
    const auto first = static_cast<std::size_t>(y - image.first_row) * static_cast<std::size_t>(width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(width) * static_cast<std::size_t>(rows); ++i) {
      std::uint32_t most = 0;
      std::array<std::uint32_t, 3> shown{};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint64_t light = sums[3 * i + c];
        shown[c] = static_cast<std::uint32_t>(255 * light / (light + half_way));
        most = std::max(most, shown[c]);
      }
      std::uint8_t* const pixel = image.pixels.data() + 3 * (first + i);
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] =
            static_cast<std::uint8_t>(image.alpha.empty() ? shown[c] + behind[c] * (255 - shown[c]) / 255
                                                          : shown[c] * 255 / std::max(most, 1U));
      }
      if (!image.alpha.empty()) {
        image.alpha[first + i] = static_cast<std::uint8_t>(most);
      }
    }
    tell(progress, 0.5 + static_cast<double>(y - image.first_row) / image.height_px / 2);
  }
  return Status::kOk;
}

}  // namespace thimble::tools
