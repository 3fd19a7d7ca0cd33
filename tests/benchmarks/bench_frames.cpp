// Seconds a frame of 800 x 600 pixels: this core ray by ray, beside a textbook pointer octree.
//
//   make bench                                       everything, about two minutes
//   make bench BENCH_ARGS=--benchmark_filter=points  what matches
//   make bench BENCH_ARGS=--benchmark_format=json    for machines
//
// In a `pair` row both draw every frame by turns, each with the same rays, so that the load of the machine
// falls on both. `Time` and `CPU` are the core's frame alone (processor time); the counters are
//
//   textbook_ms    the textbook octree's frame
//   faster         textbook_ms / the core's
//   hits           pixels that hit, of the last frame; textbook_hits the same in double precision
//   bytes          of the tree; textbook_bytes that of the other; smaller their ratio
//
// Every frame is seen from a slightly different place and includes the camera, the rays and depth shading
// into 8-bit grey.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/measure.h"
#include "benchmarks/textbook_octree.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 800;
constexpr std::int32_t kHeightPx = 600;
constexpr int kFrames = 5;

// A scene in both structures. Only the last one is kept: rows of one scene stand next to each other.
struct Scene {
  std::string name;
  std::unique_ptr<tools::BuiltScene> built;
  std::unique_ptr<TextbookOctree> textbook;
};

Scene& scene(const std::string& name) {
  static Scene last;
  if (last.name != name) {
    last = {};
    tools::SceneArguments arguments;
    arguments.scene = name;
    const auto source = tools::open_scene(arguments);
    last.built = std::make_unique<tools::BuiltScene>(*source, tools::BuildOptions{});
    // In Morton order, so that nodes that are near in space are near in memory.
    std::vector<std::uint64_t> codes;
    source->stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
          codes.push_back(morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                      static_cast<std::uint32_t>(z)));
        },
        {});
    std::sort(codes.begin(), codes.end());
    last.textbook = std::make_unique<TextbookOctree>(source->level());
    for (const std::uint64_t code : codes) {
      const Vec3i voxel = morton_voxel(code);
      last.textbook->insert(voxel.x, voxel.y, voxel.z);
    }
    last.name = name;
  }
  return last;
}

// From outside with the cube filling the picture, or along y; `frame` moves it a little.
Camera camera_of(int level, bool orthographic, int frame) {
  const double side = 1 << level;
  const double drift = 0.003 * side * (frame % kFrames + 1);
  tools::ViewWishes view;
  view.width_px = kWidthPx;
  view.height_px = kHeightPx;
  view.orthographic = orthographic;
  view.target = tools::Real3{side / 2 + drift / 3, side / 2, side / 2 + drift / 5};
  if (orthographic) {
    view.eye = tools::Real3{(*view.target)[0], -1, (*view.target)[2]};
    view.span = side * kWidthPx / kHeightPx;
  } else {
    view.eye = tools::Real3{side * 0.2 + drift, -side * 0.62, side * 0.75 - drift / 2};
  }
  return tools::frame_box(view, level, {}).camera;
}

std::uint64_t draw_core(const tools::BuiltScene& built, const Camera& camera,
                        std::vector<std::uint8_t>& pixels) {
  Shading shading;
  const DepthRange range = depth_range(camera, built.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  Band band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  band.format = PixelFormat::kGray8;
  band.rows = kHeightPx;
  RenderCounts counts;
  if (built.render_band(camera, shading, band, &counts, {}) != Status::kOk) {
    throw tools::InputError("the rays of this view are not taken");
  }
  return counts.hits;
}

std::uint64_t draw_textbook(const Scene& scene, const Camera& camera, std::vector<std::uint8_t>& pixels) {
  const DepthRange range = depth_range(camera, scene.built->bounds());
  const double scale = 215.0 / (range.far_q8 - range.near_q8);
  std::uint64_t hits = 0;
  for (std::int32_t y = 0; y < kHeightPx; ++y) {
    RowRays rays(camera, 0, y);
    for (std::int32_t x = 0; x < kWidthPx; ++x, rays.next()) {
      const Ray ray = rays.ray();
      const auto t = scene.textbook->first_hit(
          {ray.origin.x.raw / 256.0, ray.origin.y.raw / 256.0, ray.origin.z.raw / 256.0},
          {static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
           static_cast<double>(ray.direction.z)});
      std::uint8_t gray = 0;
      if (t) {
        ++hits;
        gray = static_cast<std::uint8_t>(
            255.0 - std::clamp((*t * camera.depth_per_t_q8() - range.near_q8) * scale, 0.0, 215.0));
      }
      pixels[static_cast<std::size_t>(y) * kWidthPx + static_cast<std::size_t>(x)] = gray;
    }
  }
  return hits;
}

void pair(benchmark::State& state, const std::string& name, bool orthographic) {
  const Scene& both = scene(name);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidthPx) * kHeightPx);
  double core_seconds = 0;
  double textbook_seconds = 0;
  std::uint64_t hits = 0;
  std::uint64_t textbook_hits = 0;
  int frame = 0;
  for ([[maybe_unused]] const auto _ : state) {
    const auto draw_ours = [&] {
      const Camera camera = camera_of(both.built->level(), orthographic, frame);
      hits = draw_core(*both.built, camera, pixels);
    };
    const auto draw_theirs = [&] {
      textbook_hits = draw_textbook(both, camera_of(both.built->level(), orthographic, frame), pixels);
    };
    const double seconds = seconds_of(draw_ours, kProgramClock);
    state.SetIterationTime(seconds);
    core_seconds += seconds;
    textbook_seconds += seconds_of(draw_theirs, kProgramClock);
    ++frame;
  }
  const auto bytes = static_cast<double>(both.built->tree_bytes());
  const auto textbook_bytes = static_cast<double>(both.textbook->bytes());
  state.counters["textbook_ms"] = textbook_seconds * 1e3 / frame;
  state.counters["faster"] = textbook_seconds / core_seconds;
  state.counters["hits"] = static_cast<double>(hits);
  state.counters["textbook_hits"] = static_cast<double>(textbook_hits);
  state.counters["bytes"] = bytes;
  state.counters["textbook_bytes"] = textbook_bytes;
  state.counters["smaller"] = textbook_bytes / bytes;
}

template <class Function>
void add(const std::string& name, const Function& function) {
  for (const bool orthographic : {false, true}) {
    benchmark::RegisterBenchmark((name + (orthographic ? "/orthographic" : "/perspective")).c_str(),
                                 [=](benchmark::State& state) { function(state, orthographic); })
        ->UseManualTime()
        ->Iterations(kFrames)
        ->Unit(benchmark::kMillisecond);
  }
}

const bool kRegistered = [] {
  for (const char* kind : {"points", "cluster"}) {
    for (const char* count : {"1000", "100000", "1000000", "10000000"}) {
      const std::string name = std::string(kind) + ":" + count;
      add("pair/" + name,
          [=](benchmark::State& state, bool orthographic) { pair(state, name, orthographic); });
    }
  }
  add("pair/spheres,depth=8",
      [](benchmark::State& state, bool orthographic) { pair(state, "spheres,depth=8", orthographic); });
  return true;
}();

}  // namespace
}  // namespace thimble::benchmarks
