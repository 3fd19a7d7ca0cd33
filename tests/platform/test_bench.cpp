#include <doctest/doctest.h>

#include <map>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/demo_view.h"
#include "boards/board_table.h"
#include "golden/demo_table.h"
#include "support/baked_demo.h"
#include "support/simulated_run.h"

namespace {

using namespace thimble;

struct BenchRun : tests::SimulatedRun {
  std::map<std::string, std::string> values;  ///< the lines `name,value`
};

BenchRun run_bench(const char* board, std::span<const std::uint8_t> scene) {
  BenchRun run{
      tests::run_simulated({platform::find_board(board), true, {scene.data(), scene.size()}, apps::bench},
                           UINT32_MAX),
      {}};
  CHECK(run.fault == "");
  for (std::size_t from = 0; from < run.out.size();) {
    const std::size_t to = std::min(run.out.find('\n', from), run.out.size());
    const std::string line = run.out.substr(from, to - from);
    const std::size_t comma = line.find(',');
    if (comma != std::string::npos) {
      run.values[line.substr(0, comma)] = line.substr(comma + 1);
    }
    from = to + 1;
  }
  return run;
}

}  // namespace

TEST_CASE(
    "bench: the demo scene on boards with and without room for a map -> golden pictures, exact, status 0") {
  const tools::Baked scene = tests::bake_words("demo");
  for (const char* board : {"lm3s6965evb", "stm32vldiscovery", "netduinoplus2"}) {
    CAPTURE(std::string(board));
    BenchRun run = run_bench(board, scene.bytes);
    CHECK(run.status == 0);
    CHECK(run.values["board"] == board);
    CHECK(run.values["exact"] == "yes");
    const bool has_map = run.values["map_bytes"] != "0";
    CHECK(has_map == (std::string(board) != "stm32vldiscovery"));
    for (const std::string engine : {"tree", "brick_map"}) {
      if (engine == "brick_map" && !has_map) {
        CHECK(run.values.count("brick_map.node_visits") == 0);
        continue;
      }
      for (std::uint32_t i = 0; i < apps::kGoldenFrames; ++i) {
        const std::string crc = run.values[engine + ".crc." + std::to_string(i * apps::kGoldenStep)];
        REQUIRE(crc.size() == 8);
        CHECK(std::stoul(crc, nullptr, 16) == golden::kDemoFrameCrc32[i]);
      }
      const double coverage = std::stod(run.values[engine + ".coverage_percent"]);
      CHECK(coverage > 92);
      CHECK(coverage < 100);
      CHECK(run.values.count(engine + ".instructions_median") == 1);
    }
    CHECK(std::stoul(run.values["tree.node_visits"]) > 8192);
    CHECK(run.values["ray32.rays"] == "128");
    CHECK(run.values["ray64.rays"] == "128");
    CHECK(run.values["ray32.node_visits_a_ray"] == run.values["ray64.node_visits_a_ray"]);
    CHECK(std::stoul(run.values["arena_used_bytes"]) <= std::stoul(run.values["arena_bytes"]));
  }
}

TEST_CASE("bench: rays too long for 32 bits, no scene, a damaged one -> said so") {
  // A world of 4096 a side: no map and no 32-bit path.
  BenchRun run = run_bench("mps2-an500", tests::bake_words("points:1000,depth=12").bytes);
  CHECK(run.status == 0);
  CHECK(run.values["ray32.rays"] == "0");
  CHECK(run.values["ray64.rays"] != "0");
  CHECK(run.values["map_bytes"] == "0");
  CHECK(run_bench("lm3s6965evb", {}).status == 1);
  const tools::Baked sound = tests::bake_words("spheres,depth=4");
  std::vector<std::uint8_t> damaged(sound.bytes.begin(), sound.bytes.end());
  damaged[damaged.size() - 9] ^= 1;
  run = run_bench("lm3s6965evb", damaged);
  CHECK(run.status == 1);
  CHECK(run.out.find("error: the scene is damaged") != std::string::npos);
}
