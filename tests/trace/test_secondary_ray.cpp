// Secondary rays, held to the exact reference: where they start, how they leave a medium, what
// they hit from a point on.
//
// THIMBLE_RAYS sets the number of rays, THIMBLE_SEED the seed of all of them.
#include <doctest/doctest.h>

#include <algorithm>

#include "reference/reference.h"
#include "reference/secondary.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/light/host/optics.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/compact_tree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr int kAir = -1;

// A cube of voxels with a material or air each, and its compact tree.
class Cells {
 public:
  explicit Cells(int level)
      : level_(level), side_(1 << level), cells_(std::size_t{1} << (3 * level), std::int16_t{kAir}) {}

  int level() const { return level_; }
  int side() const { return side_; }
  bool contains(const reference::Voxel& v) const {
    return v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && v[0] < side_ && v[1] < side_ && v[2] < side_;
  }
  int at(const reference::Voxel& v) const { return contains(v) ? cells_[index(v)] : kAir; }
  void set(const reference::Voxel& v, int material) {
    cells_[index(v)] = static_cast<std::int16_t>(material);
  }
  void fill(const reference::Voxel& low, const reference::Voxel& high, int material) {
    for (int z = std::max(low[2], 0); z < std::min(high[2], side_); ++z) {
      for (int y = std::max(low[1], 0); y < std::min(high[1], side_); ++y) {
        for (int x = std::max(low[0], 0); x < std::min(high[0], side_); ++x) {
          set({x, y, z}, material);
        }
      }
    }
  }

  HeapBytes tree(int rank_shift = kDefaultRankShift) const {
    OwnedPool pool(level_, (std::size_t{1} << 3 * level_) + 100);
    for (int i = 0; i < side_ * side_ * side_; ++i) {
      const Vec3i at = morton_voxel(static_cast<std::uint64_t>(i));
      if (const int material = this->at({at.x, at.y, at.z}); material != kAir) {
        REQUIRE(pool.octree.insert(at, static_cast<std::uint8_t>(material)) == Status::kOk);
      }
    }
    return compact_of(pool.octree, rank_shift);
  }

 private:
  std::size_t index(const reference::Voxel& v) const {
    const int number = v[0] + side_ * (v[1] + side_ * v[2]);
    return static_cast<std::size_t>(number);
  }

  int level_;
  int side_;
  std::vector<std::int16_t> cells_;
};

// Boxes of few materials, so that solid blocks of many sizes meet; sometimes every voxel by chance, or one
// material through and through.
Cells random_cells(std::mt19937_64& random) {
  Cells cells(pick_int(random, 1, 6));
  const int materials = pick_int(random, 1, 3);
  const auto any = [&] { return pick_int(random, kAir, materials - 1); };
  const std::int64_t kind = pick(random, 0, 5);
  if (kind == 0) {
    for (int z = 0; z < cells.side(); ++z) {
      for (int y = 0; y < cells.side(); ++y) {
        for (int x = 0; x < cells.side(); ++x) {
          cells.set({x, y, z}, any());
        }
      }
    }
    return cells;
  }
  const int filling = kind == 1 ? kAir : any();
  cells.fill({0, 0, 0}, {cells.side(), cells.side(), cells.side()}, filling);
  const std::int64_t boxes = pick(random, 0, 12);
  for (std::int64_t i = 0; i < boxes; ++i) {
    reference::Voxel low{};
    reference::Voxel high{};
    const std::int64_t size = pick(random, 1, cells.side());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = pick_int(random, 0, cells.side() - 1);
      high[axis] = low[axis] + pick_int(random, 1, size);
    }
    cells.fill(low, high, any());
  }
  return cells;
}

struct Tally {
  std::int64_t rays = 0;
  std::int64_t degenerate = 0;  // through edges or corners, or within planes
  std::int64_t walks = 0;       // through a medium, of more than no length
  std::int64_t left_world = 0;
  std::int64_t into_solid = 0;
  std::int64_t diagonal = 0;  // left media through an edge or corner
  std::int64_t mirrored = 0;
  std::int64_t narrow = 0;
  std::int64_t wrong = 0;
  std::string first;

  void fail(const std::string& what) {
    if (++wrong <= 5) {
      first += "\n" + what;
    }
  }
};

reference::Time time_of(const RayPoint& point) {
  return {point.t_numerator, point.t_denominator};
}

class Judge {
 public:
  Judge(const Cells& cells, std::uint64_t seed, Tally& tally)
      : cells_(cells),
        bytes_(cells.tree(static_cast<int>(3 + seed % 4))),
        tree_(open_or_throw(bytes_)),
        random_(seed),
        tally_(tally) {}

  void check_ray(const RayCase& ray_case) {
    const Ray ray = to_core(ray_case.ray);
    tally_.degenerate +=
        ray_case.aimed() || ray_case.kind == RayKind::kInPlane || ray_case.kind == RayKind::kSimple;
    const reference::Voxel first = reference::voxel_after(ray_case.ray, {});
    const Vec3i starting = starting_voxel(ray);
    if (first != reference::Voxel{starting.x, starting.y, starting.z}) {
      tally_.fail("starting voxel of " + reference::describe(ray_case.ray));
    }
    const int here = cells_.at(first);
    std::uint8_t material = 99;
    if (material_at(tree_, starting, &material) != (here != kAir) || (here != kAir && material != here)) {
      tally_.fail("material at the start of " + reference::describe(ray_case.ray));
    }
    check_medium(ray, here == kAir ? 0 : here, {});

    Hit hit;
    REQUIRE(closest_hit(tree_, ray, &hit) == Status::kOk);
    check_before(ray, hit);
    if (hit.kind != HitKind::kHit) {
      return;
    }
    check_start(ray, hit);
    // The same ray on through what it hit, and what comes then.
    const MediumExit exit = check_medium(ray, hit.material, point_of(hit));
    check_from(ray, point_of(hit));
    check_from(ray, point_of(exit.hit));
    if (!exit.left_world) {
      check_start(ray, exit.hit);
    }
    if (hit.axis >= 0) {
      check_away(ray, hit);
      check_into(ray, hit);
    }
  }

  MediumExit check_medium(const Ray& ray, int material, const RayPoint& from) {
    ++tally_.rays;
    const reference::Ray judged = to_reference(ray);
    const std::string place = reference::describe(judged) + " from " + std::to_string(from.t_numerator) +
                              "/" + std::to_string(from.t_denominator) + " in " + std::to_string(material);
    MediumExit exit;
    REQUIRE(leave_medium(tree_, ray, static_cast<std::uint8_t>(material), &exit, from) == Status::kOk);
    check_narrow(ray, material, from, exit, place);
    if (!cells_.contains(reference::voxel_after(judged, time_of(from)))) {
      if (!exit.left_world || exit.into_solid || exit.hit.axis != -1 || exit.hit.visits != 0) {
        tally_.fail("not in the world: " + place);
      }
      return exit;
    }
    const reference::Hit expected = reference::first_voxel(
        judged, time_of(from), [&](const reference::Voxel& v) { return cells_.at(v) != material; },
        [](const reference::Voxel&) { return false; });
    const int found = cells_.at(expected.voxel);
    const bool outside = !cells_.contains(expected.voxel);
    if (!same_answer(exit.hit, expected) || exit.left_world != outside ||
        exit.into_solid != (found != kAir) || (found != kAir && exit.hit.material != found) ||
        exit.hit.block_level != 0) {
      tally_.fail("leave_medium: " + place + ": " + tests::describe(exit.hit) + " instead of " +
                  reference::describe(expected));
    }
    if (exit.hit.visits > 3U * static_cast<unsigned>(cells_.side())) {
      tally_.fail("visits: " + place);
    }
    tally_.walks += exit.hit.axis >= 0 ? 1 : 0;
    tally_.left_world += outside ? 1 : 0;
    tally_.into_solid += found != kAir ? 1 : 0;
    return exit;
  }

 private:
  void check_narrow(const Ray& ray, int material, const RayPoint& from, const MediumExit& wide,
                    const std::string& place) {
    MediumExit exit;
    TraceOptions options;
    options.width = Width::k32;
    const Status status = leave_medium(tree_, ray, static_cast<std::uint8_t>(material), &exit, from, options);
    if (status == Status::kOutOfRange && !accepts_32(ray, cells_.level())) {
      return;
    }
    Hit narrow;
    Hit hit;
    REQUIRE(closest_hit_from(tree_, ray, from, &narrow, options) == Status::kOk);
    REQUIRE(closest_hit_from(tree_, ray, from, &hit) == Status::kOk);
    if (!same_hit(narrow, hit) || narrow.visits != hit.visits) {
      tally_.fail("32 bits, closest: " + place);
    }
    ++tally_.narrow;
    if (status != Status::kOk || exit.left_world != wide.left_world || exit.into_solid != wide.into_solid ||
        !same_hit(exit.hit, wide.hit) || exit.hit.visits != wide.hit.visits) {
      tally_.fail("32 bits: " + place);
    }
  }

  void check_start(const Ray& ray, const Hit& hit) {
    ++tally_.rays;
    const reference::Hit judged{
        true, {hit.voxel.x, hit.voxel.y, hit.voxel.z}, hit.t_numerator, hit.t_denominator, hit.axis};
    const reference::PointQ8 expected = reference::start_on_face(to_reference(ray), judged);
    const Vec3Q8 start = start_on_face(ray, hit);
    for (int axis = 0; axis < 3; ++axis) {
      if (start[axis].raw != expected[static_cast<std::size_t>(axis)]) {
        tally_.fail("start: " + reference::describe(to_reference(ray)) + " " + tests::describe(hit));
        return;
      }
    }
  }

  void check_from(const Ray& ray, const RayPoint& from) {
    ++tally_.rays;
    const reference::Ray judged = to_reference(ray);
    const reference::Hit expected = reference::first_voxel(
        judged, time_of(from), [&](const reference::Voxel& v) { return cells_.at(v) != kAir; },
        [&](const reference::Voxel& v) { return !cells_.contains(v); });
    Hit hit;
    REQUIRE(closest_hit_from(tree_, ray, from, &hit) == Status::kOk);
    if (!same_answer(hit, expected) || (expected.hit && hit.material != cells_.at(expected.voxel))) {
      tally_.fail("closest_hit_from: " + reference::describe(judged) + " from " +
                  std::to_string(from.t_numerator) + "/" + std::to_string(from.t_denominator) + ": " +
                  tests::describe(hit) + " instead of " + reference::describe(expected));
    }
  }

  // Not before its own t, but before the least more; and before any fraction as cross products say.
  void check_before(const Ray& ray, const Hit& hit) {
    ++tally_.rays;
    const RayPoint any{pick_int(random_, 0, INT32_MAX >> pick(random_, 0, 30)),
                       pick_int(random_, 1, INT32_MAX >> pick(random_, 0, 30))};
    __extension__ typedef __int128 Int128;
    const bool expected = hit.kind == HitKind::kHit && Int128{hit.t_numerator} * any.t_denominator <
                                                           Int128{any.t_numerator} * hit.t_denominator;
    HitKind kind = HitKind::kStepLimit;
    std::uint32_t visits = 0;
    REQUIRE(any_hit_before(tree_, ray, any, &kind, &visits) == Status::kOk);
    if ((kind == HitKind::kHit) != expected || visits != hit.visits) {
      tally_.fail("any_hit_before: " + reference::describe(to_reference(ray)));
    }
    if (hit.kind == HitKind::kHit) {
      HitKind own = HitKind::kStepLimit;
      HitKind more = HitKind::kStepLimit;
      REQUIRE(any_hit_before(tree_, ray, point_of(hit), &own) == Status::kOk);
      REQUIRE(any_hit_before(tree_, ray, {hit.t_numerator + 1, hit.t_denominator}, &more) == Status::kOk);
      if (own != HitKind::kMiss || more != HitKind::kHit) {
        tally_.fail("any_hit_before its own t: " + reference::describe(to_reference(ray)));
      }
    }
  }

  // A mirrored ray, or any that leaves the face: it never meets the voxel that it comes from, and what it
  // meets is what the reference says of the same ray.
  void check_away(const Ray& ray, const Hit& hit) {
    ++tally_.rays;
    ++tally_.mirrored;
    const bool smaller = looks_to_smaller(ray, hit);
    Ray away{start_on_face(ray, hit), reflect(ray.direction, hit.axis)};
    if (pick(random_, 0, 1) == 0) {
      away.direction = occlusion_direction(pick_int(random_, 0, kOcclusionDirections - 1), hit.axis, smaller);
    }
    REQUIRE(leaves_face(away.direction, hit.axis, smaller));
    Hit next;
    REQUIRE(closest_hit(tree_, away, &next) == Status::kOk);
    if (next.kind == HitKind::kHit && next.voxel == hit.voxel) {
      tally_.fail("acne: " + reference::describe(to_reference(away)) + " hits " + tests::describe(next));
    }
    check_from(away, {});
  }

  // A ray into the block: it starts in it, or leaves through another of its planes at once.
  void check_into(const Ray& ray, const Hit& hit) {
    Ray into{start_on_face(ray, hit), shorten(ray.direction)};
    for (int axis = 0; axis < 3; ++axis) {
      if (axis != hit.axis && pick(random_, 0, 1) == 0) {
        into.direction[axis] = pick_int(random_, -kMaxShort, kMaxShort);
      }
    }
    if (!enters_face(into.direction, hit.axis, looks_to_smaller(ray, hit))) {
      return;  // a component that shortening took
    }
    const Vec3i first = starting_voxel(into);
    for (int axis = 0; axis < 3; ++axis) {
      const bool through =
          into.origin[axis].raw == hit.voxel[axis] * Q8::kOne && into.direction[axis] < 0 && axis != hit.axis;
      if (first[axis] != hit.voxel[axis] - (through ? 1 : 0)) {
        tally_.fail("into: " + reference::describe(to_reference(into)) + " from " + tests::describe(hit));
      }
    }
    const MediumExit exit = check_medium(into, hit.material, {});
    if (exit.hit.axis >= 0) {
      int planes = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t plane =
            std::int64_t{exit.hit.voxel[axis] + (into.direction[axis] < 0 ? 1 : 0)} * 256;
        planes +=
            into.direction[axis] != 0 && (plane - into.origin[axis].raw) * exit.hit.t_denominator ==
                                             std::int64_t{exit.hit.t_numerator} * into.direction[axis] * 256;
      }
      tally_.diagonal += planes > 1 ? 1 : 0;
    }
  }

  const Cells& cells_;
  HeapBytes bytes_;
  CompactTree tree_;
  std::mt19937_64 random_;
  Tally& tally_;
};

}  // namespace

TEST_CASE(
    "secondary rays: random rays in worlds of materials -> starts, exits and hits as the exact reference has "
    "them") {
  const std::int64_t rays = number_from_environment("THIMBLE_RAYS", many_or_few(1000000, 60000));
  const std::int64_t seed = number_from_environment("THIMBLE_SEED", 20261121);
  Tally tally;
  std::int64_t worlds = 0;
  std::int64_t cases = 0;
  for (; tally.rays < rays; ++worlds) {
    const std::uint64_t own = static_cast<std::uint64_t>(seed + worlds);
    std::mt19937_64 random(own);
    const Cells cells = random_cells(random);
    Judge judge(cells, own, tally);
    RayCases any(own * 2 + 1, {cells.side(), cells.side(), cells.side()});
    // From within, and within what the 32-bit path takes.
    RayLimits limits;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      limits.origin_high_q8[axis] = 256 * cells.side();
    }
    limits.direction = (std::int64_t{1} << (31 - 9 - cells.level())) - 1;
    limits.direction = std::min(limits.direction, reference::kMaxDirection);
    RayCases within(own * 2 + 2, {cells.side(), cells.side(), cells.side()}, limits);
    const std::int64_t wrong = tally.wrong;
    for (int i = 0; i < 500; ++i, ++cases) {
      judge.check_ray(i % 3 == 0 ? any.next() : within.next());
    }
    if (tally.wrong != wrong) {
      tally.first += "\nseed " + std::to_string(own) + " side " + std::to_string(cells.side());
    }
  }
  CHECK_MESSAGE(tally.wrong == 0, tally.first);
  CHECK(tally.rays >= rays);
  CHECK(tally.degenerate * 3 >= cases);
  CHECK(tally.diagonal > 0);
  CHECK(tally.left_world > 0);
  CHECK(tally.into_solid > 0);
  CHECK(tally.walks * 10 >= tally.rays);
  CHECK(tally.mirrored > 0);
  CHECK(tally.narrow * 10 >= tally.rays);
}

TEST_CASE(
    "start on a face: worlds to 4096, blocks of every size, any direction -> the exact point rounded down") {
  std::mt19937_64 random(seed_or(7));
  int wrong = 0;
  int starts = 0;
  for (int i = 0; i < 4000; ++i) {
    const int level = pick_int(random, 1, kMaxLevel);
    const int block_level = static_cast<int>(pick(random, 0, 3) == 0 ? pick(random, 0, level) : 0);
    const int side = 1 << block_level;
    reference::Block block;
    block.log2_side = block_level;
    for (int& corner : block.lowest) {
      corner = side * pick_int(random, 0, (1 << (level - block_level)) - 1);
    }
    RayCases cases(random(), {1 << level, 1 << level, 1 << level}, {block.lowest});
    for (int j = 0; j < 40; ++j) {
      const reference::Ray ray = cases.next().ray;
      const reference::Hit judged = reference::judge_blocks({block}, ray);
      if (!judged.hit) {
        continue;
      }
      ++starts;
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = static_cast<std::int8_t>(judged.axis);
      hit.block_level = static_cast<std::uint8_t>(block_level);
      hit.voxel = {judged.voxel[0], judged.voxel[1], judged.voxel[2]};
      hit.t_numerator = static_cast<std::int32_t>(judged.t_numerator);
      hit.t_denominator = static_cast<std::int32_t>(judged.t_denominator);
      const reference::PointQ8 expected = reference::start_on_face(ray, judged, side);
      const Vec3Q8 start = start_on_face(tests::to_core(ray), hit);
      const bool same =
          start.x.raw == expected[0] && start.y.raw == expected[1] && start.z.raw == expected[2];
      CAPTURE(reference::describe(ray));
      wrong += same ? 0 : 1;
      // On a plane that is not the lattice's and in a box of any size, as those of water are.
      if (judged.axis >= 0) {
        const std::size_t axis = static_cast<std::size_t>(judged.axis);
        const std::int64_t plane =
            ray.origin_q8[axis] + (ray.direction[axis] > 0 ? 1 : -1) * pick(random, 0, 1 << 20);
        Vec3i low;
        Vec3i high;
        for (int a = 0; a < 3; ++a) {
          low[a] = pick_int(random, -(1 << 21), 1 << 20);
          high[a] = low[a] + pick_int(random, 1, 1 << pick(random, 0, 20));
        }
        const Vec3Q8 on =
            start_on_plane(tests::to_core(ray), judged.axis, static_cast<std::int32_t>(plane), low, high);
        for (std::size_t a = 0; a < 3; ++a) {
          const std::int64_t way = plane - ray.origin_q8[axis];
          std::int64_t exact = plane;
          if (a != axis) {
            // floor(origin + way * d / d_axis) by the remainder's sign.
            const std::int64_t dividend = way * ray.direction[a] * (ray.direction[axis] < 0 ? -1 : 1);
            const std::int64_t divisor = std::abs(ray.direction[axis]);
            const std::int64_t down = dividend / divisor - (dividend % divisor < 0 ? 1 : 0);
            exact = std::clamp<std::int64_t>(ray.origin_q8[a] + down, low[static_cast<int>(a)],
                                             high[static_cast<int>(a)] - 1);
          }
          wrong += on[static_cast<int>(a)].raw == exact ? 0 : 1;
        }
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(starts > 10000);
}

TEST_CASE("leave_medium: merged blocks -> crossed whole as media, entered as blocks") {
  std::mt19937_64 random(seed_or(8));
  int wrong = 0;
  int merged = 0;
  for (int world = 0; world < 40; ++world) {
    const int level = 4;
    OwnedPool owned(level, 6000);
    Octree& pool = owned.octree;
    for (int i = 0; i < 700; ++i) {
      const auto at = [&] { return pick_int(random, 0, 15); };
      const std::int32_t x = at();
      const std::int32_t y = at();
      REQUIRE(pool.insert({x, y, at()}, static_cast<std::uint8_t>(1 + x / 2 % 2)) == Status::kOk);
    }
    REQUIRE(pool.coarsen_to(pool.nodes_used() * 3 / 4) == Status::kOk);
    const HeapBytes tree_bytes = compact_of(pool);
    const CompactTree tree = open_or_throw(tree_bytes);
    const auto at = [&](const reference::Voxel& v) {
      std::uint8_t material = 0;
      return material_at(tree, {v[0], v[1], v[2]}, &material) ? int{material} : kAir;
    };
    RayLimits limits;
    limits.origin_high_q8 = {4096, 4096, 4096};
    limits.direction = 4095;
    RayCases cases(random(), {16, 16, 16}, limits);
    for (int i = 0; i < 300; ++i) {
      const reference::Ray judged = cases.next().ray;
      const Ray ray = tests::to_core(judged);
      const reference::Voxel first = reference::voxel_after(judged, {});
      const int here = at(first);
      const bool inside = std::all_of(first.begin(), first.end(), [](int c) { return c >= 0 && c < 16; });
      if (here == kAir || !inside) {
        continue;
      }
      reference::Hit expected = reference::first_voxel(
          judged, {}, [&](const reference::Voxel& v) { return at(v) != here; },
          [](const reference::Voxel&) { return false; });
      MediumExit exit;
      REQUIRE(leave_medium(tree, ray, static_cast<std::uint8_t>(here), &exit) == Status::kOk);
      if (exit.hit.block_level > 0) {
        ++merged;
        const reference::Block block{{exit.hit.voxel.x, exit.hit.voxel.y, exit.hit.voxel.z},
                                     exit.hit.block_level};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          wrong += (expected.voxel[axis] & -(1 << exit.hit.block_level)) == block.lowest[axis] ? 0 : 1;
        }
        expected = reference::judge_blocks({block}, judged);
      }
      wrong += same_answer(exit.hit, expected) && exit.into_solid == (at(expected.voxel) != kAir) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
  CHECK(merged > 100);
}

TEST_CASE("ray_towards: two points -> a ray that is at the second at the t given") {
  std::mt19937_64 random(seed_or(9));
  int wrong = 0;
  for (int i = 0; i < 100000; ++i) {
    Vec3Q8 from;
    Vec3Q8 to;
    std::int64_t largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t reach = std::int64_t{1} << pick(random, 0, 22);
      from[axis] = Q8::from_raw(pick_int(random, -reach, reach));
      to[axis] = Q8::from_raw(
          static_cast<std::int32_t>(pick(random, 0, 4) == 0 ? from[axis].raw : pick(random, -reach, reach)));
      largest = std::max(largest, std::abs(std::int64_t{to[axis].raw} - from[axis].raw));
    }
    const int bits = pick_int(random, 2, 20);
    Ray ray;
    RayPoint place;
    if (!ray_towards(from, to, bits, &ray, &place)) {
      wrong += largest == 0 ? 0 : 1;
      continue;
    }
    std::int64_t most = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t way = std::int64_t{to[axis].raw} - from[axis].raw;
      const std::int64_t moved = std::int64_t{place.t_numerator} * ray.direction[axis];
      wrong += 2 * std::abs(moved - way) <= place.t_numerator - 1 + (place.t_numerator > 1 ? 1 : 0) ? 0 : 1;
      wrong += way == 0 && ray.direction[axis] != 0 ? 1 : 0;
      most = std::max<std::int64_t>(most, std::abs(ray.direction[axis]));
    }
    wrong += place.t_denominator == 256 && most < (std::int64_t{1} << bits) && ray.origin == from ? 0 : 1;
    wrong += place.t_numerator == 1 || most >= (std::int64_t{1} << (bits - 1)) ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("leave_medium: rays beyond the limits, step limits, an empty tree -> as closest_hit says") {
  Cells cells(4);
  const HeapBytes none = cells.tree();
  const CompactTree empty = open_or_throw(none);
  const Ray ray{{Q8::from_raw(640), Q8::from_raw(640), Q8::from_raw(640)}, {3, -2, 1}};
  MediumExit exit;
  REQUIRE(leave_medium(empty, ray, 0, &exit) == Status::kOk);
  CHECK(exit.hit.voxel == Vec3i{2, 2, 2});
  CHECK(exit.hit.axis == -1);
  CHECK_FALSE(exit.into_solid);
  CHECK_FALSE(exit.left_world);
  CHECK_FALSE(material_at(empty, {2, 2, 2}, nullptr));
  Hit hit;
  REQUIRE(closest_hit_from(empty, ray, {}, &hit) == Status::kOk);
  CHECK(hit.kind == HitKind::kMiss);

  cells.fill({0, 0, 0}, {16, 16, 16}, 1);
  cells.set({15, 0, 15}, 2);
  const HeapBytes bytes = cells.tree();
  const CompactTree tree = open_or_throw(bytes);
  const MediumExit before = exit;
  CHECK(leave_medium(tree, {ray.origin, {0, 0, 0}}, 1, &exit) == Status::kBadArgument);
  CHECK(leave_medium(tree, {ray.origin, {kMaxDirection + 1, 0, 0}}, 1, &exit) == Status::kOutOfRange);
  CHECK(leave_medium(tree, {ray.origin, {kMaxDirection, 0, 1}}, 1, &exit, {}, {UINT32_MAX, Width::k32}) ==
        Status::kOutOfRange);
  CHECK(closest_hit_from(tree, {ray.origin, {0, 0, 0}}, {}, &hit) == Status::kBadArgument);
  HitKind kind = HitKind::kMiss;
  CHECK(any_hit_before(tree, {ray.origin, {0, 0, 0}}, {1, 1}, &kind) == Status::kBadArgument);
  CHECK(exit.hit.voxel == before.hit.voxel);
  std::uint32_t full = 0;
  for (std::uint32_t limit = 0; limit <= 60; ++limit) {
    TraceOptions options;
    options.max_visits = limit;
    REQUIRE(leave_medium(tree, ray, 1, &exit, {}, options) == Status::kOk);
    CHECK(exit.hit.visits <= limit);
    if (exit.hit.kind == HitKind::kHit) {
      full = full == 0 ? exit.hit.visits : full;
      CHECK(exit.hit.visits == full);
      CHECK(exit.left_world);
    } else {
      CHECK(exit.hit.kind == HitKind::kStepLimit);
      CHECK(full == 0);
    }
  }
  CHECK(full > 0);
  // A full world of one material is one node.
  cells.set({15, 0, 15}, 1);
  const HeapBytes whole = cells.tree();
  REQUIRE(leave_medium(open_or_throw(whole), ray, 1, &exit) == Status::kOk);
  CHECK(exit.hit.visits == 1);
  CHECK(exit.left_world);
  CHECK(exit.hit.axis == 1);
  CHECK(exit.hit.voxel == Vec3i{6, -1, 3});
}
