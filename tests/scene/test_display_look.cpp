// Scenes baked for a display: its range of brightness, and dark edges where it has few greys.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "scene/baking.h"
#include "scene/built_scene.h"
#include "scene/default_look.h"
#include "scene/framing.h"
#include "scene/host_memory.h"
#include "scene/lit_description.h"
#include "scene/lit_streams.h"
#include "scene/look_picture.h"
#include "scene/scene_shape.h"
#include "support/lit_world.h"
#include "thimble/light/scene.h"

namespace {

using namespace thimble;
using namespace thimble::tools;

constexpr DisplayFacts kOled{PixelFormat::kGray4, 128, 64};

Baked baked_for(const std::optional<DisplayFacts>& display, bool default_look = true) {
  const auto source = open_scene({.scene = "spheres", .depth = 5});
  BakingOptions options;
  options.default_look = default_look;
  options.display = display;
  options.camera = [&](const CompactTree& tree) {
    ViewWishes view;
    view.width_px = kOled.width_px;
    view.height_px = kOled.height_px;
    return frame_scene(view, *source, shape_of(tree)).kept;
  };
  return bake_scene(*source, options);
}

}  // namespace

TEST_CASE(
    "display: a scene baked by the rule has dark edges on few greys, none else, and never by the list") {
  constexpr EffectSet kSunlit = Effect::kDirectLight | Effect::kShadows;
  CHECK(baked_for(kOled).effects == (kSunlit | Effect::kEdges));
  CHECK(baked_for(DisplayFacts{PixelFormat::kMono1, 128, 64}).effects == (kSunlit | Effect::kEdges));
  // Many colours get something light behind the scene.
  CHECK(baked_for(DisplayFacts{PixelFormat::kRgb565, 240, 240}).effects == (kSunlit | Effect::kSky));
  CHECK(baked_for(DisplayFacts{PixelFormat::kGray8, 240, 240}).effects == (kSunlit | Effect::kSky));
  CHECK(baked_for(std::nullopt).effects == (kSunlit | Effect::kSky));
  CHECK(baked_for(kOled, false).effects == Effect::kNone);
}

TEST_CASE(
    "display: the light of a scene, dim or glaring -> its brightest twentieth is all but white on few "
    "greys") {
  for (const int albedo : {40, 110, 250}) {
    for (const int strength : {90, 256, 420}) {
      CAPTURE(albedo);
      CAPTURE(strength);
      testing::LitWorld world;
      world.box({0, 0, 0}, {32, 32, 2}, 1);
      world.box({10, 10, 2}, {22, 22, 14}, 1);
      const auto gray = static_cast<std::uint8_t>(albedo);
      world.surfaces[1].albedo = {gray, gray, gray};
      world.lights = {testing::sun({-3, -6, 9}, strength)};
      world.finish();
      testing::set_ambient(&world.scene, 40);
      SceneCamera camera;
      camera.eye = testing::LitWorld::point({-10 * 256, -30 * 256, 40 * 256});
      camera.target = testing::LitWorld::point({16 * 256, 16 * 256, 4 * 256});
      camera.fov_degrees = Q16::saturate(35);
      LitDescription lit;
      lit.lights = world.lights;
      lit.rest = world.scene;
      lit.rest.lights = {};
      lit.rest.surfaces = {};
      UsedMaterials used;
      used.is[1] = true;
      const Rgb8 palette[2] = {{}, {gray, gray, gray}};
      suit_display(kOled, world.tree, camera, {palette, 2}, used, Effect::kDirectLight, &lit);
      world.scene.ambient_q8[0] = lit.rest.ambient_q8[0];
      world.scene.ambient_q8[1] = lit.rest.ambient_q8[1];
      world.scene.ambient_q8[2] = lit.rest.ambient_q8[2];
      world.lights = lit.lights;
      world.scene.lights = {world.lights.data(), world.lights.size()};
      REQUIRE(set_camera(camera, 128, 64, world.tree.level(), &world.camera) == Status::kOk);
      std::vector<int> grays;
      for (const Rgb8& pixel : world.draw(Effect::kDirectLight)) {
        if (pixel.r != 0) {
          grays.push_back(pixel.g);
        }
      }
      std::sort(grays.begin(), grays.end());
      const int bright = grays[grays.size() - grays.size() / 20];
      // No more than four times as bright.
      CHECK(bright <= 250);
      CHECK((bright >= 236 || lit.lights[0].color_q8[0] == 4 * strength));
    }
  }
}

TEST_CASE("backdrop: light on the ground by vectors -> what the core finds, ray by ray") {
  struct World {
    std::string name;
    int depth;
  };
  // Where worlds are wide, most of the ground has nothing near it, or only on one side.
  for (const World& world :
       {World{"spheres", 5}, World{"points:3000", 5}, World{"spheres", 7}, World{"points:30000", 7}}) {
    CAPTURE(world.name);
    CAPTURE(world.depth);
    const auto source = open_scene({.scene = world.name, .depth = world.depth});
    const BuiltScene built(*source, {}, {});
    const CompactTree& tree = built.compact();
    ViewWishes view;
    view.width_px = 96;
    view.height_px = 72;
    const Camera camera = frame_scene(view, *source, shape_of(tree)).camera;
    LitScene scene;
    const EffectSet effects = Effect::kDirectLight | Effect::kShadows;
    HostMemory memory(LitStreams::bytes(tree, effects, scene, 1) + 4096);
    Arena arena(memory.bytes());
    const auto streams = LitStreams::make(tree, &arena, effects, scene, 1);
    Look look;
    look.ground.is_there = true;
    look.ground.toward_sun = {-300, -200, 500};
    look.ground.reach = 9;
    std::vector<Ray> rays;
    for (std::int32_t y = 0; y < 72; ++y) {
      for (std::int32_t x = 0; x < 96; ++x) {
        rays.push_back(camera.ray(x, y));
      }
    }
    // Under the model, within it, and far above what is seen.
    for (const std::int32_t ground_z :
         {tree.bounds().low.z, 7 << (world.depth - 5), 31 << (world.depth - 5)}) {
      look.ground.z = ground_z;
      std::vector<std::uint8_t> core(rays.size());
      std::vector<std::uint8_t> vectors(rays.size());
      find_light_behind(tree, look, nullptr, {rays.data(), rays.size()}, core.data());
      find_light_behind(tree, look, streams.get(), {rays.data(), rays.size()}, vectors.data());
      CHECK(core == vectors);
      CHECK(std::set<std::uint8_t>(core.begin(), core.end()).size() > 3);  // shadows and corners
    }
  }
}
