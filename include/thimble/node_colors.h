/// @file node_colors.h
/// The mean colour of every node of a tree, for hits that stop above the voxels (cutoff.h).
///
/// The colour of a node is the mean of the palette's colours over all voxels that are solid in it, each
/// counted once, channel by channel in the palette's own numbers; a voxel within a block counts as one. It is
/// rounded once, to 5, 6 and 5 bits, and not again on the way up: the sums are exact. So the table is a
/// function of the tree's voxels and the palette alone.
///
/// In trees of one material all means are that material's colour, and no table is needed.
#ifndef THIMBLE_NODE_COLORS_H
#define THIMBLE_NODE_COLORS_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/compact_tree.h"
#include "thimble/pixel.h"
#include "thimble/span.h"
#include "thimble/status.h"

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

/// A view of the table's bytes, which outlive it. Copy it freely.
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

}  // namespace thimble

#endif
