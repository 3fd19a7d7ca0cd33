/// Other ways to the same picture: what somebody could use instead of this renderer.
///
/// A peer is given the voxels once and then draws frames: clearing, rays, all that depends on the view, and a
/// grey by depth for every pixel. Each is made as fast as its interface allows, and gets the rays just as
/// the core quantises them. How many pixels show another voxel than the core's ray hits is counted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "thimble/picture/shading.h"
#include "wide/raster/frame.h"

namespace thimble::benchmarks {

struct Voxel {
  std::uint16_t x, y, z;
  friend bool operator==(const Voxel&, const Voxel&) = default;
};
inline constexpr Voxel kNoVoxel{UINT16_MAX, UINT16_MAX, UINT16_MAX};

/// A camera, and where its greys begin and end.
struct View {
  wide::WideFrame frame;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  float depth_per_t = 0;  ///< in 1/256 voxel
  float near_q8 = 0;
  float per_q8 = 0;
  Shading shading;  ///< the same for the core's shade()

  View(const Camera& camera, std::int32_t near_plane_q8, std::int32_t far_plane_q8);

  std::uint8_t gray(float t) const {
    return static_cast<std::uint8_t>(255.0F -
                                     std::min(std::max((t * depth_per_t - near_q8) * per_q8, 0.0F), 215.0F));
  }
};

/// The quantised ray of a pixel, but for the few whose numbers lie half way between two: origin in voxels,
/// direction in integers.
struct FloatRay {
  float origin[3];
  float direction[3];
};
inline FloatRay ray_of(const View& view, std::int32_t x, std::int32_t y) {
  // Adding and taking off 1.5 * 2^23 rounds to the nearest integer.
  constexpr float kRounder = 12582912.0F;
  const wide::WideFrame& frame = view.frame;
  const auto column = static_cast<float>(x);
  const auto row = static_cast<float>(y);
  FloatRay ray;
  for (int axis = 0; axis < 3; ++axis) {
    const float whole =
        frame.map_whole[0][axis] + column * frame.map_whole[1][axis] + row * frame.map_whole[2][axis];
    const float rest =
        frame.map_rest[0][axis] + column * frame.map_rest[1][axis] + row * frame.map_rest[2][axis];
    const float varying = whole + ((rest + kRounder) - kRounder);
    const float eye = static_cast<float>(frame.camera->eye()[axis].raw) / 256;
    ray.origin[axis] = frame.perspective ? eye : eye + varying / 256;
    ray.direction[axis] = frame.perspective ? varying : static_cast<float>(frame.camera->direction()[axis]);
  }
  return ray;
}

class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  /// Of all that it keeps between frames.
  virtual std::size_t bytes() const = 0;
  /// `gray`: a byte a pixel. `voxels` (may be null): the voxel that each shows, or kNoVoxel.
  virtual void draw(const View& view, std::uint8_t* gray, Voxel* voxels) = 0;
  /// What some rays meet first, as t, infinity where nothing; with `any`, what they meet at all, any t. False
  /// where it is not for single rays.
  virtual bool trace(const std::vector<FloatRay>& rays, bool any, float* t) {
    static_cast<void>(rays);
    static_cast<void>(any);
    static_cast<void>(t);
    return false;
  }
};

/// Every point's box, tested at each pixel centre that it can cover, into a depth buffer.
std::unique_ptr<Peer> make_raster(const std::vector<Voxel>& voxels);
/// The same in integers, exact.
std::unique_ptr<Peer> make_loop(const std::vector<Voxel>& voxels);
/// Packets of 16 rays through Embree's hierarchy over unit boxes; null where it is not installed.
std::unique_ptr<Peer> make_embree(const std::vector<Voxel>& voxels);
/// The same through Embree's own triangles: nine numbers each, in voxels.
std::unique_ptr<Peer> make_embree_triangles(const std::vector<float>& corners);
/// A hierarchical DDA over NanoVDB's active voxels; null where it is not installed.
std::unique_ptr<Peer> make_nanovdb(const std::vector<Voxel>& voxels);
/// An octree of pointers in double precision.
std::unique_ptr<Peer> make_textbook(const std::vector<Voxel>& voxels);

}  // namespace thimble::benchmarks
