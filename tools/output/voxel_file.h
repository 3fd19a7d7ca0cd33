/// Voxels with their colours as files of other programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "output/output_file.h"
#include "output/progress.h"
#include "readers/source.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// Formats that hold every voxel at its place, so that their readers give the same voxels again:
/// - kVox: MagicaVoxel, version 150 or 200; a model for each 256 x 256 x 256 voxels that hold some. Readers put the
///   lowest model's corner to 0, which moves what is 256 voxels and more away from it
/// - kNpy: NumPy, X x Y x Z x 4 bytes red, green, blue and 255 where solid, 0 elsewhere; without colours X x Y x Z
///   bytes, 1 where solid. Index 0 is the voxel 0 on each axis, the last one the greatest that is solid
/// - kPly: points, binary; x, y, z as 16 bits and, with colours, red, green, blue as 8
/// - kCsv: a header and a line x,y,z or x,y,z,r,g,b a voxel. Readers take colours none of which passes 1 for parts
///   of 1, so such ones are written so
enum class VoxelFormat : std::uint8_t { kVox, kNpy, kPly, kCsv };

/// By the ending of a file's name, in any case of letters.
std::optional<VoxelFormat> voxel_format(std::string_view path);

/// Longest array that is written as .npy, bytes: it is made in memory.
inline constexpr std::uint64_t kMostArrayBytes = std::uint64_t{1} << 32;

/// Writes the voxels of a tree that is not empty; a .vox has colours also without `has_colors`. Memory: an array's
/// bytes (.npy), four bytes a voxel (.vox), else one block of text.
/// @throws InputError   an array that would be larger than `kMostArrayBytes`
/// @throws OutputError  what cannot be written
void write_voxels(OutputFile* file, VoxelFormat format, const CompactTree& tree, const Palette& palette,
                  bool has_colors, const Progress& progress);

}  // namespace thimble::tools
