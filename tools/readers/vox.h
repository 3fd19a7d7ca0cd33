/// @file vox.h
/// MagicaVoxel `.vox` files, versions 150 and 200.
///
/// What is read: all models (SIZE, XYZI), the palette (RGBA, or MagicaVoxel's default one), materials (MATT,
/// MATL), layers (LAYR) and the scene graph (nTRN, nGRP, nSHP) with translations, rotations and mirrors,
/// shared and nested groups, hidden nodes and hidden layers. Of an animation one frame is taken, the first
/// by default. With a scene graph a node is as its key with the greatest `_f` up to the frame
/// says, and holds still until the next one; in a file without one, several models only ever are frames. What
/// is placed stays where it is from frame to frame: the lowest corner is that of all frames together. IMAP
/// orders the colours of the editor's palette window and nothing else, so colours do not depend on it; it is
/// skipped as cameras, lights, notes and unknown chunks are.
///
/// Conventions: the axes are the file's, z up, right-handed. A model of size s turns about the lattice point
/// floor(s / 2), which its node's translation places; voxels turn by their centres, as MagicaVoxel does.
/// Colour index c of a voxel is entry c - 1 of RGBA and `palette()[c]` here; a voxel of index 0 is empty
/// space and is left out.
///
/// Source of the format: ephtracy, "MagicaVoxel .vox File Format" and its extension.
#ifndef THIMBLE_TOOLS_READERS_VOX_H
#define THIMBLE_TOOLS_READERS_VOX_H

#include <cstdint>
#include <memory>
#include <optional>

#include "readers/file_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Longest side of one model: XYZI holds a position in a byte an axis.
inline constexpr std::uint32_t kVoxModelSideLimit = 256;
/// Largest translation, alone or summed over nested groups, on any axis and in either direction.
inline constexpr std::int32_t kVoxTranslationLimit = 1 << 24;
/// Most models placed in a scene. Groups may be shared, so a few bytes can ask for 2^n of them.
inline constexpr std::uint32_t kVoxInstanceLimit = 65536;
/// Most scene graph nodes entered while placing them, for shared groups that hold nothing.
inline constexpr std::uint32_t kVoxVisitLimit = 1 << 20;
/// Most nodes entered to find how far an animation reaches.
inline constexpr std::uint64_t kVoxAnimationLimit = std::uint64_t{1} << 22;
/// Most voxels in all placed models together: what one call of `for_each` may have to do.
inline constexpr std::uint64_t kVoxPlacedVoxelLimit = std::uint64_t{1} << 31;

/// Checks the whole file and places its models.
///
/// The result keeps the file's bytes and streams voxels from them: beyond those, memory is a small multiple
/// of the chunks in the file (some 100 bytes a node or model) plus 24 bytes a placed model. Voxels come model
/// by model in the scene graph's order (depth first, children as listed), each in the order of its XYZI
/// chunk. A scene whose models are all hidden is read and holds no voxels.
///
/// Of an animation of more than `kVoxAnimationLimit` nodes in all frames together, the lowest corner is that
/// of the frame taken.
///
/// @param frame     0 is the first; absent: the earliest key of each node
/// @param progress  called every few hundred kilobytes and with 1 at the end; may be empty; may throw
/// @throws InputError  wrong magic or version; no model; a chunk, string or count that leaves its place; a
///   side over 256; a voxel outside its model; a scene graph without node 0, with an id used twice, a missing
///   node or model or a cycle; a rotation byte that is none; a frame that there is
///   not; any of the limits above
std::unique_ptr<VoxelModel> read_vox(SharedBytes file, const Progress& progress = {},
                                     std::optional<std::uint32_t> frame = {});

}  // namespace thimble::tools

#endif
