/// What `thimble bake` and `thimble image` share: the options of a baked scene, and its baking within a flash.
#pragma once

#include "commands/stats.h"
#include "scene/baking.h"
#include "scene/board_fit.h"

namespace thimble::tools {

// What a header calls the array where nobody says.
constexpr const char* kDefaultIdentifier = "thimble_scene";

struct BakeCommand {
  SceneOptions scene;  // its --memory is the limit of what is written
  ViewWishes view;
  std::string output;
  std::string identifier = kDefaultIdentifier;
  bool as_header = false;
  bool brick_map = false;
  EffectChoice effects;
  std::function<std::uint64_t(EffectSet)> room{};  ///< FlashLimit::room
  // Once it is baked:
  std::string note{};  ///< of the camera
  bool lost_light = false;

  FlashLimit limit() const { return {scene.board, scene.memory_bytes, room}; }
};

/// How it is baked, but for whether it may be coarsened; `note` (may be null) gets that of the camera.
BakingOptions baking_options(const BakeCommand& command, const SceneSource& source, std::string* note);
/// Opens the scene, bakes it within the command's limit; `options` are then those that it was baked with. Throws
/// InputError for what does not fit, with the options that make it fit.
Baked bake(BakeCommand* command, const SceneSource& source, BakingOptions* options);

/// What was baked, in lines for people, without the board.
std::string baked_text(const BakeCommand& command, const BakingOptions& options, const Baked& baked);
Stats baked_stats(const BakeCommand& command, const SceneSource& source, const Baked& baked,
                  std::optional<std::uint64_t> limit);

/// Whether `text` can name a variable in C and in C++: letters, digits and _, no keyword, no leading _ or
/// digit, no two _ in a row, at most 63 characters.
bool is_identifier(std::string_view text);

/// The header: macros IDENTIFIER_BYTES, _DEPTH, ... (the identifier in capitals: THIMBLE_SCENE_... by
/// default; _EFFECTS is the set of scene.h that the scene was baked for, 0 for none, _LAMPS how many of its
/// lights are points), then `static const uint8_t identifier[IDENTIFIER_BYTES]`, aligned to 4 bytes. It
/// includes <stdint.h> and nothing else.
std::string c_header_text(const BakedScene& scene, std::string_view identifier);

/// What is wrong with a scene that wants these effects, for which there is no program.
std::string not_drawn_text(const BakeCommand& command, EffectSet effects);

/// All options of `thimble bake`, for `command`.
void add_bake_options(CLI::App& app, BakeCommand* command);

/// --memory and --coarsen.
void add_fitting(CLI::App& app, BakeCommand* command);

}  // namespace thimble::tools
