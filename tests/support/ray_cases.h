/// Random rays and random worlds, chosen to be hard: what every engine is held to the reference with.
///
/// The numbers come from `std::mt19937_64` alone, not from the library's distributions, so that a seed
/// printed by one compiler's build means the same rays in another's.
#pragma once

#include <random>

#include "reference/reference.h"
#include "support/counts.h"

namespace thimble::tests {

/// A uniformly random integer of low .. high, both included.
std::int64_t pick(std::mt19937_64& random, std::int64_t low, std::int64_t high);
inline int pick_int(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return static_cast<int>(pick(random, low, high));
}

/// What the rays may be, both ends included. An arithmetic path with smaller limits passes its own.
struct RayLimits {
  std::array<std::int64_t, 3> origin_low_q8{};   ///< in 1/256 voxel
  std::array<std::int64_t, 3> origin_high_q8{};  ///< in 1/256 voxel
  std::int64_t direction = 0;                    ///< largest magnitude of a component
};

/// All that the product accepts: origins from -4 to 5 world sizes, directions of 20 bits.
RayLimits full_limits(const reference::Voxel& size);

/// Whether a ray is within the limits and its direction is not zero.
bool within(const RayLimits& limits, const reference::Ray& ray);

enum class RayKind {
  kFree,     ///< any origin, any direction
  kTowards,  ///< from anywhere to a random point of the world or of a target
  kSimple,   ///< components -1, 0 or 1 times one magnitude, from multiples of half a voxel
  kInPlane,  ///< runs within one or two lattice planes (face and edge rays)
  kAtLimit,  ///< origin and direction at their limits
  kEdge,     ///< aimed: passes exactly through a lattice edge, across it
  kCorner,   ///< aimed: passes exactly through a lattice corner
  kNudged,   ///< an aimed ray with one of its six numbers off by one
};
inline constexpr std::size_t kRayKinds = 8;

struct RayCase {
  reference::Ray ray;
  RayKind kind = RayKind::kFree;

  /// Whether the ray was aimed at a lattice edge or corner, which it meets exactly at a t >= 0.
  bool aimed() const { return kind == RayKind::kEdge || kind == RayKind::kCorner; }
};

/// An endless sequence of rays for a world of `size` voxels; 5 of 16 are aimed. Direction components are
/// zero, one, at the limit, or log-uniform in magnitude; some rays have equal components. Origins are inside,
/// on faces, edges and corners of voxels and of the world, outside, and at the limits.
class RayCases {
 public:
  /// `targets`, when given, are voxels that half of the rays seek, so that small solids in large worlds are
  /// met too.
  RayCases(std::uint64_t seed, const reference::Voxel& size, const RayLimits& limits,
           std::vector<reference::Voxel> targets = {});
  RayCases(std::uint64_t seed, const reference::Voxel& size, std::vector<reference::Voxel> targets = {});

  RayCase next();

 private:
  using Components = std::array<std::int64_t, 3>;

  bool one_in(std::int64_t n);
  std::int64_t random_sign();
  std::int64_t log_uniform(std::int64_t limit);
  std::int64_t random_component(std::int64_t limit);
  Components random_direction(std::int64_t limit);
  Components random_origin();
  reference::Voxel random_voxel();
  Components scaled_towards(const Components& origin, const Components& point, std::int64_t magnitude);
  reference::Ray free_ray();
  reference::Ray towards_ray();
  reference::Ray simple_ray();
  reference::Ray in_plane_ray();
  reference::Ray at_limit_ray();
  reference::Ray aimed_ray(bool corner);
  reference::Ray nudged_ray();

  std::mt19937_64 random_;
  reference::Voxel size_;
  RayLimits limits_;
  std::vector<reference::Voxel> targets_;
};

enum class WorldKind {
  kEmpty,
  kFull,
  kSingle,        ///< one voxel
  kSparse,        ///< a few, at most one in eight
  kRandom,        ///< any density
  kDense,         ///< full but for a few
  kShell,         ///< the six walls
  kCheckerboard,  ///< every second voxel: all edges and corners are between solid and empty
  kCorners,       ///< the eight corners
};
inline constexpr std::size_t kWorldKinds = 9;

struct World {
  std::string name;
  reference::Voxel size{};
  std::vector<reference::Voxel> voxels;  ///< each once
};

/// The voxels of low .. high, the last not included, behind those that are there.
void add_box(const reference::Voxel& low, const reference::Voxel& high,
             std::vector<reference::Voxel>* voxels);

/// A random world. Any size will do for kEmpty, kSingle, kSparse (at most 4096 voxels) and kCorners; the
/// others look at every voxel and throw `std::invalid_argument` above 2^24.
World make_world(WorldKind kind, const reference::Voxel& size, std::mt19937_64& random);

}  // namespace thimble::tests
