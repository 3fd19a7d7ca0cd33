/// What frames by bricks are compared in: a small world of boxes, cameras around and in it, and bands of its frames.
#pragma once

#include "portable/case.h"
#include "thimble/tree/octree.h"

namespace thimble::portable::brick_world {

inline constexpr int kLevel = 4;
inline constexpr int32_t kWidth = 37;
inline constexpr int32_t kHeight = 26;
inline constexpr uint32_t kPoolNodes = 64;
/// Bytes that `make_world` takes of the case's arena, and a brick map of it.
inline constexpr uint32_t kPoolBytes = (static_cast<uint32_t>(Octree::octree_bytes(kPoolNodes)) + 7) & ~7U;
inline constexpr uint32_t kTreeBytes = 80 + 3 * kPoolNodes;
inline constexpr uint32_t kMapBytes = 640;

/// Where the boxes stand: in a world of kLevel or deeper, from a corner on whose coordinates are multiples of 16.
struct Site {
  int level = kLevel;
  Vec3i corner;
};

/// The tree in `check.world.compact`, of materials 1 to 5.
bool make_world(Check& check, const Site& site = {});

inline constexpr int kLookCount = 8;
/// Sets `check.camera` and `check.shading` for one of kLookCount cameras:
enum Look : int { kBefore, kAlongAxis, kInside, kInSolid, kDiagonal, kParallel, kFromAbove, kFarAway };
bool look(Check& check, int number, const Site& site = {});

/// A band of the picture in `check.band`, nothing counted in `check.counts`.
void set_band(Check& check, Bytes bytes, PixelFormat format, int32_t y, int32_t rows);

}  // namespace thimble::portable::brick_world
