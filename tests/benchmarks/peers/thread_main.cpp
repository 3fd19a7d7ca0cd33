// What threads give the wide renderer: frames by the clock, one after the other as in a film, some with one
// thread and some with several by turns.
//
//   thimble_thread_table                        2 threads from 100,000 points on
//   thimble_thread_table --threads 2,4 --csv F  for other machines, and for machines
//
// A frame is 800 x 600 pixels with depth shading. The median of the frames counts, and all pictures are
// compared. Wants processors that are idle: the clock does not know who else uses them.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include "benchmarks/peers/contest.h"
#include "scene/scene_source.h"
#include "wide/raster/renderer.h"

namespace thimble::benchmarks {
namespace {

struct Choice {
  std::vector<std::uint64_t> points{100'000, 1'000'000, 3'000'000, 10'000'000, 20'000'000};
  std::vector<std::string> scenes{"points", "cluster"};
  std::vector<int> threads{2};
  int frames = 40;
  std::string csv_path;
};

class ThreadTable {
 public:
  ThreadTable(const std::string& kind, std::uint64_t points) {
    tools::SceneArguments arguments;
    arguments.scene = kind + ":" + std::to_string(points);
    const auto source = tools::open_scene(arguments);
    built_ = std::make_unique<tools::BuiltScene>(*source, tools::BuildOptions{});
    list_bytes_.resize(wide::VoxelLists::bytes(built_->compact()) + 64);
    Arena arena(Bytes(list_bytes_.data(), list_bytes_.size()));
    if (wide::VoxelLists::make(built_->compact(), &arena, &lists_) != Status::kOk) {
      throw std::runtime_error("no room for the lists");
    }
  }

  // Milliseconds a frame for each number of threads, one among them.
  std::vector<double> run(bool orthographic, int frames, const std::vector<int>& threads) {
    std::vector<std::vector<double>> seconds(threads.size());
    std::vector<std::vector<std::uint8_t>> pictures(kInARow);
    for (int first = 0; first < frames; first += kInARow - kUncounted) {
      for (std::size_t i = 0; i < threads.size(); ++i) {
        wide::Threads ready(threads[i]);
        for (int turn = 0; turn < kInARow; ++turn) {
          const Camera camera = tools::timed_camera(built_->level(), orthographic, first + turn);
          const double took = draw(camera, &ready);
          if (turn >= kUncounted) {
            seconds[i].push_back(took);
          }
          std::vector<std::uint8_t>& picture = pictures[static_cast<std::size_t>(turn)];
          if (i == 0) {
            picture = pixels_;
          } else if (pixels_ != picture) {
            throw std::runtime_error("pictures differ");
          }
        }
      }
    }
    std::vector<double> ms;
    for (const std::vector<double>& each : seconds) {
      ms.push_back(1e3 * median(each));
    }
    return ms;
  }

 private:
  // Frames in a row with the same threads; the first ones bring caches and threads into their places and do
  // not count.
  static constexpr int kInARow = 24;
  static constexpr int kUncounted = 4;

  double draw(const Camera& camera, wide::Threads* threads) {
    workspace_.resize(std::max(
        workspace_.size(), wide::workspace_bytes(Contest::kWidthPx, Contest::kHeightPx, threads->count())));
    wide::Options options;
    options.threads = threads;
    const Shading shading = tools::timed_shading(camera, built_->bounds());
    const auto frame = [&] {
      if (wide::render(lists_, camera, shading, gray_band(&pixels_, Contest::kHeightPx),
                       Bytes(workspace_.data(), workspace_.size()), nullptr, options) != Status::kOk) {
        throw std::runtime_error("the wide renderer leaves this view to the core");
      }
    };
    return seconds_of(frame, kWallClock);
  }

  std::unique_ptr<tools::BuiltScene> built_;
  std::vector<std::uint8_t> list_bytes_;
  std::vector<std::uint8_t> workspace_;
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(Contest::kPixels);
  wide::VoxelLists lists_;
};

int run(int count, char** words) {
  Choice choice;
  CLI::App app("What threads give the wide renderer");
  app.add_option("--points", choice.points, "numbers of points")->delimiter(',');
  app.add_option("--scene", choice.scenes, "points, cluster")->delimiter(',');
  app.add_option("--threads", choice.threads, "numbers of threads, besides one")
      ->delimiter(',')
      ->check(CLI::Range(2, wide::kMaxThreads));
  app.add_option("--frames", choice.frames, "of each number and row")->check(CLI::Range(1, 1000));
  app.add_option("--csv", choice.csv_path, "results as CSV");
  CLI11_PARSE(app, count, words);
  std::vector<int> threads{1};
  threads.insert(threads.end(), choice.threads.begin(), choice.threads.end());
  std::string csv = "scene,points,projection,threads,frame_ms,times_faster\n";
  for (const std::string& scene : choice.scenes) {
    for (const std::uint64_t points : choice.points) {
      ThreadTable table(scene, points);
      for (const bool orthographic : {false, true}) {
        const std::vector<double> ms = table.run(orthographic, choice.frames, threads);
        std::printf("%-8s%12llu  %-12s  1 thread %.3f ms", scene.c_str(),
                    static_cast<unsigned long long>(points), projection(orthographic), ms[0]);
        for (std::size_t i = 0; i < threads.size(); ++i) {
          if (i > 0) {
            std::printf("  %d threads %.3f ms, %.2f x", threads[i], ms[i], ms[0] / ms[i]);
          }
          char line[160];
          std::snprintf(line, sizeof(line), "%s,%llu,%s,%d,%.4f,%.3f\n", scene.c_str(),
                        static_cast<unsigned long long>(points), projection(orthographic), threads[i], ms[i],
                        ms[0] / ms[i]);
          csv += line;
        }
        std::printf("\n");
        std::fflush(stdout);
      }
    }
  }
  write_text(choice.csv_path, csv);
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_thread_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
