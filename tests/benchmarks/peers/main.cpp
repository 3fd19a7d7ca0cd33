// The paper's workload on this machine: this renderer beside what could be used instead, as a table.
//
//   thimble_peer_table                                      all rows, some minutes
//   thimble_peer_table --points 1000,100000 --scene points  some
//   thimble_peer_table --csv F --plot F.svg --plot-bytes F.svg
//                                                           the same for machines and readers
//
// Frames are those of `thimble table` (instruments/timed_frames.h). `faster` is the time of the fastest peer that counts over this renderer's.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "benchmarks/peers/contest.h"
#include "output/plot.h"

namespace thimble::benchmarks {
namespace {

struct Choice {
  std::vector<std::uint64_t> points{1,         10,        100,       1'000,      10'000,    100'000,
                                    1'000'000, 3'000'000, 5'000'000, 10'000'000, 20'000'000};
  std::vector<std::string> scenes{"points", "cluster"};
  int depth = 10;
  int frames = tools::kTimedFrames;
  std::uint64_t most_bytes = 6'000'000'000;
  std::string csv_path;
  std::string plot_path;
  std::string bytes_plot_path;
};

void print(const Result& result) {
  std::printf("%-8s%12llu  %-12s", result.scene.c_str(), static_cast<unsigned long long>(result.points),
              projection(result.orthographic));
  for (const Entrant& entrant : result.entrants) {
    std::printf("  %s %.3f ms", entrant.name.c_str(), entrant.ms);
    if (entrant.warm_ms != 0) {
      std::printf(" (warm %.3f)", entrant.warm_ms);
    }
    if (entrant.differing_px != 0) {
      std::printf(" (%llu px)", static_cast<unsigned long long>(entrant.differing_px));
    }
  }
  for (const std::string& name : result.left_out) {
    std::printf("  %s does not fit", name.c_str());
  }
  const Entrant* const best = result.best_peer();
  if (best != nullptr) {
    std::printf("  faster %.1f x", best->ms / result.entrants[0].ms);
  }
  std::printf("\n");
  std::fflush(stdout);
}

std::string csv_text(const std::vector<Result>& results) {
  std::string text =
      "scene,points,voxels,projection,hits,engine,frame_ms,warm_ms,build_seconds,bytes,differing_px,counts,"
      "times_slower\n";
  for (const Result& result : results) {
    for (const Entrant& entrant : result.entrants) {
      char line[320];
      std::snprintf(line, sizeof(line), "%s,%llu,%llu,%s,%llu,\"%s\",%.4f,%.4f,%.3f,%llu,%llu,%d,%.2f\n",
                    result.scene.c_str(), static_cast<unsigned long long>(result.points),
                    static_cast<unsigned long long>(result.voxels), projection(result.orthographic),
                    static_cast<unsigned long long>(result.hits), entrant.name.c_str(), entrant.ms,
                    entrant.warm_ms, entrant.build_seconds, static_cast<unsigned long long>(entrant.bytes),
                    static_cast<unsigned long long>(entrant.differing_px),
                    entrant.counts(Contest::kPixels) ? 1 : 0, entrant.ms / result.entrants[0].ms);
      text += line;
    }
  }
  return text;
}

// Where the fastest ray tracer overtakes the raster loop: between two rows, on straight lines of logarithms.
std::optional<std::pair<double, double>> crossover(const std::vector<const Result*>& rows) {
  double last_lead = 0;
  double last_x = 0;
  double last_y = 0;
  for (const Result* row : rows) {
    const Entrant* const raster = row->find("raster in floats");
    double tracing = std::numeric_limits<double>::infinity();
    for (const char* name : {"Thimble, ray by ray", "Embree", "NanoVDB"}) {
      const Entrant* const tracer = row->find(name);
      if (tracer != nullptr && tracer->counts(Contest::kPixels)) {
        tracing = std::min(tracing, tracer->ms);
      }
    }
    if (raster == nullptr || !(tracing < 1e30)) {
      continue;
    }
    const double lead = std::log(raster->ms / tracing);
    const double x = std::log(static_cast<double>(row->points));
    const double y = std::log(raster->ms);
    if (lead >= 0 && last_lead < 0) {
      const double part = -last_lead / (lead - last_lead);
      return std::pair{std::exp(last_x + part * (x - last_x)), std::exp(last_y + part * (y - last_y))};
    }
    last_lead = lead;
    last_x = x;
    last_y = y;
  }
  return std::nullopt;
}

// The rows of the first scene, in perspective.
std::vector<const Result*> plotted_rows(const std::vector<Result>& results) {
  std::vector<const Result*> rows;
  for (const Result& result : results) {
    if (result.scene == results.front().scene && !result.orthographic) {
      rows.push_back(&result);
    }
  }
  return rows;
}

// A line for each engine; `value` says how high an entrant stands.
tools::Plot plot_of(const std::vector<const Result*>& rows, double (*value)(const Entrant& entrant)) {
  tools::Plot plot;
  plot.x_label = "points (" + rows.front()->scene + ")";
  for (const char* name :
       {"Thimble", "raster in floats", "exact loop", "Embree", "NanoVDB", "Thimble, ray by ray"}) {
    tools::Series series{name, name == std::string("Thimble, ray by ray"), {}};
    for (const Result* row : rows) {
      if (const Entrant* const entrant = row->find(name)) {
        series.points.emplace_back(static_cast<double>(row->points), value(*entrant));
      }
    }
    if (!series.points.empty()) {
      plot.series.push_back(series);
    }
  }
  return plot;
}

std::string time_plot(const std::vector<const Result*>& rows) {
  tools::Plot plot = plot_of(rows, [](const Entrant& entrant) { return entrant.ms; });
  plot.title = "One frame of 800 x 600 pixels, perspective, one thread";
  plot.y_label = "milliseconds a frame";
  if (const auto crossing = crossover(rows)) {
    double least = crossing->second;
    for (const tools::Series& series : plot.series) {
      for (const auto& [x, y] : series.points) {
        least = std::min(least, y);
      }
    }
    char name[96];
    std::snprintf(name, sizeof(name), "peers' tracing overtakes rasterization at %.1f million",
                  crossing->first / 1e6);
    plot.series.push_back({name, true, {{crossing->first, least}, {crossing->first, crossing->second}}});
    std::printf("%s points\n", name);
  }
  return tools::log_plot_text(plot);
}

std::string bytes_plot(const std::vector<const Result*>& rows) {
  tools::Plot plot = plot_of(rows, [](const Entrant& entrant) { return static_cast<double>(entrant.bytes); });
  plot.title = "Memory that is kept between frames";
  plot.y_label = "bytes";
  return tools::log_plot_text(plot);
}

int run(int count, char** words) {
  Choice choice;
  CLI::App app("This renderer beside what could be used instead");
  app.add_option("--points", choice.points, "numbers of points")->delimiter(',');
  app.add_option("--scene", choice.scenes, "points, cluster")->delimiter(',');
  app.add_option("--depth", choice.depth, "of the world, 2^depth a side")->check(CLI::Range(5, 12));
  app.add_option("--frames", choice.frames, "of each engine and row")->check(CLI::Range(1, 100));
  app.add_option("--most-bytes", choice.most_bytes, "leave out peers that would take more, which do not fit");
  app.add_option("--csv", choice.csv_path, "results as CSV");
  app.add_option("--plot", choice.plot_path, "milliseconds against points as SVG");
  app.add_option("--plot-bytes", choice.bytes_plot_path, "memory against points as SVG");
  CLI11_PARSE(app, count, words);
  for (const auto& [key, value] : machine()) {
    std::printf("%s: %s\n", key.c_str(), value.c_str());
  }
  std::vector<Result> results;
  for (const std::string& scene : choice.scenes) {
    for (const std::uint64_t points : choice.points) {
      Contest contest(scene, points, choice.depth, choice.most_bytes);
      for (const bool orthographic : {false, true}) {
        results.push_back(contest.run(orthographic, choice.frames));
        print(results.back());
      }
      // Rows are written as they come: the last ones take long.
      write_text(choice.csv_path, csv_text(results));
    }
  }
  if (!results.empty()) {
    write_text(choice.plot_path, time_plot(plotted_rows(results)));
    write_text(choice.bytes_plot_path, bytes_plot(plotted_rows(results)));
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_peer_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
