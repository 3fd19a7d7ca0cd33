// What the studies write beside the table that people read: CSV, JSON and a plot of one run, or one of them alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/json.h"
#include "support/run_command.h"
#include "support/xml_elements.h"

namespace {

using namespace thimble::tests;

struct Study {
  Words words;        // behind the scene
  std::string scene;  // none: a file with a name that XML has to write otherwise
  bool help_names_columns;
  int elements;  // of the plot, at least
  Words plotted;
};

std::ptrdiff_t commas(const std::string& line) {
  return std::count(line.begin(), line.end(), ',');
}

}  // namespace

TEST_CASE("studies: CSV, JSON and plot -> the same rows, columns as in the help, well-formed XML") {
  const TemporaryFolder folder;
  const std::string path = folder.write("a<&\">.xyz", "0 0 0\n3 1 2\n2 2 2\n");
  const std::string escaped = "a&lt;&amp;&quot;&gt;.xyz";
  for (const Study& study :
       {Study{{"memory", "--as-voxels", "--size", "20x20", "--projection", "orthographic"},
              path,
              false,
              20,
              {escaped, "bytes", "depth (a world", "dense grid", "pool", "compact tree", "DAG"}},
        Study{{"accuracy", "--as-voxels", "--size", "20x20", "--projection", "orthographic", "--rounds", "2"},
              path,
              true,
              60,
              {escaped, "PSNR", "dB", "ms", "log scale", "The front", "cut-off alone", "samples alone",
               "knobs together", "stopped early", "equal to the reference"}},
        Study{{"effects", "--size", "48x36", "--frames", "2", "--bounces", "2"},
              "water",
              false,
              16,
              {">direct-light<", ">mirror<", ">glass<", ">water<", ">depth-cue<"}}}) {
    const std::string& name = study.words.front();
    CAPTURE(name);
    const Words files{"--csv",  folder.path("a.csv"), "--json", folder.path("a.json"),
                      "--plot", folder.path("a.svg")};
    const CommandResult result = check_done(study.words + Words{study.scene} + files);
    CHECK(result.err.empty());
    for (const std::string& line : lines_of(result.out)) {
      CAPTURE(line);
      CHECK((line.size() <= 100 || line == study.scene));
    }
    const auto rows = read_json(folder.path("a.json"));
    const Words csv = lines_of(read_text(folder.path("a.csv")));
    REQUIRE(csv.size() == rows.size() + 1);
    std::string header;
    const std::string help = run_command({name, "--help"}).out;
    for (const auto& [column, value] : rows[0].items()) {
      header += (header.empty() ? "" : ",") + column;
      CAPTURE(column);
      CHECK((!study.help_names_columns || help.find(column) != std::string::npos));
      CHECK(std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return row.contains(column); }));
    }
    CHECK(csv[0] == header);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::string& first = rows[i].begin()->template get_ref<const std::string&>();
      CHECK(csv[i + 1].starts_with(first + ","));
    }
    const std::string svg = read_text(folder.path("a.svg"));
    CHECK(svg.starts_with("<svg"));
    CHECK(elements_of(svg) >= study.elements);
    CHECK(svg.find("prefers-color-scheme: dark") != std::string::npos);
    for (const std::string& words : study.plotted) {
      CAPTURE(words);
      CHECK(svg.find(words) != std::string::npos);
    }
    // Data on standard output stand alone.
    const CommandResult piped = check_done({name, "points:20,depth=3", "--csv", "-", "--size", "8x8"});
    CHECK(piped.out.starts_with(header + "\n"));
    for (const std::string& line : lines_of(piped.out)) {
      CHECK(commas(line) == commas(header));
    }
    check_refused({name, "spheres", "--csv", "-", "--json", "-"}, 1, {"standard output"});
    check_refused({name, "spheres", "--csv", "/no/such/a.csv"}, 1, {"/no/such/a.csv"});
  }
}

// `thimble table`: its columns, its judge and its plot.
namespace {

using namespace thimble::tests;

}  // namespace

TEST_CASE("table: two counts of points -> a row a projection, the paper's figures beside, no pixel wrong") {
  const TemporaryFolder folder;
  for (const char* scene : {"points", "cluster"}) {
    const CommandResult result =
        check_done({"table", "--points", "1,1000,7", "--depth", "7", "--scene", scene, "--json",
                    folder.path("t.json"), "--plot", folder.path("t.svg")});
    CHECK(result.err.empty());
    CHECK(lines_of(result.out).size() == 7);
    const Json table = read_json(folder.path("t.json"));
    REQUIRE(table.size() == 6);
    const std::vector<std::uint64_t> points{1, 1, 1000, 1000, 7, 7};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Json& row = table[i];
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
  check_refused({"table", "--points", "1", "--depth", "4"}, 2, {"5 to 12"});
}

TEST_CASE("studies: --plot with another ending -> refused; what has no name of its own takes it") {
  for (const Words& study : {Words{"table"}, Words{"memory", "demo"}, Words{"effects", "demo"}}) {
    check_refused(study + Words{"--plot", "m.png"}, 2, {"--plot", "\"m.png\"", ".svg"});
  }
  const Words small{"memory", "points:9,depth=3", "--quiet", "--size", "8x6", "--plot"};
  CHECK(check_done(small + Words{"-"}).out.starts_with("<svg"));
  CHECK(check_done(small + Words{"/dev/stdout"}).out.starts_with("<svg"));
}

TEST_CASE("table: no points at all -> a table of misses, and a plot without lines") {
  const TemporaryFolder folder;
  check_done({"table", "--points", "0", "--depth", "5", "--json", folder.path("t.json"), "--plot",
              folder.path("t.svg")});
  const Json table = read_json(folder.path("t.json"));
  REQUIRE(table.size() == 2);
  CHECK(table[0]["hits"] == 0);
  CHECK(table[0]["exact_mismatches"] == 0);
  CHECK(elements_of(read_text(folder.path("t.svg"))) >= 10);
}
