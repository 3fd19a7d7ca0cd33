/// @file brick_render.h
/// The picture of render.h in a thirteenth of the instructions, for chips that draw frames: a compact tree
/// with a brick map beside it.
///
/// The pixels are those of `render_band` for the tree, bit for bit, whatever the camera, shading, format and
/// band: `render_band` draws what the fast way does not take, single rays or whole frames. Nothing is kept
/// between bands, so bands may be drawn in any order and side by side.
///
/// The fast way takes perspective cameras whose products of distances and directions fit in 32 bits
/// (`draws_fast`): in a world of 64 pictures of up to 1,200 pixels a side from within it, of up to 300 seen
/// from two world sizes away. Bands of many rows that start at a multiple of kBrickTilePx are cheapest, in
/// pictures whose width is a multiple of 16. kDepth costs a division a pixel, and is drawn ray by ray.
///
/// A tile is drawn face by face where faces cover several pixels, else ray by ray.
///
/// Cost on a Cortex-M3: some 360 instructions a pixel of 128 x 64 pixels, 172 of 320 x 240, 96 of 640 x 480;
/// 1.7 to 1.9 times that on a Cortex-M0 (src/picture/README.md, "Frames on a chip"). Stack: 6 KiB
/// (tests/budgets/stack.csv), most of it half-planes, colours and the state of a tile. Code: about 48 KB.
///
/// Options with which the core is compiled (of a board: BOARD_FRAMES) choose what an image has:
///   THIMBLE_SMALL_FRAMES   no tile is drawn face by face, directions have up to 12 bits (pictures of 160 x
///                          128): 3 KiB of stack and 9 KB of code less. Every file that includes this one
///                          must be compiled with the same options.
///   THIMBLE_SWEEP_SLOTS    16 (the default), 8 or 4: each halving takes 0.9 KiB of stack away, then 0.4
#ifndef THIMBLE_PICTURE_BRICK_RENDER_H
#define THIMBLE_PICTURE_BRICK_RENDER_H

#include <stdint.h>

#include "../base/status.h"
#include "../tree/brick_map.h"
#include "../tree/compact_tree.h"
#include "camera.h"
#include "render.h"
#include "shading.h"

namespace thimble {

#ifdef THIMBLE_SMALL_FRAMES
inline constexpr int kMaxBrickDirectionBits = 12;
#else
inline constexpr int kMaxBrickDirectionBits = 15;
#endif
/// Rows of a tile. The rays of a tile start where the first of them may meet something.
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
