// The strongest simple rival below some millions of points: no tree, no order, a depth buffer.
#include "benchmarks/peers/peer.h"

namespace thimble::benchmarks {
namespace {

class Raster : public Peer {
 public:
  explicit Raster(const std::vector<Voxel>& voxels) : voxels_(voxels) {}
  std::string name() const override { return "exact raster"; }
  std::size_t bytes() const override { return voxels_.size() * sizeof(Voxel); }

  void draw(const View& view, std::uint8_t* gray, Voxel* voxels) override {
    const std::size_t pixels =
        static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px);
    nearest_.assign(pixels, kNothing);
    if (voxels != nullptr) {
      std::fill(voxels, voxels + pixels, kNoVoxel);
    }
    std::fill(gray, gray + pixels, std::uint8_t{0});
    view.frame.perspective ? draw_boxes<true>(view, gray, voxels) : draw_boxes<false>(view, gray, voxels);
  }

 private:
  static constexpr float kNothing = std::numeric_limits<float>::infinity();

  // How many pixels a box reaches from its middle: wide/frame.h.
  struct Reach {
    float x, y;
  };
  static Reach reach_of(const wide::WideFrame& frame, float column, float row, float per_depth) {
    const float k = 0.5F * per_depth + frame.per_direction * (1 + frame.half_w * per_depth);
    const float r = k * frame.norm_w;
    if (!frame.perspective || r > 0.125F) {
      return {frame.reach_x * per_depth + frame.rounding_x * per_depth + frame.slack_x,
              frame.reach_y * per_depth + frame.rounding_y * per_depth + frame.slack_y};
    }
    const float factor = k * (r * 1.152F + 1.001F);
    float across = 0;
    float down = 0;
    for (int axis = 0; axis < 3; ++axis) {
      across += std::abs(frame.u[axis] - column * frame.w[axis]);
      down += std::abs(frame.v[axis] - row * frame.w[axis]);
    }
    return {across * factor + frame.rounding_x * per_depth + frame.spread_x,
            down * factor + frame.rounding_y * per_depth + frame.spread_y};
  }

  template <bool kPerspective>
  void draw_boxes(const View& view, std::uint8_t* gray, Voxel* ids) {
    const wide::WideFrame& frame = view.frame;
    const auto last_x = static_cast<float>(view.width_px - 1);
    const auto last_y = static_cast<float>(view.height_px - 1);
    for (const Voxel voxel : voxels_) {
      const float low[3] = {static_cast<float>(voxel.x), static_cast<float>(voxel.y),
                            static_cast<float>(voxel.z)};
      const auto apply = [&](const float(&of)[4]) {
        return of[0] * (low[0] + 0.5F) + of[1] * (low[1] + 0.5F) + of[2] * (low[2] + 0.5F) + of[3];
      };
      float per_depth = 1;
      if (kPerspective) {
        const float depth = apply(frame.w);
        if (depth <= frame.half_w) {
          continue;  // in the eye's plane or behind it: the views here have no such voxels in sight
        }
        per_depth = 1 / depth;
      }
      const float column = apply(frame.u) * per_depth;
      const float row = apply(frame.v) * per_depth;
      const Reach reach = reach_of(frame, column, row, per_depth);
      const float x0 = std::max(column - reach.x, 0.0F);
      const float x1 = std::min(column + reach.x, last_x);
      const float y0 = std::max(row - reach.y, 0.0F);
      const float y1 = std::min(row + reach.y, last_y);
      if (!(x0 <= x1 && y0 <= y1)) {
        continue;
      }
      const auto end_x = static_cast<std::int32_t>(x1);
      const auto end_y = static_cast<std::int32_t>(y1);
      for (auto y = static_cast<std::int32_t>(y0 + 0.9999999F); y <= end_y; ++y) {
        for (auto x = static_cast<std::int32_t>(x0 + 0.9999999F); x <= end_x; ++x) {
          test<kPerspective>(view, low, voxel, x, y, gray, ids);
        }
      }
    }
  }

  template <bool kPerspective>
  void test(const View& view, const float (&low)[3], Voxel voxel, std::int32_t x, std::int32_t y,
            std::uint8_t* gray, Voxel* ids) {
    const FloatRay ray = ray_of(view, x, y);
    float enter = 0;
    float leave = kNothing;
    for (int axis = 0; axis < 3; ++axis) {
      const float to_low = low[axis] - ray.origin[axis];
      if (ray.direction[axis] == 0) {
        leave = to_low <= 0 && to_low > -1 ? leave : -1;
        continue;
      }
      const float inverse = 1 / ray.direction[axis];
      const float first = to_low * inverse;
      const float second = (to_low + 1) * inverse;
      enter = std::max(enter, std::min(first, second));
      leave = std::min(leave, std::max(first, second));
    }
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width_px) + static_cast<std::size_t>(x);
    if (enter < leave && enter < nearest_[pixel]) {
      nearest_[pixel] = enter;
      gray[pixel] = view.gray(enter);
      if (ids != nullptr) {
        ids[pixel] = voxel;
      }
    }
  }

  const std::vector<Voxel>& voxels_;
  std::vector<float> nearest_;
};

}  // namespace

View::View(const Camera& camera, std::int32_t near_plane_q8, std::int32_t far_plane_q8)
    : width_px(camera.width_px()),
      height_px(camera.height_px()),
      depth_per_t(static_cast<float>(camera.depth_per_t_q8())),
      near_q8(static_cast<float>(near_plane_q8)),
      per_q8(215.0F / static_cast<float>(far_plane_q8 - near_plane_q8)) {
  (void)wide::make_frame(camera, {0, 0, width_px, height_px}, &frame);
}

std::unique_ptr<Peer> make_raster(const std::vector<Voxel>& voxels) {
  return std::make_unique<Raster>(voxels);
}

}  // namespace thimble::benchmarks
