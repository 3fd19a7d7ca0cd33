// `thimble render` without a word on how: the scene's own look, backgrounds, films.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/check_command.h"
#include "support/json.h"
#include "support/pictures.h"
#include "thimble/picture/pixel.h"

namespace {

using namespace thimble::tests;

// Coloured boxes on legs, so that there is something to cast a shadow.
constexpr const char* kLookScene = R"(depth 5
material wall color 200 60 40
material roof color 60 90 200
box wall from 8 8 6 to 24 20 18
box roof from 6 6 18 to 26 22 22
box wall from 8 8 2 to 10 10 6
box wall from 22 18 2 to 24 20 6
)";

std::uint8_t byte_at(const std::string& text, std::size_t at) {
  REQUIRE(at < text.size());
  return static_cast<std::uint8_t>(text[at]);
}

struct Drawn {
  std::string pixels;
  Json stats;
  std::string err;
};

Drawn draw(const std::string& scene, const Words& more, const std::string& size = "80x60") {
  const TemporaryFolder folder;
  const CommandResult result = check_done(
      Words{"render", scene, "--size", size, "-o", folder.path("a.ppm"), "--stats", folder.path("a.json")} +
      more);
  const std::string file = read_text(folder.path("a.ppm"));
  return {file.substr(file.find("255\n") + 4), read_json(folder.path("a.json")), result.err};
}

void check_look_refused(const std::string& scene, const Words& more, const std::string& named,
                        const std::string& output = "a.png") {
  const TemporaryFolder folder;
  check_refused(Words{"render", scene, "--size", "16x12", "-o", folder.path(output)} + more, 2, {named});
  CHECK(folder.names().empty());
}

}  // namespace

TEST_CASE("render look: a scene with colours and nothing said -> light, shadows, a backdrop, four samples") {
  const TemporaryFolder folder;
  const Drawn drawn = draw(folder.write("a.scene", kLookScene), {"--verbose"});
  CHECK(drawn.stats["engine"] == "lit");
  CHECK(drawn.stats["effects"] == Json({"direct-light", "shadows", "ambient-occlusion"}));
  CHECK(drawn.stats["samples"] == 4);
  CHECK(drawn.stats["rays"].get<std::uint64_t>() >= 4 * 80 * 60);
  CHECK(drawn.err.find("look: its colours, a sun over the viewer's shoulder") != std::string::npos);
  // The corners show the backdrop, lighter below.
  const std::size_t last = 3 * (80 * 60 - 1);
  CHECK(byte_at(drawn.pixels, 0) > 100);
  CHECK(byte_at(drawn.pixels, last) > byte_at(drawn.pixels, 0));
  std::set<std::string> colors;
  for (std::size_t i = 0; i < drawn.pixels.size(); i += 3) {
    colors.insert(drawn.pixels.substr(i, 3));
  }
  CHECK(colors.size() > 200);
}

TEST_CASE(
    "render look: the rays of a small picture -> within some per cent those of the whole; too many -> one "
    "sample") {
  const auto measured = [](const Drawn& drawn) {
    const std::size_t after = drawn.err.find(" a pixel (") + 10;
    std::string digits = drawn.err.substr(after, drawn.err.find(" rays for four", after) - after);
    digits.erase(std::remove(digits.begin(), digits.end(), ','), digits.end());
    return std::stod(digits);
  };
  for (const char* const scene : {"castle", "glass", "water"}) {
    CAPTURE(scene);
    const Drawn drawn = draw(scene, {"--verbose"}, "200x150");
    CHECK(measured(drawn) == doctest::Approx(drawn.stats["rays"].get<double>()).epsilon(0.05));
    CHECK(drawn.stats["samples"] == 4);
    // Of a large picture one row will do; the samples are the whole picture's.
    const TemporaryFolder folder;
    const std::vector<std::string> words{"render",
                                         scene,
                                         "--rows",
                                         "0:1",
                                         "--verbose",
                                         "-o",
                                         folder.path("a.part"),
                                         "--stats",
                                         folder.path("a.json")};
    CHECK(check_done(Words(words) + Words{"--size", "4000x3000"}).err.find(" 1 sample a pixel") !=
          std::string::npos);
    CHECK(read_json(folder.path("a.json"))["samples"] == 1);
  }
}

TEST_CASE("render look: any number of threads, any budget that fits -> the same pixels") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kLookScene);
  for (const std::string& one : {scene, std::string("points:3000,depth=7")}) {
    const Drawn first = draw(one, {"--quiet"});
    for (const char* const threads : {"2", "3", "5"}) {
      CHECK(draw(one, {"--quiet", "--threads", threads}).pixels == first.pixels);
    }
    for (const char* const memory : {"48K", "64K", "200K"}) {
      const Drawn tight = draw(one, {"--quiet", "--memory", memory});
      CHECK(tight.pixels == first.pixels);
      CHECK(tight.stats["high_water_bytes"] <= tight.stats["budget_bytes"]);
    }
  }
}

TEST_CASE("render look: strewn points -> stars on black, brighter where there are more") {
  const Drawn drawn = draw("cluster:5000,depth=8", {"--verbose"});
  CHECK(drawn.stats["engine"] == "stars");
  CHECK(drawn.err.find("look: stars") != std::string::npos);
  std::uint64_t dark = 0;
  std::uint64_t bright = 0;
  for (std::size_t i = 0; i < drawn.pixels.size(); i += 3) {
    dark += byte_at(drawn.pixels, i) < 20 ? 1U : 0U;
    bright += byte_at(drawn.pixels, i) > 180 ? 1U : 0U;
  }
  CHECK(dark > 80 * 60 / 4);
  CHECK(bright > 20);
}

TEST_CASE("render look: strewn points as dark as the night -> stars that can be seen all the same") {
  const TemporaryFolder folder;
  std::string points =
      "ply\nformat ascii 1.0\nelement vertex 64\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < 64; ++i) {
    points +=
        std::to_string(i % 4) + " " + std::to_string(i / 4 % 4) + " " + std::to_string(i / 16) + " 0 0 0\n";
  }
  const Drawn drawn = draw(folder.write("black.ply", points), {"--quiet"});
  CHECK(drawn.stats["engine"] == "stars");
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < drawn.pixels.size(); i += 3) {
    seen += byte_at(drawn.pixels, i) > 40 ? 1U : 0U;
  }
  CHECK(seen > 64);
}

TEST_CASE("render look: one colour that a text says -> is drawn in it, baked too; none -> clay") {
  const TemporaryFolder folder;
  const auto middle = [](const std::string& scene) {
    const Drawn drawn = draw(scene, {"--quiet"});
    const std::size_t at = 3 * (80 * 30 + 40);
    return std::array{byte_at(drawn.pixels, at), byte_at(drawn.pixels, at + 1),
                      byte_at(drawn.pixels, at + 2)};
  };
  const std::string red =
      folder.write("red.scene", "material a color 220 20 20\nbox a from 0 0 0 to 8 8 8\n");
  const auto lit = middle(red);
  CHECK(lit[0] > 3 * lit[1]);
  check_done({"bake", red, "-o", folder.path("red.oct"), "--quiet"});
  const auto baked = middle(folder.path("red.oct"));
  CHECK(baked[0] > 3 * baked[1]);
  folder.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\nf 1 3 4\nf 1 2 4\nf 2 3 4\n");
  const auto clay = middle(folder.write("clay.scene", "model cube.obj depth 4\n"));
  CHECK(clay[0] < 2 * clay[1]);
  CHECK(clay[0] > clay[2]);
  const auto replaced = middle(
      folder.write("replaced.scene", "material a color 220 20 20\nmodel cube.obj depth 4 replace all a\n"));
  CHECK(replaced[0] > 3 * replaced[1]);
}

TEST_CASE(
    "render look: heights, balls of glass and of polished metal -> slopes, baked too; voxels, panes and "
    "rough balls "
    "-> their faces") {
  const TemporaryFolder folder;
  const std::string land = folder.write(
      "land.asc", "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 1 2\n1 2 4\n2 4 9\n");
  check_done({"bake", land, "-o", folder.path("land.oct"), "--quiet"});
  const auto with = [&folder](const std::string& name, const std::string& material, const std::string& body) {
    return folder.write(name + ".scene",
                        kLookScene + ("material clear " + material + "\n" + body + "\nsun toward 1 1 1\n"));
  };
  std::vector<std::pair<std::string, bool>> scenes{
      {land, true}, {folder.path("land.oct"), true}, {folder.write("a.scene", kLookScene), false}};
  for (const std::string radius : {"3", "5", "7", "9"}) {
    scenes.emplace_back(with("ball" + radius, "glass", "ball clear at 16 16 16 radius " + radius), true);
  }
  const std::string ball = "ball clear at 16 16 16 radius 6";
  check_done({"bake", scenes.back().first, "-o", folder.path("ball.oct"), "--quiet"});
  scenes.emplace_back(folder.path("ball.oct"), true);
  scenes.emplace_back(with("gold", "metal mirror 0.9 roughness 0", ball), true);
  scenes.emplace_back(with("rough", "metal mirror 0.9 roughness 0.2", ball), false);
  scenes.emplace_back(with("off", "glass", ball + "\neffects off smooth-normals"), false);
  scenes.emplace_back(with("diffuse", "color 9 9 9", ball), false);
  scenes.emplace_back(with("pane", "glass", "box clear from 3 3 3 to 4 29 28"), false);
  scenes.emplace_back(with("block", "glass", "box clear from 3 3 3 to 15 11 28"), false);
  for (const auto& [each_scene, is_smooth] : scenes) {
    const auto& scene = each_scene;
    CAPTURE(scene);
    const auto drawn =
        run_command({"render", scene, "--size", "40x30", "--verbose", "-o", folder.path("a.png")});
    REQUIRE(drawn.status == 0);
    CHECK((drawn.err.find("smooth-normals") != std::string::npos) == is_smooth);
  }
}

TEST_CASE("render look: nothing in the scene -> the backdrop, and no crash") {
  CHECK(draw("points:0,depth=4", {"--quiet"}).stats["hits"] == 0);
  CHECK(draw("points:1,depth=12", {"--quiet"}).pixels.size() == 3 * 80 * 60);
}

TEST_CASE(
    "render look: --background -> a colour behind; none -> an alpha that is 0 there and 255 on the model") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kLookScene);
  const Drawn red = draw(scene, {"--quiet", "--background", "ff2010", "--ground", "off"});
  CHECK(red.pixels.substr(0, 3) == std::string("\xff\x20\x10"));
  const Drawn shadow = draw(scene, {"--quiet", "--background", "ff2010", "--ground", "on"});
  CHECK(shadow.pixels != red.pixels);
  check_done(
      {"render", scene, "--size", "80x60", "--background", "none", "--quiet", "-o", folder.path("a.png")});
  const std::string png = read_text(folder.path("a.png"));
  CHECK(byte_at(png, 25) == 6);  // colour type: r, g, b and alpha
  check_look_refused(scene, {"--background", "none"}, "png", "a.ppm");
  check_look_refused(scene, {"--background", "blue"}, "\"blue\"");
  check_look_refused(scene, {"--background", "ff2010", "--shade", "color"}, "--background");
  check_look_refused(scene, {"--ground", "on", "--engine", "ray64"}, "--ground");
  check_look_refused(scene, {"--ground", "wet"}, "\"wet\"");
}

TEST_CASE("render look: --view, --turn and --tilt -> other pictures, and the same by another name") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kLookScene);
  const auto pixels = [&](const Words& words) {
    return draw(scene, Words{"--quiet"} + words, "40x30").pixels;
  };
  CHECK(pixels({"--view", "best"}) == pixels({}));
  CHECK(pixels({"--view", "front"}) != pixels({}));
  CHECK(pixels({"--view", "front", "--turn", "90"}) == pixels({"--view", "right"}));
  CHECK(pixels({"--view", "front", "--turn", "-90"}) == pixels({"--view", "left"}));
  CHECK(pixels({"--view", "front", "--tilt", "90"}) == pixels({"--view", "top"}));
  check_look_refused(scene, {"--view", "below"}, "\"below\"");
  check_look_refused(scene, {"--turn", "nan"}, "\"nan\"");
  check_look_refused(scene, {"--tilt", "181"}, "-180 to 180");
  check_look_refused(scene, {"--view", "front", "--eye", "1,2,3"}, "--eye");
}

TEST_CASE("render look: --turntable -> a GIF of so many frames that decode, each near its own picture") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kLookScene);
  const std::string path = folder.path("a.gif");
  check_done({"render", scene, "--size", "90x70", "--turntable", "7", "-o", path, "--quiet"});
  const ReadPicture gif = read_gif(read_text(path));
  CHECK(gif.width == 90);
  CHECK(gif.height == 70);
  REQUIRE(gif.frames.size() == 7);
  CHECK(gif.delays_ms == std::vector<int>(7, 850));
  for (std::size_t i = 1; i < 7; ++i) {
    CHECK(gif.frames[i] != gif.frames[i - 1]);
  }
  // The same frames without a palette: near, and pixels of one colour, dithered, are one colour of the palette.
  check_done({"render", scene, "--size", "90x70", "--turntable", "7", "-o", folder.path("a.y4m"), "--quiet"});
  CHECK(read_text(folder.path("a.y4m")).find(" F7:6 ") != std::string::npos);
  check_done(
      {"render", scene, "--size", "90x70", "--turntable", "7", "-o", folder.path("%d.png"), "--quiet"});
  std::map<std::array<int, 3>, std::string> shown;
  for (std::size_t frame = 0; frame < 7; ++frame) {
    const ReadPicture png = read_png(read_text(folder.path(std::to_string(frame) + ".png")));
    const auto channels = static_cast<std::size_t>(png.channels);
    std::size_t torn = 0;
    int farthest = 0;
    for (std::size_t i = 0; i < 90U * 70; ++i) {
      const std::string rgb = gif.frames[frame].substr(3 * i, 3);
      const int nudge = static_cast<int>(thimble::bayer_rank(static_cast<std::int32_t>(i % 90),
                                                             static_cast<std::int32_t>(i / 90))) /
                            8 -
                        4;
      std::array<int, 3> bin{};
      for (std::size_t c = 0; c < 3; ++c) {
        const int value = byte_at(png.frames[0], channels * i + c);
        bin[c] = std::clamp(value + nudge, 0, 255) / 8;
        farthest = std::max(farthest, std::abs(value - byte_at(rgb, c)));
      }
      torn += shown.emplace(bin, rgb).first->second == rgb ? 0U : 1U;
    }
    CHECK(torn == 0);
    CHECK(farthest < 32);
  }
}

TEST_CASE("render look: films and pictures asked for wrongly -> status 2, and no file") {
  check_look_refused("spheres", {"--turntable", "5"}, ".gif");
  check_look_refused("spheres", {}, "--turntable", "a.gif");
  check_look_refused("spheres", {"--turntable", "1"}, "2 to 1000", "a.gif");
  check_look_refused("spheres", {"--turntable", "5", "--shade", "depth"}, "--shade", "a.gif");
  check_look_refused("spheres", {"--turntable", "5", "--eye", "1,2,3"}, "--eye", "a.y4m");
  check_look_refused("spheres", {"--turntable", "5", "--background", "none"}, "png", "a.gif");
}
