// Every public function of light: numbers within the ranges that the headers name, and any bytes and bands.
#include <doctest/doctest.h>

#include <cstdint>

#include "misuse/odd_worlds.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/map_render.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/light/water.h"
#include "thimble/tree/edited_world.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// A vector of at most `most` a component, not all 0.
Vec3i some_vector(OddValues& odd, std::int32_t most) {
  Vec3i vector = odd.vector_between(-most, most);
  if (vector == Vec3i{}) {
    vector[odd.between_32(0, 2)] = odd.one_in(2) ? 1 : -most;
  }
  return vector;
}

Surface odd_surface(OddValues& odd) {
  Surface surface;
  surface.albedo = {odd.any<std::uint8_t>(), odd.any<std::uint8_t>(), odd.any<std::uint8_t>()};
  surface.kind = static_cast<SurfaceKind>(odd.bits() % 5);
  surface.roughness = odd.any<std::uint8_t>();
  surface.mirror = odd.any<std::uint8_t>();
  surface.index_q12 = static_cast<std::uint16_t>(odd.between(kMinIndexQ12, kMaxIndexQ12));
  surface.density_q8 = odd.any<std::uint16_t>();
  surface.emission_q8 = odd.any<std::uint16_t>();
  return surface;
}

Light odd_light(OddValues& odd, int level) {
  Light light;
  light.is_point = odd.one_in(2);
  light.place = light.is_point ? [&] {
    const Vec3Q8 at = good_ray(odd, level).origin;
    return PackedVec3i(at.x.raw, at.y.raw, at.z.raw);
  }() : PackedVec3i(some_vector(odd, kMaxLightComponent));
  for (PackedU16& channel : light.color_q8) {
    channel = odd.any<std::uint16_t>();
  }
  light.reach = static_cast<std::uint16_t>(odd.between(1, UINT16_MAX));
  return light;
}

struct OddScene {
  Surface surfaces[6];
  Light lights[4];
  HeapBytes water_bytes_;
  Water water;
  LitScene scene;

  OddScene(OddValues& odd, int level) {
    for (Surface& surface : surfaces) {
      surface = odd_surface(odd);
    }
    for (Light& light : lights) {
      light = odd_light(odd, level);
    }
    scene.surfaces = {surfaces, odd.bits() % 7};
    scene.lights = {lights, odd.bits() % 5};
    for (std::uint16_t& channel : scene.ambient_q8) {
      channel = odd.any<std::uint16_t>();
    }
    scene.has_shadows = odd.one_in(2);
    scene.has_sky = odd.one_in(2);
    scene.has_depth_cue = odd.one_in(2);
    scene.fog.density_q16 = static_cast<std::uint32_t>(odd.between(0, 1 << 24));
    const std::uint8_t counts[] = {0, 4, 8, 16, 32};
    scene.occlusion = {counts[odd.bits() % 5], odd.any<std::uint8_t>(),
                       static_cast<std::uint16_t>(odd.between(1, 4096))};
    scene.bounces = static_cast<std::uint8_t>(odd.between(0, kMaxBounces));
    const std::int32_t side = std::int32_t{1} << level;
    if (odd.one_in(2)) {
      const WaterConfig config{side, side, 256 * (side / 2), 0, 256 * side, 28, 24, {}};
      water_bytes_ = HeapBytes(thimble::water_bytes(side, side));
      REQUIRE(Water::make(config, water_bytes_.span(), &water) == Status::kOk);
      (void)water.touch(128 * side, 128 * side, 512, 300);
      water.step();
      scene.has_water = true;
      scene.water = water.surface({0, 0, 0});
      scene.water_material = odd_surface(odd);
      scene.water_material.kind = SurfaceKind::kGlass;
    }
  }
};

}  // namespace

TEST_CASE("misuse: optics at the ends of their ranges -> results within theirs") {
  misuse(30, 60000, [](OddValues& odd) {
    const Vec3i direction = some_vector(odd, kMaxDirection);
    const Vec3i unit = unit_q14(direction);
    const Vec3i normal = unit_q14(some_vector(odd, kMaxDirection));
    (void)length_of(shorten(direction));
    (void)reflect(direction, odd.between_32(0, 2));
    (void)reflect(shorten(direction), normal);
    (void)dot_q14(unit, normal);
    const auto index = [&] { return static_cast<std::uint32_t>(odd.between(1, 65535)); };
    CHECK(eta_q12(index(), index()) <= kMaxEtaQ12);
    Vec3i out;
    (void)refract(unit, odd.between_32(0, 2), odd.any<std::uint32_t>(), &out);
    (void)refract(unit, normal, odd.any<std::uint32_t>(), &out);
    const std::uint32_t r0 = r0_q16(static_cast<std::uint32_t>(odd.between(0, 65535)), index());
    CHECK(r0 <= kOneQ16);
    CHECK(fresnel_q16(odd.any<std::int32_t>(), r0) <= kOneQ16);
    CHECK(transmittance_q16(odd.any<std::uint32_t>()) <= kOneQ16);
    const int axis = odd.between_32(0, 2);
    const std::int32_t speed = direction[axis] < 0 ? -direction[axis] : direction[axis];
    CHECK(distance_q8(direction, odd.between_32(0, 1 << 24), speed == 0 ? 1 : 256 * speed) >= 0);
    (void)occlusion_direction(odd.between_32(0, 31), axis, odd.one_in(2));
    (void)roughen(unit, odd.any<std::uint8_t>(), odd.between_32(0, 3));
    (void)effect_name(odd.any<EffectSet>());
  });
}

TEST_CASE("misuse: water of any numbers -> refused or done, its volume kept, its rays answered") {
  misuse(31, 1500, [](OddValues& odd) {
    const bool sane = !odd.one_in(3);
    WaterConfig config;
    config.width = sane ? odd.between_32(1, 40) : odd.any<std::int32_t>();
    config.depth = sane ? odd.between_32(1, 40) : odd.any<std::int32_t>();
    config.greatest_q8 = sane ? odd.between_32(0, kMaxWaterHeightQ8) : odd.any<std::int32_t>();
    config.rest_q8 = sane ? odd.between_32(0, config.greatest_q8) : odd.any<std::int32_t>();
    config.least_q8 = sane ? odd.between_32(0, config.rest_q8) : odd.any<std::int32_t>();
    config.wave_speed_q6 = sane ? odd.between_32(kMinWaveSpeedQ6, kMaxWaveSpeedQ6) : odd.any<std::int32_t>();
    config.damping_q12 = sane ? odd.between_32(0, 2048) : odd.any<std::int32_t>();
    const std::size_t columns = sane ? static_cast<std::size_t>(config.width * config.depth) : 64;
    HeapBytes blocked(odd.one_in(2) ? 0 : odd_size(odd, (columns + 7) / 8));
    for (std::uint8_t& byte : blocked.span()) {
      byte = odd.one_in(3) ? odd.any<std::uint8_t>() : std::uint8_t{0};
    }
    config.blocked = blocked.span();
    HeapBytes bytes(odd_size(odd, water_bytes(config.width, config.depth)));
    Water water;
    water.step();
    if (Water::make(config, bytes.span(), &water) != Status::kOk) {
      CHECK(water.width() == 0);
      return;
    }
    const std::uint64_t volume = water.volume_q16();
    for (int i = 0; i < 12; ++i) {
      const auto number = [&](std::int32_t most) { return odd.any_or(3, -most, most); };
      (void)water.touch(number(12000), number(12000), number(1 << 14), number(1 << 14));
      (void)water.drop(number(12000), number(12000), number(1 << 14), number(1 << 20), number(1 << 16));
      water.step();
      REQUIRE(water.volume_q16() == volume);
      CHECK(water.lowest_q8() >= config.least_q8);
      CHECK(water.highest_q8() <= config.greatest_q8);
    }
    const WaterSurface surface =
        water.surface({odd.between_32(0, 4096 - config.width), odd.between_32(0, 4096 - config.depth),
                       odd.between_32(0, 4095)});
    for (int i = 0; i < 20; ++i) {
      const Ray ray = good_ray(odd, 12);
      WaterHit hit;
      if (water_enter(surface, ray, &hit) || water_leave(surface, ray, &hit)) {
        CHECK(hit.visits <= static_cast<std::uint32_t>(config.width + config.depth + 4));
      }
      (void)water_holds(surface, ray.origin, ray.direction);
      (void)water_normal(surface, ray.origin.x, ray.origin.y);
    }
  });
}

TEST_CASE(
    "misuse: lit bands of any scene, set and band over sound and damaged trees, by maps and without -> "
    "refused or drawn") {
  const Rgb8 palette[] = {{200, 100, 50}, {30, 60, 90}};
  misuse(34, 400, [&](OddValues& odd) {
    const bool is_deep = odd.one_in(2);
    const int level = odd.between_32(kMinLevel, 5);
    OddWorld small(odd, level);
    const OddDeepWorld deep(odd);
    const OwnedMap small_map(small.compact, most_brick_map_bytes(small.compact));
    REQUIRE((small_map.status == Status::kOk) == (level >= kMinBrickMapLevel));
    if (odd.one_in(2)) {
      small.damage(odd);
    }
    const CompactTree& tree = is_deep ? deep.compact : small.compact;
    const BrickMap& map = odd.one_in(8) ? BrickMap() : is_deep ? deep.map : small_map.map;
    const OddScene lit(odd, std::min(tree.level(), 6));
    HeapBytes bits(odd_size(odd, SunBricks::bytes(map)));
    SunBricks sun;
    const Vec3i towards = odd.one_in(8) ? Vec3i{} : some_vector(odd, kMaxLightComponent);
    const Status status = SunBricks::make(map, towards, bits.span(), &sun);
    CHECK((status == Status::kOutOfMemory) ==
          (bits.span().size < SunBricks::bytes(map) && towards != Vec3i{}));
    if (status == Status::kOk) {
      (void)sun.prove(odd.any<std::uint32_t>());
      EditedWorld world;  // another one, or none
      (void)sun.follow(world, odd.any<std::uint32_t>());
    }
    const Camera camera = is_deep && odd.one_in(2) ? deep.near(odd) : odd_camera(odd, tree.level());
    const Shading shading = odd_shading(odd, Span<const Rgb8>(palette));
    HeapBytes pixels;
    const Band band = odd_band(odd, camera, &pixels);
    LitCounts counts;
    const LitOptions options{odd.one_in(2) ? UINT32_MAX : odd.any<std::uint32_t>(), odd.one_in(2)};
    const EffectSet effects = odd.one_in(2) ? effects_of(lit.scene) : odd.any<EffectSet>();
    LitCounts* const counted = odd.one_in(2) ? &counts : nullptr;
    (void)render_lit_band(effects, tree, map, camera, shading, lit.scene, {&sun, 1}, band, counted, options);
    (void)render_lit_band(effects, tree, camera, shading, lit.scene, band, counted, options);
  });
}

TEST_CASE("misuse: damaged lighting sections -> refused, or numbers within their limits") {
  misuse(33, 6000, [](OddValues& odd) {
    const int level = odd.between_32(kMinLevel, kMaxLevel);
    OddScene lit(odd, level > 6 ? 6 : level);
    BakedLighting lighting;
    lighting.scene = lit.scene;
    lighting.effects = effects_of(lit.scene);
    HeapBytes bytes(odd_size(odd, lighting_bytes(lit.scene)));
    (void)BakedLighting::make(lighting, level, bytes.span());
    const HeapBytes bad = damaged(odd, bytes.span());
    std::uint32_t place = 0;
    const char* const wrong = BakedLighting::validate(bad.span(), level, odd.one_in(2) ? &place : nullptr);
    BakedLighting opened;
    const Status status = BakedLighting::open(bad.span(), level, &opened);
    if (wrong == nullptr && status == Status::kOk) {
      CHECK(opened.scene.lights.size <= kMaxLights);
      CHECK(opened.scene.bounces <= kMaxBounces);
      for (const Surface& surface : opened.scene.surfaces) {
        CHECK(surface.index_q12 >= kMinIndexQ12);
        CHECK(surface.index_q12 <= kMaxIndexQ12);
      }
    }
  });
}
