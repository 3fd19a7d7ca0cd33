#include "scene/backdrop.h"

namespace thimble::tools {
namespace {

uint8_t between(uint8_t from, uint8_t to, int32_t part, int32_t whole) {
  return static_cast<uint8_t>((from * (whole - part) + to * part + whole / 2) / whole);
}

}  // namespace

Rgb8 backdrop_color(const Background& background, int32_t y, int32_t height_px) {
  if (background.kind != BackgroundKind::kGradient) {
    return background.kind == BackgroundKind::kColor ? background.color : Rgb8{};
  }
  const int32_t whole = height_px > 1 ? height_px - 1 : 1;
  return {between(kSoftTop.r, kSoftBottom.r, y, whole), between(kSoftTop.g, kSoftBottom.g, y, whole),
          between(kSoftTop.b, kSoftBottom.b, y, whole)};
}

bool meets_ground(const CompactTree& tree, const Ground& ground, const Ray& ray, Vec3Q8* at) {
  const int64_t plane = int64_t{ground.z} * Q8::kOne;
  const int64_t drop = plane - ray.origin.z.raw;
  if (!ground.is_there || ray.direction.z >= 0 || drop >= 0) {
    return false;
  }
  at->z = Q8::from_raw(static_cast<int32_t>(plane));
  for (int axis = 0; axis < 2; ++axis) {
    const int64_t value = ray.origin[axis].raw + ray.direction[axis] * drop / ray.direction.z;
    const int64_t side = int64_t{Q8::kOne} << tree.level();
    if (value < kMinOriginWorlds * side || value > kMaxOriginWorlds * side) {
      return false;
    }
    (*at)[axis] = Q8::from_raw(static_cast<int32_t>(value));
  }
  return true;
}

bool is_near_model(const CompactTree& tree, const Ground& ground, const Vec3Q8& at) {
  const VoxelBox& box = tree.bounds();
  for (int axis = 0; axis < 2; ++axis) {
    const int32_t voxel = at[axis].raw >> Q8::kBits;
    if (voxel < box.low[axis] - ground.reach || voxel > box.high[axis] + ground.reach) {
      return false;
    }
  }
  return true;
}

int64_t closed_at(const RayPoint& entry, uint16_t reach) {
  const int64_t reach_q8 = int64_t{reach} * Q8::kOne;
  const int64_t distance_q8 = int64_t{entry.t_numerator} * kAroundLength * Q8::kOne / entry.t_denominator;
  return distance_q8 < reach_q8 ? (reach_q8 - distance_q8) * 256 / reach_q8 : 0;
}

uint8_t in_shadow(uint8_t share) {
  return static_cast<uint8_t>(share * 160U / 256);
}

uint8_t in_corner(uint8_t share, int64_t closed_sum) {
  const auto closed = static_cast<uint32_t>(closed_sum / static_cast<int64_t>(kAroundCount));
  return static_cast<uint8_t>(share - share * closed * 3 / 4 / 256);
}

bool light_behind(const CompactTree& tree, const Ground& ground, const Ray& ray, uint8_t* share) {
  HitKind kind = HitKind::kMiss;
  *share = kFullShare;
  if (any_hit(tree, ray, &kind) != Status::kOk) {
    return true;
  }
  if (kind == HitKind::kHit) {
    return false;
  }
  Vec3Q8 at;
  if (!meets_ground(tree, ground, ray, &at)) {
    return true;
  }
  if (ground.toward_sun.z > 0 && any_hit(tree, {at, ground.toward_sun}, &kind) == Status::kOk &&
      kind == HitKind::kHit) {
    *share = in_shadow(*share);
  }
  if (is_near_model(tree, ground, at)) {
    int64_t closed = 0;
    for (const Vec3i& direction : kAround) {
      Hit hit;
      if (closest_hit(tree, {at, direction}, &hit) == Status::kOk && hit.kind == HitKind::kHit) {
        closed += closed_at(point_of(hit), ground.reach);
      }
    }
    *share = in_corner(*share, closed);
  }
  return true;
}

uint32_t bright_gray(const GrayCounts& counts, uint64_t part) {
  uint64_t total = 0;
  for (const uint32_t count : counts.of) {
    total += count;
  }
  uint64_t above = 0;
  for (uint32_t gray = 256; total != 0 && gray-- > 0;) {
    above += counts.of[gray];
    if (part * above >= total) {
      return gray == 0 ? 1 : gray;
    }
  }
  return 0;
}

uint32_t exposure_q8(const GrayCounts& counts) {
  const uint32_t gray = bright_gray(counts, 10);
  if (gray == 0) {
    return 256;
  }
  const uint32_t exposure = kExposedGray * 256 * 2 / (3 * gray);
  return exposure < kLeastExposureQ8  ? kLeastExposureQ8
         : exposure > kMostExposureQ8 ? kMostExposureQ8
                                      : exposure;
}

ToneTable tone_table(uint32_t exposure_q8) {
  const bool is_exposed = exposure_q8 != kOwnColorsQ8;
  const uint32_t brightness_q8 = is_exposed ? exposure_q8 : 256;
  const uint32_t knee = is_exposed ? 200 : 255;
  const uint32_t rest = 255 - knee;
  ToneTable table;
  for (uint32_t value = 0; value < 256; ++value) {
    const uint32_t bright = (value * brightness_q8 * 3 + 256) / 512;
    const uint32_t over = bright > knee ? bright - knee : 0;
    table.of[value] = static_cast<uint8_t>(over == 0 ? bright : knee + rest * over / (over + rest));
  }
  return table;
}

}  // namespace thimble::tools
