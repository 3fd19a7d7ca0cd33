// How far a band is drawn, and the deferred pixels of a tile: ties for the tree, notes for secondary rays in water. Internal
// to src/.
#pragma once

#include "../../picture/bricks/sight.h"
#include "mirror_rays.h"
#include "point_lighting.h"

namespace thimble::lit {
namespace {

using namespace bricks;

constexpr int kAskedWords = kTileAcrossPx * kTileDownPx / 32;
static_assert(kAskedWords == 4);

// How far a band is drawn: the next tile, and the ties of the tile before it, which are left to the tree.
struct FlatProgress {
  int32_t x;
  int32_t y;
  uint32_t asked[kAskedWords];
};

// What the camera's ray of a pixel meets that may come to water: the face's voxel in the box, and from bit 24 on its side
// and 1; kNothing, or 0 where nothing is noted.
constexpr int kNoteBits = kMaxBrickMapLevel;
constexpr uint32_t kNothing = 7U << 3 * kNoteBits;
inline uint32_t note_of(const FacePoint& point) {
  uint32_t note = side_of(point) + 1;
  for (int i = 2; i >= 0; --i) {
    note = note << kNoteBits | static_cast<uint32_t>(point.voxel[i]);
  }
  return note;
}
struct WetNotes {
  bool any = false;
  uint32_t of[kTileAcrossPx * kTileDownPx] = {};
};

// The same with the notes of the tile.
struct WetProgress : FlatProgress {
  WetNotes* notes;
};
template <EffectSet kSet>
using ProgressOf = Choose<kIsWet<kSet>, WetProgress, FlatProgress>;

}  // namespace
}  // namespace thimble::lit
