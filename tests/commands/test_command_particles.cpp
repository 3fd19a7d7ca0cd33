// thimble particles, unseen: what it writes, what it reads, and that a run can be repeated.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/counts.h"
#include "support/json.h"
#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
using thimble::tools::in_disc;

const char* const kSteps = thimble::tests::many_or_few("600", "150");

CommandResult particles(const Words& words) {
  return run_command(Words{"particles"} + words);
}

/// Runs it unseen and returns --stats; fails the test when it does not succeed.
Json stats_of(const Words& words) {
  const TemporaryFolder folder;
  const std::string path = folder.path("stats.json");
  CHECK(check_done(Words{"particles"} + words + Words{"--stats", path, "--quiet", "--display", "none"})
            .err.empty());
  return read_json(path);
}

std::string crc_of(const Words& words) {
  return stats_of(words).at("state_crc32");
}

struct BallState {
  long id, x, y, vx, vy, radius, asleep;
};

std::vector<BallState> read_state(const std::string& path) {
  const Words lines = lines_of(read_text(path));
  REQUIRE(!lines.empty());
  CHECK(lines[0] == "id,x_q16,y_q16,vx_q16,vy_q16,radius_q16,asleep");
  std::vector<BallState> balls;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Words columns = split(lines[i]);
    REQUIRE(columns.size() == 7);
    std::array<long, 7> values{};
    std::transform(columns.begin(), columns.end(), values.begin(),
                   [](const std::string& text) { return std::stol(text); });
    balls.push_back({values[0], values[1], values[2], values[3], values[4], values[5], values[6]});
  }
  return balls;
}

/// Rows of cells, 1 where the PBM has a 1.
std::vector<std::vector<int>> read_field(const std::string& path, int width, int height) {
  const std::string bytes = read_text(path);
  const std::string header = "P4\n" + std::to_string(width) + " " + std::to_string(height) + "\n";
  REQUIRE(bytes.substr(0, header.size()) == header);
  const std::size_t stride = static_cast<std::size_t>(width + 7) / 8;
  REQUIRE(bytes.size() == header.size() + stride * static_cast<std::size_t>(height));
  std::vector<std::vector<int>> cells;
  for (int y = 0; y < height; ++y) {
    std::vector<int> row;
    for (int x = 0; x < width; ++x) {
      const auto byte = static_cast<unsigned char>(
          bytes[header.size() + stride * static_cast<std::size_t>(y) + static_cast<std::size_t>(x / 8)]);
      row.push_back(byte >> (7 - x % 8) & 1);
    }
    cells.push_back(row);
  }
  return cells;
}

/// Takes the balls' cells out of the field, by the rule that --help tells; fails where one is not set.
void take_discs(const std::vector<BallState>& balls, std::vector<std::vector<int>>* cells) {
  for (const BallState& ball : balls) {
    const int diameter = static_cast<int>(ball.radius / 32768);
    const long left = (ball.x - ball.radius + 32768) >> 16;
    const long top = (ball.y - ball.radius + 32768) >> 16;
    for (int row = 0; row < diameter; ++row) {
      for (int column = 0; column < diameter; ++column) {
        if (in_disc(diameter, column, row)) {
          int& cell =
              cells->at(static_cast<std::size_t>(top + row)).at(static_cast<std::size_t>(left + column));
          CHECK(cell == 1);
          cell = 0;
        }
      }
    }
  }
}

long count_of(const std::vector<std::vector<int>>& cells) {
  long count = 0;
  for (const auto& row : cells) {
    count += std::count(row.begin(), row.end(), 1);
  }
  return count;
}

}  // namespace

TEST_CASE("particles: no option, no display, no terminal -> 2,000 steps of Figure 1 end in a heap at rest") {
  ::unsetenv("DISPLAY");
  const CommandResult result = particles({});
  CAPTURE(result.describe());
  CHECK(result.status == 0);
  CHECK(result.out.empty());
  CHECK(result.err.find("693 balls, 2,000 steps") == 0);
  CHECK(result.err.find("asleep 693") != std::string::npos);
  const Json stats = stats_of({});
  CHECK(stats.at("steps") == 2000);
  CHECK(stats.at("particles") == 693);
  CHECK(stats.at("width") == 800);
  CHECK(stats.at("height") == 600);
  CHECK(stats.at("field_bytes") == 60000);
  CHECK(stats.at("bytes") <= 150000);
  CHECK(stats.at("collisions") == stats.at("ball_hits").get<long>() + stats.at("wall_hits").get<long>());
  CHECK(stats.at("collisions") > 10000);
  // In the lower half of the picture all of it.
  const TemporaryFolder folder;
  REQUIRE(particles({"--steps", "2000", "--state", folder.path("a.csv"), "--quiet"}).status == 0);
  for (const BallState& ball : read_state(folder.path("a.csv"))) {
    CHECK(ball.y > (300 << 16));
    CHECK(ball.asleep == 1);
  }
}

TEST_CASE(
    "particles: the same options -> the state of the core itself, run directly; another seed -> another") {
  const Words words{"--size", "300x200", "--count", "150", "--seed", "7", "--steps", kSteps};
  const std::string crc = crc_of(words);
  CHECK(crc_of(words) == crc);

  ParticleConfig config;
  config.width = 300;
  config.height = 200;
  config.capacity = 150;
  config.seed = 7;
  std::vector<std::uint8_t> bytes(particles_bytes(config));
  ParticleWorld world;
  REQUIRE(ParticleWorld::make(config, {bytes.data(), bytes.size()}, &world) == Status::kOk);
  while (world.count() < 150) {
    REQUIRE(world.spawn_random(3 * 65536) == Status::kOk);
  }
  for (int i = std::atoi(kSteps); i > 0; --i) {
    world.step();
  }
  CHECK(std::stoul(crc, nullptr, 16) == world.state_crc32());

  Words other = words;
  other[5] = "8";
  CHECK(crc_of(other) != crc);
}

TEST_CASE("particles: every knob -> another state") {
  const Words words{"--size", "200x150", "--count", "60", "--steps", "100"};
  std::vector<std::string> seen{crc_of(words)};
  const std::vector<Words> knobs{{"--min-size", "5"},        {"--max-size", "7"},    {"--bounciness", "0.3"},
                                 {"--gravity", "0.05,-0.1"}, {"--speed", "1.5"},     {"--substeps", "4"},
                                 {"--subpixel-bits", "4"},   {"--gravity", "0,0.2"}, {"--bounciness", "1"}};
  for (const Words& knob : knobs) {
    const std::string crc = crc_of(words + knob);
    CAPTURE(knob[0]);
    CHECK(std::find(seen.begin(), seen.end(), crc) == seen.end());
    seen.push_back(crc);
  }
}

TEST_CASE("particles: --state and --field -> the field is the discs and the walls drawn, cell by cell") {
  const TemporaryFolder folder;
  const Words size{"--size", "203x150", "--quiet", "--display", "none"};
  const auto run = [&](const Words& words, const std::string& name) {
    check_done(Words{"particles"} + words + size +
               Words{"--state", folder.path(name + ".csv"), "--field", folder.path(name + ".pbm")});
  };
  for (const char* steps : {"0", "1", "37", "400"}) {
    run({"--count", "90", "--steps", steps}, "a");
    auto cells = read_field(folder.path("a.pbm"), 203, 150);
    const std::vector<BallState> balls = read_state(folder.path("a.csv"));
    CHECK(balls.size() == 90);
    take_discs(balls, &cells);
    CHECK(count_of(cells) == 0);
  }
  // Walls far above a heap are the same with balls and without.
  const std::string walls =
      folder.write("walls.txt",
                   "900: key 6\n900: press left 20,20\n901: move 60,40\n901: move 90,10\n"
                   "905: release left 95,12\n910: press middle -30,5\n911: move 30,9\n"
                   "912: release middle 30,9\n");
  run({"--count", "60", "--steps", "1000", "--input", walls}, "with");
  run({"--count", "0", "--steps", "1000", "--input", walls}, "without");
  auto cells = read_field(folder.path("with.pbm"), 203, 150);
  const auto wanted = read_field(folder.path("without.pbm"), 203, 150);
  CHECK(count_of(wanted) > 500);
  CHECK(wanted[40][60] == 1);
  CHECK(wanted[5][0] == 1);
  CHECK(read_state(folder.path("without.csv")).empty());
  take_discs(read_state(folder.path("with.csv")), &cells);
  CHECK(cells == wanted);
}

TEST_CASE(
    "particles: a script with every tool and key -> recorded, played again: the same state and record") {
  const TemporaryFolder folder;
  const std::string script = folder.write(
      "script.txt",
      "# every tool and key\n"
      "0: key ?\n5: key N\n6: key M\n7: key b\n8: key C\n9: key C\n10: press left 100,75\n15: move 50,50\n"
      "30: release left 50,50\n31: key 2\n32: press left 100,75\n60: release left 100,75\n61: key 3\n"
      "61: wheel 3 10,10\n62: press left 90,70\n80: release left 90,70\n81: key 4\n82: press left 20,20\n"
      "95: move 120,20\n110: release left 120,20\n112: key 5\n113: press left 100,140\n120: move 130,140\n"
      "130: release left 130,140\n131: press middle 10,60\n133: move 190,80\n135: release middle 190,80\n"
      "140: press right 5,5\n150: release right 300,500\n160: key left\n180: key G\n181: key up\n200: key "
      "space\n"
      "210: key .\n215: key space\n220: key c\n221: key n\n222: key m\n223: key B\n224: key e\n225: key E\n"
      "230: key 0\n240: key 0\n241: key x\n242: key o\n243: key ]\n244: key [\n245: key g\n250: key down\n");
  const Words words{"--size", "200x150", "--count", "60", "--steps", "300", "--input", script};
  const Json first = stats_of(words + Words{"--record-input", folder.path("one.txt")});
  CHECK(first.at("steps") == 300);
  CHECK(first.at("state_crc32") != crc_of({"--size", "200x150", "--count", "60", "--steps", "300"}));
  // The record ends by itself.
  const Words again{"--size",         "200x150",
                    "--count",        "60",
                    "--input",        folder.path("one.txt"),
                    "--record-input", folder.path("two.txt")};
  const Json second = stats_of(again);
  CHECK(second.at("state_crc32") == first.at("state_crc32"));
  CHECK(second.at("steps") == 300);
  CHECK(read_text(folder.path("one.txt")) == read_text(folder.path("two.txt")));
  // Paused from tick 200 to 215, but for one step.
  CHECK(read_text(folder.path("one.txt")).find("\n314: end\n") != std::string::npos);
}

TEST_CASE("particles: pause, single step, reset -> time stands, advances by one, begins again") {
  const TemporaryFolder folder;
  const Words world{"--size", "200x150", "--count", "60"};
  const auto with = [&](const std::string& script, const Words& more) {
    return stats_of(more + world + Words{"--input", folder.write("script.txt", script)});
  };
  const auto plain = [&](const char* steps) {
    return crc_of({"--size", "200x150", "--count", "60", "--steps", steps});
  };
  CHECK(with("50: key space\n5000: key space\n", {"--steps", "120"}).at("state_crc32") == plain("120"));
  const Json stands = with("50: key space\n", {"--steps", "120"});
  CHECK(stands.at("steps") == 50);
  CHECK(stands.at("state_crc32") == plain("50"));
  const Json by_one = with("50: key .\n60: key .\n70: key .\n", {});
  CHECK(by_one.at("steps") == 53);
  CHECK(by_one.at("state_crc32") == plain("53"));
  const Json reset = with("80: key left\n90: key r\n90: key down\n", {"--steps", "130"});
  CHECK(reset.at("steps") == 130);
  CHECK(reset.at("state_crc32") == plain("40"));
  CHECK(with("40: end\n", {}).at("state_crc32") == plain("40"));
  CHECK(with("40: key q\n", {}).at("steps") == 40);
  CHECK(with("2500: key o\n", {}).at("steps") == 2500);
}

TEST_CASE("particles: tools -> balls come, go, and are drawn along; figures are limited") {
  const TemporaryFolder folder;
  const auto with = [&](const std::string& script, const char* count, const char* steps) {
    return stats_of({"--size", "200x150", "--gravity", "0,0", "--speed", "0", "--count", count, "--steps",
                     steps, "--input", folder.write("script.txt", script)});
  };
  // A click between two ticks works for one step.
  CHECK(with("0: key 4\n3: press left 50,50\n3: release left 50,50\n", "0", "20").at("particles") == 1);
  CHECK(with("0: key 4\n3: press left 50,50\n4: move 100,50\n6: release left 100,50\n", "0", "20")
            .at("particles") == 2);
  CHECK(with("0: key 4\n3: press left -50,50\n13: release left 9000,50\n", "0", "20").at("particles") == 0);
  CHECK(with("0: key 5\n0: wheel 40 0,0\n1: press left 100,75\n", "50", "20").at("particles") == 0);
  CHECK(with("0: key C\n0: key C\n1: key c\n", "50", "20").at("particles") == 60);
  CHECK(with("0: key c\n0: key c\n", "15", "20").at("particles") == 0);
  CHECK(with("0: key x\n", "15", "20").at("particles") == 15);
  // The ball nearest to the pointer follows it.
  const std::string script = folder.write("drag.txt",
                                          "0: key 4\n0: press left 50,50\n1: release left 50,50\n3: key 1\n"
                                          "5: press left 54,47\n6: move 150,100\n");
  REQUIRE(particles({"--size", "200x150", "--gravity", "0,0", "--count", "0", "--steps", "60", "--input",
                     script, "--state", folder.path("drag.csv"), "--quiet"})
              .status == 0);
  const std::vector<BallState> balls = read_state(folder.path("drag.csv"));
  REQUIRE(balls.size() == 1);
  CHECK(std::abs(balls[0].x - ((150 << 16) + 32768)) < 65536);
  CHECK(std::abs(balls[0].y - ((100 << 16) + 32768)) < 65536);
}

TEST_CASE("particles: pictures and a recording -> a pixel a cell, a frame for so many steps") {
  const TemporaryFolder folder;
  REQUIRE(particles({"--size", "64x48", "--count", "12", "--steps", "60", "-o", folder.path("a.ppm"),
                     "--field", folder.path("a.pbm"), "--record", folder.path("a.y4m"), "--fps", "30",
                     "--eps", "60", "--quiet"})
              .status == 0);
  const std::string ppm = read_text(folder.path("a.ppm"));
  const std::string header = "P6\n64 48\n255\n";
  REQUIRE(ppm.size() == header.size() + 3 * 64 * 48);
  const auto cells = read_field(folder.path("a.pbm"), 64, 48);
  for (std::size_t i = 0; i < 64 * 48; ++i) {
    const auto green = static_cast<unsigned char>(ppm[header.size() + 3 * i + 1]);
    CHECK((green > 40) == (cells[i / 64][i % 64] == 1));
  }
  // The first picture and one after every second step.
  const std::string video = read_text(folder.path("a.y4m"));
  const std::string video_header = "YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C444\n";
  CHECK(video.substr(0, video_header.size()) == video_header);
  CHECK(video.size() == video_header.size() + 31 * (6 + 3 * 64 * 48));
  // With the figures another picture.
  REQUIRE(particles({"--steps", "0", "--figures", "-o", folder.path("f.ppm"), "--quiet"}).status == 0);
  REQUIRE(particles({"--steps", "0", "-o", folder.path("g.ppm"), "--quiet"}).status == 0);
  CHECK(read_text(folder.path("f.ppm")) != read_text(folder.path("g.ppm")));
  const CommandResult out =
      particles({"--size", "64x48", "--count", "12", "--steps", "60", "-o", "-", "--quiet"});
  CHECK(out.out == ppm);
}

TEST_CASE(
    "particles: --bodies -> places, speeds, areas and colours of the file; what cannot be is an error") {
  const TemporaryFolder folder;
  const std::string bodies =
      folder.write("bodies.txt",
                   "5\n100.0\n\n0 0 10 0 4.0 255 0 0\n-50 50 0 10 1.0 0 255 0\n"
                   "50 -50 -20 0 16 0 0 255\n50.1 -50 0 0 16 9 9 9\n250 0 0 0 16 1 1 1\n");
  const CommandResult result =
      particles({"--bodies", bodies, "--size", "300x200", "--max-size", "8", "--speed", "2", "--steps", "0",
                 "--state", folder.path("a.csv"), "-o", folder.path("a.ppm")});
  CAPTURE(result.describe());
  REQUIRE(result.status == 0);
  CHECK(result.err.find("4 bodies placed, 1 of them at the nearest free place, 1 left out beyond the box") !=
        std::string::npos);
  const std::vector<BallState> balls = read_state(folder.path("a.csv"));
  REQUIRE(balls.size() == 4);
  CHECK(balls[0].x / 65536 == 150);
  CHECK(balls[0].y / 65536 == 100);
  CHECK(balls[0].radius == (2 << 16));
  CHECK(balls[0].vx == (1 << 16));
  CHECK(balls[0].vy == 0);
  CHECK(balls[1].x / 65536 == 100);
  CHECK(balls[1].y / 65536 == 50);
  CHECK(balls[1].radius == (1 << 16));
  CHECK(balls[1].vy == -65536);
  CHECK(balls[2].radius == (4 << 16));
  CHECK(balls[2].vx == -(2 << 16));
  CHECK(std::abs(balls[3].x - balls[2].x) + std::abs(balls[3].y - balls[2].y) < (12 << 16));
  const std::string ppm = read_text(folder.path("a.ppm"));
  const std::size_t centre = std::string("P6\n300 200\n255\n").size() + 3 * (100 * 300 + 150);
  CHECK(ppm.substr(centre, 3) == std::string("\xFF\0\0", 3));
  // There is no gravity unless asked for: the first body flies straight on.
  REQUIRE(particles({"--bodies", bodies, "--count", "1", "--size", "300x200", "--steps", "10", "--state",
                     folder.path("b.csv"), "--quiet"})
              .status == 0);
  const std::vector<BallState> later = read_state(folder.path("b.csv"));
  REQUIRE(later.size() == 1);
  CHECK(later[0].vy == 0);
  CHECK(later[0].y / 65536 == 100);

  const std::vector<std::pair<std::string, std::string>> damaged{
      {"\n\n", "the file holds no bodies"},
      {"two\n1\n", "line 1, column 1: the number of bodies is 'two'"},
      {"1 2\n1\n", "line 1, column 3: '2' is one value too many"},
      {"1\n", "the radius of the world, on the second line, is missing"},
      {"1\n0\n", "line 2, column 1: the radius of the world is '0', which is not above 0"},
      {"1\n1\n0 0 0 0 1 0 0 0 7\n", "line 3, column 17: '7' is one value too many"},
      {"1\n1\n0 0  nan 0 1 0 0 0\n", "line 3, column 6: vx is 'nan', which is not a finite number"},
      {"1\n1\n0 0 0 1e999 1 0 0 0\n", "line 3, column 7: vy is '1e999', which is not a finite number"},
      {"1\n1\n0 0 0 0 -1 0 0 0\n", "line 3, column 9: the mass is '-1', which is not above 0"},
      {"1\n1\n0 0 0 0 1 0 256 0\n", "line 3, column 13: green is '256'"},
      {"1\n1\n0 0 0 0 1 0 0\n", "line 3, column 14: blue is missing"},
      {"1\n1\n0,0 0 0 0 1 0 0 0\n", "line 3, column 1: x is '0,0', which is not a number"},
      {"2\n1\n0 0 0 0 1 0 0 0\n", "the file ends after 1 of the 2 bodies announced"},
      {"1\n1\n0 0 0 0 1 0 0 0\n0 0 0 0 1 0 0 0\n",
       "line 4, column 1: there are more bodies than the 1 announced"},
      {"1\n1\n5 0 0 0 1 0 0 0\n", "none of the 1 bodies lies in a box"}};
  for (const auto& [text, sentence] : damaged) {
    const std::string path = folder.write("damaged.txt", text);
    CAPTURE(text);
    check_refused({"particles", "--bodies", path, "--steps", "1", "--state", folder.path("no.csv")}, 1,
                  {"damaged.txt: " + sentence});
  }
  CHECK(folder.names() == Words{"a.csv", "a.ppm", "b.csv", "bodies.txt", "damaged.txt"});
}

TEST_CASE("particles: the real bodies -> placed and played") {
  const char* const data = std::getenv("THIMBLE_DATA");
  if (data == nullptr) {
    MESSAGE("skipped: THIMBLE_DATA is not set");
    return;
  }
  const auto run = [data](const char* name, const char* size) {
    return stats_of({"--bodies", std::string(data) + "/nbody/" + name, "--size", size, "--steps", "20"});
  };
  CHECK(run("collision1.txt", "800x600").at("particles") > 1300);
  CHECK(run("cluster2582.txt", "800x600").at("particles") > 800);
#ifndef __SANITIZE_ADDRESS__
  CHECK(run("galaxy30k.txt", "1600x1600").at("particles") > 29000);
#endif
}

TEST_CASE("particles: wrong usage -> status 2 and a sentence that quotes what is wrong") {
  const std::vector<Words> wrong{{"--size", "0x0"},
                                 {"--size", "0x600"},
                                 {"--size", "800"},
                                 {"--size", "800x20000"},
                                 {"--size", "-8x8"},
                                 {"--count", "-1"},
                                 {"--count", "1e3"},
                                 {"--min-size", "0"},
                                 {"--max-size", "17"},
                                 {"--bounciness", "nan"},
                                 {"--bounciness", "1.1"},
                                 {"--bounciness", "-0.1"},
                                 {"--gravity", "0"},
                                 {"--gravity", "nan,0"},
                                 {"--gravity", "0,inf"},
                                 {"--gravity", "0,2000"},
                                 {"--gravity", "1,2,3"},
                                 {"--speed", "nan"},
                                 {"--speed", "9000"},
                                 {"--substeps", "3"},
                                 {"--subpixel-bits", "16"},
                                 {"--steps", "-1"},
                                 {"--steps", "many"},
                                 {"--seed", "-1"},
                                 {"--display", "hologram"},
                                 {"--eps", "0"},
                                 {"--fps", "0"},
                                 {"-o", "frame.tga"},
                                 {"--record", "a.mp4"},
                                 {"--input", ""},
                                 {"--min-size", "5", "--max-size", "4"}};
  for (const Words& words : wrong) {
    check_refused(Words{"particles"} + words, 2, {words[0] == "-o" ? "output" : words[0]});
  }
}

TEST_CASE("particles: what does not fit, cannot be read or written -> status 1, a sentence, nothing left") {
  const TemporaryFolder folder;
  const std::string state = folder.path("a.csv");
  const auto refused = [&](const Words& words, const std::string& sentence) {
    check_refused(Words{"particles"} + words + Words{"--steps", "3", "--state", state}, 1, {sentence});
  };
  refused({"--size", "50x40", "--count", "500"},
          "500 balls of 2 to 12 cells do not fit into 50 x 40 cells; ");
  refused({"--size", "3x3", "--min-size", "4", "--count", "1"},
          "1 balls of 4 to 12 cells do not fit into 3 x 3 cells; 0 did");
  refused({"--bodies", folder.path("none.txt")}, "none.txt: ");
  refused({"--input", folder.path("none.txt")}, "none.txt: ");
  refused({"--input", folder.path()}, folder.path() + ": ");
  refused({"-o", folder.path("no/a.png")}, "no/a.png");
  refused({"--field", folder.path("no/a.pbm")}, "no/a.pbm");
  refused({"--record-input", folder.path("no/a.txt")}, "no/a.txt");
  refused({"--field", state}, "a.csv");
  refused({"--input", state, "--bodies", state}, "a.csv");
  const std::vector<std::pair<std::string, std::string>> scripts{
      {"0 key a\n", "line 1, column 1: a line is TICK: "},
      {"# one\n\n x: key a\n", "line 3, column 2: the tick is 'x'"},
      {"-1: key a\n", "line 1, column 1: the tick is '-1'"},
      {"1 2: key a\n", "line 1, column 3: '2' is too much after the tick"},
      {": key a\n", "line 1, column 1: the tick is missing"},
      {"1:\n", "line 1, column 3: an event: key, move, press, release, wheel or end is missing"},
      {"1: jump\n", "line 1, column 4: 'jump' is not key, move, press, release, wheel or end"},
      {"1: key\n", "line 1, column 7: the key is missing"},
      {"1: key ab\n", "line 1, column 8: 'ab' is not a key"},
      {"1: key a b\n", "line 1, column 10: 'b' is too much after the event"},
      {"1: move 3\n", "line 1, column 9: the place is '3', which is not X,Y"},
      {"1: move 3,4.5\n", "line 1, column 11: y is '4.5'"},
      {"1: press first 3,4\n", "line 1, column 10: 'first' is not left, middle or right"},
      {"1: wheel up 3,4\n", "line 1, column 10: the number of steps is 'up'"},
      {"5: key a\n4: key b\n", "line 2, column 1: tick 4 comes after tick 5"},
      {"5: end\n6: key b\n", "line 2, column 1: an event follows the end"},
      {"99999999999999999999: end\n", "line 1, column 1: the tick is '99999999999999999999'"}};
  for (const auto& [each_text, sentence] : scripts) {
    const auto& text = each_text;
    CAPTURE(text);
    refused({"--input", folder.write("script.txt", text)}, "script.txt: " + sentence);
  }
  CHECK(folder.names() == Words{"script.txt"});
}

TEST_CASE("particles: no loss and gravity too strong for the step -> a note names the substeps") {
  struct Row {
    const char* gravity;
    const char* parts;
    const char* bounciness;
    const char* note;  // "" where there is none
  };
  constexpr Row kRows[] = {
      {"0,0.25", "1", "1", ""},
      {"0,0.1", "1", "1", ""},
      {"0,20", "1", "0.9", ""},
      {"0,-0.3", "1", "1", "--substeps 2 keeps it"},
      {"0.2,0.2", "1", "1", "--substeps 2 keeps it"},
      {"0,1", "2", "1", "--substeps 4 keeps it"},
      {"0,1", "4", "1", ""},
      {"0,20", "1", "1", "no number of substeps keeps it"},
      {"0,20", "16", "1", "no number of substeps keeps it"},
  };
  for (const Row& row : kRows) {
    CAPTURE(row.gravity);
    CAPTURE(row.parts);
    const CommandResult result = particles({"--gravity", row.gravity, "--substeps", row.parts, "--bounciness",
                                            row.bounciness, "--steps", "1", "--count", "3"});
    CHECK(result.status == 0);
    const std::size_t note = result.err.find("note: ");
    CHECK((note == std::string::npos) == (row.note[0] == '\0'));
    CHECK(result.err.find(row.note) != std::string::npos);
  }
}
