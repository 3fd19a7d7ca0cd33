/// Says in a word where the tree keeps the materials of a leaf's voxels, so that nobody walks down the tree for them.
#pragma once

#include <stdint.h>

namespace thimble::wide {

/// A leaf is eight cells of 2^3 voxels, numbered as octants. The tree keeps a byte for each voxel of a cell, or one
/// byte for a cell that is solid through in one material.
struct LeafTag {
  uint32_t first_voxel = 0;  ///< the tree's number of the first voxel that has a byte of its own
  uint8_t plain = 0;         ///< a bit for each cell whose voxels have `material`
  uint8_t material = 0;
  uint8_t other = 0;  ///< a bit for each cell that is solid through in another material

  uint64_t word() const {
    return uint64_t{first_voxel} | uint64_t{plain} << 32 | uint64_t{material} << 40 | uint64_t{other} << 48;
  }
  static LeafTag of(uint64_t word) {
    LeafTag tag;
    tag.first_voxel = static_cast<uint32_t>(word);
    tag.plain = static_cast<uint8_t>(word >> 32);
    tag.material = static_cast<uint8_t>(word >> 40);
    tag.other = static_cast<uint8_t>(word >> 48);
    return tag;
  }
};

/// The second word, without its material, of a chunk that is solid through in one material. In other chunks that word
/// is a node's number, or all ones.
inline constexpr uint64_t kSolidChunk = uint64_t{1} << 63;
constexpr bool is_solid_chunk(uint64_t second) {
  return second >> 8 == kSolidChunk >> 8;
}

/// The voxels of a leaf, by the bits of its mask.
struct LeafOrder {
  uint64_t before[64] = {};  ///< by voxel: the voxels whose bytes come before its byte
  uint64_t cells[256] = {};  ///< by set of cells: their voxels
  constexpr LeafOrder() {
    for (unsigned voxel = 0; voxel < 64; ++voxel) {
      for (unsigned other = 0; other < 64; ++other) {
        before[voxel] |= uint64_t{place(other) < place(voxel)} << other;
      }
    }
    for (unsigned set = 0; set < 256; ++set) {
      for (unsigned voxel = 0; voxel < 64; ++voxel) {
        cells[set] |= uint64_t{(set >> cell_of(voxel) & 1U) != 0} << voxel;
      }
    }
  }
  static constexpr unsigned cell_of(unsigned voxel) {
    return (voxel >> 1 & 1U) | (voxel >> 2 & 2U) | (voxel >> 3 & 4U);
  }
  /// A voxel's place in the order of the tree, which is Morton's.
  static constexpr unsigned place(unsigned voxel) {
    return cell_of(voxel) << 3 | (voxel & 1U) | (voxel >> 1 & 2U) | (voxel >> 2 & 4U);
  }
};
inline constexpr LeafOrder kLeafOrder;

}  // namespace thimble::wide
