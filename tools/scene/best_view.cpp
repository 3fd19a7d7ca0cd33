#include "scene/best_view.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "readers/source.h"
#include "scene/workers.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

constexpr std::array<ViewAngles, 8> kCandidates{
    {{-35, 25}, {35, 25}, {-35, 40}, {35, 40}, {-145, 25}, {145, 25}, {-145, 40}, {145, 40}}};
constexpr std::int32_t kWidth = 96;
constexpr std::int32_t kHeight = 72;

// How many planes of faces, each in its material, a camera sees.
std::size_t planes_seen(const CompactTree& tree, const Camera& camera) {
  std::vector<std::uint32_t> planes;
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      if (closest_hit(tree, ray, &hit) != Status::kOk || hit.kind != HitKind::kHit) {
        continue;
      }
      const Face face = face_of(hit, ray.direction);
      // 12 bits of coordinate, 8 of material, 3 of face.
      planes.push_back(static_cast<std::uint32_t>(hit.voxel[face.axis]) << 11 |
                       static_cast<std::uint32_t>(hit.material) << 3 |
                       static_cast<std::uint32_t>(2 * face.axis + (face.negative ? 0 : 1)));
    }
  }
  std::sort(planes.begin(), planes.end());
  return static_cast<std::size_t>(std::unique(planes.begin(), planes.end()) - planes.begin());
}

}  // namespace

ViewAngles best_angles(const SceneShape& shape) {
  if (shape.tree == nullptr || shape.corners.empty()) {
    return kCandidates[0];
  }
  std::array<std::optional<std::size_t>, kCandidates.size()> seen{};
  each_task(kCandidates.size(), shape.threads, [&](std::size_t i, std::size_t) {
    ViewWishes wishes;
    wishes.width_px = kWidth;
    wishes.height_px = kHeight;
    wishes.side = NamedView::kIso;
    wishes.onward = {kCandidates[i].turn - angles_of(NamedView::kIso).turn,
                     kCandidates[i].tilt - angles_of(NamedView::kIso).tilt};
    wishes.fov_degrees = kPictureFov;
    try {
      seen[i] = planes_seen(*shape.tree, frame_shape(wishes, shape).camera);
    } catch (const InputError&) {
      // A side from which this world cannot be seen whole.
    }
  });
  std::size_t best = 0;
  std::size_t most = 0;
  std::size_t front = 0;  // the most of the views from there
  for (std::size_t i = 0; i < kCandidates.size(); ++i) {
    if (!seen[i]) {
      continue;
    }
    const bool from_behind = i >= kCandidates.size() / 2;
    if (from_behind ? 2 * *seen[i] > 3 * front && *seen[i] > most : *seen[i] > most) {
      best = i;
      most = *seen[i];
    }
    front = from_behind ? front : most;
  }
  return kCandidates[best];
}

}  // namespace thimble::tools
