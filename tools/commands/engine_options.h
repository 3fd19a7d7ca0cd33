/// @file engine_options.h
/// --engine and --threads: what draws. The pictures are the same.
#ifndef THIMBLE_TOOLS_COMMANDS_ENGINE_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_ENGINE_OPTIONS_H

#include <cstdint>
#include <memory>
#include <string>

#include "thimble/light/scene.h"

namespace CLI {
class App;
}
namespace thimble {
struct TraceOptions;
}

namespace thimble::tools {

/// As many threads as this process may use cores, at most wide::kMaxThreads.
int all_cores();
/// --threads alone, all cores by default.
void add_threads(CLI::App& app, int* threads, const std::string& help);

class BuiltScene;
class GpuEngine;
class LitStreams;
class WideRenderer;

struct EngineOptions {
  std::string name = "auto";
  int threads = 1;
  bool threads_given = false;

  /// `all_cores`: --threads is as many as there are cores unless it is given; otherwise 1.
  void add_to(CLI::App& app, bool all_cores = true);
  /// Where there is a budget of memory one thread is the default: what threads keep counts, and figures are
  /// to be the same on every machine.
  void keep_to_budget(bool has_budget) { threads = has_budget && !threads_given ? 1 : threads; }
  /// --engine alone, for subcommands that draw nothing.
  void add_ray_engines_to(CLI::App& app);
  /// For applications on a simulated board, where the core draws as the board has it draw.
  void add_board_engines_to(CLI::App& app);
  /// For single rays, whatever the engine.
  TraceOptions trace_options() const;
  /// The GPU with the scene on it where it is to draw, else null. Throws InputError when it cannot be had.
  std::unique_ptr<GpuEngine> gpu(const BuiltScene& built) const;
  /// Refuses a budget of memory for what does not keep to it.
  void check_budget(bool has_budget) const;
  /// The wide renderer for pictures of that size, where it is to draw and there is room for it within the
  /// scene's budget; else null. Throws InputError when it was asked for by name and cannot be had.
  std::unique_ptr<WideRenderer> wide_renderer(BuiltScene* built, std::int32_t width_px,
                                              std::int32_t height_px) const;
  /// Streams of rays for lit pictures, where they are to draw and there is room for them within the scene's budget;
  /// else null.
  std::unique_ptr<LitStreams> lit_streams(BuiltScene* built, EffectSet effects, const LitScene& scene) const;
  /// How many threads draw lit pictures with the core: each keeps rays of its own, in what the budget has left.
  int lit_threads(BuiltScene* built, EffectSet effects) const;
  /// What was used.
  std::string resolved(bool is_wide) const {
    return is_wide ? "wide" : name == "ray32" || name == "gpu" ? name : "ray64";
  }
};

}  // namespace thimble::tools

#endif
