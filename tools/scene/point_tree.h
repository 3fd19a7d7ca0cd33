/// Many strewn points as a compact tree, in less memory than a list of their keys takes; and the sort of such a list.
#pragma once

#include <cstdint>

#include "output/progress.h"
#include "thimble/base/memory.h"

namespace thimble::tools {

class SceneSource;

/// The world is divided into cubes of 256 voxels a side, the parts, so its level is above this one.
inline constexpr int kPartLevel = 8;

/// A tree that was built, and what it took.
struct PointTree {
  Bytes tree;                    ///< at the front of the room; empty where that does not suffice
  std::uint64_t voxels = 0;      ///< different ones
  std::uint64_t most_bytes = 0;  ///< in use at once
};

/// Builds the tree that `CompactTree::make` gives for the keys of a point set above kPartLevel, bit for bit.
///
/// Points are dealt into a list a part, 3 bytes a point and 1 more with materials. A list that grows beyond a grid of its
/// part becomes that grid, so that points that repeat take no more. Part after part is then drawn into a grid, a bit a
/// voxel in Morton order, whose bytes are the masks of level 1; those of higher levels follow from them without a sort.
/// Where all lists would take more than `most_list_bytes`, the source is streamed again for the parts that were left out.
///
/// @param room  address space, of which pages take memory once they are written: it is used here and there, and what is
///   no longer needed is given back to the system
PointTree build_point_tree(const SceneSource& source, Bytes room, int threads, const Progress& progress,
                           std::uint64_t most_list_bytes = std::uint64_t{3} << 29);

// Morton keys sorted with what a desktop has: caches, some spare bytes and threads.

/// Most bytes of scratch that sorting so many keys on so many threads makes use of: a byte a key at most.
std::size_t key_sort_scratch_bytes(std::size_t keys, int threads);

/// What `sort_keys` (thimble/tree/compact_tree.h) does, two to three times as fast: keys are dealt in place into
/// buckets by their highest 8 bits, and a bucket that fits the scratch (or is dealt again until it does) goes
/// there and back in passes of 11 bits, lowest first. Buckets are shared out among `threads`, 1 or more.
/// `scratch` is aligned for keys and overwritten; with none, or for short lists, it is `sort_keys`.
/// Key: std::uint32_t or std::uint64_t.
template <class Key>
void sort_keys_fast(Span<Key> keys, int key_bits, Bytes scratch, int threads);

}  // namespace thimble::tools
