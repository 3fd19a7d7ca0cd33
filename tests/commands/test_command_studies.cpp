// What the studies write beside the table that people read: CSV, JSON and a plot of one run, or one of them alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "support/check_command.h"
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
  const std::string escaped = "a&lt;&amp;\"&gt;.xyz";
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
    const auto rows = nlohmann::ordered_json::parse(read_text(folder.path("a.json")));
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
