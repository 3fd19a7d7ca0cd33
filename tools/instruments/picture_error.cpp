#include "instruments/picture_error.h"

#include <algorithm>
#include <cmath>

#include "output/hit_csv.h"
#include "readers/source.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {

TracedPicture trace_picture(const CompactTree& tree, const Camera& camera, const Shading& shading) {
  TracedPicture picture;
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width_px()) * static_cast<std::size_t>(camera.height_px());
  picture.colors.reserve(pixels);
  picture.distances.reserve(pixels);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      if (closest_hit(tree, ray, &hit) != Status::kOk) {
        throw InputError("the rays of this camera cannot be traced");
      }
      picture.colors.push_back(shade(hit, ray, camera, shading));
      const double length =
          std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                     static_cast<double>(ray.direction.z));
      picture.distances.push_back(hit.kind == HitKind::kHit ? hit_t(hit) * length : -1);
    }
  }
  return picture;
}

PictureError picture_error(const TracedPicture& picture, const TracedPicture& reference) {
  PictureError error;
  std::uint64_t both = 0;
  double sum = 0;
  for (std::size_t i = 0; i < picture.colors.size(); ++i) {
    const Rgb8& a = picture.colors[i];
    const Rgb8& b = reference.colors[i];
    const bool hit = picture.distances[i] >= 0;
    const bool expected = reference.distances[i] >= 0;
    error.wrong_px += hit != expected || a.r != b.r || a.g != b.g || a.b != b.b ? 1U : 0U;
    error.silhouette_px += hit != expected ? 1U : 0U;
    if (hit && expected) {
      const double difference = std::abs(picture.distances[i] - reference.distances[i]);
      ++both;
      sum += difference;
      error.depth_max_voxels = std::max(error.depth_max_voxels, difference);
    }
  }
  error.depth_mean_voxels = both == 0 ? 0 : sum / static_cast<double>(both);
  return error;
}

}  // namespace thimble::tools
