#include "wide/lit/open_space.h"

#include <algorithm>

#include "thimble/light/host/optics.h"

namespace thimble::wide {
namespace {

constexpr int32_t kPatch = 4;  // voxels
// In rays: what looking at a patch costs, and how much of it may be in vain.
constexpr int32_t kCost = 12;
constexpr int32_t kMostCredit = 1024;

}  // namespace

OpenSpace::OpenSpace(const RayMap& map, const Occlusion& occlusion, uint32_t around)
    : map_(map), around_(around), credit_(map.cells() == nullptr ? 0 : kMostCredit) {
  int32_t across = 0;
  int32_t along = 0;
  for (uint32_t n = 0; n < around; ++n) {
    const PatternDirection& way = kOcclusionPattern[n];
    across = std::max({across, int32_t{way.x}, -int32_t{way.x}, int32_t{way.y}, -int32_t{way.y}});
    along = std::max(along, int32_t{way.z});
  }
  across_ = across * occlusion.reach / kOcclusionLength + 1;
  along_ = along * occlusion.reach / kOcclusionLength + 1;
}

unsigned OpenSpace::look_up(const Vec3Q8& at, uint8_t face) {
  const int axis = face / 2;
  Vec3i corner;
  for (int a = 0; a < 3; ++a) {
    const int32_t voxel = at[a].raw >> 8;
    corner[a] = a == axis ? voxel : voxel & ~(kPatch - 1);
  }
  // Coordinates have 13 bits. No patch is 0.
  const uint64_t patch = static_cast<uint64_t>(corner.x) << 46 | static_cast<uint64_t>(corner.y) << 33 |
                         static_cast<uint64_t>(corner.z) << 20 | (uint64_t{face} + 1) << 4;
  uint64_t& known = known_[(patch * 0x9E3779B97F4A7C15U) >> (64 - kKnownBits)];
  if ((known & ~uint64_t{kAll}) != patch) {
    known = patch | look(corner, face);
    credit_ -= kCost;
  }
  const auto rays = static_cast<unsigned>(known & kAll);
  const auto spared = static_cast<int32_t>((4 - static_cast<unsigned>(__builtin_popcount(rays))) * around_);
  credit_ = std::min(credit_ + spared / 4, kMostCredit);
  return rays;
}

// Ray n goes to larger coordinates on the next axis for n % 4 = 0 and 3, on the one after it for 0 and 1.
unsigned OpenSpace::look(const Vec3i& corner, uint8_t face) const {
  const int axis = face / 2;
  const int next = axis == 2 ? 0 : axis + 1;
  const int last = axis == 0 ? 2 : axis - 1;
  VoxelBox all;
  all.low[axis] = corner[axis] - (face % 2 == 0 ? along_ : 0);
  all.high[axis] = corner[axis] + (face % 2 == 0 ? 0 : along_);
  for (const int a : {next, last}) {
    all.low[a] = corner[a] - across_;
    all.high[a] = corner[a] + kPatch + across_;
  }
  if (map_.is_empty(all)) {
    return 0;
  }
  unsigned rays = 0;
  for (unsigned n = 0; n < 4; ++n) {
    VoxelBox box = all;
    const auto cut = [&](int a, bool is_up) {
      (is_up ? box.low : box.high)[a] = corner[a] + (is_up ? 0 : kPatch);
    };
    cut(next, n == 0 || n == 3);
    cut(last, n < 2);
    rays |= map_.is_empty(box) ? 0U : 1U << n;
  }
  return rays;
}

}  // namespace thimble::wide
