/// @file flash_baking.h
/// Baking for a flash of so many bytes, in which the code of the scene's effects lies as well.
#ifndef THIMBLE_TOOLS_SCENE_FLASH_BAKING_H
#define THIMBLE_TOOLS_SCENE_FLASH_BAKING_H

#include <cstdint>
#include <optional>
#include <string>

#include "boards/board_table.h"
#include "scene/baking.h"

namespace thimble::tools {

/// How large a baked scene may be.
struct FlashLimit {
  const platform::BoardFacts* board = nullptr;  ///< may be null
  std::optional<std::uint64_t> memory_bytes;    ///< --memory

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

#endif
