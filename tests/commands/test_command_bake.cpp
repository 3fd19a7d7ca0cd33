// `thimble bake`, and baked scenes wherever a scene is taken: the same pictures, limits to the byte, headers
// that compile, and bad input.
#include <doctest/doctest.h>
#include <zlib.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "output/units.h"
#include "scene/board_fit.h"
#include "support/baked_damage.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/file_bytes.h"
#include "support/json.h"
#include "thimble/bake/baked_scene.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

std::string render(const TemporaryFolder& folder, const std::string& scene, const Words& options,
                   const std::string& name = "picture.ppm") {
  check_done(Words{"render", scene, "-o", folder.path(name), "--quiet"} + options);
  return read_text(folder.path(name));
}

BakedScene open_text(const std::string& text) {
  BakedScene scene;
  const ConstBytes bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  REQUIRE(BakedScene::validate(bytes) == nullptr);
  REQUIRE(BakedScene::open(bytes, &scene) == Status::kOk);
  return scene;
}

// A .vox of a few voxels of three colours.
std::string small_vox() {
  std::vector<std::array<int, 4>> voxels;
  for (int i = 0; i < 300; ++i) {
    voxels.push_back({i * 7 % 20, i * 3 % 18, i % 17, 1 + i % 3});
  }
  return vox_file(vox_model({20, 18, 17}, voxels));
}

// What a picture of netpbm holds behind its header.
std::string pixels_of(const std::string& picture, int header_lines = 3) {
  std::size_t at = 0;
  for (int i = 0; i < header_lines; ++i) {
    at = picture.find('\n', at) + 1;
  }
  return picture.substr(at);
}

}  // namespace

TEST_CASE("bake: with any camera -> the baked scene renders to the same pixels as the scene itself") {
  const TemporaryFolder folder;
  const std::string vox = folder.write("small.vox", small_vox());
  const std::string points = folder.write("p.xyz", "0 0 0 255 0 0\n1 2 3 0 255 0\n4 1 9 0 0 255\n");
  const std::string oct = folder.path("s.oct");
  const std::vector<Words> cameras{
      {},
      {"--fov", "33.3"},
      {"--projection", "orthographic"},
      {"--projection", "orthographic", "--span", "40.7", "--up", "0.3,1,0.2"},
      {"--eye", "-11.37,-20.111,31.7", "--target", "10.1,9.9,8.3"},
      {"--eye", "10.0001,10,10", "--target", "10,10.0001,9.9999", "--up", "1,2,3", "--fov", "100"},
      {"--target", "5,5,5", "--direction-bits", "14"},
      {"--eye", "10,10,60", "--target", "10,10,1e9"}};
  std::size_t number = 0;
  for (const std::string& scene : {std::string("spheres,depth=5"), vox, points}) {
    for (const Words& camera : cameras) {
      if (++number % 3 != 0 && thimble::tests::takes_few()) {
        continue;
      }
      CAPTURE(scene);
      CAPTURE(camera.size());
      check_done(Words{"bake", scene, "-o", oct, "--size", "80x60", "--quiet"} + camera);
      const Words picture{"--size", "80x60", "--shade", "color"};
      const std::string expected = render(folder, scene, picture + camera);
      CHECK(render(folder, oct, picture) == expected);
      // The same camera said once more.
      CHECK(render(folder, oct, picture + camera) == expected);
    }
    const Words depth{"--size", "80x60", "--shade", "depth"};
    check_done({"bake", scene, "-o", oct, "--quiet"});
    CHECK(render(folder, oct, depth) == render(folder, scene, depth));
    for (const char* structure : {"dense", "pool"}) {
      const Words other{"--size", "80x60", "--structure", structure, "--shade", "color"};
      CHECK(render(folder, oct, other) == render(folder, scene, other));
    }
  }
}

TEST_CASE(
    "bake: a mesh -> slopes by itself; one picture of the mesh, its baked scene and one baked from that") {
  const TemporaryFolder folder;
  const std::string mesh =
      folder.write("octahedron.off",
                   "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n"
                   "3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n");
  const std::string oct = folder.path("m.oct");
  const Words effects{"--effects", "direct-light,shadows,smooth-normals"};
  const Words picture{"--size", "80x60", "--shade", "color"};
  check_done(Words{"bake", mesh, "--depth", "5", "--size", "80x60", "-o", oct, "--quiet"} + effects);
  const std::string expected = render(folder, mesh, Words{"--depth", "5"} + picture + effects);
  CHECK(render(folder, oct, picture + Words{"--effects", "auto"}) == expected);
  CHECK(render(folder, mesh, Words{"--depth", "5"} + picture + Words{"--effects", "direct-light,shadows"}) !=
        expected);
  // Nobody said a word.
  check_done({"bake", mesh, "--depth", "5", "-o", oct, "--quiet"});
  const CommandResult said = run_command({"info", oct});
  CHECK(said.out.find("smooth-normals") != std::string::npos);
}

TEST_CASE(
    "bake: without a word -> the baked scene's picture without a word is that of its file, byte for byte") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  const Words small{"--size", thimble::tests::takes_few() ? "40x30" : "80x60"};
  std::string strewn;
  for (int i = 0; i < 300; ++i) {
    strewn += std::to_string(i * 37 % 101) + " " + std::to_string(i * 53 % 97) + " " +
              std::to_string(i * 29 % 89) + "\n";
  }
  const std::vector<std::string> scenes{
      folder.write("s.vox", small_vox()),  // colours
      folder.write("s.obj", "v 0 0 0\nv 9 0 0\nv 0 9 3\nv 4 4 9\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n"),
      folder.write("s.xyz", strewn),  // stars
      folder.write("glass.scene",
                   "depth 5\nmaterial clear glass color 215 240 232 index 1.5\nmaterial red color 200 40 30\n"
                   "material gold metal color 230 190 80\nmaterial glow emit color 250 220 90 emission 2\n"
                   "box red from 2 2 0 to 30 30 3\nball clear at 10 16 10 radius 6\n"
                   "ball gold at 22 12 8 radius 5\nbox glow from 20 22 3 to 24 26 6\n"),
      folder.write("lamp.scene",
                   "depth 5\nlamp at 4 4 28\nmaterial red color 200 40 30\nbox red from 2 2 0 to 30 30 9\n"),
      folder.write("off.scene",
                   "depth 5\neffects off ambient-occlusion shadows\nmaterial red color 200 40 30\n"
                   "box red from 2 2 0 to 30 30 9\nbox red from 9 9 9 to 14 14 20\n")};
  for (const std::string& scene : scenes) {
    CAPTURE(scene);
    check_done({"bake", scene, "--depth", "5", "-o", oct, "--quiet"});
    const std::string own = render(folder, scene, Words{"--depth", "5"} + small);
    CHECK(render(folder, oct, small, "baked.ppm") == own);
    CHECK(render(folder, oct, Words{"--view", "left", "--ground", "off"} + small) ==
          render(folder, scene, Words{"--view", "left", "--ground", "off", "--depth", "5"} + small));
    check_done({"bake", oct, "-o", folder.path("again.oct"), "--quiet"});
    CHECK(render(folder, folder.path("again.oct"), small) == own);
  }
  // What is named is what is drawn; so is what suits a display.
  const auto looks = [&](const Words& options) {
    check_done(Words{"bake", scenes[0], "-o", oct, "--quiet"} + options);
    return open_text(read_text(oct)).section(SectionKind::kLook).size;
  };
  CHECK(looks({}) == 12);
  CHECK(looks({"--effects", "auto"}) == 0);
  CHECK(looks({"--board", "raspi0"}) == 0);
  // A note of another version or size says nothing: then the scene is lit as it was baked.
  CHECK(looks({}) == 12);
  std::string bytes = read_text(oct);
  const std::size_t at = static_cast<std::size_t>(open_text(bytes).section(SectionKind::kLook).data -
                                                  reinterpret_cast<const std::uint8_t*>(bytes.data()));
  const std::string own = render(folder, oct, small);
  bytes[at] = 2;
  repair_baked_checksums({reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()});
  CHECK(render(folder, folder.write("other.oct", bytes), small) != own);
}

TEST_CASE("bake: a baked scene under gzip, with another ending or baked again -> read all the same") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres,depth=5", "-o", oct, "--quiet"});
  const std::string bytes = read_text(oct);
  const Words size{"--size", "40x30"};
  const std::string expected = render(folder, oct, size);
  CHECK(render(folder, folder.write("s.oct.gz", deflated(bytes, kGzip)), size) == expected);
  CHECK(render(folder, folder.write("s.bin", bytes), size) == expected);
  check_done({"bake", oct, "-o", folder.path("again.oct"), "--quiet"});
  CHECK(render(folder, folder.path("again.oct"), size) == expected);
  CHECK(check_done({"bake", "spheres,depth=5", "-o", "-"}).out == bytes);
}

TEST_CASE("bake: --memory -> fits at N, at N - 1 refused by one byte, with the depth that does fit") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  const std::string stats = folder.path("s.json");
  const CommandResult result = check_done({"bake", "spheres", "-o", oct, "--stats", stats});
  CHECK(result.err.find("28,327 voxels in 12,624 bytes (depth 6, 0.45 bytes a voxel)") != std::string::npos);
  const auto size = std::filesystem::file_size(oct);
  CHECK(size == 12624);
  const auto json = read_json(stats);
  CHECK(json["baked_bytes"] == size);
  CHECK(json["budget_bytes"] == size);
  CHECK(json["voxels"] == 28327);
  CHECK(json["solid_added"] == 0);
  const std::string text = read_text(oct);
  const BakedScene scene = open_text(text);
  CHECK(json["tree_bytes"] == scene.tree().size_bytes());
  CHECK(json["nodes"] == scene.tree().node_count());
  check_done({"bake", "spheres", "-o", oct, "--memory", std::to_string(size), "--quiet"});
  std::filesystem::remove(oct);
  check_refused({"bake", "spheres", "-o", oct, "--memory", std::to_string(size - 1), "--quiet"}, 1,
                {"takes 12,624 bytes", "limit is 12,623 bytes (--memory)", "1 byte too many",
                 "--depth 5 fits with 2,880 bytes", "--coarsen"});
  check_done({"bake", "spheres", "--depth", "5", "-o", oct, "--memory", "2880", "--quiet"});
  CHECK(std::filesystem::file_size(oct) == 2880);
  std::filesystem::remove(oct);
  check_refused({"bake", "spheres", "-o", oct, "--memory", "2879"}, 1, {"9,745 bytes too many", "--depth 4"});
  check_refused({"bake", "spheres", "-o", oct, "--memory", "0"}, 1, {"12,624 bytes too many", "--coarsen"});
  const std::string vox = folder.write("small.vox", small_vox());
  check_refused({"bake", vox, "-o", oct, "--memory", "300"}, 1, {vox, "one depth only", "--coarsen"});
  CHECK(folder.names() == Words{"s.json", "small.vox"});
}

TEST_CASE("bake: --coarsen -> within the limit and close to it, only solid added, and said so") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  const std::string vox = folder.write("small.vox", small_vox());
  for (const std::string& scene : {std::string("spheres"), std::string("points:5000,depth=7"),
                                   std::string("cluster:3000,depth=9"), vox}) {
    CAPTURE(scene);
    check_done(
        {"bake", scene, "-o", oct, "--quiet", "--effects", "none", "--stats", folder.path("full.json")});
    const auto full = read_json(folder.path("full.json"));
    const std::size_t exact = std::filesystem::file_size(oct);
    for (const std::size_t percent : {100U, 99U, 80U, 50U, 30U}) {
      if (thimble::tests::takes_few() && percent != 99U && percent != 30U) {
        continue;
      }
      const std::size_t limit = exact * percent / 100;
      CAPTURE(percent);
      const CommandResult result =
          check_done({"bake", scene, "-o", oct, "--coarsen", "--effects", "none", "--memory",
                      std::to_string(limit), "--stats", folder.path("s.json")});
      const std::size_t size = std::filesystem::file_size(oct);
      CHECK(size <= limit);
      // One block is merged at a time. The first one also costs a bit a node.
      CHECK(size + limit / 12 + 64 >= limit);
      const auto stats = read_json(folder.path("s.json"));
      CHECK(stats["baked_bytes"] == size);
      CHECK(stats["budget_bytes"] == limit);
      const std::uint64_t added = stats["solid_added"];
      CHECK(stats["voxels"].get<std::uint64_t>() == full["voxels"].get<std::uint64_t>() + added);
      CHECK((added == 0) == (percent == 100));
      CHECK((result.err.find("of solid volume added") != std::string::npos) == (percent != 100));
      // With the same camera nothing that was seen has gone.
      if (percent >= 80) {
        const Words camera{"--eye",  "-40,-70,60", "--target", "30,30,30",
                           "--size", "64x48",      "--shade",  "mono"};
        const std::string before = pixels_of(render(folder, scene, camera, "a.pbm"), 2);
        const std::string after = pixels_of(render(folder, oct, camera, "b.pbm"), 2);
        REQUIRE(before.size() == after.size());
        for (std::size_t i = 0; i < before.size(); ++i) {
          CHECK((static_cast<unsigned char>(after[i]) & ~static_cast<unsigned char>(before[i])) == 0);
        }
      }
    }
  }
  check_refused({"bake", "spheres", "-o", folder.path("no.oct"), "--coarsen", "--memory", "200"}, 1,
                {"even the coarsest tree takes 208 bytes", "8 bytes too many"});
  check_done({"bake", "spheres", "-o", oct, "--coarsen", "--memory", "208", "--quiet"});
  CHECK(open_text(read_text(oct)).tree().node_count() == 1);
}

TEST_CASE(
    "bake: a coarsened scene, baked again or in other structures -> its added volume is not forgotten") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres", "-o", oct, "--coarsen", "--memory", "6000", "--quiet", "--stats",
              folder.path("a.json")});
  const auto added = read_json(folder.path("a.json"))["solid_added"];
  CHECK(added > 0);
  for (const char* structure : {"compact", "pool", "dense"}) {
    check_done({"info", oct, "--structure", structure, "--stats", folder.path("b.json")});
    CHECK(read_json(folder.path("b.json"))["solid_added"] == added);
  }
  // In less memory than its tree takes, --coarsen merges more.
  const auto bytes = read_json(folder.path("b.json"))["tree_bytes"];
  check_done({"info", oct, "--memory", "20000", "--coarsen", "--stats", folder.path("b.json")});
  CHECK(read_json(folder.path("b.json"))["solid_added"] == added);
  check_done({"info", oct, "--memory", "5000", "--coarsen", "--stats", folder.path("b.json")});
  CHECK(read_json(folder.path("b.json"))["solid_added"] > added);
  CHECK(bytes > 0);
}

TEST_CASE("bake: a .h -> compiles as C and C++ without a warning and holds the .oct's bytes") {
  if (std::system("gcc --version >/dev/null 2>&1 && g++ --version >/dev/null 2>&1") != 0) {
    MESSAGE("skipped: no gcc and g++");
    return;
  }
  const TemporaryFolder folder;
  check_done({"bake", "spheres,depth=5", "-o", folder.path("s.oct"), "--quiet"});
  check_done({"bake", "spheres,depth=5", "-o", folder.path("s.h"), "--quiet"});
  check_done({"bake", "spheres,depth=5", "-o", folder.path("other.h"), "--quiet", "--name", "my_Scene2",
              "--projection", "orthographic"});
  // A file's name may hold anything.
  const std::string odd = folder.write("* \\ ?\n\".xyz", "1 2 3\n");
  check_done({"bake", odd, "-o", folder.path("odd.h"), "--quiet", "--name", "odd"});
  const std::string lamps =
      folder.write("lamps.scene",
                   "depth 4\nsun toward -5 -9 16\nlamp at 2 6 14 color 255 220 180 reach 12\n"
                   "lamp at 9 6 14 color 90 220 180 reach 7\nmaterial floor color 170 150 130\n"
                   "box floor from 0 0 0 to 16 16 2\n");
  check_done({"bake", lamps, "-o", folder.path("lamps.h"), "--quiet", "--name", "lit"});
  const std::string source =
      folder.write("main.c",
                   "#include \"s.h\"\n"
                   "#include \"s.h\"\n"
                   "#include \"other.h\"\n"
                   "#include \"odd.h\"\n"
                   "#include \"lamps.h\"\n"
                   "#include <stdio.h>\n"
                   "#if THIMBLE_SCENE_DEPTH != 5 || THIMBLE_SCENE_VERSION != 1 || \\\n"
                   "    THIMBLE_SCENE_VOXELS < 1000 || !THIMBLE_SCENE_HAS_CAMERA || \\\n"
                   "    !THIMBLE_SCENE_IS_PERSPECTIVE || THIMBLE_SCENE_HAS_BRICK_MAP || \\\n"
                   "    THIMBLE_SCENE_CRC32 == 0 || THIMBLE_SCENE_IS_ORTHOGRAPHIC || \\\n"
                   "    MY_SCENE2_IS_PERSPECTIVE || !MY_SCENE2_IS_ORTHOGRAPHIC || \\\n"
                   "    THIMBLE_SCENE_LAMPS != 0 || LIT_LAMPS != 2\n"
                   "#error facts\n"
                   "#endif\n"
                   "int main(void) {\n"
                   "  if (((uintptr_t)thimble_scene | (uintptr_t)my_Scene2) % 8 != 0) return 3;\n"
                   "  if (((uintptr_t)odd | (uintptr_t)lit) % 8 != 0) return 3;\n"
                   "  if (my_Scene2[0] != 0x54 || odd[1] != 0x4D || lit[1] != 0x4D) return 4;\n"
                   "  return fwrite(thimble_scene, 1, THIMBLE_SCENE_BYTES, stdout) != "
                   "sizeof thimble_scene;\n"
                   "}\n");
  for (const char* compiler :
       {"gcc -std=c99 -x c", "gcc -std=c11 -x c", "g++ -std=c++11 -x c++", "g++ -std=c++20 -x c++"}) {
    CAPTURE(compiler);
    const std::string program = folder.path("program");
    const std::string command = std::string(compiler) + " -Wall -Wextra -Wpedantic -Werror -o " + program +
                                " " + source + " && " + program + " > " + folder.path("out.bin");
    REQUIRE(std::system(command.c_str()) == 0);
    CHECK(read_text(folder.path("out.bin")) == read_text(folder.path("s.oct")));
  }
}

TEST_CASE("bake: --board -> its flash is the limit, its display the picture; RAM is reported") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  const platform::BoardFacts* board = platform::find_board("stm32vldiscovery");
  REQUIRE(board != nullptr);
  const std::uint64_t flash = tools::scene_flash_bytes(*board);
  const std::string has = tools::grouped(flash) + " bytes";
  CHECK(flash > board->flash_bytes / 4);  // beside what the demonstration takes (boards/program_flash.h)
  CHECK(flash < board->flash_bytes / 2);
  const CommandResult result = check_done(
      {"bake", "spheres", "-o", oct, "--board", "stm32vldiscovery", "--stats", folder.path("s.json")});
  // The tree, and a brick map beside it.
  const std::uint64_t baked_bytes = std::filesystem::file_size(oct);
  CHECK(baked_bytes > 12624);
  CHECK(baked_bytes < 12624 + 16384);
  CHECK(result.err.find("stm32vldiscovery: flash " + tools::grouped(baked_bytes) + " of the " + has) !=
        std::string::npos);
  CHECK(run_command({"info", oct}).out.find("brick map ") != std::string::npos);
  check_done({"bake", "spheres", "-o", oct, "--memory", "12700", "--board", "stm32vldiscovery", "--quiet"});
  CHECK(std::filesystem::file_size(oct) == 12624);  // no room for a map: none
  check_done({"bake", "spheres", "-o", oct, "--brick-map", "--size", "128x64", "--quiet"});
  CHECK(std::filesystem::file_size(oct) == baked_bytes);
  const std::string ram = "RAM " + tools::grouped(208 + 512 + board->stack_bytes) + " of 8,192 bytes";
  CHECK(result.err.find(ram) != std::string::npos);  // renderer, band and stack
  CHECK(read_json(folder.path("s.json"))["board"] == "stm32vldiscovery");
  CHECK(read_json(folder.path("s.json"))["budget_bytes"] == flash);
  CHECK(render(folder, oct, {"--size", "128x64"}) == render(folder, "spheres", {"--size", "128x64"}));

  check_refused({"bake", "points:100000", "-o", folder.path("no.oct"), "--board", "stm32vldiscovery"}, 1,
                {"takes 442,764 bytes", "stm32vldiscovery has " + has + " of flash",
                 tools::grouped(442764 - flash) + " bytes too many; --coarsen", "; --depth "});
  // Of --memory and --board the smaller counts, whichever it is.
  const Words both{"bake", "points:100000", "-o", oct, "--board", "stm32vldiscovery", "--coarsen", "--quiet"};
  check_done(both);
  CHECK(std::filesystem::file_size(oct) <= flash);
  CHECK(std::filesystem::file_size(oct) > flash / 100 * 95);
  const auto size = std::filesystem::file_size(oct);
  check_done(both + Words{"--memory", "1M"});
  CHECK(std::filesystem::file_size(oct) == size);
  check_done(both + Words{"--memory", "30000"});
  CHECK(std::filesystem::file_size(oct) <= 30000);
  check_refused({"bake", "spheres", "-o", oct, "--board", "microbot"}, 2,
                {"--board: \"microbot\" is not a board", "lm3s6965evb, microbit, mps2-an500"});
}

TEST_CASE("render --board: the display's size and pixels as it shows them, its RAM as the budget") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres", "-o", oct, "--board", "lm3s6965evb", "--quiet"});
  // 16 greys, 17 apart, rounded from 256.
  const std::string fine = pixels_of(
      render(folder, "spheres", {"--size", "128x64", "--view", "front", "--shade", "depth"}, "a.pgm"));
  const std::string shown = pixels_of(render(
      folder, oct,
      {"--board", "lm3s6965evb", "--view", "front", "--shade", "depth", "--stats", folder.path("s.json")},
      "b.pgm"));
  REQUIRE(fine.size() == 128 * 64);
  REQUIRE(shown.size() == fine.size());
  std::string packed;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const unsigned gray = static_cast<unsigned char>(fine[i]);
    const unsigned level = (2 * gray + 17) / 34;
    REQUIRE(static_cast<unsigned char>(shown[i]) == level * 17);
    if (i % 2 == 0) {
      packed += static_cast<char>(level << 4);
    } else {
      packed.back() = static_cast<char>(static_cast<unsigned char>(packed.back()) | level);
    }
  }
  const auto stats = read_json(folder.path("s.json"));
  std::array<char, 9> crc{};
  std::snprintf(crc.data(), crc.size(), "%08lx",
                crc32(0, reinterpret_cast<const Bytef*>(packed.data()), static_cast<uInt>(packed.size())));
  CHECK(stats["display_crc32"] == crc.data());
  CHECK(stats["budget_bytes"] == 65536 - platform::find_board("lm3s6965evb")->stack_bytes);
  CHECK(stats["board"] == "lm3s6965evb");
  // The scene lies in flash: the state and the band are all the RAM it takes.
  CHECK(stats["high_water_bytes"] < 2048);
  CHECK(stats["tree_bytes"] > 12000);

  // Another size, another format, another file.
  const std::string fine_color =
      pixels_of(render(folder, oct, {"--size", "31x20", "--shade", "color"}, "c.ppm"));
  const std::string color = pixels_of(
      render(folder, oct, {"--size", "31x20", "--shade", "color", "--board", "mps2-an500"}, "d.ppm"));
  REQUIRE(color.size() == fine_color.size());
  for (std::size_t i = 0; i < color.size(); ++i) {
    const unsigned bits = i % 3 == 1 ? 6 : 5;
    const unsigned kept = static_cast<unsigned>(static_cast<unsigned char>(fine_color[i])) >> (8 - bits);
    REQUIRE(static_cast<unsigned char>(color[i]) == (kept << (8 - bits) | kept >> (2 * bits - 8)));
  }
  CHECK(render(folder, oct, {"--board", "raspi0", "--effects", "none"}).substr(0, 15) ==
        "P6\n640 480\n255\n");

  // A scene that is built in the board's RAM.
  const auto usable_bytes = [](const char* name) {
    const platform::BoardFacts* board = platform::find_board(name);
    REQUIRE(board != nullptr);
    return std::uint64_t{board->ram_bytes - board->stack_bytes};
  };
  const std::uint64_t least_bytes = usable_bytes("stm32vldiscovery");
  check_refused({"render", "spheres", "-o", folder.path("e.ppm"), "--board", "stm32vldiscovery"}, 1,
                {"stm32vldiscovery's RAM less its stack", tools::grouped(least_bytes), "--coarsen"});
  check_done({"render", "spheres", "-o", folder.path("e.ppm"), "--board", "stm32vldiscovery", "--coarsen",
              "--quiet", "--stats", folder.path("s.json")});
  CHECK(read_json(folder.path("s.json"))["high_water_bytes"] <= least_bytes);
  // The smaller of both counts.
  check_refused({"info", "spheres", "--board", "microbit", "--memory", "4000"}, 1, {"4,000 (--memory)"});
  check_refused({"info", "spheres", "--board", "microbit", "--memory", "1M"}, 1,
                {tools::grouped(usable_bytes("microbit"))});
  check_refused({"trace", "spheres", "--rays", "x.csv", "--board", "microbit"}, 1,
                {tools::grouped(usable_bytes("microbit"))});
  check_refused({"render", "spheres", "-o", folder.path("f.ppm"), "--board", "ZX81"}, 2, {"ZX81", "raspi0"});
  // A baked scene that the flash does not hold.
  check_done({"bake", "points:100000", "-o", oct, "--quiet"});
  check_refused({"render", oct, "-o", folder.path("f.ppm"), "--board", "lm3s6965evb"}, 1,
                {oct, "442,764", "lm3s6965evb", "161,792"});
}

TEST_CASE("baked scenes: --memory counts the tree, and nothing to build it with") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres", "-o", oct, "--quiet"});
  check_done({"info", oct, "--memory", "12468"});
  check_refused({"info", oct, "--memory", "12467"}, 1, {oct, "needs 12,468 bytes", "12,467"});
  check_done({"render", oct, "-o", folder.path("p.ppm"), "--size", "64x48", "--memory", "16K", "--quiet",
              "--shade", "depth"});
  check_refused({"info", oct, "--depth", "7"}, 1, {"baked with depth 6", "--depth"});
  check_done({"info", oct, "--depth", "6"});
  check_refused({"info", oct, "--as-voxels"}, 1, {"--as-voxels"});
}

TEST_CASE("info: a baked scene -> version, sections by bytes, palette, camera, name, checksum, boards") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres", "-o", oct, "--quiet", "--eye", "-10,-20.5,30", "--target", "32,32,32",
              "--up", "0,1,1", "--fov", "45"});
  const std::string bytes = read_text(oct);
  std::map<std::string, std::string> rows;
  for (const std::string& line : lines_of(check_done({"info", oct, "--stats", folder.path("s.json")}).out)) {
    const std::size_t end = line.find("  ");
    REQUIRE(end != std::string::npos);
    rows[line.substr(0, end)] = line.substr(line.find_first_not_of(' ', end));
  }
  const BakedScene scene = open_text(bytes);
  std::array<char, 9> crc{};
  std::snprintf(crc.data(), crc.size(), "%08x", static_cast<unsigned>(scene.crc32()));
  CHECK(rows["kind"] == "baked scene");
  CHECK(rows["depth"] == "6 (a world of 64 voxels a side)");
  CHECK(rows["solid voxels"] == "28,327");
  CHECK(rows["format version"] == "1");
  CHECK(rows["made from"] == "spheres");
  CHECK(rows["crc32"] == crc.data());
  CHECK(rows["baked bytes"] == "12,624");
  CHECK(rows["sections"] == "tree 12,468, palette 24, camera 60, name 7, rest 65");
  CHECK(rows["palette entries"] == "8");
  CHECK(
      rows["camera"].starts_with("perspective, fov 45 degrees, eye -10,-20.5,30, target 32,32,32, up 0,1,1"));
  CHECK(rows["fits the flash of"].find("stm32vldiscovery") != std::string::npos);
  CHECK(rows["compact tree"] == "sound");
  const auto stats = read_json(folder.path("s.json"));
  CHECK(stats["baked_crc32"] == crc.data());
  CHECK(stats["baked_bytes"] == 12624);
}

TEST_CASE("baked scenes: damaged -> status 1 and a sentence, for every command") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "spheres,depth=4", "-o", oct, "--quiet"});
  const std::string good = read_text(oct);
  std::string bad = good;
  bad[200] = static_cast<char>(bad[200] ^ 4);
  const std::string flipped = folder.write("flipped.oct", bad);
  check_refused({"info", flipped}, 1, {flipped, "damaged at 8", "checksum"});
  check_refused({"render", flipped, "-o", folder.path("p.ppm")}, 1, {flipped, "checksum"});
  check_refused({"trace", flipped, "--rays", oct}, 1, {"checksum"});
  check_refused({"bake", flipped, "-o", folder.path("q.oct")}, 1, {flipped, "checksum"});
  check_refused({"boards", flipped}, 1, {flipped, "checksum"});
  check_refused({"info", folder.write("cut.oct", good.substr(0, good.size() - 1))}, 1,
                {std::to_string(good.size() - 1), std::to_string(good.size()), "truncated"});
  check_refused({"info", folder.write("long.oct", good + "x")}, 1, {std::to_string(good.size() + 1)});
  check_refused({"info", folder.write("other.oct", "something else")}, 1, {"not a scene baked"});
  check_refused({"info", folder.write("short.oct", "TMS")}, 1, {"damaged at 0", "shorter than a header"});
  check_refused({"info", folder.write("empty.oct", "")}, 1, {"empty"});
  for (std::size_t size = 1; size < good.size(); size += 97) {
    check_refused({"info", folder.write("cut.oct", good.substr(0, size))}, 1, {});
  }
}

TEST_CASE("bake: bad usage and outputs that cannot be written -> a sentence, and nothing half-written") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  for (const char* name : {"s.bin", "s", "oct", ".oct2", "s.oct.gz", ""}) {
    check_refused({"bake", "spheres", "-o", name}, 2, {"--output", ".oct or .h"});
  }
  for (const char* name : {"", "2x", "a b", "int", "_x", "a__b", "uint8_t", "a-b", "caf\xC3\xA9"}) {
    CAPTURE(name);
    check_refused({"bake", "spheres", "-o", folder.path("s.h"), "--name", name}, 2, {"--name"});
  }
  check_refused({"bake", "spheres", "-o", oct, "--eye", "nan,0,0"}, 2, {"X,Y,Z"});
  check_refused({"bake", "spheres", "-o", oct, "--structure", "pool"}, 2, {"--structure"});
  check_refused({"bake", "spheres", "-o", oct, "--eye", "1,1,1", "--target", "1,1,1"}, 1, {"same point"});
  check_refused({"bake", folder.write("nan.xyz", "1 nan 2\n"), "-o", oct}, 1, {"nan.xyz"});
  check_refused({"bake", folder.path("missing.vox"), "-o", oct}, 1, {"missing.vox"});
  check_refused({"bake", "spheres", "-o", folder.path("no/such/s.oct")}, 1, {"no/such/s.oct"});
  check_refused({"bake", "spheres", "-o", oct, "--stats", oct}, 1, {oct, "share"});
  CHECK(folder.names() == Words{"nan.xyz"});

  // A device without room, and a disk that fills up half way.
  for (const char* name : {"full.oct", "full.h"}) {
    std::filesystem::create_symlink("/dev/full", folder.path(name));
    check_refused({"bake", "spheres", "-o", folder.path(name)}, 1, {name, "No space left"});
    std::filesystem::remove(folder.path(name));
  }
  folder.write("s.oct", "old");
  CommandLimits small;
  small.file_size_bytes = 4096;
  check_refused({"bake", "spheres", "-o", oct, "--stats", folder.path("s.json")}, 1, {}, small);
  CHECK(read_text(oct) == "old");
  CHECK(folder.names() == Words{"nan.xyz", "s.oct"});
  check_refused({"bake", oct, "-o", oct}, 1, {"input"});
}
