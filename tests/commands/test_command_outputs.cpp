// Outputs of the command: never over what it reads, never over one another, all there or none, whatever the names.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/counts.h"

namespace {

namespace fs = std::filesystem;
using namespace thimble::tests;

// A script in the folder, with the command as $T.
CommandResult shell(const TemporaryFolder& folder, const std::string& script) {
  CommandLimits limits;
  limits.program = "/bin/sh";
  limits.directory = folder.path();
  return run_command({"-c", "T='" THIMBLE_COMMAND_PATH "'; " + script}, limits);
}

constexpr const char* kRays = "0,0,0,1,1,1\n";
constexpr const char* kPoints = "0 0 0\n1 2 3\n5 5 5\n";

// A triangle whose points lie in box.bin and whose colours in texture.png.
std::string triangle_gltf() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"textures":[{"source":0}],"images":[{"uri":"texture.png"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
"buffers":[{"uri":"box.bin","byteLength":60}]})";
}

void write_triangle(const TemporaryFolder& folder) {
  folder.write("box.gltf", triangle_gltf());
  std::string bytes;
  for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F}) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  folder.write("box.bin", bytes);
  check_done({"render", "spheres", "--size", "4x4", "--quiet", "-o", folder.path("texture.png")});
}

}  // namespace

TEST_CASE(
    "outputs: what a reader opens, by any of its names -> refused before it is replaced, by every option") {
  const TemporaryFolder folder;
  write_triangle(folder);
  folder.write("points.xyz", kPoints);
  folder.write("rays.csv", kRays);
  folder.write("inner.scene", "model points.xyz\n");
  folder.write("castle.scene", "model castle.oct\nmodel inner.scene at 70 0 0\n");
  CommandLimits here;
  here.directory = folder.path();
  check_done({"bake", "spheres", "-o", "castle.oct", "--quiet"}, here);
  folder.write("path.csv", "-9,-9,9,0,0,0\n-9,-8,9,0,0,0\n");
  folder.write("keys.txt", "0: end\n");
  folder.write("bodies.txt", "1\n100\n0 0 0 0 1 255 0 0\n");
  folder.write("log", "P5\n1 1\n255\nx");
  check_done({"render", "spheres", "--size", "8x8", "--rows", "0:8", "-o", "a.part", "--quiet"}, here);
  const Words small{"--size", "16x12", "--quiet"};
  struct Line {
    Words words;  // but for the output, which follows
    std::string ending;
    Words inputs;
  };
  std::vector<Line> lines;
  const Words gltf{"box.bin", "texture.png", "box.gltf"};
  const Words scene{"castle.oct", "points.xyz", "inner.scene", "castle.scene"};
  for (const auto& [file, inputs] :
       {std::pair{std::string("box.gltf"), gltf}, std::pair{std::string("castle.scene"), scene}}) {
    const Words render = Words{"render", file} + small;
    lines.push_back({render + Words{"-o"}, ".png", inputs});
    lines.push_back({Words{"render", file, "--quiet", "--size", "16x12", "--turntable", "2"} + Words{"-o"},
                     ".gif", inputs});
    for (const char* option : {"--hits", "--depth-image", "--stats"}) {
      lines.push_back({render + Words{"-o", "p.png", option}, ".x", inputs});
    }
    lines.push_back({{"bake", file, "--quiet", "-o"}, ".oct", inputs});
    lines.push_back({{"bake", file, "--quiet", "-o", "p.h", "--stats"}, ".x", inputs});
    lines.push_back({{"info", file, "--stats"}, ".x", inputs});
    lines.push_back(
        {{"trace", file, "--quiet", "--rays", "rays.csv", "-o"}, ".x", inputs + Words{"rays.csv"}});
    lines.push_back({{"trace", file, "--quiet", "--rays", "rays.csv", "--stats"}, ".x", inputs});
    lines.push_back({{"sim", file, "--quiet", "--display", "none", "--shot"}, ".png", inputs});
    lines.push_back({{"sim", file, "--quiet", "--display", "none", "--record"}, ".y4m", inputs});
    lines.push_back({{"sim", file, "--quiet", "--display", "none", "--stats"}, ".x", inputs});
    for (const char* option : {"--csv", "--json"}) {
      lines.push_back({{"boards", file, "--quiet", option}, ".x", inputs});
    }
    for (const char* study : {"memory", "accuracy", "effects"}) {
      for (const auto& [option, ending] :
           {std::pair{"--csv", ".x"}, std::pair{"--json", ".x"}, std::pair{"--plot", ".svg"}}) {
        lines.push_back({{study, file, "--quiet", "--size", "16x12", option}, ending, inputs});
      }
    }
  }
  lines.push_back(
      {Words{"render", "spheres", "--camera-path", "path.csv"} + small + Words{"-o"}, ".gif", {"path.csv"}});
  lines.push_back({{"join", "a.part", "-o"}, ".png", {"a.part"}});
  lines.push_back({{"uart-picture", "log", "-o"}, ".pgm", {"log"}});
  for (const auto& [option, ending] : {std::pair{"--state", ".csv"}, std::pair{"-o", ".png"},
                                       std::pair{"--stats", ".x"}, std::pair{"--record-input", ".x"}}) {
    lines.push_back(
        {{"particles", "--quiet", "--steps", "1", "--bodies", "bodies.txt", "--input", "keys.txt", option},
         ending,
         {"bodies.txt", "keys.txt"}});
  }
  const Words before = folder.names();
  std::size_t turn = 0;
  const auto check_kept = [&](const Line& line, const std::string& input) {
    CAPTURE(line_of_words(line.words));
    CAPTURE(input);
    const std::string bytes = read_text(folder.path(input));
    const std::string name = "out" + line.ending;
    if (turn++ % 2 == 0) {
      fs::create_hard_link(folder.path(input), folder.path(name));
    } else {
      fs::create_symlink(input, folder.path(name));
    }
    check_refused(line.words + Words{name}, 1, {name + ": is an input and would be overwritten"}, here);
    CHECK(read_text(folder.path(input)) == bytes);
    fs::remove(folder.path(name));
    CHECK(folder.names() == before);
  };
  // What a reader opens is one list for all of a command's outputs: each output keeps one of the files, by turns, and the
  // first of each scene's, all of them.
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool all = i == 0 || lines[i].words[1] != lines[i - 1].words[1];
    for (std::size_t input = 0; input < lines[i].inputs.size(); ++input) {
      if (all || input == i % lines[i].inputs.size()) {
        check_kept(lines[i], lines[i].inputs[input]);
      }
    }
  }
  // By its own name, too; and standard output may be behind a file that is read.
  check_refused({"render", folder.path("box.gltf"), "-o", folder.path("texture.png")}, 1,
                {"texture.png", "input"});
  check_refused(
      {"render", folder.path("box.gltf"), "-o", folder.path("p.png"), "--stats", folder.path("box.bin")}, 1,
      {"box.bin", "input"});
  const CommandResult appended =
      shell(folder, "$T render castle.scene --size 4x3 --quiet -o - >> points.xyz");
  CHECK(appended.status == 1);
  CHECK(read_text(folder.path("points.xyz")) == kPoints);
}

TEST_CASE(
    "outputs: a name that leads to an open descriptor -> written to, behind what is there, never replaced") {
  const TemporaryFolder folder;
  folder.write("rays.csv", kRays);
  fs::create_symlink("/dev/stdout", folder.path("away"));
  const std::string trace = "$T trace spheres --quiet --rays rays.csv -o ";
  const std::string rows =
      run_command({"trace", "spheres", "--quiet", "--rays", folder.path("rays.csv")}).out;
  REQUIRE(!rows.empty());
  for (const char* const line :
       {"/dev/stdout >>log", "/dev/fd/1 >>log", "/proc/self/fd/1 >>log", "/proc/thread-self/fd/1 >>log",
        "away >>log", "./away >>log", "/dev/stderr 2>>log", "/dev/fd/3 3>>log", "/proc/self/fd/7 7>>log",
        "/proc/$$/fd/8 8>>log", "/dev/../dev/fd/9 9>>log"}) {
    CAPTURE(line);
    const std::string log = folder.write("log", "old\n");
    fs::create_hard_link(log, folder.path("same"));
    const CommandResult result = shell(folder, "exec 8>>log; " + trace + line);
    CHECK_MESSAGE(result.status == 0, result.describe());
    CHECK(read_text(log) == "old\n" + rows);
    CHECK(read_text(folder.path("same")) == "old\n" + rows);
    fs::remove(folder.path("same"));
  }
  // Every option that writes, and no table between data.
  for (const char* const line :
       {"render spheres --quiet --size 8x8 -o p.ppm --hits F",
        "render spheres --quiet --size 8x8 -o p.ppm --stats F",
        "render spheres --quiet --size 8x8 -o p.ppm --depth-image F",
        "bake spheres --quiet -o b.oct --stats F", "info spheres --stats F",
        "sim --quiet --display none --frames 1 --stats F", "boards spheres --quiet --csv F",
        "memory spheres --quiet --depth 4 --size 16x12 --csv F", "table --quiet --points 1 --json F",
        "particles --quiet --steps 1 --state F", "particles --quiet --steps 1 --stats F"}) {
    if (kSanitized && std::string(line).find("render") == std::string::npos) {
      continue;
    }
    CAPTURE(line);
    const std::string log = folder.write("log", "old\n");
    const std::string words = line;
    const std::string to = words.substr(0, words.size() - 1);
    const CommandResult result = shell(folder, "$T " + to + "/dev/fd/3 3>>log");
    CHECK_MESSAGE(result.status == 0, result.describe());
    CHECK(read_text(log).starts_with("old\n"));
    CHECK(read_text(log).size() > 10);
  }
  const CommandResult json = shell(folder, "$T table --quiet --points 1 --json /dev/stdout");
  CHECK_MESSAGE(json.out.starts_with("["), json.out);
  CHECK(run_command({"table", "--quiet", "--points", "1", "--json", "-"}).out.starts_with("["));
  // What is not open, or only to be read, or one that the command opened for itself.
  for (const char* const line : {"/dev/fd/9", "/dev/fd/9 9</dev/null"}) {
    const CommandResult result = shell(folder, trace + line);
    CHECK_MESSAGE(result.status == 1, result.describe());
  }
  fs::remove(folder.path("log"));
  fs::remove(folder.path("p.ppm"));
  for (const char* const own : {"/dev/fd/3", "/dev/fd/4", "/dev/fd/5"}) {
    const CommandResult result = shell(
        folder,
        std::string("exec 3>&- 4>&- 5>&-; $T render spheres --quiet --size 8x8 -o p.ppm --stats ") + own);
    CHECK_MESSAGE(result.status == 1, result.describe());
    CHECK(!fs::exists(folder.path("p.ppm")));
  }
}

TEST_CASE(
    "outputs: one file spelled in two ways, whether or not it is there yet -> refused, nothing written") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path("dir"));
  fs::create_directory_symlink("dir", folder.path("way"));
  fs::create_symlink("a.ppm", folder.path("leads"));
  fs::create_symlink("leads", folder.path("further.ppm"));
  fs::create_symlink("dir/../a.ppm", folder.path("dir/../round"));
  const Words before = folder.names();
  CommandLimits here;
  here.directory = folder.path();
  const std::string absolute = folder.path("a.ppm");
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"a.ppm", "a.ppm"},         {"a.ppm", "./a.ppm"},       {"./a.ppm", "a.ppm"},
      {"a.ppm", absolute},        {"dir/../a.ppm", "a.ppm"},  {"a.ppm", "leads"},
      {"further.ppm", "./a.ppm"}, {"further.ppm", "leads"},   {"a.ppm", "round"},
      {"a.ppm", "way/../a.ppm"},  {"dir/b.ppm", "way/b.ppm"}, {"a.ppm", ".//a.ppm"}};
  for (const auto& [each_first, each_second] : pairs) {
    const auto& first = each_first;
    const auto& second = each_second;
    CAPTURE(first);
    CAPTURE(second);
    for (const char* option : {"--hits", "--depth-image", "--stats"}) {
      check_refused({"render", "spheres", "--quiet", "--size", "8x8", "-o", first, option, second}, 1,
                    {"two outputs cannot share it"}, here);
      CHECK(folder.names() == before);
    }
  }
  // Standard output has several names, too; and the file behind it is one.
  for (const char* const line : {"-o - --stats /dev/stdout", "-o - --hits /dev/fd/1", "-o - --stats log >log",
                                 "-o - --stats /dev/stderr 2>&1", "-o - --stats /dev/fd/3 3>&1"}) {
    CAPTURE(line);
    const CommandResult result = shell(folder, std::string("$T render spheres --quiet --size 8x8 ") + line);
    CHECK_MESSAGE(result.status == 1, result.describe());
    CHECK((result.err + result.out).find("two outputs cannot share it") != std::string::npos);
  }
  // Different ones that look alike, and a device as often as one likes.
  for (const auto& [first, second] : {std::pair{"a.ppm", "dir/a.ppm"}, std::pair{"b.ppm", "way/b.ppm"},
                                      std::pair{"/dev/null", "/dev/null"}}) {
    check_done({"trace", "spheres", "--quiet", "--rays", folder.write("rays.csv", kRays), "-o", first,
                "--stats", second},
               here);
  }
}

TEST_CASE(
    "outputs: a second that cannot take its name -> the first is as it was, and nothing hidden is left") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path("d"));
  // The command waits for its rays; meanwhile a folder takes the place of its last output.
  const auto run = [&](const std::string& before, const std::vector<RefusedCall>& refused) {
    CommandLimits limits;
    limits.program = "/bin/sh";
    limits.directory = folder.path("d");
    limits.refused = refused;
    return run_command(
        {"-c", "rm -rf ./* ./.t*; " + before +
                   "; mkfifo rays; " THIMBLE_COMMAND_PATH
                   " trace spheres --rays rays -o out.csv --stats stats.json --quiet & child=$!; "
                   "exec 3>rays; rm -f stats.json; mkdir stats.json; printf '0,0,0,1,1,1\\n' >&3; "
                   "exec 3>&-; wait $child; status=$?; rm rays; exit $status"},
        limits);
  };
  const auto names = [&] {
    Words all;
    for (const auto& entry : fs::directory_iterator(folder.path("d"))) {
      all.push_back(entry.path().filename().string());
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  const RefusedCall no_links{SYS_link, EPERM};
  const RefusedCall no_nameless{SYS_openat, EOPNOTSUPP, 2, O_TMPFILE & ~O_DIRECTORY};
  for (const std::vector<RefusedCall>& refused :
       {std::vector<RefusedCall>{}, {no_links}, {no_nameless}, {no_links, no_nameless}}) {
    CAPTURE(refused.size());
    const CommandResult fresh = run(":", refused);
    CHECK_MESSAGE(fresh.status == 1, fresh.describe());
    CHECK(fresh.err.find("stats.json: cannot be written: Is a directory") != std::string::npos);
    CHECK(names() == Words{"stats.json"});
    const CommandResult again = run("printf old >out.csv; ln out.csv same; printf old >stats.json", refused);
    CHECK_MESSAGE(again.status == 1, again.describe());
    CHECK(names() == Words{"out.csv", "same", "stats.json"});
    CHECK(read_text(folder.path("d/out.csv")) == "old");
    CHECK(fs::equivalent(folder.path("d/out.csv"), folder.path("d/same")));
  }
  // Where all can be placed nothing is left, either.
  fs::remove_all(folder.path("d"));
  fs::create_directory(folder.path("d"));
  for (const std::vector<RefusedCall>& refused :
       {std::vector<RefusedCall>{}, {no_links}, {no_nameless}, {no_links, no_nameless}}) {
    folder.write("d/p.ppm", "old");
    folder.write("d/h.csv", "old");
    CommandLimits limits;
    limits.refused = refused;
    check_done({"render", "spheres", "--quiet", "--size", "8x8", "-o", folder.path("d/p.ppm"), "--hits",
                folder.path("d/h.csv"), "--stats", folder.path("d/s.json")},
               limits);
    CHECK(names() == Words{"h.csv", "p.ppm", "s.json"});
    CHECK(read_text(folder.path("d/p.ppm")).size() > 190);
    CHECK(read_text(folder.path("d/h.csv")).size() > 190);
    fs::remove(folder.path("d/s.json"));
  }
}

TEST_CASE(
    "outputs: a name that nothing can take, for something is mounted there -> refused before any work") {
  const TemporaryFolder folder;
  folder.write("first.csv", "old");
  folder.write("second.json", "old");
  folder.write("other", "");
  // There are no rays, and nobody waits for them.
  const CommandResult result = shell(
      folder,
      "unshare -m true 2>/dev/null || exit 77; unshare -m sh -c 'mount --bind other second.json || exit "
      "77; mkfifo rays; timeout 20 '$T' trace spheres --rays rays -o first.csv --stats second.json'");
  if (result.status == 77) {
    MESSAGE("skipped: only root may mount");
    return;
  }
  CHECK_MESSAGE(result.status == 1, result.describe());
  CHECK(result.err.find("second.json: cannot be written: Device or resource busy") != std::string::npos);
  CHECK(read_text(folder.path("first.csv")) == "old");
  CHECK(folder.names() == Words{"first.csv", "other", "rays", "second.json"});
}

TEST_CASE(
    "outputs: every signal that ends the command, with and without nameless files -> nothing left behind") {
  const TemporaryFolder folder;
  const RefusedCall no_nameless{SYS_openat, EOPNOTSUPP, 2, O_TMPFILE & ~O_DIRECTORY};
  for (const std::vector<RefusedCall>& refused : {std::vector<RefusedCall>{}, {no_nameless}}) {
    for (const char* const signal : {"HUP", "INT", "QUIT", "ABRT", "ALRM", "TERM", "USR1", "USR2", "XCPU",
                                     "PROF", "VTALRM", "IO", "PWR"}) {
      CAPTURE(signal);
      CommandLimits limits;
      limits.program = "/bin/bash";
      limits.directory = folder.path();
      limits.refused = refused;
      // A shell's background job ignores INT and QUIT, unless it is one of a job control.
      const CommandResult ended = run_command(
          {"-c", std::string("set -m; mkfifo rays; " THIMBLE_COMMAND_PATH
                             " trace spheres --rays rays -o out.csv --stats s.json --quiet & child=$!; "
                             "exec 3>rays; kill -") +
                     signal + " $child; wait $child; status=$?; rm rays; exit $status"},
          limits);
      CHECK_MESSAGE(ended.status > 128, ended.describe());
      CHECK(folder.names() == Words{});
    }
  }
}

TEST_CASE(
    "outputs: no descriptors left -> said as such, everywhere that a file is opened, or the whole answer") {
  const TemporaryFolder folder;
  write_triangle(folder);
  folder.write("rays.csv", kRays);
  folder.write("points.xyz", kPoints);
  folder.write("s.scene", "model points.xyz\n");
  const std::string picture = folder.path("p.ppm");
  const auto p = [&](const std::string& name) { return folder.path(name); };
  const std::vector<Words> lines{{"info", "castle"},
                                 {"render", "castle", "--quiet", "--size", "8x6", "-o", picture},
                                 {"render", p("box.gltf"), "--quiet", "--size", "8x6", "-o", picture},
                                 {"render", p("s.scene"), "--quiet", "--size", "8x6", "-o", picture, "--hits",
                                  p("h.csv"), "--stats", p("j")},
                                 {"trace", "spheres", "--rays", p("rays.csv")},
                                 {"castle", "--bench", "1", "--size", "8x6"},
                                 {"complete", "thimble render "}};
  bool any = false;
  for (const Words& words : lines) {
    CAPTURE(words[1]);
    fs::remove(picture);
    check_done(words);
    const std::string whole = fs::exists(picture) ? read_text(picture) : "";
    for (std::uint64_t most = 3; most < 14; most += many_or_few(1U, 3U)) {
      CAPTURE(most);
      fs::remove(picture);
      CommandLimits limits;
      limits.descriptors = most;
      const CommandResult result = run_command(words, limits);
      if (result.status == 127 || result.err.find("shared libraries") != std::string::npos) {
        continue;  // nor can it be loaded
      }
      if (result.status == 0) {
        CHECK((fs::exists(picture) ? read_text(picture) : "") == whole);
      } else {
        any = true;
        CHECK_MESSAGE(result.err.find("Too many open files") != std::string::npos, result.describe());
        CHECK(!fs::exists(picture));
      }
    }
  }
  CHECK(any);  // some need more than the least with which the command can be loaded
}

// The search for leaks at an end wants a thread of its own.
#ifndef __SANITIZE_ADDRESS__
TEST_CASE("outputs: no threads -> the command draws with one, the same picture, and says nothing of it") {
  const TemporaryFolder folder;
  const std::string rays = folder.write("rays.csv", kRays);
  const std::string picture = folder.path("p.ppm");
  const Words render{"render", "spheres", "--size", "40x30", "-o", picture};
  const std::vector<Words> lines{
      render + Words{},
      render + Words{"--threads", "7"},
      render + Words{"--shade", "depth"},
      render + Words{"--engine", "wide"},
      render + Words{"--effects", "all"},
      render + Words{"--samples", "auto", "--effects", "shadows"},
      {"render", "spheres", "--size", "20x10", "--turntable", "2", "-o", folder.path("t.gif")},
      {"trace", "spheres", "--rays", rays, "-o", picture},
      {"bake", "spheres", "-o", folder.path("b.oct"), "--quiet"},
      {"info", "points:100000"},
      {"table", "--points", "10", "--quiet", "--threads", "2"},
      {"accuracy", "spheres", "--quiet", "--size", "16x12", "--rounds", "1"},
      {"particles", "--steps", "2", "--display", "none"}};
  CommandLimits limits;
  // glibc asks by clone3, and where that is not there by clone.
  limits.refused = {{SYS_clone3, ENOSYS}, {SYS_clone, EAGAIN}};
  for (const Words& words : lines) {
    CAPTURE(line_of_words(words));
    fs::remove(picture);
    const CommandResult with = check_done(words);
    const std::string whole = fs::exists(picture) ? read_text(picture) : "";
    fs::remove(picture);
    const CommandResult without = check_done(words, limits);
    CHECK((fs::exists(picture) ? read_text(picture) : "") == whole);
    CHECK(lines_of(without.err + "\n").size() == lines_of(with.err + "\n").size());
  }
  // The simulator's application has a board's stack, and the viewer draws while it listens.
  for (const Words& words : {Words{"sim", "--display", "none", "--frames", "2"},
                             Words{"spheres", "--bench", "1", "--size", "40x30"}}) {
    const CommandResult without = run_command(words, limits);
    CHECK_MESSAGE(without.status == 1, without.describe());
    CHECK(without.err.find("Resource temporarily unavailable") != std::string::npos);
  }
}
#endif

TEST_CASE("command: -- -> what follows is no option, whatever it begins with") {
  const TemporaryFolder folder;
  CommandLimits here;
  here.directory = folder.path();
  folder.write("-odd.xyz", kPoints);
  folder.write("--help", kPoints);
  const auto out = [&](const Words& words) {
    const CommandResult result = check_done(words, here);
    return result.out;
  };
  const std::string odd = out({"info", "--", "-odd.xyz"});
  CHECK(odd.starts_with("scene                -odd.xyz\n"));
  CHECK(out({"--", "info", "--", "-odd.xyz"}) == odd);
  CHECK(out({"render", "--quiet", "--size", "4x3", "-o", "-", "--", "-odd.xyz"}) ==
        out({"render", "--quiet", "--size", "4x3", "-o", "-", "./-odd.xyz"}));
  // What is shown needs a display: here there is none, and it is a scene all the same.
  const auto refused = [&](const Words& words, int status, const std::string& what) {
    const CommandResult result = run_command(words, here);
    CHECK_MESSAGE(result.status == status, result.describe());
    CHECK_MESSAGE(result.err.find(what) != std::string::npos, result.describe());
  };
  refused({"--", "-none.xyz"}, 1, "-none.xyz: cannot be opened: No such file");
  refused({"--", "none.xyz"}, 1, "none.xyz: cannot be opened: No such file");
  refused({"info", "--", "-odd.xyz", "--depth", "3"}, 2, "\"--depth\" is one argument too many");
  refused({"info", "--", "-odd.xyz", "--help"}, 2, "\"--help\" is one argument too many");
  refused({"info", "--", "--depth"}, 1, "--depth: no such file");
}
