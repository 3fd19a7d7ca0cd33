#include "scene/backdrop.h"

#include <algorithm>
#include <array>

#include "scene/lit_streams.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// Rays that are traced together: a few for each lane of the widest vectors, little on the stack.
constexpr std::size_t kAtOnce = 256;

// The quadrant of a direction of kAround: bit 0 to smaller x, bit 1 to smaller y.
constexpr unsigned quadrant_of(const Vec3i& direction) {
  return (direction.x < 0 ? 1U : 0U) | (direction.y < 0 ? 2U : 0U);
}

// Of the quadrants above a voxel of the ground, those in which there is anything within reach, by their bits.
class NearQuadrants {
 public:
  NearQuadrants(const LitStreams& streams, std::int32_t reach) : streams_(streams), reach_(reach) {}

  unsigned of(const Vec3i& voxel) {
    if (!is_known_ || voxel != voxel_) {
      is_known_ = true;
      voxel_ = voxel;
      found_ = find(voxel);
    }
    return found_;
  }

 private:
  unsigned find(const Vec3i& voxel) const {
    const std::int32_t beyond = reach_ + 1;
    VoxelBox all{{voxel.x - beyond, voxel.y - beyond, voxel.z},
                 {voxel.x + beyond + 1, voxel.y + beyond + 1, voxel.z + beyond + 1}};
    if (streams_.is_empty(all)) {
      return 0;
    }
    unsigned found = 0;
    for (unsigned quadrant = 0; quadrant < 4; ++quadrant) {
      VoxelBox box = all;
      for (int axis = 0; axis < 2; ++axis) {
        if ((quadrant >> axis & 1U) != 0) {
          box.high[axis] = voxel[axis] + 1;
        } else {
          box.low[axis] = voxel[axis];
        }
      }
      found |= streams_.is_empty(box) ? 0U : 1U << quadrant;
    }
    return found;
  }

  const LitStreams& streams_;
  std::int32_t reach_;
  bool is_known_ = false;
  Vec3i voxel_;
  unsigned found_ = 0;
};

// Shares of what stands near the model: without what it closes off above. At most kAtOnce places.
Status darken_corners(const Look& look, const LitStreams& streams, Span<const Vec3Q8> places,
                      std::uint8_t* const* shares) {
  std::array<Ray, kAtOnce> rays;
  std::array<RayPoint, kAtOnce> entries;
  std::array<std::size_t, kAtOnce> place_of;  // by ray
  std::array<std::int64_t, kAtOnce> closed{};
  std::size_t count = 0;
  const auto trace = [&] {
    const Status status = streams.first_entry_before({rays.data(), count}, {look.ground.reach, kAroundLength},
                                                     {entries.data(), count});
    for (std::size_t ray = 0; ray < count; ++ray) {
      closed[place_of[ray]] +=
          entries[ray].t_denominator == 0 ? 0 : closed_at(entries[ray], look.ground.reach);
    }
    count = 0;
    return status;
  };
  NearQuadrants near(streams, look.ground.reach);
  Status status = Status::kOk;
  for (std::size_t place = 0; place < places.size && status == Status::kOk; ++place) {
    const Vec3Q8& at = places.data[place];
    const unsigned quadrants = near.of({at.x.floor(), at.y.floor(), at.z.floor()});
    for (const Vec3i& direction : kAround) {
      if ((quadrants >> quadrant_of(direction) & 1U) != 0) {
        place_of[count] = place;
        rays[count++] = {at, direction};
      }
    }
    if (count + kAroundCount > kAtOnce) {
      status = trace();
    }
  }
  if (status == Status::kOk) {
    status = trace();
  }
  for (std::size_t place = 0; place < places.size; ++place) {
    *shares[place] = in_corner(*shares[place], closed[place]);
  }
  return status;
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
