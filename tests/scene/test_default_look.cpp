// The default look: what a scene has decides, and what a scene states stays.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <vector>

#include "scene/default_look.h"
#include "scene/lit_description.h"
#include "scene/look_picture.h"

namespace {

using namespace thimble;
using namespace thimble::tools;

Framing looking(const Vec3i& forward) {
  Framing framing;
  framing.kept.forward = forward;
  return framing;
}

SceneFacts colored() {
  SceneFacts facts;
  facts.has_colors = true;
  facts.palette.assign(256, Rgb8{10, 200, 30});
  facts.bounds = {{4, 4, 4}, {24, 20, 30}};
  facts.used.is[1] = true;
  return facts;
}

Look look_at_front(const SceneFacts& facts, const LookWishes& wishes = {}) {
  return default_look(facts, wishes, looking({0, 1 << 20, 0}));
}

bool has(const Look& look, EffectSet effects) {
  return (look.effects & effects) == effects;
}

}  // namespace

TEST_CASE("look: colours -> a sun, shadows, occlusion, a gradient, a ground, four samples, its palette") {
  const Look look = look_at_front(colored());
  CHECK(look.kind == LookKind::kLit);
  CHECK(has(look, Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion));
  CHECK_FALSE(has(look, Effect::kSky));
  CHECK(look.has_backdrop);
  CHECK(look.background.kind == BackgroundKind::kGradient);
  CHECK(look.ground.is_there);
  CHECK(look.ground.z == 4);
  CHECK(look.across == 2);
  CHECK(look.palette[7] == Rgb8{10, 200, 30});
  CHECK((look.effects & Effect::kSmoothNormals) == 0);
}

TEST_CASE("look: from every side -> the sun shines on what faces the viewer") {
  for (const Vec3i& forward : {Vec3i{1 << 20, 0, 0}, Vec3i{-(1 << 20), 0, 0}, Vec3i{0, 1 << 20, 0},
                               Vec3i{0, -(1 << 20), 0}, Vec3i{0, 0, -(1 << 20)}, Vec3i{0, 0, 1 << 20},
                               Vec3i{600000, 800000, -500000}, Vec3i{-600000, 800000, -500000}}) {
    const Look look = default_look(colored(), {}, looking(forward));
    const LitScene scene = look.lit_scene();
    REQUIRE(scene.lights.size == 1);
    const Vec3i sun = scene.lights[0].place;
    const std::int64_t facing = std::int64_t{sun.x} * -forward.x + std::int64_t{sun.y} * -forward.y +
                                std::int64_t{sun.z} * -forward.z;
    CHECK(facing > 0);
    CHECK(look.ground.toward_sun == sun);
  }
}

TEST_CASE(
    "look: a wide side -> the sun is over the shoulder on whose side it is seen; else over the left one") {
  // How far to the picture's right, seen from the front.
  const auto to_right = [](const VoxelBox& box, const Vec3i& forward) {
    SceneFacts facts = colored();
    facts.bounds = box;
    const Vec3i sun = default_look(facts, {}, looking(forward)).ground.toward_sun;
    return std::int64_t{sun.x} * forward.y - std::int64_t{sun.y} * forward.x;
  };
  const VoxelBox wide{{0, 0, 0}, {64, 8, 16}};
  const VoxelBox long_one{{0, 0, 0}, {8, 64, 16}};
  const VoxelBox cube{{0, 0, 0}, {16, 16, 16}};
  const Vec3i from_left{500000, 800000, -400000};
  const Vec3i from_right{-500000, 800000, -400000};
  CHECK(to_right(wide, from_left) > 0);
  CHECK(to_right(wide, from_right) < 0);
  CHECK(to_right(long_one, from_left) < 0);
  CHECK(to_right(long_one, from_right) > 0);
  CHECK(to_right(wide, {-500000, -800000, -400000}) > 0);  // the same from behind
  CHECK(to_right(cube, from_left) < 0);
  CHECK(to_right(cube, from_right) < 0);
  CHECK(to_right({}, from_left) < 0);
  SceneFacts facts = colored();
  facts.bounds = wide;
  const Vec3i sun = default_look(facts, {}, looking(from_left)).ground.toward_sun;
  CHECK(-sun.y > std::abs(sun.x));  // it shines on the front
}

TEST_CASE("look: a mesh or a surface of points without colours -> clay; strewn points -> stars") {
  SceneFacts facts = colored();
  facts.has_colors = false;
  facts.is_mesh = true;
  const Look mesh = look_at_front(facts);
  CHECK(mesh.palette[0] == mesh.palette[255]);
  CHECK(mesh.palette[0].r > mesh.palette[0].b);
  CHECK((mesh.effects & Effect::kSmoothNormals) != 0);
  facts.is_mesh = false;
  facts.is_points = true;
  facts.surface_share = kSurfaceShare;
  CHECK(look_at_front(facts).kind == LookKind::kLit);
  facts.surface_share = kSurfaceShare - 1;
  CHECK(look_at_front(facts).kind == LookKind::kStars);
}

TEST_CASE("look: lights, sky, occlusion, effects that the scene states -> kept as they are") {
  SceneFacts facts = colored();
  Light lamp;
  lamp.is_point = true;
  lamp.reach = 9;
  facts.lighting.lights = {lamp};
  facts.lighting.rest.has_sky = true;
  facts.lighting.rest.occlusion = {4, 99, 3};
  facts.lighting.off = Effect::kShadows;
  const Look look = look_at_front(facts);
  REQUIRE(look.lit_scene().lights.size == 1);
  CHECK(look.lit_scene().lights[0].is_point);
  CHECK(look.lit_scene().lights[0].reach == 9);
  CHECK(look.lit_scene().occlusion == Occlusion{4, 99, 3});
  CHECK(has(look, Effect::kSky));
  CHECK_FALSE(has(look, Effect::kShadows));
  CHECK_FALSE(look.has_backdrop);
  CHECK_FALSE(look.ground.is_there);
  LookWishes wishes;
  wishes.background = {BackgroundKind::kColor, {1, 2, 3}};
  wishes.ground = true;
  CHECK(look_at_front(facts, wishes).has_backdrop);
  CHECK(look_at_front(facts, wishes).ground.is_there);
}

TEST_CASE("look: an ambient of its own, or no direct light -> no sun is added") {
  SceneFacts dark = colored();
  dark.lighting.rest.ambient_q8[0] = 1;
  CHECK(look_at_front(dark).lit_scene().lights.size == 0);
  SceneFacts off = colored();
  off.lighting.off = Effect::kDirectLight;
  CHECK_FALSE(has(look_at_front(off), Effect::kDirectLight));
}

TEST_CASE("look: up to the limit of rays -> four samples a pixel; a wish goes first") {
  CHECK(LookMeasure{256, kMostLookRays}.allows_four());
  CHECK_FALSE(LookMeasure{256, kMostLookRays + 1}.allows_four());
  LookWishes wishes;
  wishes.across = 3;
  CHECK(look_at_front(colored(), wishes).across == 3);
}

TEST_CASE("look: none, gradient and six hex digits are backgrounds; nothing else is") {
  Background background;
  CHECK(parse_background("none", &background));
  CHECK(background.kind == BackgroundKind::kNone);
  CHECK(parse_background("gradient", &background));
  CHECK(background.kind == BackgroundKind::kGradient);
  CHECK(parse_background("0aFf10", &background));
  CHECK(background.kind == BackgroundKind::kColor);
  CHECK(background.color == Rgb8{10, 255, 16});
  for (const char* wrong :
       {"", "#0aff10", "0aff1", "0aff100", "0aff1g", "-aff10", "+aff10", "None", " none"}) {
    CAPTURE(wrong);
    CHECK_FALSE(parse_background(wrong, &background));
  }
}

TEST_CASE("tone: never falls, nothing is cut off, black stays black; exposures keep their limits") {
  for (const std::uint32_t exposure : {kLeastExposureQ8, 256U, kMostExposureQ8}) {
    const ToneTable table = tone_table(exposure);
    CHECK(table[0] == 0);
    CHECK(std::is_sorted(std::begin(table.of), std::end(table.of)));
    CHECK(table[255] < 255);
    CHECK(table[200] < table[255]);  // bright and brighter stay apart
  }
  CHECK(tone_table(256)[100] == 150);  // straight below the knee
  GrayCounts counts;
  CHECK(exposure_q8(counts) == 256);
  counts.of[0] = 1000;
  CHECK(exposure_q8(counts) == kMostExposureQ8);
  counts = {};
  counts.of[255] = 10;
  CHECK(exposure_q8(counts) == kLeastExposureQ8);
  counts = {};
  counts.of[60] = 899;
  counts.of[128] = 100;
  counts.of[140] = 1;  // a tenth is as bright as 128
  CHECK(exposure_q8(counts) == kExposedGray * 512 / 384);
}

using namespace thimble;
using namespace thimble::tools;

namespace {

Light sun_of(const Vec3i& toward, std::uint16_t brightness) {
  Light light;
  light.place = toward;
  std::fill(std::begin(light.color_q8), std::end(light.color_q8), brightness);
  return light;
}

}  // namespace

TEST_CASE(
    "quick light: a sun by its angle, lamps for every face alike, and faces stay apart however bright") {
  LitScene scene;
  std::fill(std::begin(scene.ambient_q8), std::end(scene.ambient_q8), std::uint16_t{40});
  std::uint16_t faces[6];
  Light lights[] = {sun_of({0, 3, 4}, 100), Light{}};
  scene.lights = {lights, 1};
  quick_light(scene, faces);
  CHECK(faces[0] == 40);
  CHECK(faces[1] == 40);
  CHECK(faces[2] == 40);
  CHECK(faces[3] == 100);  // 3/5 of the sun
  CHECK(faces[4] == 40);
  CHECK(faces[5] == 120);
  lights[1].is_point = true;
  scene.lights = {lights, 2};
  quick_light(scene, faces);
  CHECK(faces[0] == 140);
  CHECK(faces[5] == 220);
  lights[0] = sun_of({0, 3, 4}, 1000);  // 740 and 940 would be white alike
  quick_light(scene, faces);
  CHECK(faces[5] == 256);
  CHECK(faces[3] == 256 * 740 / 940);
  CHECK(faces[0] == 256 * 140 / 940);
}

TEST_CASE("quick look: colours are toned for the brightest face, which has all of its light") {
  Look look;
  look.palette = {{200, 100, 50}, {0, 0, 0}};
  look.lighting.lights = {sun_of({0, 0, 1}, 128)};
  look.effects = Effect::kDirectLight;
  std::fill(std::begin(look.lighting.rest.ambient_q8), std::end(look.lighting.rest.ambient_q8),
            std::uint16_t{0});
  const ToneTable tone = tone_table(256);
  const QuickLook quick = quick_look(look, tone);
  CHECK(quick.face_light[5] == 256);
  CHECK(quick.face_light[0] == 0);
  REQUIRE(quick.palette.size() == 2);
  CHECK(quick.palette[0].r == tone[100]);
  CHECK(quick.palette[0].g == tone[50]);
  CHECK(quick.palette[1].b == 0);
  look.has_backdrop = false;
  CHECK(quick_tone(look, 256)[100] == tone[100]);
  look.has_backdrop = true;
  CHECK(quick_tone(look, 256)[100] == tone_table(224)[100]);
}
