// What light does in scenes of every kind, as the core takes it, and which effects follow.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "readers/oct.h"
#include "scene/baking.h"
#include "scene/built_scene.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "support/check_command.h"
#include "support/reader_inputs.h"
#include "thimble/base/memory.h"

namespace {

using namespace thimble;
using namespace thimble::tools;
using tests::TemporaryFolder;
using tools::test::contains;

std::unique_ptr<SceneSource> open_file(const std::string& path) {
  SceneArguments arguments;
  arguments.scene = path;
  return open_scene(arguments);
}

EffectSet effects_of_file(const std::string& path) {
  const auto source = open_file(path);
  return called_for(source->lighting(), used_materials(*source));
}

Material of_kind(tools::SurfaceKind kind) {
  Material material;
  material.kind = kind;
  return material;
}

}  // namespace

TEST_CASE("surface_of: parameters of a file -> the core's numbers") {
  Material material = of_kind(tools::SurfaceKind::kMetal);
  material.color = {1, 2, 3};
  material.roughness = 0.25;
  material.weight = 0.5;
  Surface surface = surface_of(material);
  CHECK(surface.albedo == Rgb8{1, 2, 3});
  CHECK(surface.kind == tools::SurfaceKind::kMetal);
  CHECK(surface.roughness == 64);
  CHECK(surface.mirror == 128);  // version 150 has a weight and no metalness
  material.metalness = 1;
  CHECK(surface_of(material).mirror == 255);

  material = of_kind(tools::SurfaceKind::kGlass);
  material.ior = 1.5;
  material.transparency = 1;
  CHECK(surface_of(material).index_q12 == 6144);
  const auto clear = surface_of(material).density_q8;
  CHECK(clear == 16);
  material.transparency = 0;
  CHECK(surface_of(material).density_q8 == 80);
  material.attenuation = 1;
  CHECK(surface_of(material).density_q8 == 336);

  material = of_kind(tools::SurfaceKind::kEmit);
  material.emission = 0.5;
  CHECK(surface_of(material).emission_q8 == 128);
  material.flux = 3;
  CHECK(surface_of(material).emission_q8 == 1024);

  material = of_kind(tools::SurfaceKind::kMedia);
  material.density = std::log(2.0);  // exp(-ln 2) is one halving
  CHECK(surface_of(material).density_q8 == 256);
  material.density = 0;
  CHECK(surface_of(material).density_q8 == 1);
  CHECK(surface_of(Material{}).kind == tools::SurfaceKind::kDiffuse);
}

TEST_CASE("surface_of: absurd parameters -> clamped to what the core takes") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double absurd : {nan, infinite, -infinite, -1.0, 1e300, -1e300, 0.0}) {
    for (int kind = 0; kind < 5; ++kind) {
      CAPTURE(absurd);
      CAPTURE(kind);
      Material material = of_kind(static_cast<tools::SurfaceKind>(kind));
      material.weight = material.roughness = material.ior = material.attenuation = material.flux =
          material.emission = material.density = material.metalness = material.transparency = absurd;
      const Surface surface = surface_of(material);
      CHECK(surface.index_q12 >= kMinIndexQ12);
      CHECK(surface.index_q12 <= kMaxIndexQ12);
      CHECK((absurd > 1 || surface.roughness == 0));
    }
  }
  Material material = of_kind(tools::SurfaceKind::kGlass);
  material.ior = 0.5;
  CHECK(surface_of(material).index_q12 == kMinIndexQ12);
  material.ior = 400;
  CHECK(surface_of(material).index_q12 == kMaxIndexQ12);
}

TEST_CASE("effects: what occurs in the tree calls for its effect, what only the palette holds does not") {
  Palette palette{};
  palette[3] = of_kind(tools::SurfaceKind::kGlass);
  palette[4] = of_kind(tools::SurfaceKind::kMetal);
  palette[5] = of_kind(tools::SurfaceKind::kEmit);
  palette[6] = of_kind(tools::SurfaceKind::kMedia);
  const LitDescription lit = describe_palette(palette);
  UsedMaterials used;
  CHECK(called_for(lit, used) == Effect::kNone);
  used.is[1] = true;
  CHECK(called_for(lit, used) == Effect::kNone);
  used.is[3] = true;
  CHECK(called_for(lit, used) == thimble::Effect::kGlass);
  used.is[4] = used.is[5] = used.is[6] = true;
  // What glows lights the rest, as lamps do.
  constexpr EffectSet kOfGlow =
      Effect::kEmission | Effect::kEmitterLight | Effect::kDirectLight | Effect::kShadows;
  CHECK(called_for(lit, used) == (thimble::Effect::kGlass | Effect::kMirror | kOfGlow | Effect::kMedia));
}

TEST_CASE("effects: on and off by the author -> in and out of the set; no shadows without direct light") {
  LitDescription lit = describe_palette(Palette{});
  const UsedMaterials used;
  lit.lights.push_back(Light{});
  lit.rest.has_shadows = true;
  CHECK(called_for(lit, used) == (Effect::kDirectLight | Effect::kShadows));
  lit.off = Effect::kShadows;
  CHECK(called_for(lit, used) == Effect::kDirectLight);
  lit.off = Effect::kDirectLight;
  CHECK(called_for(lit, used) == Effect::kNone);
  lit = describe_palette(Palette{});
  lit.on = Effect::kSky | Effect::kShadows;
  CHECK(called_for(lit, used) == (Effect::kSky | Effect::kShadows | Effect::kDirectLight));
}

TEST_CASE("--effects: auto, none, lists -> a choice; anything else -> nothing") {
  CHECK(parse_effects("auto")->automatic);
  CHECK_FALSE(parse_effects("none")->automatic);
  CHECK(parse_effects("none")->effects == Effect::kNone);
  CHECK(parse_effects("sky")->effects == Effect::kSky);
  CHECK(parse_effects("shadows,fog,depth-cue")->effects ==
        (Effect::kShadows | Effect::kFog | Effect::kDepthCue));
  for (const char* bad : {"", "Sky", "sky,", ",sky", "sky,,fog", "sky,sky", "auto,sky", "none,sky", "sky fog",
                          "all,sky", "ao,ao"}) {
    CAPTURE(std::string(bad));
    CHECK_FALSE(parse_effects(bad).has_value());
  }
  CHECK(parse_effects("sky,ao")->effects == (Effect::kSky | Effect::kAmbientOcclusion));
  CHECK(effects_text(Effect::kNone) == "none");
  CHECK(effects_text(Effect::kShadows | Effect::kSky) == "shadows,sky");
  CHECK(parse_effects(effect_names())->effects == Effect::kAll);
  const LitDescription lit = describe_palette(Palette{});
  CHECK(chosen_effects(lit, {}, *parse_effects("shadows")) == (Effect::kShadows | Effect::kDirectLight));
  CHECK(chosen_effects(lit, {}, *parse_effects("auto")) == Effect::kNone);
  constexpr EffectSet kEverywhere = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                                    Effect::kEmission | Effect::kEmitterLight | Effect::kSmoothNormals;
  CHECK(chosen_effects(lit, {}, *parse_effects("all")) == kEverywhere);
  LitDescription with_sky = lit;
  with_sky.on = Effect::kSky;
  CHECK(chosen_effects(with_sky, {}, *parse_effects("all")) == (kEverywhere | Effect::kSky));
}

TEST_CASE("with_defaults: effects asked for and not described -> something to show; what is there stays") {
  const LitScene plain;
  CHECK(effects_of(plain) == Effect::kNone);
  CHECK(effects_of(with_defaults(plain, Effect::kNone)) == Effect::kNone);
  for (const EffectSet effect :
       {Effect::kDirectLight, Effect::kAmbientOcclusion, Effect::kFog, Effect::kSky, Effect::kDepthCue}) {
    CAPTURE(effect_name(effect));
    CHECK(effects_of(with_defaults(plain, effect)) == effect);
  }
  CHECK(effects_of(with_defaults(plain, Effect::kDirectLight | Effect::kShadows)) ==
        (Effect::kDirectLight | Effect::kShadows));
  // Needs a material, or water.
  CHECK(effects_of(with_defaults(plain, Effect::kMirror | thimble::Effect::kGlass | Effect::kMedia |
                                            Effect::kEmission | Effect::kWater)) == Effect::kNone);
  LitScene own = plain;
  const Light light{true, {1, 2, 3}, {4, 5, 6}, 7};
  own.lights = {&light, 1};
  own.occlusion.rays = 32;
  own.fog.density_q16 = 5;
  const LitScene kept = with_defaults(own, Effect::kAll);
  CHECK(kept.lights.data == &light);
  CHECK(kept.occlusion.rays == 32);
  CHECK(kept.fog.density_q16 == 5);
}

TEST_CASE("generators: water -> still water between the walls, a sun, a sky; the others -> no effect") {
  for (const int depth : {4, 6, 8}) {
    CAPTURE(depth);
    const auto source = open_file("water,depth=" + std::to_string(depth));
    const LitDescription lit = source->lighting();
    const WaterSurface& water = lit.rest.water;
    CHECK(called_for(lit, used_materials(*source)) ==
          (Effect::kDirectLight | Effect::kShadows | Effect::kMirror | thimble::Effect::kGlass |
           Effect::kWater | Effect::kSky));
    const int side = 1 << depth;
    CHECK(water.corner.x + water.width + water.corner.x == side);
    CHECK(water.highest_q8 == 15 * 256 * side / 64);
  }
  for (const char* plain : {"spheres", "demo,depth=4", "points:100,depth=4"}) {
    CAPTURE(std::string(plain));
    CHECK(effects_of_file(plain) == Effect::kNone);
  }
}

TEST_CASE(
    "baking: with lighting -> the same description and effects from the file; a plain scene -> no section") {
  const TemporaryFolder folder;
  const auto path = folder.write(
      "a.scene",
      "material plain color 9 9 9\nmaterial clear glass index 1.25 color 1 2 3\nmaterial lit emit emission "
      "2\n"
      "box plain from 0 0 0 to 8 8 1\nball clear at 4 4 4 radius 2\nmodel points:3,depth=2 at 0 0 5\n"
      "lamp at 4 4 7\nwater level 2\nocclusion\nbounces 2\n");
  const auto source = open_file(path);
  const EffectSet expected = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                             thimble::Effect::kGlass | Effect::kWater;
  CHECK(called_for(source->lighting(), used_materials(*source)) == expected);
  BakingOptions options;
  const Baked baked = bake_scene(*source, options);
  CHECK(baked.effects == expected);
  folder.write("a.oct", std::string(baked.bytes.begin(), baked.bytes.end()));
  const auto again = open_file(folder.path("a.oct"));
  const LitDescription lit = again->lighting();
  CHECK(called_for(lit, used_materials(*again)) == expected);
  CHECK(lit.lights == source->lighting().lights);
  CHECK(lit.rest.bounces == 2);
  CHECK(lit.rest.water.highest_q8 == 512);
  CHECK(lit.surfaces[1] == source->lighting().surfaces[1]);
  CHECK(lit.surfaces[0].albedo == Rgb8{9, 9, 9});

  options.effects = *parse_effects("sky,fog");
  const Baked other = bake_scene(*source, options);
  CHECK(other.effects == (Effect::kSky | Effect::kFog));
  BakedLighting lighting;
  REQUIRE(BakedLighting::open(other.scene.section(SectionKind::kLighting), 3, &lighting) == Status::kOk);
  CHECK(lighting.effects == (Effect::kSky | Effect::kFog));
  CHECK(effects_of(lighting.scene) ==
        (Effect::kSky | Effect::kFog));  // defaults where nobody said; nothing else kept
  CHECK(lighting.scene.lights.empty());
  CHECK(lighting.scene.surfaces.empty());

  options.effects = *parse_effects("none");
  CHECK(bake_scene(*source, options).scene.section(SectionKind::kLighting).empty());
  options.effects = {};
  CHECK(bake_scene(*open_file("spheres"), options).scene.section(SectionKind::kLighting).empty());
}

TEST_CASE("bake: a header -> the set of effects as a macro; --effects as asked for; info tells it") {
  const TemporaryFolder folder;
  const auto macro = [&](const std::string& scene, const std::vector<std::string>& more) {
    using tests::operator+;
    tests::check_done(tests::Words{"bake", scene, "-o", folder.path("a.h")} + more);
    for (const std::string& line : tests::lines_of(tests::read_text(folder.path("a.h")))) {
      if (line.starts_with("#define THIMBLE_SCENE_EFFECTS ")) {
        return line.substr(30);
      }
    }
    return std::string("none");
  };
  CHECK(macro("water", {}) == "0x2b3u /* direct-light shadows mirror glass water sky */");
  CHECK(macro("water", {"--effects", "sky"}) == "0x200u /* sky */");
  CHECK(macro("water", {"--effects", "none"}) == "0x000u");
  CHECK(macro("spheres", {}) == "0x000u");
  tests::check_refused({"bake", "water", "-o", folder.path("b.h"), "--effects", "gloss"}, 2,
                       {"--effects: \"gloss\" is not auto, none, all or a list"});
  tests::check_done({"bake", "water", "-o", folder.path("a.oct")});
  const auto info = tests::run_command({"info", folder.path("a.oct")});
  CHECK(contains(info.out, "effects              direct-light,shadows,mirror,glass,water,sky\n"));
  CHECK(contains(info.out, "water                58 x 58 columns from 3,3, level 15\n"));
  CHECK(contains(info.out, "lighting 157"));
}

TEST_CASE("baked file: lighting damaged under right checksums -> refused by name") {
  const TemporaryFolder folder;
  const Baked baked = bake_scene(*open_file("water,depth=3"), {});
  std::vector<std::uint8_t> bytes(baked.bytes.begin(), baked.bytes.end());
  const ConstBytes lighting = baked.scene.section(SectionKind::kLighting);
  const auto at = static_cast<std::size_t>(lighting.data - baked.scene.bytes().data);
  bytes[at + 2] = 99;
  // The checksum, put right as the core computes it.
  const auto all = ConstBytes{bytes.data(), bytes.size()};
  const std::uint32_t crc = crc32(all.subspan(12), crc32(all.subspan(0, 8)));
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[8 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
  folder.write("a.oct", std::string(bytes.begin(), bytes.end()));
  try {
    open_file(folder.path("a.oct"));
    FAIL("opened");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()) ==
          "damaged at " + std::to_string(at + 1) + ": lighting with a flag or number that does not exist");
  }
}

TEST_CASE("real .vox files -> materials that occur call for their effects, plain ones for none") {
  const auto data = tools::test::data_folder();
  if (data.empty()) {
    return;
  }
  CHECK(effects_of_file(data / "vox/bevy/test.vox") == (thimble::Effect::kGlass | Effect::kMedia));
  CHECK(effects_of_file(data / "vox/dot_vox/metal-material.vox") == Effect::kMirror);
  const auto source = open_file(data / "vox/bevy/test.vox");
  const LitDescription lit = source->lighting();
  CHECK(lit.surfaces[181].kind == tools::SurfaceKind::kGlass);
  CHECK(lit.surfaces[181].index_q12 == 5325);  // 1.3
  CHECK(lit.surfaces[232].kind == tools::SurfaceKind::kEmit);
  CHECK(lit.surfaces[232].emission_q8 == 102);  // 0.4
  CHECK(lit.surfaces[238].kind == tools::SurfaceKind::kMedia);
  CHECK(lit.surfaces[238].density_q8 == 18);  // 0.05
  for (const char* plain : {"vox/ephtracy/deer.vox", "vox/ephtracy/monu10.vox", "vox/bevy/deer.vox"}) {
    if (std::filesystem::exists(data / plain)) {
      CAPTURE(std::string(plain));
      CHECK(effects_of_file(data / plain) == Effect::kNone);
    }
  }
}
