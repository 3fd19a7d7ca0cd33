// Lit pictures whose rays somebody else traces: the core asks, and goes on from what it is told. Every byte is that of the
// picture for which it traced its rays itself.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>

#include "support/lit_cases.h"
#include "support/wide_cases.h"

namespace thimble::tests {

TEST_CASE("lit asked: any light, rays traced by others -> every byte of the core's own picture") {
  const BestInstructionSet after;
  std::mt19937_64 random(20260821);
  int drawn = 0;
  while (drawn < many_or_few(30, 5)) {
    const WideScene scene = drawn % 3 == 0 ? random_scene(random) : cabinet(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    const LitCase lit = random_light(random, scene.level);
    use_random_instruction_set(random);
    const HeapBytes map_bytes(wide::RayMap::bytes(scene.tree));
    Arena arena(map_bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
    const LitDrawn expected = draw_lit_core(scene, frame, lit);
    const LitDrawn ours =
        draw_lit_streams(scene, map, frame, lit, wide::lit_workspace_bytes(lit.effects, lit.scene), 1);
    CAPTURE(drawn);
    CAPTURE(lit.effects);
    REQUIRE(ours.pixels == expected.pixels);
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CHECK(ours.counts.rays[kind] == expected.counts.rays[kind]);
    }
    ++drawn;
  }
}

}  // namespace thimble::tests
