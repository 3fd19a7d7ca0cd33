/// @file schematic.h
/// Minecraft schematics: `.schematic` (MCEdit) and `.schem` (Sponge, versions 1 to 3).
///
/// What is read: Width (x), Height (y, up) and Length (z) and the blocks. Of a `.schematic`: Blocks,
/// AddBlocks (four more bits each) and the colour in Data. Of a `.schem`: Palette and BlockData, on the first
/// level or, as version 3 has it, within Schematic and Blocks. Blocks have the colours of block_colors.h and
/// all are whole cubes; entities, biomes and what chests hold are passed over. Here z is up: (x, y, z) -> (x,
/// -z, y).
///
/// Sources of the formats: Minecraft Wiki, "Schematic file format"; SpongePowered, "Sponge Schematic
/// Specification" 1 to 3.
#ifndef THIMBLE_TOOLS_READERS_SCHEMATIC_H
#define THIMBLE_TOOLS_READERS_SCHEMATIC_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// True for a compound of the names that such files begin with, unpacked.
bool looks_like_schematic(std::span<const std::uint8_t> bytes);

/// Checks the whole file; the result keeps `file` and streams from it. Memory: 4 bytes a palette entry.
/// @throws InputError  broken tags; a size that is missing, 0 or over `kGridSideLimit`; not as many blocks as
///   the size says; a block that the palette does not have; nothing but air
Source read_schematic(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
