/// From a scene to the bytes of a baked one, within a limit.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "boards/board_table.h"
#include "scene/host_memory.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/pixel.h"
#include "thimble/tree/brick_map.h"

namespace thimble::tools {

// What a display makes of a scene that somebody bakes for it: the scene's range of brightness becomes the display's,
// and on one of few greys edges are dark, as faces of one grey would run together.

struct DisplayFacts {
  PixelFormat format = PixelFormat::kRgb888;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
};

/// Displays of 1, 2 or 4 bits a pixel.
bool has_few_grays(PixelFormat format);

/// Brightens or dims the light of a scene by what a camera sees of it, at most 96 x 96 of the display's pixels. On few
/// greys the brightest twentieth becomes all but white, else the brightest tenth what it is in a picture of
/// `thimble render` (`expose_light`), both within limits. A function of its arguments, the same on every machine.
void suit_display(const DisplayFacts& display, const CompactTree& tree, const SceneCamera& camera,
                  Span<const Rgb8> palette, const UsedMaterials& used, EffectSet effects,
                  LitDescription* lit);

struct BakingOptions {
  std::optional<std::uint64_t> limit_bytes;  ///< of the baked scene
  bool coarsen = false;                      ///< merge blocks until it keeps the limit
  int threads = 1;                           ///< that build
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
  /// With `default_look`: the display that the light is to suit.
  std::optional<DisplayFacts> display;
  /// With `default_look`: no display has the last word. The scene is baked so that its picture without another word is
  /// that of the source (`LookNote`); `display` says only at which size its brightness is measured.
  bool keeps_look = false;
};

/// A baked scene and what its making took.
struct Baked {
  std::span<const std::uint8_t> bytes;
  BakedScene scene;   ///< views into `bytes`
  HostMemory memory;  ///< of `bytes`
  EffectSet effects = Effect::kNone;
  std::uint64_t work_bytes = 0;
  double seconds = 0;
  /// Whether it keeps the limit. If not, it is the scene as it is (or, coarsened, as small as it gets).
  bool fits = true;
};

/// Bakes `source`. With `coarsen` and a limit that the exact tree does not keep, blocks are merged in the
/// order of law 1 (src/LAWS.md) until it does: what is left of the limit is then less than 1/1024 of it, or
/// than one merge saves. Throws InputError.
Baked bake_scene(const SceneSource& source, const BakingOptions& options, const Progress& progress = {});

/// What a baked scene is called: a file's name without its folder, a generator as it is written. UTF-8: a byte
/// that is none becomes U+FFFD.
std::string scene_name(const std::string& scene);

// Baking for a flash of so many bytes, in which the code of the scene's effects lies as well.

/// How large a baked scene may be.
struct FlashLimit {
  const platform::BoardFacts* board = nullptr;  ///< may be null
  std::optional<std::uint64_t> memory_bytes;    ///< --memory
  /// What the board has for a scene with these effects behind a program that is there; empty: beside the demonstration.
  std::function<std::uint64_t(EffectSet)> room{};

  /// Of the board, without --memory.
  std::uint64_t board_bytes(EffectSet effects) const;
  /// The smaller of both, for a scene with these effects; none where neither is given.
  std::optional<std::uint64_t> bytes(EffectSet effects = Effect::kNone) const;
};

/// Bakes `source`. Light of the default look is left out where the scene would lose its place by it, and what
/// does not fit beside the code of its effects is baked smaller, without a brick map, or not at all (`fits`).
/// `options` are then those of the last try.
Baked bake_within(const FlashLimit& limit, const SceneSource& source, BakingOptions* options,
                  const Progress& progress = {});

/// Why `baked`, which does not fit, does not: a sentence without its end, for advice to follow.
std::string too_large_text(const FlashLimit& limit, const Baked& baked, const BakingOptions& options,
                           int level);

}  // namespace thimble::tools
