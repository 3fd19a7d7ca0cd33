/// @file oct.h
/// Reader of `.oct`: scenes baked by `thimble bake` (src/FORMAT.md). The one reader that hands over a tree,
/// because that is what the file holds; nothing is rebuilt or copied.
#ifndef THIMBLE_TOOLS_READERS_OCT_H
#define THIMBLE_TOOLS_READERS_OCT_H

#include <cstdint>
#include <functional>
#include <span>

#include "readers/shared_bytes.h"
#include "readers/source.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// Opens a baked scene and validates every byte of it, so what comes back is sound. Throws InputError that
/// says what is wrong where.
Source read_oct(const SharedBytes& file, const Progress& progress);

bool looks_like_oct(std::span<const std::uint8_t> bytes);

/// A solid block of one material: its lowest corner, the log2 of its side (0 for a voxel), its material.
using VisitBlock = std::function<void(const Vec3i& corner, int level, std::uint8_t material)>;

/// Visits everything solid of a sound tree, in Morton order.
void for_each_block(const CompactTree& tree, const VisitBlock& visit);

}  // namespace thimble::tools

#endif
