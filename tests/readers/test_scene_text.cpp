// `.scene` text: what it says, where its errors are, and the world that comes of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <sys/stat.h>

#include "readers/file_bytes.h"
#include "readers/read_any.h"
#include "readers/scene_text.h"
#include "scene/scene_source.h"
#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

namespace {

using namespace thimble;
using namespace thimble::tools;
using tests::operator+;
using tests::TemporaryFolder;
using tools::test::contains;

std::shared_ptr<const SceneText> parse(const std::string& text) {
  return std::get<std::shared_ptr<const SceneText>>(read_scene_text(SharedBytes::own(text), {}, {}));
}

std::string error_of(const std::string& text) {
  return tools::test::error_of(read_scene_text, text);
}

using VoxelMaterials = std::map<std::array<int, 3>, int>;

VoxelMaterials voxels_of(const SceneSource& source) {
  VoxelMaterials voxels;
  source.stream([&](int x, int y, int z, std::uint8_t material) { voxels[{x, y, z}] = material; }, {});
  return voxels;
}

std::unique_ptr<SceneSource> open_file(const std::string& path) {
  SceneArguments arguments;
  arguments.scene = path;
  return open_scene(arguments);
}

std::string open_error(const std::string& path) {
  try {
    open_file(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

constexpr const char* kPoint = "material m\nbox m from 0 0 0 to 1 1 1\n";  // two lines that show something

}  // namespace

TEST_CASE("scene text: every statement with all of its clauses -> what it says") {
  const auto scene = parse(
      "\xEF\xBB\xBF# a comment, then a blank line\r\n"
      "\r\n"
      "depth 7\r\n"
      "camera eye 1.5 -30,40 target 2, 3, 4 up 0 0 2 fov 45   # commas or blanks\n"
      "sun toward -1 0 2 color 255 128 0 brightness 2\n"
      "lamp at 1 2 3.5 color 255 255 255 brightness 0.5 reach 9\n"
      "ambient color 255 255 0 brightness 0.25\n"
      "sky zenith 1 2 3 horizon 4 5 6 ground 7 8 9\n"
      "fog color 10 20 30 density 0.5\n"
      "occlusion rays 16 reach 12 strength 0.5\n"
      "water level 12.5 floor 2 from 1 2 to 30 40 color 50 60 70 index 1.25 density 0.125\n"
      "bounces 6\n"
      "effects on depth-cue\n"
      "effects off shadows sky\n"
      "material \"gr\xC3\xBCn\" glass color 9 8 7 index 2 density 1\n"
      "material gold metal roughness 1 mirror 0.8\n"
      "box gold from -1 0 1 to 4 5 6\n"
      "ball gr\xC3\xBCn at 1.5 2 3 radius 4\n"
      "model \"a file.vox\" at 1 2 3 turn z 1 mirror x crop depth 5 as-voxels z-up replace 7 gold replace "
      "all "
      "gr\xC3\xBCn\n");
  CHECK(scene->depth == 7);
  REQUIRE(scene->camera.has_value());
  CHECK(scene->camera->is_perspective);
  CHECK(scene->camera->eye == Vec3Q8{Q8::from_raw(384), Q8::saturate(-30), Q8::saturate(40)});
  CHECK(scene->camera->target == Vec3Q8{Q8::saturate(2), Q8::saturate(3), Q8::saturate(4)});
  CHECK(scene->camera->up == Vec3i{0, 0, kMaxViewComponent});
  CHECK(scene->camera->forward.z == -kMaxViewComponent);
  CHECK(scene->camera->fov_degrees == Q16::saturate(45));
  REQUIRE(scene->lights.size() == 2);
  const Light& sun = scene->lights[0].light;
  CHECK_FALSE(sun.is_point);
  CHECK(Vec3i(sun.place) == Vec3i{-8192, 0, 16384});
  CHECK(sun.color_q8[0] == 512);
  CHECK(sun.color_q8[1] == 257);
  CHECK(sun.color_q8[2] == 0);
  const Light& lamp = scene->lights[1].light;
  CHECK(lamp.is_point);
  CHECK(Vec3i(lamp.place) == Vec3i{256, 512, 896});
  CHECK(lamp.color_q8[2] == 128);
  CHECK(lamp.reach == 9);
  const LitScene& rest = scene->rest;
  CHECK(rest.ambient_q8[0] == 64);
  CHECK(rest.ambient_q8[2] == 0);
  CHECK(rest.has_sky);
  CHECK(rest.sky == Sky{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  CHECK(rest.fog == Fog{{10, 20, 30}, 32768});
  CHECK(rest.occlusion == Occlusion{16, 128, 12});
  CHECK(rest.has_shadows);
  CHECK(rest.bounces == 6);
  REQUIRE(scene->water.has_value());
  CHECK(scene->water->level_q8 == 3200);
  CHECK(scene->water->floor == 2);
  CHECK(*scene->water->from_to == std::array<std::int32_t, 4>{1, 2, 30, 40});
  CHECK(rest.water_material.albedo == Rgb8{50, 60, 70});
  CHECK(rest.water_material.index_q12 == 5120);
  CHECK(rest.water_material.density_q8 == 32);
  CHECK(scene->on == Effect::kDepthCue);
  CHECK(scene->off == (Effect::kShadows | Effect::kSky));
  REQUIRE(scene->materials.size() == 2);
  CHECK(scene->materials[0].name == "gr\xC3\xBCn");
  CHECK(scene->materials[0].has_color);
  CHECK(scene->materials[0].surface.kind == tools::SurfaceKind::kGlass);
  CHECK(scene->materials[0].surface.index_q12 == 8192);
  CHECK_FALSE(scene->materials[1].has_color);
  CHECK(scene->materials[1].surface.mirror == 204);
  REQUIRE(scene->parts.size() == 3);
  CHECK(scene->parts[0].low == Vec3i{-1, 0, 1});
  CHECK(scene->parts[0].high == Vec3i{4, 5, 6});
  CHECK(scene->parts[1].radius_q8 == 1024);
  const SceneText::Part& model = scene->parts[2];
  CHECK(model.file == "a file.vox");
  CHECK(model.at == Vec3i{1, 2, 3});
  CHECK(model.crop);
  CHECK(model.as_voxels);
  CHECK(model.z_up);
  CHECK(model.depth == 5);
  CHECK(model.replaced[7] == 1);
  CHECK(model.replaced[8] == 0);
  CHECK(parse(std::string(kPoint) + "camera eye 0 0 9 target 0 0 0 span 40")->camera->span ==
        Q14::saturate(40));
}

TEST_CASE("scene text: what it leaves out -> plain defaults, and no effect of its own") {
  const auto scene = parse(kPoint);
  CHECK_FALSE(scene->depth.has_value());
  CHECK_FALSE(scene->camera.has_value());
  CHECK(scene->lights.empty());
  CHECK_FALSE(scene->rest.has_shadows);
  CHECK_FALSE(scene->rest.has_sky);
  CHECK_FALSE(scene->water.has_value());
  CHECK(scene->rest.bounces == kDefaultBounces);
  CHECK(parse("material g glass\nball g at 1 1 1 radius 1")->materials[0].surface.index_q12 == 6144);
}

TEST_CASE("scene text: each error -> its line, its column and what is wrong") {
  struct Case {
    const char* text;
    int line, column;
    const char* says;
  };
  const Case cases[] = {
      {"", 0, 1, "shows nothing"},
      {"depth 4\n# no more", 2, 1, "shows nothing"},
      {"cube", 1, 1, "'cube' is no statement; there are model, box"},
      {"\n\t  Depth 4", 2, 4, "'Depth' is no statement"},
      {"depth", 1, 6, "depth is missing"},
      {"depth   # later", 1, 9, "depth is missing"},
      {"depth 0", 1, 7, "it must be 1 to 12"},
      {"depth 13", 1, 7, "it must be 1 to 12"},
      {"depth 4.5", 1, 7, "not a whole number"},
      {"depth 99999999999999999999", 1, 7, "it must be 1 to 12"},
      {"depth 4 5", 1, 9, "nothing more belongs into this line"},
      {"depth 4\r\ndepth 5", 2, 1, "said twice; the first stands in line 1"},
      {"\"depth\" 4", 1, 1, "is no statement"},
      {"# \xC3\xA4\xC3\xB6\n\xC3\xA4 1", 2, 1, "is no statement"},
      {"material \xC3\xA4\xC3\xB6 shiny", 1, 13,
       "'shiny' is not known in material"},  // characters, not bytes
      {"depth \xFF", 1, 7, "not UTF-8"},
      {"depth \xC0\x80", 1, 7, "not UTF-8"},
      {"depth \xED\xA0\x80", 1, 7, "not UTF-8"},
      {"\n \xF4\x90\x80\x80", 2, 2, "not UTF-8"},
      {"depth 4\n box\x01", 2, 5, "byte 1 is a control character"},
      {"camera eye 1 2 3", 1, 17, "camera needs target"},
      {"camera target 1 2 3 # eye", 1, 21, "camera needs eye"},
      {"camera eye 1 2 target 1 2 3", 1, 16, "z of eye is 'target', which is not a number"},
      {"camera eye 1 2", 1, 15, "z of eye is missing"},
      {"camera eye 1,2,", 1, 16, "z of eye is missing"},
      {"camera eye 1,,2,3", 1, 14, "y of eye is missing"},
      {"camera eye 1 2 nan target 0 0 0", 1, 16, "z of eye is 'nan', which is not finite"},
      {"camera eye 1 2 1e999 target 0 0 0", 1, 16, "not finite"},
      {"camera eye 1 2 40000 target 0 0 0", 1, 16, "it must be -36864 to 36864"},
      {"camera eye 1 2 3 eye 1 2 3", 1, 18, "eye is said twice in this camera"},
      {"camera eye 1 2 3 target 1 2 3", 1, 1, "the same point"},
      {"camera eye 1 2 3 target 1 2 4 fov 121", 1, 35, "it must be 1 to 120"},
      {"camera eye 1 2 3 target 1 2 4 fov 0.5", 1, 35, "it must be 1 to 120"},
      {"camera eye 1 2 3 target 1 2 4 fov 9 span 9", 1, 37, "one or the other"},
      {"camera eye 1 2 3 target 1 2 4 up 0 0 0", 1, 31, "no direction"},
      {"camera eye 1 2 3 roll 4", 1, 18, "'roll' is not known in camera; there are eye"},
      {"sun", 1, 4, "sun needs toward"},
      {"sun toward 0 0 0", 1, 5, "no direction"},
      {"sun at 1 2 3", 1, 5, "'at' is not known in sun"},
      {"lamp toward 1 2 3", 1, 6, "'toward' is not known in lamp"},
      {"lamp at 1 2 3 reach 0", 1, 21, "it must be 1 to 65535"},
      {"lamp at 1 2 3 brightness -1", 1, 26, "it must be 0 to 100"},
      {"sun toward 1 2 3 color 1 2 256", 1, 28, "blue is '256', it must be 0 to 255"},
      {"sun toward 1 2 3 color 1 -2 3", 1, 26, "green is '-2'"},
      {"sky middle 1 2 3", 1, 5, "there are zenith, horizon and ground"},
      {"sky\nsky", 2, 1, "said twice"},
      {"fog color 1 2 3", 1, 16, "fog needs density"},
      {"fog density inf", 1, 13, "not finite"},
      {"occlusion rays 7", 1, 11, "it must be 4, 8, 16 or 32"},
      {"occlusion strength 1.5", 1, 20, "it must be 0 to 1"},
      {"water", 1, 6, "water needs level"},
      {"water level 3 floor 3", 1, 7, "not above its floor at 3"},
      {"water level 3 from 1 1", 1, 23, "water needs to"},
      {"water level 3 to 1 1", 1, 21, "water needs from"},
      {"water level 3 from 1 1 to 1 5", 1, 1, "holds no column"},
      {"water level 3 mirror 1", 1, 15, "'mirror' is not known in water"},
      {"bounces 9", 1, 9, "it must be 0 to 8"},
      {"effects", 1, 8, "effects needs on or off"},
      {"effects maybe sky", 1, 9, "not 'maybe'"},
      {"effects on", 1, 11, "the name of an effect is missing"},
      {"effects on sparkle", 1, 12, "'sparkle' is no effect; there are direct-light, shadows"},
      {"effects on sky\neffects off sky", 2, 13, "sky is turned on or off twice"},
      {"effects off direct-light\neffects on shadows", 2, 12, "without direct-light there are no shadows"},
      {"effects on emitter-light\neffects off sky direct-light", 2, 17, "without direct-light there are no"},
      {"material", 1, 9, "material needs a name"},
      {"material \"two words\"", 1, 10, "one word"},
      {"material a\nmaterial a", 2, 10, "there is a material 'a' already"},
      {"material a index 0.9", 1, 18, "it must be 1 to 4"},
      {"material a index nan", 1, 18, "not finite"},
      {"material a glass metal", 1, 18, "a material has one kind"},
      {"material a roughness 0.1 roughness 0.2", 1, 26, "said twice"},
      {"material a density -0.5", 1, 20, "it must be 0 to 200"},
      {"material a color 1 2", 1, 21, "blue is missing"},
      {"box", 1, 4, "box needs the name of a material"},
      {"box b from 0 0 0 to 1 1 1", 1, 5, "there is no material 'b' above this line"},
      {"material m\nbox m from 0 0 0", 2, 17, "box needs to"},
      {"material m\nbox m from 0 0 0 to 1 0 1", 2, 1, "holds no voxel"},
      {"material m\nbox m from 0 0 0.5 to 1 1 1", 2, 16, "not a whole number"},
      {"material m\nbox m from 0 0 0 to 1 1 16385", 2, 25, "it must be -16384 to 16384"},
      {"material m\nball m at 1 1 1", 2, 16, "ball needs radius"},
      {"material m\nball m at 1 1 1 radius 0", 2, 24, "it must be 1 to 4096"},
      {"model", 1, 6, "model needs the name"},
      {"model \"\"", 1, 7, "model needs the name"},
      {"model \"a.vox", 1, 7, "the quotation mark is not closed"},
      {"model \"a.vox\"at", 1, 14, "a blank must follow"},
      {"model a.vox turn w 1", 1, 18, "turn needs an axis: x, y or z, not 'w'"},
      {"model a.vox turn z 4", 1, 20, "it must be -3 to 3"},
      {"model a.vox mirror", 1, 19, "mirror needs an axis"},
      {"model a.vox at 1 2 3 at 1 2 3", 1, 22, "said twice"},
      {"model a.vox scale 2", 1, 13, "'scale' is not known in model"},
      {"model a.vox replace", 1, 20, "a palette index from 0 to 255, or all"},
      {"model a.vox replace 256 m", 1, 21, "not '256'"},
      {"material m\nmodel a.vox replace 1", 2, 22, "replace needs the name of a material"},
      {"material m\nmodel a.vox replace 1 n", 2, 23, "there is no material 'n'"},
      {"material m\nmodel a.vox replace 1 m replace 1 m", 2, 33, "replace 1 is said twice"},
      {"material m\nmodel a.vox replace all m replace all m", 2, 35, "replace all is said twice"},
  };
  for (const Case& each : cases) {
    CAPTURE(std::string(each.text));
    const std::string error = error_of(each.text);
    CAPTURE(error);
    const std::string place =
        "line " + std::to_string(each.line) + ", column " + std::to_string(each.column) + ": ";
    CHECK(error.starts_with(place));
    CHECK(contains(error, each.says));
    CHECK(error.find('\n') == std::string::npos);
    CHECK_FALSE(error.ends_with("."));
  }
}

TEST_CASE("scene text: one more than each limit -> refused by its number; the limit itself -> taken") {
  std::string text = kPoint;
  for (std::size_t i = 0; i < kMaxLights; ++i) {
    text += "lamp at 1 1 1\n";
  }
  CHECK(parse(text)->lights.size() == 100);
  CHECK(contains(error_of(text + "sun toward 0 0 1"),
                 "line 103, column 1: there are more lights than the limit of 100"));
  text = "";
  for (std::size_t i = 0; i < kSceneTextMaterials; ++i) {
    text += "material m" + std::to_string(i) + "\n";
  }
  CHECK(parse(text + "box m7 from 0 0 0 to 1 1 1")->materials.size() == 256);
  CHECK(contains(error_of(text + "material x"), "more materials than the limit of 256"));
  text = "material m\n";
  for (std::size_t i = 0; i < kSceneTextParts; ++i) {
    text += "box m from 0 0 0 to 1 1 1\n";
  }
  CHECK(parse(text)->parts.size() == 4096);
  CHECK(contains(error_of(text + "model a.vox"),
                 "line 4098, column 1: there are more models, boxes and balls"));
  text = std::string(kPoint) + "#";
  text.resize(kSceneTextBytes, 'x');
  CHECK(parse(text)->parts.size() == 1);
  CHECK(contains(error_of(text + "x"), "the limit of a .scene file is 1,048,576"));
}

TEST_CASE(
    "scene: boxes and balls -> their voxels, the last one wins, in the smallest world that holds them") {
  const TemporaryFolder folder;
  const auto path =
      folder.write("a.scene",
                   "material red color 255 0 0\nmaterial blue color 0 0 255\nmaterial too color 255 0 0\n"
                   "box red from 0 0 0 to 4 3 2\nbox blue from 3 2 1 to 5 5 5\nball too at 6 1 1 radius 1\n"
                   "box red from -5 0 0 to 1 1 1\n");
  const auto source = open_file(path);
  CHECK(source->kind() == "scene text");
  CHECK(source->level() == 3);
  const VoxelMaterials voxels = voxels_of(*source);
  CHECK(voxels.size() == 24 + 2 * 3 * 4 - 1 + 8);
  const int red = voxels.at({0, 0, 0});
  const int blue = voxels.at({3, 2, 1});
  CHECK(red != blue);
  CHECK(voxels.at({5, 0, 0}) == red);  // the same look, the same material
  CHECK(source->palette()[static_cast<std::size_t>(red)].color == tools::Rgb{255, 0, 0});
  CHECK(source->palette()[static_cast<std::size_t>(blue)].color == tools::Rgb{0, 0, 255});
  CHECK(source->extent() == std::array<std::int32_t, 3>{7, 5, 5});
  CHECK_FALSE(source->single_material());
  CHECK(voxels_of(*source) == voxels);  // again, the same
}

TEST_CASE("scene: a ball -> the voxels whose centres it holds") {
  const TemporaryFolder folder;
  const auto source = open_file(folder.write("a.scene", "material m\nball m at 8.25 7 6.5 radius 5.5\n"));
  const VoxelMaterials voxels = voxels_of(*source);
  std::size_t expected = 0;
  for (int z = 0; z < 16; ++z) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const double dx = x + 0.5 - 8.25, dy = y + 0.5 - 7, dz = z + 0.5 - 6.5;
        const bool inside = dx * dx + dy * dy + dz * dz <= 5.5 * 5.5;
        expected += inside ? 1 : 0;
        CHECK(voxels.contains({x, y, z}) == inside);
      }
    }
  }
  CHECK(voxels.size() == expected);
}

TEST_CASE("scene: boxes and balls in blocks -> aligned, the voxels one by one; 1024 a side in few") {
  const TemporaryFolder folder;
  const auto mixed =
      open_file(folder.write("a.scene",
                             "material m\nmaterial n color 9 9 9\nbox m from 1 3 5 to 17 30 13\n"
                             "ball n at 20.5 20 20.25 radius 11.7\n"
                             "box n from 30 30 -3 to 99 32 4\ndepth 5\n"));
  VoxelMaterials voxels;
  std::size_t calls = 0;
  mixed->stream_blocks(
      [&](const Vec3i& at, int level, std::uint8_t material) {
        const int side = 1 << level;
        CHECK(((at.x | at.y | at.z) & (side - 1)) == 0);
        for (int i = 0; i < side * side * side; ++i) {
          voxels[{at.x + i % side, at.y + i / side % side, at.z + i / side / side}] = material;
        }
        ++calls;
      },
      {});
  CHECK(voxels == voxels_of(*mixed));
  CHECK(calls < voxels.size() / 3);

  // Voxel by voxel the first took 40 s.
  for (const char* const box : {"0 0 0 to 1024 1024 1024", "1 1 1 to 1025 1025 1025"}) {
    const auto large =
        open_file(folder.write("b.scene", std::string("material m\nbox m from ") + box + "\n"));
    std::uint64_t volume = 0;
    std::uint64_t blocks = 0;
    large->stream_blocks(
        [&](const Vec3i&, int level, std::uint8_t) {
          volume += std::uint64_t{1} << (3 * level);
          ++blocks;
        },
        {});
    CHECK(volume == std::uint64_t{1} << 30);
    CHECK(blocks < volume / 100);
  }
}

TEST_CASE("scene: models turned and mirrored -> the lowest corner of the turned box at its place") {
  const TemporaryFolder folder;
  // An asymmetric model of 3 x 2 x 1 voxels, each corner of its own colour.
  folder.write("l.xyz", "0 0 0 255 0 0\n1 0 0 0 255 0\n2 0 0 0 0 255\n0 1 0 255 255 0\n2 1 0 1 1 1\n");
  const auto placed = [&](const std::string& clauses) {
    const auto source =
        open_file(folder.write("a.scene", "depth 4\nmodel l.xyz as-voxels " + clauses + "\n"));
    std::map<std::array<int, 3>, std::array<int, 3>> colors;
    for (const auto& [at, material] : voxels_of(*source)) {
      const tools::Rgb color = source->palette()[static_cast<std::size_t>(material)].color;
      colors[at] = {color.r, color.g, color.b};
    }
    CHECK(colors.size() == 5);
    return colors;
  };
  using Color = std::array<int, 3>;
  const Color red{255, 0, 0}, blue{0, 0, 255}, yellow{255, 255, 0};
  CHECK(placed("at 5 6 7").at({5, 6, 7}) == red);
  CHECK(placed("at 5 6 7").at({7, 6, 7}) == blue);
  // Against the clock seen from above: x goes to y, y to -x. The box is then 2 x 3.
  const auto turned = placed("turn z 1 at 5 6 7");
  CHECK(turned.at({6, 6, 7}) == red);
  CHECK(turned.at({6, 8, 7}) == blue);
  CHECK(turned.at({5, 6, 7}) == yellow);
  CHECK(placed("turn z 3") == placed("turn z -1"));
  CHECK(placed("turn z 2") == placed("mirror x mirror y"));
  CHECK(placed("mirror x").at({2, 0, 0}) == red);
  const auto up = placed("turn x 1");  // y goes to z
  CHECK(up.at({0, 0, 0}) == red);
  CHECK(up.at({0, 0, 1}) == yellow);
  const auto side = placed("turn y 1");  // x goes to -z
  CHECK(side.at({0, 0, 2}) == red);
  CHECK(side.at({0, 0, 0}) == blue);
  // In the order in which they are written.
  CHECK(placed("turn z 1 mirror x") != placed("mirror x turn z 1"));
}

TEST_CASE("scene: a model out of the world -> an error with the depth; crop -> cut off") {
  const TemporaryFolder folder;
  const auto cropped = open_file(folder.write("b.scene", "depth 4\nmodel spheres,depth=4 at 8 -3 0 crop\n"));
  const VoxelMaterials part = voxels_of(*cropped);
  CHECK_FALSE(part.empty());
  for (const auto& [at, material] : part) {
    CHECK((at[0] >= 8 && at[0] < 16 && at[1] >= 0 && at[1] < 16));
  }
  const std::string box = "material m\nbox m from 0 0 0 to 2 2 2\n";
  for (const auto& [each_text, says] : std::vector<std::array<std::string, 2>>{
           {"depth 4\nmodel spheres,depth=4 at 1 0 0\n", "line 2, column 1: the model's voxels from"},
           {"depth 3\nmaterial m\nbox m from 8 0 0 to 9 9 9\n",
            "line 3, column 1: all of this lies outside the world of 8 voxels a side (depth 3)"},
           {"material m\nbox m from 0 0 0 to 1 1 4097\n",
            "line 2, column 1: this reaches to 4097; the largest world ends at 4096"},
           {"material m\nbox m from 0 0 0 to 4096 4096 65\n", "the limit is 1,073,741,824"},
           {box + "lamp at 0 0 11\n", "line 3, column 1: the lamp is outside the accepted -8 to 10"},
           {box + " camera eye 0 0 11 target 1 1 1\n", "line 3, column 2: the eye of the camera is outside"},
           {box + "camera eye 1 1 9 target 1 1 1 up 0 0 1\n", "up of the camera is parallel"},
           {box + "water level 2.5\n", "the water leaves the world of 2 voxels"}}) {
    const auto& text = each_text;
    CAPTURE(text);
    CHECK(contains(open_error(folder.write("a.scene", text)), says));
  }
  SceneArguments arguments;
  arguments.scene = folder.write("j.scene", "depth 3\n" + box);
  arguments.depth = 5;
  CHECK(open_scene(arguments)->level() == 5);  // --depth decides
}

TEST_CASE("scene: replace -> a model's colours as other materials; those without a colour keep the model's") {
  const TemporaryFolder folder;
  folder.write("l.xyz", "0 0 0 255 0 0\n1 0 0 0 255 0\n2 0 0 0 0 255\n");
  const auto path = folder.write("a.scene",
                                 "material clear glass index 2\nmaterial gold metal color 200 180 90\n"
                                 "model l.xyz as-voxels\nmodel l.xyz as-voxels at 0 1 0 replace all clear\n"
                                 "model l.xyz as-voxels at 0 2 0 replace all gold\n");
  const auto source = open_file(path);
  const VoxelMaterials voxels = voxels_of(*source);
  const LitDescription lit = source->lighting();
  const auto surface = [&](int x, int y) {
    return lit.surfaces[static_cast<std::size_t>(voxels.at({x, y, 0}))];
  };
  CHECK(surface(0, 0).kind == tools::SurfaceKind::kDiffuse);
  CHECK(surface(0, 1).kind == tools::SurfaceKind::kGlass);
  CHECK(surface(0, 1).albedo == Rgb8{255, 0, 0});
  CHECK(surface(2, 1).albedo == Rgb8{0, 0, 255});
  CHECK(surface(2, 1).index_q12 == 8192);
  CHECK(surface(1, 2).albedo == Rgb8{200, 180, 90});
  CHECK(voxels.at({0, 2, 0}) == voxels.at({2, 2, 0}));
  CHECK(lit.surfaces.size() == kMaxSurfaces);
}

TEST_CASE("scene: more than 256 materials in all -> an error that names the model") {
  const TemporaryFolder folder;
  std::string points, others;
  for (int i = 0; i < 200; ++i) {
    points += std::to_string(i) + " 0 0 " + std::to_string(i / 16 * 16) + " " + std::to_string(i % 16 * 16) +
              " 0\n";
    others += std::to_string(i) + " 0 0 " + std::to_string(i / 16 * 16) + " " + std::to_string(i % 16 * 16) +
              " 255\n";
  }
  folder.write("a.xyz", points);
  folder.write("b.xyz", others);
  CHECK(open_error(folder.write("twice.scene", "model a.xyz as-voxels\nmodel a.xyz as-voxels at 0 1 0\n"))
            .empty());
  CHECK(contains(
      open_error(folder.write("both.scene", "model a.xyz as-voxels\nmodel b.xyz as-voxels at 0 1 0\n")),
      "line 2, column 1: with this the scene has more than the limit of 256 different materials"));
}

TEST_CASE("scene: scenes within scenes -> paths relative to each file; loops and depth are errors") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("inner"));
  folder.write("inner/point.xyz", "3 2 1\n");
  folder.write("inner/b.scene", "model point.xyz as-voxels\nsun toward 0 0 1\n");
  const auto source = open_file(folder.write("a.scene", "model inner/b.scene at 1 1 1\n"));
  CHECK(voxels_of(*source).contains({4, 3, 2}));
  CHECK(source->lighting().lights.empty());  // only voxels and their materials come along
  CHECK(contains(open_error(folder.write("c.scene", "model inner/c.scene\n")),
                 "line 1, column 7: inner/c.scene: "));

  folder.write("x.scene", "model y.scene\n");
  folder.write("y.scene", "\n  model ./inner/../x.scene\n");
  CHECK(open_error(folder.path("x.scene")) ==
        "line 1, column 7: y.scene: line 2, column 9: ./inner/../x.scene: this scene is a model of itself");

  folder.write("n0.scene", kPoint);
  for (int i = 1; i < 10; ++i) {
    folder.write("n" + std::to_string(i) + ".scene", "model n" + std::to_string(i - 1) + ".scene\n");
  }
  CHECK(open_error(folder.path("n7.scene")).empty());
  CHECK(contains(open_error(folder.path("n8.scene")), "deeper than the limit of 8"));
}

TEST_CASE("scene: scenes that multiply -> refused before they are streamed") {
  const TemporaryFolder folder;
  const auto many = [](const std::string& line) {
    std::string text;
    for (int i = 0; i < 300; ++i) {
      text += line + "\n";
    }
    return text;
  };
  folder.write("nothing.scene", many("model points:0"));
  folder.write("more.scene", many("model nothing.scene"));
  CHECK(contains(open_error(folder.path("more.scene")),
                 "more than the limit of 65,536 models, boxes and balls"));
  folder.write("big.scene", "material m\nbox m from 0 0 0 to 512 512 64\n");
  CHECK(contains(open_error(folder.write("bigger.scene", many("model big.scene"))),
                 "more than the limit of 2,147,483,648 voxels"));
  CHECK(contains(open_error(folder.write("points.scene", "model points:1\nmodel points:134217728\n")),
                 "line 2, column 7: points:134217728: with this the scene's generators make more than the"));
  REQUIRE(mkfifo(folder.path("pipe.vox").c_str(), 0600) == 0);
  CHECK(contains(open_error(folder.write("pipe.scene", "model pipe.vox\n")), "pipe.vox: is no regular file"));
}

TEST_CASE("scene: points that are degrees beside metres -> noted") {
  const TemporaryFolder folder;
  const auto is_noted = [&](const std::string& points) {
    const Notes notes = open_file(folder.write("a.xyz", points))->notes();
    return std::any_of(notes.begin(), notes.end(),
                       [](const std::string& note) { return contains(note, "x and y may be degrees"); });
  };
  CHECK(is_noted("10 50 100\n11 51 200\n10.5 50.5 150\n"));
  CHECK_FALSE(is_noted("10 50 1\n11 51 2\n10.5 50.5 1\n"));
  CHECK_FALSE(is_noted("600010 50 100\n600011 51 200\n600010 50 150\n"));
}

TEST_CASE("scene: models that cannot be read, .gz, options -> as for the command's own SCENE") {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) { return open_error(folder.write("a.scene", text)); };
  CHECK(contains(error("model gone.vox"), "line 1, column 7: gone.vox: "));
  CHECK(contains(error("model ."), "line 1, column 7: .: "));
  folder.write("bad.vox", "VOX nothing");
  CHECK(contains(error("\nmodel bad.vox"), "line 2, column 7: bad.vox: "));
  CHECK(contains(error("model points:x"), "line 1, column 7: points:x: the number of points"));
  CHECK(contains(error("model spheres as-voxels"), "is for point files"));
  folder.write("cube.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  CHECK(open_file(folder.write("m.scene", "model cube.off depth 4 z-up at 1 1 1\n"))->level() == 5);

  CHECK(open_file(folder.write("z.scene.gz", tests::deflated("model points:10,depth=3\n", tests::kGzip)))
            ->level() == 3);
  CHECK((find_reader("a.SCENE.gz", {})->read == read_scene_text));
}

TEST_CASE("scene: the command -> one sentence with file, line and column, status 1; --memory holds") {
  const TemporaryFolder folder;
  const auto bad = folder.write("bad.scene", "depth 5\n\tbox\n");
  tests::check_refused({"render", bad, "-o", folder.path("a.ppm")}, 1,
                       {bad + ": line 2, column 5: box needs the name of a material"});
  CHECK(folder.names() == std::vector<std::string>{"bad.scene"});

  const auto good =
      folder.write("good.scene",
                   "model spheres at 3 0 1\nmodel spheres,seed=2 turn z 1 crop\nmaterial m\nball m at 20 "
                   "20 20 radius 9\ncamera eye 0 -60 60 target 30 30 30 fov 50\n");
  const auto render = [&](const char* name) {
    return tests::Words{"render", good, "-o", folder.path(name), "--size", "40x30", "--quiet"};
  };
  tests::check_refused(render("a.ppm") + tests::Words{"--memory", "2K"}, 1, {"--memory"});
  tests::check_done(render("a.ppm") + tests::Words{"--memory", "300K"});
  tests::check_done(render("b.ppm"));
  CHECK(tests::read_text(folder.path("a.ppm")) == tests::read_text(folder.path("b.ppm")));
}
