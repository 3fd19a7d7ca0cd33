// Rays and water, held to every column's box in exact fractions.
//
// THIMBLE_RAYS sets the number of rays, THIMBLE_SEED the seed.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/light/water.h"

namespace thimble::tools {
namespace {

__extension__ typedef __int128 Wide;

const std::int64_t kRays = thimble::tests::many_or_few<std::int64_t>(1000000, 60000);

// Exact; denominators are positive.
struct Fraction {
  Wide top = 0;
  Wide bottom = 1;
  friend bool operator<(const Fraction& a, const Fraction& b) { return a.top * b.bottom < b.top * a.bottom; }
  friend bool operator==(const Fraction& a, const Fraction& b) {
    return a.top * b.bottom == b.top * a.bottom;
  }
};

// What the definition says about a ray: when it is in which column, and through which faces.
struct Stretch {
  Fraction in;
  Fraction out;
  int in_axis = -1;
  int out_axis = -1;
  std::int32_t x = 0;
  std::int32_t y = 0;
};

// The judge: water of some heights.
struct Columns {
  Vec3i corner;
  std::int32_t width = 1;
  std::int32_t depth = 1;
  std::vector<std::int32_t> q16;

  std::int64_t height_q8(std::int32_t x, std::int32_t y) const {
    const std::int32_t fine = q16[static_cast<std::uint32_t>(y * width + x)];
    return fine < 0 ? 0 : (fine + 128) / 256;
  }
  WaterSurface surface() const {
    WaterSurface made{corner, width, depth, INT32_MAX, 0, q16.data(), false};
    for (const std::int32_t fine : q16) {
      if (fine < 0) {
        made.has_blocked = true;
      } else {
        made.lowest_q8 = std::min(made.lowest_q8, (fine + 128) / 256);
        made.highest_q8 = std::max(made.highest_q8, (fine + 128) / 256);
      }
    }
    made.lowest_q8 = std::min(made.lowest_q8, made.highest_q8);
    return made;
  }

  // All stretches of positive length, one a column at most.
  std::vector<Stretch> stretches(const Ray& ray) const {
    std::vector<Stretch> all;
    for (std::int32_t y = 0; y < depth; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        const std::array<std::int64_t, 3> low = {
            256 * std::int64_t{corner.x + x}, 256 * std::int64_t{corner.y + y}, 256 * std::int64_t{corner.z}};
        const std::array<std::int64_t, 3> high = {low[0] + 256, low[1] + 256, low[2] + height_q8(x, y)};
        Stretch one;
        one.x = x;
        one.y = y;
        bool empty = false;
        bool ends = false;
        for (int axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<std::size_t>(axis);
          const std::int64_t origin = ray.origin[axis].raw;
          const std::int64_t direction = ray.direction[axis];
          if (direction == 0) {
            empty = empty || origin < low[a] || origin >= high[a];
            continue;
          }
          const std::int64_t sign = direction < 0 ? -1 : 1;
          const Fraction enters{sign * ((sign > 0 ? low[a] : high[a]) - origin), 256 * sign * direction};
          const Fraction leaves{sign * ((sign > 0 ? high[a] : low[a]) - origin), 256 * sign * direction};
          if (one.in < enters) {
            one.in = enters;
            one.in_axis = axis;
          }
          if (!ends || leaves < one.out) {
            one.out = leaves;
            one.out_axis = axis;
            ends = true;
          }
        }
        if (!empty && one.in < one.out) {
          all.push_back(one);
        }
      }
    }
    std::sort(all.begin(), all.end(), [](const Stretch& a, const Stretch& b) { return a.in < b.in; });
    return all;
  }
};

int side_of(const Ray& ray, int axis, bool leaving) {
  return axis < 0 ? 0 : (ray.direction[axis] > 0) == leaving ? 1 : -1;
}

// Counts of what was met, to show that the hard cases were.
struct Tally {
  std::int64_t rays = 0;
  std::int64_t hits = 0;
  std::int64_t inside = 0;
  std::int64_t axes[3] = {};
  std::int64_t leaves[3] = {};
  std::int64_t longer = 0;  // left in another column than the first
  std::int64_t again = 0;   // in the water a second time after a gap
};

// Empty when all three functions say what the definition says.
std::string fault(const Columns& columns, const WaterSurface& surface, const Ray& ray, Tally* tally) {
  const std::vector<Stretch> all = columns.stretches(ray);
  ++tally->rays;
  WaterHit hit;
  const bool entered = water_enter(surface, ray, &hit);
  if (hit.visits > static_cast<std::uint32_t>(columns.width + columns.depth)) {
    return "too many columns looked at";
  }
  if (entered != !all.empty()) {
    return entered ? "entered, but no stretch" : "not entered";
  }
  const bool inside = !all.empty() && all[0].in == Fraction{};
  if (entered) {
    ++tally->hits;
    const Stretch& first = all[0];
    if (hit.column_x != first.x || hit.column_y != first.y) {
      return "entered another column";
    }
    if (!(Fraction{hit.t_numerator, hit.t_denominator} == first.in)) {
      return "entered at another t";
    }
    if (hit.axis != first.in_axis || hit.side != side_of(ray, first.in_axis, false)) {
      return "entered through another face";
    }
    if (hit.axis >= 0) {
      ++tally->axes[hit.axis];
      const std::int32_t speed = std::abs(ray.direction[hit.axis]);
      if (hit.t_denominator != 256 * speed || hit.t_numerator < 0 || hit.t_numerator > 1 << 23) {
        return "t is not written as promised";
      }
    }
  }
  tally->inside += inside ? 1 : 0;
  if (water_holds(surface, ray.origin, ray.direction) != inside) {
    return "water_holds";
  }
  hit = WaterHit{};
  if (water_leave(surface, ray, &hit) != inside) {
    return "water_leave starts elsewhere";
  }
  if (hit.visits > static_cast<std::uint32_t>(columns.width + columns.depth) + 4) {
    return "too many columns looked at on the way out";
  }
  if (inside) {
    std::size_t last = 0;
    while (last + 1 < all.size() && all[last + 1].in == all[last].out) {
      ++last;
    }
    tally->longer += last > 0 ? 1 : 0;
    tally->again += last + 1 < all.size() ? 1 : 0;
    const Stretch& end = all[last];
    ++tally->leaves[end.out_axis];
    if (hit.column_x != end.x || hit.column_y != end.y) {
      return "left another column";
    }
    if (!(Fraction{hit.t_numerator, hit.t_denominator} == end.out)) {
      return "left at another t";
    }
    if (hit.axis != end.out_axis || hit.side != side_of(ray, end.out_axis, true)) {
      return "left through another face";
    }
  }
  return "";
}

std::string describe(const Ray& ray) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    text += std::to_string(ray.origin[axis].raw) + " ";
  }
  for (int axis = 0; axis < 3; ++axis) {
    text += std::to_string(ray.direction[axis]) + " ";
  }
  return text;
}

class Cases {
 public:
  explicit Cases(std::uint64_t seed) : random_(seed), rays_(seed, {1, 1, 1}) {}

  std::int32_t pick(std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }

  Columns columns() {
    Columns made;
    const bool far = pick(0, 3) == 0;
    made.width = pick(1, pick(0, 2) == 0 ? 12 : 5);
    made.depth = pick(1, pick(0, 2) == 0 ? 12 : 5);
    made.corner = {pick(0, far ? 4096 - made.width : 6), pick(0, far ? 4096 - made.depth : 6),
                   pick(0, far ? 4000 : 6)};
    const std::int32_t kind = pick(0, 6);
    const std::int32_t level = pick(0, kind == 6 ? 1 << 20 : 1500) * 256;
    for (std::int32_t y = 0; y < made.depth; ++y) {
      for (std::int32_t x = 0; x < made.width; ++x) {
        std::int32_t fine = level;
        switch (kind) {
          case 0:  // flat
            break;
          case 1:  // ripples below what is shown, and above
            fine += pick(-700, 700);
            break;
          case 2:  // anything
            fine = pick(0, 400000);
            break;
          case 3:  // a slope
            fine = 256 * (64 * x + 128 * y + 5);
            break;
          case 4:  // whole voxels: planes of the lattice
            fine = 65536 * pick(0, 3);
            break;
          default:  // islands
            fine = pick(0, 3) == 0 ? -1 : level + 256 * pick(0, 2);
            break;
        }
        made.q16.push_back(fine < -1 ? 0 : std::min(fine, 1 << 28));
      }
    }
    return made;
  }

  Vec3i direction() { return tests::to_core(rays_.next().ray).direction; }

  // A point of the lattice that matters: corners of columns, their heights.
  Vec3i special_point(const Columns& columns) {
    const std::int32_t i = pick(0, columns.width - 1);
    const std::int32_t j = pick(0, columns.depth - 1);
    const auto height = static_cast<std::int32_t>(columns.height_q8(i, j));
    const std::int32_t up = pick(0, 3);
    return {256 * (columns.corner.x + i) + (pick(0, 2) == 0 ? pick(0, 255) : 256 * pick(0, 1)),
            256 * (columns.corner.y + j) + (pick(0, 2) == 0 ? pick(0, 255) : 256 * pick(0, 1)),
            256 * columns.corner.z + (up == 0   ? 0
                                      : up == 1 ? pick(0, std::max(height, 1))
                                                : height)};
  }

  Ray ray(const Columns& columns) {
    Ray made;
    for (int attempt = 0; attempt < 50; ++attempt) {
      const Vec3i at = special_point(columns);
      made.direction = direction();
      switch (pick(0, 8)) {
        case 0:
        case 1:
        case 2: {  // through the point exactly, at t = way / 256
          const std::int32_t way = pick(0, pick(0, 1) == 0 ? 3 : 2000);
          for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t from = at[axis] - std::int64_t{way} * made.direction[axis];
            made.origin[axis].raw =
                static_cast<std::int32_t>(std::clamp<std::int64_t>(from, -(1 << 23), 1 << 23));
          }
          break;
        }
        case 3:  // from the point
          for (int axis = 0; axis < 3; ++axis) {
            made.origin[axis].raw = at[axis];
          }
          break;
        case 4:  // anywhere that is allowed, towards the point
          for (int axis = 0; axis < 3; ++axis) {
            made.origin[axis].raw = pick(-(1 << 22), 5 << 20);
            made.direction[axis] = (at[axis] - made.origin[axis].raw) / 8;
          }
          break;
        case 5:  // from near, towards the point
        case 6:
          for (int axis = 0; axis < 3; ++axis) {
            made.origin[axis].raw = at[axis] + pick(-3000, 3000);
            made.direction[axis] = (at[axis] - made.origin[axis].raw) * pick(1, 2) + pick(-1, 1);
          }
          break;
        default:  // from inside
          made.origin.x.raw = 256 * columns.corner.x + pick(0, 256 * columns.width);
          made.origin.y.raw = 256 * columns.corner.y + pick(0, 256 * columns.depth);
          made.origin.z.raw = 256 * columns.corner.z + pick(0, 700);
          break;
      }
      if (pick(0, 9) == 0) {
        made.origin[pick(0, 2)].raw += pick(-1, 1);
      }
      if (check_ray(made, kMaxLevel) == Status::kOk) {
        return made;
      }
    }
    return {{}, {0, 0, -1}};
  }

 private:
  std::mt19937_64 random_;
  tests::RayCases rays_;
};

TEST_CASE("water surface: random rays and columns, a third of them degenerate -> the exact answer") {
  const std::uint64_t seed = tests::seed_or(20240611);
  const std::int64_t rays = tests::number_from_environment("THIMBLE_RAYS", kRays);
  CAPTURE(seed);
  Cases cases(seed);
  Tally tally;
  while (tally.rays < rays) {
    const Columns columns = cases.columns();
    const WaterSurface surface = columns.surface();
    for (int i = 0; i < 100; ++i) {
      const Ray ray = cases.ray(columns);
      const std::string wrong = fault(columns, surface, ray, &tally);
      if (!wrong.empty()) {
        CAPTURE(tally.rays);
        CAPTURE(describe(ray));
        CAPTURE(columns.width);
        CAPTURE(columns.depth);
        FAIL(wrong);
      }
    }
  }
  // That the hard cases were met.
  CHECK(tally.hits > rays / 4);
  CHECK(tally.inside > rays / 20);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(tally.axes[axis] > rays / 50);
    CHECK(tally.leaves[axis] > rays / 200);
  }
  CHECK(tally.longer > rays / 100);
  CHECK(tally.again > rays / 1000);
}

TEST_CASE("water surface: no array -> the same answers as an array of that level, and one column looked at") {
  Cases cases(77);
  for (int number = 0; number < 200; ++number) {
    Columns columns = cases.columns();
    const std::int32_t level = cases.pick(0, 1200);
    std::fill(columns.q16.begin(), columns.q16.end(), level * 256);
    const WaterSurface still = still_water(columns.corner, columns.width, columns.depth, level);
    Tally tally;
    for (int i = 0; i < 100; ++i) {
      const Ray ray = cases.ray(columns);
      REQUIRE(fault(columns, still, ray, &tally) == "");
      WaterHit hit;
      static_cast<void>(water_enter(still, ray, &hit));
      REQUIRE(hit.visits <= 1);
      static_cast<void>(water_leave(still, ray, &hit));
      REQUIRE(hit.visits <= 3);
    }
  }
}

Ray ray_of(std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t dx, std::int32_t dy,
           std::int32_t dz) {
  return {{Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)}, {dx, dy, dz}};
}

TEST_CASE("water surface: a long way in large moving water -> at most the columns that are crossed") {
  Columns columns;
  columns.width = 4096;
  columns.depth = 3;
  for (std::int32_t i = 0; i < 4096 * 3; ++i) {
    columns.q16.push_back((500 + i % 7) * 256);
  }
  const WaterSurface surface = columns.surface();
  WaterHit hit;
  // Just above the crests: misses the box, looks at nothing.
  CHECK_FALSE(water_enter(surface, ray_of(-500, 300, 506, 1, 0, 0), &hit));
  CHECK(hit.visits == 0);
  // Deep down, level and upwards: two ends of a way of 4,096 columns are looked at, not what lies between.
  REQUIRE(water_leave(surface, ray_of(1, 300, 100, 4000, 0, 0), &hit));
  CHECK(hit.column_x == 4095);
  CHECK(hit.visits <= 4);
  REQUIRE(water_leave(surface, ray_of(1, 300, 100, 40000, 0, 20), &hit));
  CHECK(hit.column_x > 3000);  // a side: the troughs of the waves come first
  CHECK(hit.visits < 200);
  // A shallow descent looks at the columns between crest and trough only.
  REQUIRE(water_enter(surface, ray_of(1, 300, 600, 100000, 0, -14), &hit));
  CHECK(hit.visits < 200);
}

TEST_CASE(
    "water surface: normals -> upright when flat, against the slope, mirrored with it, one-sided at walls") {
  const Vec3i up{0, 0, 1 << 14};
  const auto at = [](std::int32_t raw) { return Q8::from_raw(raw); };
  CHECK(water_normal(still_water({0, 0, 0}, 8, 8, 100), at(500), at(500)) == up);
  // A slope of 1/4 along x and -1/8 along y, everywhere the same.
  Columns slope;
  slope.width = 6;
  slope.depth = 5;
  for (std::int32_t y = 0; y < 5; ++y) {
    for (std::int32_t x = 0; x < 6; ++x) {
      slope.q16.push_back(200000 + 16384 * x - 8192 * y);
    }
  }
  Columns island = slope;
  island.q16[0] = -1;
  island.q16[2 * 6 + 3] = -1;
  for (const Columns& columns : {slope, island}) {
    for (std::int32_t y = 0; y < 5 * 256; y += 37) {
      for (std::int32_t x = 0; x < 6 * 256; x += 41) {
        if (columns.q16[static_cast<std::uint32_t>(y / 256 * 6 + x / 256)] >= 0) {
          REQUIRE(water_normal(columns.surface(), at(x), at(y)) == Vec3i{-4096, 2048, 1 << 14});
        }
      }
    }
  }
  // Steeper than 2 counts as 2.
  const Columns cliff{{0, 0, 0}, 2, 1, {0, 1 << 28}};
  CHECK(water_normal(cliff.surface(), at(100), at(100)) == Vec3i{-(1 << 15), 0, 1 << 14});
  // A crest in the middle: mirrored points have mirrored normals, and there is no jump between columns.
  const Columns crest{{0, 0, 0}, 5, 1, {65536, 70000, 99999, 70000, 65536}};
  Vec3i before = water_normal(crest.surface(), at(0), at(7));
  for (std::int32_t x = 0; x <= 5 * 256; ++x) {
    const Vec3i normal = water_normal(crest.surface(), at(x), at(7));
    const Vec3i mirrored = water_normal(crest.surface(), at(5 * 256 - x), at(7));
    REQUIRE(normal.x == -mirrored.x);
    REQUIRE(std::abs(normal.x - before.x) < 64);
    before = normal;
  }
}

}  // namespace
}  // namespace thimble::tools
