/// @file baking.h
/// From a scene to the bytes of a baked one, within a limit.
#ifndef THIMBLE_TOOLS_SCENE_BAKING_H
#define THIMBLE_TOOLS_SCENE_BAKING_H

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/display_look.h"
#include "scene/scene_source.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/tree/brick_map.h"

namespace thimble::tools {

struct BakingOptions {
  std::optional<std::uint64_t> limit_bytes;  ///< of the baked scene
  bool coarsen = false;                      ///< merge blocks until it keeps the limit
  /// Add a brick map (brick_map.h), which makes frames on a chip faster, where the world has one and it keeps
  /// the limit.
  bool brick_map = false;
  int most_map_level = kMaxDeepMapLevel;  ///< deeper worlds get none: the board's (board_table.h)
  /// Which effects the scene is baked for; what they need goes into a section of its own.
  EffectChoice effects;
  std::string name;  ///< cut off at kMaxNameBytes
  /// Chooses the camera once the tree is known; without it the scene gets none.
  std::function<SceneCamera(const CompactTree& tree)> camera;
  /// Bake the light of the default look (default_look.h) where `effects` were not given and the scene states
  /// none. For scenes of people; generators are baked as they are.
  bool default_look = false;
  /// With `default_look`: the display that the light is to suit (display_look.h).
  std::optional<DisplayFacts> display;
  /// With `default_look`: no display has the last word. The scene is baked so that its picture without another word is
  /// that of the source (look_note.h); `display` says only at which size its brightness is measured.
  bool keeps_look = false;
};

/// A baked scene and what its making took.
struct Baked {
  std::vector<std::uint8_t> bytes;
  BakedScene scene;  ///< views into `bytes`; moving this keeps them, copying does not
  EffectSet effects = Effect::kNone;
  std::uint64_t work_bytes = 0;
  double seconds = 0;
  /// Whether it keeps the limit. If not, it is the scene as it is (or, coarsened, as small as it gets).
  bool fits = true;

  Baked() = default;
  Baked(Baked&&) = default;
  Baked& operator=(Baked&&) = default;
};

/// Bakes `source`. With `coarsen` and a limit that the exact tree does not keep, blocks are merged in the
/// order of law 1 (src/LAWS.md) until it does: what is left of the limit is then less than 1/1024 of it, or
/// than one merge saves. Throws InputError.
Baked bake_scene(const SceneSource& source, const BakingOptions& options, const Progress& progress = {});

/// What a baked scene is called: a file's name without its folder, a generator as it is written. UTF-8: a byte
/// that is none becomes U+FFFD.
std::string scene_name(const std::string& scene);

}  // namespace thimble::tools

#endif
