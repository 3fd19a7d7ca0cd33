// thimble table: the paper's Table I and II on this machine, beside the paper's own figures.
//
// Frames are seen and timed as instruments/timed_frames.h says. Every frame is judged: pixels are drawn at random and their
// rays handed to the exact reference, which holds voxels in a grid of its own, filled from the generator and not from the
// tree: those of the cubes that these rays pass until their hits, since a grid of a billion points takes 9 GB.
#include <random>

#include "commands/commands.h"
#include "instruments/timed_frames.h"
#include "output/plot.h"
#include "reference/reference.h"
#include "scene/generators.h"
#include "scene/gpu_engine.h"

namespace thimble::tools {
namespace {

constexpr int kJudgedPixels = 10000;

struct TableCommand {
  std::vector<std::uint64_t> points{1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 20000000};
  std::string scene = "points";
  int depth = 10;
  bool quiet = false;
  ReportPaths files;
  EngineOptions engine;
};

struct PaperRow {
  std::uint64_t points;
  double perspective_seconds;   // Table I
  double orthographic_seconds;  // Table II
};
// Tables I and II of "Real Time Ray Tracing in a Space Limited Environment", seconds a frame.
constexpr std::array<PaperRow, 9> kPaper{{{1, 0.105575, 0.007379},
                                          {10, 0.310432, 0.015365},
                                          {100, 0.828678, 0.057024},
                                          {1000, 1.980592, 0.153735},
                                          {10000, 4.469226, 0.373861},
                                          {100000, 7.086494, 0.866302},
                                          {1000000, 3.390397, 1.49762},
                                          {10000000, 1.172221, 0.883987},
                                          {20000000, 0.942457, 0.669997}}};

std::optional<double> paper_seconds(std::uint64_t points, bool orthographic) {
  for (const PaperRow& row : kPaper) {
    if (row.points == points) {
      return orthographic ? row.orthographic_seconds : row.perspective_seconds;
    }
  }
  return std::nullopt;
}

struct Row {
  std::uint64_t points = 0;
  bool orthographic = false;
  double seconds = 0;  // median
  std::uint64_t hits = 0;
  std::uint64_t mismatches = 0;
  std::string engine;
};

/// Judges pixels of the two rows of a scene: first all are drawn, then the scene is streamed once more.
class PixelJudge {
 public:
  explicit PixelJudge(int level)
      : size_{1 << level, 1 << level, 1 << level},
        cubes_({size_[0] / reference::kPathCubeSide, size_[1] / reference::kPathCubeSide,
                size_[2] / reference::kPathCubeSide}) {}

  /// Takes pixels of a frame at random, each with the hit that its ray has by the core.
  void take(bool orthographic, const BuiltScene& built, const Camera& camera, const Shading& shading,
            const std::vector<std::uint8_t>& pixels, const TraceOptions& options, std::mt19937_64* random) {
    for (int i = 0; i < kJudgedPixels / kTimedFrames; ++i) {
      const std::int32_t x = static_cast<std::int32_t>((*random)() % kTimedWidthPx);
      const std::int32_t y = static_cast<std::int32_t>((*random)() % kTimedHeightPx);
      const Ray ray = camera.ray(x, y);
      Hit hit;
      fail_if(built.closest_hit(ray, &hit, options) != Status::kOk,
              "this engine does not take the rays of this view");
      Judged& judged = judged_.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        judged.ray.origin_q8[axis] = ray.origin[static_cast<int>(axis)].raw;
        judged.ray.direction[axis] = ray.direction[static_cast<int>(axis)];
      }
      judged.ours = {hit.kind == HitKind::kHit,
                     {hit.voxel.x, hit.voxel.y, hit.voxel.z},
                     hit.t_numerator,
                     hit.t_denominator,
                     int{hit.axis}};
      const std::uint8_t pixel =
          pixels[static_cast<std::size_t>(y) * kTimedWidthPx + static_cast<std::size_t>(x)];
      judged.is_same_pixel = pixel == gray_of(shade(hit, ray, camera, shading));
      judged.orthographic = orthographic;
      mark_path(judged.ray, size_, judged.ours, &cubes_);
    }
  }

  /// Of perspective and parallel pixels, how many are not as the reference says.
  std::array<std::uint64_t, 2> mismatches(const SceneSource& source, const Progress& progress) const {
    reference::BitGrid grid(size_);
    source.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
          constexpr int kSide = reference::kPathCubeSide;
          if (cubes_.test({x / kSide, y / kSide, z / kSide})) {
            grid.set({x, y, z});
          }
        },
        progress);
    std::array<std::uint64_t, 2> wrong{};
    for (const Judged& judged : judged_) {
      const bool is_right = judged.is_same_pixel && same_answer(judged.ours, walk(grid, judged.ray));
      wrong[judged.orthographic ? 1 : 0] += is_right ? 0U : 1U;
    }
    return wrong;
  }

 private:
  struct Judged {
    reference::Ray ray;
    reference::Hit ours;
    bool is_same_pixel = false;
    bool orthographic = false;
  };
  reference::Voxel size_;
  reference::BitGrid cubes_;
  std::vector<Judged> judged_;
};

Row measure(const TableCommand& command, const BuiltScene& built, PixelJudge* judge, WideRenderer* wide,
            GpuEngine* gpu, bool orthographic, std::uint64_t points,
            const std::function<void(double)>& progress) {
  const TraceOptions options = command.engine.trace_options();
  std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kGray8, kTimedWidthPx, kTimedHeightPx));
  std::vector<double> seconds;
  Row row;
  row.points = points;
  row.orthographic = orthographic;
  std::mt19937_64 random(points);
  for (int frame = -1; frame < kTimedFrames; ++frame) {
    // Everything a frame needs is done again: the camera, its depth range, clearing, rays and shading.
    const FrameWatch watch(command.engine.threads);
    const Camera camera = timed_camera(command.depth, orthographic, frame + kTimedFrames);
    const Shading shading = timed_shading(camera, built.bounds());
    Band band;
    band.format = PixelFormat::kGray8;
    band.pixels = Bytes(pixels.data(), pixels.size());
    band.rows = kTimedHeightPx;
    RenderCounts counts;
    thimble::wide::Counts work;
    Status status = gpu != nullptr    ? gpu->draw(camera, shading, band, &counts)
                    : wide != nullptr ? wide->render(camera, shading, band, &counts, &work)
                                      : Status::kTooFine;
    row.engine = command.engine.resolved(gpu == nullptr && status == Status::kOk);
    if (status == Status::kTooFine && command.engine.name != "wide") {
      status = built.render_band(camera, shading, band, &counts, options);
    }
    fail_if(status != Status::kOk, "--engine ", command.engine.name, " does not take the rays of this view");
    const double taken = watch.seconds();
    if (frame < 0) {
      continue;  // its memory was never touched before
    }
    seconds.push_back(taken);
    row.hits = counts.hits;
    judge->take(orthographic, built, camera, shading, pixels, options, &random);
    progress(static_cast<double>(frame + 1) / kTimedFrames);
  }
  row.seconds = quantile(seconds, 0.5);
  return row;
}

std::string row_text(const Row& row) {
  const std::optional<double> paper = paper_seconds(row.points, row.orthographic);
  std::array<char, 64> beside{};
  if (paper) {
    std::snprintf(beside.data(), beside.size(), "%10.6f %8.1fx", *paper, *paper / row.seconds);
  } else {
    std::snprintf(beside.data(), beside.size(), "%10s %9s", "-", "-");
  }
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "%12s  %-12s %10.6f %s %9s %11s\n", grouped(row.points).c_str(),
                row.orthographic ? "orthographic" : "perspective", row.seconds, beside.data(),
                grouped(row.hits).c_str(), grouped(row.mismatches).c_str());
  return line.data();
}

JsonRow object_of(const Row& row) {
  JsonRow object;
  put_all(&object, "points", row.points, "projection", row.orthographic ? "orthographic" : "perspective",
          "seconds", row.seconds, "paper_seconds", json_of(paper_seconds(row.points, row.orthographic)),
          "hits", row.hits, "exact_mismatches", row.mismatches, "engine", row.engine);
  return object;
}

std::string plot_text(const TableCommand& command, const std::vector<Row>& rows) {
  Plot plot;
  plot.title = "One frame of 800 x 600 pixels";
  plot.x_label = concat("points in the world of 2^", command.depth, " a side (", command.scene, ")");
  plot.y_label = "seconds a frame";
  for (const bool orthographic : {false, true}) {
    const std::string name = orthographic ? "orthographic" : "perspective";
    Series ours{"Thimble, " + name, false, {}};
    Series paper{"the paper, " + name, true, {}};
    for (const Row& row : rows) {
      if (row.orthographic != orthographic || row.points == 0) {
        continue;
      }
      const double x = static_cast<double>(row.points);
      ours.points.emplace_back(x, row.seconds);
      if (const auto seconds = paper_seconds(row.points, orthographic)) {
        paper.points.emplace_back(x, *seconds);
      }
    }
    plot.series.push_back(ours);
    plot.series.push_back(paper);
  }
  return log_plot_text(plot);
}

void run(const TableCommand& command) {
  ReportFiles files(command.files, "");
  files.print("      points  projection      seconds      paper    faster      hits  mismatches\n");
  std::vector<Row> rows;
  for (const std::uint64_t points : command.points) {
    ProgressBar bar(grouped(points) + " points", command.quiet);
    SceneArguments arguments;
    arguments.scene = concat(command.scene, ":", points);
    arguments.depth = command.depth;
    const auto source = open_scene(arguments);
    BuildOptions build;
    build.memory_bytes.reset();
    build.threads = command.engine.threads;
    BuiltScene built(*source, build, [&](double done) { bar.update(done * 0.3); });
    const auto wide = command.engine.wide_renderer(&built, kTimedWidthPx, kTimedHeightPx);
    const auto gpu = command.engine.gpu(built);
    PixelJudge judge(command.depth);
    std::vector<Row> pair;
    for (const bool orthographic : {false, true}) {
      pair.push_back(measure(command, built, &judge, wide.get(), gpu.get(), orthographic, points,
                             [&](double done) { bar.update(0.3 + 0.2 * (done + (orthographic ? 1 : 0))); }));
    }
    const auto wrong = judge.mismatches(*source, [&](double done) { bar.update(0.7 + done * 0.3); });
    pair[0].mismatches = wrong[0];
    pair[1].mismatches = wrong[1];
    bar.clear();
    for (const Row& row : pair) {
      files.print(row_text(row));
      rows.push_back(row);
    }
  }
  files.write(objects_of(rows, object_of), files.wants_plot() ? plot_text(command, rows) : "");
}

}  // namespace

void add_table(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "table",
      "The paper's Tables I and II on this machine: seconds a frame of 800 x 600 grey pixels (the median of "
      "5 after one that does not count, each from a slightly different place; processor time, with more "
      "threads than one by the clock on the wall) beside the paper's, and how many of 10,000 pixels differ "
      "from the exact reference.");
  TableCommand* const command = options_for<TableCommand>(*sub, run);
  add_text_option(
      *sub, "--points", "N,N,...",
      [command](const std::string& text) -> std::string {
        command->points.clear();
        for (const std::string& word : CLI::detail::split(text + ',', ',')) {
          const auto number = parse_whole(word, 0, static_cast<std::int64_t>(kMaxGeneratorPoints));
          if (!number) {
            return "is not a list of whole numbers from 0 to " + std::to_string(kMaxGeneratorPoints);
          }
          command->points.push_back(static_cast<std::uint64_t>(*number));
        }
        return {};
      },
      "numbers of points (default: the paper's, 1 to 20,000,000)");
  add_choice_option(*sub, "--scene", {"points", "cluster"}, &command->scene,
                    "uniformly random points, or points that crowd");
  add_whole_option(*sub, "--depth", "L", kLeastTimedLevel, kMaxLevel, &command->depth,
                   "the world is 2^L voxels a side, L from 5 to 12; the paper's was probably smaller")
      ->default_str("10");
  add_path_option(
      *sub, "--json", "FILE.json", &command->files.json,
      "an array, one object a row: points, projection, seconds, paper_seconds (null where the paper "
      "has none), hits, exact_mismatches, engine");
  add_output_option(*sub, "--plot", "FILE.svg", &command->files.plot, takes_svg, ".svg",
                    "seconds against points");
  add_flag(*sub, "--quiet", &command->quiet, "no progress bar");
  command->engine.add_to(*sub, false);
}

}  // namespace thimble::tools
