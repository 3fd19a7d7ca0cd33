// Lit pictures: a small scene with everything in it, by renderers for several sets of effects.
#include "golden/lit_table.h"
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"
#include "thimble/light/render.h"

namespace thimble::portable {
namespace {

constexpr int32_t kWidth = 40;
constexpr int32_t kHeight = 24;
constexpr int32_t kBandRows = 5;
constexpr uint32_t kPoolNodes = 128;
constexpr uint32_t kTreeBytes = 80 + 2 * kPoolNodes;
constexpr uint32_t kBandBytes = (kWidth * 3 * kBandRows + 7) & ~7;
// A LitScene of the widest machine, and what a set of counts takes.
constexpr uint32_t kStateBytes = 512;
constexpr uint32_t kArenaBytes = 8 * kPoolNodes + 8 + kTreeBytes + kBandBytes + kStateBytes;

static_assert(kArenaBytes <= kLitArenaBytes);

enum Material : uint8_t { kFloor, kWall, kSteel, kBottle, kLamp, kCloud };

constexpr Surface surface(const Rgb8& albedo, SurfaceKind kind) {
  Surface result;
  result.albedo = albedo;
  result.kind = kind;
  return result;
}
constexpr Surface rough_steel() {
  Surface steel = surface({222, 216, 200}, SurfaceKind::kMetal);
  steel.mirror = 200;
  steel.roughness = 40;
  return steel;
}
constexpr Surface kSurfaces[] = {
    surface({200, 180, 140}, SurfaceKind::kDiffuse),
    surface({190, 60, 50}, SurfaceKind::kDiffuse),
    rough_steel(),
    surface({190, 235, 210}, SurfaceKind::kGlass),
    surface({255, 210, 120}, SurfaceKind::kEmit),
    surface({210, 215, 235}, SurfaceKind::kMedia),
};
constexpr Light kLights[] = {
    {false, PackedVec3i{-5, -9, 16}, {230, 220, 200}, 0},
    {true, PackedVec3i{12 * 256 + 128, 10 * 256 + 128, 9 * 256 + 128}, {400, 330, 180}, 6},
};

constexpr SolidBox kBoxes[] = {
    {{{0, 0, 0}, {16, 8, 2}}, kFloor},    {{{0, 8, 0}, {16, 16, 4}}, kFloor},
    {{{0, 12, 4}, {16, 16, 12}}, kWall},  {{{4, 4, 2}, {8, 6, 10}}, kSteel},
    {{{8, 4, 4}, {12, 8, 8}}, kBottle},   {{{0, 8, 4}, {4, 12, 8}}, kCloud},
    {{{12, 10, 9}, {13, 11, 10}}, kLamp},
};

struct State {
  LitScene scene;
  LitCounts counts;
  uint32_t passed = 0;  ///< balls
  static void* operator new(size_t, void* at) { return at; }
  static void operator delete(void*, void*) {}
};
static_assert(sizeof(State) <= kStateBytes);

bool make_scene(Check& check, State** state) {
  if (!make_pool(check, kPoolNodes, 4, kBoxes)) {
    return false;
  }
  const Vec3Q8 eye = point_q8(3200, -3300, 3000);
  const Vec3i forward = look_at(eye, point_q8(1900, 2000, 900));
  check.shading = {};
  check.shading.background = {120, 150, 190};
  const Status set =
      check.camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(44), kWidth, kHeight, 0}, 4);
  const DepthRange range = depth_range(check.camera, {{0, 0, 0}, {16, 16, 16}});
  check.shading.near_q8 = range.near_q8;
  check.shading.far_q8 = range.far_q8;
  const Bytes bytes = check.arena.take(sizeof(State), alignof(State));
  if (bytes.empty() || !check.equal(set, Status::kOk, THIMBLE_WHAT("camera")) || !make_compact(check)) {
    return false;
  }
  *state = new (bytes.data) State;
  LitScene& scene = (*state)->scene;
  scene.surfaces = {kSurfaces, sizeof kSurfaces / sizeof kSurfaces[0]};
  scene.lights = {kLights, sizeof kLights / sizeof kLights[0]};
  scene.has_shadows = true;
  scene.has_sky = true;
  scene.fog.density_q16 = 700;
  scene.occlusion = {4, 200, 4};
  scene.has_water = true;
  scene.water = still_water({0, 0, 2}, 16, 8, 300);
  return true;
}

// In the air: one before the wall, one over the water before the steel; of places that no voxel has.
constexpr Ball ball(const Vec3i& center, int32_t half_q8) {
  Ball made;
  made.center = center;
  made.half_q8 = half_q8;
  made.top_q8 = center.z + half_q8;
  made.surface = surface({250, 92, 64}, SurfaceKind::kDiffuse);
  return made;
}
constexpr Ball kBalls[] = {ball({9 * 256 + 77, 9 * 256 + 31, 10 * 256 + 5}, 300),
                           ball({6 * 256 + 19, 2 * 256 + 40, 5 * 256 + 201}, 202)};

template <EffectSet kSet, bool kHasBalls>
Status draw_band(Check& check, State* state) {
  if constexpr (kHasBalls) {
    const DrawnBalls drawn{{kBalls, sizeof kBalls / sizeof kBalls[0]}, &state->passed};
    return render_lit_band<kSet>(check.world.compact, drawn, check.camera, check.shading, state->scene,
                                 check.band, &state->counts);
  } else {
    return render_lit_band<kSet>(check.world.compact, check.camera, check.shading, state->scene, check.band,
                                 &state->counts);
  }
}

// The picture in bands of that many rows.
template <EffectSet kSet, bool kHasBalls>
[[gnu::noinline]] bool draw(Check& check, State* state, Bytes bytes, PixelFormat format, int32_t band_rows,
                            uint32_t* crc) {
  *crc = 0;
  for (int32_t y = 0; y < kHeight; y += band_rows) {
    const int32_t rows = kHeight - y < band_rows ? kHeight - y : band_rows;
    check.band = Band{};
    check.band.pixels = bytes.subspan(0, band_bytes(format, kWidth, rows));
    check.band.format = format;
    check.band.first_row = y;
    check.band.rows = rows;
    if (!check.equal(draw_band<kSet, kHasBalls>(check, state), Status::kOk,
                     THIMBLE_WHAT("render_lit_band"))) {
      return false;
    }
    *crc = crc32(check.band.pixels, *crc);
  }
  return true;
}

template <EffectSet kSet, bool kHasBalls = false>
void run(Check& check, int index) {
  State* state = nullptr;
  THIMBLE_REQUIRE(make_scene(check, &state) && state != nullptr);
  const Bytes bytes = check.arena.take(kBandBytes, alignof(uint8_t));
  THIMBLE_REQUIRE(!bytes.empty());
  const golden::LitEntry& wanted = golden::kLitTable[index];
  uint32_t crc = 0;
  THIMBLE_REQUIRE((draw<kSet, kHasBalls>(check, state, bytes, wanted.format, kBandRows, &crc)));
  THIMBLE_EQUAL(crc, wanted.crc32);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    check.note(static_cast<int64_t>(state->counts.rays[kind]));
    check.note(static_cast<int64_t>(state->counts.hits[kind]));
    check.note(static_cast<int64_t>(state->counts.node_visits[kind]));
  }
  THIMBLE_EQUAL(state->passed, kHasBalls ? 3U : 0U);
  // No effect, no ray for it.
  constexpr EffectSet kSends[kLitRayKinds] = {Effect::kAll,
                                              Effect::kShadows,
                                              Effect::kAmbientOcclusion,
                                              Effect::kMirror,
                                              Effect::kGlass | Effect::kWater,
                                              Effect::kMedia | Effect::kGlass,
                                              Effect::kWater};
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    THIMBLE_CHECK((kSet & kSends[kind]) != 0 || state->counts.rays[kind] == 0);
  }
  THIMBLE_REQUIRE((draw<kSet, kHasBalls>(check, state, bytes, wanted.format, 1, &crc)));
  THIMBLE_EQUAL(crc, wanted.crc32);
}

constexpr EffectSet kSunlit = Effect::kDirectLight | Effect::kShadows;
constexpr EffectSet kDry =
    kSunlit | Effect::kAmbientOcclusion | Effect::kEmission | Effect::kMirror | Effect::kGlass | Effect::kSky;
// Every effect that a scene may call for by what is in it.
constexpr EffectSet kOfScene = kDry | Effect::kMedia | Effect::kWater | Effect::kFog | Effect::kDepthCue;
constexpr Case kCases[] = {
    {"direct light and shadows, 16 greys -> the golden picture", kArenaBytes, run<kSunlit>, 0},
    {"the same in black and white -> the golden picture", kArenaBytes, run<kSunlit>, 1},
    {"shadows, occlusion, a lamp, a mirror, glass, sky in 16 bits -> the golden picture", kArenaBytes,
     run<kDry>, 2},
    {"every effect of the scene's own, in 24 bits -> the golden picture", kArenaBytes, run<kOfScene>, 3},
    {"smooth normals with shadows, occlusion, a lamp, a mirror, glass, sky -> the golden picture",
     kArenaBytes, run<kDry | Effect::kSmoothNormals>, 4},
    {"direct light and shadows with dark edges, 16 greys -> the golden picture", kArenaBytes,
     run<kSunlit | Effect::kEdges>, 5},
    {"balls beside the tree, with shadows and in a mirror -> the golden picture", kArenaBytes,
     run<kSunlit | Effect::kMirror, true>, 6},
};

}  // namespace

const Group kLitGroup = group_of<kCases>("lit", "cases_lit.cpp");

}  // namespace thimble::portable
