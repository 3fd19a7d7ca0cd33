/// @file cutoff.h
/// Leaves out detail that no pixel shows: tracing stops at a node that covers less than a given part of a
/// pixel, and colours it by the mean of what it holds.
///
/// What is solid for a ray, exactly. Let c be the axis of the direction's largest component (the lowest axis
/// on a tie). A node of the tree, a cube of 2^level voxels with level >= 1, is *cut* when
///   - perspective: s >= reach * 2^level, where s is the distance on axis c, in 1/256 voxel, from the origin
///     to the first of the node's two planes of that axis (negative behind the origin) and `reach`, in 1/256
///     of a node's side, is fixed for the ray: `Cutoff::reach_q8`. With w the change of the direction from
///     one pixel to the next, a pixel is s / |d_c| * w wide there, so the node is narrower than `pixels` of
///     it;
///   - orthographic: level <= `Cutoff::level()`, the largest whose side is less than `pixels` pixels;
///   - either: level <= `Cutoff::level()` where `set_level` asked for more: a tree cut off at a depth.
/// A cut node below no other cut node is solid through, whole. All other voxels and merged blocks are what
/// they are without a cut-off. The answer is the first of these boxes that the ray enters, as ray.h defines
/// it for voxels, and a ray that does not meet the tree's `bounds()` misses.
///
/// So it only adds solid, in cubes that hold something solid already and are less than `pixels` pixels wide:
/// nothing vanishes, and what is hit is never farther away than without a cut-off. The answer is a fact of
/// integers, the same in every width and on every machine. `pixels` 0 cuts nothing: the very answers, visits
/// and bytes of ray.h and render.h.
///
/// Source: the idea of stopping where a node is smaller than a pixel is that of Crassin, Neyret, Lefebvre and
/// Eisemann, "GigaVoxels", I3D 2009, and of Laine and Karras, "Efficient Sparse Voxel Octrees", I3D 2010.
///
/// The colour of a node is the mean of the palette's colours over all voxels that are solid in it, each
/// counted once, channel by channel in the palette's own numbers; a voxel within a block counts as one. It is
/// rounded once, to 5, 6 and 5 bits, and not again on the way up: the sums are exact. So the table of colours
/// is a function of the tree's voxels and the palette alone. In trees of one material all means are that
/// material's colour, and no table is needed.
///
/// Firmware that does not call this holds none of it.
#ifndef THIMBLE_PICTURE_CUTOFF_H
#define THIMBLE_PICTURE_CUTOFF_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../trace/ray.h"
#include "../tree/compact_tree.h"
#include "camera.h"
#include "pixel.h"
#include "render.h"
#include "shading.h"

namespace thimble {

/// Bytes of the table: 2 a node, twice what the masks take.
constexpr size_t node_colors_bytes(uint32_t nodes) {
  return static_cast<size_t>(nodes) * 2;
}
/// The same for a tree; 0 for one of one material, which needs none.
inline size_t node_colors_bytes(const CompactTree& tree) {
  return tree.many_materials() ? node_colors_bytes(tree.node_count()) : 0;
}

/// Bound on the difference between a channel of `NodeColors::color` and the exact mean, of 255: half a step
/// of 5 bits, 255 / 62, and half a unit for the way back to 8 bits.
inline constexpr int kNodeColorError = 5;

/// The mean colours of all nodes of a tree: a view of the table's bytes, which outlive it. Copy it freely.
class NodeColors {
 public:
  /// No table.
  constexpr NodeColors() = default;

  /// Makes the table in the front of `out` (any alignment). A material beyond the palette has
  /// `default_color`. One pass over the nodes with a sum a level, about 1 KiB of stack, no other memory; a
  /// few dozen instructions a node and three short divisions. Reads nothing outside the tree's bytes. Errors,
  /// with `colors` as it was: kOutOfMemory (`out` untouched), kDamaged (a tree whose counts contradict each
  /// other).
  static Status make(const CompactTree& tree, Span<const Rgb8> palette, Rgb8 default_color, Bytes out,
                     NodeColors* colors);

  uint32_t nodes() const { return nodes_; }
  /// Mean colour of node `index` < nodes(), each channel back at 0 .. 255.
  Rgb8 color(uint32_t index) const;

 private:
  const uint8_t* packed_ = nullptr;  // rrrrrggg gggbbbbb, little-endian
  uint32_t nodes_ = 0;
};

/// The largest cut-off, in pixels: 64 of a picture with 8 x 8 samples each (render.h).
inline constexpr Q16 kMaxCutoff = Q16::saturate(512);
/// How far `reach_q8` may lie above the real number 256 |d_c| / (w * pixels), in its own units (1/256 of a
/// node's side): rounding up to the next integer takes up to 1, the factor's 2^-29 the rest for distances
/// that there are. Never below it by more than the rest.
inline constexpr int32_t kReachErrorQ8 = 2;

/// Where a picture's rays stop. Plain data, 12 bytes; copy it as you like.
class Cutoff {
 public:
  /// Cuts nothing.
  constexpr Cutoff() = default;

  /// For the rays of `camera`: nodes that cover less than `pixels` (0 .. kMaxCutoff) of its pixels. Cost: a
  /// root and a division.
  /// Errors, which leave it as it was: kOutOfRange (pixels), kBadArgument (a camera without pixels).
  Status set(const Camera& camera, Q16 pixels);

  /// Nodes up to `level` (0 .. kMaxLevel) are cut as well, wherever they are: what is drawn is the tree of
  /// that many levels less. Lower than `level()` changes nothing. kOutOfRange leaves it as it was.
  Status set_level(int level);

  /// Perspective: nodes whose distance is at least this many 1/256 of their side are cut, 1 .. INT32_MAX
  /// (none). `largest` is the direction's largest |component|. One product.
  int32_t reach_q8(int32_t largest) const;
  /// Nodes up to this level are cut; 0 cuts none.
  int level() const { return level_; }
  bool cuts_nothing() const { return factor_ == 0 && level_ == 0; }

 private:
  uint32_t factor_ = 0;  // reach = (largest * factor >> shift) + 1; 0: none
  uint8_t shift_ = 0;
  uint8_t level_ = 0;
};

/// What `closest_hit_cut` found. For a cut node `hit.block_level` is its level, `hit.voxel` its lowest corner
/// and `hit.material` 0; t and axis are those of its faces.
struct CutHit {
  Hit hit;
  bool cut = false;
  uint32_t node = 0;  ///< of a cut node: its number, for `NodeColors::color`
};

/// The first box entered of those defined above. `hit` is written on `kOk`; errors as for `closest_hit`. A
/// cut node is not read and so not counted in `visits`: there are never more visits than without a cut-off,
/// and where nodes are cut there are mostly fewer.
Status closest_hit_cut(const CompactTree& tree, const Ray& ray, const Cutoff& cutoff, CutHit* hit,
                       const TraceOptions& options = {});

/// As `render_band`, with a cut-off set up for the same camera. `colors` is only looked at for kColor and a
/// tree of several materials, and was then made from that tree.
/// Errors, with nothing drawn: those of `render_band`; kBadArgument where colours are needed and `colors` is
/// for another number of nodes.
Status render_band_cut(const CompactTree& tree, const Camera& camera, const Shading& shading,
                       const Cutoff& cutoff, const NodeColors& colors, const Band& band,
                       RenderCounts* counts = nullptr, const TraceOptions& options = {});

}  // namespace thimble

#endif
