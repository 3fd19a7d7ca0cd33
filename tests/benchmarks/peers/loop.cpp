// No tree and no vectors: each voxel at each pixel that it can cover, by the core's own rule in integers, into
// a depth buffer of fractions. What somebody would write who has some thousand voxels and wants the core's
// picture: it is exact. Nothing but the greys is cleared, since a grey of 0 says that a pixel holds nothing.
#include "benchmarks/peers/extent.h"
#include "benchmarks/peers/peer.h"

#include <cstring>

namespace thimble::benchmarks {
namespace {

class Loop : public Peer {
 public:
  explicit Loop(const std::vector<Voxel>& voxels) : voxels_(voxels) {}
  std::string name() const override { return "exact loop"; }
  std::size_t bytes() const override { return voxels_.size() * sizeof(Voxel); }

  void draw(const View& view, std::uint8_t* gray, Voxel* voxels) override {
    const auto pixels = static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px);
    nearest_.resize(pixels);
    std::memset(gray, 0, pixels);
    if (voxels != nullptr) {
      std::fill(voxels, voxels + pixels, kNoVoxel);
    }
    view.frame.perspective ? draw_voxels<true>(view, gray, voxels) : draw_voxels<false>(view, gray, voxels);
  }

 private:
  // Where a ray enters, t = numerator / (256 * speed).
  struct Entry {
    std::int32_t numerator, speed;
  };

  template <bool kPerspective>
  void draw_voxels(const View& view, std::uint8_t* gray, Voxel* ids) {
    for (const Voxel voxel : voxels_) {
      const float low[3] = {static_cast<float>(voxel.x), static_cast<float>(voxel.y),
                            static_cast<float>(voxel.z)};
      const Extent extent = extent_of<kPerspective>(view, low);
      for (std::int32_t y = extent.y0; y <= extent.y1; ++y) {
        for (std::int32_t x = extent.x0; x <= extent.x1; ++x) {
          const Ray ray = view.frame.camera->ray(x, y);
          Hit hit;
          if (!meets(ray, voxel, &hit)) {
            continue;
          }
          const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width_px) +
                                    static_cast<std::size_t>(x);
          Entry& nearest = nearest_[pixel];
          if (gray[pixel] == 0 || std::int64_t{hit.t_numerator} * nearest.speed <
                                      std::int64_t{nearest.numerator} * hit.t_denominator) {
            nearest = {hit.t_numerator, hit.t_denominator};
            gray[pixel] = shade(hit, ray, *view.frame.camera, view.shading).r;
            if (ids != nullptr) {
              ids[pixel] = voxel;
            }
          }
        }
      }
    }
  }

  // The core's rule: of the planes of each two axes the lower one of either is passed before the upper one of
  // the other (wide/raster/exact.cpp).
  static bool meets(const Ray& ray, Voxel voxel, Hit* hit) {
    const std::int32_t low[3] = {voxel.x * 256 - ray.origin.x.raw, voxel.y * 256 - ray.origin.y.raw,
                                 voxel.z * 256 - ray.origin.z.raw};
    const std::int32_t direction[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    std::int32_t speed[3];
    std::int64_t ahead[3];  // of the middle, along the ray's own direction, in 1/512 voxel
    for (int axis = 0; axis < 3; ++axis) {
      speed[axis] = std::abs(direction[axis]);
      const std::int32_t middle = 2 * low[axis] + 256;
      ahead[axis] = direction[axis] < 0 ? -middle : middle;
      if (speed[axis] == 0 ? middle > 256 || middle <= -256 : ahead[axis] <= -256) {
        return false;
      }
    }
    for (int a = 0; a < 3; ++a) {
      const int b = a == 2 ? 0 : a + 1;
      const std::int64_t cross = ahead[a] * speed[b] - ahead[b] * speed[a];
      if (std::abs(cross) >= 256 * (std::int64_t{speed[a]} + speed[b]) && speed[a] != 0 && speed[b] != 0) {
        return false;
      }
    }
    std::int64_t numerator = 0;
    std::int64_t last_speed = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t distance = (ahead[axis] - 256) / 2;
      if (speed[axis] != 0 && distance > 0 && distance * last_speed > numerator * speed[axis]) {
        numerator = distance;
        last_speed = speed[axis];
      }
    }
    hit->kind = HitKind::kHit;
    hit->t_numerator = static_cast<std::int32_t>(numerator);
    hit->t_denominator = numerator == 0 ? 1 : static_cast<std::int32_t>(256 * last_speed);
    return true;
  }

  const std::vector<Voxel>& voxels_;
  std::vector<Entry> nearest_;
};

}  // namespace

std::unique_ptr<Peer> make_loop(const std::vector<Voxel>& voxels) {
  return std::make_unique<Loop>(voxels);
}

}  // namespace thimble::benchmarks
