#include "scene/backdrop.h"

#include <algorithm>
#include <array>

#include "scene/lit_streams.h"
#include "thimble/trace/trace.h"

namespace thimble::tools {
namespace {

std::uint8_t between(std::uint8_t from, std::uint8_t to, std::int32_t part, std::int32_t whole) {
  return static_cast<std::uint8_t>((from * (whole - part) + to * part + whole / 2) / whole);
}

// Of about one length each, spread over the hemisphere above by the cosine of their angle with the upright: a
// spiral that turns by the golden angle.
constexpr std::array<Vec3i, 32> kAround{
    {{16, 0, 127},    {-20, 19, 125},  {3, -36, 123},  {26, 34, 121},  {-47, -8, 119},  {45, -28, 116},
     {-15, 56, 114},  {-29, -55, 112}, {62, 23, 110},  {-64, 27, 107}, {31, -66, 105},  {23, 73, 102},
     {-69, -40, 100}, {81, -18, 97},   {-50, 70, 95},  {-11, -88, 92}, {70, 59, 89},    {-95, 4, 86},
     {69, -69, 83},   {-5, 100, 80},   {-66, -79, 77}, {104, 14, 73},  {-88, 61, 70},   {24, -107, 66},
     {56, 97, 62},    {-109, -35, 58}, {106, -49, 53}, {-46, 109, 48}, {-41, -114, 42}, {109, 57, 36},
     {-121, 32, 28},  {69, -107, 16}}};
constexpr std::int32_t kAroundLength = 128;

// Of 256: how much of the sky something at that point of a ray closes off; nothing beyond the reach.
std::int64_t closed_at(const RayPoint& entry, std::uint16_t reach) {
  const std::int64_t reach_q8 = std::int64_t{reach} * Q8::kOne;
  const std::int64_t distance_q8 =
      std::int64_t{entry.t_numerator} * kAroundLength * Q8::kOne / entry.t_denominator;
  return std::max<std::int64_t>(0, reach_q8 - distance_q8) * 256 / reach_q8;
}

// The mean of the rays around.
std::uint32_t closed_of(std::int64_t sum) {
  return static_cast<std::uint32_t>(sum / static_cast<std::int64_t>(kAround.size()));
}

// Of 256: how much of the sky the model closes off near `at`, fading with distance.
std::uint32_t closed_above(const CompactTree& tree, const Vec3Q8& at, std::uint16_t reach) {
  std::int64_t closed = 0;
  for (const Vec3i& direction : kAround) {
    Hit hit;
    if (closest_hit(tree, {at, direction}, &hit) == Status::kOk && hit.kind == HitKind::kHit) {
      closed += closed_at(point_of(hit), reach);
    }
  }
  return closed_of(closed);
}

bool is_near(const Vec3Q8& at, const VoxelBox& box, std::int32_t reach) {
  for (int axis = 0; axis < 2; ++axis) {
    const std::int32_t voxel = at[axis].raw >> Q8::kBits;
    if (voxel < box.low[axis] - reach || voxel > box.high[axis] + reach) {
      return false;
    }
  }
  return true;
}

// Where a ray from above meets the ground, if within where rays may start.
bool meets_ground(const CompactTree& tree, const Ray& ray, std::int32_t ground_z, Vec3Q8* at) {
  const std::int64_t plane = std::int64_t{ground_z} * Q8::kOne;
  const std::int64_t drop = plane - ray.origin.z.raw;
  if (ray.direction.z >= 0 || drop >= 0) {
    return false;
  }
  at->z = Q8::from_raw(static_cast<std::int32_t>(plane));
  for (int axis = 0; axis < 2; ++axis) {
    const std::int64_t value = ray.origin[axis].raw + ray.direction[axis] * drop / ray.direction.z;
    const std::int64_t side = std::int64_t{Q8::kOne} << tree.level();
    if (value < kMinOriginWorlds * side || value > kMaxOriginWorlds * side) {
      return false;
    }
    (*at)[axis] = Q8::from_raw(static_cast<std::int32_t>(value));
  }
  return true;
}

}  // namespace

Rgb8 backdrop_color(const Background& background, std::int32_t, std::int32_t y, std::int32_t,
                    std::int32_t height_px) {
  if (background.kind != BackgroundKind::kGradient) {
    return background.kind == BackgroundKind::kColor ? background.color : Rgb8{};
  }
  const std::int32_t whole = std::max(1, height_px - 1);
  return {between(kSoftTop.r, kSoftBottom.r, y, whole), between(kSoftTop.g, kSoftBottom.g, y, whole),
          between(kSoftTop.b, kSoftBottom.b, y, whole)};
}

namespace {

// What is left of the light on the ground: in the sun's shadow, and where so much of the sky is closed off.
std::uint32_t in_shadow(std::uint32_t light) {
  return light * 160 / 256;
}
std::uint32_t in_corner(std::uint32_t light, std::uint32_t closed) {
  return light - light * closed * 3 / 4 / 256;
}

// Rays that are traced together: a few for each lane of the widest vectors, little on the stack.
constexpr std::size_t kAtOnce = 256;
constexpr std::size_t kPlacesAtOnce = kAtOnce / kAround.size();

// Shares of what stands near the model: without what it closes off above.
Status darken_corners(const Look& look, const LitStreams& streams, Span<const Vec3Q8> places,
                      std::uint8_t* const* shares) {
  std::array<Ray, kAtOnce> rays;
  std::array<RayPoint, kAtOnce> entries;
  for (std::size_t first = 0; first < places.size; first += kPlacesAtOnce) {
    const std::size_t count = std::min(kPlacesAtOnce, places.size - first);
    std::size_t ray = 0;
    for (std::size_t i = first; i < first + count; ++i) {
      for (const Vec3i& direction : kAround) {
        rays[ray++] = {places.data[i], direction};
      }
    }
    const Status status =
        streams.first_entry_before({rays.data(), ray}, {look.reach, kAroundLength}, {entries.data(), ray});
    if (status != Status::kOk) {
      return status;
    }
    const RayPoint* entry = entries.data();
    for (std::size_t i = first; i < first + count; ++i) {
      std::int64_t closed = 0;
      for (std::size_t around = 0; around < kAround.size(); ++around, ++entry) {
        closed += entry->t_denominator == 0 ? 0 : closed_at(*entry, look.reach);
      }
      *shares[i] = static_cast<std::uint8_t>(in_corner(*shares[i], closed_of(closed)));
    }
  }
  return Status::kOk;
}

// Of at most kAtOnce rays. On an error the shares are not to be used.
Status find_in_vectors(const CompactTree& tree, const Look& look, const LitStreams& streams,
                       Span<const Ray> rays, std::uint8_t* shares) {
  std::array<std::uint8_t, kAtOnce> hits;
  Status status = streams.any_hit(rays, {hits.data(), rays.size});
  std::array<Vec3Q8, kAtOnce> places;
  std::array<std::uint8_t*, kAtOnce> lights;
  std::size_t count = 0;  // that meet the ground
  for (std::size_t i = 0; i < rays.size; ++i) {
    shares[i] = hits[i] != 0 ? kNothingBehind : kFullShare;
    if (hits[i] == 0 && look.has_ground && meets_ground(tree, rays.data[i], look.ground_z, &places[count])) {
      lights[count++] = shares + i;
    }
  }
  if (status == Status::kOk && look.toward_sun.z > 0) {
    std::array<Ray, kAtOnce> toward_sun;
    for (std::size_t i = 0; i < count; ++i) {
      toward_sun[i] = {places[i], look.toward_sun};
    }
    status = streams.any_hit({toward_sun.data(), count}, {hits.data(), count});
    for (std::size_t i = 0; i < count; ++i) {
      *lights[i] = static_cast<std::uint8_t>(hits[i] != 0 ? in_shadow(*lights[i]) : *lights[i]);
    }
  }
  std::size_t near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_near(places[i], tree.bounds(), look.reach)) {
      places[near] = places[i];
      lights[near++] = lights[i];
    }
  }
  return status != Status::kOk ? status : darken_corners(look, streams, {places.data(), near}, lights.data());
}

}  // namespace

void find_light_behind(const CompactTree& tree, const Look& look, const LitStreams* streams,
                       Span<const Ray> rays, std::uint8_t* shares) {
  if (!look.has_backdrop) {
    std::fill(shares, shares + rays.size, kNothingBehind);
    return;
  }
  for (std::size_t first = 0; first < rays.size; first += kAtOnce) {
    const Span<const Ray> some{rays.data + first, std::min(kAtOnce, rays.size - first)};
    if (streams != nullptr && find_in_vectors(tree, look, *streams, some, shares + first) == Status::kOk) {
      continue;
    }
    for (std::size_t i = 0; i < some.size; ++i) {
      if (!light_behind(tree, look, some.data[i], shares + first + i)) {
        shares[first + i] = kNothingBehind;
      }
    }
  }
}

bool light_behind(const CompactTree& tree, const Look& look, const Ray& ray, std::uint8_t* share) {
  HitKind kind = HitKind::kMiss;
  *share = kFullShare;
  if (any_hit(tree, ray, &kind) != Status::kOk) {
    return true;
  }
  if (kind == HitKind::kHit) {
    return false;
  }
  Vec3Q8 at;
  if (!look.has_ground || !meets_ground(tree, ray, look.ground_z, &at)) {
    return true;
  }
  std::uint32_t light = kFullShare;
  if (look.toward_sun.z > 0 && any_hit(tree, {at, look.toward_sun}, &kind) == Status::kOk &&
      kind == HitKind::kHit) {
    light = in_shadow(light);
  }
  if (is_near(at, tree.bounds(), look.reach)) {
    light = in_corner(light, closed_above(tree, at, look.reach));
  }
  *share = static_cast<std::uint8_t>(light);
  return true;
}

}  // namespace thimble::tools
