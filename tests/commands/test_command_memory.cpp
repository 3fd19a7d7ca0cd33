// `thimble memory`: its figures from first principles, its budgets, its plots, and what it refuses.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "output/units.h"
#include "scene/board_fit.h"
#include "support/check_command.h"
#include "support/hit_rows.h"
#include "support/json.h"
#include "support/subtree_count.h"
#include "support/xml_elements.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

CommandResult memory(const Words& words) {
  CommandResult result = check_done(Words{"memory"} + words);
  CHECK(result.err.empty());
  for (const std::string& line : lines_of(result.out)) {
    CAPTURE(line);
    CHECK((line.size() <= 100 || line == words.front()));
  }
  return result;
}

Json rows_of(const TemporaryFolder& folder, const Words& words) {
  memory(words + Words{"--json", folder.path("m.json")});
  return read_json(folder.path("m.json"));
}

// Some blocks, some single voxels, in a world of 16.
std::vector<reference::Voxel> small_scene(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::set<reference::Voxel> voxels;
  for (int block = 0; block < 6; ++block) {
    const int side = 1 << (random() % 3);
    reference::Voxel corner{};
    for (int& component : corner) {
      component = static_cast<int>(random() % static_cast<unsigned>(16 / side)) * side;
    }
    for (int i = 0; i < side * side * side; ++i) {
      voxels.insert({corner[0] + i % side, corner[1] + i / side % side, corner[2] + i / side / side});
    }
  }
  voxels.insert({15, 2, 3});
  return {voxels.begin(), voxels.end()};
}

constexpr std::array<const char*, 4> kStructures{"dense", "pool", "compact", "dag"};

}  // namespace

TEST_CASE("memory: small scenes -> every figure is what counting by hand gives") {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const std::vector<reference::Voxel> voxels = small_scene(seed);
    const std::string path = folder.write("s.xyz", as_xyz(voxels));
    const Json rows = rows_of(folder, {path, "--as-voxels", "--size", "40x30", "--frames", "1"});
    REQUIRE(rows.size() == 4 + 12);
    std::uint64_t last_silhouette = UINT64_MAX;
    for (int depth = 1; depth <= 4; ++depth) {
      CAPTURE(depth);
      const Json& row = rows[static_cast<std::size_t>(depth) - 1];
      // The parents of the voxels.
      std::set<reference::Voxel> parents;
      reference::Voxel most{};
      for (const reference::Voxel& voxel : voxels) {
        const int levels = 4 - depth;
        const reference::Voxel parent{voxel[0] >> levels, voxel[1] >> levels, voxel[2] >> levels};
        parents.insert(parent);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          most[axis] = std::max(most[axis], parent[axis] + 1);
        }
      }
      const int side = 1 << depth;
      const reference::BitGrid grid({side, side, side}, {parents.begin(), parents.end()});
      const CountedTrees counted = count_trees(grid, depth);
      const std::size_t units = static_cast<std::size_t>(most[0]) * static_cast<std::size_t>(most[1]) *
                                static_cast<std::size_t>(most[2]);
      CHECK(row["row"] == "depth");
      CHECK(row["depth"] == depth);
      CHECK(row["grid"] ==
            std::to_string(most[0]) + "x" + std::to_string(most[1]) + "x" + std::to_string(most[2]));
      CHECK(row["units"] == units);
      CHECK(row["voxels"] == parents.size());
      const bool full = parents.size() == std::size_t{1} << (3 * depth);
      const std::size_t nodes = full ? 1 : counted.nodes;
      const std::size_t leaves = full ? 1 : counted.leaves;
      const std::size_t compact = full ? 64 : counted.compact_bytes();
      CHECK(row["leaves"] == leaves);
      CHECK(row["pool_nodes"] == nodes);
      CHECK(row["compact_nodes"] == nodes);
      CHECK(row["dag_nodes"] == counted.shared_nodes);
      CHECK(row["dense_bytes"] == (units + 7) / 8);
      CHECK(row["pool_bytes"] == 8 * nodes);
      CHECK(row["compact_bytes"] == compact);
      CHECK(row["dag_bytes"] == counted.shared_bytes);
      const auto ratio = [&](std::size_t bytes) {
        return doctest::Approx(static_cast<double>(bytes) / static_cast<double>(parents.size()));
      };
      CHECK(row["dense_bit_bytes_per_voxel"].get<double>() == ratio((units + 7) / 8));
      CHECK(row["dense_color_bytes_per_voxel"].get<double>() == ratio((units + 7) / 8 + units));
      CHECK(row["dense_normal_bytes_per_voxel"].get<double>() == ratio((units + 7) / 8 + 3 * units));
      CHECK(row["dense_opacity_bytes_per_voxel"].get<double>() == ratio((units + 7) / 8 + 4 * units));
      CHECK(row["pool_bit_bytes_per_voxel"].get<double>() == ratio(8 * nodes));
      CHECK(row["pool_color_bytes_per_voxel"].get<double>() == ratio(8 * nodes));
      CHECK(row["pool_opacity_bytes_per_voxel"].get<double>() == ratio(8 * nodes + 3 * leaves));
      CHECK(row["compact_bit_bytes_per_voxel"].get<double>() == ratio(compact));
      CHECK(row["dag_bit_bytes_per_voxel"].get<double>() == ratio(counted.shared_bytes));
      // Built from keys of four bytes, at any rate not in less than it takes.
      CHECK(row["dense_build_bytes"] == (units + 7) / 8);
      CHECK(row["pool_build_bytes"] >= 8 * nodes);
      CHECK(row["compact_build_bytes"] == compact + 4 * parents.size());
      const std::uint64_t table = row["dag_table_bytes"];
      CHECK(table >= 12 * counted.shared_nodes);
      CHECK(row["dag_build_bytes"] == std::max(row["compact_build_bytes"].get<std::uint64_t>(),
                                               compact + table + counted.shared_bytes));
      for (const std::string structure : kStructures) {
        CHECK(row[structure + "_frame_ms"].get<double>() > 0);
        CHECK(row[structure + "_visits_per_ray"].get<double>() > 0);
      }
      CHECK(row["pool_visits_per_ray"] == row["compact_visits_per_ray"]);
      CHECK(row["dag_visits_per_ray"] == row["compact_visits_per_ray"]);
      // A coarser depth only adds.
      CHECK(row["silhouette_px"] <= last_silhouette);
      CHECK(row["silhouette_px"] <= row["wrong_px"]);
      last_silhouette = row["silhouette_px"];
    }
    CHECK(rows[3]["wrong_px"] == 0);
    CHECK(rows[3]["depth_error_max_voxels"] == 0);
    CHECK(rows[0]["wrong_px"] > 0);
    // The paper's sum.
    CHECK(rows[5]["row"] == "paper");
    CHECK(rows[5]["grid"] == "800x600x800");
    CHECK(rows[5]["units"] == 384000000);
    CHECK(rows[5]["dense_bytes"] == 48000000);
    CHECK(rows[5]["depth"].is_null());
    CHECK(rows[6]["row"] == "paper_4_gib");
    for (std::size_t i = 6; i < rows.size(); i += 3) {
      const std::uint64_t bytes = rows[i]["dense_bytes"];
      const std::uint64_t layer = rows[i - 2]["dense_bytes"];
      CHECK(bytes <= std::uint64_t{1} << 32);
      CHECK(bytes + layer > std::uint64_t{1} << 32);
    }
  }
}

TEST_CASE("memory: a scene of several materials -> colour costs what the trees really take") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, {"spheres", "--size", "80x60", "--frames", "0"});
  const Json& own = rows[5];
  CHECK(own["voxels"] == 28327);
  // What info says of the same structures.
  CHECK(own["compact_color_bytes_per_voxel"].get<double>() ==
        doctest::Approx(own["compact_bytes"].get<double>() / 28327));
  for (const std::string structure : {"compact", "pool"}) {
    const CommandResult info = run_command({"info", "spheres", "--structure", structure});
    CHECK(info.out.find(tools::grouped(own[structure + "_bytes"].get<std::uint64_t>())) != std::string::npos);
  }
  CHECK(own["compact_bit_bytes_per_voxel"] < own["compact_color_bytes_per_voxel"]);
  CHECK(own["dag_bit_bytes_per_voxel"] < own["dag_color_bytes_per_voxel"]);
  // One byte a leaf, a count a node, and nothing that one colour for all would have.
  CHECK(own["dag_bytes"] >= own["leaves"]);
  for (const std::string structure : kStructures) {
    CHECK(own[structure + "_frame_ms"].is_null());
    CHECK(own[structure + "_visits_per_ray"].is_null());
  }
}

TEST_CASE("memory: the boards of a depth -> those whose flash boards says it fits") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, {"points:100000,depth=9", "--size", "40x30", "--frames", "0"});
  const std::string json = folder.path("b.json");
  check_done({"boards", "points:100000,depth=9", "--quiet", "--json", json});
  const std::string fits = ";" + rows[8]["compact_boards"].get<std::string>() + ";";
  int boards = 0;
  for (const Json& board : read_json(json)) {
    const std::string name = board["board"];
    CAPTURE(name);
    const bool listed = fits.find(";" + name + ";") != std::string::npos;
    CHECK(listed == (board["fits_flash"] == 1));
    boards += listed ? 1 : 0;
  }
  CHECK(boards > 0);
  CHECK(boards < static_cast<int>(platform::boards().size));
  for (const Json& row : rows) {
    if (row["row"] != "depth") {
      continue;
    }
    for (const platform::BoardFacts& board : platform::boards()) {
      const std::string name = std::string(";") + board.name + ";";
      const std::string pool = ";" + row["pool_boards"].get<std::string>() + ";";
      CHECK((pool.find(name) != std::string::npos) ==
            (tools::drawing_ram_bytes(board) + row["pool_build_bytes"].get<std::uint64_t>() <=
             board.ram_bytes));
    }
  }
}

TEST_CASE("memory: --budget-sweep -> the deepest depth that fits each budget, and trees coarsened to it") {
  const TemporaryFolder folder;
  const Words scene{"spheres", "--size", "80x60", "--frames", "0"};
  const Json depths = rows_of(folder, scene);
  const Json rows = rows_of(folder, scene + Words{"--budget-sweep", "--memory", "5000", "--csv",
                                                  folder.path("m.csv"), "--plot", folder.path("m.svg")});
  REQUIRE(rows.size() == 7);
  const std::vector<std::uint64_t> budgets{1024, 2048, 4096, 5000, 8192, 16384, 32768};
  std::uint64_t last_added = UINT64_MAX;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json& row = rows[i];
    CHECK(row["budget_bytes"] == budgets[i]);
    for (const std::string structure : kStructures) {
      int deepest = 0;
      for (int depth = 1; depth <= 6; ++depth) {
        const Json& figures = depths[static_cast<std::size_t>(depth) - 1];
        deepest = figures[structure + "_bytes"] <= budgets[i] ? depth : deepest;
      }
      CHECK(row[structure + "_depth"] == deepest);
      if (deepest != 0 && (structure == "compact" || structure == "dag")) {
        CHECK(row[structure + "_wrong_px"] == depths[static_cast<std::size_t>(deepest) - 1]["wrong_px"]);
      }
    }
    CHECK(row["coarsened_bytes"] <= budgets[i]);
    CHECK(row["coarsened_bytes"] > budgets[i] / 4);
    CHECK(row["coarsened_solid_added_voxels"] <= last_added);
    last_added = row["coarsened_solid_added_voxels"];
  }
  CHECK(rows[0]["coarsened_wrong_px"] > 0);
  CHECK(rows[0]["coarsened_solid_added_voxels"] > 0);
  CHECK(rows[6]["coarsened_wrong_px"] == 0);
  CHECK(rows[6]["coarsened_bytes"] == depths[5]["compact_bytes"]);
  CHECK(rows[6]["coarsened_solid_added_voxels"] == 0);
  const Words csv = lines_of(read_text(folder.path("m.csv")));
  REQUIRE(csv.size() == 8);
  CHECK(csv[0].starts_with("budget_bytes,dense_depth,pool_depth,compact_depth,dag_depth,compact_wrong_px,"));
  CHECK(csv[4].starts_with("5000,"));
  CHECK(elements_of(read_text(folder.path("m.svg"))) > 20);
}

TEST_CASE("memory: empty, full and smallest worlds -> rows, not errors") {
  const TemporaryFolder folder;
  const Json empty = rows_of(folder, {"points:0,depth=3", "--size", "16x12", "--budget-sweep"});
  CHECK(empty[0]["compact_depth"] == 3);
  Json rows = rows_of(folder, {"points:0,depth=3", "--size", "16x12"});
  CHECK(rows[2]["voxels"] == 0);
  CHECK(rows[2]["compact_bytes"] == 56);
  CHECK(rows[2]["dag_bit_bytes_per_voxel"].is_null());
  CHECK(rows[2]["wrong_px"] == 0);
  rows = rows_of(folder, {"points:4000,depth=2", "--size", "16x12"});
  CHECK(rows[1]["voxels"] == 64);
  CHECK(rows[1]["dag_bytes"] == 68);
  CHECK(rows[1]["leaves"] == 1);
  rows = rows_of(folder, {"points:1,depth=1", "--size", "16x12"});
  CHECK(rows.size() == 1 + 12);
  CHECK(rows[0]["dag_bytes"] == 64);
}

TEST_CASE("memory: wrong options and files -> a sentence, and no file") {
  const TemporaryFolder folder;
  check_refused({"memory"}, 2, {"SCENE"});
  check_refused({"memory", "spheres", "--frames", "100"}, 2, {"--frames", "\"100\""});
  check_refused({"memory", "spheres", "--frames", "-1"}, 2, {"--frames", "\"-1\""});
  check_refused({"memory", "spheres", "--depth", "13"}, 2, {"--depth", "1 to 12"});
  check_refused({"memory", "spheres", "--memory", "some"}, 2, {"--memory", "64K"});
  check_refused({"memory", "spheres", "--shade", "pretty"}, 2, {"--shade"});
  check_refused({"memory", "spheres", "--budget-sweep=3"}, 2, {"--budget-sweep takes no value"});
  check_refused({"memory", "spheres", "--structure", "dense"}, 2, {"--structure"});
  check_refused({"memory", "nothing.vox"}, 1, {"nothing.vox"});
  check_refused({"memory", "spheres", "--eye", "1,2,3", "--target", "1,2,3", "--csv", folder.path("m.csv")},
                1, {"--eye"});
  CHECK(folder.names().empty());
}
