// Triangles to voxels, held to an exact test of another kind; cell by cell, to the same triangle by triangle.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <vector>

#include "scene/random.h"
#include "scene/voxelise.h"
#include "scene/world_fit.h"
#include "support/counts.h"

namespace {

using namespace thimble::tools;

const int kEffort = thimble::tests::many_or_few(10, 1);

__extension__ typedef __int128 Wide;

// ---- the exact judge: the triangle is clipped by the cube's six closed half spaces in rational numbers

struct Rational {
  std::array<Wide, 3> p;
  Wide w;  // > 0; the point is p / w
};

Wide gcd(Wide a, Wide b) {
  a = a < 0 ? -a : a;
  b = b < 0 ? -b : b;
  while (b != 0) {
    const Wide rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

Rational reduced(Rational r) {
  const Wide divisor = gcd(gcd(r.p[0], r.p[1]), gcd(r.p[2], r.w));
  for (Wide& component : r.p) {
    component /= divisor;
  }
  r.w /= divisor;
  return r;
}

/// Sutherland and Hodgman, keeping what touches.
bool clip_says_meets(const UnitTriangle& triangle, const UnitPoint& center, std::int32_t half) {
  std::vector<Rational> polygon;
  for (const UnitPoint& vertex : triangle) {
    polygon.push_back({{vertex[0], vertex[1], vertex[2]}, 1});
  }
  for (std::size_t plane = 0; plane < 6; ++plane) {
    const std::size_t axis = plane / 2;
    const Wide sign = plane % 2 == 0 ? 1 : -1;
    const Wide limit = center[axis] - sign * half;
    std::vector<Rational> kept;
    const auto inside = [&](const Rational& r) { return sign * (r.p[axis] - limit * r.w); };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Rational& a = polygon[i];
      const Rational& b = polygon[(i + 1) % polygon.size()];
      const Wide da = inside(a);
      const Wide db = inside(b);
      if (da >= 0) {
        kept.push_back(a);
      }
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
        Rational cross{};
        for (std::size_t k = 0; k < 3; ++k) {
          cross.p[k] = da > 0 ? da * b.p[k] - db * a.p[k] : db * a.p[k] - da * b.p[k];
        }
        cross.w = da > 0 ? da * b.w - db * a.w : db * a.w - da * b.w;
        kept.push_back(reduced(cross));
      }
    }
    polygon = kept;
  }
  return !polygon.empty();
}

/// Coordinates 1 .. 2^(level+8) - 1, half of the time on a grid plane or a voxel's middle.
UnitPoint random_point(SplitMix64& random, int level) {
  const std::int32_t top = (kUnitsPerVoxel << level) - 1;
  UnitPoint point;
  for (std::int32_t& component : point) {
    component = random.between(1, top);
    const std::uint32_t kind = random.below(4);
    if (kind < 2) {
      component = std::clamp(component & (kind == 0 ? ~255 : ~127), 1, top);
    }
  }
  return point;
}

UnitTriangle random_triangle(SplitMix64& random, int level) {
  UnitTriangle triangle{random_point(random, level), random_point(random, level),
                        random_point(random, level)};
  const std::int32_t top = (kUnitsPerVoxel << level) - 1;
  switch (random.below(8)) {
    case 0:  // a point
      triangle[1] = triangle[2] = triangle[0];
      break;
    case 1:  // a segment, two vertices equal
      triangle[2] = triangle[random.below(2)];
      break;
    case 2:  // a segment, three different vertices
      for (std::size_t axis = 0; axis < 3; ++axis) {
        triangle[1][axis] += (triangle[0][axis] ^ triangle[1][axis]) & 1;
        triangle[1][axis] = std::min(triangle[1][axis], top - 1 + (triangle[0][axis] & 1));
        triangle[2][axis] = (triangle[0][axis] + triangle[1][axis]) / 2;
      }
      break;
    case 3:  // small
      for (std::size_t i = 1; i < 3; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          triangle[i][axis] = std::clamp(triangle[0][axis] + random.between(-300, 300), 1, top);
        }
      }
      break;
    case 4:  // in a coordinate plane
      triangle[1][1] = triangle[2][1] = triangle[0][1];
      break;
    default:
      break;
  }
  return triangle;
}

// ---- meshes

TriangleMesh tetrahedron() {
  return {
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}, {}};
}

TriangleMesh box() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 0.8 : -0.8, i & 4 ? 0.6 : -0.6});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

using VoxelSet = std::set<std::array<int, 3>>;

VoxelSet voxels_of(const TriangleMesh& mesh, int level, bool z_up = false) {
  VoxelSet voxels;
  voxelise(mesh, level, z_up, nullptr, [&](const UnitPoint& at, int, std::uint8_t) { voxels.insert(at); });
  return voxels;
}

using CellVoxels = std::map<UnitPoint, std::uint8_t>;

CellVoxels by_triangle(const std::vector<CellTriangle>& triangles) {
  CellVoxels voxels;
  for (const CellTriangle& triangle : triangles) {
    voxelise_triangle(triangle.corners, [&](const UnitPoint& at) { voxels[at] = triangle.number & 255; });
  }
  return voxels;
}

CellVoxels by_cell(const std::vector<CellTriangle>& triangles, int level, bool is_shaded, int* blocks) {
  CellVoxels voxels;
  bool once = true;
  double last = 0;
  const BlockSink sink = [&](const UnitPoint& corner, int block_level, std::uint8_t material) {
    const std::int32_t side = std::int32_t{1} << block_level;
    *blocks += block_level > 0 ? 1 : 0;
    for (std::int32_t i = 0; i < side * side * side; ++i) {
      const UnitPoint voxel{corner[0] + i % side, corner[1] + i / side % side, corner[2] + i / side / side};
      once = once && voxels.emplace(voxel, material).second;
    }
  };
  const CellShade shade = [](const CellTriangle& triangle, auto&) { return triangle.number & 255; };
  const auto told = [&](double done) {
    CHECK(done >= last);
    CHECK(done <= 1);
    last = done;
  };
  voxelise_cells(triangles, level, sink, told, is_shaded ? shade : CellShade());
  CHECK(last == 1);
  CHECK(once);
  return voxels;
}

}  // namespace

TEST_CASE("voxelise: random triangles and cubes -> the answer of exact rational clipping") {
  constexpr std::uint64_t kSeed = 20250101;
  SplitMix64 random(kSeed);
  int met = 0;
  const int rounds = 20000 * kEffort;
  for (int i = 0; i < rounds; ++i) {
    const int level = 1 + static_cast<int>(random.below(3));
    const UnitTriangle triangle = random_triangle(random, level);
    const int block = static_cast<int>(random.below(2));
    const std::int32_t half = kUnitsPerVoxel / 2 << block;
    UnitPoint center;
    for (std::int32_t& component : center) {
      component = random.between(0, (1 << (level - block)) - 1) * 2 * half + half;
    }
    const bool expected = clip_says_meets(triangle, center, half);
    met += expected;
    CAPTURE(kSeed);
    CAPTURE(i);
    REQUIRE(TriangleBoxTest(triangle).meets(center, half) == expected);
    // The same in the largest world: no width runs out.
    const int shift = 12 - level;
    UnitTriangle large = triangle;
    UnitPoint large_center = center;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      large_center[axis] <<= shift;
      for (UnitPoint& vertex : large) {
        vertex[axis] <<= shift;
      }
    }
    REQUIRE(TriangleBoxTest(large).meets(large_center, half << shift) == expected);
  }
  CHECK(met > rounds / 10);
  CHECK(met < rounds - rounds / 10);
}

TEST_CASE("voxelise: one triangle, small or large -> each voxel it meets exactly once, and no other") {
  constexpr std::uint64_t kSeed = 77;
  SplitMix64 random(kSeed);
  for (int i = 0; i < 40 * kEffort; ++i) {
    const int level = 1 + static_cast<int>(random.below(4));
    const UnitTriangle triangle = random_triangle(random, level);
    std::vector<int> seen(std::size_t{1} << 3 * level);
    voxelise_triangle(triangle, [&](const UnitPoint& at) {
      REQUIRE(*std::min_element(at.begin(), at.end()) >= 0);
      REQUIRE(*std::max_element(at.begin(), at.end()) < 1 << level);
      ++seen[static_cast<std::size_t>((at[2] << level | at[1]) << level | at[0])];
    });
    for (int z = 0; z < 1 << level; ++z) {
      for (int y = 0; y < 1 << level; ++y) {
        for (int x = 0; x < 1 << level; ++x) {
          const UnitPoint center{x * 256 + 128, y * 256 + 128, z * 256 + 128};
          CAPTURE(kSeed);
          CAPTURE(i);
          REQUIRE(seen[static_cast<std::size_t>((z << level | y) << level | x)] ==
                  (clip_says_meets(triangle, center, 128) ? 1 : 0));
        }
      }
    }
  }
}

TEST_CASE("voxelise: the largest triangles of the largest world -> exact to the last unit") {
  constexpr std::int32_t kTop = (1 << 20) - 1;
  // The plane x + y + z = 2^20 + 1: the cube around its middle meets it, the cubes a unit off do not.
  const TriangleBoxTest test({{{kTop, 1, 1}, {1, kTop, 1}, {1, 1, kTop}}});
  constexpr std::int32_t kSum = kTop + 2;
  constexpr std::int32_t kThird = kSum / 3;
  constexpr std::int32_t kRest = kSum - 3 * kThird;
  CHECK(test.meets({kThird - 100, kThird - 100, kThird + kRest - 100}, 100));
  CHECK(test.meets({kThird + 100, kThird + 100, kThird + kRest + 100}, 100));
  CHECK_FALSE(test.meets({kThird - 100, kThird - 100, kThird + kRest - 101}, 100));
  CHECK_FALSE(test.meets({kThird + 100, kThird + 101, kThird + kRest + 100}, 100));
  // Every corner triple of the world, against its eighths and itself; the sanitizer watches the widths.
  for (int corners = 0; corners < 512; ++corners) {
    UnitTriangle triangle{};
    for (int i = 0; i < 9; ++i) {
      triangle[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)] =
          corners >> i & 1 ? kTop : 1;
    }
    const TriangleBoxTest corner_test(triangle);
    CHECK(corner_test.meets({1 << 19, 1 << 19, 1 << 19}, 1 << 19));
    const UnitPoint& first = triangle[0];
    CHECK(corner_test.meets({first[0] < 2 ? 1 << 18 : 3 << 18, first[1] < 2 ? 1 << 18 : 3 << 18,
                             first[2] < 2 ? 1 << 18 : 3 << 18},
                            1 << 18));
  }
}

TEST_CASE("voxelise: points on a middle, a face, an edge, a corner -> 1, 2, 4, 8 voxels") {
  const auto count = [](const UnitPoint& p) {
    int voxels = 0;
    voxelise_triangle({p, p, p}, [&](const UnitPoint&) { ++voxels; });
    return voxels;
  };
  CHECK(count({384, 384, 384}) == 1);
  CHECK(count({512, 384, 384}) == 2);
  CHECK(count({512, 384, 512}) == 4);
  CHECK(count({512, 512, 512}) == 8);
}

TEST_CASE("voxelise: any level -> the longest axis fills the world, the others are centred") {
  for (int level = 1; level <= 12; ++level) {
    const auto units = quantise_vertices(box(), level, true);
    UnitPoint low = units[0];
    UnitPoint high = units[0];
    for (const UnitPoint& p : units) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
    const std::int32_t world = kUnitsPerVoxel << level;
    CHECK(low[0] == 1);
    CHECK(high[0] == world - 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK(low[axis] + high[axis] == world);
    }
    CHECK(std::abs(high[1] - low[1] - 0.8 * (world - 2)) <= 1);
  }
  const VoxelSet voxels = voxels_of(box(), 6, true);
  CHECK(voxels.begin()->front() == 0);
  CHECK(voxels.rbegin()->front() == 63);
}

TEST_CASE("voxelise: map coordinates -> the same voxels as near zero") {
  TriangleMesh near;
  SplitMix64 random(6);
  for (std::uint32_t i = 0; i < 150; ++i) {
    near.positions.push_back({random.between(-4096, 4096) / 4096.0, random.between(-4096, 4096) / 4096.0,
                              random.between(-4096, 4096) / 4096.0});
    near.triangles.push_back({i, random.below(i + 1), random.below(i + 1)});
  }
  TriangleMesh far = near;
  for (auto& p : far.positions) {
    p = {p[0] + 6.0e5, p[1] + 4.0e6, p[2] - 120.5};
  }
  CHECK(voxels_of(near, 6) == voxels_of(far, 6));
}

TEST_CASE("voxelise: extreme magnitudes -> still fill the world") {
  for (const double scale : {1e-320, 1e-300, 1.0, 1e300, 1.7e308}) {
    TriangleMesh mesh = tetrahedron();
    for (auto& p : mesh.positions) {
      for (double& component : p) {
        component *= scale;
      }
    }
    CAPTURE(scale);
    CHECK(voxels_of(mesh, 4) == voxels_of(tetrahedron(), 4));
  }
}

TEST_CASE("voxelise: y up -> turned by (x, -z, y); z up -> left as it is") {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 4, 0}, {0, 0, 2}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  const auto turned = quantise_vertices(mesh, 8, false);
  CHECK(turned[2][2] == (256 << 8) - 1);  // y became height
  CHECK(turned[3][1] < turned[0][1]);     // +z became -y
  CHECK(turned[1][0] > turned[0][0]);     // x stays
  const auto straight = quantise_vertices(mesh, 8, true);
  CHECK(straight[2][1] == (256 << 8) - 1);
  CHECK(straight[3][2] > straight[0][2]);
}

TEST_CASE("voxelise: flat, thin and empty meshes -> one layer, one voxel, an error") {
  TriangleMesh quad{{{0, 5, 0}, {1, 5, 0}, {1, 5, 1}, {0, 5, 1}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  const VoxelSet layer = voxels_of(quad, 4);
  CHECK(layer.size() == 256);
  for (const auto& voxel : layer) {
    CHECK(voxel[2] == 8);
  }
  const TriangleMesh dot{{{3, 3, 3}}, {{0, 0, 0}}, {}};
  CHECK(voxels_of(dot, 4) == VoxelSet{{8, 8, 8}});
  CHECK(voxels_of(dot, 1) == VoxelSet{{1, 1, 1}});
  CHECK_THROWS_WITH_AS(voxels_of({{{0, 0, 0}}, {}, {}}, 4), "no triangles", InputError);
}

TEST_CASE("voxelise: a vertex that no triangle uses -> does not shrink the rest") {
  TriangleMesh mesh = tetrahedron();
  mesh.positions.push_back({1000, 1000, 1000});
  CHECK(voxels_of(mesh, 4) == voxels_of(tetrahedron(), 4));
}

TEST_CASE(
    "voxelise: two colours by turns on the same place -> the last one wins, also when it had been there "
    "before") {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Rgb red{255, 0, 0};
  const Rgb blue{0, 0, 255};
  mesh.colors = {red, red, red, blue, blue, blue};
  for (const bool red_last : {true, false}) {
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {0, 1, 2}, {0, 2, 1}};
    if (!red_last) {
      mesh.triangles.push_back({3, 4, 5});
    }
    const PaletteMap colors(mesh_colors(mesh, 6, true));
    std::map<std::array<std::int32_t, 3>, std::uint8_t> last;
    voxelise(mesh, 6, true, &colors, [&](const UnitPoint& at, int, std::uint8_t m) { last[at] = m; });
    CHECK_FALSE(last.empty());
    for (const auto& [voxel, material] : last) {
      CHECK(material == colors.index(red_last ? red : blue));
    }
  }
}

TEST_CASE("voxelise: few large triangles -> progress is reported between them") {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.1}};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {0, 2, 3}};
  std::vector<double> told;
  voxelise(
      mesh, 10, true, nullptr, [](auto, auto, auto) {}, [&](double done) { told.push_back(done); });
  CHECK(told.size() == 3);
  CHECK(std::is_sorted(told.begin(), told.end()));
}

TEST_CASE("voxelise: a sink that throws -> the exception comes through") {
  CHECK_THROWS_AS(voxelise(tetrahedron(), 3, false, nullptr, [](auto, auto, auto) { throw 1; }), int);
}

TEST_CASE("voxelise_cells: random triangles -> what each of them meets, with the last one's material") {
  SplitMix64 random(20);
  int blocks = 0;
  for (int round = 0; round < 60; ++round) {
    const int level = random.between(1, 6);
    const bool many_materials = round % 2 == 0;
    std::vector<CellTriangle> triangles;
    const int count = round < 50 ? random.between(1, 30) : 1500;
    for (int i = 0; i < count; ++i) {
      triangles.push_back({random_triangle(random, level), false, many_materials ? random.below(3) : 0});
    }
    CAPTURE(round);
    CHECK((by_cell(triangles, level, many_materials, &blocks) == by_triangle(triangles)));
  }
  CHECK(blocks > 100);
}
