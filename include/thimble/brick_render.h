/// @file brick_render.h
/// The picture of render.h in a tenth of the instructions, for chips that draw frames: a compact tree with a
/// brick map beside it.
///
/// The pixels are those of `render_band` for the tree, bit for bit, whatever camera, shading, format and
/// band: what the fast way does not take (below) goes the other's way, pixel by pixel or as a whole. Nothing
/// is kept between bands, so bands may be drawn in any order and side by side.
///
/// The fast way takes perspective cameras of at most kMaxBrickDirectionBits direction bits, for which the
/// products of distances and directions fit in 32 bits (`draws_fast`): at level 6 pictures of up to some 400
/// pixels a side seen from two world sizes away. Bands work best in multiples of kBrickTilePx rows that start
/// at one.
#ifndef THIMBLE_BRICK_RENDER_H
#define THIMBLE_BRICK_RENDER_H

#include <stdint.h>

#include "thimble/brick_map.h"
#include "thimble/camera.h"
#include "thimble/compact_tree.h"
#include "thimble/render.h"
#include "thimble/shading.h"
#include "thimble/status.h"

namespace thimble {

inline constexpr int kMaxBrickDirectionBits = 12;
/// Pixels of a tile's side: rays of one tile start where the first of them may meet something.
inline constexpr int32_t kBrickTilePx = 8;

/// Whether frames of that camera take the fast way.
bool draws_fast(const BrickMap& map, const Camera& camera);

/// As `render_band` (render.h) with `map`, which belongs to `tree`; the counters of nodes stay as they are
/// for rays that read none. Errors, with nothing drawn: those of `render_band`, and kDamaged when the map is
/// another tree's.
Status render_band(const CompactTree& tree, const BrickMap& map, const Camera& camera, const Shading& shading,
                   const Band& band, RenderCounts* counts = nullptr);

/// The same for cameras that `draws_fast`; kBadArgument for others. A firmware that calls this one only has
/// nothing of the 64-bit tracer in its flash and on its stack.
Status render_band_32(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                      const Shading& shading, const Band& band, RenderCounts* counts = nullptr);

}  // namespace thimble

#endif
