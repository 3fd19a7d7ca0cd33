// Lit pictures by streams of rays: every byte is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "support/lit_cases.h"
#include "support/lit_world.h"
#include "support/wide_cases.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {
namespace {

// Nothing with secondary rays: what most pictures are.
LitCase random_opaque_light(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  lit.effects = static_cast<EffectSet>(pick(random, 0, Effect::kAll)) &
                (Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kEmission |
                 Effect::kSky | Effect::kEmitterLight);
  lit.effects |= pick(random, 0, 1) == 0 ? Effect::kDirectLight | Effect::kShadows : Effect::kSky;
  return lit;
}

// Many lamps: in what is solid, on faces and corners of voxels, far away, and such as reach nowhere; most
// materials are clear, or shine.
LitCase random_lamps(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  const std::int64_t side = std::int64_t{1} << level;
  lit.lights.resize(std::min<std::size_t>(lit.lights.size(), 2));
  for (std::int64_t i = pick(random, 1, 12); i > 0; --i) {
    const bool is_far = pick(random, 0, 5) == 0;
    Vec3i place =
        is_far ? random_voxel(random, -4 * 256 * side, 5 * 256 * side) : random_voxel(random, 0, 256 * side);
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = pick(random, 0, 2) == 0 ? place[axis] / 256 * 256 : place[axis];
    }
    Light light = testing::lamp(place);
    for (PackedU16& channel : light.color_q8) {
      channel = static_cast<std::uint16_t>(pick(random, 0, 3) == 0 ? 65535 : pick(random, 0, 3) * 200);
    }
    light.reach =
        static_cast<std::uint16_t>(pick(random, 0, 4) == 0 ? pick(random, 0, 2) : pick(random, 0, 65535));
    lit.lights.push_back(light);
  }
  constexpr SurfaceKind kKinds[] = {SurfaceKind::kGlass, SurfaceKind::kEmit, SurfaceKind::kMedia,
                                    SurfaceKind::kDiffuse};
  for (Surface& one : lit.surfaces) {
    one.kind = kKinds[pick(random, 0, 3)];
    one.density_q8 = static_cast<std::uint16_t>(pick(random, 0, 40));
  }
  lit.effects |= Effect::kDirectLight | Effect::kShadows;
  lit.effects &= ~(pick(random, 0, 3) == 0 ? Effect::kNone : Effect::kSmoothNormals);
  lit.scene.lights = {lit.lights.data(), lit.lights.size()};
  return lit;
}

// Slopes of everything, most of the time with glass and mirrors.
LitCase random_smooth_light(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  lit.effects |= Effect::kSmoothNormals | Effect::kDirectLight;
  lit.effects &=
      pick(random, 0, 1) == 0 ? Effect::kAll : ~(Effect::kFog | Effect::kWater | Effect::kDepthCue);
  lit.effects |= pick(random, 0, 2) == 0 ? Effect::kNone : Effect::kGlass | Effect::kMirror;
  // One in four reaches far.
  const std::int64_t reach = pick(random, 1, 40);
  lit.scene.occlusion.reach = static_cast<std::uint16_t>(reach > 30 ? 65535 - 6553 * (40 - reach) : reach);
  return lit;
}

// Pixels here and there: three bytes each, as the core draws them alone.
void check_places(std::mt19937_64& random, const WideScene& scene, const wide::RayMap& map,
                  const FrameCase& frame, const LitCase& lit, const Bytes& workspace, int threads) {
  std::vector<wide::PixelPlace> places;
  std::vector<std::uint8_t> expected;
  for (std::int64_t i = pick(random, 0, 100); i > 0; --i) {
    const auto x = pick_int(random, 0, frame.camera.width_px() - 1);
    const auto y = pick_int(random, 0, frame.camera.height_px() - 1);
    std::uint8_t pixel[3];
    CHECK(render_lit_band(lit.effects, scene.tree, frame.camera.window(x, y, 1, 1), frame.shading, lit.scene,
                          {Bytes(pixel, 3), PixelFormat::kRgb888, 0, 0, 1}, nullptr,
                          lit.options) == Status::kOk);
    expected.insert(expected.end(), pixel, pixel + 3);
    places.push_back({x, y});
  }
  std::vector<std::uint8_t> drawn(expected.size(), 0xA5);
  const Bytes rgb(drawn.data(), drawn.size());
  const auto draw = [&](const Bytes& into) {
    return wide::render_lit_pixels(lit.effects, map, frame.camera, frame.shading, lit.scene,
                                   {places.data(), places.size()}, into, workspace, threads_of(threads),
                                   nullptr, lit.options);
  };
  if (!places.empty()) {
    CHECK(draw(rgb.subspan(1)) == Status::kOutOfMemory);
    CHECK(drawn[0] == 0xA5);
  }
  REQUIRE(draw(rgb) == Status::kOk);
  REQUIRE(drawn == expected);
}

// Draws so many random frames, and compares every byte and count with the core's.
void check_lit_frames(std::uint64_t seed, int frames,
                      LitCase (*make_light)(std::mt19937_64& random, int level)) {
  const BestInstructionSet after;
  std::mt19937_64 random(seed);
  int drawn = 0;
  int lit_up = 0;
  while (drawn < frames) {
    const WideScene scene = pick(random, 0, 2) == 0 ? random_scene(random) : cabinet(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    const LitCase lit = make_light(random, scene.level);
    if (kHasPanelFormats && pick(random, 0, 2) == 0) {
      frame.band.format = static_cast<PixelFormat>(pick(random, 0, 13));
      frame.band.stride_bytes = 0;
      if (has_pages(frame.band.format)) {
        frame.band.first_row = 0;
        frame.band.rows = frame.camera.height_px();
      }
    }
    use_random_instruction_set(random);
    const HeapBytes map_bytes(wide::RayMap::bytes(scene.tree));
    Arena arena(map_bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
    const int threads = pick_int(random, 1, 3);
    const std::size_t workspace = pick(random, 0, 1) == 0
                                      ? wide::least_lit_workspace_bytes(lit.effects, lit.scene)
                                      : wide::lit_workspace_bytes(lit.effects, lit.scene) *
                                            static_cast<std::size_t>(pick(random, 1, threads));
    CAPTURE(drawn);
    CAPTURE(scene.what);
    CAPTURE(lit.effects);
    CAPTURE(threads);
    CAPTURE(frame.band.format);
    CAPTURE(wide::instruction_set());
    const LitDrawn expected = draw_lit_core(scene, frame, lit);
    const LitDrawn ours = draw_lit_streams(scene, map, frame, lit, workspace, threads);
    REQUIRE(ours.pixels == expected.pixels);
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CAPTURE(kind);
      REQUIRE(ours.counts.rays[kind] == expected.counts.rays[kind]);
      REQUIRE(ours.counts.hits[kind] <= expected.counts.hits[kind]);
      const bool ends =
          kind == static_cast<int>(LitRayKind::kOcclusion) || kind == static_cast<int>(LitRayKind::kShadow);
      REQUIRE((ends || ours.counts.hits[kind] == expected.counts.hits[kind]));
    }
    REQUIRE(ours.counts.pending_high_water == expected.counts.pending_high_water);
    if (drawn % 4 == 0) {
      const HeapBytes of_places(workspace);
      check_places(random, scene, map, frame, lit, of_places.span(), threads);
    }
    lit_up += expected.counts.hits[0] != 0 ? 1 : 0;
    ++drawn;
  }
  CHECK(lit_up > frames / 3);
}

}  // namespace

TEST_CASE("wide: lit scenes of any kind -> every byte is the core's") {
  check_lit_frames(20261123, many_or_few(600, 40), random_light);
}
TEST_CASE("wide: lit scenes in which rays end where they hit -> every byte is the core's") {
  check_lit_frames(20261124, many_or_few(400, 15), random_opaque_light);
}

TEST_CASE("wide: many lamps, in solids, behind glass and out of reach -> every byte is the core's") {
  check_lit_frames(20261125, many_or_few(300, 20), random_lamps);
}

TEST_CASE("wide: lit scenes with slopes -> every byte is the core's") {
  check_lit_frames(20261126, many_or_few(80, 10), random_smooth_light);
}

TEST_CASE("wide: a lit picture's errors are the core's, with nothing drawn") {
  std::mt19937_64 random(5);
  const WideScene scene = cabinet(random);
  FrameCase frame;
  while (!random_frame(random, scene, &frame)) {
  }
  LitScene lit;
  std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
  frame.band.pixels = Bytes(pixels.data(), pixels.size());
  const wide::RayMap map(scene.tree);
  const HeapBytes workspace(wide::least_lit_workspace_bytes(Effect::kSky, lit));
  const auto status_of = [&](const Band& band, const Bytes& work) {
    return wide::render_lit(Effect::kSky, map, frame.camera, frame.shading, lit, band, work);
  };
  CHECK(status_of(frame.band, workspace.span().subspan(1)) == Status::kOutOfMemory);
  lit.bounces = kMaxBounces + 1;
  CHECK(status_of(frame.band, workspace.span()) == Status::kOutOfRange);
  lit.bounces = 0;
  Band beyond = frame.band;
  beyond.first_row = frame.camera.height_px();
  beyond.rows = 1;
  CHECK(status_of(beyond, workspace.span()) ==
        render_lit_band(Effect::kSky, scene.tree, frame.camera, frame.shading, lit, beyond));
  CHECK(std::all_of(pixels.begin(), pixels.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
  // The least is enough.
  CHECK(status_of(frame.band, workspace.span()) == Status::kOk);
}

}  // namespace thimble::tests
