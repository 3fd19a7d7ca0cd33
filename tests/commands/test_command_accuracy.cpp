// `thimble accuracy`: its errors recomputed from what `thimble render` draws, the front and the answers from
// its own rows, and what it refuses.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <set>

#include "instruments/accuracy_study.h"
#include "instruments/hard_cases.h"
#include "output/plot.h"
#include "support/check_command.h"
#include "support/json.h"
#include "support/xml_elements.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// What all runs here share, for accuracy and for render.
const Words kView{"spheres", "--depth", "5", "--size", "40x30", "--shade", "color"};

CommandResult accuracy(const Words& words) {
  CommandResult result = check_done(Words{"accuracy"} + words);
  CHECK(result.err.empty());
  for (const std::string& line : lines_of(result.out)) {
    CAPTURE(line);
    CHECK((line.size() <= 100 || line == words.front()));
  }
  return result;
}

Json rows_of(const TemporaryFolder& folder, const Words& words, std::string* out = nullptr) {
  const CommandResult result = accuracy(words + Words{"--json", folder.path("a.json"), "--rounds", "2"});
  if (out != nullptr) {
    *out = result.out;
  }
  return read_json(folder.path("a.json"));
}

void check_accuracy_refused(const Words& words, int status, const Words& named) {
  check_refused(Words{"accuracy"} + words, status, named);
}

double decibels(const Json& row) {
  return row["psnr_db"].is_null() ? std::numeric_limits<double>::infinity() : row["psnr_db"].get<double>();
}

Words words_of(const std::string& options) {
  return options.empty() ? Words{} : split(options, ' ');
}

// What `thimble render` draws: bytes of the pixels, distances of their centres' rays, and its counts.
struct Drawn {
  std::string pixels;
  std::vector<float> distances;
  Json stats;
};

Drawn draw(const TemporaryFolder& folder, const std::string& options) {
  check_done(Words{"render", "--view", "paper", "--fov", "60"} + kView + words_of(options) +
             Words{"--engine", "ray64", "--quiet", "-o", folder.path("r.ppm"), "--depth-image",
                   folder.path("r.pfm"), "--stats", folder.path("r.json")});
  const std::string picture = read_text(folder.path("r.ppm"));
  const std::string depths = read_text(folder.path("r.pfm"));
  Drawn drawn;
  drawn.pixels = picture.substr(picture.size() - 40 * 30 * 3);
  drawn.distances.resize(40 * 30);
  std::memcpy(drawn.distances.data(), depths.data() + depths.size() - 40 * 30 * sizeof(float),
              40 * 30 * sizeof(float));
  drawn.stats = read_json(folder.path("r.json"));
  return drawn;
}

// The settings that none beats, by the definition: of less error at no more cost, or of no more error at less.
void check_front(const Json& rows, const std::string& cost, const std::string& error, double noise = 0) {
  const auto error_of = [&](const Json& row) {
    return error == "psnr_db" ? -decibels(row) : row[error].get<double>();
  };
  int front = 0;
  for (const Json& row : rows) {
    if (row["row"] == "anytime") {
      CHECK(row["front"] == 0);
      continue;
    }
    bool beaten = false;
    for (const Json& other : rows) {
      if (other["row"] == row["row"]) {
        const double mine = row[cost];
        const double theirs = other[cost];
        beaten = beaten || (error_of(other) < error_of(row) && theirs <= mine * (1 + noise)) ||
                 (error_of(other) == error_of(row) && theirs < mine);
      }
    }
    CAPTURE(row.dump());
    CHECK(row["front"] == (beaten ? 0 : 1));
    front += beaten ? 0 : 1;
  }
  CHECK(front >= 2);
}

}  // namespace

TEST_CASE("accuracy: every setting -> the errors and counts of what render draws with its options") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, kView);
  const Drawn best = draw(folder, "--direction-bits 20 --samples 64");
  std::set<std::string> groups;
  std::size_t compared = 0;
  for (const Json& row : rows) {
    if (row["row"] != "setting") {
      continue;
    }
    const std::string options = row["options"];
    groups.insert(row["group"]);
    // All that are turned alone, and some of the others.
    if (row["group"] == "together" && ++compared % 9 != 0) {
      continue;
    }
    CAPTURE(options);
    const Drawn drawn = draw(folder, options);
    std::uint64_t wrong = 0;
    std::uint64_t visible = 0;
    double squares = 0;
    for (std::size_t i = 0; i < drawn.pixels.size(); i += 3) {
      int most = 0;
      for (std::size_t c = i; c < i + 3; ++c) {
        const int difference = std::abs(int{static_cast<unsigned char>(drawn.pixels[c])} -
                                        static_cast<unsigned char>(best.pixels[c]));
        most = std::max(most, difference);
        squares += difference * difference;
      }
      wrong += most > 0 ? 1U : 0U;
      visible += most > 8 ? 1U : 0U;
    }
    const double rms = std::sqrt(squares / static_cast<double>(drawn.pixels.size()));
    CHECK(row["wrong_px"] == wrong);
    CHECK(row["visible_px"] == visible);
    CHECK(row["rms_error"].get<double>() == doctest::Approx(rms));
    CHECK(row["psnr_db"].is_null() == (squares == 0));
    if (squares != 0) {
      CHECK(decibels(row) == doctest::Approx(20 * std::log10(255 / rms)));
    }
    std::uint64_t silhouette = 0;
    std::uint64_t both = 0;
    double sum = 0;
    double most = 0;
    for (std::size_t i = 0; i < drawn.distances.size(); ++i) {
      const auto own = static_cast<double>(drawn.distances[i]);
      const auto reference = static_cast<double>(best.distances[i]);
      silhouette += std::isfinite(own) != std::isfinite(reference) ? 1U : 0U;
      if (std::isfinite(own) && std::isfinite(reference)) {
        const double error = std::abs(own - reference);
        sum += error;
        most = std::max(most, error);
        ++both;
      }
    }
    CHECK(row["silhouette_px"] == silhouette);
    CHECK(row["depth_error_mean_voxels"].get<double>() ==
          doctest::Approx(sum / static_cast<double>(both)).epsilon(1e-3));
    CHECK(row["depth_error_max_voxels"].get<double>() == doctest::Approx(most).epsilon(1e-3));
    for (const char* count : {"rays", "hits", "node_visits"}) {
      CHECK(row[count] == drawn.stats[count]);
    }
    CHECK(row["ms_quarter"].get<double>() <= row["ms_median"].get<double>());
    CHECK(row["ms_median"].get<double>() <= row["ms_three_quarters"].get<double>());
    CHECK(row["lm3s6965evb_instructions"].get<double>() > row["node_visits"].get<double>() * 200);
  }
  CHECK(groups ==
        std::set<std::string>{"default", "depth", "cutoff", "direction_bits", "samples", "together", "best"});
}

TEST_CASE(
    "accuracy: frames stopped early -> bounds that hold and never grow, and the default picture at last") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, kView);
  const Json& plain = rows[0];
  REQUIRE(plain["group"] == "default");
  std::uint64_t visits = 0;
  std::uint64_t inexact = UINT64_MAX;
  double bound = 1e9;
  int count = 0;
  const Json* last = nullptr;
  for (const Json& row : rows) {
    if (row["row"] != "anytime") {
      continue;
    }
    CHECK((visits == 0 || row["visits_given"] == 2 * visits));
    visits = row["visits_given"];
    CHECK(row["node_visits"] <= visits);
    CHECK(row["inexact_px"] <= inexact);
    inexact = row["inexact_px"];
    CHECK(row["error_bound_grays"] <= bound);
    bound = row["error_bound_grays"];
    CHECK(row["mean_error_grays"] <= bound);
    last = &row;
    ++count;
  }
  REQUIRE(count >= 3);
  CHECK(inexact == 0);
  CHECK(bound == 0);
  CHECK((*last)["mean_error_grays"] == 0);
  CHECK((*last)["wrong_px"] == plain["wrong_px"]);
  CHECK((*last)["psnr_db"] == plain["psnr_db"]);
  CHECK((*last)["hits"] == plain["hits"]);
}

TEST_CASE(
    "accuracy: the front -> exactly the settings that no other one beats, by time and by what is counted") {
  const TemporaryFolder folder;
  check_front(rows_of(folder, kView), "ms_median", "psnr_db", 0.03);
  check_front(rows_of(folder, kView + Words{"--against", "visits"}), "node_visits", "psnr_db");
  check_front(rows_of(folder, kView + Words{"--against", "instructions"}), "lm3s6965evb_instructions",
              "psnr_db");
}

TEST_CASE(
    "accuracy: --for-ms and --for-error -> the options of the best row, or a sentence when there is none") {
  const TemporaryFolder folder;
  const auto answer_of = [](const std::string& out) {
    const std::size_t at = out.find("\noptions: ");
    REQUIRE(at != std::string::npos);
    const std::string line = out.substr(at + 10, out.find('\n', at + 10) - at - 10);
    return line == "(none: the defaults)" ? std::string() : line;
  };
  std::string out;
  const Json before = rows_of(folder, kView);
  std::vector<double> times;
  for (const Json& row : before) {
    times.push_back(row["ms_median"]);
  }
  std::sort(times.begin(), times.end());
  // Wide enough that the second run has settings on both sides.
  const double limit = times[times.size() / 2];
  Json rows = rows_of(folder, kView + Words{"--for-ms", std::to_string(limit)}, &out);
  const Json* best = nullptr;
  for (const Json& row : rows) {
    const double given = std::stod(std::to_string(limit));
    if (row["row"] == "setting" && row["ms_median"] <= given &&
        (best == nullptr || decibels(row) > decibels(*best) ||
         (decibels(row) == decibels(*best) && row["ms_median"] < (*best)["ms_median"]))) {
      best = &row;
    }
  }
  REQUIRE(best != nullptr);
  CHECK(answer_of(out) == (*best)["options"]);

  for (const char* error : {"0", "2.5", "12"}) {
    CAPTURE(error);
    rows = rows_of(folder, kView + Words{"--for-error", error}, &out);
    best = nullptr;
    for (const Json& row : rows) {
      if (row["row"] == "setting" && row["rms_error"] <= std::stod(error) &&
          (best == nullptr || row["ms_median"] < (*best)["ms_median"])) {
        best = &row;
      }
    }
    REQUIRE(best != nullptr);
    CHECK(answer_of(out) == (*best)["options"]);
  }
  check_accuracy_refused(kView + Words{"--rounds", "1", "--for-ms", "1e-7", "--csv", folder.path("no.csv")},
                         1, {"1e-07 ms", "fastest"});
  CHECK(folder.names() == Words{"a.json"});
}

TEST_CASE(
    "accuracy: a scene that calls for light -> its knobs, against what the renderer draws at their best") {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "l.scene",
      "depth 5\nsun toward 3 5 9\nocclusion rays 8 reach 6 strength 0.8\nbounces 3\n"
      "material steel metal color 200 200 210 mirror 0.9 roughness 0.3\nmaterial wall color 200 80 60\n"
      "box wall from 0 0 0 to 32 32 3\nbox steel from 6 6 3 to 14 26 16\nbox steel from 18 6 3 to 20 26 "
      "20\n");
  const Words view{path, "--size", "24x18", "--shade", "color"};
  const Json rows = rows_of(folder, view + Words{"--plot", folder.path("l.svg")});
  CHECK(elements_of(read_text(folder.path("l.svg"))) > 100);
  CHECK(read_text(folder.path("l.svg")).find("bounces 8") != std::string::npos);

  const auto rays_drawn = [&](const std::string& bounces) {
    check_done(Words{"render", "--view", "paper", "--fov", "60"} + view +
               Words{"--effects", "auto", "--bounces", bounces, "--quiet", "-o", folder.path("l.ppm"),
                     "--stats", folder.path("l.json")});
    return read_json(folder.path("l.json"))["rays"];
  };
  std::map<std::string, int> groups;
  std::set<Words> settings;
  int front = 0;
  bool has_error = false;
  for (const Json& row : rows) {
    if (row["row"] != "light") {
      CHECK(row["bounces"].is_null());
      continue;
    }
    ++groups[row["group"]];
    front += row["front"].get<int>();
    CHECK(settings.insert({row["occlusion_rays"].dump(), row["roughness_rays"].dump(), row["bounces"].dump()})
              .second);
    has_error = has_error || !row["psnr_db"].is_null();
    if (row["group"] == "bounces") {
      CHECK(row["rays"] == rays_drawn(row["bounces"].dump()));
    }
    CHECK(row["depth_error_mean_voxels"].is_null());
  }
  CHECK(groups["default"] == 1);
  CHECK(groups["occlusion_rays"] == 4);
  CHECK(groups["roughness_rays"] == 1);
  CHECK(groups["bounces"] == 6);
  CHECK(groups["together"] >= 20);
  CHECK(front >= 2);
  CHECK(has_error);
  std::string out;
  rows_of(folder, view + Words{"--for-error", "0"}, &out);
  CHECK(out.find("light: occlusion rays 32, roughness rays 4, bounces 8\n") != std::string::npos);
  CHECK(out.find("with --shade as given here") != std::string::npos);
  CHECK(out.find("--bounces 8 of thimble render") != std::string::npos);
  // No light asked for, none measured.
  for (const Json& row : rows_of(folder, view + Words{"--effects", "none"})) {
    CHECK(row["row"] != "light");
  }
  check_accuracy_refused({"spheres", "--effects", "magic"}, 2, {"--effects", "\"magic\""});
}

TEST_CASE("accuracy: the demonstration on an lm3s6965evb -> the estimate is near what was counted there") {
  if (kSanitized) {
    return;  // It draws one size, and a sanitized build counts the same.
  }
  const TemporaryFolder folder;
  accuracy(
      {"demo", "--size", "128x64", "--shade", "color", "--rounds", "1", "--json", folder.path("d.json")});
  const Json rows = read_json(folder.path("d.json"));
  // Ray by ray, setting the camera up included (src/picture/BRICKS.md, "Frames on a chip").
  const double counted = 40.5e6;
  CHECK(rows[0]["lm3s6965evb_instructions"].get<double>() == doctest::Approx(counted).epsilon(0.19));
}

TEST_CASE("accuracy: empty and smallest worlds, the smallest picture -> rows, not errors") {
  const TemporaryFolder folder;
  CHECK(rows_of(folder, {"points:0,depth=3", "--size", "8x6"})[0]["wrong_px"] == 0);
  CHECK(rows_of(folder, {"points:1,depth=1", "--size", "8x6"}).size() > 20);
  CHECK(rows_of(folder, {"points:8,depth=2", "--size", "1x1", "--plot", folder.path("a.svg")}).size() > 20);
  CHECK(elements_of(read_text(folder.path("a.svg"))) > 20);
}

TEST_CASE("accuracy: wrong options and files -> a sentence, and no file") {
  const TemporaryFolder folder;
  check_accuracy_refused({}, 2, {"SCENE"});
  check_accuracy_refused({"spheres", "--for-ms", "1", "--for-error", "1"}, 2, {"--for-ms", "--for-error"});
  check_accuracy_refused({"spheres", "--for-ms", "0"}, 2, {"--for-ms", "\"0\"", "above 0"});
  check_accuracy_refused({"spheres", "--for-ms", "nan"}, 2, {"--for-ms", "\"nan\""});
  check_accuracy_refused({"spheres", "--for-ms", "soon"}, 2, {"--for-ms", "\"soon\""});
  check_accuracy_refused({"spheres", "--for-error", "-1"}, 2, {"--for-error", "\"-1\""});
  check_accuracy_refused({"spheres", "--for-error", "1x"}, 2, {"--for-error", "\"1x\""});
  check_accuracy_refused({"spheres", "--rounds", "0"}, 2, {"--rounds", "\"0\""});
  check_accuracy_refused({"spheres", "--size", "0x3"}, 2, {"--size"});
  check_accuracy_refused({"spheres", "--against", "luck"}, 2, {"--against"});
  check_accuracy_refused({"spheres", "--samples", "4"}, 2, {"--samples"});
  check_accuracy_refused({"spheres", "--rays", "4"}, 2, {"--rays", "--hard-cases"});
  check_accuracy_refused({"spheres", "--hard-cases"}, 2, {"--hard-cases", "SCENE"});
  check_accuracy_refused({"--hard-cases", "--size", "8x8"}, 2, {"--hard-cases", "--size"});
  check_accuracy_refused({"--hard-cases", "--rays", "0"}, 2, {"--rays", "\"0\""});
  check_accuracy_refused({"nothing.vox"}, 1, {"nothing.vox"});
  check_accuracy_refused({"spheres", "--eye", "1,2,3", "--target", "1,2,3", "--csv", folder.path("a.csv")}, 1,
                         {"--eye"});
  CHECK(folder.names().empty());
}

TEST_CASE("accuracy --simulation particles -> the lag of a falling ball, halved by twice the substeps") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, {"--simulation", "particles", "--plot", folder.path("p.svg")});
  REQUIRE(rows.size() == 20);
  // A step adds gravity, then moves: after n steps of s parts a ball is g n / (2 s) cells ahead of the
  // parabola, and the reference's 16 parts as much as that.
  for (std::size_t i = 0; i < 4; ++i) {
    const double substeps = rows[i]["substeps"];
    CHECK(substeps == (1 << i));
    CHECK(rows[i]["subpixel_bits"] == 15);
    const double expected = 0.1 * 10 / 2 * (1 / substeps - 1.0 / 16);
    CHECK(rows[i]["error_median"].get<double>() == doctest::Approx(expected).epsilon(0.25));
    CHECK(rows[i]["work"] == 693 * 10 * (1 << i));
  }
  CHECK(rows[4]["error_most"] == 0);
  CHECK(rows[4]["front"] == 1);
  CHECK(rows[0]["columns"].is_null());
  check_front(rows, "ms_median", "error_median");
  const std::string svg = read_text(folder.path("p.svg"));
  CHECK(elements_of(svg) > 30);
  CHECK(svg.find("cells (0 not shown)") != std::string::npos);
}

TEST_CASE("accuracy --simulation water -> heights nearer to the finest grid with every doubling of columns") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder, {"--simulation", "water", "--plot", folder.path("w.svg")});
  REQUIRE(rows.size() == 12);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int columns = rows[i]["columns"];
    CHECK(columns == 16 << (i % 4));
    // A wave has crossed half the basin.
    CHECK(rows[i]["steps"].get<int>() * rows[i]["wave_speed_q6"].get<int>() == 64 * columns / 2);
    CHECK(rows[i]["substeps"].is_null());
    CHECK(rows[i]["error_median"] <= rows[i]["error_most"]);
    if (i % 4 != 0) {
      CHECK(rows[i]["error_rms"] < rows[i - 1]["error_rms"]);
      CHECK(rows[i]["work"] > 4 * rows[i - 1]["work"].get<std::uint64_t>());
    }
  }
  CHECK(elements_of(read_text(folder.path("w.svg"))) > 30);
  check_accuracy_refused({"--simulation", "fire"}, 2, {"--simulation", "\"fire\""});
  check_accuracy_refused({"--simulation", "water", "spheres"}, 2, {"--simulation", "SCENE"});
  check_accuracy_refused({"--simulation", "water", "--for-ms", "3"}, 2, {"--simulation", "--for-ms"});
  check_accuracy_refused({"--simulation", "water", "--hard-cases"}, 2, {"--simulation", "--hard-cases"});
}

TEST_CASE("accuracy --hard-cases: every case and tracer -> ours 0, theirs counted, sums that are right") {
  const TemporaryFolder folder;
  const CommandResult result = accuracy({"--hard-cases", "--rays", "2800", "--seed", "5", "--json",
                                         folder.path("h.json"), "--csv", folder.path("h.csv")});
  const Json rows = read_json(folder.path("h.json"));
  std::map<std::string, std::uint64_t> wrong;
  std::set<std::string> cases;
  int totals = 0;
  int operations = 0;
  for (const Json& row : rows) {
    if (row["row"] == "operation") {
      ++operations;
      CHECK(row["error"] <= row["bound"]);
    } else if (row["case"] == "all") {
      ++totals;
      CHECK(row["wrong"] == wrong[row["tracer"]]);
      CHECK((row["wrong"] == 0) == (row["traversal"] == "thimble"));
    } else {
      cases.insert(row["case"]);
      wrong[row["tracer"]] += row["wrong"].get<std::uint64_t>();
    }
  }
  CHECK(cases.size() == 14);
  CHECK(totals == 14);
  CHECK(operations >= 24);
  CHECK(lines_of(read_text(folder.path("h.csv"))).size() == rows.size() + 1);
  for (const std::string& name : cases) {
    CHECK(result.out.find(name) != std::string::npos);
  }
  CHECK(result.out.find("kRayErrorPxQ16") != std::string::npos);
}

TEST_CASE("hard cases: a ray, a face or an operation of ours that is wrong -> a sentence for the status") {
  tools::HardCaseStudy study;
  tools::HardCaseRow row;
  row.name = "a case";
  row.rays = 10;
  row.wrong[2] = 3;  // not ours
  study.cases.push_back(row);
  study.operations.push_back({"sum", "kSumError", "1", 2, 2, 5});
  CHECK(tools::hard_case_fault(study).empty());
  study.cases[0].wrong[1] = 1;
  CHECK(tools::hard_case_fault(study).find("1 of 10") != std::string::npos);
  study.cases[0].wrong[1] = 0;
  study.cases[0].wrong_face[0] = 2;
  CHECK(tools::hard_case_fault(study).find("2 of 10") != std::string::npos);
  study.cases[0].wrong_face[0] = 0;
  study.operations[0].error = 2.01;
  CHECK(tools::hard_case_fault(study).find("kSumError") != std::string::npos);
  study.operations[0].error = std::nan("");
  CHECK(!tools::hard_case_fault(study).empty());
}

TEST_CASE("scatter: points on one spot -> numbers side by side, each point and number once") {
  tools::Scatter scatter;
  scatter.clouds.push_back({"a", {{1, 1}, {1, 1}, {1, 1}}, true});
  for (int i = 0; i < 3; ++i) {
    scatter.front.push_back({1, 1, "p"});
  }
  const std::string svg = tools::scatter_text(scatter);
  CHECK(elements_of(svg) > 10);
  std::set<std::string> places;
  for (const char* number : {">1</text>", ">2</text>", ">3</text>"}) {
    // The last one: ticks come before.
    const std::size_t at = svg.rfind(number);
    REQUIRE(at != std::string::npos);
    const std::size_t begin = svg.rfind("<text x=", at);
    CHECK(places.insert(svg.substr(begin, svg.find(" text-anchor", begin) - begin)).second);
  }
}
