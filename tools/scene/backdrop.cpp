#include "scene/backdrop.h"

#include <algorithm>
#include <array>

#include "scene/lit_streams.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// Rays that are traced together: a few for each lane of the widest vectors, little on the stack.
constexpr std::size_t kAtOnce = 256;
constexpr std::size_t kPlacesAtOnce = kAtOnce / kAroundCount;

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
    const Status status = streams.first_entry_before({rays.data(), ray}, {look.ground.reach, kAroundLength},
                                                     {entries.data(), ray});
    if (status != Status::kOk) {
      return status;
    }
    const RayPoint* entry = entries.data();
    for (std::size_t i = first; i < first + count; ++i) {
      std::int64_t closed = 0;
      for (std::size_t around = 0; around < kAroundCount; ++around, ++entry) {
        closed += entry->t_denominator == 0 ? 0 : closed_at(*entry, look.ground.reach);
      }
      *shares[i] = in_corner(*shares[i], closed);
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
    if (hits[i] == 0 && meets_ground(tree, look.ground, rays.data[i], &places[count])) {
      lights[count++] = shares + i;
    }
  }
  if (status == Status::kOk && look.ground.toward_sun.z > 0) {
    std::array<Ray, kAtOnce> toward_sun;
    for (std::size_t i = 0; i < count; ++i) {
      toward_sun[i] = {places[i], look.ground.toward_sun};
    }
    status = streams.any_hit({toward_sun.data(), count}, {hits.data(), count});
    for (std::size_t i = 0; i < count; ++i) {
      *lights[i] = hits[i] != 0 ? in_shadow(*lights[i]) : *lights[i];
    }
  }
  std::size_t near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_near_model(tree, look.ground, places[i])) {
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
      if (!light_behind(tree, look.ground, some.data[i], shares + first + i)) {
        shares[first + i] = kNothingBehind;
      }
    }
  }
}

}  // namespace thimble::tools
