// `thimble export`: voxels as files of other programs, which the readers turn into the same voxels again.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "scene/scene_source.h"
#include "support/check_command.h"
#include "support/run_command.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

using Voxel = std::array<std::int32_t, 3>;
using Color = std::array<int, 3>;
using Voxels = std::map<Voxel, Color>;

const char* const kEndings[] = {".vox", ".npy", ".ply", ".csv"};

Voxels voxels_of(const std::string& path, bool as_voxels, bool* has_colors) {
  tools::SceneArguments arguments;
  arguments.scene = path;
  arguments.as_voxels = as_voxels;
  const auto source = tools::open_scene(arguments);
  *has_colors = source->has_colors();
  // The last of a place counts, of points the one with the greatest index.
  std::map<Voxel, std::uint8_t> materials;
  source->stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        std::uint8_t& kept = materials[{x, y, z}];
        kept = source->is_point_set() ? std::max(kept, material) : material;
      },
      {});
  Voxels voxels;
  for (const auto& [voxel, material] : materials) {
    const tools::Rgb& color = source->palette()[material].color;
    voxels[voxel] = {color.r, color.g, color.b};
  }
  return voxels;
}

// Where the lowest model of a .vox is, on each axis.
Voxel lowest_model(const Voxels& voxels) {
  Voxel lowest = voxels.begin()->first;
  for (const auto& [voxel, color] : voxels) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lowest[axis] = std::min(lowest[axis], voxel[axis]);
    }
  }
  return {lowest[0] / 256 * 256, lowest[1] / 256 * 256, lowest[2] / 256 * 256};
}

Voxels moved(const Voxels& voxels, const Voxel& by) {
  Voxels result;
  for (const auto& [voxel, color] : voxels) {
    result[{voxel[0] + by[0], voxel[1] + by[1], voxel[2] + by[2]}] = color;
  }
  return result;
}

// Exports `scene` in each format and reads that again.
void check_round(const TemporaryFolder& folder, const std::string& scene, bool as_voxels) {
  bool has_colors = false;
  const Voxels before = voxels_of(scene, as_voxels, &has_colors);
  REQUIRE(!before.empty());
  for (const std::string ending : kEndings) {
    CAPTURE(scene);
    CAPTURE(ending);
    const std::string path = folder.path("out" + ending);
    const CommandResult result =
        check_done(Words{"export", scene, "-o", path} + (as_voxels ? Words{"--as-voxels"} : Words{}));
    CHECK(result.out.empty());
    CHECK(result.err.find(std::to_string(before.size() % 1000)) != std::string::npos);
    bool is_colored = false;
    Voxels after = voxels_of(path, ending == ".ply" || ending == ".csv", &is_colored);
    if (ending == ".vox") {
      after = moved(after, lowest_model(before));
    }
    if (has_colors) {
      CHECK(after == before);
      continue;
    }
    CHECK(is_colored == (ending == ".vox"));
    CHECK(after.size() == before.size());
    CHECK(std::equal(after.begin(), after.end(), before.begin(),
                     [](const auto& a, const auto& b) { return a.first == b.first; }));
  }
}

// `count` voxels in a world of `side`, of `colors` colours, none of whose parts passes `most`.
std::string random_voxels(std::uint32_t seed, int count, int side, int colors, int most) {
  std::mt19937 generator(seed);
  const auto random = [&](int below) { return static_cast<int>(generator() % static_cast<unsigned>(below)); };
  std::vector<Color> palette;
  for (int i = 0; i < colors; ++i) {
    palette.push_back({random(most + 1), random(most + 1), random(most + 1)});
  }
  std::string text = colors != 0 ? "x,y,z,red,green,blue\n" : "x,y,z\n";
  for (int i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      text += (axis == 0 ? "" : ",") + std::to_string(random(side));
    }
    if (colors != 0) {
      for (const int part : palette[static_cast<std::size_t>(random(colors))]) {
        text += "," + (most > 1 ? std::to_string(part) : std::string(part == 0 ? "0" : "0.0039215686"));
      }
    }
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("export: voxels of any place, number and colours -> each format is read as the same again") {
  const TemporaryFolder folder;
  struct World {
    int count, side, colors, most;
  };
  // Few and many colours, none, nearly black ones; one model of a .vox and several.
  constexpr World kWorlds[] = {{1, 1, 1, 255},     {40, 8, 3, 255},   {300, 40, 250, 255}, {200, 256, 2, 1},
                               {500, 300, 9, 255}, {50, 256, 0, 255}, {90, 300, 0, 255}};
  std::uint32_t seed = 1;
  for (const World& world : kWorlds) {
    const std::string text = random_voxels(seed++, world.count, world.side, world.colors, world.most);
    CAPTURE(seed);
    check_round(folder, folder.write("in.csv", text), true);
  }
  // Only far from the origin, so that what stands at it is empty.
  check_round(folder, folder.write("in.csv", "x,y,z,red,green,blue\n700,3,300,9,200,7\n701,3,300,9,200,8\n"),
              true);
}

TEST_CASE("export: models, meshes and baked scenes -> the voxels that they are drawn with") {
  const TemporaryFolder folder;
  check_round(folder, "castle", false);
  check_round(folder, "demo", false);
  const std::string baked = folder.path("c.oct");
  check_done({"bake", "castle", "-o", baked});
  check_round(folder, baked, false);
  // A corner of a cube, coarsened nowhere, voxelised at its --depth.
  const std::string mesh =
      folder.write("m.obj", "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 2 3\nf 1 3 4\nf 1 2 4\n");
  check_done({"export", mesh, "--depth", "4", "-o", folder.path("m.ply")});
  check_done({"bake", mesh, "--depth", "4", "-o", folder.path("m.oct")});
  bool colors = false;
  const Voxels exported = voxels_of(folder.path("m.ply"), true, &colors);
  CHECK(!colors);
  const Voxels drawn = voxels_of(folder.path("m.oct"), false, &colors);
  REQUIRE(exported.size() == drawn.size());
  CHECK(std::equal(exported.begin(), exported.end(), drawn.begin(),
                   [](const auto& a, const auto& b) { return a.first == b.first; }));
}

TEST_CASE("export: what cannot be written -> one sentence, and nothing is there") {
  const TemporaryFolder folder;
  check_refused({"export", "demo", "-o", folder.path("a.obj")}, 2, {".vox, .npy, .ply or .csv"});
  check_refused({"export", "demo"}, 2, {"--output"});
  check_refused({"export", folder.path("nothing.vox"), "-o", folder.path("a.vox")}, 1, {"nothing.vox"});
  const std::string far = folder.write("far.csv", "x,y,z\n0,0,0\n4095,4095,4095\n");
  check_refused({"export", far, "--as-voxels", "--quiet", "-o", folder.path("a.npy")}, 1,
                {"4096 x 4096 x 4096", "68,719,476,736", ".ply"});
  const std::string same = folder.write("same.csv", "x,y,z\n1,2,3\n");
  check_refused({"export", same, "--as-voxels", "-o", same}, 1, {"same.csv", "overwritten"});
  CHECK(read_text(same) == "x,y,z\n1,2,3\n");
  CHECK(folder.names() == std::vector<std::string>{"far.csv", "same.csv"});
}
