// `thimble trace`: the contract of its lines, how rays are quantised, and every answer against the exact
// reference.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/hit_rows.h"
#include "support/json.h"
#include "support/ray_cases.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

struct Traced {
  std::vector<HitRow> rows;
};

// Traces `rays` in `scene`, which is read as voxels when it ends in .xyz.
Traced trace(const TemporaryFolder& folder, const std::string& scene, const std::string& rays,
             const Words& options = {}) {
  Words words{"trace", scene, "--rays", folder.write("rays.csv", rays), "-o", folder.path("hits.csv")};
  if (scene.ends_with(".xyz")) {
    words.push_back("--as-voxels");
  }
  check_done(words + options);
  return {parse_hits(read_text(folder.path("hits.csv")), false)};
}

std::string full_text(double number) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", number);
  return text.data();
}

using Direction = std::array<std::int64_t, 3>;

}  // namespace

TEST_CASE(
    "trace: a ray at a voxel, one past it, one inside it -> the lines of the contract, value by value") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("one.xyz", "3 1 2\n");
  trace(folder, scene,
        "ox,oy,oz,dx,dy,dz\n"
        "0,1.5,2.5,2,0,0\n"
        "0,5,5,1,0,0\n"
        "3.5,1.5,2.5,0,0,-7\n"
        "-1,-3,-2,1,1,1\n");
  const std::vector<std::string> lines = lines_of(read_text(folder.path("hits.csv")));
  REQUIRE(lines.size() == 5);
  CHECK(lines[0] == kHitHeader);
  const auto without_nodes = [](const std::string& line) {
    std::string text;
    const std::vector<std::string> columns = split(line);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      text += (i == 0 ? "" : ",") + (i == 6 ? "*" : columns[i]);
    }
    return text;
  };
  CHECK(without_nodes(lines[1]) == "1,3,1,2,1.5,0,*,0,384,640,2,0,0,0,3");
  CHECK(without_nodes(lines[2]) == "0,,,,,,*,0,1280,1280,1,0,0,,");
  CHECK(without_nodes(lines[3]) == "1,3,1,2,0,-1,*,896,384,640,0,0,-7,0,0");
  // Through the edge x = 3, y = 1 at t = 4, two axes at once: the lower one.
  CHECK(without_nodes(lines[4]) == "1,3,1,2,4,0,*,-256,-768,-512,1,1,1,0,6.928203230275509");
}

TEST_CASE(
    "trace: header or none, CRLF, blanks, empty lines, signs, exponents, no last line feed -> the same "
    "rays") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("one.xyz", "3 1 2\n");
  const auto answers = [&](const std::string& rays) {
    trace(folder, scene, rays);
    return read_text(folder.path("hits.csv"));
  };
  const std::string plain = answers("0,1.5,2.5,2,0,0\n1,1,1,0,-1,3\n");
  for (const char* rays :
       {"ox,oy,oz,dx,dy,dz\n0,1.5,2.5,2,0,0\n1,1,1,0,-1,3\n", "0,1.5,2.5,2,0,0\n1,1,1,0,-1,3",
        "ox,oy,oz,dx,dy,dz\r\n0,1.5,2.5,2,0,0\r\n1,1,1,0,-1,3\r\n",
        "\n\n 0 ,\t1.5, 2.5,2 ,0,0 \n   \n1,1,1,0,-1,3\n\n",
        "-0,+1.5,25e-1,2.000,-0,-0.0\n1e0,0.1E+1,1.,0,-1,3\n",
        "x0,y0,z0,x1,y1,z1\n0,1.5,2.5,2,0,0\n1,1,1,0,-1,3\n",
        "\"ox\",\"oy\",\"oz\",\"dx\",\"dy\",\"dz\"\n0,1.5,2.5,2,0,0\n1,1,1,0,-1,3\n",
        "\xEF\xBB\xBFox,oy,oz,dx,dy,dz\n0,1.5,2.5,2,0,0\n1,1,1,0,-1,3\n"}) {
    CAPTURE(rays);
    CHECK(answers(rays) == plain);
  }
  CHECK(answers("ox,oy,oz,dx,dy,dz\n") == std::string(kHitHeader) + "\n");
}

TEST_CASE(
    "trace, render --hits: arrays in and out -> the same as lines; a table that holds no rays -> a "
    "sentence") {
  const TemporaryFolder folder;
  const auto save = [&](const std::string& shape, const std::vector<double>& numbers) {
    std::string text = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + shape + "), }";
    text.resize(118, ' ');
    std::string file = std::string("\x93NUMPY\1\0", 8) + little(118, 2) + text;
    for (const double number : numbers) {
      file += little(number);
    }
    return folder.write("rays.npy", file);
  };
  const std::string scene = folder.write("one.xyz", "3 1 2\n");
  const std::string lines = "0,1.5,2.5,2,0,0\n0,5,5,1,0,0\n-1,-3,-2,1,1,1\n";
  trace(folder, scene, lines);
  const std::string wanted = read_text(folder.path("hits.csv"));
  const std::vector<double> rays{0, 1.5, 2.5, 2, 0, 0, 0, 5, 5, 1, 0, 0, -1, -3, -2, 1, 1, 1};
  const std::string file = save("3, 6", rays);
  const auto run = [&](const std::string& output) {
    check_done({"trace", scene, "--as-voxels", "--rays", file, "-o", output});
    return read_text(output);
  };
  CHECK(run(folder.path("hits.csv")) == wanted);
  // Of each record 60 bytes: the columns of the header, one after the other, without gaps.
  const auto check_array = [&](const std::string& array, const std::string& csv, bool has_pixels) {
    const std::size_t record = has_pixels ? 68 : 60;
    const std::vector<HitRow> rows = parse_hits(csv, has_pixels);
    const std::size_t head =
        10 + (static_cast<std::uint8_t>(array[8]) | static_cast<std::size_t>(array[9]) << 8);
    CHECK(head % 64 == 0);
    CHECK(array.find("'shape': (" + std::to_string(rows.size()) + ",)") < head);
    REQUIRE(array.size() == head + record * rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      CAPTURE(i);
      const HitRow& row = rows[i];
      std::size_t at = head + i * record;
      const auto next = [&](std::size_t size) {
        const std::string bytes = array.substr(at, size);
        at += size;
        return bytes;
      };
      const auto number = [](std::int64_t value, std::size_t size) {
        return little(static_cast<std::uint64_t>(value), size);
      };
      const double never = std::numeric_limits<double>::infinity();
      if (has_pixels) {
        CHECK(next(4) == number(row.px, 4));
        CHECK(next(4) == number(row.py, 4));
      }
      CHECK(next(1) == number(row.hit ? 1 : 0, 1));
      for (const auto coordinate : row.voxel) {
        CHECK(next(4) == number(row.hit ? coordinate : -1, 4));
      }
      CHECK(next(8) == little(row.hit ? std::stod(row.t) : never));
      CHECK(next(1) == number(row.hit ? row.axis : -1, 1));
      CHECK(next(4) == number(row.nodes, 4));
      at += 24;
      CHECK(next(2) == number(row.hit ? row.material : -1, 2));
      CHECK(next(8) == little(row.hit ? row.distance : never));
    }
  };
  check_array(run(folder.path("hits.npy")), wanted, false);
  for (const char* structure : {"compact", "dense"}) {
    const auto picture = [&](const std::string& hits) {
      check_done({"render", scene, "--as-voxels", "--structure", structure, "--size", "9x7", "-o",
                  folder.path("p.png"), "--hits", hits});
      return read_text(hits);
    };
    const std::string csv = picture(folder.path("h.csv"));
    check_array(picture(folder.path("h.npy")), csv, true);
  }
  const auto refused = [&](const std::string& path, const std::string& named) {
    check_refused({"trace", "spheres", "--rays", path}, 1, {named});
  };
  refused(save("3, 5", rays), "this array has 5 columns");
  refused(save("18", rays), "no table");
  refused(save("4, 6", rays), "has room for 18");
  std::vector<double> bad = rays;
  bad[9] = std::nan("");
  refused(save("3, 6", bad), "rays.npy: row 1: ");
}

TEST_CASE("trace: a line that is no ray -> status 1, file and line named, nothing written, stdout included") {
  const TemporaryFolder folder;
  const std::string good = "ox,oy,oz,dx,dy,dz\n0,0,0,1,1,1\n";
  for (const char* bad : {"nan,0,0,1,0,0",    "0,0,0,1,0,NaN",     "inf,0,0,1,0,0",     "0,0,0,-inf,0,0",
                          "0,0,0,1e999,0,0",  "0,0,0,0,0,0",       "0,0,0,-0,0,0.0",    "0,0,0,1e-999,0,0",
                          "320.01,0,0,1,0,0", "0,-256.01,0,1,0,0", "0,0,1e300,1,0,0",   "0,0,0,1,0,0,0",
                          "0,0,0,1,0",        "0,0,0,1,0,",        ",0,0,1,0,0",        "0,0,0,1,0,0x10",
                          "0,0,0,1,0,one",    "0 0 0 1 0 0",       "0;0;0;1;0;0",       "+-1,0,0,1,0,0",
                          "--1,0,0,1,0,0",    "ox,oy,oz,dx,dy,dz", "0,0,0,1,0,0 # ray", "\x01"}) {
    CAPTURE(bad);
    const std::string rays = folder.write("rays.csv", good + bad + "\n0,0,0,1,1,1\n");
    const std::string hits = folder.write("hits.csv", "as it was");
    check_refused({"trace", "spheres", "--rays", rays, "-o", hits}, 1, {rays + ": line 3: "});
    CHECK(read_text(hits) == "as it was");
    CHECK(folder.names() == Words{"hits.csv", "rays.csv"});
    CHECK(run_command({"trace", "spheres", "--rays", rays}).out.empty());
  }
  // The first line is a header only when nothing in it is a number.
  for (const char* bad : {"1,2,3,4,5,z", "nan,nan,nan,nan,nan,nan,nan", "0,0,0,1,0", "a,b,c,1,2,3",
                          "dx,dy,dz,ox,oy,oz\n1,1,1,0,0,5", "\"ox\",oz,oy,dx,dy,dz\n1,1,1,0,0,5"}) {
    CAPTURE(bad);
    check_refused({"trace", "spheres", "--rays", folder.write("rays.csv", bad)}, 1, {"line 1: "});
  }
  check_refused({"trace", "spheres", "--rays", folder.write("rays.csv", "")}, 1, {"rays.csv"});
  check_refused({"trace", "spheres", "--rays", folder.path("none.csv")}, 1, {"none.csv"});
}

TEST_CASE("trace: origins at the very limits, -4 and 5 world sizes -> accepted, and the next number is not") {
  const TemporaryFolder folder;
  for (const char* depth : {"1", "6", "12"}) {
    const double side = 1 << std::stoi(depth);
    const Words options{"--depth", depth};
    const std::string low = full_text(-4 * side);
    const std::string high = full_text(5 * side);
    CHECK(trace(folder, "points:4", low + "," + high + ",0,1,-1,0\n" + high + ",0," + low + ",-1,0,1\n",
                options)
              .rows.size() == 2);
    for (const double beyond : {std::nextafter(-4 * side, -1e9), std::nextafter(5 * side, 1e9)}) {
      check_refused({"trace", "points:4", "--depth", depth, "--rays",
                     folder.write("rays.csv", "0,0," + full_text(beyond) + ",1,0,0\n")},
                    1, {"line 1"});
    }
  }
}

TEST_CASE(
    "trace: directions of integers up to 65535 -> as given; others turn by less than 2^-15, zeros stay") {
  const TemporaryFolder folder;
  constexpr std::uint64_t kSeed = 60601;
  CAPTURE(kSeed);
  std::mt19937_64 random(kSeed);
  std::string text;
  std::vector<std::array<double, 6>> rays;
  for (int i = 0; i < 20000; ++i) {
    std::array<double, 6> ray{};
    // Whole numbers that are kept, fractions, whole numbers too large, and components of any size beside one of 1.
    const int kind = i % 4;
    const std::int64_t most = kind == 0 ? 65535 : std::int64_t{1} << 50;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray[axis] = std::ldexp(static_cast<double>(pick(random, -(1LL << 40), 1LL << 40)), -34);  // -64 .. 64
      const int exponent = kind == 1 ? -50 : kind == 3 && axis != 0 ? pick_int(random, -1050, 850) - 50 : 0;
      ray[axis + 3] =
          pick(random, 0, 5) == 0 ? 0 : std::ldexp(static_cast<double>(pick(random, -most, most)), exponent);
    }
    if (ray[3] == 0 && ray[4] == 0 && ray[5] == 0) {
      ray[5] = kind == 3 ? 5e-324 : 1;
    }
    rays.push_back(ray);
    for (std::size_t column = 0; column < 6; ++column) {
      text += full_text(ray[column]) + (column == 5 ? "\n" : ",");
    }
  }
  const Traced traced = trace(folder, "spheres", text);
  REQUIRE(traced.rows.size() == rays.size());
  long double worst = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    CAPTURE(i);
    const reference::Ray& ray = traced.rows[i].ray;
    std::array<long double, 3> a{};
    std::array<long double, 3> b{};
    long double largest = 0;
    bool as_given = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      REQUIRE(std::abs(static_cast<double>(ray.origin_q8[axis]) - rays[i][axis] * 256) <= 0.5);
      a[axis] = rays[i][axis + 3];
      b[axis] = static_cast<long double>(ray.direction[axis]);
      largest = std::max(largest, std::abs(a[axis]));
      as_given = as_given && a[axis] == b[axis];
      REQUIRE((ray.direction[axis] == 0 || (ray.direction[axis] > 0) == (a[axis] > 0)));
    }
    REQUIRE((as_given || i % 4 != 0));
    long double dot = 0;
    long double cross = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      a[axis] /= largest;  // long double has the exponents, the sum of squares might not
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t y = (axis + 1) % 3;
      const std::size_t z = (axis + 2) % 3;
      const long double part = a[y] * b[z] - a[z] * b[y];
      dot += a[axis] * b[axis];
      cross += part * part;
    }
    worst = std::max(worst, std::atan2(std::sqrt(cross), dot));
  }
  CHECK(worst < std::ldexp(1.0L, -15));
  CHECK(worst > 0);
}

TEST_CASE("trace: --direction-bits -> directions within them, and the default takes what 20 bits give") {
  const TemporaryFolder folder;
  for (const int bits : {8, 13, 20}) {
    const Traced traced = trace(folder, "spheres", "1,2,3,0.3,-1,0.7\n1,2,3,3,-2,1\n",
                                {"--direction-bits", std::to_string(bits)});
    CHECK(traced.rows[0].ray.direction[1] == -((1 << bits) - 1));
    CHECK(traced.rows[1].ray.direction == Direction{3, -2, 1});
  }
}

TEST_CASE("trace: random rays, many aimed at edges and corners -> every one as the exact reference says") {
  const TemporaryFolder folder;
  const int kRays = thimble::tests::many_or_few(15000, 1500);
  struct Case {
    WorldKind kind;
    reference::Voxel size;
  };
  std::uint64_t seed = 880;
  for (const Case& one :
       {Case{WorldKind::kRandom, {16, 16, 16}}, Case{WorldKind::kCheckerboard, {32, 32, 32}},
        Case{WorldKind::kSparse, {512, 512, 512}}, Case{WorldKind::kSparse, {4096, 4096, 4096}},
        Case{WorldKind::kCorners, {4096, 4096, 4096}}, Case{WorldKind::kShell, {24, 24, 24}},
        Case{WorldKind::kDense, {32, 32, 32}}, Case{WorldKind::kSingle, {64, 64, 64}}}) {
    ++seed;
    std::mt19937_64 random(seed);
    const World world = make_world(one.kind, one.size, random);
    const reference::BitGrid grid(one.size, world.voxels);
    RayCases cases(seed, one.size, world.voxels);
    std::string text;
    std::vector<reference::Ray> given;
    for (int i = 0; i < kRays; ++i) {
      const reference::Ray ray = cases.next().ray;
      given.push_back(ray);
      for (const std::int64_t origin : ray.origin_q8) {
        text += full_text(static_cast<double>(origin) / 256) + ",";
      }
      text += std::to_string(ray.direction[0]) + "," + std::to_string(ray.direction[1]) + "," +
              std::to_string(ray.direction[2]) + "\n";
    }
    int depth = 1;
    while ((1 << depth) < one.size[0]) {
      ++depth;
    }
    const std::string scene = folder.write("world.xyz", as_xyz(world.voxels));
    for (const char* structure : {"compact", "pool", "dense"}) {
      if (std::string(structure) == "dense" && one.size[0] > 512) {
        continue;  // 8 GiB
      }
      const Traced traced =
          trace(folder, scene, text, {"--depth", std::to_string(depth), "--structure", structure});
      REQUIRE(traced.rows.size() == given.size());
      int hits = 0;
      std::string first_fault;
      for (std::size_t i = 0; i < given.size(); ++i) {
        hits += traced.rows[i].hit ? 1 : 0;
        std::string fault = traced.rows[i].ray == given[i]
                                ? judge(grid, traced.rows[i])
                                : "the ray is not traced as given: " + reference::describe(given[i]);
        if (first_fault.empty()) {
          first_fault = fault;
        }
      }
      CAPTURE(seed);
      CAPTURE(structure);
      CHECK(first_fault == "");
      CHECK(hits > 0);
    }
  }
}

TEST_CASE("trace: --engine ray32 -> the same lines, or the line of the first ray that needs more") {
  const TemporaryFolder folder;
  const std::string rays = "1,2,3,300,-200,100\n-9,30,30,5,0,0\n70,70,70,-255,-255,-254\n";
  trace(folder, "spheres", rays);
  const std::string wide = read_text(folder.path("hits.csv"));
  trace(folder, "spheres", rays, {"--engine", "ray32"});
  CHECK(read_text(folder.path("hits.csv")) == wide);
  check_refused({"trace", "spheres", "--engine", "ray32", "--rays",
                 folder.write("rays.csv", rays + "1,2,3,1000000,1,1\n")},
                1, {"line 4"});
}

TEST_CASE("trace: empty scene, one voxel, deepest world -> answers, not errors") {
  const TemporaryFolder folder;
  const Traced empty = trace(folder, "points:0", "0,0,0,1,1,1\n");
  CHECK(!empty.rows[0].hit);
  const Traced one =
      trace(folder, folder.write("corner.xyz", "4095 4095 4095\n"), "-16384,4095.5,4095.5,1,0,0\n");
  CHECK(one.rows[0].hit);
  CHECK(one.rows[0].t == "20479");
}

TEST_CASE(
    "trace: a file of many rays -> by vectors, and but for nodes the lines of ray64; small budgets: ray64") {
  const TemporaryFolder folder;
  std::mt19937_64 random(77);
  std::string rays = "ox,oy,oz,dx,dy,dz\n\n";
  constexpr int kRays = 100000;
  const std::string kScene = "points:20000,depth=8";
  for (int i = 0; i < kRays; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      rays += std::to_string(static_cast<double>(pick(random, -256 * 100, 256 * 356)) / 256) + ',';
    }
    rays += std::to_string(pick(random, 1, 9)) + ',' + std::to_string(pick(random, -9, 9)) + ',' +
            std::to_string(pick(random, -70000, 70000)) + (i % 3 == 0 ? "\r\n" : "\n");
  }
  const std::string path = folder.write("rays.csv", rays);
  // The columns without `nodes`, and the engine.
  const auto lines_of = [&](const Words& options, std::string* engine, std::string* nodes) {
    check_done(Words{"trace", kScene, "--rays", path, "-o", folder.path("hits.csv"), "--stats",
                     folder.path("s.json")} +
               options);
    const auto stats = read_json(folder.path("s.json"));
    *engine = stats["engine"];
    CHECK(stats["rays"] == kRays);
    std::string kept;
    nodes->clear();
    int column = 0;
    for (const char letter : read_text(folder.path("hits.csv"))) {
      column = letter == '\n' ? 0 : letter == ',' ? column + 1 : column;
      (column == 6 ? *nodes : kept) += letter;
    }
    return kept;
  };
  std::string engine;
  std::string nodes;
  std::string tree_nodes;
  const std::string expected = lines_of({"--engine", "ray64", "--threads", "1"}, &engine, &tree_nodes);
  CHECK(engine == "ray64");
  CHECK(lines_of({"--threads", "3"}, &engine, &nodes) == expected);
  CHECK(engine == "wide");
  CHECK(nodes != tree_nodes);
  // Just what the scene needs is no room for the map.
  const std::string sentence = run_command({"trace", kScene, "--rays", path, "--memory", "1K"}).err;
  constexpr std::string_view kBefore = "needs ";
  REQUIRE(sentence.find(kBefore) != std::string::npos);
  std::string least = sentence.substr(sentence.find(kBefore) + kBefore.size());
  least = least.substr(0, least.find(' '));
  std::erase(least, ',');
  CHECK(lines_of({"--memory", least}, &engine, &nodes) == expected);
  CHECK(engine == "ray64");
  CHECK(nodes == tree_nodes);
}

TEST_CASE("trace: the first line that is no ray, far on in a long file -> its number") {
  const TemporaryFolder folder;
  std::string rays = "ox,oy,oz,dx,dy,dz\n";
  constexpr int kGood = 60000;
  for (int i = 0; i < kGood; ++i) {
    rays += i % 1000 == 0 ? "\n" : "1,2,3,4,5,6\n";
  }
  const std::string path = folder.write("rays.csv", rays + "1,2,3,4,5\n" + rays);
  check_refused({"trace", "spheres", "--rays", path, "-o", folder.path("hits.csv")}, 1,
                {"line " + std::to_string(kGood + 2) + ": these are not the six numbers"});
}
