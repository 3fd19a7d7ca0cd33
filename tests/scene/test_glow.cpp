#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "scene/baking.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "support/lit_world.h"
#include "support/run_command.h"

namespace {

using namespace thimble;
using namespace thimble::tools;
using thimble::testing::LitWorld;

constexpr EffectSet kOfGlow =
    Effect::kEmission | Effect::kEmitterLight | Effect::kDirectLight | Effect::kShadows;

// Material 1 glows with twice its colour, which is white but for half of its blue; 0 does not.
class Glowing : public LitWorld {
 public:
  Glowing() : LitWorld(5) {
    surfaces.resize(256);
    surfaces[1].kind = tools::SurfaceKind::kEmit;
    surfaces[1].albedo = {255, 255, 127};
    surfaces[1].emission_q8 = 512;
  }
  std::vector<Light> lamps(std::size_t most = kMostGlowLamps) {
    finish();
    return glow_lamps(tree, surfaces, most);
  }
};

EffectSet effects_of_text(const std::string& text) {
  const tests::TemporaryFolder folder;
  SceneArguments arguments;
  arguments.scene = folder.write("a.scene", text);
  const auto source = open_scene(arguments);
  return called_for(source->lighting(), used_materials(*source));
}

}  // namespace

TEST_CASE("a glowing voxel in the air -> a lamp in its middle, as bright as its six faces") {
  Glowing world;
  world.voxel({4, 5, 6}, 1);
  const std::vector<Light> lamps = world.lamps();
  REQUIRE(lamps.size() == 1);
  CHECK(lamps[0].is_point);
  CHECK(lamps[0].reach == 1);
  CHECK(lamps[0].place == PackedVec3i(4 * 256 + 128, 5 * 256 + 128, 6 * 256 + 128));
  CHECK(lamps[0].color_q8[0] == std::lround(512 * 6 / M_PI));
  CHECK(lamps[0].color_q8[2] == std::lround(512 * 127 / 255.0 * 6 / M_PI));
}

TEST_CASE("a glowing panel in a ceiling -> lamps before it, twice as bright for their faces") {
  Glowing world;
  world.box({0, 0, 20}, {32, 32, 24}, 0);
  world.box({8, 8, 20}, {9, 9, 21}, 1);
  const std::vector<Light> lamps = world.lamps();
  REQUIRE(lamps.size() == 1);
  CHECK(lamps[0].place == PackedVec3i(8 * 256 + 128, 8 * 256 + 128, 20 * 256 - 128));
  CHECK(lamps[0].color_q8[0] == std::lround(512 * 2 / M_PI));
}

TEST_CASE("much that glows -> never more lamps than asked for, and all of its light; nothing -> none") {
  CHECK(Glowing().lamps().empty());
  Glowing world;
  world.box({0, 0, 0}, {32, 32, 1}, 1);
  world.voxel({31, 31, 31}, 1);
  for (const std::size_t most : {std::size_t{1}, std::size_t{2}, std::size_t{7}, kMostGlowLamps}) {
    CAPTURE(most);
    const std::vector<Light> lamps = world.lamps(most);
    CHECK(!lamps.empty());
    CHECK(lamps.size() <= most);
  }
  CHECK(world.lamps(0).empty());
  // What is walled in sends nothing.
  Glowing hidden;
  hidden.box({0, 0, 0}, {8, 8, 8}, 0);
  hidden.voxel({4, 4, 4}, 1);
  CHECK(hidden.lamps().empty());
}

TEST_CASE("a scene that glows calls for light from it, unless it says otherwise") {
  const std::string scene = "material lamp emit\nbox lamp from 0 0 0 to 2 2 2\n";
  CHECK(effects_of_text(scene) == kOfGlow);
  CHECK(effects_of_text(scene + "effects off emitter-light\n") == Effect::kEmission);
  CHECK(effects_of_text(scene + "effects off direct-light\n") == Effect::kEmission);
  CHECK(effects_of_text(scene + "effects off emission\n") == Effect::kNone);
  CHECK(effects_of_text(scene + "effects off shadows\n") == (kOfGlow & ~Effect::kShadows));
  CHECK(effects_of_text("material lamp emit emission 0\nbox lamp from 0 0 0 to 2 2 2\n") == Effect::kNone);
  CHECK(parse_effects("emitter-light").has_value());
  CHECK(chosen_effects({}, {}, *parse_effects("emitter-light")) == kOfGlow);
}

TEST_CASE("ambient counts without a sun or a lamp, and none is made up") {
  const std::string scene = "material stone\nbox stone from 0 0 0 to 2 2 2\n";
  CHECK(effects_of_text(scene) == Effect::kNone);
  CHECK(effects_of_text(scene + "ambient brightness 0.1\n") == Effect::kDirectLight);
  CHECK(effects_of_text(scene + "ambient\neffects off direct-light\n") == Effect::kNone);
  LitDescription lit;
  CHECK(lit.drawn(Effect::kDirectLight).lights.size == 1);
  lit.has_own_ambient = true;
  CHECK(lit.drawn(Effect::kDirectLight).lights.empty());
  CHECK(lit.drawn(kOfGlow).lights.empty());
}

TEST_CASE("a baked scene keeps its lamps, and finds no second ones") {
  const tests::TemporaryFolder folder;
  SceneArguments arguments;
  arguments.scene = folder.write("a.scene",
                                 "material lamp emit\nmaterial stone\nbox stone from 0 0 0 to 8 8 1\n"
                                 "box lamp from 4 4 4 to 6 6 6\nambient brightness 0.1\n");
  const Baked baked = bake_scene(*open_scene(arguments), {});
  CHECK(baked.effects == kOfGlow);
  arguments.scene = folder.write("a.oct", std::string(baked.bytes.begin(), baked.bytes.end()));
  const auto again = open_scene(arguments);
  LitDescription lit = again->lighting();
  const LitScene before = lit.drawn(kOfGlow);
  CHECK(before.lights.size == 8);
  lit.find_glow(baked.scene.tree());
  CHECK(lit.drawn(kOfGlow).lights.size == 8);
  CHECK(called_for(lit, used_materials(*again)) == kOfGlow);
}

TEST_CASE("--normals: smooth adds the effect to whatever there is, face takes it away") {
  EffectChoice choice;
  choice.smooth = true;
  CHECK(chosen_effects({}, {}, choice) == Effect::kSmoothNormals);
  choice = *parse_effects("smooth-normals,sky");
  CHECK(chosen_effects({}, {}, choice) == (Effect::kSmoothNormals | Effect::kSky));
  choice.smooth = false;
  CHECK(chosen_effects({}, {}, choice) == Effect::kSky);
}
