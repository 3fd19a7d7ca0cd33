// `thimble info`: what it says of each kind of scene.
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/json.h"

namespace {

using namespace thimble::tests;

// label -> value, from columns of blanks.
std::map<std::string, std::string> info(const Words& words) {
  const CommandResult result = check_done(Words{"info"} + words);
  CHECK(result.err.empty());
  std::map<std::string, std::string> rows;
  for (const std::string& line : lines_of(result.out)) {
    const std::size_t end = line.find("  ");
    REQUIRE(end != std::string::npos);
    rows[line.substr(0, end)] = line.substr(line.find_first_not_of(' ', end));
  }
  return rows;
}

}  // namespace

TEST_CASE("info: a generator -> depth, points, voxels, a sound compact tree") {
  auto rows = info({"points:1000,depth=7,seed=3"});
  CHECK(rows["scene"] == "points:1000,depth=7,seed=3");
  CHECK(rows["kind"] == "generator points");
  CHECK(rows["depth"] == "7 (a world of 128 voxels a side)");
  CHECK(rows["points"] == "1,000");
  CHECK(rows["materials"] == "1: 1 diffuse");
  CHECK(rows["compact tree"] == "sound");
  CHECK(info({"points:1000,depth=7", "--depth", "5"})["depth"].starts_with("5 "));
  rows = info({"points:0"});
  CHECK(rows["solid voxels"] == "0");
  CHECK(rows["occupied box"] == "none");
  // A full world, whatever the order of its points, is one node.
  rows = info({"points:40000,depth=3"});
  CHECK(rows["solid voxels"] == "512");
}

TEST_CASE("info: points far out, or outside of --clip -> a note, and rendering says it, too") {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 400; ++i) {
    text += std::to_string(i % 20) + " " + std::to_string(i / 20) + " 0\n";
  }
  const std::string path = folder.write("far.xyz", text + "1000000 0 0\n");
  const auto note = [&](const Words& more) {
    const CommandResult result = check_done(Words{"info", path} + more);
    CHECK((result.out.find("solid voxels         400") != std::string::npos) == more.empty());
    return result.out + result.err;
  };
  const std::string said = "1 of 401 points are far from all others and left out; --fit 100 takes them";
  CHECK(note({}).find(said) != std::string::npos);
  CHECK(note({"--fit", "100"}).find("left out") == std::string::npos);
  CHECK(note({"--clip", "0,0,-1,4.5,19,1"}).find("301 of 401 points are outside of --clip") !=
        std::string::npos);
  const CommandResult drawn = run_command({"render", path, "--size", "9x9", "-o", folder.path("a.png")});
  CHECK(drawn.err.find(said) != std::string::npos);
}

TEST_CASE("info: a .vox of two voxels and two materials -> its own indices, the least world that holds it") {
  const TemporaryFolder folder;
  const std::string vox = vox_file(vox_model({20, 5, 9}, {{0, 1, 2, 5}, {19, 4, 8, 7}}));
  const std::string path = folder.write("two.vox", vox);
  auto rows = info({path});
  CHECK(rows["scene"] == path);
  CHECK(rows["depth"] == "5 (a world of 32 voxels a side)");
  CHECK(rows["solid voxels"] == "2");
  CHECK(rows["occupied box"] == "0,1,2 to 20,5,9 (exclusive)");
  CHECK(rows["materials"] == "2: 2 diffuse");
  check_refused({"info", path, "--depth", "4"}, 1, {"20 voxels", "--depth 5"});
}

TEST_CASE("info: a mesh -> voxelised, y up turned to z up unless --z-up") {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("plate.obj", "v 0 0 0\nv 8 0 0\nv 8 0 4\nv 0 0 4\nf 1 2 3\nf 1 3 4\n");
  auto turned = info({path, "--depth", "3"});
  CHECK(turned["kind"] == "triangle mesh, voxelised");
  auto kept = info({path, "--depth", "3", "--z-up"});
  CHECK(turned["up in the file"] == "y (--z-up says otherwise)");
  CHECK(kept["up in the file"] == "z");
  CHECK(turned["occupied box"] != kept["occupied box"]);
  CHECK(info({path})["depth"].starts_with("9 "));
}

TEST_CASE("info: points -> fitted to the world, or as voxel indices with --as-voxels") {
  const TemporaryFolder folder;
  const std::string path = folder.write("p.xyz", "10 20 30\n12 25 31\n12 25 31\n");
  auto rows = info({path, "--as-voxels"});
  CHECK(rows["points"] == "3");
  CHECK(rows["solid voxels"] == "2");
  CHECK(rows["depth"].starts_with("5 "));
  CHECK(rows["occupied box"] == "10,20,30 to 13,26,32 (exclusive)");
  rows = info({path});
  CHECK(rows["depth"].starts_with("9 "));
  CHECK(rows["solid voxels"] == "2");
}

TEST_CASE("info: --stats -> the keys of every command, the frame's being zero or empty") {
  const TemporaryFolder folder;
  info({"spheres", "--stats", folder.path("s.json"), "--structure", "pool"});
  const auto stats = read_json(folder.path("s.json"));
  CHECK(stats["voxels"] == 28327);
  CHECK(stats["rays"] == 0);
  CHECK(stats["frame_crc32"] == "");
  CHECK(stats["high_water_bytes"] <= stats["budget_bytes"]);
}
