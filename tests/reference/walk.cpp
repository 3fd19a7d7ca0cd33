// The walk: from cell to cell along the ray, each decision an exact comparison of fractions.
//
// Times here are s = 256 t, so that origin_q8 + s * direction is the point in 1/256 voxel and the ray passes
// a plane at s = (plane_q8 - origin_q8) / direction: a fraction whose denominator is at most 2^20. Bounds: a
// plane of the grid is at most 2^20 and an origin 2^31, so numerators are below 2^32, and every product below
// is less than 2^54.
#include "reference/reference.h"

namespace thimble::reference {

namespace {

// numerator / denominator, denominator >= 0; 1 / 0 is "never", later than every other time.
struct Time {
  std::int64_t numerator;
  std::int64_t denominator;
};

constexpr Time kNever{1, 0};

bool operator<(const Time& a, const Time& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

bool operator==(const Time& a, const Time& b) {
  return a.numerator * b.denominator == b.numerator * a.denominator;
}

// When the ray is at `plane` (in voxels) of `axis`; `kNever` for a ray that runs parallel to the plane.
Time passes(const Ray& ray, std::size_t axis, std::int64_t plane) {
  const std::int64_t distance_q8 = 256 * plane - ray.origin_q8[axis];
  const std::int64_t direction = ray.direction[axis];
  if (direction == 0) {
    return kNever;
  }
  return direction > 0 ? Time{distance_q8, direction} : Time{-distance_q8, -direction};
}

// When the ray leaves, along one axis, the cells `low` .. `low + side - 1`.
Time leaves(const Ray& ray, std::size_t axis, int low, int side) {
  return passes(ray, axis, ray.direction[axis] > 0 ? low + side : low);
}

// Where the walk is: in `cell` from `time` on.
struct State {
  Voxel cell{};
  Time time{0, 1};
  int axis = -1;   // lowest axis of the planes passed at `time`; -1 where time is 0
  int planes = 0;  // how many were passed at once
};

// The quotient rounded down; divisor > 0.
std::int64_t floor_divide(std::int64_t dividend, std::int64_t divisor) {
  const std::int64_t quotient = dividend / divisor;
  return dividend % divisor < 0 ? quotient - 1 : quotient;
}

// The voxel that the ray is in right after `time`. A coordinate that lies on a plane then belongs to the
// voxel above the plane, except when the ray is coming down through the plane.
State place(const Ray& ray, const Time& time) {
  State state;
  state.time = time;
  const std::int64_t unit = 256 * time.denominator;  // one voxel, in 1 / (256 * denominator) voxel
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t direction = ray.direction[axis];
    const std::int64_t position = ray.origin_q8[axis] * time.denominator + direction * time.numerator;
    std::int64_t index = floor_divide(position, unit);
    if (direction != 0 && index * unit == position) {
      if (direction < 0) {
        --index;
      }
      if (time.numerator > 0) {
        state.axis = state.planes == 0 ? static_cast<int>(axis) : state.axis;
        ++state.planes;
      }
    }
    state.cell[axis] = static_cast<int>(index);
  }
  return state;
}

// When the ray begins to be inside the grid's own half-open box, at 0 at the earliest; `kNever` when it
// spends no positive length there.
Time enters_grid(const Ray& ray, const Voxel& size) {
  Time enter{0, 1};
  Time leave = kNever;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) {
      const std::int64_t origin_q8 = ray.origin_q8[axis];
      if (origin_q8 < 0 || origin_q8 >= std::int64_t{256} * size[axis]) {
        return kNever;
      }
      continue;
    }
    const Time in = passes(ray, axis, ray.direction[axis] > 0 ? 0 : size[axis]);
    const Time out = passes(ray, axis, ray.direction[axis] > 0 ? size[axis] : 0);
    enter = enter < in ? in : enter;
    leave = out < leave ? out : leave;
  }
  return enter < leave ? enter : kNever;
}

// The next plane of each axis, as the time at which the ray passes it.
using NextPlanes = std::array<Time, 3>;

NextPlanes next_planes(const Ray& ray, const Voxel& cell) {
  return {leaves(ray, 0, cell[0], 1), leaves(ray, 1, cell[1], 1), leaves(ray, 2, cell[2], 1)};
}

Time earliest(const std::array<Time, 3>& times) {
  const Time& first = times[1] < times[0] ? times[1] : times[0];
  return times[2] < first ? times[2] : first;
}

// Moves on to the next voxel: through every plane that is passed at the earliest time. At least one component
// of the direction is not zero, so the earliest time is never `kNever`.
void step(const Ray& ray, NextPlanes& next, State& state) {
  state.time = earliest(next);
  state.planes = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (next[axis] == state.time) {
      state.cell[axis] += ray.direction[axis] > 0 ? 1 : -1;
      next[axis].numerator += 256;  // planes lie 256 apart, both ways
      state.axis = state.planes == 0 ? static_cast<int>(axis) : state.axis;
      ++state.planes;
    }
  }
}

// Moves on to the first voxel outside the aligned cube of 2^log2_side voxels a side around the state's voxel.
void leave_cube(const Ray& ray, int log2_side, NextPlanes& next, State& state) {
  const int side = 1 << log2_side;
  std::array<Time, 3> leave{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    leave[axis] = leaves(ray, axis, state.cell[axis] / side * side, side);
  }
  state = place(ray, earliest(leave));
  next = next_planes(ray, state.cell);
}

Hit make_hit(const State& state) {
  return Hit{true, state.cell, state.time.numerator, 256 * state.time.denominator, state.axis};
}

Hit walk_and_count(const BitGrid& grid, const Ray& ray, EmptyBlocks empty_blocks, Statistics& counted) {
  const Time enter = enters_grid(ray, grid.size());
  if (enter == kNever) {
    return Hit{};
  }
  State state = place(ray, enter);
  NextPlanes next = next_planes(ray, state.cell);
  // Bounded: every turn moves at least one coordinate on, none ever turns back, and the grid has an end.
  while (grid.contains(state.cell)) {
    counted.tied_crossings += state.planes > 1 ? 1 : 0;
    counted.corner_crossings += state.planes > 2 ? 1 : 0;
    const int empty = grid.empty_log2_side(state.cell);
    if (empty < 0) {
      counted.tied_hits += state.planes > 1 ? 1 : 0;
      counted.starts_inside += state.axis < 0 ? 1 : 0;
      return make_hit(state);
    }
    if (empty > 0 && empty_blocks == EmptyBlocks::kSkip) {
      leave_cube(ray, empty, next, state);
    } else {
      step(ray, next, state);
    }
    ++counted.steps;
  }
  return Hit{};
}

}  // namespace

Hit walk(const BitGrid& grid, const Ray& ray, Statistics* statistics, EmptyBlocks empty_blocks) {
  check_ray(ray);
  Statistics counted;
  const Hit hit = walk_and_count(grid, ray, empty_blocks, counted);
  if (statistics != nullptr) {
    counted.rays = 1;
    counted.hits = hit.hit ? 1 : 0;
    counted.tied_rays = counted.tied_crossings > 0 ? 1 : 0;
    *statistics += counted;
  }
  return hit;
}

void mark_path(const Ray& ray, const Voxel& size, const Hit& answer, BitGrid* cubes) {
  check_ray(ray);
  const auto cube_of = [](const Voxel& voxel) {
    return Voxel{voxel[0] / kPathCubeSide, voxel[1] / kPathCubeSide, voxel[2] / kPathCubeSide};
  };
  const Time enter = enters_grid(ray, size);
  if (enter == kNever) {
    return;
  }
  State state = place(ray, enter);
  NextPlanes next{};
  const auto is_inside = [&](std::size_t axis) {
    return state.cell[axis] >= 0 && state.cell[axis] < size[axis];
  };
  while (is_inside(0) && is_inside(1) && is_inside(2)) {
    cubes->set(cube_of(state.cell));
    if (answer.hit && cube_of(state.cell) == cube_of(answer.voxel)) {
      return;
    }
    leave_cube(ray, 3, next, state);
  }
}

Statistics& Statistics::operator+=(const Statistics& other) {
  rays += other.rays;
  hits += other.hits;
  starts_inside += other.starts_inside;
  steps += other.steps;
  tied_crossings += other.tied_crossings;
  corner_crossings += other.corner_crossings;
  tied_rays += other.tied_rays;
  tied_hits += other.tied_hits;
  return *this;
}

std::string describe(const Statistics& statistics) {
  return "rays " + std::to_string(statistics.rays) + ", hits " + std::to_string(statistics.hits) +
         " (starting inside " + std::to_string(statistics.starts_inside) +
         ", entered through an edge or corner " + std::to_string(statistics.tied_hits) + "), steps " +
         std::to_string(statistics.steps) + ", tied crossings " + std::to_string(statistics.tied_crossings) +
         " (at corners " + std::to_string(statistics.corner_crossings) + ") on " +
         std::to_string(statistics.tied_rays) + " rays";
}

}  // namespace thimble::reference
