// Lit pictures: the core ray by ray, and the same picture by streams of rays.
//
//   thimble_lit_table room.scene dragon.ply.gz@10 ...    a file's depth behind an @
//
// What has light of its own is drawn with it and with all that it calls for; a scene without gets the sun, its
// shadows, a sky and four rays of occlusion. 800 x 600 on one thread, by turns, processor time, the median of
// --frames; two threads by the clock. `different`: bytes that are not the core's.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "benchmarks/peers/contest.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/lit_description.h"
#include "scene/lit_streams.h"
#include "scene/scene_shape.h"
#include "scene/scene_source.h"

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 800;
constexpr std::int32_t kHeightPx = 600;

// A scene, its light and a view of it.
class LitTrial {
 public:
  LitTrial(const std::string& name, int threads) : source_(open_at(name)), built_(*source_, {}) {
    lit_ = source_->lighting();
    effects_ = tools::called_for(lit_, tools::used_materials(built_.compact()));
    if (effects_ == Effect::kNone) {
      effects_ = Effect::kDirectLight | Effect::kShadows | Effect::kSky | Effect::kAmbientOcclusion;
      lit_.rest.occlusion.rays = 4;
    }
    lit_.find_glow(built_.compact());
    scene_ = tools::lit_scene_for(lit_, tools::used_materials(built_.compact()), effects_);
    camera_ = tools::frame_scene({}, *source_, tools::shape_of(built_)).camera;
    shading_.mode = ShadeMode::kColor;
    shading_.palette = {built_.palette().data(), built_.palette().size()};
    const DepthRange range = depth_range(camera_, built_.bounds());
    shading_.near_q8 = range.near_q8;
    shading_.far_q8 = range.far_q8;
    const std::size_t before = built_.arena().used_bytes();
    streams_ = tools::LitStreams::make(built_.compact(), &built_.arena(), effects_, scene_, threads);
    bytes_ = built_.arena().used_bytes() - before;
    if (streams_ == nullptr) {
      throw std::runtime_error("this build has no streams");
    }
  }

  EffectSet effects() const { return effects_; }
  std::size_t bytes() const { return bytes_; }
  double seconds() const { return streams_->seconds(); }
  void draw_core(std::vector<std::uint8_t>* pixels) const {
    check(render_lit_band(effects_, built_.compact(), camera_, shading_, scene_, band(pixels)));
  }
  void draw_streams(std::vector<std::uint8_t>* pixels) {
    check(streams_->render({effects_, camera_, shading_, scene_}, band(pixels), nullptr));
  }

 private:
  static void check(Status status) {
    if (status != Status::kOk) {
      throw std::runtime_error("the picture cannot be drawn");
    }
  }
  static Band band(std::vector<std::uint8_t>* pixels) {
    pixels->resize(band_bytes(PixelFormat::kRgb888, kWidthPx, kHeightPx));
    return {{pixels->data(), pixels->size()}, PixelFormat::kRgb888, 0, 0, kHeightPx};
  }

  std::unique_ptr<tools::SceneSource> source_;
  tools::BuiltScene built_;
  tools::LitDescription lit_;
  EffectSet effects_ = Effect::kNone;
  LitScene scene_;
  Camera camera_;
  Shading shading_;
  std::unique_ptr<tools::LitStreams> streams_;
  std::size_t bytes_ = 0;
};

int run(int count, char** words) {
  std::vector<std::string> names;
  int frames = 5;
  CLI::App app("Lit pictures by the core and by streams of rays");
  app.add_option("SCENES", names, "files and generators, @DEPTH behind them")->required();
  app.add_option("--frames", frames, "by turns, of each")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, count, words);

  std::printf("%-30s %9s %9s %6s %9s %7s %9s %9s  %s\n", "scene", "core, ms", "ours, ms", "ratio",
              "2 threads", "map, ms", "MB", "different", "effects");
  for (const std::string& name : names) {
    LitTrial one(name, 1);
    LitTrial two(name, 2);
    std::vector<std::uint8_t> expected;
    std::vector<std::uint8_t> pixels;
    std::vector<double> core;
    std::vector<double> ours;
    std::vector<double> by_clock[2];
    for (int frame = 0; frame <= frames; ++frame) {
      const double core_seconds = seconds_of([&] { one.draw_core(&expected); });
      const double seconds = seconds_of([&] { one.draw_streams(&pixels); });
      const double alone = seconds_of([&] { one.draw_streams(&pixels); }, kWallClock);
      const double together = seconds_of([&] { two.draw_streams(&pixels); }, kWallClock);
      if (frame != 0) {  // the first does not count
        core.push_back(core_seconds);
        ours.push_back(seconds);
        by_clock[0].push_back(alone);
        by_clock[1].push_back(together);
      }
    }
    std::size_t different = 0;
    one.draw_streams(&pixels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      different += pixels[i] != expected[i] ? 1U : 0U;
    }
    const double ratio = median(core) / median(ours);
    const double gain = *std::min_element(by_clock[0].begin(), by_clock[0].end()) /
                        *std::min_element(by_clock[1].begin(), by_clock[1].end());
    std::printf("%-30s %9.1f %9.1f %6.2f %9.2f %7.1f %9.1f %9zu  %s\n", short_name(name).c_str(),
                median(core) * 1e3, median(ours) * 1e3, ratio, gain, one.seconds() * 1e3,
                static_cast<double>(one.bytes()) / 1e6, different,
                tools::effects_text(one.effects()).c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_lit_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
