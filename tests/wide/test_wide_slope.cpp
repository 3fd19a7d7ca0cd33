// Slopes that a host keeps: every number is the core's, and so are the visits, whatever was looked up before.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include "support/lit_world.h"
#include "support/wide_cases.h"
#include "thimble/light/host/optics.h"
#include "wide/lit/slope_table.h"

namespace thimble::tests {
namespace {

using testing::LitWorld;
using testing::surface;

// A part of a world, solid or a shell; glass of two indices, a cloud and something opaque lie in one another.
struct Part {
  Vec3i middle;
  Vec3i slope;
  std::int32_t size;
  std::int32_t shell;
  int shape;  // ball, plate that leans, box

  bool holds(const Vec3i& at) const {
    const Vec3i d{at.x - middle.x, at.y - middle.y, at.z - middle.z};
    if (shape == 0) {
      const std::int32_t square = d.x * d.x + d.y * d.y + d.z * d.z;
      return square < size * size && square >= (size - shell) * (size - shell);
    }
    if (shape == 1) {
      const std::int32_t height = d.x * slope.x + d.y * slope.y + d.z * slope.z;
      return height < 8 * size && height >= 8 * (size - shell);
    }
    const std::int32_t most = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return most < size && most >= size - shell;
  }
};

void fill(std::mt19937_64& random, int level, LitWorld* world) {
  const std::int32_t side = std::int32_t{1} << level;
  for (std::int64_t i = pick(random, 1, 4); i > 0; --i) {
    Part part{random_voxel(random, 0, side), random_voxel(random, -12, 12), pick_int(random, 2, 14), 0,
              pick_int(random, 0, 2)};
    part.shell = static_cast<std::int32_t>(pick(random, 0, 1) == 0 ? pick(random, 1, 4) : 2 * side);
    const int material = pick_int(random, 0, 4);
    const std::int64_t gaps = pick(random, 0, 3) == 0 ? pick(random, 2, 9) : 1000000;
    Vec3i at;
    for (at.z = 0; at.z < side; ++at.z) {
      for (at.y = 0; at.y < side; ++at.y) {
        for (at.x = 0; at.x < side; ++at.x) {
          if (part.holds(at) && pick(random, 1, gaps) != 1) {
            world->voxel(at, material);
          }
        }
      }
    }
  }
  world->voxel({side / 2, side / 2, side / 2}, 0);
  world->surfaces[1] = surface(SurfaceKind::kGlass, {200, 220, 240});
  world->surfaces[1].index_q12 = 6000;
  world->surfaces[2] = surface(SurfaceKind::kGlass, {200, 220, 240});
  world->surfaces[2].index_q12 = 7000;
  world->surfaces[3] = surface(SurfaceKind::kMedia, {200, 220, 240});
  world->finish();
}

}  // namespace

TEST_CASE("wide: slopes that are kept -> the core's normals and visits, any table, any order of questions") {
  const BestInstructionSet after;
  std::mt19937_64 random(20261125);
  constexpr std::uint16_t kIndices[] = {0, 6000, 7000, kMinIndexQ12};
  int bent = 0;
  int asked = 0;
  for (int trial = 0; trial < many_or_few(40, 8); ++trial) {
    const auto level = pick_int(random, 3, 5);
    LitWorld world(level, 200000);
    fill(random, level, &world);
    const EffectSet effects = pick(random, 0, 1) == 0
                                  ? Effect::kSmoothNormals
                                  : Effect::kGlass | Effect::kMedia | Effect::kSmoothNormals;
    const lit::Frame frame{world.tree, world.camera, world.shading, world.scene, LitOptions(), effects};
    const auto count = static_cast<std::uint32_t>(4 << pick(random, 0, 8));
    std::vector<wide::KnownSlope> places(count);
    std::vector<wide::KnownWindow> windows(count / 4);
    wide::SlopeTable table(frame, places.data(), windows.data(), count);
    const std::int32_t side = std::int32_t{1} << world.tree.level();
    Vec3i voxel;
    int wrong = 0;
    for (int i = 0; i < many_or_few(2000, 600); ++i) {
      if (i % 50 == 0) {
        use_random_instruction_set(random);
      }
      // Near the last one most of the time, and often on the same face.
      if (pick(random, 0, 20) == 0) {
        voxel = random_voxel(random, 0, side - 1);
      } else if (pick(random, 0, 2) == 0) {
        voxel[pick_int(random, 0, 2)] += pick_int(random, -1, 1);
      }
      const Face face{pick_int(random, 0, 2), pick(random, 0, 1) == 0};
      const std::uint16_t index = kIndices[pick(random, 0, 3)];
      Vec3i raw = random_voxel(random, 0, 255);
      raw[face.axis] = 0;
      for (int axis = 0; axis < 3; ++axis) {
        raw[axis] += voxel[axis] * 256;
      }
      const Vec3Q8 at = LitWorld::point(raw);
      std::uint32_t expected_visits = 0;
      const Vec3i expected =
          lit::surface_normal(world.tree, {world.scene.surfaces, effects, index}, at, face, &expected_visits);
      std::uint32_t visits = 0;
      const Vec3i ours = table.normal(at, face, index, &visits);
      wrong += ours == expected && visits == expected_visits ? 0 : 1;
      bent += expected[face.axis] == kUnitQ14 || expected[face.axis] == -kUnitQ14 ? 0 : 1;
      ++asked;
    }
    CAPTURE(trial);
    REQUIRE(wrong == 0);
  }
  CHECK(bent > asked / 20);
}

}  // namespace thimble::tests
