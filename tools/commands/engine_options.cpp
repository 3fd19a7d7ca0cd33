#include "commands/engine_options.h"

#include <algorithm>
#include <thread>
#include <vector>

#include "commands/arguments.h"
#include "scene/built_scene.h"
#include "scene/gpu_engine.h"
#include "scene/lit_streams.h"
#include "scene/wide_renderer.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"
#include "wide/limits.h"

namespace thimble::tools {
namespace {

// Refuses what this build was made without.
void choose(const std::string& name, std::string* chosen) {
  if (name == "wide" && WideRenderer::instruction_sets().empty()) {
    refuse_usage("--engine", "\"wide\" is not in this build (-DTHIMBLE_WIDE=OFF); auto and ray64 are");
  }
  if (name == "gpu" && !GpuEngine::is_in_build()) {
    refuse_usage("--engine", "\"gpu\" is not in this build (-DTHIMBLE_GPU=OFF); auto and ray64 are");
  }
  *chosen = name;
}

}  // namespace

int all_cores() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, wide::kMaxThreads);
}

void add_threads(CLI::App& app, int* threads, const std::string& help) {
  *threads = all_cores();
  add_whole_option(
      app, "--threads", "N", 1, wide::kMaxThreads,
      [threads](std::int64_t number) { *threads = static_cast<int>(number); }, help)
      .default_str("all cores");
}

void EngineOptions::add_to(CLI::App& app, bool all_cores) {
  static const std::vector<std::string> kNames{"auto", "wide", "gpu", "ray64", "ray32"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { choose(kNames[index], &name); },
      "wide: object order, with vectors and threads, for --structure compact where there is room; gpu: the "
      "best Vulkan device, without light, for --structure compact, without --memory and --board; ray64, "
      "ray32: ray by ray with products of that width; the answers are the same, but ray32 refuses rays that "
      "need more; auto: wide where it can be, but not with --board, else ray64")
      .default_str("auto");
  also_check(app, [&app, this] {
    const std::string structure = text_given(app, "--structure");
    if ((name == "wide" || name == "gpu") && !structure.empty() && structure != "compact") {
      refuse_usage("--engine " + name + " draws --structure compact only");
    }
  });
  threads = all_cores ? tools::all_cores() : 1;
  add_whole_option(
      app, "--threads", "N", 1, wide::kMaxThreads,
      [this](std::int64_t number) {
        threads = static_cast<int>(number);
        threads_given = true;
      },
      "threads that build, and that draw with the wide engine or with effects")
      .default_str(all_cores ? "all cores; 1 with --memory or --board, whose bytes they count in" : "1");
}

void EngineOptions::add_ray_engines_to(CLI::App& app) {
  static const std::vector<std::string> kNames{"auto", "gpu", "ray64", "ray32"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { choose(kNames[index], &name); },
      "gpu: the best Vulkan device, for --structure compact, without --memory and --board (then nodes are "
      "its "
      "steps); ray64, ray32: products of that width; the answers are the same, but ray32 refuses rays that "
      "need "
      "more; auto: "
      "with vectors from 100,000 rays on, where there is room and not with --board (then nodes are its "
      "steps, "
      "else those of the tree), else ray64")
      .default_str("auto");
  also_check(app, [&app, this] {
    const std::string structure = text_given(app, "--structure");
    if (name == "gpu" && !structure.empty() && structure != "compact") {
      refuse_usage("--engine gpu traces --structure compact only");
    }
  });
}

std::unique_ptr<GpuEngine> EngineOptions::gpu(const BuiltScene& built) const {
  return name == "gpu" ? std::make_unique<GpuEngine>(built) : nullptr;
}

void EngineOptions::check_budget(bool has_budget) const {
  if (name == "gpu" && has_budget) {
    refuse_usage("--engine gpu keeps the scene in the GPU's memory, without --memory and --board");
  }
}

std::unique_ptr<WideRenderer> EngineOptions::wide_renderer(BuiltScene* built, std::int32_t width_px,
                                                           std::int32_t height_px) const {
  if (name != "auto" && name != "wide") {
    return nullptr;
  }
  auto renderer = WideRenderer::make(built, width_px, height_px, threads);
  if (renderer == nullptr && name == "wide") {
    throw InputError(built->structure() == StructureKind::kCompact
                         ? "no room for --engine wide within --memory"
                         : "--engine wide draws --structure compact only");
  }
  return renderer;
}

std::unique_ptr<LitStreams> EngineOptions::lit_streams(BuiltScene* built, EffectSet effects,
                                                       const LitScene& scene) const {
  return name == "auto" ? LitStreams::make(built->compact(), &built->arena(), effects, scene, threads)
                        : nullptr;
}

int EngineOptions::lit_threads(BuiltScene* built, EffectSet effects) const {
  const std::size_t more = built->arena().free_bytes() / lit_render_bytes(effects);
  return static_cast<int>(std::min(static_cast<std::size_t>(threads), 1 + more));
}

void EngineOptions::add_board_engines_to(CLI::App& app) {
  static const std::vector<std::string> kNames{"auto", "wide", "ray64"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { choose(kNames[index], &name); },
      "what draws demo's frames without light; the pictures are the same. wide: object order, with vectors "
      "and "
      "threads, in memory of this machine's own, and the first frame by the core too, for the stack, and "
      "compared; ray64: the core, as on the board (by bricks where the scene has a brick map); auto: wide "
      "where it can be, else ray64. Frames with light, those thinned or refined to hold a rate, and other "
      "applications are always the core's")
      .default_str("auto");
  add_threads(app, &threads, "threads that draw with the wide engine");
}

TraceOptions EngineOptions::trace_options() const {
  TraceOptions options;
  options.width = name == "ray32" ? Width::k32 : Width::k64;
  return options;
}

}  // namespace thimble::tools
