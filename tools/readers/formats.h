/// The readers of scene formats, one a file of this folder; what each reads of its format, and what it refuses, stands
/// there. Which of them reads which file: read_any.h. What readers are made of comes with it: bytes, words, what they return.
#pragma once

#include <algorithm>
#include <optional>

#include "readers/source.h"
#include "readers/text.h"

namespace thimble::tools {

/// An array of two dimensions as it stands.
struct NumberTable {
  std::uint64_t rows = 0, columns = 0;
  std::function<double(std::uint64_t row, std::uint64_t column)> at;  ///< keeps the file
};
/// The table of a `.npy`, or of the member of an `.npz` that has the most numbers.
/// @throws InputError  a broken header, another type or number of dimensions, fewer bytes than the shape takes
NumberTable read_npy_table(const SharedBytes& file);

/// The height at a point of a grid; NaN where there is none. Rows count from the farthest.
using HeightAt = std::function<double(std::uint64_t column, std::uint64_t row)>;
/// Heights as a landscape of voxels (height_grid.cpp). `height` is called twice for some points, and not
/// kept. Memory: 2 bytes a column of voxels.
/// @throws InputError  fewer than 2 x 2 points, no height at all
Source height_landscape(std::uint64_t columns, std::uint64_t rows, const HeightAt& height);

/// The plain colour of a block of Minecraft or Minetest by its name, such as `minecraft:oak_leaves[persistent=true]`
/// (block_colors.cpp); nothing for air and what is as invisible. A name that says nothing is grey.
std::optional<Rgb> block_color(std::string_view name);
/// The same by its number in files from before 2018. `data` tells the colour of wool, clay and glass.
std::optional<Rgb> block_color(unsigned number, unsigned data);

/// What a LAS header says of its points.
struct LasPoints {
  std::uint64_t first_offset = 0;  ///< of the first record in the file
  std::uint64_t count = 0;
  std::uint64_t record_bytes = 0;
};

/// A record of what is unpacked: x, y, z, three bytes that mean nothing, and the byte 15 of the point's format, which
/// has the mark "withheld"; with colours then r, g, b of 16 bits. All little endian, as in LAS.
inline constexpr std::uint64_t kPlainPointBytes = 16;
inline constexpr std::uint64_t kColoredPointBytes = 22;

/// Unpacks the points of a `.laz` that `points` describes, one record each (laz.cpp).
///
/// Time: some 100 to 300 ns a point. Memory: the records and 4 MB. Believed are 2,000,000 points, and 5 for
/// each byte of the file.
///
/// Source: M. Isenburg, "LASzip: lossless compression of LiDAR data" (2013) and the specification of LASzip's native
/// extension for LAS 1.4; A. Said, "Introduction to Arithmetic Coding" (HPL-2004-76).
///
/// @throws InputError  a compressor, item or version that is not read (waveforms among the old formats, LASzip before
///   2.0), bytes that end too soon or are damaged, a count that they are not believed to hold
SharedBytes unpack_laz(const SharedBytes& file, const LasPoints& points, bool has_color,
                       const Progress& progress);

/// What a reader needs beside the bytes; most need none of it.
struct ReadOptions {
  std::string path{};                    ///< of the file, for the other files that it names; may be empty
  std::optional<std::uint32_t> frame{};  ///< of an animation; by default the earliest key of each node
  ArrayAs as = ArrayAs::kByShape;        ///< of an array of numbers
  std::uint16_t full_color = 0;  ///< what a full red, green or blue is; 0: what the file's colors let guess
  bool is_beside = false;        ///< another file names it, which waits for no pipe or device
};

/// Reads all of `file`, already decompressed, and checks it. What streams (points, voxels) keeps the file and reads it
/// again each time; a mesh keeps none of it.
/// @param progress  may be empty; may throw, which ends the reading
/// @throws InputError  what is wrong, and where
using FormatReader = Source(const SharedBytes& file, const ReadOptions& options, const Progress& progress);
FormatReader read_binvox, read_gadget, read_gltf, read_gox, read_height_grid, read_kv6, read_kvx, read_las,
    read_mts, read_npy, read_obj, read_oct, read_octomap, read_off, read_pcd, read_ply, read_qb, read_qbcl,
    read_scene_text, read_schematic, read_stl, read_vox, read_vxl, read_xyz;

/// How Voxlap's own maps begin; those of Ace of Spades have nothing to know them by.
inline constexpr std::string_view kVoxlapMagic("\x00\x20\x07\x09", 4);

/// Whether a file that begins so is of the format.
using FormatLook = bool(std::string_view text);
FormatLook looks_like_gadget, looks_like_gltf, looks_like_height_grid, looks_like_npy, looks_like_octomap,
    looks_like_off, looks_like_pcd, looks_like_ply, looks_like_schematic, looks_like_stl;

}  // namespace thimble::tools
