/// @file scene_options.h
/// SCENE and what is built of it, as most subcommands take it.
#ifndef THIMBLE_TOOLS_COMMANDS_SCENE_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_SCENE_OPTIONS_H

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "scene/scene_arguments.h"

namespace CLI {
class App;
}
namespace thimble::platform {
struct BoardFacts;
}

namespace thimble::tools {

class BuiltScene;
class SceneSource;

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
  /// What is kept back of the budget for pictures.
  struct DrawingBytes {
    std::uint64_t band = 0;        ///< of pixels; 0: none are drawn
    std::uint64_t least_band = 0;  ///< what will do for a band when the budget is short
    std::uint64_t state = 0;       ///< of what draws, beside the band
  };
  /// Builds inside the budget. With --board a baked scene stays outside of it, in the board's flash, where it
  /// must fit; the source must then outlive what is built.
  BuiltScene build(const SceneSource& source, const DrawingBytes& drawing) const;
  /// The same where nothing is drawn.
  BuiltScene build(const SceneSource& source) const;
};

/// An option --board, whose `help` says what of the board counts.
void add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help);
/// An option that is a number of bytes.
void add_bytes(CLI::App& app, const std::string& name, std::optional<std::uint64_t>* bytes,
               const std::string& help);

}  // namespace thimble::tools

#endif
