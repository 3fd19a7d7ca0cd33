// Lit pictures by streams of rays: every byte is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "support/lit_world.h"
#include "support/wide_cases.h"
#include "wide/lit/kernels.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {
namespace {

using testing::lamp;
using testing::sun;
using testing::surface;

std::uint8_t any_byte(std::mt19937_64& random) {
  return static_cast<std::uint8_t>(pick(random, 0, 255));
}
Rgb8 any_color(std::mt19937_64& random) {
  return {any_byte(random), any_byte(random), any_byte(random)};
}

// What light does in a scene of the world; `water` keeps the heights.
struct LitCase {
  LitScene scene;
  EffectSet effects = Effect::kNone;
  LitOptions options;
  std::vector<Surface> surfaces;
  std::vector<Light> lights;
  std::vector<std::int32_t> heights;
};

void make_surfaces(std::mt19937_64& random, LitCase* lit) {
  for (std::int64_t i = pick(random, 0, 9) == 0 ? 0 : pick(random, 1, 200); i > 0; --i) {
    Surface one = surface(static_cast<SurfaceKind>(pick(random, 0, 4)), any_color(random));
    one.roughness = pick(random, 0, 1) == 0 ? std::uint8_t{0} : any_byte(random);
    one.mirror = pick(random, 0, 1) == 0 ? std::uint8_t{255} : any_byte(random);
    one.index_q12 = pick(random, 0, 3) == 0
                        ? kMinIndexQ12
                        : static_cast<std::uint16_t>(pick(random, kMinIndexQ12, kMaxIndexQ12));
    one.density_q8 = static_cast<std::uint16_t>(pick(random, 0, 300));
    one.emission_q8 = static_cast<std::uint16_t>(pick(random, 0, 1000));
    lit->surfaces.push_back(one);
  }
}

void make_lights(std::mt19937_64& random, int level, LitCase* lit) {
  const std::int64_t world = std::int64_t{256} << level;
  for (std::int64_t i = pick(random, 0, pick(random, 0, 20) == 0 ? 100 : 4); i > 0; --i) {
    const bool is_point = pick(random, 0, 1) == 0;
    Vec3i place = is_point ? random_voxel(random, -world, 2 * world) : random_voxel(random, -16384, 16384);
    if (pick(random, 0, 3) == 0) {
      place[static_cast<int>(pick(random, 0, 2))] = is_point ? 256 : 0;
    }
    if (!is_point && place == Vec3i{}) {
      place.z = 1;
    }
    Light light = is_point ? lamp(place) : sun(place);
    for (PackedU16& channel : light.color_q8) {
      channel = static_cast<std::uint16_t>(pick(random, 0, 600));
    }
    light.reach = static_cast<std::uint16_t>(pick(random, 0, 200));
    lit->lights.push_back(light);
  }
}

void make_water(std::mt19937_64& random, int level, LitCase* lit) {
  const std::int64_t side = std::int64_t{1} << level;
  const Vec3i corner = random_voxel(random, 0, side - 1);
  const auto width = static_cast<std::int32_t>(pick(random, 1, std::min<std::int64_t>(side - corner.x, 40)));
  const auto depth = static_cast<std::int32_t>(pick(random, 1, std::min<std::int64_t>(side - corner.y, 40)));
  const auto height = static_cast<std::int32_t>(pick(random, 0, (side - corner.z) * 256));
  lit->scene.has_water = true;
  lit->scene.water = still_water(corner, width, depth, height);
  if (pick(random, 0, 1) == 0) {
    lit->heights.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(depth));
    std::int32_t lowest = INT32_MAX;
    std::int32_t highest = 0;
    for (std::int32_t& one : lit->heights) {
      one = height * 256 + static_cast<std::int32_t>(pick(random, 0, 65536));
      lowest = std::min(lowest, (one + 128) >> 8);
      highest = std::max(highest, (one + 128) >> 8);
    }
    lit->scene.water.lowest_q8 = lowest;
    lit->scene.water.highest_q8 = highest;
    lit->scene.water.heights_q16 = lit->heights.data();
  }
}

LitCase random_light(std::mt19937_64& random, int level) {
  LitCase lit;
  make_surfaces(random, &lit);
  make_lights(random, level, &lit);
  make_water(random, level, &lit);
  LitScene& scene = lit.scene;
  for (std::uint16_t& channel : scene.ambient_q8) {
    channel = static_cast<std::uint16_t>(pick(random, 0, 300));
  }
  scene.sky = {any_color(random), any_color(random), any_color(random)};
  scene.fog = {any_color(random), static_cast<std::uint32_t>(pick(random, 0, 3000))};
  constexpr std::uint8_t kRays[] = {0, 4, 4, 8, 16, 32};
  scene.occlusion = {kRays[pick(random, 0, 5)], any_byte(random),
                     static_cast<std::uint16_t>(pick(random, 0, pick(random, 0, 3) == 0 ? 65535 : 30))};
  scene.bounces = static_cast<std::uint8_t>(pick(random, 0, 5));
  // All of them, one, or any.
  const std::int64_t kind = pick(random, 0, 5);
  lit.effects = kind == 0   ? Effect::kAll
                : kind == 1 ? EffectSet{1} << pick(random, 0, Effect::kCount - 1)
                            : static_cast<EffectSet>(pick(random, 0, Effect::kAll));
  lit.options.dither = pick(random, 0, 1) == 0;
  return lit;
}

// Boxes and voxels of all materials close together, so that rays go far.
WideScene cabinet(std::mt19937_64& random) {
  const int level = static_cast<int>(pick(random, 3, 7));
  const std::int32_t side = std::int32_t{1} << level;
  WideScene scene = make_scene(level, [&](Octree* octree) {
    for (std::int64_t i = pick(random, 5, 40); i > 0; --i) {
      const Vec3i at = random_voxel(random, 0, side - 1);
      const Vec3i size = random_voxel(random, 1, std::max(1, side / 3));
      const Vec3i end{std::min(side, at.x + size.x), std::min(side, at.y + size.y),
                      std::min(side, at.z + size.z)};
      (void)octree->insert_box({at, end}, static_cast<std::uint8_t>(pick(random, 0, 12)));
    }
    for (std::int64_t i = pick(random, 0, 200); i > 0; --i) {
      (void)octree->insert(random_voxel(random, 0, side - 1), static_cast<std::uint8_t>(pick(random, 0, 12)));
    }
    if (pick(random, 0, 9) == 0) {
      (void)octree->coarsen_to(octree->nodes_used() / 2);
    }
  });
  scene.what = "cabinet";
  return scene;
}

struct Drawn {
  std::vector<std::uint8_t> pixels;
  LitCounts counts;
};

Drawn draw_lit_core(const WideScene& scene, const FrameCase& frame, const LitCase& lit) {
  Drawn drawn{std::vector<std::uint8_t>(band_size(frame), 0xA5), {}};
  Band band = frame.band;
  band.pixels = Bytes(drawn.pixels.data(), drawn.pixels.size());
  CHECK(render_lit_band(lit.effects, scene.tree, frame.camera, frame.shading, lit.scene, band, &drawn.counts,
                        lit.options) == Status::kOk);
  return drawn;
}

Drawn draw_lit_streams(const WideScene& scene, const wide::RayMap& map, const FrameCase& frame,
                       const LitCase& lit, std::size_t workspace_bytes, int threads) {
  const HeapBytes pixels(band_size(frame));
  std::memset(pixels.span().data, 0xA5, pixels.span().size);
  const HeapBytes workspace(workspace_bytes);
  Band band = frame.band;
  band.pixels = pixels.span();
  Drawn drawn;
  CHECK(map.tree().level() == scene.tree.level());
  CHECK(wide::render_lit(lit.effects, map, frame.camera, frame.shading, lit.scene, band, workspace.span(),
                         threads_of(threads), &drawn.counts, lit.options) == Status::kOk);
  drawn.pixels.assign(band.pixels.data, band.pixels.data + band.pixels.size);
  return drawn;
}

// Nothing that a ray goes on from: what most pictures are.
LitCase random_opaque_light(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  lit.effects = static_cast<EffectSet>(pick(random, 0, Effect::kAll)) &
                (Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kEmission |
                 Effect::kSky | Effect::kEmitterLight);
  lit.effects |= pick(random, 0, 1) == 0 ? Effect::kDirectLight | Effect::kShadows : Effect::kSky;
  const auto is_lamp = [](const Light& light) { return light.is_point; };
  lit.lights.erase(std::remove_if(lit.lights.begin(), lit.lights.end(), is_lamp), lit.lights.end());
  return lit;
}

// Pixels here and there: three bytes each, as the core draws them alone.
void check_places(std::mt19937_64& random, const WideScene& scene, const wide::RayMap& map,
                  const FrameCase& frame, const LitCase& lit, const Bytes& workspace, int threads) {
  std::vector<wide::PixelPlace> places;
  std::vector<std::uint8_t> expected;
  for (std::int64_t i = pick(random, 0, 200); i > 0; --i) {
    const auto x = static_cast<std::int32_t>(pick(random, 0, frame.camera.width_px() - 1));
    const auto y = static_cast<std::int32_t>(pick(random, 0, frame.camera.height_px() - 1));
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
    LitCase lit = make_light(random, scene.level);
    lit.scene.surfaces = {lit.surfaces.data(), lit.surfaces.size()};
    lit.scene.lights = {lit.lights.data(), lit.lights.size()};
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
    const int threads = static_cast<int>(pick(random, 1, 3));
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
    const Drawn expected = draw_lit_core(scene, frame, lit);
    const Drawn ours = draw_lit_streams(scene, map, frame, lit, workspace, threads);
    REQUIRE(count_different(ours.pixels, expected.pixels) == 0);
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CAPTURE(kind);
      REQUIRE(ours.counts.rays[kind] == expected.counts.rays[kind]);
      REQUIRE(ours.counts.hits[kind] <= expected.counts.hits[kind]);
      const bool ends =
          kind == static_cast<int>(LitRayKind::kOcclusion) || kind == static_cast<int>(LitRayKind::kShadow);
      REQUIRE((ends || ours.counts.hits[kind] == expected.counts.hits[kind]));
    }
    REQUIRE(ours.counts.pending_high_water == expected.counts.pending_high_water);
    const HeapBytes of_places(workspace);
    check_places(random, scene, map, frame, lit, of_places.span(), threads);
    lit_up += expected.counts.hits[0] != 0 ? 1 : 0;
    ++drawn;
  }
  CHECK(lit_up > frames / 3);
}

}  // namespace

TEST_CASE("wide: lit scenes of any kind -> every byte is the core's") {
  check_lit_frames(20261123, many_or_few(1000, 60), random_light);
}
TEST_CASE("wide: lit scenes in which rays end where they hit -> every byte is the core's") {
  check_lit_frames(20261124, many_or_few(1000, 60), random_opaque_light);
}

TEST_CASE("wide: the sky in lanes -> the core's, also where a length is rounded up") {
  const BestInstructionSet after;
  std::mt19937_64 random(77);
  constexpr std::size_t kCount = 4000;
  std::vector<std::int32_t> axes[3];
  for (std::size_t i = 0; i < kCount + wide::kMostSkyLanes; ++i) {
    for (auto& axis : axes) {
      const std::int64_t most = std::int64_t{1} << pick(random, 0, 20);
      const std::int64_t size = pick(random, 0, 1) == 0 ? pick(random, 0, most - 1) : most - 1;
      axis.push_back(static_cast<std::int32_t>(pick(random, 0, 1) == 0 ? size : -size));
    }
    axes[0].back() = axes[0].back() == 0 ? 1 : axes[0].back();
  }
  // So bright that each share is another colour.
  LitScene scene;
  scene.sky = {{255, 255, 255}, {0, 0, 0}, {255, 255, 255}};
  const CompactTree tree;
  const lit::Frame frame{tree, Camera(), Shading(), scene, LitOptions(), Effect::kSky};
  std::vector<std::int32_t> shares(kCount + wide::kMostSkyLanes);
  for (int set = 0; set < wide::instruction_set_count(); ++set) {
    wide::use_instruction_set(set);
    wide::find_sky_shares(axes[0].data(), axes[1].data(), axes[2].data(), kCount, shares.data());
    int wrong = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::uint32_t expected = lit::sky_color(frame, {axes[0][i], axes[1][i], axes[2][i]}).c[0];
      wrong += (255 * lit::kLevel * static_cast<std::uint32_t>(shares[i])) >> 12 == expected ? 0 : 1;
    }
    CHECK(wrong == 0);
  }
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
