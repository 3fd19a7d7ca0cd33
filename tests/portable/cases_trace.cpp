// What holds for every ray: the answer of a brute force over few voxels, limits, statuses, visits, materials,
// merged blocks.
#include "portable/groups.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

constexpr Width kWidths[] = {Width::k64, Width::k32, Width::kAuto};
constexpr uint32_t kVoxels = 24;
// A pool of that many single voxels, and a list of them.
constexpr uint32_t cloud_bytes(int level) {
  return scene_bytes(level, kVoxels * static_cast<uint32_t>(level)) + kVoxels * 12 + 8;
}

// kVoxels voxels anywhere in all three structures, and their list.
Span<Vec3i> make_cloud(Check& check, int level, uint32_t seed) {
  const Span<Vec3i> voxels = check.take<Vec3i>(kVoxels);
  const int32_t side = int32_t{1} << level;
  if (voxels.size != kVoxels || !make_grid(check, {side, side, side}) ||
      !make_pool(check, kVoxels * static_cast<uint32_t>(level), level)) {
    return {};
  }
  Random random{seed};
  for (Vec3i& voxel : voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      voxel[axis] = random.below(side);
    }
    if (check.world.pool.insert(voxel) != Status::kOk || check.world.grid.set(voxel) != Status::kOk) {
      return {};
    }
  }
  return make_compact(check) ? voxels : Span<Vec3i>{};
}

// A number of t, with a positive denominator: below 2^23 over below 2^29.
struct Fraction {
  int32_t numerator = 0;
  int32_t denominator = 1;
};
bool less(const Fraction& a, const Fraction& b) {
  return int64_t{a.numerator} * b.denominator < int64_t{b.numerator} * a.denominator;
}

// Where the ray enters one voxel: false when it spends no length in it. The definition of ray.h, nothing
// else.
bool enters(const Vec3i& voxel, const Ray& ray, Fraction* entry, int* axis_entered) {
  Fraction in;
  Fraction out;
  bool bounded = false;
  int entered = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = 256 * voxel[axis] - ray.origin[axis].raw;
    const int32_t high = low + 256;
    const int32_t along = ray.direction[axis];
    if (along == 0) {
      if (low > 0 || high <= 0) {
        return false;
      }
      continue;
    }
    const int32_t size = 256 * (along < 0 ? -along : along);
    const Fraction from{along > 0 ? low : -high, size};
    const Fraction to{along > 0 ? high : -low, size};
    if (less(in, from)) {
      in = from;
      entered = axis;
    }
    if (!bounded || less(to, out)) {
      out = to;
      bounded = true;
    }
  }
  *entry = in;
  *axis_entered = entered;
  return less(in, out);
}

// The first of `voxels` along the ray, into `check.hit`.
void brute_force(Check& check, Span<const Vec3i> voxels, const Ray& ray) {
  Hit& best = check.hit;
  best = Hit{};
  Fraction first;
  for (const Vec3i& voxel : voxels) {
    Fraction entry;
    int axis = -1;
    if (enters(voxel, ray, &entry, &axis) && (best.kind == HitKind::kMiss || less(entry, first))) {
      first = entry;
      best.kind = HitKind::kHit;
      best.voxel = voxel;
      best.axis = static_cast<int8_t>(axis);
      best.t_numerator = entry.numerator;
      best.t_denominator = entry.denominator;
    }
  }
}

// How origins and directions are drawn.
enum Family : int { kLattice, kSmall, kAnywhere, kAxes, kFarAway, kLong, kFamilies };

Ray random_ray(Random& random, Family family, int level) {
  const int32_t side = 256 << level;
  Vec3i origin;
  Vec3i direction;
  do {
    for (int axis = 0; axis < 3; ++axis) {
      switch (family) {
        case kLattice:  // from lattice points, through lattice points
          origin[axis] = 256 * (random.below((1 << level) + 5) - 2);
          direction[axis] = random.below(5) - 2;
          break;
        case kSmall:  // from halves of voxels
          origin[axis] = 128 * (random.below((2 << level) + 9) - 4);
          direction[axis] = random.below(15) - 7;
          break;
        case kAxes:  // one component or two
          origin[axis] = 64 * (random.below((4 << level) + 9) - 4);
          direction[axis] = random.below(2) == 0 ? 0 : random.below(601) - 300;
          break;
        case kFarAway:
          origin[axis] = random.below(9 * side >> 4) * 16 - 4 * side;
          direction[axis] = random.below(side) - origin[axis];
          break;
        case kLong:
          origin[axis] = random.below(2 * side) - side / 2;
          direction[axis] = (random.below(8191) - 4095) * 256;
          direction[axis] += random.below(256);
          break;
        default:
          origin[axis] = random.below(2 * side) - side / 2;
          direction[axis] = random.below(4001) - 2000;
          break;
      }
    }
  } while (direction == Vec3i{});
  return ray_q8(origin, direction);
}

// Rays of one family in a cloud of voxels, against the brute force.
void against_brute_force(Check& check, int family) {
  constexpr int level = 3;
  const Span<Vec3i> voxels = make_cloud(check, level, 0x9E3779B9U + static_cast<uint32_t>(family));
  THIMBLE_REQUIRE(voxels.size == kVoxels);
  Random random{77U + static_cast<uint32_t>(family)};
  int hits = 0;
  int narrow = 0;
  for (int i = 0; i < 100; ++i) {
    const Ray ray = random_ray(random, static_cast<Family>(family), level);
    brute_force(check, voxels, ray);
    const Hit wanted = check.hit;
    check.note(ray);
    hits += wanted.kind == HitKind::kHit ? 1 : 0;
    for (const Width width : kWidths) {
      if (width == Width::k32 && !accepts_32(ray, level)) {
        continue;
      }
      narrow += width == Width::k32 ? 1 : 0;
      check.options.width = width;
      for (int structure = 0; structure < 3; ++structure) {
        THIMBLE_REQUIRE_OK(closest(check, structure, ray, check.options));
        THIMBLE_REQUIRE(same_hit(check.hit, wanted));
        check.note(check.hit);
      }
    }
  }
  THIMBLE_CHECK(hits >= 5);
  THIMBLE_CHECK(family == kLong ? narrow < 100 : narrow > 50);
}

// One voxel at (4, 4, 4) in a world of 8.
constexpr RayScene::Box kOneBox[] = {{{4, 4, 4}, {5, 5, 5}}};
constexpr RayScene kOne = {3, 1, 8, kOneBox};
constexpr RayScene::Box kFullBox[] = {{{0, 0, 0}, {8, 8, 8}}};
constexpr RayScene kFull = {3, 1, 8, kFullBox};
constexpr RayScene kEmpty = {3, 0, 1, nullptr};
constexpr uint32_t kOneBytes = scene_bytes(3, 8);

// A ray that must be refused, in every structure and by both functions: nothing is written.
void refuse(Check& check, const Ray& ray, Status wanted) {
  for (const Width width : kWidths) {
    check.options.width = width;
    for (int structure = 0; structure < 3; ++structure) {
      check.hit = Hit{};
      check.hit.visits = 77;
      THIMBLE_EQUAL(closest(check, structure, ray, check.options), wanted);
      THIMBLE_EQUAL(check.hit.visits, 77U);
      HitKind kind = HitKind::kStepLimit;
      uint32_t visits = 78;
      THIMBLE_EQUAL(any(check, structure, ray, &kind, &visits, check.options), wanted);
      THIMBLE_EQUAL(visits, 78U);
      THIMBLE_EQUAL(kind, HitKind::kStepLimit);
    }
  }
}

void origin_beyond(Check& check, int axis) {
  THIMBLE_REQUIRE(build(check, kFull));
  constexpr int32_t kBeyonds[] = {-4 * 2048 - 1, 5 * 2048 + 1, INT32_MIN, INT32_MAX};
  for (const int32_t beyond : kBeyonds) {
    Vec3i from{256, 256, 256};
    from[axis] = beyond;
    refuse(check, ray_q8(from, {1, 1, 1}), Status::kOutOfRange);
  }
}
void direction_beyond(Check& check, int axis) {
  THIMBLE_REQUIRE(build(check, kFull));
  constexpr int32_t kBeyonds[] = {-kMaxDirection - 1, kMaxDirection + 1, INT32_MIN, INT32_MAX};
  for (const int32_t beyond : kBeyonds) {
    Vec3i direction{1, 1, 1};
    direction[axis] = beyond;
    refuse(check, ray_q8({256, 256, 256}, direction), Status::kOutOfRange);
  }
}

// Away from the world and past it, on each axis: no node is read.
void no_visit(Check& check, int axis) {
  THIMBLE_REQUIRE(build(check, kFull));
  for (int structure = 0; structure < 3; ++structure) {
    for (int side = 0; side < 2; ++side) {
      Vec3i from{1100, 1100, 1100};
      Vec3i direction{3, 5, 7};
      from[axis] = side == 0 ? -128 : 2048 + 128;
      direction[axis] = side == 0 ? -11 : 11;
      THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8(from, direction), check.options));
      THIMBLE_EQUAL(check.hit.kind, HitKind::kMiss);
      THIMBLE_EQUAL(check.hit.visits, 0U);
      direction = {};
      direction[(axis + 1) % 3] = 1;
      THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8(from, direction), check.options));
      THIMBLE_EQUAL(check.hit.visits, 0U);
    }
  }
}

// A limit of 0, 1, ... visits: the answer from the visits that it takes on, kStepLimit before.
void step_limit(Check& check, int structure) {
  const Span<Vec3i> voxels = make_cloud(check, 3, 5);
  THIMBLE_REQUIRE(voxels.size == kVoxels);
  Random random{6};
  for (int i = 0; i < 12; ++i) {
    const Ray ray = random_ray(random, kAnywhere, 3);
    check.options = {};
    THIMBLE_REQUIRE_OK(closest(check, structure, ray, check.options));
    const HitKind wanted = check.hit.kind;
    const uint32_t visits = check.hit.visits;
    for (uint32_t limit = 0; limit <= visits + 1; ++limit) {
      check.options.max_visits = limit;
      THIMBLE_REQUIRE_OK(closest(check, structure, ray, check.options));
      THIMBLE_EQUAL(check.hit.kind, limit < visits ? HitKind::kStepLimit : wanted);
      THIMBLE_EQUAL(check.hit.visits, limit < visits ? limit : visits);
      HitKind kind = HitKind::kMiss;
      uint32_t any_visits = 0;
      THIMBLE_REQUIRE_OK(any(check, structure, ray, &kind, &any_visits, check.options));
      THIMBLE_EQUAL(kind, check.hit.kind);
      THIMBLE_EQUAL(any_visits, check.hit.visits);
    }
  }
}

// The world and the ray moved by whole voxels: the hit moves along.
void shifted(Check& check, int axis) {
  for (int32_t shift = 0; shift < 7; shift += 3) {
    check.arena.rewind(0);
    THIMBLE_REQUIRE(make_pool(check, 16, 4));
    Vec3i at{2, 3, 4};
    at[axis] += shift;
    THIMBLE_REQUIRE_OK(check.world.pool.insert(at));
    Vec3i from{-300, 100, 200};
    from[axis] += 256 * shift;
    THIMBLE_REQUIRE_OK(closest(check, 1, ray_q8(from, {256, 217, 261}), check.options));
    THIMBLE_EQUAL(check.hit.kind, HitKind::kHit);
    THIMBLE_EQUAL(check.hit.voxel, at);
    THIMBLE_EQUAL(check.hit.axis, 0);
    THIMBLE_EQUAL(check.hit.t_numerator, 812);
  }
}

// A voxel in each corner of the largest world, seen along its edges from as far as a ray may start.
void along_edges(Check& check, int axis) {
  constexpr int32_t kLast = (1 << kMaxLevel) - 1;
  THIMBLE_REQUIRE(make_pool(check, 89, kMaxLevel));
  for (int32_t corner = 0; corner < 8; ++corner) {
    THIMBLE_REQUIRE_OK(
        check.world.pool.insert({(corner & 1) * kLast, (corner >> 1 & 1) * kLast, (corner >> 2) * kLast}));
  }
  THIMBLE_REQUIRE(make_compact(check));
  for (int32_t corner = 0; corner < 8; ++corner) {
    const Vec3i voxel{(corner & 1) * kLast, (corner >> 1 & 1) * kLast, (corner >> 2) * kLast};
    const bool upper = voxel[axis] != 0;
    Vec3i from{256 * voxel.x, 256 * voxel.y, 256 * voxel.z};
    from[axis] = (upper ? 5 : -4) * 256 * (kLast + 1);
    Vec3i direction;
    direction[axis] = upper ? -1 : 1;
    for (int structure = 1; structure < 3; ++structure) {
      THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8(from, direction), check.options));
      THIMBLE_EQUAL(check.hit.voxel, voxel);
      THIMBLE_EQUAL(check.hit.axis, axis);
      THIMBLE_EQUAL(check.hit.t_numerator, 4 * 256 * (kLast + 1));
      THIMBLE_EQUAL(check.hit.t_denominator, 256);
    }
  }
}

// Two voxels far apart, coarsened to one node: the whole world is one merged block.
void merged_world(Check& check, int) {
  THIMBLE_REQUIRE(make_pool(check, 16, 3));
  THIMBLE_REQUIRE_OK(check.world.pool.insert({0, 0, 0}, 3));
  THIMBLE_REQUIRE_OK(check.world.pool.insert({7, 7, 7}, 4));
  THIMBLE_REQUIRE_OK(check.world.pool.coarsen_to(1));
  THIMBLE_REQUIRE(make_compact(check));
  for (int structure = 1; structure < 3; ++structure) {
    THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8({1100, 1100, 3072}, {0, 0, -2}), check.options));
    THIMBLE_EQUAL(check.hit.kind, HitKind::kHit);
    THIMBLE_EQUAL(check.hit.voxel, (Vec3i{0, 0, 0}));
    THIMBLE_EQUAL(check.hit.block_level, 3);
    THIMBLE_EQUAL(check.hit.material, 3);
    THIMBLE_EQUAL(check.hit.axis, 2);
    THIMBLE_EQUAL(check.hit.t_numerator, 1024);
    THIMBLE_EQUAL(check.hit.t_denominator, 512);
  }
}

constexpr Case kCases[] = {
    {"random rays -> the brute force's answer, in every structure and width", cloud_bytes(3),
     against_brute_force, 0, "family", 6},
    {"no direction -> bad argument, the hit untouched", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kOne));
       refuse(check, ray_q8({256, 256, 256}, {0, 0, 0}), Status::kBadArgument);
     }},
    {"origin beyond the limits -> out of range, the hit untouched", kOneBytes, origin_beyond, 0, "axis", 3},
    {"direction beyond the limits -> out of range, the hit untouched", kOneBytes, direction_beyond, 0, "axis",
     3},
    {"check_ray: levels 0 and 13 -> out of range", 0,
     [](Check& check, int) {
       const Ray ray = ray_q8({0, 0, 0}, {1, 0, 0});
       THIMBLE_EQUAL(check_ray(ray, 0), Status::kOutOfRange);
       THIMBLE_EQUAL(check_ray(ray, 13), Status::kOutOfRange);
       THIMBLE_EQUAL(check_ray(ray, 1), Status::kOk);
       THIMBLE_EQUAL(check_ray(ray, 12), Status::kOk);
     }},
    {"check_ray: the limits themselves -> ok", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(check_ray(ray_q8({-4096, 5120, 0}, {kMaxDirection, -kMaxDirection, 0}), 2), Status::kOk);
       THIMBLE_EQUAL(check_ray(ray_q8({-4097, 5120, 0}, {1, 1, 0}), 2), Status::kOutOfRange);
       THIMBLE_EQUAL(check_ray(ray_q8({-4096, 5121, 0}, {1, 1, 0}), 2), Status::kOutOfRange);
     }},
    {"accepts_32: 16 bits of distance -> 15 of direction and no more", 0,
     [](Check& check, int) {
       const int32_t low = -4 * 256 * 32;
       THIMBLE_CHECK(accepts_32(ray_q8({low, 300, 300}, {32767, 1, 1}), 5));
       THIMBLE_CHECK(!accepts_32(ray_q8({low, 300, 300}, {32768, 1, 1}), 5));
       THIMBLE_CHECK(!accepts_32(ray_q8({300, low, 300}, {1, 1, -32768}), 5));
     }},
    {"accepts_32: a world of 64 from within -> directions of 17 bits", 0,
     [](Check& check, int) {
       THIMBLE_CHECK(accepts_32(ray_q8({8000, 8000, 8000}, {131071, 0, 0}), 6));
       THIMBLE_CHECK(!accepts_32(ray_q8({8000, 8000, 8000}, {131072, 0, 0}), 6));
     }},
    {"a ray too long for 32 bits -> refused by k32, answered by kAuto", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kOne));
       const Ray ray = ray_q8({-8192, 1100, 1100}, {kMaxDirection, 0, 0});
       check.options.width = Width::k32;
       for (int structure = 0; structure < 3; ++structure) {
         THIMBLE_EQUAL(closest(check, structure, ray, check.options), Status::kOutOfRange);
       }
       check.options.width = Width::kAuto;
       THIMBLE_EQUAL(closest(check, 2, ray, check.options), Status::kOk);
       THIMBLE_EQUAL(check.hit.t_numerator, 9216);
       THIMBLE_EQUAL(check.hit.t_denominator, 256 * kMaxDirection);
     }},
    {"away from the world or past it -> no node visited", kOneBytes, no_visit, 0, "axis", 3},
    {"past the box of what is occupied -> no node visited", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kOne));
       for (int structure = 0; structure < 3; ++structure) {
         THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8({0, 600, 1100}, {1, 0, 0}), check.options));
         THIMBLE_EQUAL(check.hit.visits, 0U);
       }
     }},
    {"an empty world -> no node visited", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kEmpty));
       for (int structure = 0; structure < 3; ++structure) {
         THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8({0, 600, 1100}, {1, 2, 3}), check.options));
         THIMBLE_EQUAL(check.hit.kind, HitKind::kMiss);
         THIMBLE_EQUAL(check.hit.visits, 0U);
       }
     }},
    {"a full world -> one node visited", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kFull));
       for (int structure = 1; structure < 3; ++structure) {
         THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8({-256, 1100, 1100}, {1, 0, 0}), check.options));
         THIMBLE_EQUAL(check.hit.visits, 1U);
       }
     }},
    {"one voxel in a world of 8 -> the three nodes above it visited", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kOne));
       for (int structure = 1; structure < 3; ++structure) {
         THIMBLE_REQUIRE_OK(closest(check, structure, ray_q8({-256, 1100, 1100}, {1, 0, 0}), check.options));
         THIMBLE_EQUAL(check.hit.visits, 3U);
       }
     }},
    {"step limit -> reported when one visit more is needed", cloud_bytes(3), step_limit, 0, "structure", 3},
    {"any_hit: nobody asks for the visits -> the same kind", kOneBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kOne));
       for (int structure = 0; structure < 3; ++structure) {
         HitKind kind = HitKind::kStepLimit;
         THIMBLE_EQUAL(
             any(check, structure, ray_q8({0, 1100, 1100}, {1, 0, 0}), &kind, nullptr, check.options),
             Status::kOk);
         THIMBLE_EQUAL(kind, HitKind::kHit);
       }
     }},
    {"moved by whole voxels -> the same hit, moved", 256, shifted, 0, "axis", 3},
    {"the voxel in front removed -> the next one", 256,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 24, 3));
       for (int32_t x = 0; x < 8; ++x) {
         THIMBLE_REQUIRE_OK(check.world.pool.insert({x, 2, 2}));
       }
       for (int32_t x = 0; x < 8; ++x) {
         THIMBLE_REQUIRE_OK(closest(check, 1, ray_q8({-256, 700, 700}, {5, 0, 0}), check.options));
         THIMBLE_EQUAL(check.hit.voxel, (Vec3i{x, 2, 2}));
         THIMBLE_REQUIRE_OK(check.world.pool.remove(check.hit.voxel));
       }
       THIMBLE_REQUIRE_OK(closest(check, 1, ray_q8({-256, 700, 700}, {5, 0, 0}), check.options));
       THIMBLE_EQUAL(check.hit.kind, HitKind::kMiss);
     }},
    {"the largest world along its edges -> the voxel in each corner", 1280, along_edges, 0, "axis", 3},
    {"a world merged to one block -> its lowest corner, its level, t at its face", 512, merged_world},
};

}  // namespace

const Group kTraceGroup = group_of<kCases>("trace", "cases_trace.cpp");

}  // namespace thimble::portable
