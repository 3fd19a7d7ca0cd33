// Lit frames by the map of bricks are those of the tree, byte for byte: the sun, lamps, occlusion, mirrors, water.
#include "portable/brick_world.h"
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/light/map_render.h"

namespace thimble::portable {
namespace {

using namespace brick_world;

constexpr uint32_t kRowsBytes = 112;
constexpr uint32_t kSunBytes = 16;

constexpr Surface surface(const Rgb8& albedo, SurfaceKind kind = SurfaceKind::kDiffuse) {
  Surface result;
  result.albedo = albedo;
  result.kind = kind;
  return result;
}
constexpr Surface metal(const Rgb8& albedo, uint8_t roughness) {
  Surface result = surface(albedo, SurfaceKind::kMetal);
  result.mirror = 200;
  result.roughness = roughness;
  return result;
}
constexpr Surface kSurfaces[] = {surface({9, 9, 9}),         surface({200, 180, 140}),
                                 metal({190, 60, 50}, 0),    surface({60, 120, 210}, SurfaceKind::kEmit),
                                 metal({250, 250, 120}, 90), surface({90, 160, 70})};
// Two suns, and two lamps: in the open, and in what shines.
constexpr Light kLights[] = {
    {false, PackedVec3i{-5, -9, 16}, {230, 220, 200}, 0},
    {false, PackedVec3i{7, 2, 3}, {60, 70, 120}, 0},
    {true, PackedVec3i{9 * 256 + 128, 3 * 256, 9 * 256 + 77}, {500, 330, 180}, 9},
    {true, PackedVec3i{11 * 256, 10 * 256, 5 * 256}, {200, 300, 700}, 0},
};
constexpr size_t kSuns = 2;

struct State {
  LitScene scene;
  BrickMap map;
  SunBricks sun;
  LitCounts by_map;
  LitCounts by_tree;
  static void* operator new(size_t, void* at) { return at; }
  static void operator delete(void*, void*) {}
};
constexpr uint32_t kArenaBytes = kPoolBytes + kTreeBytes + kMapBytes + 2 * kRowsBytes + kSunBytes + 880;
static_assert(sizeof(State) + 64 <= 880);
static_assert(kArenaBytes <= kLitArenaBytes);

constexpr PixelFormat kFormats[] = {PixelFormat::kRgb565, PixelFormat::kGray4, PixelFormat::kRgb888,
                                    PixelFormat::kMono1};

// Not inlined, so that what one way keeps does not stand on the stack beside what the other does.
template <EffectSet kSet>
[[gnu::noinline]] Status draw_by_tree(const Check& check, State* state) {
  return render_lit_band<kSet>(check.world.compact, check.camera, check.shading, state->scene, check.band,
                               &state->by_tree);
}
template <EffectSet kSet, bool kLamps>
[[gnu::noinline]] Status draw_by_map(const Check& check, State* state) {
  // What is proven of the first sun alone, and only where there are shadows.
  const Span<const SunBricks> suns{&state->sun, (kSet & Effect::kShadows) != 0 ? 1U : 0U};
  return render_lit_band<kSet, kLamps>(check.world.compact, state->map, check.camera, check.shading,
                                       state->scene, suns, check.band, &state->by_map);
}

// A picture in bands, by the map and by the tree.
template <EffectSet kSet, bool kLamps>
[[gnu::noinline]] bool draw(Check& check, State* state, Bytes rows_bytes, Bytes wanted_bytes,
                            PixelFormat format) {
  const int32_t fits = static_cast<int32_t>(kRowsBytes / row_bytes(format, kWidth));
  const int32_t most = fits < 8 ? fits : 8;
  for (int32_t y = 0; y < kHeight; y += most) {
    const int32_t rows = kHeight - y < most ? kHeight - y : most;
    set_band(check, wanted_bytes, format, y, rows);
    const Bytes wanted = check.band.pixels;
    if (!check.equal(draw_by_tree<kSet>(check, state), Status::kOk, THIMBLE_WHAT("by the tree"))) {
      return false;
    }
    set_band(check, rows_bytes, format, y, rows);
    if (!check.equal(draw_by_map<kSet, kLamps>(check, state), Status::kOk, THIMBLE_WHAT("by the map")) ||
        !check.equal(ConstBytes(check.band.pixels), ConstBytes(wanted), THIMBLE_WHAT("pixels"))) {
      return false;
    }
  }
  return true;
}

template <EffectSet kSet, bool kLamps>
void light(Check& check, int index) {
  THIMBLE_REQUIRE(make_world(check));
  const Bytes bytes = check.arena.take(sizeof(State), alignof(State));
  const Bytes map = check.arena.take(kMapBytes);
  const Bytes sun = check.arena.take(kSunBytes);
  const Bytes rows = check.arena.take(kRowsBytes);
  const Bytes wanted = check.arena.take(kRowsBytes);
  THIMBLE_REQUIRE(wanted.size == kRowsBytes);
  State* state = new (bytes.data) State;
  THIMBLE_REQUIRE_OK(BrickMap::make(check.world.compact, map, &state->map));
  THIMBLE_REQUIRE_OK(SunBricks::make(state->map, kLights[0].place, sun, &state->sun));
  state->sun.prove();
  THIMBLE_REQUIRE(look(check, index));
  state->scene.surfaces = {kSurfaces, sizeof kSurfaces / sizeof kSurfaces[0]};
  state->scene.lights = {kLights, kLamps ? sizeof kLights / sizeof kLights[0] : kSuns};
  state->scene.has_shadows = true;
  state->scene.has_sky = true;
  state->scene.occlusion = {5, 180, 8};
  if constexpr ((kSet & Effect::kWater) != 0) {
    state->scene.has_water = true;
    state->scene.water = still_water({1, 2, 1}, 14, 13, 6 * 256 + 77);
    state->scene.water_material = surface({84, 176, 190}, SurfaceKind::kGlass);
    state->scene.water_material.index_q12 = 5460;
    state->scene.water_material.density_q8 = 30;
    state->scene.ripple_phase = 77;
  }
  for (const PixelFormat format : kFormats) {
    THIMBLE_REQUIRE((draw<kSet, kLamps>(check, state, rows, wanted, format)));
  }
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    THIMBLE_EQUAL(state->by_map.rays[kind], state->by_tree.rays[kind]);
    THIMBLE_CHECK(state->by_map.hits[kind] <= state->by_tree.hits[kind]);
    check.note(static_cast<int64_t>(state->by_map.hits[kind]));
  }
  // The way through the map reads next to no node.
  const bool is_fast = draws_fast(state->map, check.camera);
  THIMBLE_EQUAL(is_fast, index != kParallel);
  constexpr auto kPrimary = static_cast<int>(LitRayKind::kPrimary);
  THIMBLE_EQUAL(4 * state->by_map.node_visits[kPrimary] < state->by_tree.node_visits[kPrimary], is_fast);
}

constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;
constexpr EffectSet kOpen = kSun | Effect::kEmission | Effect::kSky;
constexpr EffectSet kAll = kOpen | Effect::kAmbientOcclusion;
constexpr EffectSet kMirrored = kOpen | Effect::kMirror;
constexpr EffectSet kAllMirrored = kAll | Effect::kMirror;
constexpr EffectSet kRippled = kOpen | Effect::kWater | Effect::kRipples;
constexpr Case kCases[] = {
    {"direct light by the map -> the tree's picture", kArenaBytes, light<Effect::kDirectLight, false>,
     kBefore},
    {"sun, shadows, what shines and sky by the map -> the tree's picture", kArenaBytes, light<kOpen, false>,
     kBefore},
    {"the same from inside the world -> the tree's picture", kArenaBytes, light<kOpen, false>, kInside},
    {"the same from far away -> the tree's picture", kArenaBytes, light<kOpen, false>, kFarAway},
    {"lamps and occlusion, too -> the tree's picture", kArenaBytes, light<kAll, true>, kBefore},
    {"lamps and occlusion along a diagonal -> the tree's picture", kArenaBytes, light<kAll, true>, kDiagonal},
    {"lamps and occlusion from inside the world -> the tree's picture", kArenaBytes, light<kAll, true>,
     kInside},
    {"lamps and occlusion from far away -> the tree's picture", kArenaBytes, light<kAll, true>, kFarAway},
    {"lamps and occlusion, a parallel camera -> the tree draws", kArenaBytes, light<kAll, true>, kParallel},
    {"metals, smooth and rough, that mirror -> the tree's picture", kArenaBytes, light<kMirrored, false>,
     kBefore},
    {"metals from inside the world -> the tree's picture", kArenaBytes, light<kMirrored, false>, kInside},
    {"metals, lamps and occlusion -> the tree's picture", kArenaBytes, light<kAllMirrored, true>, kBefore},
    {"metals, lamps and occlusion from far away -> the tree's picture", kArenaBytes,
     light<kAllMirrored, true>, kFarAway},
    {"water with ripples -> the tree's picture", kArenaBytes, light<kRippled, false>, kBefore},
    {"water from inside the world -> the tree's picture", kArenaBytes, light<kRippled, false>, kInside},
    {"water along a diagonal -> the tree's picture", kArenaBytes, light<kRippled, false>, kDiagonal},
    {"water from far away -> the tree's picture", kArenaBytes, light<kRippled, false>, kFarAway},
};

}  // namespace

const Group kMapLightGroup = group_of<kCases>("map_light", "cases_map_light.cpp");

}  // namespace thimble::portable
