// Random rays and random worlds.
#include "support/ray_cases.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace thimble::tests {

using reference::Ray;
using reference::Voxel;

namespace {

constexpr std::int64_t kOneQ8 = 256;

std::int64_t magnitude_of(std::int64_t value) {
  return value < 0 ? -value : value;
}

std::int64_t largest_magnitude(const std::array<std::int64_t, 3>& values) {
  return std::max({magnitude_of(values[0]), magnitude_of(values[1]), magnitude_of(values[2])});
}

bool is_zero(const std::array<std::int64_t, 3>& values) {
  return largest_magnitude(values) == 0;
}

}  // namespace

std::int64_t pick(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  // The remainder favours small numbers by less than one in 2^32 for the ranges used here.
  const std::uint64_t range = static_cast<std::uint64_t>(high - low) + 1;
  return low + static_cast<std::int64_t>(random() % range);
}

// Below, no expression draws two numbers where the language leaves open which is drawn first.

RayLimits full_limits(const Voxel& size) {
  RayLimits limits;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    limits.origin_low_q8[axis] = -4 * kOneQ8 * size[axis];
    limits.origin_high_q8[axis] = 5 * kOneQ8 * size[axis];
  }
  limits.direction = reference::kMaxDirection;
  return limits;
}

bool within(const RayLimits& limits, const Ray& ray) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.origin_q8[axis] < limits.origin_low_q8[axis] ||
        ray.origin_q8[axis] > limits.origin_high_q8[axis] ||
        magnitude_of(ray.direction[axis]) > limits.direction) {
      return false;
    }
  }
  return !is_zero(ray.direction);
}

RayCases::RayCases(std::uint64_t seed, const Voxel& size, const RayLimits& limits, std::vector<Voxel> targets)
    : random_(seed), size_(size), limits_(limits), targets_(std::move(targets)) {}

RayCases::RayCases(std::uint64_t seed, const Voxel& size, std::vector<Voxel> targets)
    : RayCases(seed, size, full_limits(size), std::move(targets)) {}

RayCase RayCases::next() {
  RayCase result;
  const std::int64_t choice = pick(random_, 0, 15);
  if (choice < 3) {
    result = {free_ray(), RayKind::kFree};
  } else if (choice < 6) {
    result = {towards_ray(), RayKind::kTowards};
  } else if (choice < 8) {
    result = {simple_ray(), RayKind::kSimple};
  } else if (choice < 9) {
    result = {in_plane_ray(), RayKind::kInPlane};
  } else if (choice < 10) {
    result = {at_limit_ray(), RayKind::kAtLimit};
  } else if (choice < 13) {
    result = {aimed_ray(false), RayKind::kEdge};
  } else if (choice < 15) {
    result = {aimed_ray(true), RayKind::kCorner};
  } else {
    result = {nudged_ray(), RayKind::kNudged};
  }
  return result;
}

bool RayCases::one_in(std::int64_t n) {
  return pick(random_, 1, n) == 1;
}

std::int64_t RayCases::random_sign() {
  return one_in(2) ? 1 : -1;
}

// 1 .. limit, each power of two as likely as the next.
std::int64_t RayCases::log_uniform(std::int64_t limit) {
  int bits = 0;
  while ((limit >> (bits + 1)) > 0) {
    ++bits;
  }
  const std::int64_t lowest = std::int64_t{1} << pick(random_, 0, bits);
  return pick(random_, lowest, std::min(2 * lowest - 1, limit));
}

std::int64_t RayCases::random_component(std::int64_t limit) {
  const std::int64_t sign = random_sign();
  switch (pick(random_, 0, 15)) {
    case 0:
    case 1:
      return 0;
    case 2:
      return sign;
    case 3:
      return sign * limit;
    default:
      return sign * log_uniform(limit);
  }
}

// Never zero. One in eight has two or three components of equal magnitude.
RayCases::Components RayCases::random_direction(std::int64_t limit) {
  Components direction = {random_component(limit), random_component(limit), random_component(limit)};
  if (one_in(8)) {
    const std::size_t kept = static_cast<std::size_t>(pick(random_, 0, 2));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      direction[axis] = one_in(3) ? direction[axis] : (one_in(2) ? direction[kept] : -direction[kept]);
    }
  }
  if (is_zero(direction)) {
    direction[static_cast<std::size_t>(pick(random_, 0, 2))] = one_in(2) ? limit : -1;
  }
  return direction;
}

// Two in five outside; the others inside, on a lattice plane in each axis with a chance of one in three.
RayCases::Components RayCases::random_origin() {
  Components origin{};
  const bool outside = pick(random_, 0, 4) < 2;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (outside) {
      origin[axis] = pick(random_, limits_.origin_low_q8[axis], limits_.origin_high_q8[axis]);
    } else if (one_in(3)) {
      origin[axis] = kOneQ8 * pick(random_, 0, size_[axis]);
    } else if (one_in(8)) {  // a hair off a lattice plane
      origin[axis] = kOneQ8 * pick(random_, 0, size_[axis]);
      origin[axis] += random_sign();
    } else {
      origin[axis] = pick(random_, 0, kOneQ8 * size_[axis]);
    }
    if (outside && one_in(4)) {
      origin[axis] = origin[axis] / kOneQ8 * kOneQ8;
    }
    origin[axis] = std::clamp(origin[axis], limits_.origin_low_q8[axis], limits_.origin_high_q8[axis]);
  }
  return origin;
}

// A voxel to aim at: half of the time a target, if there are any.
Voxel RayCases::random_voxel() {
  if (!targets_.empty() && one_in(2)) {
    return targets_[static_cast<std::size_t>(
        pick(random_, 0, static_cast<std::int64_t>(targets_.size()) - 1))];
  }
  Voxel voxel{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    voxel[axis] = pick_int(random_, 0, size_[axis] - 1);
  }
  return voxel;
}

// About the direction from `origin` to `point`, its largest component `magnitude`.
RayCases::Components RayCases::scaled_towards(const Components& origin, const Components& point,
                                              std::int64_t magnitude) {
  Components direction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    direction[axis] = point[axis] - origin[axis];
  }
  const std::int64_t largest = largest_magnitude(direction);
  if (largest == 0) {
    return random_direction(limits_.direction);
  }
  for (std::int64_t& component : direction) {
    component = component * magnitude / largest;
  }
  return direction;
}

Ray RayCases::free_ray() {
  return {random_origin(), random_direction(limits_.direction)};
}

Ray RayCases::towards_ray() {
  const Voxel voxel = random_voxel();
  Components point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = kOneQ8 * voxel[axis] + pick(random_, 0, kOneQ8);
  }
  Ray ray;
  ray.origin_q8 = random_origin();
  ray.direction = scaled_towards(ray.origin_q8, point, log_uniform(limits_.direction));
  return ray;
}

Ray RayCases::simple_ray() {
  Ray ray;
  const std::int64_t magnitude = log_uniform(limits_.direction);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ray.origin_q8[axis] = kOneQ8 / 2 * pick(random_, -4, 2 * std::int64_t{size_[axis]} + 4);
    ray.origin_q8[axis] =
        std::clamp(ray.origin_q8[axis], limits_.origin_low_q8[axis], limits_.origin_high_q8[axis]);
    ray.direction[axis] = magnitude * pick(random_, -1, 1);
  }
  if (is_zero(ray.direction)) {
    ray.direction[static_cast<std::size_t>(pick(random_, 0, 2))] = magnitude;
  }
  return ray;
}

Ray RayCases::in_plane_ray() {
  Ray ray = towards_ray();
  const Voxel voxel = random_voxel();
  // The axis that stays free is the one that moves if the other two are fixed.
  const std::size_t free_axis = static_cast<std::size_t>(pick(random_, 0, 2));
  const bool along_edge = one_in(2);
  for (std::size_t turn = 1; turn <= (along_edge ? 2U : 1U); ++turn) {
    const std::size_t axis = (free_axis + turn) % 3;
    ray.origin_q8[axis] = kOneQ8 * (voxel[axis] + pick(random_, 0, 1));
    ray.direction[axis] = 0;
  }
  if (is_zero(ray.direction)) {
    ray.direction[free_axis] = random_sign();
    ray.direction[free_axis] *= log_uniform(limits_.direction);
  }
  return ray;
}

Ray RayCases::at_limit_ray() {
  Ray ray;
  Components point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = limits_.origin_low_q8[axis];
    const std::int64_t high = limits_.origin_high_q8[axis];
    const std::array<std::int64_t, 5> choices = {low, high, low + 1, high - 1, pick(random_, low, high)};
    ray.origin_q8[axis] = choices[static_cast<std::size_t>(pick(random_, 0, 4))];
    point[axis] = pick(random_, 0, kOneQ8 * size_[axis]);
  }
  if (one_in(2)) {
    ray.direction = scaled_towards(ray.origin_q8, point, limits_.direction);
    return ray;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<std::int64_t, 6> choices = {
        0, 1, -1, limits_.direction, -limits_.direction, limits_.direction - 1};
    ray.direction[axis] = choices[static_cast<std::size_t>(pick(random_, 0, 5))];
  }
  if (is_zero(ray.direction)) {
    ray.direction[static_cast<std::size_t>(pick(random_, 0, 2))] = limits_.direction;
  }
  return ray;
}

// Exact by construction: the origin is a lattice point (or a point of a lattice edge) minus a whole number of
// 1/256 steps of the direction, and the direction is then made longer by a whole factor.
Ray RayCases::aimed_ray(bool corner) {
  const Voxel voxel = random_voxel();
  // The edge runs along `along`; the ray has to cross the planes of the other two axes there.
  const std::size_t along = static_cast<std::size_t>(pick(random_, 0, 2));
  Components point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool on_lattice = corner || axis != along;
    point[axis] =
        kOneQ8 * voxel[axis] + (on_lattice ? kOneQ8 * pick(random_, 0, 1) : pick(random_, 1, kOneQ8 - 1));
  }

  Components direction{};
  std::int64_t most_steps = 0;
  if (one_in(2)) {
    // From a random origin straight to the point, in one step or in as many as the components' divisor.
    const Components origin = random_origin();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      direction[axis] = point[axis] - origin[axis];
    }
    const std::int64_t divisor = std::gcd(std::gcd(direction[0], direction[1]), direction[2]);
    for (std::int64_t& component : direction) {
      component = divisor == 0 ? 0 : component / divisor;
    }
    most_steps = divisor;
  }
  if (largest_magnitude(direction) > limits_.direction || most_steps == 0) {
    direction = random_direction(log_uniform(limits_.direction));
    most_steps = -1;
  }
  for (std::size_t turn = 1; turn <= 2; ++turn) {
    std::int64_t& component = direction[(along + turn) % 3];
    if (component == 0) {
      component = random_sign();
      most_steps = -1;
    }
  }
  if (most_steps < 0) {  // as many steps back as the limits of the origin allow
    most_steps = std::int64_t{1} << 30;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t component = direction[axis];
      if (component > 0) {
        most_steps = std::min(most_steps, (point[axis] - limits_.origin_low_q8[axis]) / component);
      } else if (component < 0) {
        most_steps = std::min(most_steps, (limits_.origin_high_q8[axis] - point[axis]) / -component);
      }
    }
    most_steps = most_steps > 0 && !one_in(8) ? log_uniform(most_steps) : most_steps;
  }

  const std::int64_t factor = log_uniform(limits_.direction / largest_magnitude(direction));
  Ray ray;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ray.origin_q8[axis] = point[axis] - most_steps * direction[axis];
    ray.direction[axis] = factor * direction[axis];
  }
  return ray;
}

Ray RayCases::nudged_ray() {
  const Ray ray = aimed_ray(one_in(2));
  Ray nudged = ray;
  const std::size_t axis = static_cast<std::size_t>(pick(random_, 0, 2));
  const bool nudge_origin = one_in(2);
  (nudge_origin ? nudged.origin_q8 : nudged.direction)[axis] += random_sign();
  return within(limits_, nudged) ? nudged : ray;
}

void add_box(const Voxel& low, const Voxel& high, std::vector<Voxel>* voxels) {
  for (int z = low[2]; z < high[2]; ++z) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int x = low[0]; x < high[0]; ++x) {
        voxels->push_back({x, y, z});
      }
    }
  }
}

World make_world(WorldKind kind, const Voxel& size, std::mt19937_64& random) {
  static const std::array<std::string, kWorldKinds> names = {
      "empty", "full", "single", "sparse", "random", "dense", "shell", "checkerboard", "corners"};
  World world;
  world.name = names[static_cast<std::size_t>(kind)] + " " + std::to_string(size[0]) + "x" +
               std::to_string(size[1]) + "x" + std::to_string(size[2]);
  world.size = size;
  const std::int64_t volume = std::int64_t{size[0]} * size[1] * size[2];

  const auto random_voxel = [&] {
    Voxel voxel{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      voxel[axis] = pick_int(random, 0, size[axis] - 1);
    }
    return voxel;
  };

  switch (kind) {
    case WorldKind::kEmpty:
      return world;
    case WorldKind::kSingle:
      world.voxels = {random_voxel()};
      return world;
    case WorldKind::kSparse: {
      const std::int64_t count = pick(random, 1, std::clamp(volume / 8, std::int64_t{1}, std::int64_t{4096}));
      for (std::int64_t i = 0; i < count; ++i) {
        world.voxels.push_back(random_voxel());
      }
      break;
    }
    case WorldKind::kCorners:
      for (int corner = 0; corner < 8; ++corner) {
        world.voxels.push_back({(corner & 1) != 0 ? size[0] - 1 : 0, (corner & 2) != 0 ? size[1] - 1 : 0,
                                (corner & 4) != 0 ? size[2] - 1 : 0});
      }
      break;
    default: {
      if (volume > (std::int64_t{1} << 24)) {
        throw std::invalid_argument("make_world: too large for this kind");
      }
      const std::int64_t density_per_1024 = pick(random, 1, 1023);
      const std::int64_t one_hole_in = std::max(std::int64_t{2}, volume / 4);
      for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
          for (int x = 0; x < size[0]; ++x) {
            const bool wall =
                x == 0 || y == 0 || z == 0 || x == size[0] - 1 || y == size[1] - 1 || z == size[2] - 1;
            const bool solid = kind == WorldKind::kFull ||
                               (kind == WorldKind::kRandom && pick(random, 0, 1023) < density_per_1024) ||
                               (kind == WorldKind::kDense && pick(random, 1, one_hole_in) != 1) ||
                               (kind == WorldKind::kShell && wall) ||
                               (kind == WorldKind::kCheckerboard && (x + y + z) % 2 == 0);
            if (solid) {
              world.voxels.push_back({x, y, z});
            }
          }
        }
      }
      return world;
    }
  }
  // Positions drawn twice, and corners of a world one voxel wide, count once.
  std::sort(world.voxels.begin(), world.voxels.end());
  world.voxels.erase(std::unique(world.voxels.begin(), world.voxels.end()), world.voxels.end());
  return world;
}

}  // namespace thimble::tests
