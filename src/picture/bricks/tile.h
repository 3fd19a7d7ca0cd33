// The tiles and quads that a band is drawn by. Internal to src/.
#pragma once

#include <stdint.h>

#include "thimble/base/vec.h"

namespace thimble::bricks {
namespace {

// A tile's size; at the edges of a picture or a band tiles are smaller.
constexpr int32_t kTileAcrossPx = 16;
constexpr int32_t kTileDownPx = 8;

// A rectangle of the picture that lies in one tile.
struct Tile {
  int32_t x0;
  int32_t x1;
  int32_t y0;
  int32_t y1;
};

// With up to so many direction bits the product of a rest and a direction takes at most 31: 8 + 11 + 11 is 30.
constexpr int kNarrowDirectionBits = 11;

// Quads divide a tile; each finds a start depth for its own rays.
constexpr int32_t kQuadAcrossPx = 4;
constexpr int32_t kQuadDownPx = 4;
constexpr int32_t kQuadPixels = kQuadAcrossPx * kQuadDownPx;

unsigned signs_of(const Vec3i& d) {
  return (d.x < 0 ? 1U : 0U) | (d.y < 0 ? 2U : 0U) | (d.z < 0 ? 4U : 0U);
}

}  // namespace
}  // namespace thimble::bricks
