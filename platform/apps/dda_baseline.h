/// What Thimble is measured against on a chip: the textbook's voxel tracer, as good as it can fairly be made.
///
/// A grid of bits in flash, one a voxel; rays clipped to the model's box; a digital differential analyser in
/// 16.16 fixed point from cell to cell (J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray
/// Tracing", Eurographics 1987); shading by the face that was entered. No floating point, no 64-bit division.
/// Rays along a row differ by additions; the cell's address goes along with the cell, so a step is an
/// addition, a comparison and a load.
///
/// It rounds: near edges a few pixels of a picture differ from the exact one. It knows no materials, which
/// spares it work that Thimble does.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/vec.h"
#include "thimble/picture/camera.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::apps {

/// Bit x + (y << level) + (z << 2 * level), lowest first in a byte: a voxel of the world of 2^level.
struct BitWorld {
  const uint8_t* bits = nullptr;
  int level = 0;
  VoxelBox bounds;
};

/// Bytes of a world's bits.
constexpr size_t bit_world_bytes(int level) {
  return ((size_t{1} << (3 * level)) + 7) / 8;
}

/// Sets the bits of `tree` in `out` (bit_world_bytes of its level, at most level 8), by asking it ray by ray
/// along x; on a host, to bake them. False when `out` is too small.
bool fill_bit_world(const CompactTree& tree, Bytes out, BitWorld* world);

/// Draws rows first_row .. first_row + rows - 1 in 16 greys, the left pixel in the high half of a byte, from
/// a perspective camera. `face_gray[2 * axis + side]`: of faces that look towards smaller (side 0) or greater
/// coordinates, 0 .. 15. Returns how many pixels met something.
uint32_t draw_dda(const BitWorld& world, const Camera& camera, const uint8_t (&face_gray)[6],
                  uint8_t background, int32_t first_row, int32_t rows, uint8_t* pixels);

}  // namespace thimble::apps
