// Every two options of a command together: what cannot be meant is wrong usage, status 2 and a sentence, never
// anything else; what depends on the scene or on a budget is status 1.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/run_command.h"

namespace thimble::tests {
namespace {

using Words = std::vector<std::string>;

// A value, or several, for each option that takes one; "" for those that take none. Files go into the test's folder.
const std::multimap<std::string, std::string>& values() {
  static const std::multimap<std::string, std::string> table{{"--as-voxels", ""},
                                                             {"--background", "ff0000"},
                                                             {"--background", "none"},
                                                             {"--board", "microbit"},
                                                             {"--brick-map", ""},
                                                             {"--budget-sweep", ""},
                                                             {"--csv", "@t.csv"},
                                                             {"--json", "@t.json"},
                                                             {"--plot", "@t.svg"},
                                                             {"--frames", "1"},
                                                             {"--bounces", "2"},
                                                             {"--camera-path", "@path.csv"},
                                                             {"--coarsen", ""},
                                                             {"--cutoff", "3"},
                                                             {"--depth", "4"},
                                                             {"--depth-image", "@d.pfm"},
                                                             {"--direction-bits", "12"},
                                                             {"--effects", "all"},
                                                             {"--effects", "none"},
                                                             {"--engine", "ray32"},
                                                             {"--engine", "ray64"},
                                                             {"--engine", "wide"},
                                                             {"--eye", "-20,-30,40"},
                                                             {"--format", "oct"},
                                                             {"--fov", "50"},
                                                             {"--frame", "0"},
                                                             {"--ground", "on"},
                                                             {"--hits", "@h.csv"},
                                                             {"--max-depth", "3"},
                                                             {"--memory", "8M"},
                                                             {"--name", "n"},
                                                             {"--normals", "smooth"},
                                                             {"--part", "0:1"},
                                                             {"--projection", "orthographic"},
                                                             {"--projection", "perspective"},
                                                             {"--quiet", ""},
                                                             {"--rows", "2:4"},
                                                             {"--samples", "4"},
                                                             {"--samples", "auto"},
                                                             {"--shade", "color"},
                                                             {"--shade", "depth"},
                                                             {"--size", "24x18"},
                                                             {"--span", "40"},
                                                             {"--stats", "@s.json"},
                                                             {"--structure", "dense"},
                                                             {"--structure", "pool"},
                                                             {"--target", "10,10,10"},
                                                             {"--threads", "2"},
                                                             {"--tilt", "10"},
                                                             {"--turn", "20"},
                                                             {"--turntable", "2"},
                                                             {"--up", "0,1,0"},
                                                             {"--verbose", ""},
                                                             {"--view", "front"},
                                                             {"--z-up", ""}};
  return table;
}

// What only a look at the scene, the rays or the budget tells: status 1.
bool depends_on_input(const std::string& text) {
  for (const char* phrase : {"is for point files", "is for .vox files", "parallel to the direction of view",
                             "no room for", "does not take this ray", "more than", "budget", "--memory"}) {
    if (text.find(phrase) != std::string::npos) {
      return true;
    }
  }
  return false;
}

// The long names of a command's options.
std::set<std::string> options_of(const std::string& command) {
  std::set<std::string> names;
  for (const std::string& line : lines_of(run_command({command, "--help"}).out)) {
    const std::size_t at = line.find_first_not_of(' ');
    if (at != 2 || line[at] != '-') {
      continue;
    }
    const std::size_t name = line.find("--");
    if (name != std::string::npos && name < 8) {
      names.insert(line.substr(name, line.find_first_of(" ,=[", name) - name));
    }
  }
  for (const char* const left_out : {"--help", "--output", "--rays"}) {
    names.erase(left_out);
  }
  return names;
}

struct Command {
  std::string name;
  Words base;  // with what it must have
};

}  // namespace

TEST_CASE("command: every two options together -> done, or wrong usage with a sentence; nothing else") {
  const TemporaryFolder folder;
  folder.write("path.csv", "ex,ey,ez,tx,ty,tz\n-20,-20,40,8,8,8\n-10,-20,40,8,8,8\n");
  folder.write("rays.csv", "-5,3,3,1,0,0\n-5,3.5,3.5,1,0.1,0\n");
  const std::vector<Command> commands{
      {"render", {"render", "spheres,depth=4", "-o", folder.path("o.png")}},
      {"bake", {"bake", "spheres,depth=4", "-o", folder.path("o.oct")}},
      {"trace", {"trace", "spheres,depth=4", "--rays", folder.path("rays.csv"), "-o", folder.path("t.csv")}},
      {"info", {"info", "spheres,depth=4"}},
      {"memory", {"memory", "spheres,depth=4"}},
      {"effects", {"effects", "spheres,depth=4"}}};
#ifdef __SANITIZE_ADDRESS__
  constexpr std::size_t kEach = 23;
#else
  constexpr std::size_t kEach = 1;
#endif
  std::size_t number = 0;
  std::map<int, int> counts;
  for (const Command& command : commands) {
    std::vector<Words> options;
    const std::set<std::string> named = options_of(command.name);
    for (const std::string& name : named) {
      CAPTURE(name);
      const auto [begin, end] = values().equal_range(name);
      CHECK(begin != end);  // a new option wants a value above
      for (auto one = begin; one != end; ++one) {
        Words words{name};
        if (!one->second.empty()) {
          words.push_back(one->second[0] == '@' ? folder.path(one->second.substr(1)) : one->second);
        }
        options.push_back(words);
      }
    }
    CHECK(options.size() >= 8);
    for (std::size_t i = 0; i < options.size(); ++i) {
      for (std::size_t j = i + 1; j < options.size(); ++j) {
        if (options[i][0] == options[j][0] || ++number % kEach != 0) {
          continue;
        }
        Words words = command.base;
        words.insert(words.end(), options[i].begin(), options[i].end());
        words.insert(words.end(), options[j].begin(), options[j].end());
        // What draws, draws little.
        const auto add = [&](const char* name, const char* value) {
          if (named.count(name) != 0 && options[i][0] != name && options[j][0] != name) {
            words.insert(words.end(), {name, value});
          }
        };
        add("--size", "24x18");
        add("--frames", "1");
        const CommandResult result = run_command(words);
        INFO(options[i][0] << " " << options[j][0]);
        INFO(result.describe());
        ++counts[result.status];
        CHECK((result.status == 0 || result.status == 1 || result.status == 2));
        if (result.status != 0) {
          CHECK(is_one_sentence(result.err));
        }
        if (result.status == 1) {
          CHECK(depends_on_input(result.err));
        }
        if (result.status == 2) {
          CHECK((result.err.find(options[i][0]) != std::string::npos ||
                 result.err.find(options[j][0]) != std::string::npos));
        }
      }
    }
  }
  CHECK(counts[0] > 5 * counts[1]);
  CHECK(counts[2] > 0);
}

}  // namespace thimble::tests
