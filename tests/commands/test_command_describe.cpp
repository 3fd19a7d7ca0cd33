// What the command says of itself: its version, its manual page, what a shell completes; and scenes by their names.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/check_command.h"

namespace {

using namespace thimble::tests;

// What the last of these words may become, without meanings.
Words completed(const Words& words) {
  std::string line = "thimble";
  for (const std::string& word : words) {
    line += "\n" + word;
  }
  const CommandResult result = check_done({"complete", line});
  CHECK(result.err.empty());
  Words out;
  for (const std::string& each : lines_of(result.out)) {
    out.push_back(each.substr(0, each.find('\t')));
  }
  return out;
}

bool holds(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// The subcommands that --help names.
Words subcommands() {
  Words names;
  bool inside = false;
  for (const std::string& line : lines_of(run_command({"--help"}).out)) {
    inside = inside || line == "Subcommands:";
    if (inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return names;
}

// The long options that the help of a subcommand names.
Words options_of(const std::string& command) {
  Words names;
  for (const std::string& line : lines_of(run_command({command, "--help"}).out)) {
    const std::size_t at = line.find("--");
    if (line.starts_with("  -") && at != std::string::npos) {
      names.push_back(line.substr(at, line.find_first_of(" ,", at) - at));
    }
  }
  return names;
}

// A manual without what roff needs.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '-') {
      continue;
    }
    if (text.compare(i, 2, "\\f") == 0) {
      i += 2;
      continue;
    }
    out += text[i];
  }
  return out;
}

}  // namespace

TEST_CASE("command: --version -> version, commit, instruction sets, GPU, windows") {
  const CommandResult result = run_command({"--version"});
  CHECK(result.status == 0);
  CHECK(result.err.empty());
  const Words lines = lines_of(result.out);
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].starts_with("thimble 0."));
  REQUIRE(lines[1].starts_with("commit         "));
  const std::string commit = lines[1].substr(15);
  CAPTURE(commit);
  CHECK((commit == "unknown" ||
         (commit.size() >= 12 && commit.find_first_not_of("0123456789abcdef") == std::string::npos)));
  CHECK(lines[2].starts_with("wide renderer  "));
  CHECK(lines[2].find(" on this machine") != std::string::npos);
  CHECK(lines[3].starts_with("GPU            "));
  CHECK(lines[4] == "windows        X11");
}

TEST_CASE("command: the manual -> every subcommand and option of --help, no empty name") {
  const CommandResult result = run_command({"manual"});
  REQUIRE(result.status == 0);
  const std::string text = unescaped(result.out);
  CHECK(text.starts_with(".TH THIMBLE 1 "));
  const Words names = subcommands();
  REQUIRE(names.size() >= 11);
  for (const std::string& name : names) {
    CAPTURE(name);
    const std::size_t section = text.find("\n.SS thimble " + name);
    REQUIRE(section != std::string::npos);
    const std::size_t end = std::min(text.find("\n.S", section + 4), text.size());
    const Words options = options_of(name);
    CHECK(options.size() >= 2);
    for (const std::string& option : options) {
      CAPTURE(option);
      CHECK((option == "--help" || text.find(option, section) < end));
    }
  }
  // What shells and scripts call is nothing for a person.
  CHECK(text.find("\n.SS thimble complete") == std::string::npos);
  CHECK(run_command({"--help"}).out.find("complete ") == std::string::npos);
}

TEST_CASE("command: completion -> every subcommand and option of --help, and values where a value is due") {
  const Words names = subcommands();
  const Words first = completed({""});
  CHECK(holds(completed({"rend"}), "render"));
  CHECK_FALSE(holds(completed({"rend"}), "trace"));
  CHECK(holds(completed({"--"}), "--version"));
  for (const std::string& name : names) {
    CAPTURE(name);
    CHECK(holds(first, name));
    const Words offered = completed({name, "--"});
    for (const std::string& option : options_of(name)) {
      CAPTURE(option);
      CHECK(holds(offered, option));
    }
  }
  CHECK(completed({"render", "castle", "--sha"}) == Words{"--shade"});
  CHECK(completed({"render", "--shade", "col"}) == Words{"color"});
  CHECK(completed({"render", "--shade=col"}) == Words{"--shade=color"});
  CHECK(completed({"render", "--shade", "=", "col"}) == Words{"color"});  // as bash cuts it
  CHECK(completed({"render", "--shade", "="}) == completed({"render", "--shade", ""}));
  CHECK(holds(completed({"sim", "--board", ""}), "microbit"));
  CHECK(completed({"sim", "--board", "micro"}) == Words{"microbit"});
  CHECK(completed({"render", "--effects", "shadows,sk"}) == Words{"shadows,sky"});
  CHECK(completed({"render", "--effects=shadows,sk"}) == Words{"--effects=shadows,sky"});
  CHECK(completed({"render", "--effects", "no"}) == Words{"none"});
  CHECK(completed({"render", "cas"}) == Words{"castle", "/files"});
  CHECK(holds(completed({"info", ""}), "spheres"));
  CHECK(completed({"render", "castle", "-o", ""}) == Words{"/files"});
  CHECK(completed({"render", "castle", "--size", ""}).empty());
  CHECK(completed({"render", "castle", "--quiet", ""}).size() > 1);  // a flag takes no value
  CHECK_FALSE(holds(completed({"render", "--quiet", "--"}), "--quiet"));
  CHECK(completed({"paint", "--"}) == completed({"--"}));
  check_done({"complete", ""});
  check_done({"complete", "\n\n\n="});
  check_refused({"complete"}, 2, {"words is required"});
}

TEST_CASE("command: a scene by its name -> the one that comes along, unless a file has that name") {
  const TemporaryFolder folder;
  CommandLimits here;
  here.directory = folder.path();
  for (const char* name : {"castle", "fox", "house", "lagoon", "ship"}) {
    CAPTURE(name);
    const CommandResult result = check_done({"info", name}, here);
    CHECK(result.out.find("compact tree         sound") != std::string::npos);
  }
  check_refused({"info", "castel"}, 1, {"castel: ", "castle, ", "fox, ", "house, ", "lagoon, ", "ship"});
  check_refused({"info", "castle.scene"}, 1, {"castle.scene: ", "No such file"});
  check_refused({"info", "./castle"}, 1, {"./castle: ", "No such file"});
  folder.write("castle", "ply\n");
  const CommandResult own = run_command({"info", "castle"}, here);
  CHECK(own.status == 1);
  CHECK(own.err.starts_with("thimble: castle: "));
  CHECK(own.err.find("scene of that name") == std::string::npos);
}

TEST_CASE("command: the scenes that come along -> under 300 KB together") {
  const std::filesystem::path build = std::filesystem::path(THIMBLE_COMMAND_PATH).parent_path();
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(build / "scenes")) {
    bytes += entry.file_size();
  }
  CHECK(bytes > 100000);
  CHECK(bytes < 300000);
}

TEST_CASE(
    "command: uart-picture -> the first whole picture among a board's lines, and sentences without one") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& log, const std::string& why) {
    check_refused({"uart-picture", folder.write("log", log), "-o", folder.path("no.pgm")}, 1, {"log: ", why});
    CHECK(folder.names() == Words{"log"});
  };
  refused("frame 1 crc 12345678\n", "no picture");
  refused("P5\n2 2\n255\nabc", "not whole");
  refused("P6\n2 1\n255\nabcde", "not whole");
  refused("P5\n2 2\n254\nabcd", "no picture");
  refused("P5\n99999999999 2\n255\nabcd", "no picture");
  refused("P5\n0 2\n255\n", "no picture");
  refused("P5\n2", "no picture");
  refused("xP5\n2 1\n255\nab", "no picture");
  const std::string log =
      folder.write("log", "demo on microbit\nP5\n3 1\n255\nP5\nP5\n2 2\n255\nabcd\nmore\n");
  check_done({"uart-picture", log, "-o", folder.path("a.pgm")});
  CHECK(read_text(folder.path("a.pgm")) == "P5\n3 1\n255\nP5\n");
  // In colour: red, then blue.
  const std::string colors = "P6\n2 1\n255\n" + std::string("\xFF\x00\x00\x00\x00\xFF", 6);
  check_done(
      {"uart-picture", folder.write("log", "frame 1\n" + colors + "\nP5\n"), "-o", folder.path("a.ppm")});
  CHECK(read_text(folder.path("a.ppm")) == colors);
  check_refused({"uart-picture", log, "-o", "x.bmp"}, 2, {"--output", ".png"});
  check_refused({"uart-picture", folder.path("none"), "-o", "x.png"}, 1, {"No such file"});
}
