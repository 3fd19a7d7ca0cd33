#include "commands/stats.h"

namespace thimble::tools {

Stats::Stats(const SceneOptions& options, const SceneSource& source)
    : scene(options.arguments.scene), points(source.points()) {
  if (options.board != nullptr) {
    board = options.board->name;
  }
}

Stats::Stats(const SceneOptions& options, const SceneSource& source, const BuiltScene& built)
    : Stats(options, source) {
  depth = built.level();
  voxels = built.voxels();
  nodes = built.nodes();
  tree_bytes = built.tree_bytes();
  budget_bytes = built.budget_bytes();
  high_water_bytes = built.high_water_bytes();
  solid_added = built.solid_added();
  build_seconds = built.build_seconds();
}

void Stats::take(const Painting& painting) {
  build_seconds += painting.preparation_seconds;
  frame_seconds = painting.seconds;
  counts = painting.counts;
  engine = painting.engine;
  threads = painting.threads;
}

std::string stats_text(const Stats& stats) {
  JsonRow json;
  put_all(&json, "scene", stats.scene, "depth", stats.depth, "points", stats.points, "voxels", stats.voxels,
          "nodes", stats.nodes, "tree_bytes", stats.tree_bytes, "budget_bytes", stats.budget_bytes,
          "high_water_bytes", stats.high_water_bytes, "solid_added", stats.solid_added, "build_seconds",
          stats.build_seconds, "frame_seconds", stats.frame_seconds, "rays", stats.counts.all.rays, "hits",
          stats.counts.all.hits, "node_visits", stats.counts.all.node_visits, "box_tests",
          stats.counts.wide.candidates, "exact_tests", stats.counts.wide.exact, "threads", stats.threads,
          "engine", stats.engine, "frame_crc32", stats.frame_crc32);
  const auto add = [&](const char* name, const auto& value) {
    if (value) {
      json[name] = *value;
    }
  };
  add("display_crc32", stats.display_crc32);
  add("baked_bytes", stats.baked_bytes);
  add("baked_crc32", stats.baked_crc32);
  add("board", stats.board);
  add("trace_seconds", stats.trace_seconds);
  if (stats.samples_at_edges) {
    json["samples"] = "auto";
  } else {
    add("samples", stats.samples);
  }
  add("cutoff_px", stats.cutoff_px);
  add("max_depth", stats.max_depth);
  if (stats.effects) {
    json["effects"] = effect_list(*stats.effects);
  }
  add("bounces", stats.bounces);
  for (int kind = 0; stats.bounces && kind < kLitRayKinds; ++kind) {
    const char* name = ray_kind_name(static_cast<LitRayKind>(kind));
    json["rays_by_kind"][name] = stats.counts.lit.rays[kind];
    json["node_visits_by_kind"][name] = stats.counts.lit.node_visits[kind];
  }
  return json_text(json);
}

void print_notes(const std::vector<std::string>& notes, bool quiet) {
  for (const std::string& note : notes) {
    if (!quiet && !note.empty()) {
      std::fprintf(stderr, "note: %s\n", note.c_str());
    }
  }
}

void add_report(CLI::App& app, ReportPaths* paths, bool* quiet, const std::string& columns,
                const std::string& plot) {
  add_path_option(app, "--csv", "FILE.csv", &paths->csv, columns);
  add_path_option(app, "--json", "FILE.json", &paths->json,
                  "the same, an array of objects; null where the CSV is empty");
  add_output_option(app, "--plot", "FILE.svg", &paths->plot, takes_svg, ".svg", plot);
  add_flag(app, "--quiet", quiet, "no progress bar and no notes");
}

void ReportFiles::write(const nlohmann::ordered_json& rows, const std::string& plot) {
  outputs_.write(0, csv_of(rows));
  outputs_.write(1, rows.dump(2) + "\n");
  outputs_.write(2, plot);
  outputs_.commit();
}

}  // namespace thimble::tools
