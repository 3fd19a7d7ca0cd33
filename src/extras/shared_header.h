// Byte offsets of a shared tree's header (src/FORMAT.md), for its writer and its reader. Internal to src/.
#pragma once

#include <stdint.h>

#include "../tree/compact_header.h"
#include "thimble/tree/shared_tree.h"

namespace thimble {

namespace shared_header {

using namespace tree_header;
inline constexpr uint32_t kMagic = 0x01474D54;  // "TMG", then the version, 1
inline constexpr uint32_t kLinkBytesOffset = 5;
inline constexpr uint32_t kLeavesOffset = 20;
inline constexpr uint32_t kRootOffset = 24;
inline constexpr uint32_t kNodesEndOffset = 56;
inline constexpr uint32_t kCountBytesOffset = 60;
inline constexpr uint32_t kLevelsOffset = 64;  // where the nodes of level 2, 3, ... begin
static_assert(kLevelsOffset == kSharedHeaderBytes);

}  // namespace shared_header

// Bytes that hold every number up to `most`, 1 .. 4.
constexpr unsigned bytes_for(uint32_t most) {
  return most < 0x100U ? 1 : most < 0x10000U ? 2 : most < 0x1000000U ? 3 : 4;
}

}  // namespace thimble
