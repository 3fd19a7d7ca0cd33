// `thimble render --rows` and `--part`, and `thimble join`: parts drawn apart are the picture or film of one process.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "output/part_file.h"
#include "readers/input_error.h"
#include "scene/random.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/json.h"

namespace {

using namespace thimble::tests;
using namespace thimble::tools;

constexpr const char* kTower = R"(depth 5
material wall color 200 60 40
material roof color 60 90 200
material lamp color 255 220 120 emission 3
box wall from 8 8 6 to 24 20 18
box roof from 6 6 18 to 26 22 22
box lamp from 10 6 8 to 12 8 10
)";

// Fails with that status and a sentence that holds all of `named`, and leaves no output.
void check_fails(const Words& words, int status, const Words& named, const std::string& output) {
  check_refused(words, status, named);
  CHECK_FALSE(std::filesystem::exists(output));
}

// A part of `rows` rows of the picture of 8 x 6 pixels that `fill` fills.
std::string write_part(const TemporaryFolder& folder, const std::string& name, PartHeader header,
                       std::uint8_t fill) {
  std::string path = folder.path(name);
  OutputFile file(path);
  PartWriter part(&file, header);
  part.add(std::vector<std::uint8_t>(header.unit_bytes() * header.count, fill));
  part.end();
  file.commit();
  return path;
}

PartHeader rows(std::uint32_t first, std::uint32_t count) {
  PartHeader header;
  header.width_px = 8;
  header.height_px = header.all = 6;
  header.first = first;
  header.count = count;
  return header;
}

// What opening a file with these bytes says; empty where it is a part.
std::string fault_of(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    PartFile::open(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("join: rows drawn apart, in any order -> byte for byte the picture of one process") {
  const TemporaryFolder folder;
  const std::string tower = folder.write("tower.scene", kTower);
  struct Case {
    std::string scene;
    Words options;
    Words endings{"png", "pgm", "pbm"};
  };
  const std::vector<Case> cases{
      {tower, {}},
      {tower, {"--ground", "on", "--background", "gradient", "--samples", "1"}},
      {tower, {"--background", "none"}, {"png"}},
      {tower, {"--samples", "auto"}},
      {tower, {"--samples", "auto", "--background", "none"}, {"png"}},
      {tower, {"--effects", "all", "--samples", "auto"}},
      {tower, {"--shade", "color", "--samples", "auto", "--cutoff", "2"}},
      {tower, {"--shade", "depth"}},
      {tower, {"--shade", "color", "--samples", "4", "--cutoff", "2"}},
      {tower, {"--shade", "normal", "--structure", "pool"}},
      {tower, {"--effects", "all"}},
      {tower, {"--effects", "all", "--samples", "4", "--bounces", "1"}},
      {tower, {"--shade", "color", "--board", "lm3s6965evb"}},
      {"spheres", {"--shade", "mono", "--structure", "dense"}},
      {"points:900,depth=7", {}},
      {"points:900,depth=7", {"--background", "none"}, {"png"}},
  };
  SplitMix64 random(8);
  int number = 0;
  for (const Case& each : cases) {
    if (thimble::tests::takes_few() && number % 2 != 0) {
      ++number;
      continue;
    }
    const std::string ending = each.endings[static_cast<std::size_t>(number++) % each.endings.size()];
    const Words render = Words{"render", each.scene, "--size", "45x40", "--quiet"} + each.options;
    CAPTURE(render);
    CAPTURE(ending);
    const std::string whole = folder.path("whole." + ending);
    check_done(render + Words{"-o", whole});
    Words parts;
    for (std::int32_t first = 0; first < 40;) {
      const std::int32_t count = std::min(random.between(1, 25), 40 - first);
      const std::string part = folder.path(std::to_string(first) + "." + ending + ".part");
      check_done(render + Words{"--rows", std::to_string(first) + ":" + std::to_string(count), "-o", part,
                                "--threads", std::to_string(random.between(1, 3))});
      parts.insert(random.below(2) == 0 ? parts.begin() : parts.end(), part);
      first += count;
    }
    const std::string joined = folder.path("joined." + ending);
    check_done(Words{"join"} + parts + Words{"-o", joined});
    CHECK(read_text(joined) == read_text(whole));
    std::filesystem::remove(joined);
  }
}

TEST_CASE("join: who draws and how fast is not in a part, what changes the picture is") {
  const TemporaryFolder folder;
  const std::string tower = folder.write("tower.scene", kTower);
  const auto part = [&](const Words& options, const std::string& name) {
    check_done(Words{"render", tower, "--size", "40x30", "--rows", "7:9", "-o", folder.path(name)} + options);
    return read_text(folder.path(name));
  };
  const Words depth{"--shade", "depth", "--quiet"};
  const std::string one = part(depth, "a.part");
  CHECK(part(depth + Words{"--engine", "ray64", "--threads", "1"}, "b.part") == one);
  CHECK(part(depth + Words{"--engine", "wide", "--threads", "2", "--stats", folder.path("s.json")},
             "b.part") == one);
  CHECK(part(depth + Words{"--memory", "4M", "--structure", "pool"}, "b.part") == one);
  const auto stats = read_json(folder.path("s.json"));
  CHECK(stats["rays"] == 9 * 40);
  const std::string rest = folder.path("rest.part");
  const std::string out = folder.path("out.png");
  const auto check_other = [&](const Words& options, const std::string& why) {
    check_done(Words{"render", tower, "--rows", "0:20", "-o", rest, "--quiet"} + options);
    check_fails({"join", folder.path("a.part"), rest, "-o", out}, 1, {"rest.part", "a.part", why}, out);
  };
  check_other({"--shade", "depth", "--size", "40x30", "--turn", "5"}, "camera");
  check_other({"--shade", "depth", "--size", "40x31"}, "40x31");
  check_other({"--shade", "normal", "--size", "40x30"}, "options");
  check_other({"--shade", "depth", "--size", "40x30", "--samples", "4"}, "options");
  check_other({"--shade", "depth", "--size", "40x30", "--samples", "auto"}, "options");
  check_other({"--size", "40x30"}, "options");
  const std::string other =
      folder.write("other.scene", std::string(kTower) + "box roof from 1 1 1 to 2 2 2\n");
  check_done(
      {"render", other, "--shade", "depth", "--size", "40x30", "--rows", "0:20", "-o", rest, "--quiet"});
  check_fails({"join", folder.path("a.part"), rest, "-o", out}, 1, {"rest.part", "scene"}, out);
  // Light alone makes another scene too.
  const std::string night =
      folder.write("night.scene", std::string(kTower) + "sun toward 1 2 3 brightness 2\n");
  check_done({"render", tower, "--size", "40x30", "--rows", "0:20", "-o", folder.path("a.part"), "--quiet"});
  check_done({"render", night, "--size", "40x30", "--rows", "20:10", "-o", rest, "--quiet"});
  check_fails({"join", folder.path("a.part"), rest, "-o", out}, 1, {"rest.part", "scene"}, out);
}

TEST_CASE("join: parts that lack rows, agree or disagree -> what is missing and where they differ, by name") {
  const TemporaryFolder folder;
  const std::string out = folder.path("out.pgm");
  const std::string a = write_part(folder, "a.part", rows(0, 2), 7);
  const std::string b = write_part(folder, "b.part", rows(3, 1), 7);
  const std::string c = write_part(folder, "c.part", rows(1, 5), 7);
  const std::string d = write_part(folder, "d.part", rows(5, 1), 8);
  check_fails({"join", a, b, "-o", out}, 1, {"2:1", "4:2", "6 rows"}, out);
  check_fails({"join", c, "-o", out}, 1, {"0:1"}, out);
  check_fails({"join", a, c, d, "-o", out}, 1, {"d.part", "c.part", "row 5"}, out);
  check_done({"join", b, c, a, a, "-o", out});
  CHECK(read_text(out) == "P5\n8 6\n255\n" + std::string(48, '\x07'));
  PartHeader finer = rows(0, 6);
  finer.has_finer_shades = true;
  const std::string e = write_part(folder, "e.part", finer, 9);
  check_fails({"join", e, "-o", folder.path("o.pbm")}, 2, {".pbm.part"}, folder.path("o.pbm"));
  check_fails({"join", e, c, "-o", folder.path("o.ppm")}, 1, {"c.part", "options"}, folder.path("o.ppm"));
  PartHeader mono = rows(0, 6);
  mono.pixels = PartPixels::kMono;
  const std::string f = write_part(folder, "f.part", mono, 0xF0);
  check_done({"join", f, "-o", folder.path("o.pbm")});
  CHECK(read_text(folder.path("o.pbm")) == "P4\n8 6\n" + std::string(6, '\x0F'));
  check_fails({"join", f, "-o", folder.path("o.png")}, 2, {".pbm"}, folder.path("o.png"));
  PartHeader clear = rows(0, 6);
  clear.pixels = PartPixels::kRgba;
  const std::string g = write_part(folder, "g.part", clear, 3);
  check_fails({"join", g, "-o", folder.path("o.ppm")}, 2, {".png"}, folder.path("o.ppm"));
}

TEST_CASE("join: every truncation and every flipped bit of a part -> refused, the file named") {
  const TemporaryFolder folder;
  const std::string path = write_part(folder, "small.part", rows(2, 2), 5);
  const std::string bytes = read_text(path);
  REQUIRE(bytes.size() == 48 + 2 * 24 + 4);
  const std::string damaged = folder.path("damaged.part");
  CHECK(fault_of(damaged, bytes).empty());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CAPTURE(size);
    CHECK(fault_of(damaged, bytes.substr(0, size)).starts_with(damaged + ": is "));
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    CAPTURE(bit);
    CHECK(fault_of(damaged, flipped).starts_with(damaged + ": is "));
  }
  CHECK(fault_of(damaged, bytes + "x").find("too long") != std::string::npos);
  // Headers that no writer makes, with checksums that fit.
  const std::vector<void (*)(PartHeader*)> wrongs{
      [](PartHeader* h) { h->count = 0; },
      [](PartHeader* h) { h->first = 5; },
      [](PartHeader* h) { h->first = UINT32_MAX; },
      [](PartHeader* h) { h->all = 7; },
      [](PartHeader* h) { h->width_px = 0; },
      [](PartHeader* h) { h->width_px = 16385; },
      [](PartHeader* h) { h->height_px = h->all = 16385; },
      [](PartHeader* h) {
        h->kind = PartKind::kTurntable;
        h->all = 100'001;
      },
      [](PartHeader* h) {
        h->kind = PartKind::kCameraPath;
        h->pixels = PartPixels::kMono;
      },
      [](PartHeader* h) { h->kind = static_cast<PartKind>(4); },
      [](PartHeader* h) { h->pixels = static_cast<PartPixels>(3); },
  };
  for (const auto wrong : wrongs) {
    PartHeader header = rows(2, 2);
    wrong(&header);
    const std::string whole = read_text(write_part(folder, "wrong.part", rows(2, 2), 5));
    {
      OutputFile file(folder.path("wrong.part"));
      PartWriter part(&file, header);
      part.end();
      file.commit();
    }
    // The head of the command's options, and the body of a sound part.
    CHECK(fault_of(damaged, read_text(folder.path("wrong.part")).substr(0, 48) + whole.substr(48))
              .starts_with(damaged + ": is damaged"));
  }
  // As a user meets them.
  const std::string out = folder.path("out.png");
  check_fails({"join", path, folder.write("cut.part", bytes.substr(0, 60)), "-o", out}, 1,
              {"cut.part", "cut off"}, out);
  check_fails({"join", folder.write("empty.part", ""), "-o", out}, 1, {"empty.part"}, out);
  check_fails({"join", folder.path("nothing.part"), "-o", out}, 1, {"nothing.part"}, out);
  check_fails({"join", folder.path(), "-o", out}, 1, {"file"}, out);
  check_fails({"join", "/dev/zero", "-o", out}, 1, {"/dev/zero"}, out);
  REQUIRE(::mkfifo(folder.path("pipe").c_str(), 0600) == 0);
  check_fails({"join", folder.path("pipe"), "-o", out}, 1, {"pipe", "twice"}, out);
}

TEST_CASE("join: a film of 48 frames by four processes, one killed and drawn again -> the film of one") {
  const TemporaryFolder folder;
  const std::string tower = folder.write("tower.scene", kTower);
  const Words render{"render", tower, "--size", "48x36", "--turntable", "48", "--quiet"};
  const auto part_words = [&](int first) {
    return render + Words{"--part",    std::to_string(first) + ":12",
                          "-o",        folder.path(std::to_string(first) + ".part"),
                          "--threads", first == 0 ? "2" : "1"};
  };
  // All four at once; the third is killed while it draws.
  std::string script;
  for (const int first : {36, 24, 0, 12}) {
    script += std::string(first == 24 ? "timeout -s KILL 0.03 " : "") + "'" THIMBLE_COMMAND_PATH "'";
    for (const std::string& word : part_words(first)) {
      script += " '" + word + "'";
    }
    script += " &\n";
  }
  CommandLimits shell;
  shell.program = "/bin/sh";
  check_done({"-c", script + "wait"}, shell);
  Words parts;
  for (const int first : {0, 12, 24, 36}) {
    parts.push_back(folder.path(std::to_string(first) + ".part"));
  }
  const std::string out = folder.path("out.gif");
  std::filesystem::remove(parts[2]);  // should it have been faster
  check_fails({"join", parts[3], parts[0], parts[1], "-o", out}, 1, {"24:12", "48 frames"}, out);
  check_done(part_words(24));
  for (const std::string ending : {"gif", "y4m"}) {
    const std::string whole = folder.path("whole." + ending);
    const std::string joined = folder.path("joined." + ending);
    check_done(render + Words{"-o", whole});
    check_done({"join", parts[3], parts[1], parts[0], parts[2], "-o", joined});
    CHECK(read_text(joined) == read_text(whole));
  }
  check_fails({"join", parts[0], parts[1], parts[2], parts[3], "-o", folder.path("o.png")}, 2, {".gif"},
              folder.path("o.png"));
}

TEST_CASE("render: --camera-path -> a frame a line, as --eye and the rest show it; parts join to the film") {
  const TemporaryFolder folder;
  const std::string tower = folder.write("tower.scene", kTower);
  const std::string path = folder.write("path.csv",
                                        "ex,ey,ez,tx,ty,tz,ux,uy,uz,fov\r\n"
                                        "-20,-30,20,16,16,10,0,0,1,40\r\n\r\n"
                                        " -10, -30, 25, 16, 16, 10, 0, 0, 1, 45\n"
                                        "0,-30,30,16,16,10,1,0,1,5e1");
  const Words render{"render", tower, "--size", "40x30", "--quiet"};
  const std::string film = folder.path("film.y4m");
  check_done(render + Words{"--camera-path", path, "-o", film});
  const std::string bytes = read_text(film);
  const std::size_t head = bytes.find('\n') + 1;
  CHECK(bytes.substr(0, head).find(" F25:1 ") != std::string::npos);
  CHECK(bytes.size() == head + 3 * (6 + 3 * 40 * 30));
  // The first frame sets the exposure, so that one compares with a picture.
  check_done(render + Words{"--eye", "-20,-30,20", "--target", "16,16,10", "--up", "0,0,1", "--fov", "40",
                            "-o", folder.path("a.ppm")});
  check_done(render + Words{"--camera-path", path, "--part", "0:1", "-o", folder.path("0.part")});
  const std::string part = read_text(folder.path("0.part"));
  CHECK(part.substr(48, 3 * 40 * 30) == read_text(folder.path("a.ppm")).substr(13));
  check_done(render + Words{"--camera-path", path, "--part", "1:2", "-o", folder.path("1.part")});
  check_done({"join", folder.path("1.part"), folder.path("0.part"), "-o", folder.path("joined.y4m")});
  CHECK(read_text(folder.path("joined.y4m")) == bytes);
  // Six columns and no header will do.
  const std::string bare = folder.write("bare.csv", "-20,-30,20,16,16,10\n");
  check_done(render + Words{"--camera-path", bare, "--fov", "40", "-o", folder.path("bare.gif")});
}

TEST_CASE("render: camera paths that are none -> status 1, file and line named") {
  const TemporaryFolder folder;
  const std::string out = folder.path("out.gif");
  const auto check_bad = [&](const std::string& text, const Words& named) {
    const std::string path = folder.write("path.csv", text);
    check_fails({"render", "spheres", "--size", "20x15", "--camera-path", path, "-o", out}, 1,
                Words{"path.csv"} + named, out);
  };
  const std::string good = "0,-90,30,32,32,32\n";
  check_bad("", {"empty"});
  check_bad("ex,ey,ez,tx,ty,tz\n", {"no camera"});
  check_bad("tx,ty,tz,ex,ey,ez\n" + good, {"line 1", "another order"});
  check_bad(good + "1,2,3,4,5\n", {"line 2", "5 columns", "6"});
  check_bad(good + "0,-90,nan,32,32,32\n", {"line 2", "ez", "nan"});
  check_bad("ex,ey,ez,tx,ty,tz\n" + good + "0,-90,inf,32,32,32\n", {"line 3", "inf"});
  check_bad(good + "0,-90,,32,32,32\n", {"line 2", "ez"});
  check_bad(good + "0,-90,1e999,32,32,32\n", {"line 2", "ez"});
  check_bad(good + "32,32,32,32,32,32\n", {"line 2", "same point"});
  check_bad(good + "0,-9000,30,32,32,32\n", {"line 2", "-4 to 5 world sizes"});
  check_bad("0,-90,30,32,32,32,0,0,0\n", {"line 1", "direction"});
  check_bad("0,-90,30,32,32,32,121\n", {"line 1", "fov", "120"});
  check_bad("0,-90\n", {"line 1", "2 columns", "ex,ey,ez"});
  check_fails({"render", "spheres", "--camera-path", folder.path("no.csv"), "-o", out}, 1, {"no.csv"}, out);
}

TEST_CASE("render: --rows, --part and --camera-path asked for wrongly -> status 2, and no file") {
  const TemporaryFolder folder;
  const std::string path = folder.write("path.csv", "0,-90,30,32,32,32,40\n");
  const auto check_bad = [&](const Words& options, const Words& named, const std::string& name = "a.part") {
    const std::string out = folder.path(name);
    check_fails(Words{"render", "spheres", "--size", "20x15", "-o", out} + options, 2, named, out);
  };
  check_bad({"--rows", "0:16"}, {"0:16", "15 rows"});
  check_bad({"--rows", "15:1"}, {"15:1", "14"});
  check_bad({"--rows", "0:0"}, {"\"0:0\""});
  check_bad({"--rows", "-1:2"}, {"\"-1:2\""});
  check_bad({"--rows", "3"}, {"\"3\""});
  check_bad({"--rows", "1:2:3"}, {"\"1:2:3\""});
  check_bad({"--rows", "0:99999999999999999999"}, {"--rows"});
  check_bad({"--rows", "0:2147483647"}, {"15 rows"});
  check_bad({"--rows", "0:2"}, {"F.part"}, "a.png");
  check_bad({"--rows", "0:2", "--hits", folder.path("h.csv")}, {"--hits"});
  check_bad({"--rows", "0:2", "--depth-image", folder.path("d.pfm")}, {"--depth-image"});
  check_bad({"--rows", "0:2", "--turntable", "4"}, {"--part"});
  check_bad({"--rows", "0:2", "--background", "none"}, {".pbm"}, "a.pbm.part");
  check_bad({"--part", "0:2"}, {"--turntable"});
  check_bad({"--part", "3:2", "--turntable", "4"}, {"4 frames", "3"});
  check_bad({"--part", "0:1", "--turntable", "4"}, {"F.part"}, "a.gif");
  check_bad({"--part", "1:1", "--camera-path", path}, {"1 frames"});
  check_bad({"--camera-path", path, "--fov", "30"}, {"--fov"}, "a.gif");
  check_bad({"--camera-path", path, "--projection", "orthographic"}, {"perspective"}, "a.gif");
  check_bad({"--camera-path", path, "--turntable", "3"}, {"--camera-path"}, "a.gif");
  check_bad({"--camera-path", path, "--eye", "1,2,3"}, {"--eye"}, "a.gif");
  check_bad({"--camera-path", path, "--shade", "depth"}, {"--shade"}, "a.gif");
  check_bad({"--camera-path", path}, {".gif"}, "a.png");
  check_bad({}, {"does not end in"}, "a.part");
  check_fails({"join", "-o", folder.path("o.png")}, 2, {"--help"}, folder.path("o.png"));
  check_fails({"join", folder.path("a.part")}, 2, {"--output"}, folder.path("o.png"));
  check_fails({"join", folder.path("a.part"), "-o", folder.path("o.bmp")}, 2, {"o.bmp"},
              folder.path("o.bmp"));
}

TEST_CASE("command: a mistyped scene -> the nearest one is named") {
  check_refused({"castl"}, 2, {"did you mean castle?"});
  const TemporaryFolder folder;
  check_fails({"render", "lagon", "-o", folder.path("a.png")}, 1, {"did you mean lagoon?"},
              folder.path("a.png"));
  check_fails({"info", "nothinglikeit"}, 1, {"no scene of that name;"}, folder.path("a.png"));
}
