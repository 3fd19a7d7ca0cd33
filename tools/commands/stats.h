/// The counts, bytes and times of one run, for people and for programs.
#pragma once

#include "commands/scene_options.h"
#include "output/tables.h"

namespace thimble::tools {

struct Stats {
  std::string scene;
  int depth = 0;
  std::uint64_t points = 0;
  std::uint64_t voxels = 0;
  std::uint64_t nodes = 0;
  std::uint64_t tree_bytes = 0;
  std::uint64_t budget_bytes = 0;
  std::uint64_t high_water_bytes = 0;
  std::uint64_t solid_added = 0;
  double build_seconds = 0;
  double frame_seconds = 0;
  PaintCounts counts;
  int threads = 1;
  std::string engine;
  std::string frame_crc32;  ///< 8 hex digits; empty where no frame was drawn

  // Only where they make sense; otherwise the JSON does not have them.
  std::optional<std::string> display_crc32;  ///< of the frame in the board's own pixel format
  std::optional<std::uint64_t> baked_bytes;
  std::optional<std::string> baked_crc32;
  std::optional<std::string> board;
  std::optional<double> trace_seconds;  ///< of rays from a file: tracing alone, summed over the threads
  std::optional<int> samples;
  bool samples_at_edges = false;  ///< "auto" instead of their number
  std::optional<double> cutoff_px;
  std::optional<int> max_depth;
  std::optional<EffectSet> effects;  ///< an array of names
  std::optional<int> bounces;        ///< of a lit picture

  Stats() = default;
  Stats(const SceneOptions& options, const SceneSource& source);
  Stats(const SceneOptions& options, const SceneSource& source, const BuiltScene& built);
  /// What drawing took and counted; what it wanted made first counts as building.
  void take(const Painting& painting);
};

/// All of them as one JSON object with the members' names.
std::string stats_text(const Stats& stats);

/// "note: ..." on standard error for each that says something, unless `quiet`.
void print_notes(const std::vector<std::string>& notes, bool quiet);

// --csv, --json and --plot: what a study found, as data and as a picture.

struct ReportPaths {
  std::string csv;
  std::string json;
  std::string plot;
};

/// --csv, whose columns are these, --json, --plot and --quiet of a study.
void add_report(CLI::App& app, ReportPaths* paths, bool* quiet, const std::string& columns,
                const std::string& plot);

class ReportFiles {
 public:
  /// Opens them, which must not be `scene`. Throws OutputError.
  ReportFiles(const ReportPaths& paths, const std::string& scene)
      : outputs_({paths.csv, paths.json, paths.plot}, {scene}) {}

  bool wants_plot() const { return outputs_[2] != nullptr; }
  /// Writes them (tables.h says what `rows` are) and gives them their names. Throws OutputError.
  void write(const nlohmann::ordered_json& rows, const std::string& plot);
  /// For people, unless data go to standard output.
  void print(const std::string& text) const { outputs_.print(text); }

 private:
  OutputSet outputs_;
};

}  // namespace thimble::tools
