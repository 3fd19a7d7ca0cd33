/// @file options.h
/// Options that several subcommands share, and what they turn into.
#ifndef THIMBLE_TOOLS_COMMANDS_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_OPTIONS_H

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "scene/built_scene.h"
#include "scene/quality.h"
#include "scene/scene_source.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/camera.h"
#include "thimble/trace/trace.h"

namespace CLI {
class App;
}

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
  /// Builds inside the budget, with `band_bytes` for pixels (0: none are drawn), or at least
  /// `least_band_bytes` when the budget is short, and the state of what draws.
  /// With --board a baked scene stays outside the budget, in the board's flash, where it must fit; the source
  /// must then outlive what is built.
  BuiltScene build(const SceneSource& source, std::uint64_t band_bytes, std::uint64_t least_band_bytes,
                   std::uint64_t render_state_bytes = render_bytes()) const;
};

/// An option --board, whose `help` says what of the board counts.
void add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help);
/// An option that is a number of bytes.
void add_bytes(CLI::App& app, const std::string& name, std::optional<std::uint64_t>* bytes,
               const std::string& help);

/// --engine and --threads: what draws. The pictures are the same.
struct EngineOptions {
  std::string name = "auto";
  int threads = 1;

  void add_to(CLI::App& app);
  /// --engine alone, for subcommands that draw nothing.
  void add_ray_engines_to(CLI::App& app);
  /// For applications on a simulated board, where the core draws as the board has it draw.
  void add_board_engines_to(CLI::App& app);
  /// For single rays, whatever the engine.
  TraceOptions trace_options() const;
  /// Makes ready what this engine wants for pictures of that size; whether the wide renderer is to draw.
  /// Throws InputError when it was asked for by name and there is no room for it.
  bool prepare(BuiltScene* built, std::int32_t width_px, std::int32_t height_px) const;
  /// What was used.
  std::string resolved(bool is_wide) const { return is_wide ? "wide" : name == "ray32" ? "ray32" : "ray64"; }
};

using Real3 = std::array<double, 3>;

/// --size, --projection, --eye and the rest that decides where the picture is taken from.
struct ViewOptions {
  std::int32_t width_px = 800;
  std::int32_t height_px = 600;
  bool size_given = false;
  /// Whether any option says where the camera is or how it looks (all but --size and --direction-bits).
  bool placed = false;
  bool orthographic = false;
  std::optional<Real3> eye;
  std::optional<Real3> target;
  std::optional<Real3> up;
  double fov_degrees = 60;
  std::optional<double> span;
  int direction_bits = 0;

  /// `with_direction_bits`: --direction-bits too.
  void add_to(CLI::App& app, bool with_direction_bits = true);
  /// The camera for a world of 2^level; what is not given frames `bounds`. Where that cannot be, because rays
  /// may not start that far away, `note` (may be null) gets a sentence that says so. Throws InputError.
  /// `chosen` (may be null) gets the same camera without the picture's size, as a baked scene keeps it.
  Camera camera(int level, const VoxelBox& bounds, std::string* note = nullptr,
                SceneCamera* chosen = nullptr) const;
  /// The camera that the scene was baked with, unless `placed` or it has none; then the one above.
  Camera camera(const SceneSource& source, int level, const VoxelBox& bounds, std::string* note = nullptr,
                SceneCamera* chosen = nullptr) const;
  /// The same view in a picture `across` times as wide and high. Throws InputError beyond the largest size.
  ViewOptions finer(int across) const;
  /// Without --size the picture is as large as the board's.
  void use_display(const platform::BoardFacts* board);
};

/// --samples, --cutoff and --max-depth.
void add_quality(CLI::App& app, Quality* quality);

/// --direction-bits, for subcommands that have no camera too.
void add_direction_bits(CLI::App& app, int* bits);

}  // namespace thimble::tools

#endif
