// Every two options of a command together: what cannot be meant is wrong usage, status 2 and a sentence, never
// anything else; what depends on the scene or on a budget is status 1.
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/counts.h"

namespace thimble::tests {
namespace {

// A value, or several, for each option that takes one; "" for those that take none. Files go into the test's folder.
const std::multimap<std::string, std::string>& values() {
  static const std::multimap<std::string, std::string> table{{"--as-heights", ""},
                                                             {"--as-points", ""},
                                                             {"--as-voxels", ""},
                                                             {"--against", "visits"},
                                                             {"--app", "dig"},
                                                             {"--bench", "2"},
                                                             {"--bodies", "@bodies.txt"},
                                                             {"--bounciness", "0.5"},
                                                             {"--check", "@ref.png"},
                                                             {"--colors", "255"},
                                                             {"--count", "4"},
                                                             {"--display", "none"},
                                                             {"--display", "terminal"},
                                                             {"--eps", "50"},
                                                             {"--field", "@f.pbm"},
                                                             {"--figures", ""},
                                                             {"--for-error", "0.5"},
                                                             {"--for-ms", "5"},
                                                             {"--fps", "20"},
                                                             {"--gravity", "0,0.01"},
                                                             {"--hard-cases", ""},
                                                             {"--hold", "5"},
                                                             {"--input", "@input.txt"},
                                                             {"--keys", "@keys.txt"},
                                                             {"--max-size", "8"},
                                                             {"--min-size", "3"},
                                                             {"--points", "1,10"},
                                                             {"--rays", "500"},
                                                             {"--record", "@r.y4m"},
                                                             {"--record-input", "@ri.txt"},
                                                             {"--rounds", "1"},
                                                             {"--scale", "2"},
                                                             {"--scene", "cluster"},
                                                             {"--seed", "3"},
                                                             {"--shot", "@shot.png"},
                                                             {"--simulation", "water"},
                                                             {"--speed", "0.1"},
                                                             {"--state", "@state.csv"},
                                                             {"--steps", "3"},
                                                             {"--subpixel-bits", "12"},
                                                             {"--substeps", "2"},
                                                             {"--theme", "plain"},
                                                             {"--background", "ff0000"},
                                                             {"--background", "none"},
                                                             {"--board", "microbit"},
                                                             {"--brick-map", ""},
                                                             {"--budget-sweep", ""},
                                                             {"--csv", "@t.csv"},
                                                             {"--json", "@t.json"},
                                                             {"--plot", "@t.svg"},
                                                             {"--frames", "1"},
                                                             {"--frames", "0:1"},
                                                             {"--bounces", "2"},
                                                             {"--camera-path", "@path.csv"},
                                                             {"--clip", "0,0,0,9,9,9"},
                                                             {"--coarsen", ""},
                                                             {"--cutoff", "3"},
                                                             {"--depth", "4"},
                                                             {"--depth-image", "@d.pfm"},
                                                             {"--direction-bits", "12"},
                                                             {"--effects", "all"},
                                                             {"--effects", "none"},
                                                             {"--engine", "gpu"},
                                                             {"--engine", "ray32"},
                                                             {"--engine", "ray64"},
                                                             {"--engine", "wide"},
                                                             {"--eye", "-20,-30,40"},
                                                             {"--format", "oct"},
                                                             {"--fit", "100"},
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
                                                             {"--seconds", "0.1"},
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
  for (const char* phrase :
       {"for point files", "is for meshes", "are for .npy and .npz", "are for .vox files",
        "parallel to the direction of view", "no room for", "does not take this ray", "more than", "budget",
        "--memory", "there is no terminal", "the terminal cannot show", "pixels differ",
        "does not take the rays"}) {
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
  for (const char* const left_out : {"--help", "--output"}) {
    names.erase(left_out);
  }
  if (command == "trace") {
    names.erase("--rays");  // its input
  }
  return names;
}

struct Command {
  std::string name;
  Words base;             // with what it must have
  std::size_t every = 1;  // one pair of so many, where a run takes long
};

const std::size_t kEach = thimble::tests::many_or_few<std::size_t>(1, 23);

// Each pair of options, or each every-th: what came of it, counted by status.
std::map<int, int> try_pairs(const TemporaryFolder& folder, const Command& command) {
  std::size_t number = 0;
  std::map<int, int> counts;
  std::vector<Words> options;
  const std::set<std::string> named = options_of(command.name);
  for (const std::string& name : named) {
    CAPTURE(name);
    const auto [begin, end] = values().equal_range(name);
    CHECK(begin != end);  // a new option wants a value above
    for (auto one = begin; one != end; ++one) {
      Words words{name};
      if (name == "--size" && command.name == "particles") {
        words.emplace_back("500x400");  // cells, in which all balls find room
      } else if (!one->second.empty()) {
        words.push_back(one->second[0] == '@' ? folder.path(one->second.substr(1)) : one->second);
      }
      options.push_back(words);
    }
  }
  CHECK(options.size() >= 7);
  for (std::size_t i = 0; i < options.size(); ++i) {
    for (std::size_t j = i + 1; j < options.size(); ++j) {
      if (options[i][0] == options[j][0] || ++number % (kEach * command.every) != 0) {
        continue;
      }
      Words words = command.base + options[i] + options[j];
      // What draws, draws little, and nowhere but here.
      const auto add = [&](const char* name, const char* value) {
        if (named.count(name) != 0 && options[i][0] != name && options[j][0] != name) {
          words.insert(words.end(), {name, value});
        }
      };
      if (command.name != "particles") {
        add("--size", "24x18");
      }
      if (command.name != "view") {
        add("--display", "none");
      }
      add("--bench", "2");
      if (command.name != "render") {
        add("--frames", "1");
      }
      add("--steps", "2");
      add("--points", "1");
      add("--rounds", "1");
      const CommandResult result = run_command(words);
      INFO(command.name << " " << options[i][0] << " " << options[j][0]);
      INFO(result.describe());
      ++counts[result.status];
      CHECK((result.status == 0 || result.status == 1 || result.status == 2));
      if (result.status == 1) {
        // What went well before it, a summary say, may stand in front.
        CHECK(is_one_sentence(lines_of(result.err).back() + "\n"));
        CHECK(depends_on_input(result.err));
      }
      if (result.status == 2) {
        CHECK(is_one_sentence(result.err));
        CHECK((result.err.find(options[i][0]) != std::string::npos ||
               result.err.find(options[j][0]) != std::string::npos));
      }
    }
  }
  return counts;
}

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
  std::map<int, int> counts;
  for (const Command& command : commands) {
    for (const auto& [status, count] : try_pairs(folder, command)) {
      counts[status] += count;
    }
  }
  CHECK(counts[0] > 5 * counts[1]);
  CHECK(counts[2] > 0);
}

TEST_CASE(
    "command: every two options of what shows, plays and measures -> done, or wrong usage with a sentence") {
  const TemporaryFolder folder;
  folder.write("bodies.txt", "2\n100\n-20 5 0 0 1 255 0 0\n20 5 0 0 1 0 0 255\n");
  folder.write("input.txt", "1: move 10,10\n");
  folder.write("keys.txt", "1: down right\n2: up right\n");
  check_done(
      {"sim", "spheres,depth=4", "--display", "none", "--frames", "1", "--shot", folder.path("ref.png")});
  const std::vector<Command> commands{{"sim", {"sim", "spheres,depth=4"}},
                                      {"particles", {"particles"}},
                                      {"table", {"table"}},
                                      {"accuracy", {"accuracy", "spheres,depth=4"}, 2},
                                      {"view", {"view", "spheres,depth=4"}},
                                      {"boards", {"boards", "spheres,depth=4"}, 4}};
  for (const Command& command : commands) {
    CAPTURE(command.name);
    std::map<int, int> counts = try_pairs(folder, command);
    MESSAGE(command.name << ": " << counts[0] << " done, " << counts[1] << " by the input, " << counts[2]
                         << " wrong usage");
    if (kEach == 1) {
      CHECK(counts[0] > counts[1]);
    }
  }
}

TEST_CASE("command: join with the one option that it has -> done; without parts, wrong usage") {
  const TemporaryFolder folder;
  for (const char* const rows : {"0:9", "9:9"}) {
    check_done({"render", "spheres,depth=4", "--size", "24x18", "--rows", rows, "-o",
                folder.path(std::string(1, rows[0]) + ".part")});
  }
  CHECK(options_of("join") == std::set<std::string>{"--quiet"});
  check_done({"join", folder.path("0.part"), folder.path("9.part"), "-o", folder.path("j.png"), "--quiet"});
  for (const Words& words : {Words{"join", "--quiet"}, Words{"join", "--quiet", "-o", folder.path("k.png")},
                             Words{"join", "--quiet", folder.path("0.part"), folder.path("9.part")}}) {
    check_refused(words, 2, {});
  }
}

TEST_CASE("command: what a generator can never take -> wrong usage by every command that takes scenes") {
  const TemporaryFolder folder;
  const std::vector<Words> commands{{"render", "-o", folder.path("o.png")},
                                    {"bake", "-o", folder.path("o.oct")},
                                    {"info"},
                                    {"memory"},
                                    {"effects"},
                                    {"accuracy"},
                                    {"boards"},
                                    {"sim", "--display", "none", "--frames", "1"},
                                    {"view", "--bench", "1"}};
  for (Words words : commands) {
    words.insert(words.begin() + 1, "spheres,depth=4");
    for (const Words& option : {Words{"--as-voxels"}, Words{"--z-up"}, Words{"--frame", "1"}}) {
      check_refused(words + option, 2, {option[0]});
    }
  }
}

}  // namespace thimble::tests
