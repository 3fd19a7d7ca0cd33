// Coarsening of the mutable octree: weakest-link pruning (Breiman, Friedman, Olshen, Stone: Classification
// and Regression Trees, 1984, chapter 3) with integers only.
//
// For a price per node, the tree that costs least (added volume + price x nodes) is found from the bottom up
// in one pass: a block is merged when what it adds, given what was merged inside, is at most the price of
// what it saves. Trees of rising prices are nested, and merging the block of the least ratio again and again
// walks through exactly these trees, so the search below finds, instead of every step, only the price at
// which enough is free: passes that write nothing bracket it, the last two passes merge.
#include "octree_parts.h"
#include "thimble/tree/octree.h"

namespace thimble {

namespace {

/// What a pass knows of a block: of all inside it so far, as left after merging.
struct Block {
  uint64_t solid;    ///< volume in voxels
  uint32_t nodes;    ///< its own included
  uint8_t rank;      ///< of the largest piece
  uint8_t material;  ///< of the largest piece
};

constexpr int kMantissaBits = 8;
constexpr uint32_t kMantissa = uint32_t{1} << kMantissaBits;
/// Codes 0 .. kLastThreshold stand for rising ratios 2^-27 .. 2^36.
constexpr uint32_t kLastThreshold = 63 * kMantissa;

}  // namespace

/// The ratio of a code: a small floating-point number, code / 256 its exponent plus 27, code % 256 its
/// fraction. Its parts obey the bounds of `Ratio`.
Octree::Ratio Octree::threshold(uint32_t code) {
  const uint32_t exponent = code >> kMantissaBits;
  const uint64_t digits = kMantissa + (code & (kMantissa - 1));
  // value = digits * 2^(exponent - 27 - kMantissaBits)
  constexpr uint32_t kUnit = 27 + kMantissaBits;
  if (exponent >= kUnit) {
    return {digits << (exponent - kUnit), 1};
  }
  // Below 2^-19 the last digits go: the denominator is at most 2^27. The codes' ratios still rise, if not
  // strictly.
  const uint32_t shift = kUnit - exponent;
  return shift <= 27 ? Ratio{digits, uint32_t{1} << shift} : Ratio{digits >> (shift - 27), uint32_t{1} << 27};
}

/// The least code whose ratio is not below `ratio`.
uint32_t Octree::threshold_code(Ratio ratio) {
  uint32_t low = 0;
  uint32_t high = kLastThreshold;
  while (low < high) {
    const uint32_t middle = (low + high) / 2;
    const Ratio probe = threshold(middle);
    if (probe.added * ratio.saved < ratio.added * probe.saved) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/// One post-order walk over the tree. Returns the number of nodes freed (kMeasure: that would be). kMeasure
/// and kMergeWithin stop as soon as that is `wanted`. If kMeasure does not, `next_ratio` is the least ratio
/// above `limit` that it met: below that no other limit frees more.
uint32_t Octree::pass(Pass kind, Ratio limit, uint32_t wanted, Ratio& next_ratio) {
  // What is known of the blocks that the walk is inside of, from their children so far; voxel nodes need no
  // place.
  Block open[kMaxLevel + 1];
  uint32_t freed = 0;
  next_ratio = {kVolume[kMaxLevel], 1};
  int level = level_;
  uint32_t index = root_;
  for (;;) {
    const Node node = nodes_[index];
    const uint32_t mask = mask_of(node);
    path_[level] = index;
    if (mask != 0 && level > 1) {
      open[level] = {0, 1, 0, 0};
      --level;
      index = link_of(node);
      continue;
    }
    Block block;
    if (mask == 0) {
      block = {kVolume[level], 1, leaf_rank(node, level), leaf_material(node)};
    } else if (has_children(node)) {
      const uint32_t count = count_bits(mask);
      block = {count, 1 + count, 1, leaf_material(nodes_[link_of(node)])};
    } else {
      block = {count_bits(mask), 1, static_cast<uint8_t>(count_bits(mask)), leaf_material(node)};
    }
    // The block is complete; so are those that it is the last child of.
    for (;;) {
      if (block.nodes > 1) {
        const Ratio ratio{kVolume[level] - block.solid, block.nodes - 1};
        // At most 2^36 * 2^27 on either side.
        const uint64_t left = ratio.added * limit.saved;
        const uint64_t right = limit.added * ratio.saved;
        if (left < right || (left == right && kind != Pass::kMergeBelow)) {
          freed += ratio.saved;
          block.solid = kVolume[level];
          block.nodes = 1;
          if (kind != Pass::kMeasure) {
            release_chain(link_of(nodes_[index]));
            make_merged(index, block.material, block.rank);
            voxels_ += ratio.added;
            solid_added_ += ratio.added;
          }
          if (freed >= wanted && kind != Pass::kMergeBelow) {
            if (kind == Pass::kMergeWithin) {
              collapse_above(level);
            }
            return freed;
          }
        } else if (ratio.added * next_ratio.saved < next_ratio.added * ratio.saved) {
          next_ratio = ratio;
        }
      }
      if (level == level_) {
        return freed;
      }
      ++level;
      Block& parent = open[level];
      parent.solid += block.solid;
      parent.nodes += block.nodes;
      if (block.rank > parent.rank) {
        parent.rank = block.rank;
        parent.material = block.material;
      }
      const uint32_t sibling = next_of(nodes_[index]);
      if (sibling != kNone) {
        --level;
        index = sibling;
        break;
      }
      block = parent;
      index = path_[level];
    }
  }
}

/// Merges, least ratio first, until `wanted` (1 .. nodes used - 1) more nodes are free.
void Octree::free_nodes(uint32_t wanted) {
  path_low_ = level_;
  // The critical ratio is the least up to which merging frees enough. It lies from `candidate`, a ratio that
  // occurs in the tree (or 0), to that of code `high`; `low` is the code of the candidate.
  Ratio candidate{0, 1};
  Ratio next_ratio{0, 1};
  uint32_t freed_below = 0;
  uint32_t low = 0;
  uint32_t high = kLastThreshold;
  bool low_known = false;
  bool high_known = false;
  uint32_t probe = threshold_hint_;
  uint32_t step = 1;
  while (low < high) {
    const uint32_t freed = pass(Pass::kMeasure, threshold(probe), wanted, next_ratio);
    if (freed < wanted) {
      freed_below = freed;
      candidate = next_ratio;
      const uint32_t code = threshold_code(candidate);
      low = code > probe ? code : probe + 1;
      low_known = true;
    } else {
      high = probe;
      high_known = true;
    }
    // First away from where the last search ended, in growing steps; once between two bounds, by halves.
    if (low_known && high_known) {
      probe = low + (high - low) / 2;
    } else if (high_known) {
      probe = high > step ? high - step : 0;
    } else {
      probe = low + step < high ? low + step - 1 : high;
    }
    step *= 2;
  }
  threshold_hint_ = high;
  // Within one code the ratios of the tree are few: one after the other. Each pass but the last finds a
  // greater.
  for (;;) {
    const uint32_t freed = pass(Pass::kMeasure, candidate, wanted, next_ratio);
    if (freed >= wanted) {
      break;
    }
    freed_below = freed;
    candidate = next_ratio;
  }
  uint32_t freed = 0;
  if (freed_below > 0) {
    freed = pass(Pass::kMergeBelow, candidate, wanted, next_ratio);
  }
  pass(Pass::kMergeWithin, candidate, wanted - freed, next_ratio);
  path_[level_] = root_;
  path_low_ = level_;
}

namespace {
constexpr uint32_t price_code(int step) {
  constexpr int kLast = Octree::kPriceSteps - 1;
  return static_cast<uint32_t>(step < 0 ? 0 : step > kLast ? kLast : step) * (kMantissa / 4);
}
}  // namespace

uint32_t Octree::pass_at(Pass kind, int step) {
  if (used_ == 0) {
    return 0;
  }
  Ratio next_ratio{0, 1};
  const uint32_t freed = pass(kind, threshold(price_code(step)), UINT32_MAX, next_ratio);
  path_low_ = level_;
  path_[level_] = root_;
  return freed;
}

uint32_t Octree::nodes_at(int step) {
  return used_ - pass_at(Pass::kMeasure, step);
}

void Octree::coarsen_at(int step) {
  pass_at(Pass::kMergeWithin, step);
}

Status Octree::make_room(size_t nodes) {
  if (nodes <= nodes_free()) {
    return Status::kOk;
  }
  if (used_ == 0 || nodes > capacity_ - 1) {
    return Status::kOutOfMemory;
  }
  free_nodes(static_cast<uint32_t>(nodes) - nodes_free());
  return Status::kOk;
}

Status Octree::coarsen_to(size_t max_nodes) {
  if (used_ <= max_nodes) {
    return Status::kOk;
  }
  if (max_nodes == 0) {
    return Status::kOutOfMemory;
  }
  free_nodes(used_ - static_cast<uint32_t>(max_nodes));
  return Status::kOk;
}

}  // namespace thimble
