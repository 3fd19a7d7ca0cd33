// `thimble render`: pictures, hits, distances, cameras, budgets, each judged by something that is not the
// renderer.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "commands/scene_options.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/hit_rows.h"
#include "support/json.h"
#include "support/pictures.h"
#include "support/ray_cases.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// What these cases look at is the core's own picture: its shading is named where the words do not.
Words shaded(Words words) {
  const bool is_named =
      std::any_of(words.begin(), words.end(), [](const std::string& word) { return word == "--shade"; });
  return is_named ? words : words + Words{"--shade", "depth"};
}

CommandResult render(const Words& words) {
  return check_done(shaded(Words{"render"} + words));
}

std::string crc_of(std::string_view bytes) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08lx",
                crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  return text.data();
}

struct Rendered {
  std::vector<HitRow> hits;
  Json stats;
  std::string picture;
};

// Renders into `folder` and reads back the hits, the stats and the PPM.
Rendered render_all(const TemporaryFolder& folder, const Words& words) {
  render(words + Words{"-o", folder.path("all.ppm"), "--hits", folder.path("all.csv"), "--stats",
                       folder.path("all.json"), "--quiet"});
  return {parse_hits(read_text(folder.path("all.csv")), true), read_json(folder.path("all.json")),
          read_text(folder.path("all.ppm"))};
}

World world_of(WorldKind kind, const reference::Voxel& size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return make_world(kind, size, random);
}

std::uint64_t number_after(const std::string& text, const std::string& word) {
  std::uint64_t number = 0;
  const std::size_t at = text.find(word);
  REQUIRE(at != std::string::npos);
  for (std::size_t i = at + word.size(); i < text.size() && (std::isdigit(text[i]) != 0 || text[i] == ',');
       ++i) {
    number = text[i] == ',' ? number : number * 10 + static_cast<std::uint64_t>(text[i] - '0');
  }
  return number;
}

}  // namespace

TEST_CASE(
    "render: ppm, pgm, pbm, png -> header, size and CRC-32 of the pixel bytes; the PNG's pixels are the "
    "PPM's") {
  const TemporaryFolder folder;
  for (const char* shade : {"depth", "normal", "color", "mono"}) {
    const auto draw = [&](const std::string& ending, const std::string& header, std::size_t bytes) {
      const std::string path = folder.path("p." + ending);
      render({"spheres", "--size", "37x21", "--shade", shade, "-o", path, "--stats", folder.path("s.json"),
              "--quiet"});
      const std::string file = read_text(path);
      CAPTURE(path);
      const Json stats = read_json(folder.path("s.json"));
      if (ending != "png") {
        CHECK(file.starts_with(header));
        CHECK(file.size() == header.size() + bytes);
        CHECK(stats["frame_crc32"] == crc_of(std::string_view(file).substr(header.size())));
      }
      return std::pair(file, stats["frame_crc32"].get<std::string>());
    };
    const std::string header = "P6\n37 21\n255\n";
    const auto [ppm, ppm_crc] = draw("ppm", header, 37 * 21 * 3);
    draw("pgm", "P5\n37 21\n255\n", 37 * 21);
    const auto [pbm, pbm_crc] = draw("pbm", "P4\n37 21\n", 5 * 21);
    for (std::size_t row = 0; row < 21; ++row) {
      CHECK((static_cast<unsigned char>(pbm[std::string("P4\n37 21\n").size() + row * 5 + 4]) & 7U) == 0);
    }
    const auto [png, png_crc] = draw("png", "", 0);
    CHECK(png_crc == ppm_crc);
    const ReadPicture read = read_png(png);
    CHECK(read.width == 37);
    CHECK(read.height == 21);
    CHECK(read.channels == 3);
    CHECK(read.frames[0] == ppm.substr(header.size()));
    // Something is in the picture, and not everything.
    CHECK(std::set<char>(ppm.begin() + 13, ppm.end()).size() >= 2);
  }
}

TEST_CASE("render: --hits and --depth-image -> every pixel as the exact reference says, both projections") {
  const TemporaryFolder folder;
  struct Case {
    WorldKind kind;
    reference::Voxel size;
    Words options;
  };
  const Words parallel{"--projection", "orthographic"};
  const std::vector<Case> cases{
      {WorldKind::kRandom, {16, 16, 16}, {}},
      {WorldKind::kSparse, {100, 70, 40}, {}},
      {WorldKind::kSparse, {100, 70, 40}, parallel},
      {WorldKind::kCheckerboard, {8, 8, 8}, parallel},
      {WorldKind::kCheckerboard, {8, 8, 8}, {"--eye", "4,-9,4"}},
      {WorldKind::kShell, {12, 12, 12}, {"--eye", "6,6,6", "--target", "6,6,0", "--fov", "120"}},
      {WorldKind::kDense, {20, 20, 20}, {"--eye", "10.5,10.25,9.75", "--target", "0,0,0"}},
      {WorldKind::kCorners, {2000, 2000, 2000}, {"--eye", "-10,-10,-10", "--target", "2000,2000,2000"}},
      {WorldKind::kCheckerboard,
       {8, 8, 8},
       parallel + Words{"--eye", "-3,-3,-3", "--target", "4,4,4", "--span", "16"}},
  };
  std::uint64_t seed = 7100;
  for (const Case& one : cases) {
    CAPTURE(++seed);
    const World world = world_of(one.kind, one.size, seed);
    const std::string scene = folder.write("world.xyz", as_xyz(world.voxels));
    const reference::BitGrid grid(one.size, world.voxels);
    const Rendered all = render_all(
        folder, Words{scene, "--as-voxels", "--size", "61x43", "--depth-image", folder.path("all.pfm")} +
                    one.options);
    REQUIRE(all.hits.size() == 61 * 43);
    const std::string pfm = read_text(folder.path("all.pfm"));
    const std::string header = "Pf\n61 43\n-1.0\n";
    REQUIRE(pfm.starts_with(header));
    REQUIRE(pfm.size() == header.size() + 61 * 43 * 4);
    std::size_t hits = 0;
    std::size_t visits = 0;
    std::string first_fault;
    for (std::size_t i = 0; i < all.hits.size(); ++i) {
      const HitRow& row = all.hits[i];
      if (row.px != static_cast<int>(i % 61) || row.py != static_cast<int>(i / 61)) {
        first_fault = "not row by row from the top left";
        break;
      }
      hits += row.hit ? 1U : 0U;
      visits += static_cast<std::size_t>(row.nodes);
      float distance = 0;  // a PFM's rows go from the bottom
      std::memcpy(&distance, pfm.data() + header.size() + 4 * ((42 - i / 61) * 61 + i % 61), 4);
      float expected = std::numeric_limits<float>::infinity();
      if (row.hit) {
        long double squares = 0;
        for (const std::int64_t d : row.ray.direction) {
          squares += static_cast<long double>(d) * static_cast<long double>(d);
        }
        expected = static_cast<float>(reference::walk(grid, row.ray).t() * std::sqrt(squares));
      }
      std::string fault = judge(grid, row);
      if (fault.empty() && distance != expected &&
          !(std::abs(distance - expected) <= std::abs(expected) * 1.2e-7F)) {
        fault = "distance " + std::to_string(distance) + ", not " + std::to_string(expected);
      }
      if (first_fault.empty()) {
        first_fault = fault;
      }
    }
    CHECK(first_fault == "");
    CHECK(hits > 0);
    CHECK(all.stats["hits"] == hits);
    CHECK(all.stats["rays"] == 61 * 43);
    CHECK(all.stats["voxels"] == world.voxels.size());
    CHECK(all.stats["node_visits"] > 0);
    CHECK(all.stats["node_visits"] <= visits);
  }
}

TEST_CASE("render: one voxel off the middle -> seen up, down, left and right as right = forward x up says") {
  const TemporaryFolder folder;
  const auto where = [&](const std::string& voxel, const Words& options) {
    const std::string scene = folder.write("one.xyz", voxel + "\n");
    double x = 0;
    double y = 0;
    int count = 0;
    for (const HitRow& row :
         render_all(folder, Words{scene, "--as-voxels", "--depth", "4", "--size", "60x60"} + options).hits) {
      x += row.hit ? row.px - 29.5 : 0;
      y += row.hit ? row.py - 29.5 : 0;
      count += row.hit ? 1 : 0;
    }
    REQUIRE(count > 0);
    const double near = 4;
    return std::string(y / count < -near  ? "up"
                       : y / count > near ? "down"
                                          : "") +
           (x / count < -near  ? "left"
            : x / count > near ? "right"
                               : "");
  };
  const Words along_y{"--eye", "8.5,-15,8.5", "--target", "8.5,8,8.5"};
  const Words along_x{"--eye", "-15,8.5,8.5", "--target", "8,8.5,8.5"};
  // Along z there is no up by z: y is up.
  const Words down_z{"--eye", "8.5,8.5,31", "--target", "8.5,8.5,8"};
  const Words up_z{"--eye", "8.5,8.5,-15", "--target", "8.5,8.5,8"};
  const struct {
    const char* voxel;
    Words view;
    const char* place;
  } kRows[] = {{"8 8 14", along_y, "up"},
               {"8 8 2", along_y, "down"},
               {"14 8 8", along_y, "right"},
               {"2 8 8", along_y, "left"},
               {"14 8 14", along_y, "upright"},
               {"8 8 14", along_y + Words{"--up", "0,0,-3"}, "down"},
               {"14 8 8", along_y + Words{"--up", "0,0,-3"}, "left"},
               {"8 8 14", along_y + Words{"--up", "1,0,0"}, "left"},
               {"8 14 8", along_x, "left"},
               {"8 8 14", along_x, "up"},
               {"8 14 8", down_z, "up"},
               {"14 8 8", down_z, "right"},
               {"8 14 8", up_z, "up"},
               {"14 8 8", up_z, "left"}};
  for (const auto& row : kRows) {
    CAPTURE(row.voxel);
    CAPTURE(line_of_words(row.view));
    CHECK(where(row.voxel, row.view + Words{"--projection", "perspective"}) == row.place);
    CHECK(where(row.voxel, row.view + Words{"--projection", "orthographic", "--span", "20"}) == row.place);
  }
}

TEST_CASE("render: the paper's first tracer, 800 x 600 x 1 -> 60,000 bytes, and the picture is the grid") {
  const TemporaryFolder folder;
  std::mt19937_64 random(3);
  std::set<std::pair<int, int>> solid{{799, 599}, {0, 0}};
  while (solid.size() < 5000) {
    solid.insert({static_cast<int>(random() % 800), static_cast<int>(random() % 600)});
  }
  std::vector<reference::Voxel> voxels;
  for (const auto& [x, y] : solid) {
    voxels.push_back({x, y, 0});
  }
  const std::string scene = folder.write("flat.xyz", as_xyz(voxels));
  const Words words{scene,          "--as-voxels",
                    "--structure",  "dense",
                    "--shade",      "mono",
                    "--projection", "orthographic",
                    "--eye",        "400,300,5",
                    "--target",     "400,300,0",
                    "--span",       "800",
                    "-o",           folder.path("p.pbm"),
                    "--stats",      folder.path("s.json")};
  render(words + Words{"--quiet"});
  const Json stats = read_json(folder.path("s.json"));
  CHECK(stats["tree_bytes"] == 60000);
  CHECK(stats["voxels"] == 5000);
  CHECK(stats["hits"] == 5000);
  const std::string picture = read_text(folder.path("p.pbm"));
  const std::string header = "P4\n800 600\n";
  REQUIRE(picture.size() == header.size() + 60000);
  int wrong = 0;
  for (int y = 0; y < 600; ++y) {
    for (int x = 0; x < 800; ++x) {
      const auto byte =
          static_cast<unsigned char>(picture[header.size() + static_cast<std::size_t>(y * 100 + x / 8)]);
      const bool white = ((byte >> (7 - x % 8)) & 1) == 0;
      wrong += white != solid.contains({x, 599 - y}) ? 1 : 0;
    }
  }
  CHECK(wrong == 0);

  const std::uint64_t needed =
      number_after(check_refused(shaded(Words{"render"} + words) + Words{"--memory", "60000"}, 1,
                                 {"60,000 of them the grid of 800 x 600 x 1 voxels"})
                       .err,
                   "needs ");
  CHECK(needed > 60000);
  CHECK(needed < 61000);
  check_done(shaded(Words{"render"} + words) + Words{"--memory", std::to_string(needed)});
  CHECK(run_command(shaded(Words{"render"} + words) + Words{"--memory", std::to_string(needed - 1)}).status ==
        1);
}

TEST_CASE("render: the paper's own sum, 800 x 600 x 800 -> 48,000,000 bytes, named by the refusal") {
  const TemporaryFolder folder;
  const std::string scene = folder.write("far.xyz", "0 0 0\n799 599 799\n");
  const Words words{"info", scene, "--as-voxels", "--structure", "dense"};
  CHECK(number_after(check_refused(words + Words{"--memory", "47999999"}, 1, {}).err, "needs ") == 48000000);
  check_done(words + Words{"--memory", "48000000", "--stats", folder.path("s.json")});
  const Json stats = read_json(folder.path("s.json"));
  CHECK(stats["tree_bytes"] == 48000000);
  CHECK(stats["high_water_bytes"] == 48000000);
  CHECK(stats["budget_bytes"] == 48000000);
}

TEST_CASE(
    "render: --shade ink -> black where nothing is, white round it, by every engine; whole pictures only") {
  const TemporaryFolder folder;
  const Words view{"render", "castle", "--size", "128x64", "--shade", "ink", "--quiet", "-o"};
  check_done(view + Words{folder.path("a.pgm"), "--hits", folder.path("a.csv")});
  const std::string pixels = read_text(folder.path("a.pgm")).substr(std::strlen("P5\n128 64\n255\n"));
  REQUIRE(pixels.size() == 128 * 64);
  const std::vector<std::string> lines = lines_of(read_text(folder.path("a.csv")));
  const auto is_hit = [&](int x, int y) {
    return split(lines[static_cast<std::size_t>(y * 128 + x + 1)])[2] == "1";
  };
  int white = 0;
  int black = 0;
  for (int y = 1; y < 63; ++y) {
    for (int x = 1; x < 127; ++x) {
      const int gray = static_cast<unsigned char>(pixels[static_cast<std::size_t>(y * 128 + x)]);
      REQUIRE((gray == 0 || gray == 255));
      if (!is_hit(x, y)) {
        CHECK(gray == 0);
      } else if (!is_hit(x - 1, y) || !is_hit(x + 1, y) || !is_hit(x, y - 1) || !is_hit(x, y + 1)) {
        CHECK(gray == 255);
      } else {
        ++(gray == 0 ? black : white);
      }
    }
  }
  CHECK(std::min(white, black) > 400);  // it has faces of both
  check_done(view + Words{folder.path("b.pgm"), "--engine", "ray64"});
  CHECK(read_text(folder.path("b.pgm")) == read_text(folder.path("a.pgm")));
  check_done(view + Words{folder.path("lit.pgm"), "--effects", "direct-light,shadows"});
  CHECK(read_text(folder.path("lit.pgm")) != read_text(folder.path("a.pgm")));
  check_refused(view + Words{folder.path("c.part"), "--rows", "0:8"}, 2, {"--shade ink", "--rows"});
  check_refused(view + Words{folder.path("c.gif"), "--turntable", "4"}, 2, {"--turntable"});
  check_refused({"view", "castle", "--shade", "ink"}, 2, {"depth, normal, color or mono"});
}

TEST_CASE("render: every structure and engine -> the same picture and, but for the nodes, the same hits") {
  const TemporaryFolder folder;
  const World world = world_of(WorldKind::kRandom, {24, 20, 9}, 91);
  const std::string scene = folder.write("world.xyz", as_xyz(world.voxels));
  const std::vector<Words> scenes{{scene, "--as-voxels"},
                                  {scene, "--as-voxels", "--depth", "9"},
                                  {"spheres"},
                                  {"points:3000,depth=5"},
                                  {"points:0,depth=3"}};
  int turn = 0;
  for (const Words& one : scenes) {
    for (const char* projection : {"perspective", "orthographic"}) {
      if (turn++ % 2 != 0 && thimble::tests::takes_few()) {
        continue;  // each scene in one projection
      }
      std::vector<std::string> first;
      std::string first_picture;
      for (const char* structure : {"dense", "pool", "compact"}) {
        for (const std::string engine : {"auto", "wide", "ray64", "ray32"}) {
          const bool is_compact = std::string(structure) == "compact";
          if (engine == "wide" && !is_compact) {
            continue;
          }
          const Rendered all = render_all(
              folder, one + Words{"--size", "40x30", "--projection", projection, "--structure", structure,
                                  "--engine", engine, "--threads", engine == "wide" ? "2" : "1"});
          std::vector<std::string> lines;
          for (const std::string& line : lines_of(read_text(folder.path("all.csv")))) {
            std::vector<std::string> columns = split(line);
            columns[8] = "";
            CHECK(columns[15].empty() ==
                  (columns[2] == "0" || (columns[0] != "px" && structure == std::string("dense"))));
            columns[15] = "";  // dense grids keep none
            std::string joined;
            for (const std::string& column : columns) {
              joined += column + ",";
            }
            lines.push_back(joined);
          }
          CAPTURE(one.front());
          CAPTURE(one.back());
          CAPTURE(projection);
          CAPTURE(structure);
          CAPTURE(engine);
          if (first.empty()) {
            first = lines;
            first_picture = all.picture;
          }
          // "points" has no colours, so that a dense grid can show what the trees do.
          CHECK(all.picture == first_picture);
          CHECK(lines == first);
          const std::string used = engine == "auto" ? (is_compact ? "wide" : "ray64") : engine;
          CHECK(all.stats["engine"] == used);
          CHECK(all.stats["threads"] == (engine == "wide" ? 2 : 1));
          CHECK((used == "wide" || all.stats["box_tests"] == 0));
        }
      }
    }
  }
  const CommandResult gray =
      check_done({"render", "castle", "--structure", "dense", "--size", "8x6", "-o", "-"});
  CHECK(gray.err.find("a dense grid keeps no colors") != std::string::npos);
}

TEST_CASE("render: no room for the wide engine's lists -> rays draw the same picture, or one sentence") {
  const TemporaryFolder folder;
  const Words scene{"points:5000", "--size", "64x48"};
  const Json roomy = render_all(folder, scene).stats;
  CHECK(roomy["engine"] == "wide");
  // The tree is built in 5000 keys of 4 bytes; lists and 48 rows of 64 pixels want more than is left beside
  // it.
  const Json tight = render_all(folder, scene + Words{"--memory", "64K"}).stats;
  CHECK(tight["engine"] == "ray64");
  CHECK(tight["high_water_bytes"] <= 65536);
  CHECK(tight["frame_crc32"] == roomy["frame_crc32"]);
  CHECK(tight["hits"] == roomy["hits"]);
  // Somewhere between, the picture is drawn a few rows at a time.
  const Json between = render_all(folder, scene + Words{"--memory", "146K"}).stats;
  CHECK(between["engine"] == "wide");
  CHECK(between["high_water_bytes"] <= 146 * 1024);
  CHECK(between["frame_crc32"] == roomy["frame_crc32"]);
  CHECK(between["hits"] == roomy["hits"]);
  check_refused({"render", "points:5000", "-o", folder.path("p.ppm"), "--size", "64x48", "--engine", "wide",
                 "--memory", "64K"},
                1, {"--engine wide", "it takes about ", " are left"});
}

TEST_CASE("render: --engine ray32 on rays that need more -> status 1, nothing written") {
  const TemporaryFolder folder;
  check_refused({"render", "points:9", "-o", folder.path("p.ppm"), "--engine", "ray32", "--direction-bits",
                 "20", "--size", "9x9"},
                1, {"ray32"});
  CHECK(folder.names().empty());
}

TEST_CASE("render: --coarsen, and the compact tree would fit though the pool does not -> nothing is merged") {
  const TemporaryFolder folder;
  const auto draw = [&](const Words& budget) {
    check_done(Words{"render", "spheres", "--size", "80x60", "--shade", "color", "--quiet", "-o",
                     folder.path("p.ppm"), "--stats", folder.path("s.json")} +
               budget);
    return read_json(folder.path("s.json"));
  };
  const Json full = draw({});
  CHECK(full["budget_bytes"] == full["high_water_bytes"]);
  const Json tight = draw({"--memory", "32K", "--coarsen"});
  CHECK(full["high_water_bytes"] > 32768);
  CHECK(tight["high_water_bytes"] <= 32768);
  CHECK(tight["solid_added"] == 0);
  for (const char* key : {"voxels", "nodes", "tree_bytes", "frame_crc32", "hits"}) {
    CAPTURE(key);
    CHECK(tight[key] == full[key]);
  }
  const Json tighter = draw({"--memory", "16K", "--coarsen"});
  CHECK(tighter["solid_added"] > 0);
  CHECK(tighter["solid_added"] < full["voxels"].get<std::uint64_t>() / 2);
}

TEST_CASE("render: every budget -> the exact need is named and is exact; high water never above the budget") {
  const TemporaryFolder folder;
  const World world = world_of(WorldKind::kSparse, {60, 50, 40}, 5);
  const std::string sparse = folder.write("world.xyz", as_xyz(world.voxels));
  const std::string colored = folder.write("colored.xyz", [&] {
    std::string text;
    for (std::size_t i = 0; i < world.voxels.size(); ++i) {
      const auto& v = world.voxels[i];
      text += std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + " " +
              std::to_string(i % 7 * 30) + " " + std::to_string(i % 3 * 100) + " 9\n";
    }
    return text;
  }());
  // The third has many more points than voxels.
  const std::vector<Words> scenes{{sparse, "--as-voxels"},
                                  {colored, "--as-voxels"},
                                  {"points:20000,depth=4"},
                                  {"points:500,depth=8"},
                                  {"spheres,depth=5"}};
  int turn = 0;
  for (const Words& one : scenes) {
    for (const char* structure : {"compact", "pool", "dense"}) {
      for (const char* size : {"16x12", "400x8"}) {
        const int place = turn++;
        if (thimble::tests::takes_few() && (place / 2 + place) % 2 != 0) {
          continue;  // half of the combinations, in which each scene, structure and size is met
        }
        const Words words =
            Words{"render",  "-o",      folder.path("p.ppm"),  "--size",  size,      "--structure",
                  structure, "--stats", folder.path("s.json"), "--quiet", "--shade", "depth"} +
            one;
        CAPTURE(one.front());
        CAPTURE(structure);
        CAPTURE(size);
        const std::uint64_t needed =
            number_after(check_refused(words + Words{"--memory", "0"}, 1, {}).err, "needs ");
        check_done(words + Words{"--memory", std::to_string(needed)});
        const Json exact = read_json(folder.path("s.json"));
        CHECK(exact["budget_bytes"] == needed);
        CHECK(exact["high_water_bytes"] <= needed);
        CHECK(exact["solid_added"] == 0);
        const std::vector<std::uint64_t> too_small =
            thimble::tests::takes_few()
                ? std::vector<std::uint64_t>{needed - 1, needed / 2}
                : std::vector<std::uint64_t>{needed - 1, needed - 7, needed / 2, needed / 16, 100, 1};
        for (const std::uint64_t budget : too_small) {
          CHECK(number_after(check_refused(words + Words{"--memory", std::to_string(budget)}, 1, {}).err,
                             "needs ") == needed);
        }
        const std::vector<std::uint64_t> enough =
            thimble::tests::takes_few()
                ? std::vector<std::uint64_t>{needed + 1, needed * 3}
                : std::vector<std::uint64_t>{needed + 1, needed + 4000, needed * 3, needed * 100};
        for (const std::uint64_t budget : enough) {
          check_done(words + Words{"--memory", std::to_string(budget)});
          const Json stats = read_json(folder.path("s.json"));
          CHECK(stats["budget_bytes"] == budget);
          CHECK(stats["high_water_bytes"] <= budget);
          CHECK(stats["frame_crc32"] == exact["frame_crc32"]);
        }
      }
    }
  }
}

TEST_CASE("render: no --threads -> all cores, one within a budget, whose bytes are the same everywhere") {
  const TemporaryFolder folder;
  const auto threads = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"cluster:1000", "--size", "16x12"});
    return render_all(folder, words).stats["threads"].get<int>();
  };
  CHECK(threads({}) == thimble::tools::all_cores());
  CHECK(threads({"--threads", "1"}) == 1);
  CHECK(threads({"--memory", "1M"}) == 1);
  CHECK(threads({"--memory", "1M", "--threads", "2"}) == 2);
}

TEST_CASE("render: --stats -> every key of the contract, with its type") {
  const TemporaryFolder folder;
  const Json stats = render_all(folder, {"cluster:1000", "--size", "16x12", "--memory", "1M"}).stats;
  for (const char* key :
       {"depth", "points", "voxels", "nodes", "tree_bytes", "budget_bytes", "high_water_bytes", "solid_added",
        "rays", "hits", "node_visits", "threads", "box_tests", "exact_tests"}) {
    CAPTURE(key);
    CHECK(stats[key].is_number_unsigned());
  }
  for (const char* key : {"build_seconds", "frame_seconds"}) {
    CHECK(stats[key].is_number_float());
    CHECK(stats[key] > 0);
  }
  for (const char* key : {"scene", "engine", "frame_crc32"}) {
    CHECK(stats[key].is_string());
  }
  CHECK(stats["scene"] == "cluster:1000");
  CHECK(stats["depth"] == 10);
  CHECK(stats["points"] == 1000);
  CHECK(stats["threads"] == 1);
  CHECK(stats["budget_bytes"] == 1 << 20);
  CHECK(stats["rays"] == 16 * 12);
  CHECK(stats["frame_crc32"].get<std::string>().size() == 8);
}
