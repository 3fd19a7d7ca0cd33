// What pixels cost beyond greys: formats and shades beside 8-bit grey by depth, each picture compared with the
// core's.
//
//   thimble_format_table                       all rows, a minute
//   thimble_format_table --scenes points:1000  some
//
// Frames are those of `thimble table` (instruments/timed_frames.h), drawn by turns. A row gives the median of
// the grey frames in milliseconds, and what the medians of the others are beside it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/peers/contest.h"
#include "scene/scene_source.h"

namespace thimble::benchmarks {
namespace {

struct Style {
  const char* name;
  PixelFormat format;
  ShadeMode mode;
};
constexpr Style kStyles[] = {
    {"grey", PixelFormat::kGray8, ShadeMode::kDepth},
    {"rgb888", PixelFormat::kRgb888, ShadeMode::kDepth},
    {"rgb565", PixelFormat::kRgb565, ShadeMode::kDepth},
    {"color", PixelFormat::kRgb888, ShadeMode::kColor},
    {"normal", PixelFormat::kRgb888, ShadeMode::kNormal},
    {"mono", PixelFormat::kRgb888, ShadeMode::kMono},
    {"color 565", PixelFormat::kRgb565, ShadeMode::kColor},
    {"rgb332", PixelFormat::kRgb332, ShadeMode::kDepth},
    {"gray4", PixelFormat::kGray4, ShadeMode::kDepth},
    {"1 bit", PixelFormat::kMono1, ShadeMode::kDepth},
};
constexpr std::size_t kStyleCount = sizeof(kStyles) / sizeof(kStyles[0]);

class Trial {
 public:
  explicit Trial(const std::string& scene) : pixels_(std::size_t{3} * Contest::kPixels), wanted_(pixels_) {
    tools::SceneArguments arguments;
    arguments.scene = scene;
    const auto source = tools::open_scene(arguments);
    built_ = std::make_unique<tools::BuiltScene>(*source, tools::BuildOptions{});
    renderer_ = tools::WideRenderer::make(built_.get(), Contest::kWidthPx, Contest::kHeightPx, 1);
    if (renderer_ == nullptr) {
      throw std::runtime_error("no room for the wide renderer");
    }
  }

  // Seconds of one frame.
  double draw(const Style& style, bool orthographic, int frame) {
    const tools::FrameWatch watch;
    const Camera camera = tools::timed_camera(built_->level(), orthographic, frame);
    RenderCounts counts;
    wide::Counts work;
    if (renderer_->render(camera, shading_of(camera, style), band_of(style, &pixels_), &counts, &work) !=
        Status::kOk) {
      throw std::runtime_error("the wide renderer leaves this view to the core");
    }
    return watch.seconds();
  }
  // Bytes of that frame that are not the core's.
  std::size_t differing(const Style& style, bool orthographic, int frame) {
    std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{0});
    wanted_ = pixels_;
    draw(style, orthographic, frame);
    const Camera camera = tools::timed_camera(built_->level(), orthographic, frame);
    RenderCounts counts;
    if (built_->render_band(camera, shading_of(camera, style), band_of(style, &wanted_), &counts, {}) !=
        Status::kOk) {
      throw std::runtime_error("the core does not take the rays of this view");
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      different += pixels_[i] == wanted_[i] ? 0U : 1U;
    }
    return different;
  }

 private:
  Shading shading_of(const Camera& camera, const Style& style) const {
    Shading shading = tools::timed_shading(camera, built_->bounds());
    shading.mode = style.mode;
    shading.palette = Span<const Rgb8>(built_->palette().data(), built_->palette().size());
    shading.background = {20, 40, 60};
    return shading;
  }
  static Band band_of(const Style& style, std::vector<std::uint8_t>* pixels) {
    return {Bytes(pixels->data(), pixels->size()), style.format, 0, 0, Contest::kHeightPx};
  }

  std::unique_ptr<tools::BuiltScene> built_;
  std::unique_ptr<tools::WideRenderer> renderer_;
  std::vector<std::uint8_t> pixels_;
  std::vector<std::uint8_t> wanted_;
};

int run(int count, char** words) {
  std::vector<std::string> scenes{"points:1000",     "points:100000", "points:1000000",
                                  "points:10000000", "castle",        "spheres,depth=8"};
  int frames = 30;
  CLI::App app("What pixels cost beyond greys");
  app.add_option("--scenes", scenes, "scenes")->delimiter(';');
  app.add_option("--frames", frames, "of each style and row")->check(CLI::Range(1, 10000));
  CLI11_PARSE(app, count, words);
  std::printf("%-18s %-12s", "scene", "projection");
  for (const Style& style : kStyles) {
    std::printf(" %9s", style.name);
  }
  std::printf(" %9s\n", "differing");
  for (const std::string& scene : scenes) {
    Trial trial(scene);
    for (const bool orthographic : {false, true}) {
      std::vector<double> seconds[kStyleCount];
      std::size_t differing = 0;
      for (std::size_t style = 0; style < kStyleCount; ++style) {
        differing += trial.differing(kStyles[style], orthographic, 0);
      }
      for (int frame = 0; frame < frames; ++frame) {
        // Each begins a turn as often as the others: the first finds what the last has left in caches.
        for (std::size_t turn = 0; turn < kStyleCount; ++turn) {
          const std::size_t style = (turn + static_cast<std::size_t>(frame)) % kStyleCount;
          seconds[style].push_back(trial.draw(kStyles[style], orthographic, frame));
        }
      }
      const double gray = median(seconds[0]);
      std::printf("%-18s %-12s %9.3f", scene.c_str(), projection(orthographic), 1e3 * gray);
      for (std::size_t style = 1; style < kStyleCount; ++style) {
        std::printf(" %9.2f", median(seconds[style]) / gray);
      }
      std::printf(" %9zu\n", differing);
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_format_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
