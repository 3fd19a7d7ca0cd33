// Lit pictures of any scene, light and effects, and the CRC-32 of each dozen that was written down: whatever changes a
// pixel, or what is counted, is seen here first. Whether they are right others say.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "support/lit_cases.h"
#include "support/wide_cases.h"
#include "thimble/base/memory.h"

namespace thimble::tests {
namespace {

// The scenes of wide_cases.h draw some numbers in an order that the language leaves open; these were written down by gcc.
#if defined(__clang__)
constexpr bool kSameScenes = false;
#else
constexpr bool kSameScenes = true;
#endif

// What a dozen is about: some effects are always on.
struct Dozen {
  EffectSet always;
  std::uint32_t crc32;
};

std::uint32_t drawn_dozen(EffectSet always, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uint32_t crc = 0;
  int drawn = 0;
  while (drawn < 12) {
    const WideScene scene = drawn % 4 == 0 ? random_scene(random) : cabinet(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    LitCase lit = random_light(random, scene.level);
    while ((always & Effect::kWater) != 0 && !lit.scene.has_water) {
      lit = random_light(random, scene.level);
    }
    lit.effects |= always;
    if (kHasPanelFormats && drawn % 3 == 0) {
      frame.band.format = static_cast<PixelFormat>(pick(random, 0, 13));
      frame.band.stride_bytes = 0;
      frame.band.first_row = 0;
      frame.band.rows = frame.camera.height_px();
    }
    const LitDrawn picture = draw_lit_core(scene, frame, lit);
    crc = crc32({picture.pixels.data(), picture.pixels.size()}, crc);
    std::vector<std::uint64_t> counts;
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      counts.push_back(picture.counts.rays[kind]);
      counts.push_back(picture.counts.hits[kind]);
      counts.push_back(picture.counts.node_visits[kind]);
    }
    counts.push_back(picture.counts.pending_high_water);
    counts.push_back(picture.counts.step_limited);
    std::vector<std::uint8_t> bytes(8 * counts.size());
    std::memcpy(bytes.data(), counts.data(), bytes.size());
    crc = crc32({bytes.data(), bytes.size()}, crc);
    ++drawn;
  }
  return crc;
}

// Every dozen of rows[]; the first seed is that of the first row.
template <std::size_t kRows>
void check_dozens(const Dozen (&rows)[kRows], std::uint64_t seed) {
  for (const Dozen& one : rows) {
    CAPTURE(seed);
    const std::uint32_t crc = drawn_dozen(one.always, seed++);
    CAPTURE(crc);
    CHECK((crc == one.crc32 || !kSameScenes));
  }
}

TEST_CASE("lit written: light, shadows, glass, air and edges -> the CRC-32 of each dozen pictures") {
  constexpr Dozen kRows[] = {
      {Effect::kNone, 2644654851},
      {Effect::kAll, 894948768},
      {Effect::kDirectLight | Effect::kShadows | Effect::kGlass, 3060095512},
      {Effect::kMedia | Effect::kGlass | Effect::kShadows | Effect::kDirectLight, 938224993},
      {Effect::kFog | Effect::kSky | Effect::kMirror, 2976482810},
      {Effect::kEdges | Effect::kDirectLight, 3757632494},
      {Effect::kEdges | Effect::kSmoothNormals, 2587953202},
  };
  check_dozens(kRows, 20260831);
}

TEST_CASE("lit written: water, still, in waves and rippled -> the CRC-32 of each dozen pictures") {
  constexpr Dozen kRows[] = {
      {Effect::kWater | Effect::kGlass | Effect::kSky, 1664715875},
      {Effect::kWater | Effect::kSky, 1652377551},
      {Effect::kWater | Effect::kDirectLight | Effect::kRipples, 23392129},
      {Effect::kWater | Effect::kGlass | Effect::kRipples | Effect::kSky, 2673953305},
      {Effect::kWater | Effect::kSmoothNormals | Effect::kGlass | Effect::kShadows | Effect::kDirectLight,
       2133628392},
      {Effect::kWater | Effect::kGlass | Effect::kMedia | Effect::kFog, 1223419803},
      {Effect::kAll, 3811710465},
      {Effect::kWater | Effect::kRipples, 1994962796},
      {Effect::kWater | Effect::kRipples | Effect::kMirror | Effect::kSky, 4029388927},
      {Effect::kWater | Effect::kRipples | Effect::kGlass | Effect::kShadows | Effect::kDirectLight,
       936140484},
      {Effect::kWater | Effect::kGlass | Effect::kMirror | Effect::kSky, 55319245},
  };
  check_dozens(kRows, 20260851);
}

TEST_CASE("lit written: smooth surfaces -> the CRC-32 of each dozen pictures") {
  constexpr Dozen kRows[] = {
      {Effect::kSmoothNormals | Effect::kGlass | Effect::kMirror, 1753105840},
      {Effect::kSmoothNormals | Effect::kGlass | Effect::kSky, 3895425953},
      {Effect::kSmoothNormals | Effect::kMirror | Effect::kSky, 603326442},
      {Effect::kSmoothNormals | Effect::kDirectLight | Effect::kAmbientOcclusion, 1309258442},
      {Effect::kSmoothNormals | Effect::kDirectLight | Effect::kMedia, 1985992703},
      {Effect::kSmoothNormals | Effect::kEmitterLight | Effect::kEmission, 2277124787},
  };
  check_dozens(kRows, 20260871);
}

}  // namespace
}  // namespace thimble::tests
