#include "scene/flash_baking.h"

#include <algorithm>

#include "output/units.h"
#include "scene/board_fit.h"

namespace thimble::tools {
namespace {

std::string limit_text(const FlashLimit& limit, EffectSet effects, std::uint64_t bytes) {
  const platform::BoardFacts* const board = limit.board;
  if (board != nullptr && bytes == scene_flash_bytes(*board, effects)) {
    return std::string(board->name) + " has " + grouped(bytes) + " bytes of flash for a scene (" +
           grouped(board->flash_bytes) + " less " + grouped(code_flash_bytes(*board, effects)) +
           " for the demonstration)";
  }
  return "the limit is " + grouped(bytes) + " bytes (--memory)";
}

// Whether the scene with its light keeps the limit, uncoarsened, and the board can draw it.
bool has_room_for_light(const FlashLimit& limit, const Baked& baked) {
  const platform::BoardFacts* const board = limit.board;
  return baked.fits && baked.bytes.size() <= limit.bytes(baked.effects).value_or(UINT64_MAX) &&
         baked.scene.tree().solid_added() == 0 &&
         (board == nullptr || drawing_ram_bytes(*board, baked.effects) <= board->ram_bytes);
}

}  // namespace

std::optional<std::uint64_t> FlashLimit::bytes(EffectSet effects) const {
  if (board == nullptr) {
    return memory_bytes;
  }
  return std::min(scene_flash_bytes(*board, effects), memory_bytes.value_or(UINT64_MAX));
}

Baked bake_within(const FlashLimit& limit, const SceneSource& source, BakingOptions* options,
                  const Progress& progress) {
  const bool coarsen = options->coarsen;
  options->coarsen = false;
  Baked baked = bake_scene(source, *options, progress);
  const auto keep_limit = [&] {
    // With the code of its effects it does not fit: without a brick map, or not at all.
    options->limit_bytes = limit.bytes(baked.effects);
    if (options->limit_bytes && (!baked.fits || baked.bytes.size() > *options->limit_bytes)) {
      baked = bake_scene(source, *options, progress);
    }
  };
  keep_limit();
  if (options->default_look && baked.effects != Effect::kNone && !has_room_for_light(limit, baked)) {
    options->default_look = false;  // light that nobody asked for never costs a scene its place
    options->limit_bytes = limit.bytes();
    baked = bake_scene(source, *options, progress);
    keep_limit();
  }
  options->coarsen = coarsen;
  if (coarsen && !baked.fits) {
    baked = bake_scene(source, *options, progress);
  }
  return baked;
}

std::string too_large_text(const FlashLimit& limit, const Baked& baked, const BakingOptions& options,
                           int level) {
  const std::uint64_t most = options.limit_bytes.value_or(UINT64_MAX);
  const std::uint64_t over = baked.bytes.size() - most;
  return (options.coarsen ? "even the coarsest tree takes " : "takes ") + grouped(baked.bytes.size()) +
         " bytes at depth " + std::to_string(level) + ", " + limit_text(limit, baked.effects, most) + ": " +
         grouped(over) + (over == 1 ? " byte" : " bytes") + " too many";
}

}  // namespace thimble::tools
