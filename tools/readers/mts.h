/// @file mts.h
/// `.mts` schematics of Minetest, versions 1 to 4.
///
/// What is read: the size, the names of the nodes, and which node is where; nodes that a schematic leaves to
/// chance are there unless the chance is 0. Nodes have the colours of block_colors.h, all as whole cubes. In
/// the file y is up; here z is: (x, y, z) -> (x, -z, y).
///
/// Source of the format: Minetest, comment of `src/mapgen/mg_schematic.h`.
#ifndef THIMBLE_TOOLS_READERS_MTS_H
#define THIMBLE_TOOLS_READERS_MTS_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

bool looks_like_mts(std::span<const std::uint8_t> bytes);

/// Checks the whole file. Memory: 4 bytes a node of the schematic, as many as it unpacks to.
/// @throws InputError  another version, a side of 0 or over `kGridSideLimit`, damaged deflated data or not as
///   much of it as the size says, a node without a name, nothing but air
Source read_mts(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
