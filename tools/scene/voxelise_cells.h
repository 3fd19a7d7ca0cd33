/// @file voxelise_cells.h
/// Triangles to voxels cell by cell, for a mesh whose triangles cover each other many times over: a voxel is
/// asked for until one triangle has it, and a cell until it is full, however many triangles meet it.
#ifndef THIMBLE_TOOLS_SCENE_VOXELISE_CELLS_H
#define THIMBLE_TOOLS_SCENE_VOXELISE_CELLS_H

#include <cstdint>
#include <span>

#include "scene/voxelise.h"

namespace thimble::tools {

/// A cube of 2^level voxels a side by its lowest voxel.
struct TriangleBlock {
  UnitPoint voxel;
  int level;
  /// Bit a: all that the block holds meets the slabs of the plane perpendicular to axis a; bit 3: it all meets the
  /// triangle's bounding box.
  std::uint8_t inside = 0;
};

/// `block.inside` where nothing but the triangle's plane is to be asked.
inline constexpr std::uint8_t kAllInside = 0xF;

/// Whether the triangle meets `block`; asks nothing that is known for the block it is part of, and adds to
/// `block.inside` what its parts need not ask.
bool meets_block(const TriangleBoxTest& test, TriangleBlock& block);
/// The same where the block is known to meet the triangle's plane.
bool meets_slabs(const TriangleBoxTest& test, TriangleBlock& block);

/// A triangle and what its voxels are made of.
struct CellTriangle {
  UnitTriangle corners;
  std::uint8_t material = 0;
};

/// Calls `sink` for blocks that together hold each voxel of the world of 2^level that a triangle meets, once,
/// with the material of the last such triangle.
///
/// Time: the world is cut into eight, and so on, each part with a list of the triangles that meet it, down to
/// parts of 64 voxels a side. They are filled from the last triangle on, and what is full is left alone: its
/// cubes of 4 voxels, its cells of 16, and the triangles that are left once all of it is. Memory:
/// at most 32 bytes a triangle and level, where all of them meet everything.
void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress);

}  // namespace thimble::tools

#endif
