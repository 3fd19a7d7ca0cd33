// Nodes of one level lie side by side, in the order in which a walk in depth comes to them. So a walk in
// depth needs no links: one cursor a level, which only goes forward. A parent's sum is complete when its last
// child's is.
#include "thimble/picture/cutoff.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"

namespace thimble {
namespace {

// Voxels below 2^36, channels below 2^8: sums below 2^44.
struct Sum {
  uint64_t r = 0;
  uint64_t g = 0;
  uint64_t b = 0;
  uint64_t voxels = 0;

  void add(Rgb8 color, int shift) {
    r += uint64_t{color.r} << shift;
    g += uint64_t{color.g} << shift;
    b += uint64_t{color.b} << shift;
    voxels += uint64_t{1} << shift;
  }
  void add(const Sum& other) {
    r += other.r;
    g += other.g;
    b += other.b;
    voxels += other.voxels;
  }
};

// The mean as 0 .. top, of which 255 is the last, rounded to nearest, halves up.
uint32_t mean(uint64_t sum, uint64_t voxels, uint32_t top) {
  return static_cast<uint32_t>(divide(2 * top * sum + 255 * voxels, 2 * 255 * voxels));
}

}  // namespace

Status NodeColors::make(const CompactTree& tree, Span<const Rgb8> palette, Rgb8 default_color, Bytes out,
                        NodeColors* colors) {
  const uint32_t nodes = tree.node_count();
  if (out.size < node_colors_bytes(nodes)) {
    return Status::kOutOfMemory;
  }
  if (!tree.nodes_in_order()) {
    return Status::kDamaged;
  }
  NodeColors result;
  result.packed_ = out.data;
  result.nodes_ = nodes;
  if (nodes == 0) {
    *colors = result;
    return Status::kOk;
  }
  const auto color_of = [&](uint8_t material) {
    return material < palette.size ? palette[material] : default_color;
  };

  // A level as the walk sees it: which node and block come next, the node that is open, its children left.
  struct Level {
    uint32_t next_node = 0;
    uint32_t next_block = 0;
    uint32_t open = 0;
    uint32_t left = 0;
    Sum sum;
  };
  Level levels[kMaxLevel + 1];
  const int top = tree.level();
  uint32_t first = 0;
  for (int level = top; level > 0; --level) {
    levels[level].next_node = first;
    levels[level].next_block = first < nodes ? tree.blocks_before(first) : 0;
    first = first < nodes ? tree.first_child(first) : first;
  }
  uint32_t next_voxel = first;

  // Each turn opens a node, and every cursor ends at the last one.
  for (int level = top; level > 0;) {
    Level& here = levels[level];
    const uint32_t index = here.next_node++;
    if (index >= nodes) {
      return Status::kDamaged;
    }
    const uint32_t mask = tree.mask(index);
    here.open = index;
    here.left = 0;
    here.sum = {};
    if (mask == 0) {
      here.sum.add(color_of(tree.material_of_block(here.next_block++)), 3 * level);
    } else if (level == 1) {
      for (uint32_t child = bits::popcount8(mask); child > 0; --child) {
        here.sum.add(color_of(tree.voxel_material(next_voxel++)), 0);
      }
    } else {
      here.left = bits::popcount8(mask);
    }
    for (; levels[level].left == 0; ++level) {
      const Level& done = levels[level];
      const uint32_t packed = mean(done.sum.r, done.sum.voxels, 31) << 11 |
                              mean(done.sum.g, done.sum.voxels, 63) << 5 |
                              mean(done.sum.b, done.sum.voxels, 31);
      bits::store16(out.data + 2 * static_cast<size_t>(done.open), packed);
      if (level == top) {
        *colors = result;
        return Status::kOk;
      }
      levels[level + 1].sum.add(done.sum);
      --levels[level + 1].left;
    }
    --level;
  }
  return Status::kDamaged;
}

Rgb8 NodeColors::color(uint32_t index) const {
  const uint32_t packed = bits::load16(packed_ + 2 * static_cast<size_t>(index));
  const auto wide = [](uint32_t value, uint32_t top) {
    return static_cast<uint8_t>((value * 255 + top / 2) / top);
  };
  return {wide(packed >> 11, 31), wide(packed >> 5 & 63U, 63), wide(packed & 31U, 31)};
}

}  // namespace thimble
