#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>

#include "scene/default_look.h"

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
