// `thimble boards`: the table, and what of a scene fits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "boards/board_table.h"
#include "output/units.h"
#include "scene/board_fit.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/json.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

CommandResult boards(const Words& words) {
  CommandResult result = check_done(Words{"boards"} + words);
  CHECK(result.err.empty());
  return result;
}

// The table that people read: what is not the scene's own name keeps to 100 columns.
std::string table(const Words& words) {
  const CommandResult result = boards(words);
  for (const std::string& line : lines_of(result.out)) {
    CAPTURE(line);
    CHECK((line.size() <= 100 || line == words.front()));
  }
  return result.out;
}

// The line that begins with `name` and a blank, in the part of the text after `from`.
std::string line_of(const std::string& text, const std::string& name, std::size_t from = 0) {
  const std::size_t at = text.find("\n" + name + " ", from);
  REQUIRE(at != std::string::npos);
  return text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

}  // namespace

TEST_CASE("boards: without a scene -> every board's limits, in order, in 100 columns") {
  const std::string text = table({});
  CHECK(lines_of(text).size() == 2 * (1 + platform::boards().size) + 4);
  std::size_t last = 0;
  for (const platform::BoardFacts& board : platform::boards()) {
    const std::size_t at = text.find(board.name);
    CHECK(at != std::string::npos);
    CHECK(at > last);
    last = at;
  }
  CHECK(line_of(text, "lm3s6965evb") ==
        "lm3s6965evb       cortex-m3      128x64 gray4        oled           5     65,536     262,144   " +
            tools::grouped(platform::find_board("lm3s6965evb")->stack_bytes));
  // 700 MHz by 51 million instructions.
  const platform::BoardFacts* const pi = platform::find_board("raspi0");
  const std::string rate = line_of(text, "raspi0", text.find("instructions counted"));
  CHECK(rate.find(" 700 ") != std::string::npos);
  CHECK(rate.find(" " + tools::grouped(pi->frame_instructions) + " ") != std::string::npos);
  CHECK(std::abs(std::stod(rate.substr(rate.rfind(' '))) - 7e8 / pi->frame_instructions) < 0.05);
}

TEST_CASE("boards: with a scene -> what fits is what bake and render say") {
  const TemporaryFolder folder;
  const std::string json_path = folder.path("b.json");
  const std::string csv_path = folder.path("b.csv");
  const std::string text = table({"spheres", "--json", json_path, "--csv", csv_path});
  CHECK(text.find("spheres\n28,327 voxels at depth 6, 12,624 bytes baked, 32,368 bytes as a pool") !=
        std::string::npos);
  const std::size_t second = text.find("scene flash");
  const std::uint64_t stack = platform::find_board("microbit")->stack_bytes;
  CHECK(line_of(text, "microbit", second) == "microbit              143,360   8.8 %        " +
                                                 tools::grouped(stack + 720) + "   yes        " +
                                                 tools::grouped(stack + 33088) + "    no        7       4.3");
  const auto rows = read_json(json_path);
  REQUIRE(rows.size() == platform::boards().size);
  const std::vector<std::string> csv = lines_of(read_text(csv_path));
  REQUIRE(csv.size() == rows.size() + 1);
  std::string header;
  for (const auto& [name, value] : rows[0].items()) {
    header += (header.empty() ? "" : ",") + name;
  }
  CHECK(csv[0] == header);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const platform::BoardFacts& board = platform::boards()[i];
    CAPTURE(board.name);
    CHECK(csv[i + 1].starts_with(std::string(board.name) + ","));
    CHECK(row["ram_bytes"] == board.ram_bytes);
    CHECK(row["scene_flash_bytes"] == tools::scene_flash_bytes(board));
    CHECK(row["baked_bytes"] == 12624);
    CHECK(row["drawing_ram_bytes"] ==
          row["state_bytes"].get<int>() + row["band_bytes"].get<int>() + row["stack_bytes"].get<int>());
    CHECK(row["building_ram_bytes"] == row["drawing_ram_bytes"].get<int>() + row["pool_bytes"].get<int>());
    CHECK(row["builds_in_ram"] == (row["building_ram_bytes"] <= board.ram_bytes ? 1 : 0));
    // Depth 9 is the last that is tried: solid bodies grow eightfold.
    const int deepest = row["deepest_depth"];
    const auto fits = [&](int depth) {
      return run_command({"bake", "spheres", "-o", folder.path("s.oct"), "--quiet", "--board", board.name,
                          "--depth", std::to_string(depth)})
                 .status == 0;
    };
    if (std::string_view(board.name) == "lm3s6965evb") {
      CHECK(fits(deepest));
      CHECK_FALSE(fits(deepest + 1));
    }
    CHECK(row["deepest_tried_depth"] == 9);
    CHECK(row["scene_frames_per_second_estimate"].get<double>() *
              row["scene_frame_instructions"].get<double>() ==
          doctest::Approx(board.core_mhz * 1e6 * (row["scene_frame_instructions"] == 0 ? 0 : 1)));
  }
  // The pool is what an octree of the scene takes.
  check_done({"info", "spheres", "--structure", "pool", "--memory", rows[0]["pool_bytes"].dump()});
}

TEST_CASE("boards: a scene of one depth, a baked one, points -> the deepest depth of each") {
  const TemporaryFolder folder;
  const std::string oct = folder.path("s.oct");
  check_done({"bake", "points:30000,depth=8", "-o", oct, "--quiet"});
  const std::string json_path = folder.path("b.json");
  const std::string text = table({oct, "--json", json_path});
  CHECK(text.find("one depth only") != std::string::npos);
  auto rows = read_json(json_path);
  for (const auto& row : rows) {
    const bool fits = row["baked_bytes"] <= row["scene_flash_bytes"];
    CHECK(row["fits_flash"] == (fits ? 1 : 0));
    CHECK(row["deepest_depth"] == (fits ? 8 : 0));
  }
  // Points of any depth: the whole range is tried, down to where the smallest board takes it.
  boards({"points:30000", "--json", json_path, "--quiet"});
  rows = read_json(json_path);
  int least = 99;
  for (const auto& row : rows) {
    CHECK(row["deepest_tried_depth"] == 12);
    CHECK(row["depth"] == 10);
    least = std::min(least, row["deepest_depth"].get<int>());
  }
  CHECK(least < 10);
  CHECK(least > 1);
}

TEST_CASE("boards: data on standard output -> no table between; bad usage and input -> a sentence") {
  const CommandResult csv = boards({"--csv", "-"});
  CHECK(lines_of(csv.out).size() == 1 + platform::boards().size);
  CHECK(csv.out.starts_with("board,title,core,ram_bytes,"));
  // Commas within a title are in quotes.
  CHECK(csv.out.find("\"Netduino Plus 2 (STM32F405, Cortex-M4F)\"") != std::string::npos);
  CHECK(parse_json(boards({"--json", "-"}).out).size() == platform::boards().size);
  check_refused({"boards", "--csv", "-", "--json", "-"}, 1, {"standard output"});
  check_refused({"boards", "--depth", "3"}, 2, {"--depth"});
  check_refused({"boards", "nothing.vox"}, 1, {"nothing.vox"});
  check_refused({"boards", "--board", "microbit"}, 2, {"--board"});
  check_refused({"boards", "--json", "/no/such/b.json"}, 1, {"/no/such/b.json"});
  CommandLimits full;
  full.output_path = "/dev/full";
  CHECK(run_command({"boards"}, full).status == 1);
}

TEST_CASE("boards: a scene's frames -> within a fifth of what bench measures, eight scenes on six boards") {
  const TemporaryFolder folder;
  const std::string path = folder.path("b.json");
  const auto table = std::filesystem::path(__FILE__).parent_path() / "../budgets/scene_frames.csv";
  std::map<std::string, std::map<std::string, double>> measured;
  for (const std::string& line : lines_of(read_text(table.string()))) {
    const std::size_t first = line.find(';');
    const std::size_t last = line.rfind(';');
    if (line[0] != '#' && !line.starts_with("board;")) {
      measured[line.substr(first + 1, last - first - 1)][line.substr(0, first)] =
          std::stod(line.substr(last + 1));
    }
  }
  REQUIRE(measured.size() == 8);
  std::size_t number = 0;
  for (const auto& [scene, boards_of] : measured) {
    if (number++ % many_or_few(1U, 2U) != 0) {
      continue;
    }
    boards({scene, "--json", path});
    CHECK(boards_of.size() == 6);
    for (const auto& row : read_json(path)) {
      const auto found = boards_of.find(row["board"]);
      if (found != boards_of.end()) {
        CAPTURE(scene);
        CAPTURE(found->first);
        CHECK(row["scene_frame_instructions"].get<double>() == doctest::Approx(found->second).epsilon(0.2));
      }
    }
  }
}

TEST_CASE("boards: the smallest that turns a scene at 10 a second; none is known where none holds it") {
  CHECK(table({"castle"}).find("\nthe smallest board that turns it at 10 frames a second: lm3s6965evb\n") !=
        std::string::npos);
  const std::string text = table({"points:500,depth=11"});
  CHECK(line_of(text, "lm3s6965evb", text.find("scene flash")).ends_with(" -"));
  CHECK(text.find("\nno board is known to turn it at 10 frames a second\n") != std::string::npos);
}
