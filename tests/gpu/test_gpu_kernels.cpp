// The GPU's kernels as C++: every picture and every hit is the core's, and no read leaves the buffers.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "support/compact_damage.h"
#include "support/frames.h"
#include "support/glsl.h"
#include "support/gpu_kernels.h"
#include "support/hard_frames.h"

namespace thimble::tests {
namespace {

constexpr Pairs kPairs[] = {Pairs::kAsNeeded, Pairs::kAlways};

// Both widths; adds the wrong hits and the reads outside.
void trace_everyhow(const CompactTree& tree, const std::vector<Ray>& rays, int* wrong,
                    std::uint64_t* outside) {
  const gpu::SceneWords scene = gpu::make_scene_words(tree);
  for (const Pairs pairs : kPairs) {
    const auto hits = trace_by_kernel(scene, {rays.data(), rays.size()}, pairs, outside);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Hit expected;
      REQUIRE(closest_hit(tree, rays[i], &expected) == Status::kOk);
      *wrong += same_hit(hits[i], expected) ? 0 : 1;
    }
  }
}

}  // namespace

TEST_CASE("gpu kernels: the golden frames -> every pixel is the core's") {
  check_golden_frames(kernel_engines());
}

TEST_CASE("gpu kernels: hard cameras in random and solid scenes -> every pixel is the core's") {
  check_frames({kernel_engines(),
                {worlds::kAny, worlds::kSolid},
                {cameras::kAny, cameras::kHard},
                39000,
                1'000'000,
                40'000,
                75});
}

TEST_CASE("gpu kernels: hard rays, whatever words they need -> every hit is the core's") {
  const int kScenes = many_or_few(120, 10);
  int wrong = 0;
  std::uint64_t outside = 0;
  for (int i = 0; i < kScenes; ++i) {
    const std::uint64_t seed = 77000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    const WideScene scene = i % 2 == 0 ? random_scene(random) : solid_scene(random, pick_int(random, 1, 12));
    trace_everyhow(scene.tree, accepted_rays(seed, scene.level, 400), &wrong, &outside);
  }
  CHECK(wrong == 0);
  CHECK(outside == 0);
}

TEST_CASE(
    "gpu kernels: worlds of every level, empty, full, of one voxel and of corners -> every hit is the "
    "core's") {
  int wrong = 0;
  std::uint64_t outside = 0;
  for (int level = kMinLevel; level <= kMaxLevel; ++level) {
    const std::int32_t last = (std::int32_t{1} << level) - 1;
    for (int kind = 0; kind < 4; ++kind) {
      CAPTURE(level);
      CAPTURE(kind);
      const WideScene scene = make_scene(level, [&](Octree* octree) {
        if (kind == 1) {
          REQUIRE(octree->insert_block({0, 0, 0}, level, 3) == Status::kOk);
        }
        if (kind >= 2) {
          REQUIRE(octree->insert({last, 0, last}, 7) == Status::kOk);
        }
        if (kind == 3) {
          REQUIRE(octree->insert({0, 0, 0}, 9) == Status::kOk);
        }
      });
      trace_everyhow(scene.tree, accepted_rays(static_cast<std::uint64_t>(level), level, 100), &wrong,
                     &outside);
    }
  }
  CHECK(wrong == 0);
  CHECK(outside == 0);
}

TEST_CASE("gpu kernels: damaged trees -> every ray ends within its bound, the bytes and the world") {
  const int kTrials = many_or_few(1500, 150);
  int traced = 0;
  std::uint64_t outside = 0;
  for (int i = 0; i < kTrials; ++i) {
    const std::uint64_t seed = 5000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    const WideScene sound = solid_scene(random, pick_int(random, 3, 7));
    std::vector<std::uint8_t> bytes(sound.tree.bytes(), sound.tree.bytes() + sound.tree.size_bytes());
    for (std::int64_t flips = pick(random, 1, 6); flips > 0; --flips) {
      bytes[static_cast<std::size_t>(pick(random, 16, static_cast<std::int64_t>(bytes.size()) - 1))] ^=
          static_cast<std::uint8_t>(1U << pick(random, 0, 7));
    }
    CompactTree tree;
    if (CompactTree::open({bytes.data(), bytes.size()}, &tree) != Status::kOk) {
      continue;
    }
    const std::vector<Ray> rays = accepted_rays(seed, tree.level(), 20);
    const gpu::SceneWords scene = gpu::make_scene_words(tree);
    for (const Hit& hit : trace_by_kernel(scene, {rays.data(), rays.size()}, kPairs[i % 2], &outside)) {
      CHECK(hit.kind != HitKind::kStepLimit);
      CHECK(hit.visits <= scene.parameters[gpu::kernel::kMostSteps]);
      for (int axis = 0; axis < 3 && hit.kind == HitKind::kHit; ++axis) {
        CHECK(hit.voxel[axis] >= 0);
        CHECK(hit.voxel[axis] < std::int32_t{1} << tree.level());
      }
      ++traced;
    }
  }
  CHECK(traced > 10 * kTrials);
  CHECK(outside == 0);  // the kernel checks every index
}

}  // namespace thimble::tests
