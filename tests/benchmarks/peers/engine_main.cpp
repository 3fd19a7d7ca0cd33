// Whether the right engine draws: the wide renderer as it chooses, in either of its orders, and the core ray
// by ray, on many worlds and from many cameras.
//
//   thimble_engine_table                          all rows, some minutes
//   thimble_engine_table --most 1000000 --csv F   clouds of at most so many points; for machines
//   thimble_engine_table FILE...                  these instead, at two depths (or that behind an @), six views
//   thimble_engine_table --world city:10 --save F the world alone, as a file that any thimble reads
//
// A frame is 800 x 600 pixels with depth shading, processor time on one thread, all by turns, the median of
// the frames. The core draws once where that takes longer than 0.2 s. Every picture is compared with the
// core's. `choice`: the time as chosen over the better order's; `core`: the same over the core's; `boxes`: over
// the time with lists of boxes alone. Files take part where THIMBLE_DATA names their folder.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "benchmarks/peers/contest.h"
#include "support/trial_worlds.h"
#include "thimble/bake/baked_scene.h"
#include "wide/raster/renderer.h"

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 800;
constexpr std::int32_t kHeightPx = 600;
constexpr double kSlowSeconds = 0.2;
constexpr double kMost = 1.3;
constexpr std::size_t kWorstRows = 12;

// kBoxes: as chosen, over lists of boxes alone.
enum Engine : std::size_t { kAuto, kFlat, kBlocks, kBoxes, kCore, kEngines };

struct Row {
  std::string world;
  std::string camera;
  std::uint64_t voxels = 0;
  std::uint64_t boxes = 0;
  double ms[kEngines] = {};
  wide::Stats stats[4];
  std::uint64_t list_bytes = 0;
  std::uint64_t box_list_bytes = 0;
  std::uint64_t hits = 0;
  bool left_to_core = false;
  bool wrong = false;

  double choice() const { return left_to_core ? 1 : ms[kAuto] / std::min(ms[kFlat], ms[kBlocks]); }
  double against_core() const { return left_to_core ? 1 : ms[kAuto] / ms[kCore]; }
  double against_boxes() const { return left_to_core ? 1 : ms[kAuto] / ms[kBoxes]; }
  const char* chosen() const {
    return left_to_core ? "core" : stats[kAuto].order == wide::Order::kFlat ? "flat" : "blocks";
  }
};

class Table {
 public:
  Row draw(const tests::TrialWorld& world, const tests::TrialView& view, int frames) {
    Row row;
    row.world = world.name();
    row.camera = view.name;
    row.voxels = world.tree().voxel_count();
    row.boxes = world.lists().size();
    row.list_bytes = world.list_bytes();
    row.box_list_bytes = world.box_list_bytes();
    shading_ = tools::timed_shading(view.camera, world.tree().bounds());
    std::vector<double> seconds[kEngines];
    // What takes a millisecond is drawn more often: a median of few would be the clock's.
    int turns = frames;
    for (int turn = 0; turn < turns; ++turn) {
      for (std::size_t i = 0; i < kCore && !row.left_to_core; ++i) {
        // Who comes first finds other caches than who comes last.
        const std::size_t engine = (i + static_cast<std::size_t>(turn)) % kCore;
        double taken = 0;
        const bool is_boxes = engine == kBoxes;
        const Status status = draw_wide(is_boxes ? world.box_lists() : world.lists(), view.camera,
                                        is_boxes ? wide::Order::kAuto : static_cast<wide::Order>(engine),
                                        &taken, &row.stats[engine], &pictures_[engine]);
        if (status != Status::kOk && status != Status::kTooFine) {
          throw std::runtime_error("the wide renderer refuses a view");
        }
        row.left_to_core = status == Status::kTooFine;
        seconds[engine].push_back(taken);
      }
      if (turn < 2 && (turn == 0 || seconds[kCore].front() < kSlowSeconds)) {
        seconds[kCore].push_back(draw_core(world, view.camera, &row.hits));
      }
      if (turn == 0 && !row.left_to_core) {
        for (std::size_t engine = 0; engine < kCore; ++engine) {
          row.wrong = row.wrong || pictures_[engine] != pictures_[kCore];
        }
        const double wide = seconds[kAuto][0] + seconds[kFlat][0] + seconds[kBlocks][0];
        turns = wide < 0.006 ? 3 * frames : wide > 1 ? 1 : frames;
      }
    }
    for (std::size_t engine = row.left_to_core ? kCore : kAuto; engine < kEngines; ++engine) {
      row.ms[engine] = 1e3 * median(seconds[engine]);
    }
    if (row.left_to_core) {
      row.ms[kAuto] = row.ms[kCore];
    }
    return row;
  }

 private:
  Status draw_wide(const wide::VoxelLists& lists, const Camera& camera, wide::Order order, double* seconds,
                   wide::Stats* stats, std::vector<std::uint8_t>* pixels) {
    wide::Options options;
    options.order = order;
    Status status = Status::kOk;
    *seconds = seconds_of([&] {
      status = wide::render(lists, camera, shading_, gray_band(pixels, kHeightPx),
                            Bytes(workspace_.data(), workspace_.size()), nullptr, options, stats);
    });
    return status;
  }

  double draw_core(const tests::TrialWorld& world, const Camera& camera, std::uint64_t* hits) {
    return seconds_of([&] {
      RenderCounts counts;
      if (render_band(world.tree(), camera, shading_, gray_band(&pictures_[kCore], kHeightPx), &counts) !=
          Status::kOk) {
        throw std::runtime_error("the core does not take the rays of a view");
      }
      *hits = counts.hits;
    });
  }

  Shading shading_;
  std::vector<std::uint8_t> workspace_ =
      std::vector<std::uint8_t>(wide::workspace_bytes(kWidthPx, kHeightPx));
  std::vector<std::uint8_t> pictures_[kEngines] = {
      std::vector<std::uint8_t>(kWidthPx * kHeightPx), std::vector<std::uint8_t>(kWidthPx* kHeightPx),
      std::vector<std::uint8_t>(kWidthPx* kHeightPx), std::vector<std::uint8_t>(kWidthPx* kHeightPx),
      std::vector<std::uint8_t>(kWidthPx* kHeightPx)};
};

// The views of large and of real worlds, of which there are many.
bool is_one_of_six(const std::string& view) {
  for (const char* name : {"outside", "near", "grazing", "along", "parallel", "parallel oblique"}) {
    if (view == name) {
      return true;
    }
  }
  return false;
}

// A file at two depths, unless it names its own.
std::vector<std::string> at_two_depths(const std::string& file) {
  return short_name(file).find('@') != std::string::npos
             ? std::vector<std::string>{file}
             : std::vector<std::string>{file + "@8", file + "@10"};
}

// Worlds that are drawn in six views.
std::vector<std::string> large_world_names(std::uint64_t most_points) {
  std::vector<std::string> names{"globe:9", "terrain:10", "city:9", "city:10"};
  for (const std::uint64_t count : std::initializer_list<std::uint64_t>{1'000'000, 20'000'000}) {
    if (count <= most_points) {
      names.push_back("cluster:" + std::to_string(count));
      names.push_back("points:" + std::to_string(count));
    }
  }
  if (const char* data = std::getenv("THIMBLE_DATA")) {
    for (const char* file :
         {"mesh/armadillo.off", "mesh/bunny00.off", "mesh/camel.off", "mesh/ChineseDragon-10kv.off",
          "mesh/elephant.off", "mesh/fandisk.off", "mesh/lion-head.off", "mesh/triceratops.off",
          "mesh/npm_snowden.obj", "mesh/trimesh_Duck.glb", "cloud/hippo1.ply", "cloud/kitten.xyz"}) {
      const std::vector<std::string> both = at_two_depths(std::string(data) + "/" + file);
      names.insert(names.end(), both.begin(), both.end());
    }
  }
  return names;
}

std::vector<std::string> world_names(std::uint64_t most_points) {
  std::vector<std::string> names;
  for (const char* kind : {"points:", "cluster:"}) {
    for (const std::uint64_t count : std::initializer_list<std::uint64_t>{1, 10, 100, 1'000, 10'000, 100'000,
                                                                          1'000'000, 3'000'000, 10'000'000}) {
      if (count <= most_points) {
        names.push_back(kind + std::to_string(count));
      }
    }
  }
  for (const char* name :
       {"spheres",   "spheres,depth=8", "spheres,depth=10", "demo",     "water",     "water,depth=9",
        "solid:6",   "solid:8",         "solid:10",         "inset:7",  "inset:9",   "noise:5",
        "noise:7",   "checker:6",       "sponge:5",         "sponge:7", "voxel:3",   "voxel:9",
        "wall:6",    "wall:9",          "slant:6",          "slant:9",  "columns:6", "columns:9",
        "islands:8", "islands:10",      "screen:7",         "screen:9", "ball:6",    "ball:9"}) {
    names.emplace_back(name);
  }
  if (const char* data = std::getenv("THIMBLE_DATA")) {
    for (const char* file :
         {"vox/ephtracy/menger.vox", "vox/ephtracy/monu10.vox", "vox/ephtracy/nature.vox",
          "vox/ephtracy/teapot.vox", "vox/mmmm/scene_hazmat.vox", "mesh/dragon_vrip_res3.ply.gz@7",
          "mesh/dragon_vrip_res3.ply.gz@9", "mesh/dragon_vrip_res2.ply.gz@11", "cloud/building.ply",
          "cloud/building.ply@8", "cloud/b9_training.ply"}) {
      names.push_back(std::string(data) + "/" + file);
    }
  }
  return names;
}

void print(const Row& row) {
  std::printf("%-28s %-16s %10llu %9.3f %9.3f %9.3f %9.3f %10.3f  %-13s %6.2f %6.2f %6.2f%s%s\n",
              short_name(row.world).c_str(), row.camera.c_str(), static_cast<unsigned long long>(row.voxels),
              row.ms[kAuto], row.ms[kFlat], row.ms[kBlocks], row.ms[kBoxes], row.ms[kCore], row.chosen(),
              row.choice(), row.against_core(), row.against_boxes(),
              row.choice() > kMost || row.against_core() > kMost ? "  above" : "",
              row.wrong ? "  OTHER PICTURE" : "");
  std::fflush(stdout);
}

void print_head() {
  std::printf("%-28s %-16s %10s %9s %9s %9s %9s %10s  %-13s %6s %6s %6s\n", "world", "camera", "voxels",
              "auto ms", "flat ms", "blocks ms", "boxes ms", "core ms", "chosen", "choice", "core", "boxes");
}

void print_worst(const char* title, std::vector<Row> rows, double (Row::*ratio)() const) {
  std::sort(rows.begin(), rows.end(),
            [&](const Row& a, const Row& b) { return (a.*ratio)() > (b.*ratio)(); });
  const auto above =
      std::count_if(rows.begin(), rows.end(), [&](const Row& row) { return (row.*ratio)() > kMost; });
  std::printf("\n%s: %zu rows, %zu above %.1f, worst %.2f\n", title, rows.size(),
              static_cast<std::size_t>(above), kMost, (rows.front().*ratio)());
  print_head();
  rows.resize(std::min(rows.size(), kWorstRows));
  for (const Row& row : rows) {
    print(row);
  }
}

void print_slowest(std::vector<Row> rows) {
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.ms[kAuto] > b.ms[kAuto]; });
  std::printf("\nthe slowest\n");
  print_head();
  rows.resize(std::min(rows.size(), kWorstRows));
  for (const Row& row : rows) {
    print(row);
  }
}

std::string csv_text(const std::vector<Row>& rows) {
  std::string text =
      "world,camera,voxels,boxes,bytes,boxes_bytes,hits,auto_ms,flat_ms,blocks_ms,boxes_ms,core_ms,"
      "chosen,choice,core,against_boxes,asked,equal";
  for (const char* order : {"flat", "blocks"}) {
    for (const char* what : {"boxes", "candidates", "exact", "hits", "nodes", "crossing"}) {
      text += std::string(",") + order + "_" + what;
    }
  }
  text += "\n";
  for (const Row& row : rows) {
    char line[640];
    std::snprintf(
        line, sizeof(line),
        "\"%s\",%s,%llu,%llu,%llu,%llu,%llu,%.4f,%.4f,%.4f,%.4f,%.4f,\"%s\",%.3f,%.3f,%.3f,%llu,%d",
        short_name(row.world).c_str(), row.camera.c_str(), static_cast<unsigned long long>(row.voxels),
        static_cast<unsigned long long>(row.boxes), static_cast<unsigned long long>(row.list_bytes),
        static_cast<unsigned long long>(row.box_list_bytes), static_cast<unsigned long long>(row.hits),
        row.ms[kAuto], row.ms[kFlat], row.ms[kBlocks], row.ms[kBoxes], row.ms[kCore], row.chosen(),
        row.choice(), row.against_core(), row.against_boxes(),
        static_cast<unsigned long long>(row.stats[kAuto].counts.asked), row.wrong ? 0 : 1);
    text += line;
    for (const Engine engine : {kFlat, kBlocks}) {
      const wide::Counts& counts = row.stats[engine].counts;
      for (const std::uint64_t count :
           {counts.boxes, counts.candidates, counts.exact, counts.hits, counts.nodes, counts.crossing}) {
        text += "," + std::to_string(count);
      }
    }
    text += "\n";
  }
  return text;
}

// As a baked scene.
void save(const CompactTree& tree, const std::string& path) {
  BakedParts parts;
  parts.tree = {tree.bytes(), tree.size_bytes()};
  std::vector<std::uint8_t> bytes(baked_bytes(parts));
  BakedScene scene;
  if (BakedScene::make(parts, Bytes(bytes.data(), bytes.size()), &scene) != Status::kOk) {
    throw std::runtime_error("the world cannot be baked");
  }
  write_text(path, std::string(bytes.begin(), bytes.end()));
}

int run(int count, char** words) {
  CLI::App app("The wide renderer's choice of an engine, judged by time");
  int frames = 5;
  std::uint64_t most_points = 10'000'000;
  std::string csv_path;
  std::vector<std::string> worlds;
  std::vector<std::string> files;
  std::string save_path;
  app.add_option("FILES", files, "files instead, at depths 8 and 10 or that behind an @, six views each");
  app.add_option("--frames", frames, "frames of each engine and view; the median counts")
      ->check(CLI::Range(1, 1000));
  app.add_option("--most", most_points, "points of the largest cloud");
  app.add_option("--world", worlds, "these worlds (tests/support/trial_worlds.h) or scenes instead");
  app.add_option("--csv", csv_path, "write the rows there too");
  app.add_option("--save", save_path, "write the tree of the one --world there (.oct), and draw nothing");
  CLI11_PARSE(app, count, words);

  Table table;
  std::vector<Row> rows;
  print_head();
  std::vector<std::string> large = large_world_names(most_points);
  if (!files.empty()) {
    large.clear();
    for (const std::string& file : files) {
      const std::vector<std::string> both = at_two_depths(file);
      large.insert(large.end(), both.begin(), both.end());
    }
    worlds = large;
  } else if (worlds.empty()) {
    worlds = world_names(most_points);
    worlds.insert(worlds.end(), large.begin(), large.end());
  }
  for (const std::string& name : worlds) {
    const bool is_large = std::find(large.begin(), large.end(), name) != large.end();
    const tests::TrialWorld world(name);
    if (!save_path.empty()) {
      save(world.tree(), save_path);
      return 0;
    }
    std::printf("%s: %zu entries%s, %.1f MB and %.3f s; boxes alone %zu, %.1f MB and %.3f s\n",
                short_name(name).c_str(), world.lists().size(),
                world.lists().is_surface() ? " of the surface" : "",
                static_cast<double>(world.list_bytes()) / 1e6, world.list_seconds(), world.box_lists().size(),
                static_cast<double>(world.box_list_bytes()) / 1e6, world.box_list_seconds());
    for (const tests::TrialView& view : tests::trial_views(world.tree(), kWidthPx, kHeightPx)) {
      if (!is_large || is_one_of_six(view.name)) {
        rows.push_back(table.draw(world, view, frames));
        print(rows.back());
      }
    }
  }
  print_worst("auto over the better order", rows, &Row::choice);
  print_worst("auto over the core", rows, &Row::against_core);
  print_worst("auto over lists of boxes alone", rows, &Row::against_boxes);
  print_slowest(rows);
  write_text(csv_path, csv_text(rows));
  const bool equal = std::none_of(rows.begin(), rows.end(), [](const Row& row) { return row.wrong; });
  std::printf("\n%s\n", equal ? "all pictures are the core's" : "PICTURES DIFFER from the core's");
  return equal ? 0 : 1;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_engine_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
