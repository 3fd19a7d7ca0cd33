// `thimble table`: its columns, its judge and its plot.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/run_command.h"
#include "support/xml_elements.h"

namespace {

using namespace thimble::tests;
using nlohmann::json;

}  // namespace

TEST_CASE("table: two counts of points -> a row a projection, the paper's figures beside, no pixel wrong") {
  const TemporaryFolder folder;
  for (const char* scene : {"points", "cluster"}) {
    const CommandResult result =
        run_command({"table", "--points", "1,1000,7", "--depth", "7", "--scene", scene, "--json",
                     folder.path("t.json"), "--plot", folder.path("t.svg")});
    CAPTURE(result.describe());
    CHECK(result.status == 0);
    CHECK(result.err.empty());
    CHECK(lines_of(result.out).size() == 7);
    const json table = json::parse(read_text(folder.path("t.json")));
    REQUIRE(table.size() == 6);
    const std::vector<std::uint64_t> points{1, 1, 1000, 1000, 7, 7};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const json& row = table[i];
      CHECK(row["points"] == points[i]);
      CHECK(row["projection"] == (i % 2 == 0 ? "perspective" : "orthographic"));
      CHECK(row["seconds"].is_number_float());
      CHECK(row["seconds"] > 0);
      CHECK(row["hits"].is_number_unsigned());
      CHECK(row["exact_mismatches"] == 0);
      CHECK(row["engine"] == "wide");
      CHECK(row["paper_seconds"].is_null() == (points[i] == 7));
    }
    CHECK(table[2]["hits"] > 0);
    // Tables I and II of the paper.
    CHECK(table[0]["paper_seconds"] == 0.105575);
    CHECK(table[1]["paper_seconds"] == 0.007379);
    CHECK(table[2]["paper_seconds"] == 1.980592);
    CHECK(table[3]["paper_seconds"] == 0.153735);
    const std::string svg = read_text(folder.path("t.svg"));
    CHECK(svg.starts_with("<svg"));
    CHECK(elements_of(svg) >= 10);
    CHECK(svg.find("seconds a frame") != std::string::npos);
  }
}

TEST_CASE("table: a world too small for 800 pixels of 1/256 voxel -> refused as usage, before any work") {
  const CommandResult result = run_command({"table", "--points", "1", "--depth", "4"});
  CHECK(result.status == 2);
  CHECK(result.out.empty());
  CHECK(result.err.find("5 to 12") != std::string::npos);
}

TEST_CASE("table: no points at all -> a table of misses, and a plot without lines") {
  const TemporaryFolder folder;
  const CommandResult result = run_command({"table", "--points", "0", "--depth", "5", "--json",
                                            folder.path("t.json"), "--plot", folder.path("t.svg")});
  CAPTURE(result.describe());
  CHECK(result.status == 0);
  const json table = json::parse(read_text(folder.path("t.json")));
  REQUIRE(table.size() == 2);
  CHECK(table[0]["hits"] == 0);
  CHECK(table[0]["exact_mismatches"] == 0);
  CHECK(elements_of(read_text(folder.path("t.svg"))) >= 10);
}
