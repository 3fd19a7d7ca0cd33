// Lit frames by the brick map are those of the tree, byte for byte, and count the same rays. THIMBLE_LONG draws 30
// million pixels, THIMBLE_FEW 200,000; THIMBLE_SEED begins elsewhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

#include "support/chip_worlds.h"
#include "support/ray_cases.h"
#include "thimble/light/map_render.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

std::uint64_t lit_pixels_to_draw() {
  return std::getenv("THIMBLE_FEW") != nullptr ? 200'000 : pixels_to_draw(30'000'000, 60'000);
}

struct LitView {
  const MappedTree& scene;
  const Camera& camera;
  const Shading& shading;
  const LitScene& light;
  const LitOptions& options;
};

struct LitWay {
  EffectSet effects;
  Status (*by_tree)(const LitView& view, const Band& band, LitCounts* counts);
  Status (*by_map)(const LitView& view, Span<const SunBricks> suns, const Band& band, LitCounts* counts);
};

template <EffectSet kSet>
Status lit_by_tree(const LitView& view, const Band& band, LitCounts* counts) {
  return render_lit_band<kSet>(view.scene.tree, view.camera, view.shading, view.light, band, counts,
                               view.options);
}
template <EffectSet kSet>
Status lit_by_map(const LitView& view, Span<const SunBricks> suns, const Band& band, LitCounts* counts) {
  return render_lit_band<kSet>(view.scene.tree, view.scene.map, view.camera, view.shading, view.light, suns,
                               band, counts, view.options);
}
template <EffectSet kSet>
constexpr LitWay lit_way() {
  return {kSet, lit_by_tree<kSet>, lit_by_map<kSet>};
}

constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;
constexpr EffectSet kBeside[] = {Effect::kEmitterLight, Effect::kAmbientOcclusion, Effect::kMirror,
                                 Effect::kEmission, Effect::kSky};
// The sun with those beside it whose bits are set.
constexpr EffectSet sun_and(unsigned bits) {
  EffectSet set = kSun;
  for (unsigned i = 0; i < std::size(kBeside); ++i) {
    set |= (bits >> i & 1U) != 0 ? kBeside[i] : Effect::kNone;
  }
  return set;
}
// All sets of the fast way, and some that the tree draws.
template <unsigned... kBits>
constexpr auto lit_ways(std::integer_sequence<unsigned, kBits...>) {
  return std::array{lit_way<sun_and(kBits)>()..., lit_way<Effect::kDirectLight>(),
                    lit_way<Effect::kEmission>(), lit_way<Effect::kNone>(),
                    lit_way<kSun | Effect::kAmbientOcclusion | Effect::kMirror | Effect::kFog>()};
}
constexpr auto kLitWays = lit_ways(std::make_integer_sequence<unsigned, 1U << std::size(kBeside)>());

/// Along axes and diagonals, flat, from below, of few bits and of many.
Light hard_sun(std::mt19937_64& random) {
  Light light;
  const int size = pick_int(random, 0, 2) == 0 ? 1 : pick_int(random, 0, 1) == 0 ? 20 : 16384;
  Vec3i place{};
  while (place == Vec3i{}) {
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = pick_int(random, -size, size);
    }
  }
  light.place = place;
  for (PackedU16& channel : light.color_q8) {
    channel = static_cast<std::uint16_t>(pick_int(random, 0, 3) == 0 ? 0 : pick_int(random, 1, 700));
  }
  return light;
}

/// In the world and outside of it, as far as rays may be, in the open and in solids, on lattice points, planes and edges.
Light hard_lamp(std::mt19937_64& random, int level) {
  Light light;
  light.is_point = true;
  const int side = 256 << level;
  const int beyond = pick_int(random, 0, 4) == 0 ? side * pick_int(random, 1, 4) : 0;
  Vec3i place{};
  for (int axis = 0; axis < 3; ++axis) {
    const int grain = pick_int(random, 0, 2) == 0 ? 1 : pick_int(random, 0, 1) == 0 ? 256 : 1024;
    place[axis] = pick_int(random, -beyond, side + beyond) / grain * grain;
  }
  light.place = place;
  const int reach = pick_int(random, 0, 9);
  light.reach = static_cast<std::uint16_t>(reach == 0 ? 0 : reach == 1 ? 65535 : pick_int(random, 1, 60));
  for (PackedU16& channel : light.color_q8) {
    channel = static_cast<std::uint16_t>(pick_int(random, 0, 3) == 0 ? 0 : pick_int(random, 1, 2000));
  }
  return light;
}

Occlusion hard_occlusion(std::mt19937_64& random) {
  constexpr int kRays[] = {0, 4, 4, 8, 8, 16, 32, 200};
  constexpr int kReach[] = {0, 1, 2, 5, 8, 12, 100, 65535};
  Occlusion occlusion;
  occlusion.rays = static_cast<std::uint8_t>(kRays[pick_int(random, 0, 7)]);
  occlusion.reach = static_cast<std::uint16_t>(kReach[pick_int(random, 0, 7)]);
  occlusion.strength =
      static_cast<std::uint8_t>(pick_int(random, 0, 3) == 0 ? pick_int(random, 0, 255) : 255);
  return occlusion;
}

struct LitLights {
  std::vector<Light> lights;
  std::vector<std::uint8_t> bytes;
  std::vector<SunBricks> free;
};

/// Lights with what is proven of the distant ones: all, a part, that of another light, nothing.
LitLights hard_lights(std::mt19937_64& random, const BrickMap& map, int level) {
  LitLights made;
  const int suns = pick_int(random, 0, 3) == 0 ? pick_int(random, 0, 3) : 1;
  const int lamps = std::max(0, pick_int(random, -2, 3));
  std::vector<bool> is_sun(static_cast<std::size_t>(suns + lamps));
  std::fill_n(is_sun.begin(), suns, true);
  std::shuffle(is_sun.begin(), is_sun.end(), random);
  const std::size_t size = SunBricks::bytes(map);
  made.bytes.resize(size * static_cast<std::size_t>(suns));
  const int proven = pick_int(random, 0, 4);
  for (const bool shines_from_afar : is_sun) {
    if (!shines_from_afar) {
      made.lights.push_back(hard_lamp(random, level));
      continue;
    }
    made.lights.push_back(hard_sun(random));
    const Vec3i towards = made.lights.back().place;
    const Bytes room(made.bytes.data() + size * made.free.size(), size);
    SunBricks sun;
    if (proven == 1) {
      REQUIRE(SunBricks::make(map, towards, room, &sun) == Status::kOk);
      sun.prove(static_cast<std::uint32_t>(pick_int(random, 0, 400)));
    } else if (proven == 2) {
      REQUIRE(SunBricks::make(map, {towards.x, towards.y, towards.z + 1000}, room, &sun) == Status::kOk);
      sun.prove();
    } else if (proven != 0) {
      REQUIRE(SunBricks::make(map, towards, room, &sun) == Status::kOk);
      sun.prove();
    }
    made.free.push_back(sun);
  }
  return made;
}

std::vector<Surface> hard_surfaces(std::mt19937_64& random) {
  std::vector<Surface> surfaces(static_cast<std::size_t>(pick_int(random, 0, 10)));
  for (Surface& surface : surfaces) {
    surface.albedo = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                      static_cast<std::uint8_t>(random())};
    surface.kind = static_cast<SurfaceKind>(pick_int(random, 0, 4));
    surface.emission_q8 = static_cast<std::uint16_t>(pick_int(random, 0, 2000));
    surface.mirror = static_cast<std::uint8_t>(pick_int(random, 0, 1) == 0 ? 255 : random());
    surface.roughness = static_cast<std::uint8_t>(pick_int(random, 0, 2) == 0 ? random() : 0);
  }
  return surfaces;
}

template <class Draw>
std::vector<std::uint8_t> lit_bytes(const Camera& camera, PixelFormat format, std::size_t stride, int rows,
                                    const Draw& draw) {
  const int height = camera.height_px();
  std::vector<std::uint8_t> bytes(stride * static_cast<std::size_t>(height), 0x5A);
  for (int y = 0; y < height; y += rows) {
    const int count = std::min(rows, height - y);
    const Band band{
        {bytes.data() + stride * static_cast<std::size_t>(y), stride * static_cast<std::size_t>(count)},
        format,
        stride,
        y,
        count};
    REQUIRE(draw(band) == Status::kOk);
  }
  return bytes;
}

TEST_CASE("lit frames by the map: hard cameras, worlds and suns -> the bytes and rays of the tree's") {
  std::mt19937_64 random(seed_or(20260501));
  const std::uint64_t wanted_pixels = lit_pixels_to_draw();
  std::uint64_t pixels = 0;
  std::uint64_t fast = 0;
  std::uint64_t shadows = 0;
  std::uint64_t sunny = 0;
  std::uint64_t by_lamps = 0;
  std::uint64_t occluded = 0;
  std::uint64_t mirrored = 0;
  // Few pictures may be all of one kind: it draws until each kind had its share.
  const auto is_enough = [&] {
    return pixels >= wanted_pixels && fast > wanted_pixels / 12 && by_lamps > wanted_pixels / 20 &&
           occluded > wanted_pixels / 20 && mirrored > wanted_pixels / 60 && shadows > wanted_pixels / 20 &&
           sunny > wanted_pixels / 40;
  };
  for (unsigned turn = 0; !is_enough() && pixels < 40 * wanted_pixels; ++turn) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const bool is_deep = turn % 4 == 3;
    const int level = is_deep ? pick_int(own, 9, 10) : pick_int(own, 3, 6);
    const MappedTree scene = make_chip_scene(own, kChipWorlds[turn % std::size(kChipWorlds)], level);
    const std::vector<Surface> surfaces = hard_surfaces(own);
    for (int view = 0; view < 6; ++view) {
      CAPTURE(view);
      const LitLights lights = hard_lights(own, scene.map, level);
      const Camera camera = hard_chip_camera(own, level);
      const LitWay& way = kLitWays[static_cast<std::size_t>(pick_int(own, 0, std::size(kLitWays) - 1))];
      Shading shading;
      shading.background = {9, 200, 77};
      LitScene light;
      light.surfaces = {surfaces.data(), surfaces.size()};
      light.lights = {lights.lights.data(), lights.lights.size()};
      light.occlusion = hard_occlusion(own);
      light.fog.density_q16 = 300;
      light.bounces = static_cast<std::uint8_t>(pick_int(own, 0, kMaxBounces));
      // Some of a metal that mirrors next to all light have nothing of their own to show, and ask for none.
      const bool shows_all = (way.effects & Effect::kMirror) == 0 ||
                             std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& one) {
                               return one.kind == SurfaceKind::kMetal && one.mirror > 253;
                             });
      LitOptions options;
      options.dither = pick_int(own, 0, 3) != 0;
      options.max_visits = pick_int(own, 0, 9) == 0 ? 20 : UINT32_MAX;
      const bool has_lamps = std::any_of(lights.lights.begin(), lights.lights.end(),
                                         [](const Light& one) { return one.is_point; });
      const LitView lit{scene, camera, shading, light, options};
      const PixelFormat format = static_cast<PixelFormat>(pick_int(own, 0, 4));
      const std::size_t stride =
          row_bytes(format, camera.width_px()) + static_cast<std::size_t>(pick_int(own, 0, 3));
      LitCounts counts;
      LitCounts counts_wanted;
      const auto wanted = lit_bytes(camera, format, stride, camera.height_px(),
                                    [&](const Band& band) { return way.by_tree(lit, band, &counts_wanted); });
      const int rows = pick_int(own, 0, 1) == 0 ? camera.height_px() : pick_int(own, 1, 20);
      const auto got = lit_bytes(camera, format, stride, rows, [&](const Band& band) {
        return way.by_map(lit, {lights.free.data(), lights.free.size()}, band, &counts);
      });
      CAPTURE(way.effects);
      REQUIRE(got == wanted);  // the gaps between rows too
      for (int kind = 0; kind < kLitRayKinds; ++kind) {
        CAPTURE(kind);
        const bool is_of_light = static_cast<LitRayKind>(kind) == LitRayKind::kOcclusion ||
                                 static_cast<LitRayKind>(kind) == LitRayKind::kShadow;
        REQUIRE(counts.rays[kind] <= counts_wanted.rays[kind]);
        REQUIRE(((is_of_light && !shows_all) || counts.rays[kind] == counts_wanted.rays[kind]));
        // Rays to lamps and of occlusion end there by the map.
        const bool ends = static_cast<LitRayKind>(kind) == LitRayKind::kOcclusion ||
                          (is_of_light && (has_lamps || !shows_all));
        REQUIRE(counts.hits[kind] <= counts_wanted.hits[kind]);
        REQUIRE((ends || counts.hits[kind] == counts_wanted.hits[kind]));
      }
      constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
      constexpr int kOcclusion = static_cast<int>(LitRayKind::kOcclusion);
      const auto area =
          static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
      pixels += area;
      // What went by the map read no node for most rays.
      const bool is_fast = counts.node_visits[kShadow] < counts_wanted.node_visits[kShadow] / 4;
      fast += is_fast ? area : 0;
      by_lamps += is_fast && has_lamps ? area : 0;
      occluded += counts.node_visits[kOcclusion] < counts_wanted.node_visits[kOcclusion] / 4
                      ? counts.hits[kOcclusion]
                      : 0;
      constexpr int kMirrorRay = static_cast<int>(LitRayKind::kMirrorRay);
      mirrored += counts.node_visits[kMirrorRay] < counts_wanted.node_visits[kMirrorRay] / 4
                      ? counts.rays[kMirrorRay]
                      : 0;
      shadows += counts.hits[kShadow];
      sunny += counts.rays[kShadow] - counts.hits[kShadow];
    }
  }
  CAPTURE(fast);
  CAPTURE(by_lamps);
  CAPTURE(occluded);
  CAPTURE(mirrored);
  CAPTURE(shadows);
  CAPTURE(sunny);
  CHECK(is_enough());
}

TEST_CASE("bricks free towards a sun: bad arguments, and bits that another light does not get") {
  std::mt19937_64 random(7);
  const MappedTree scene = make_chip_scene(random, ChipWorld::kTower, 5);
  std::vector<std::uint8_t> room(SunBricks::bytes(scene.map));
  SunBricks sun;
  CHECK(SunBricks::make(scene.map, {0, 0, 0}, {room.data(), room.size()}, &sun) == Status::kBadArgument);
  CHECK(SunBricks::make(BrickMap{}, {0, 0, 1}, {room.data(), room.size()}, &sun) == Status::kBadArgument);
  CHECK(SunBricks::make(scene.map, {0, 0, 1}, {room.data(), room.size() - 1}, &sun) == Status::kOutOfMemory);
  CHECK_FALSE(sun.belongs_to(scene.map, {0, 0, 1}));
  REQUIRE(SunBricks::make(scene.map, {3, -1, 9}, {room.data(), room.size()}, &sun) == Status::kOk);
  CHECK_FALSE(sun.prove());
  CHECK(sun.belongs_to(scene.map, {3, -1, 9}));
  CHECK_FALSE(sun.belongs_to(scene.map, {3, -1, 8}));
  CHECK_FALSE(sun.belongs_to(BrickMap{}, {3, -1, 9}));
  const std::vector<std::uint8_t> whole = room;
  CHECK(std::count(whole.begin(), whole.end(), 0) < static_cast<std::ptrdiff_t>(whole.size()));
  // Slices of any size come to the same.
  REQUIRE(SunBricks::make(scene.map, {3, -1, 9}, {room.data(), room.size()}, &sun) == Status::kOk);
  CHECK(std::count(room.begin(), room.end(), 0) == static_cast<std::ptrdiff_t>(room.size()));
  int slices = 1;
  while (sun.prove(7)) {
    ++slices;
  }
  CHECK(slices == (8 * 8 * 8 + 6) / 7);
  CHECK(room == whole);
}

}  // namespace
