// `thimble new`: a project for each board, panel, build and language that go together, and a sentence for others. The
// packages' tests build them (tests/packages/new.sh), the boards' run them (tests/boards/new.sh).
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/file_bytes.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
namespace fs = std::filesystem;

std::vector<std::string> files_of(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      names.push_back(fs::relative(entry.path(), folder).string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

CommandResult make_project(const std::string& folder, const Words& words) {
  return run_command(Words{"new", folder, "spheres,depth=4"} + words);
}

TEST_CASE("new: each board with its own display -> a program by Thimble's port") {
  for (const platform::BoardFacts& board : platform::boards()) {
    const TemporaryFolder folder;
    const CommandResult made = make_project(folder.path("own"), {"--board", board.name});
    INFO(made.describe());
    REQUIRE(made.status == 0);
    CHECK(files_of(folder.path("own")) == Words{"CMakeLists.txt", "README.md", "main.cpp", "scene.h"});
    CHECK(read_text(folder.path("own/main.cpp")).find("display of the display") == std::string::npos);
    CHECK(read_text(folder.path("own/CMakeLists.txt")).find("set(THIMBLE_BOARD " + std::string(board.name)) !=
          std::string::npos);
  }
}

TEST_CASE("new: every board, panel, build and language -> a short program that says all, or wrong usage") {
  std::size_t made = 0;
  std::size_t refused = 0;
  Words panels{"ssd1306", "st7789-320x240", "sh1106", "st7567", "st7735", "st7789", "ili9341"};
  panels.resize(many_or_few(panels.size(), std::size_t{2}));
  for (const platform::BoardFacts& board : platform::boards()) {
    for (const std::string& panel : panels) {
      for (const char* const build : {"cmake", "platformio", "arduino"}) {
        for (const char* const language : {"c", "c++"}) {
          const TemporaryFolder folder;
          const std::string place = folder.path("castle-1");
          const CommandResult result = make_project(
              place, {"--board", board.name, "--panel", panel, "--build", build, "--language", language});
          INFO(result.describe());
          if (result.status != 0) {
            CHECK(result.status == 2);
            CHECK(is_one_sentence(result.err));
            CHECK_FALSE(fs::exists(place));
            ++refused;
            continue;
          }
          ++made;
          for (const std::string& name : files_of(place)) {
            const std::string text = read_text(place + "/" + name);
            CAPTURE(name);
            CHECK(text.find('@') == std::string::npos);
            CHECK(text.find("\n%") == std::string::npos);
            const auto lines = std::count(text.begin(), text.end(), '\n');
            CHECK(lines <= (name == "README.md"                         ? 15
                            : name.find("scene.h") == std::string::npos ? 60
                                                                        : 2000));
          }
        }
      }
    }
  }
  CHECK(made == panels.size() * (3 * 2 + 6 * 2));  // the Pico's SDK in both languages, sketches on six boards
  CHECK(refused == panels.size() * 6 * platform::boards().size - made);
}

TEST_CASE(
    "new: a folder that is no place or no name, a scene that does not fit -> a sentence, and no folder") {
  const TemporaryFolder folder;
  const Words pico{"--board", "pico", "--panel", "ssd1306"};
  fs::create_directory(folder.path("full"));
  folder.write("full/note", "text");
  const auto refused = [&](const std::string& name, const Words& words, int status, const std::string& what,
                           const std::string& scene = "spheres,depth=4") {
    check_refused(Words{"new", folder.path(name), scene} + words, status, {what});
  };
  refused("full", pico, 1, "no empty folder");
  refused("full/note", pico, 1, "no empty folder");
  CHECK(files_of(folder.path("full")) == Words{"note"});
  refused("my castle", pico, 2, "no name of a project");
  refused("a-b", {"--board", "gba"}, 2, "no name of a project");
  refused("main", {"--board", "gba"}, 2, "no name of a project");
  refused("p", {}, 2, "--board");
  refused("p", pico + Words{"--memory", "100"}, 1, "--memory");
  refused("p", {"--board", "gba", "--build", "arduino"}, 2, "--build");
  refused("p", pico, 1, "none.vox", folder.path("none.vox"));
  CHECK_FALSE(fs::exists(folder.path("p")));
  // An empty one will do.
  fs::create_directory(folder.path("empty"));
  CHECK(make_project(folder.path("empty") + "/", pico).status == 0);
}

}  // namespace
