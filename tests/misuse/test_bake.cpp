// Every public function of bake with any parts and bytes: refused, or a scene that is safe to open and to
// draw.
#include <doctest/doctest.h>

#include <cstdint>
#include <optional>

#include "misuse/odd_worlds.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// Opens any bytes, and draws what opens in every way that a board would.
void open_and_draw(OddValues& odd, ConstBytes bytes) {
  std::uint32_t place = 0;
  (void)BakedScene::validate(bytes, odd.one_in(2) ? &place : nullptr);
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) != Status::kOk) {
    CHECK(scene.bytes().empty());
    return;
  }
  (void)scene.validate();
  (void)scene.section(static_cast<SectionKind>(odd.any<std::uint32_t>()));
  Camera camera;
  const int level = scene.tree().level();
  if (!scene.has_camera() || set_camera(scene.camera(), 24, 16, level, &camera) != Status::kOk) {
    camera = odd_camera(odd, level);
  }
  Shading shading = odd_shading(odd, scene.palette());
  HeapBytes pixels;
  const Band band = odd_band(odd, camera, &pixels);
  const TraceOptions options{2000, Width::kAuto};
  (void)render_band(scene.tree(), camera, shading, band, nullptr, options);
  BrickMap map;
  if (BrickMap::open(scene.section(SectionKind::kBrickMap), &map) == Status::kOk) {
    (void)render_band(scene.tree(), map, camera, shading, band);
  }
  BakedLighting lighting;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), level, &lighting) == Status::kOk) {
    (void)render_lit_band(lighting.effects, scene.tree(), camera, shading, lighting.scene, band, nullptr,
                          {2000, true});
  }
}

}  // namespace

TEST_CASE(
    "misuse: scenes made of any parts, damaged or not -> refused, or opened and drawn inside the bytes") {
  misuse(50, 700, [](OddValues& odd) {
    OddWorld world(odd, odd.between_32(kMinLevel, 6));
    std::optional<OddDeepWorld> deep;
    if (odd.one_in(4)) {
      deep.emplace(odd);
    }
    const CompactTree& tree = deep ? deep->compact : world.compact;
    const int level = tree.level();
    Rgb8 palette[8] = {{1, 2, 3}, {200, 10, 10}};
    const HeapBytes map_bytes = map_of(tree);
    const Surface surfaces[] = {{{9, 9, 9}, SurfaceKind::kGlass}, {{200, 200, 0}, SurfaceKind::kMetal}};
    const Light lights[] = {Light{}};
    BakedLighting lighting;
    lighting.scene.surfaces = Span<const Surface>(surfaces);
    lighting.scene.lights = Span<const Light>(lights);
    lighting.scene.has_shadows = odd.one_in(2);
    lighting.effects = odd.one_in(4) ? odd.any<EffectSet>() : effects_of(lighting.scene);
    HeapBytes lighting_section(lighting_bytes(lighting.scene));
    (void)BakedLighting::make(lighting, level, lighting_section.span());
    SceneCamera camera;
    const Ray view = good_ray(odd, level);
    camera.eye = view.origin;
    camera.target = good_ray(odd, level).origin;
    camera.is_perspective = odd.one_in(2);
    camera.span = Q14::from_raw(odd.one_in(4) ? odd.any<std::int32_t>() : 1 << 20);
    camera.fov_degrees = odd.one_in(4) ? Q16::from_raw(odd.any<std::int32_t>()) : camera.fov_degrees;
    camera.direction_bits = odd.one_in(4) ? odd.any<std::uint8_t>() : std::uint8_t{0};
    HeapBytes name(odd.bits() % 300);

    BakedParts parts;
    if (!odd.one_in(12)) {
      parts.tree = {tree.bytes(), tree.size_bytes()};
    }
    parts.palette = Span<const Rgb8>(palette, odd.bits() % 9);
    parts.camera = odd.one_in(2) ? &camera : nullptr;
    if (odd.one_in(2)) {
      parts.brick_map = map_bytes.view();
    }
    if (odd.one_in(2)) {
      parts.lighting = lighting_section.span();
    }
    parts.name = name.span();
    if (odd.one_in(6)) {
      (odd.one_in(2) ? parts.lighting : parts.brick_map) = name.span();
    }
    HeapBytes out(odd_size(odd, baked_bytes(parts) == SIZE_MAX ? 4096 : baked_bytes(parts)));
    BakedScene scene;
    if (BakedScene::make(parts, out.span(), odd.one_in(4) ? nullptr : &scene) != Status::kOk) {
      return;
    }
    open_and_draw(odd, out.span());
    for (int i = 0; i < 6; ++i) {
      const HeapBytes bad = damaged(odd, out.span());
      open_and_draw(odd, bad.span());
    }
  });
}
