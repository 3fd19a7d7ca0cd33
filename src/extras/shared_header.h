// Byte offsets of a shared tree's header (src/FORMAT.md), for its writer and its reader. Internal to src/.
#ifndef THIMBLE_SRC_EXTRAS_SHARED_HEADER_H
#define THIMBLE_SRC_EXTRAS_SHARED_HEADER_H

#include <stdint.h>

#include "thimble/tree/shared_tree.h"

namespace thimble {

namespace shared_header {

inline constexpr uint32_t kMagic = 0x01474D54;      // "TMG", then the version, 1
inline constexpr uint32_t kMagicMask = 0x00FFFFFF;  // all but the version
inline constexpr uint32_t kLevelOffset = 4;
inline constexpr uint32_t kLinkBytesOffset = 5;
inline constexpr uint32_t kFlagsOffset = 6;
inline constexpr uint32_t kMaterialOffset = 7;
inline constexpr uint32_t kSizeOffset = 8;
inline constexpr uint32_t kChecksumOffset = 12;
inline constexpr uint32_t kChecksumStart = 16;  // the checksum covers bytes 0..11 and all from here on
inline constexpr uint32_t kNodesOffset = 16;
inline constexpr uint32_t kLeavesOffset = 20;
inline constexpr uint32_t kRootOffset = 24;
inline constexpr uint32_t kBoundsMinOffset = 28;
inline constexpr uint32_t kBoundsMaxOffset = 34;
inline constexpr uint32_t kVoxelCountOffset = 40;
inline constexpr uint32_t kSolidAddedOffset = 48;
inline constexpr uint32_t kNodesEndOffset = 56;
inline constexpr uint32_t kCountBytesOffset = 60;
inline constexpr uint32_t kLevelsOffset = 64;  // where the nodes of level 2, 3, ... begin
static_assert(kLevelsOffset == kSharedHeaderBytes);

inline constexpr unsigned kManyMaterialsFlag = 1;
inline constexpr unsigned kMergedFlag = 2;
inline constexpr unsigned kKnownFlags = kManyMaterialsFlag | kMergedFlag;

}  // namespace shared_header

// Bytes that hold every number up to `most`, 1 .. 4.
constexpr unsigned bytes_for(uint32_t most) {
  return most < 0x100U ? 1 : most < 0x10000U ? 2 : most < 0x1000000U ? 3 : 4;
}

}  // namespace thimble

#endif
