// The light on many faces at once, on points of edges and corners too: what the core finds for each alone.
#include <doctest/doctest.h>

#include <iterator>
#include <random>
#include <vector>

#include "support/lit_cases.h"
#include "support/lit_world.h"
#include "support/wide_cases.h"
#include "wide/lit/face_lights.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {
namespace {

constexpr EffectSet kMost = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                            Effect::kEmission | Effect::kGlass | Effect::kMedia | Effect::kWater;

// A set of effects, and the core's colour of a face with it.
struct ColorOfFaces {
  EffectSet set;
  lit::Color (*face_color)(lit::Frame& frame, const lit::Spot& spot);
};
template <EffectSet kSet>
constexpr ColorOfFaces with() {
  return {kSet, lit::face_color<kSet, lit::Frame>};
}
constexpr ColorOfFaces kSets[] = {
    with<kMost>(),
    with<kMost & ~(Effect::kGlass | Effect::kMedia)>(),
    with<kMost & ~(Effect::kGlass | Effect::kMedia | Effect::kWater)>(),
    with<kMost & ~(Effect::kWater | Effect::kEmission)>(),
    with<kMost & ~Effect::kShadows>(),
    with<kMost & ~Effect::kAmbientOcclusion>(),
    with<kMost & ~(Effect::kDirectLight | Effect::kShadows)>(),
    with<Effect::kDirectLight>(),
    with<Effect::kAmbientOcclusion>(),
};

// A point of a face of a voxel: of three in four on an edge of it, or on a corner. Of one in eight the camera is inside.
lit::Spot random_spot(std::mt19937_64& random, int level) {
  const std::int64_t side = std::int64_t{1} << level;
  lit::Spot spot;
  spot.face = {pick_int(random, 0, 2), pick(random, 0, 1) == 0};
  const Vec3i voxel = random_voxel(random, 0, side);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t part = axis == spot.face.axis || pick(random, 0, 1) == 0 ? 0 : pick(random, 1, 255);
    spot.at[axis] = Q8::from_raw(static_cast<std::int32_t>(voxel[axis] * 256 + part));
  }
  spot.surface.albedo = {255, 255, 255};
  spot.inside = pick(random, 0, 7) == 0;
  return spot;
}

}  // namespace

TEST_CASE("wide: the light on many faces, on edges and corners, with any effects -> the core's") {
  const BestInstructionSet after;
  std::mt19937_64 random(79);
  int wrong = 0;
  int lit_up = 0;
  const int trials = many_or_few(180, 60);
  for (int trial = 0; trial < trials; ++trial) {
    const ColorOfFaces& of = kSets[static_cast<std::size_t>(trial) % std::size(kSets)];
    const EffectSet set = of.set;
    use_random_instruction_set(random);
    CAPTURE(trial);
    CAPTURE(set);
    const WideScene scene = cabinet(random);
    LitCase lit = random_light(random, scene.level);
    for (Surface& one : lit.surfaces) {
      one.kind = pick(random, 0, 1) == 0 ? SurfaceKind::kGlass : one.kind;
      one.density_q8 = static_cast<std::uint16_t>(pick(random, 0, 20));
    }
    const wide::LitMedia media = wide::lit_media(set, lit.scene);
    const HeapBytes map_bytes(wide::RayMap::bytes(scene.tree, media.span()));
    Arena arena(map_bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map, media.span()) == Status::kOk);
    const Camera camera;
    const Shading shading;
    lit::Frame frame{scene.tree, camera, shading, lit.scene, lit.options, set};
    constexpr std::uint32_t kCount = 200;
    const wide::FaceLightsShape shape(set, lit.scene, kCount);
    wide::ArrayArena counter(nullptr);
    wide::FaceLightsParts parts;
    parts.lay_out(shape, &counter);
    const HeapBytes bytes(counter.used() + wide::ArrayArena::kAlignment);
    wide::ArrayArena taker(wide::ArrayArena::aligned(bytes.span().data));
    wide::FaceLights lights(frame, map, shape, &taker);
    std::vector<lit::Spot> spots;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const lit::Spot spot = random_spot(random, scene.level);
      int face = 2 * spot.face.axis + (spot.face.negative ? 0 : 1);
      face += spot.inside ? static_cast<int>(wide::FaceLights::kInside) : 0;
      lights.faces()[i] = {spot.at, i, static_cast<std::uint8_t>(face), 0};
      spots.push_back(spot);
    }
    lights.shine(0);
    lights.shine(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const lit::Color expected = of.face_color(frame, spots[i]);
      const lit::Color ours = lit::lit_color(spots[i], lights.light()[i]);
      for (int c = 0; c < 3; ++c) {
        wrong += ours.c[c] == expected.c[c] ? 0 : 1;
        lit_up += expected.c[c] != 0 && expected.c[c] != lit::kMaxChannel ? 1 : 0;
      }
    }
    const LitCounts counts = lights.counts();
    constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
    constexpr int kAround = static_cast<int>(LitRayKind::kOcclusion);
    CHECK(counts.rays[kShadow] == frame.counts.rays[kShadow]);
    CHECK(counts.hits[kShadow] <= frame.counts.hits[kShadow]);
    CHECK(counts.rays[kAround] == frame.counts.rays[kAround]);
    CHECK(counts.hits[kAround] <= frame.counts.hits[kAround]);
  }
  CHECK(wrong == 0);
  CHECK(lit_up > 110 * trials);
}

}  // namespace thimble::tests
