// The command as a user meets it: exit statuses, help, sentences, and files that are whole or not there.
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/check_command.h"

namespace {

using namespace thimble::tests;

}  // namespace

TEST_CASE("command: --help -> exit 0, on standard output, what machines read named, no line wider than 100") {
  // That each option stands there is held by what reads the help: test_command_pairs.cpp, test_command_describe.cpp.
  const std::vector<std::pair<std::string, Words>> all{
      {"render", {"shadows", "depth-cue", "dense|pool|compact", "microbit", "points:N"}},
      {"trace", {"ox,oy,oz,dx,dy,dz", "hit,vx,vy,vz,t,axis,nodes,qox,qoy,qoz,qdx,qdy,qdz,material,distance"}},
      {"info", {"points:N", "dense|pool|compact"}},
      {"sim", {"BUTTON", "TEXT"}},
      {"particles", {"TICK", "asleep", "steps a second"}},
      {"bake", {".oct", ".h"}},
      {"boards", {}},
      {"memory",
       {"wrong_px", "units", "S_build_bytes", "S_frame_ms", "S_visits_per_ray", "S_boards",
        "depth_error_mean_voxels", "budget_bytes"}},
      {"effects", {"K_rays", "node_visits", "q25_ms", "ram_bytes", "flash_bytes", "lm3s6965evb"}},
      {"view", {"drag", "wheel", "double click", "Esc"}},
      {"table", {}}};
  const CommandResult top = check_done({"--help"});
  for (const auto& [each_subcommand, names] : all) {
    const auto& subcommand = each_subcommand;
    CAPTURE(subcommand);
    CHECK(top.out.find("  " + subcommand + " ") != std::string::npos);
    const CommandResult result = check_done({subcommand, "--help"});
    CHECK(result.err.empty());
    for (const std::string& name : names) {
      CAPTURE(name);
      CHECK(result.out.find(name) != std::string::npos);
    }
    for (const std::string& line : lines_of(result.out)) {
      CHECK(line.size() <= 100);
    }
  }
}

TEST_CASE("command: wrong usage -> status 2 and a sentence that quotes what is wrong") {
  check_refused({"paint"}, 2, {"\"paint\"", "neither a subcommand nor a file"});
  check_refused({"rendr"}, 2, {"\"rendr\"", "(did you mean render?)"});
  check_refused({"inof"}, 2, {"(did you mean info?)"});
  check_refused({"render", "spheres", "-o", "-", "--sise", "3x3"}, 2, {"(did you mean --size?)"});
  check_refused({"render", "spheres", "-o", "-", "--dpeth=3"}, 2, {"(did you mean --depth?)"});
  check_refused({"--hlep"}, 2, {"(did you mean --help?)"});
  check_refused({"--verbose"}, 2, {"\"--verbose\""});
  check_refused({"render", "--nope"}, 2, {"\"--nope\"", "is not an option of thimble render"});
  check_refused({"render"}, 2, {"SCENE"});
  check_refused({"render", "spheres"}, 2, {"--output"});
  check_refused({"trace", "spheres"}, 2, {"--rays"});
  check_refused({"render", "spheres", "more", "-o", "-"}, 2, {"\"more\""});
  check_refused({"info", "spheres", "--depth"}, 2, {"--depth"});
  check_refused({"info", "spheres", "--depth", "3", "--depth", "4"}, 2, {"--depth", "more than once"});
  for (const char* flag : {"--quiet", "--coarsen", "--as-voxels", "--z-up"}) {
    for (const char* value : {"=3", "=x", "=1", "=0", "=false"}) {
      check_refused({"info", "spheres", std::string(flag) + value}, 2,
                    {std::string(flag) + " takes no value"});
    }
  }
  check_refused({"table", "--quiet=1"}, 2, {"--quiet takes no value"});
  check_refused({"render", "spheres", "-o", "picture.bmp"}, 2, {"\"picture.bmp\"", ".ppm", ".png"});
  check_refused({"render", "spheres", "-o", ""}, 2, {"--output"});
  check_refused({"bake"}, 2, {"SCENE"});
  check_refused({"bake", "spheres"}, 2, {"--output"});
}

TEST_CASE("command: options that have no effect together -> status 2, whichever subcommand") {
  const std::vector<Words> commands{{"render", "spheres", "-o", "-"}, {"bake", "spheres", "-o", "-"},
                                    {"effects", "spheres"},           {"memory", "spheres"},
                                    {"accuracy", "spheres"},          {"view", "spheres"}};
  for (const Words& command : commands) {
    check_refused(command + Words{"--span", "3"}, 2, {"--span", "--projection orthographic"});
    check_refused(command + Words{"--projection", "perspective", "--span", "3"}, 2, {"--span"});
    check_refused(command + Words{"--fov", "30", "--projection", "orthographic"}, 2, {"--fov", "--span"});
  }
  check_refused({"render", "spheres", "-o", "-", "--shade", "depth", "--bounces", "3"}, 2, {"--bounces"});
  for (const char* structure : {"pool", "Pool", "dense"}) {
    check_refused({"render", "spheres", "-o", "-", "--structure", structure, "--engine", "wide"}, 2,
                  {"--engine wide", "--structure compact"});
  }
}

TEST_CASE("command: values out of range -> status 2, the option, the value and the limits named") {
  const auto render = [](const std::string& option, const std::string& value, const Words& named) {
    check_refused({"render", "spheres", "-o", "picture.ppm", option, value}, 2,
                  named + Words{option + ": \"" + value + "\""});
  };
  for (const char* value : {"0", "13", "-1", "x", "", "3.5", "3x", "99999999999999999999"}) {
    render("--depth", value, {"1 to 12"});
  }
  for (const char* value :
       {"0x5", "5x0", "5", "5x", "x5", "5x5x5", "-5x5", "16385x5", "5x16385", "5 x 5", ""}) {
    render("--size", value, {"WxH", "16384"});
  }
  for (const char* value : {"0.99", "120.01", "nan", "inf", "-60", "60deg", ""}) {
    render("--fov", value, {"1 to 120"});
  }
  for (const char* value : {"0", "-1", "nan", "inf", "-inf", "1e999", "wide"}) {
    render("--span", value, {"above 0"});
  }
  for (const char* option : {"--eye", "--target", "--up"}) {
    for (const char* value : {"1,2", "1,2,3,4", "1,2,x", "nan,0,0", "inf,0,0", "1;2;3", "", ",,", "1,2,3 "}) {
      render(option, value, {"X,Y,Z"});
    }
  }
  for (const char* value : {"-1", "64X", "1e6", "K", "", "9223372036854775808", "99999999999999999999999"}) {
    render("--memory", value, {"64K"});
  }
  render("--shade", "pretty", {"depth, normal, color, mono or ink"});
  render("--structure", "bvh", {"dense, pool or compact"});
  render("--projection", "fisheye", {"perspective or orthographic"});
  render("--engine", "cpu", {"auto, wide, gpu, ray64 or ray32"});
  render("--threads", "0", {"1 to 256"});
  for (const char* value : {"7", "21", "auto"}) {
    render("--direction-bits", value, {"8 to 20"});
  }
  for (const char* value : {"x", "5,", ",5", "-5", "1000000001", "1,,2", ""}) {
    check_refused({"table", "--points", value}, 2, {"--points", "1000000000"});
  }
}

TEST_CASE("command: scenes that cannot be read -> status 1, the file and the fault named") {
  const TemporaryFolder folder;
  check_refused({"info", folder.path("none.vox")}, 1, {folder.path("none.vox"), "No such file"});
  check_refused({"info", folder.path()}, 1, {folder.path(), "directory"});
  check_refused({"info", folder.write("empty.ply", "")}, 1, {"empty.ply", "empty"});
  check_refused({"info", folder.write("what.bin", "something")}, 1, {"what.bin", "info --help"});
  check_refused({"info", folder.write("bad.xyz", "1 2 3\n4 five 6\n")}, 1, {"bad.xyz", "line 2"});
  check_refused({"info", "--as-voxels", folder.write("far.xyz", "1 2 3\n4 5 4096\n")}, 1,
                {"far.xyz", ": line 2: (4, 5, 4096)", "4095"});
  check_refused({"info", "--as-voxels", "--depth", "3", folder.write("deep.xyz", "1 2 3\n4 5 8\n")}, 1,
                {"deep.xyz", ": line 2:", "0..7"});
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n1 2 5000\n";
  check_refused({"info", "--as-voxels", folder.write("far.ply", ply)}, 1, {"far.ply: line 8: (1, 2, 5000)"});
  std::string binary = ply.substr(0, ply.find("1 2 5000"));
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  binary += std::string(11, '\0') + '\x47';  // 0, 0, 32768
  check_refused({"info", "--as-voxels", folder.write("binary.ply", binary)}, 1,
                {"binary.ply: point 1: (0, 0, 32768)"});
  check_refused({"info", folder.write("cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1")}, 1,
                {"cut.off: line 6: the file ends in face 0 of 1"});
  check_refused({"info", folder.path("two\nlines.xyz")}, 1, {"two\\x0alines.xyz"});
  check_refused({"info", ""}, 1, {"\"\""});
  check_refused({"info", "points:many"}, 1, {"points:many", "\"many\""});
  check_refused({"info", "points:5,depth=13"}, 1, {"12"});
  check_refused({"info", "points:5,color=3"}, 1, {"points:5,color=3"});
  check_refused({"info", "spheres", "--as-voxels"}, 2, {"--as-voxels"});
  const std::string cloud = folder.write("cloud.xyz", "1 2 3\n4 5 6\n");
  check_refused({"info", "spheres", "--fit", "100"}, 2, {"--fit"});
  check_refused({"info", cloud, "--fit", "49"}, 2, {"--fit", "50"});
  check_refused({"info", cloud, "--as-voxels", "--clip", "0,0,0,9,9,9"}, 2, {"--clip", "--as-voxels"});
  for (const char* box : {"1,2,3", "0,0,0,1,1,1,1", "0,0,0,1,-1,1", "0,0,0,1,1,x", ""}) {
    check_refused({"info", cloud, "--clip", box}, 2, {"--clip", "X,Y,Z,X,Y,Z"});
  }
  check_refused({"info", cloud, "--clip", "7,0,0,9,9,9"}, 1, {"cloud.xyz", "--clip"});
  check_refused(
      {"info", folder.write("mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "--fit", "99"}, 1,
      {"mesh.off", "point files"});
}

TEST_CASE("command: names with blanks, UTF-8 and line feeds -> read, and told without breaking the line") {
  const TemporaryFolder folder;
  const std::string path = folder.write("a b\n\xC3\xBC.xyz", "1 2 3\n");
  const CommandResult result = run_command({"info", "--as-voxels", path});
  CHECK(result.status == 0);
  CHECK(result.out.find("a b\\x0a\xC3\xBC.xyz\n") != std::string::npos);
}

TEST_CASE("command: cameras that cannot be -> status 1 and what to change") {
  const auto render = [](const Words& options, const Words& named) {
    check_refused(Words{"render", "spheres", "-o", "-"} + options, 1, named);
  };
  render({"--eye", "1,2,3", "--target", "1,2,3"}, {"--eye", "--target"});
  render({"--eye", "1,2,3", "--target", "1,2,9", "--up", "0,0,-4"}, {"--up", "parallel"});
  render({"--up", "0,0,0"}, {"--up"});
  render({"--eye", "0,0,321"}, {"--eye", "321", "-256 to 320"});
  render({"--eye", "0,-1e300,0"}, {"--eye", "-256 to 320"});
  render({"--target", "1e300,0,0"}, {"--target", "-256 to 320"});
  render({"--projection", "orthographic", "--span", "1e9"}, {"--span", "131,071"});
  render({"--projection", "orthographic", "--span", "1e-9"}, {"--span"});
  render({"--projection", "orthographic", "--span", "5000"}, {"--span"});
  render({"--fov", "1", "--size", "16384x16384"}, {"--fov", "--size"});
}

TEST_CASE("command: --eye with leading minus, point or plus in --up -> understood") {
  for (const char* eye : {"-30,2,3", "-.5,-70,3", "1e1,-7e1,.5"}) {
    check_done({"render", "spheres", "--size", "4x3", "-o", "-", "--eye", eye});
  }
}

TEST_CASE("command: an output that cannot be written -> status 1, its name, and nothing left behind") {
  const TemporaryFolder folder;
  const std::string rays = folder.write("rays.csv", "0,0,0,1,1,1\n");
  const std::string ppm = folder.path("gone/picture.ppm");
  check_refused({"render", "spheres", "-o", ppm}, 1, {ppm, "No such file"});
  check_refused({"trace", "spheres", "--rays", rays, "-o", folder.path("gone/hits.csv")}, 1,
                {"gone/hits.csv"});
  check_refused({"trace", "spheres", "--rays", rays, "-o", folder.path()}, 1, {folder.path(), "directory"});
  check_refused({"trace", "spheres", "--rays", rays, "-o", "/dev/full"}, 1, {"/dev/full", "No space"});
  check_refused({"table", "--points", "1", "--json", folder.path("gone/t.json")}, 1, {"gone/t.json"});
  check_refused({"info", "spheres", "--stats", folder.path("gone/s.json")}, 1, {"gone/s.json"});
  std::filesystem::create_directory(folder.path("folder.ppm"));
  check_refused({"render", "spheres", "-o", folder.path("folder.ppm")}, 1, {"folder.ppm", "directory"});
  // One output of several: none appears.
  for (const char* option : {"--hits", "--depth-image", "--stats"}) {
    const Words words{"render", "spheres", "--quiet", "--size", "64x48", "-o", folder.path("p.ppm"), option};
    check_refused(words + Words{"/dev/full"}, 1, {"/dev/full"});
    check_refused(words + Words{folder.path("gone/x")}, 1, {"gone/x"});
  }
  CHECK(folder.names() == Words{"folder.ppm", "rays.csv"});
}

TEST_CASE("command: standard output that takes nothing -> status 1") {
  const TemporaryFolder folder;
  const std::string rays = folder.write("rays.csv", "0,0,0,1,1,1\n");
  CommandLimits full;
  full.output_path = "/dev/full";
  for (const Words& words : {Words{"--help"}, Words{"render", "--help"}, Words{"info", "spheres"},
                             Words{"render", "spheres", "--quiet", "--size", "64x48", "-o", "-"},
                             Words{"trace", "spheres", "--rays", rays}, Words{"table", "--points", "1"}}) {
    check_refused(words, 1, {"standard output"}, full);
  }
}

TEST_CASE("command: a failure -> a file of the output's name keeps its bytes") {
  const TemporaryFolder folder;
  const std::string picture = folder.write("p.ppm", "old picture");
  const std::string hits = folder.write("h.csv", "old hits");
  const std::string bad = folder.write("bad.csv", "0,0,0,1,1,1\n0,0,0,0,0,0\n");
  check_refused({"render", "spheres", "-o", picture, "--hits", hits, "--memory", "1000"}, 1, {"1,000"});
  check_refused({"render", folder.path("none.vox"), "-o", picture, "--hits", hits}, 1, {"none.vox"});
  check_refused({"render", "spheres", "-o", picture, "--hits", hits, "--stats", "/dev/full", "--quiet",
                 "--size", "64x48"},
                1, {"/dev/full"});
  check_refused({"trace", "spheres", "--rays", bad, "-o", hits}, 1, {"bad.csv", "line 2"});
  CHECK(read_text(picture) == "old picture");
  CHECK(read_text(hits) == "old hits");
  // A disk that is full, or the like: the limit on a file's size ends the write in its middle.
  CommandLimits small;
  small.file_size_bytes = 20000;
  check_refused({"render", "spheres", "--quiet", "-o", picture, "--size", "200x100"}, 1, {picture}, small);
  CHECK(read_text(picture) == "old picture");
  CHECK(folder.names() == Words{"bad.csv", "h.csv", "p.ppm"});
}

TEST_CASE("command: success over a file -> replaced whole, its mode and a link to it kept, no temporary") {
  const TemporaryFolder folder;
  const std::string path = folder.write("p.ppm", std::string(100000, 'x'));
  std::filesystem::permissions(path,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("p.ppm", folder.path("link.ppm"));
  const CommandResult result =
      run_command({"render", "spheres", "--size", "4x3", "-o", folder.path("link.ppm"), "--quiet"});
  CHECK(result.status == 0);
  CHECK(result.err.empty());
  CHECK(std::filesystem::is_symlink(folder.path("link.ppm")));
  CHECK(read_text(path).size() == std::string("P6\n4 3\n255\n").size() + 36);
  CHECK((std::filesystem::status(path).permissions() & std::filesystem::perms::others_read) ==
        std::filesystem::perms::none);
  CHECK(folder.names() == Words{"link.ppm", "p.ppm"});
}

TEST_CASE("command: a link that leads to nothing yet -> stays, and what it leads to is made") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("there"));
  std::filesystem::create_symlink("there/second", folder.path("first"));
  std::filesystem::create_symlink("p.ppm", folder.path("there/second"));
  std::filesystem::create_symlink("round", folder.path("round"));
  CHECK(run_command({"render", "spheres", "--size", "4x3", "-o", folder.path("first"), "--quiet"}).status ==
        2);  // the ending is what is typed
  CHECK(folder.names() == Words{"first", "round", "there"});
  std::filesystem::rename(folder.path("first"), folder.path("first.ppm"));
  check_done({"render", "spheres", "--size", "4x3", "-o", folder.path("first.ppm"), "--quiet"});
  CHECK(std::filesystem::is_symlink(folder.path("first.ppm")));
  CHECK(std::filesystem::is_symlink(folder.path("there/second")));
  CHECK(read_text(folder.path("there/p.ppm")).size() == std::string("P6\n4 3\n255\n").size() + 36);
  std::filesystem::rename(folder.path("round"), folder.path("round.ppm"));
  std::filesystem::create_symlink("round.ppm", folder.path("round"));
  check_refused({"render", "spheres", "-o", folder.path("round.ppm")}, 1, {"round.ppm"});
}

TEST_CASE("command: signals that whoever started us ignores -> stay ignored; killed -> nothing left") {
  const TemporaryFolder folder;
  // The command waits for rays, and gets them when the signal has been sent.
  const auto run = [&](const std::string& before, const std::string& signal) {
    const std::string script =
        "cd " + folder.path() + "; rm -f rays out.csv; mkfifo rays; (" + before +
        " exec " THIMBLE_COMMAND_PATH
        " trace spheres --rays rays -o out.csv --quiet) & child=$!; exec 3>rays; kill -" +
        signal + " $child; (printf '0,0,0,1,1,1\\n' >&3) 2>/dev/null; exec 3>&-; wait $child";
    CommandLimits limits;
    limits.program = "/bin/sh";
    return run_command({"-c", script}, limits);
  };
  for (const char* const signal : {"HUP", "INT", "TERM"}) {
    CAPTURE(signal);
    const CommandResult ignored = run("trap '' " + std::string(signal) + ";", signal);
    CHECK_MESSAGE(ignored.status == 0, ignored.describe());
    CHECK(folder.names() == Words{"out.csv", "rays"});
  }
  // What can end it otherwise is in test_command_outputs.cpp; this cannot be caught.
  const CommandResult ended = run("", "KILL");
  CHECK_MESSAGE(ended.status > 128, ended.describe());
  CHECK(folder.names() == Words{"rays"});
}

TEST_CASE(
    "command: -o - -> standard output holds the file's bytes and nothing else, with and without --quiet") {
  const TemporaryFolder folder;
  const Words render{"render", "spheres", "--size", "31x17", "-o"};
  check_done(render + Words{folder.path("p.ppm")});
  const std::string file = read_text(folder.path("p.ppm"));
  const CommandResult loud = check_done(render + Words{"-"});
  CHECK(loud.out == file);
  CHECK(loud.err.find("28,327 voxels") != std::string::npos);
  const CommandResult quiet = check_done(render + Words{"-", "--quiet"});
  CHECK(quiet.out == file);
  CHECK(quiet.err.empty());

  const Words trace{"trace", "spheres", "--rays", folder.write("rays.csv", "0,0,0,1,1,1\n")};
  check_done(trace + Words{"-o", folder.path("h.csv")});
  const CommandResult traced = check_done(trace);
  CHECK(traced.out == read_text(folder.path("h.csv")));
  CHECK(traced.err.empty());
}

TEST_CASE("command: a pipe as scene, a device as output -> both work") {
  const TemporaryFolder folder;
  const std::string rays = folder.write("rays.csv", "0,0,0,1,1,1\n");
  check_done({"trace", "spheres", "--rays", rays, "-o", "/dev/null"});
  check_done({"info", "points:0"});
  check_done({"info", "points:1", "--depth", "1"});
  // Standard input is empty here.
  check_refused({"info", "/dev/stdin"}, 1, {"/dev/stdin"});
}
