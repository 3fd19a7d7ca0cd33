/// SCENE, what is built of it, what light does in it, how it is seen and what draws, as most subcommands take it.
#pragma once

#include "boards/board_table.h"
#include "commands/arguments.h"
#include "scene/framing.h"
#include "scene/painter.h"
#include "scene/scene_source.h"

namespace thimble::tools {

/// SCENE, --depth, --memory, --board and the rest that decides what is built.
struct SceneOptions {
  SceneArguments arguments;
  std::optional<std::uint64_t> memory_bytes;
  bool coarsen = false;
  StructureKind structure = StructureKind::kCompact;
  bool quiet = false;
  int build_threads = 1;  ///< that may build; the subcommand says
  std::string stats_path;
  const platform::BoardFacts* board = nullptr;

  /// All of them.
  void add_to(CLI::App& app);
  /// Only SCENE, --depth, --as-voxels and --z-up.
  void add_scene(CLI::App& app, bool required = true);
  /// Only --quiet and --stats.
  void add_report(CLI::App& app);

  /// --memory or what the board's RAM has beside its stack, the smaller of both; nothing without either.
  std::optional<std::uint64_t> budget_bytes() const;
  std::unique_ptr<SceneSource> open() const;
  /// Builds inside the budget. With --board a baked scene stays outside of it, in the board's flash, where it
  /// must fit; the source must then outlive what is built. Of `options` only what is kept back for pictures counts.
  BuiltScene build(const SceneSource& source, BuildOptions options = {}) const;
};

/// An option --board, whose `help` says what of the board counts.
CLI::Option* add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help);
/// An option that is a number of bytes.
void add_bytes(CLI::App& app, const std::string& name, std::optional<std::uint64_t>* bytes,
               const std::string& help);

// --effects, --normals and --bounces: what light does in a picture.

/// `more` ends the help of --effects; `usual` is what it says of the default.
void add_effect_options(CLI::App& app, EffectWishes* wishes, const std::string& more = {},
                        const std::string& usual = "auto");

/// --effects (auto, none, all or a list) and --normals alone.
void add_effect_list(CLI::App& app, EffectChoice* choice, const std::string& help,
                     const std::string& usual = "auto", const std::string& value = "LIST");

// --engine and --threads: what draws. The pictures are the same.

/// As many threads as this process may use cores, at most wide::kMaxThreads.
int all_cores();
/// --threads alone, all cores by default.
void add_threads(CLI::App& app, int* threads, const std::string& help);

class GpuEngine;

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
  /// For the viewer.
  void add_view_engines_to(CLI::App& app);
  /// For single rays, whatever the engine.
  TraceOptions trace_options() const;
  /// The GPU with the scene on it where it is to draw, else null. Throws InputError when it cannot be had.
  /// Refuses effects that it does not draw.
  std::unique_ptr<GpuEngine> gpu(const BuiltScene& built, EffectSet effects = Effect::kNone) const;
  /// Refuses what does not draw lit pictures, samples (`at_edges`: where edges are) or less depth.
  void check(bool is_plain, bool is_lit, bool at_edges) const;
  /// Refuses a budget of memory for what does not keep to it.
  void check_budget(bool has_budget) const;
  /// The wide renderer for pictures of that size, where it is to draw and there is room for it within the
  /// scene's budget; else null. Throws InputError when it was chosen by name and cannot be had.
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

// --size, --projection, --eye and the rest that decides how a scene is seen; scene/framing.h makes a camera of it.

/// All that `view` holds. `with_direction_bits`: --direction-bits too.
void add_view(CLI::App& app, ViewWishes* view, bool with_direction_bits = true);
/// The same for pictures that people keep: --view, --turn and --tilt too, and the view and the angle that they
/// start from.
void add_picture_view(CLI::App& app, ViewWishes* view, bool with_direction_bits = true);
/// --direction-bits, for subcommands that have no camera too.
void add_direction_bits(CLI::App& app, int* bits);
/// Without --size the picture is as large as the board's; `board` may be null.
void use_display(const platform::BoardFacts* board, ViewWishes* view);

/// --samples: auto, or squares up to 64; another number is taken as the next of them, and said so. `across` gets
/// the square's side; `of_what` says in the help how they lie, `usual` what is taken without the option.
void add_samples(CLI::App& app, int* across, bool* at_edges, const std::string& of_what,
                 const std::string& usual);
/// --samples, --cutoff and --max-depth.
void add_quality(CLI::App& app, Quality* quality);

/// The shade of displays of one bit (picture/ink.h).
inline constexpr const char* kInk = "ink";
/// --shade. `given` gets its word where it is given, and without it the scene's own look is drawn; null: depth is. With
/// `has_ink` ink is one of them, whose tones are palette colours.
void add_shade(CLI::App& app, ShadeMode* mode, const std::string& help, std::string* given = nullptr,
               bool has_ink = false);

}  // namespace thimble::tools
