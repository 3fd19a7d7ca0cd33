// --effects and --bounces of `thimble render`: which effects are drawn, what they take, what they refuse.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "scene/built_scene.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "support/check_command.h"
#include "support/json.h"
#include "thimble/light/render.h"
#include "thimble/picture/camera.h"

namespace {

using namespace thimble::tests;

// A little of everything but water.
constexpr const char* kScene = R"(depth 5
camera eye -20 -26 34 target 16 16 6 fov 45
sun toward -5 -9 16
lamp at 26 6 14 color 255 220 180 reach 12
occlusion rays 4
sky zenith 70 120 190
fog color 200 205 210 density 0.01
material floor color 170 150 130
material clear glass color 220 240 235
material mirror metal color 230 230 230 mirror 0.9
material glow emit color 255 210 150 emission 1.5
material mist media color 200 210 220 density 0.05
box floor from 0 0 0 to 32 32 2
box clear from 4 4 2 to 12 12 10
box mirror from 18 20 2 to 28 24 16
box mist from 14 4 2 to 20 12 9
ball glow at 26 26 5 radius 3
)";

struct Picture {
  std::string bytes;
  Json stats;
};

Picture render(const std::string& scene, const Words& more, const std::string& ending = ".ppm",
               const std::string& size = "48x36") {
  const TemporaryFolder folder;
  Words words = Words{"render", scene, "--size", size, "--quiet", "-o", folder.path("a" + ending)} +
                Words{"--stats", folder.path("a.json")} + more;
  // What the scene calls for and no more: the core's own picture, not the default one.
  const auto is_how = [](const std::string& word) { return word == "--effects" || word == "--shade"; };
  if (std::none_of(more.begin(), more.end(), is_how)) {
    words.insert(words.end(), {"--effects", "auto"});
  }
  check_done(words);
  return {read_text(folder.path("a" + ending)), read_json(folder.path("a.json"))};
}

void check_lit_refused(const std::string& scene, const Words& more, int status, const Words& named) {
  const TemporaryFolder folder;
  check_refused(Words{"render", scene, "--size", "48x36", "-o", folder.path("a.ppm")} + more, status, named);
  CHECK(folder.names().empty());
}

// The pixels that the core gives for a scene with a camera of its own, without the command's help.
struct Direct {
  std::string pixels;
  thimble::LitCounts counts;
};
Direct draw_directly(const std::string& scene, thimble::PixelFormat format) {
  namespace tools = thimble::tools;
  tools::SceneArguments arguments;
  arguments.scene = scene;
  const auto source = tools::open_scene(arguments);
  const tools::BuiltScene built(*source, {});
  tools::LitDescription lit = source->lighting();
  lit.find_glow(built.compact());
  const thimble::EffectSet effects = tools::called_for(lit, tools::used_materials(built.compact()));
  thimble::Camera camera;
  REQUIRE(thimble::set_camera(*source->camera(), 48, 36, built.level(), &camera) == thimble::Status::kOk);
  thimble::Shading shading;
  shading.palette = {built.palette().data(), built.palette().size()};
  Direct direct;
  direct.pixels.resize(thimble::band_bytes(format, 48, 36));
  thimble::Band band;
  band.pixels = {reinterpret_cast<std::uint8_t*>(direct.pixels.data()), direct.pixels.size()};
  band.format = format;
  band.rows = 36;
  REQUIRE(thimble::render_lit_band(effects, built.compact(), camera, shading, lit.drawn(effects), band,
                                   &direct.counts) == thimble::Status::kOk);
  return direct;
}

TEST_CASE("render effects: any number of threads -> the same picture and rays, dithered and sampled too") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kScene);
  for (const Words& more : {Words{}, {"--samples", "4"}, {"--memory", "64K"}, {"--effects", "all"}}) {
    // Slopes are kept by each thread: in a picture so large that every one has some.
    const std::string size = more == Words{"--effects", "all"} ? "160x121" : "50x37";
    for (const char* ending : {".ppm", ".pbm"}) {
      const Picture one = render(scene, more + Words{"--threads", "1"}, ending, size);
      CHECK(one.stats["threads"] == 1);
      for (const char* threads : {"2", "5"}) {
        CAPTURE(threads);
        const Picture many = render(scene, more + Words{"--threads", threads}, ending, size);
        CHECK(many.bytes == one.bytes);
        CHECK(many.stats["rays_by_kind"] == one.stats["rays_by_kind"]);
        // Rays that happen to go together share steps.
        for (const auto& [kind, visits] : one.stats["node_visits_by_kind"].items()) {
          CHECK(many.stats["node_visits_by_kind"][kind].get<double>() ==
                doctest::Approx(visits.get<double>()).epsilon(0.2));
        }
        CHECK(many.stats["threads"] == std::stoi(threads));
      }
    }
  }
}

TEST_CASE("render effects: a plain scene -> the very picture of --effects none, and none in --stats") {
  const Words one{"--threads", "1"};  // threads that hand one another rows visit nodes twice
  const Picture plain = render("spheres", one);
  CHECK(plain.stats["effects"] == Json::array());
  CHECK(!plain.stats.contains("rays_by_kind"));
  for (const Words& more : {Words{"--effects", "none"}, {"--effects", "auto"}, {"--shade", "color"}}) {
    const Picture same = render("spheres", more + one);
    CHECK(same.bytes == plain.bytes);
    CHECK(same.stats["high_water_bytes"] == plain.stats["high_water_bytes"]);
    CHECK(same.stats["engine"] == plain.stats["engine"]);
    CHECK(same.stats["node_visits"] == plain.stats["node_visits"]);
  }
}

TEST_CASE("render effects: auto -> what the scene calls for; none or a --shade -> a picture without") {
  const Picture lit = render("water", {});
  CHECK(lit.stats["effects"] == Json({"direct-light", "shadows", "mirror", "glass", "water", "sky"}));
  CHECK(lit.stats["engine"] == "lit");
  CHECK(lit.stats["bounces"] == 4);
  CHECK(lit.stats["rays_by_kind"]["primary"] == 48 * 36);
  CHECK(lit.stats["rays_by_kind"]["occlusion"] == 0);
  CHECK(lit.stats["rays_by_kind"]["water"] > 0);
  std::uint64_t rays = 0;
  for (const auto& [kind, number] : lit.stats["rays_by_kind"].items()) {
    rays += number.get<std::uint64_t>();
  }
  CHECK(lit.stats["rays"] == rays);
  CHECK(render("water", {"--effects", "auto"}).bytes == lit.bytes);
  CHECK(render("water", {"--effects", "auto", "--shade", "color"}).bytes == lit.bytes);

  const Picture none = render("water", {"--effects", "none"});
  CHECK(none.bytes != lit.bytes);
  const Picture depth = render("water", {"--shade", "depth"});
  CHECK(render("water", {"--shade", "depth", "--effects", "auto"}).bytes == depth.bytes);
  CHECK(render("water", {"--shade", "color"}).bytes == none.bytes);
  const Picture color = render("water", {"--shade", "color"});
  CHECK(color.stats["effects"] == Json::array());
  CHECK(color.bytes == render("water", {"--shade", "color", "--effects", "none"}).bytes);
}

TEST_CASE("render effects: a list -> these and no others; --bounces -> no more rays than that") {
  const Picture two = render("spheres", {"--effects", "shadows,sky"});
  CHECK(two.stats["effects"] == Json({"direct-light", "shadows", "sky"}));
  CHECK(two.stats["rays_by_kind"]["shadow"] > 0);
  CHECK(two.stats["rays_by_kind"]["occlusion"] == 0);
  const Picture darker = render("spheres", {"--effects", "shadows,sky,ambient-occlusion"});
  CHECK(darker.stats["rays_by_kind"]["occlusion"] > 0);
  CHECK(darker.bytes != two.bytes);

  CHECK(render("spheres", {"--effects", "shadows,sky,ao"}).bytes == darker.bytes);
  const Picture all = render("water", {"--effects", "all"});
  CHECK(all.stats["effects"] == Json({"direct-light", "shadows", "ambient-occlusion", "emission", "mirror",
                                      "glass", "water", "sky", "smooth-normals", "emitter-light"}));
  CHECK(render("spheres", {"--effects", "all", "--normals", "face"}).stats["effects"] ==
        Json({"direct-light", "shadows", "ambient-occlusion", "emission", "emitter-light"}));

  std::uint64_t before = 0;
  for (const char* bounces : {"0", "1", "2", "8"}) {
    const Picture water = render("water", {"--bounces", bounces});
    CHECK(std::to_string(water.stats["bounces"].get<int>()) == bounces);
    const std::uint64_t rays = water.stats["rays"];
    CHECK(rays > before);
    before = rays;
  }
  // No mirror without a bounce; glass and water let rays go straight on.
  CHECK(render("water", {"--bounces", "0"}).stats["rays_by_kind"]["mirror"] == 0);
}

TEST_CASE("render effects: every format -> the pixels that the core gives; greys below a byte are dithered") {
  const TemporaryFolder folder;
  for (const std::string& scene : {std::string("water"), folder.write("a.scene", kScene)}) {
    CAPTURE(scene);
    const Direct color = draw_directly(scene, thimble::PixelFormat::kRgb888);
    CHECK(render(scene, {}).bytes == "P6\n48 36\n255\n" + color.pixels);
    const Picture ppm = render(scene, {"--engine", "ray64"});  // the visits are those of what traces
    CHECK(ppm.bytes == "P6\n48 36\n255\n" + color.pixels);
    CHECK(render(scene, {}, ".pgm").bytes ==
          "P5\n48 36\n255\n" + draw_directly(scene, thimble::PixelFormat::kGray8).pixels);
    std::string mono = draw_directly(scene, thimble::PixelFormat::kMono1).pixels;
    for (char& eight : mono) {
      eight = static_cast<char>(~eight);  // 1 is black in a .pbm
    }
    CHECK(render(scene, {}, ".pbm").bytes == "P4\n48 36\n" + mono);
    for (int kind = 0; kind < thimble::kLitRayKinds; ++kind) {
      const char* name = thimble::tools::ray_kind_name(static_cast<thimble::LitRayKind>(kind));
      CHECK(ppm.stats["rays_by_kind"][name] == color.counts.rays[kind]);
      CHECK(ppm.stats["node_visits_by_kind"][name] == color.counts.node_visits[kind]);
    }
  }
}

TEST_CASE("render effects: a short budget -> the same picture in bands of fewer rows, or a sentence") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.scene", kScene);
  const Picture drawn = render(scene, {"--engine", "ray64", "--threads", "1"});  // as within a budget
  // The least budget, by halving.
  const auto fits = [&](int bytes) {
    return run_command({"render", scene, "--size", "48x36", "--quiet", "-o", folder.path("b.ppm"),
                        "--effects", "auto", "--memory", std::to_string(bytes)})
               .status == 0;
  };
  int low = 0;
  int high = drawn.stats["high_water_bytes"];
  REQUIRE(fits(high));
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (fits(middle) ? high : low) = middle;
  }
  const Picture least = render(scene, {"--memory", std::to_string(high)});
  CHECK(least.bytes == drawn.bytes);
  CHECK(least.stats["high_water_bytes"] <= high);
  CHECK(high < drawn.stats["high_water_bytes"]);
  check_lit_refused(scene, {"--effects", "auto", "--memory", std::to_string(low)}, 1,
                    {std::to_string(high % 1000), "--memory"});
}

TEST_CASE("render effects: what makes no sense, or cannot be honoured -> status 2, a sentence, no file") {
  for (const char* wrong :
       {"", "shadow", "auto,sky", "sky,", "sky,sky", "Shadows", "none,sky", "all,sky", "ao,ao"}) {
    check_lit_refused("spheres", {"--effects", wrong}, 2,
                      {std::string("--effects: \"") + wrong + "\"", "auto, none", "ambient-occlusion"});
  }
  check_lit_refused("spheres", {"--effects", "sky,shadow"}, 2, {"(did you mean shadows?)"});
  for (const char* wrong : {"-1", "9", "x", "", "1.5"}) {
    check_lit_refused("spheres", {"--bounces", wrong}, 2, {"--bounces", "0 to 8"});
  }
  for (const Words& more : {Words{"--samples", "4"},
                            {"--samples", "auto"},
                            {"--cutoff", "2"},
                            {"--max-depth", "3"},
                            {"--effects", "sky"},
                            {"--bounces", "2"}}) {
    check_lit_refused("spheres", Words{"--engine", "wide"} + more, 2, {"--engine wide", more[0]});
  }
  for (const Words& more : {Words{"--structure", "pool"},
                            {"--structure", "dense"},
                            {"--engine", "ray32"},
                            {"--engine", "wide"},
                            {"--cutoff", "2"},
                            {"--max-depth", "3"}}) {
    check_lit_refused("water", more, 2, {more[0], "water", "--effects none"});
    render("water", more + Words{"--effects", "none"});
  }
  for (const char* shade : {"depth", "normal", "mono"}) {
    check_lit_refused("water", {"--shade", shade, "--effects", "sky"}, 2, {std::string("--shade ") + shade});
  }
}

}  // namespace
