// The strongest simple rival below some millions of points: no tree, no order, a depth buffer.
#include "benchmarks/peers/extent.h"
#include "benchmarks/peers/peer.h"

namespace thimble::benchmarks {
namespace {

class Raster : public Peer {
 public:
  explicit Raster(const std::vector<Voxel>& voxels) : voxels_(voxels) {}
  std::string name() const override { return "raster in floats"; }
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

  template <bool kPerspective>
  void draw_boxes(const View& view, std::uint8_t* gray, Voxel* ids) {
    for (const Voxel voxel : voxels_) {
      const float low[3] = {static_cast<float>(voxel.x), static_cast<float>(voxel.y),
                            static_cast<float>(voxel.z)};
      const Extent extent = extent_of<kPerspective>(view, low);
      for (std::int32_t y = extent.y0; y <= extent.y1; ++y) {
        for (std::int32_t x = extent.x0; x <= extent.x1; ++x) {
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
  shading.near_q8 = near_plane_q8;
  shading.far_q8 = far_plane_q8;
}

std::unique_ptr<Peer> make_raster(const std::vector<Voxel>& voxels) {
  return std::make_unique<Raster>(voxels);
}

}  // namespace thimble::benchmarks
