// The bytes of a shared tree: opening, checking, finding children and materials. src/FORMAT.md is the
// specification; shared_build.cpp writes them.
#include "thimble/tree/shared_tree.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "shared_header.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

// What is wrong with the header, or nullptr. Everything that later reads rely on is looked at here.
const char* header_fault(ConstBytes bytes, uint32_t* place) {
  using namespace shared_header;
  if (bytes.size < kSharedHeaderBytes) {
    return fault(place, 0, "shorter than a header");
  }
  const uint8_t* base = bytes.data;
  if (const uint32_t differ = bits::load32(base) ^ kMagic) {
    return fault(place, 0, (differ & kMagicMask) == 0 ? kAnotherVersion : "not a shared tree");
  }
  const int level = base[kLevelOffset];
  if (level < kMinLevel || level > kMaxLevel) {
    return fault(place, kLevelOffset, "level out of range");
  }
  if (base[kLinkBytesOffset] < 1 || base[kLinkBytesOffset] > 4) {
    return fault(place, kLinkBytesOffset, "links of no such size");
  }
  const unsigned flags = base[kFlagsOffset];
  if ((flags & ~kKnownFlags) != 0) {
    return fault(place, kFlagsOffset, "unknown flag");
  }
  const bool many = (flags & kManyMaterialsFlag) != 0;
  if ((base[kCountBytesOffset] != 0) != many || base[kCountBytesOffset] > 4) {
    return fault(place, kCountBytesOffset, "counts of no such size");
  }
  const uint64_t front = shared_front_bytes(level);
  const uint64_t nodes_end = bits::load32(base + kNodesEndOffset);
  if (nodes_end < front || nodes_end >= SharedTree::kNowhere) {
    return fault(place, kNodesEndOffset, "nodes beyond the limits");
  }
  const uint64_t leaves = bits::load32(base + kLeavesOffset);
  const uint64_t materials = many ? (leaves + 3) & ~uint64_t{3} : 0;
  const uint64_t size = bits::load32(base + kSizeOffset);
  if (size != ((nodes_end + 3) & ~uint64_t{3}) + materials) {
    return fault(place, kSizeOffset, "size does not match the counts");
  }
  if (size > bytes.size) {
    return fault(place, kSizeOffset, "truncated");
  }
  const bool empty = leaves == 0;
  if (empty != (bits::load32(base + kRootOffset) == SharedTree::kNowhere)) {
    return fault(place, kRootOffset, "a root without leaves, or leaves without a root");
  }
  if (!has_sound_bounds(base, empty, level)) {
    return fault(place, kBoundsMinOffset, "bounds outside the world");
  }
  return nullptr;
}

}  // namespace

Status SharedTree::open(ConstBytes bytes, SharedTree* tree) {
  using namespace shared_header;
  if (header_fault(bytes, nullptr) != nullptr) {
    return Status::kDamaged;
  }
  const uint8_t* base = bytes.data;
  SharedTree result;
  result.base_ = base;
  result.level_ = base[kLevelOffset];
  result.link_bytes_ = base[kLinkBytesOffset];
  result.count_bytes_ = base[kCountBytesOffset];
  result.merged_bytes_ = (base[kFlagsOffset] & kMergedFlag) != 0 ? 1 : 0;
  result.uniform_material_ = base[kMaterialOffset];
  result.size_bytes_ = bits::load32(base + kSizeOffset);
  result.node_count_ = bits::load32(base + kNodesOffset);
  result.leaf_count_ = bits::load32(base + kLeavesOffset);
  result.root_ = bits::load32(base + kRootOffset);
  result.first_node_ = static_cast<uint32_t>(shared_front_bytes(result.level_));
  result.nodes_end_ = bits::load32(base + kNodesEndOffset);
  // Any number will do for safety: it only says how the bytes of a node are read.
  result.level_3_ = result.level_ >= 3 ? bits::load32(base + kLevelsOffset + 4) : result.nodes_end_;
  load_bounds(base, &result.bounds_);
  if ((base[kFlagsOffset] & kManyMaterialsFlag) != 0) {
    result.materials_ = base + ((size_t{result.nodes_end_} + 3) & ~size_t{3});
  }
  *tree = result;
  return Status::kOk;
}

uint64_t SharedTree::voxel_count() const {
  using namespace shared_header;
  return base_ == nullptr ? 0 : bits::load64(base_ + kVoxelCountOffset);
}
uint64_t SharedTree::solid_added() const {
  using namespace shared_header;
  return base_ == nullptr ? 0 : bits::load64(base_ + kSolidAddedOffset);
}

// The number in `bytes` bytes at `at`, all of them before the nodes' end.
uint32_t SharedTree::load_number(uint32_t at, unsigned bytes) const {
  uint32_t number = 0;
  for (unsigned i = 0; i < bytes; ++i) {
    number |= uint32_t{base_[at + i]} << (8 * i);
  }
  return number;
}

uint32_t SharedTree::child(uint32_t node, uint32_t mask, unsigned octant) const {
  if (node < first_node_ || node >= nodes_end_) {  // an inline node among them
    return kNowhere;
  }
  // Offsets stay below 2^31 + 40.
  const uint32_t before = bits::popcount8(mask & ((1U << octant) - 1));
  uint32_t at = node + 1;
  uint32_t merged = 0;
  if (merged_bytes_ != 0) {
    if (at >= nodes_end_) {
      return kNowhere;
    }
    merged = ((uint32_t{base_[at]} >> octant) & 1U) * kMergedBit;
    ++at;
  }
  if (node < level_3_) {
    at += before;
    if (at >= nodes_end_) {
      return kNowhere;
    }
    const uint32_t child_mask = base_[at];
    return kInline | child_mask | (child_mask == 0 ? merged : 0);
  }
  at += count_bytes_ + before * link_bytes_;
  if (at + link_bytes_ > nodes_end_) {
    return kNowhere;
  }
  const uint32_t link = load_number(at, link_bytes_);
  return link == 0 ? kInline | merged : link & kNowhere;  // a damaged link is no inline node
}

// Leaves below a node; anything for a damaged one.
uint32_t SharedTree::leaves_of(uint32_t node) const {
  uint8_t mask = 0;
  if (!load(node, &mask)) {
    return 0;
  }
  if ((node & kInline) != 0) {
    return mask == 0 ? 1 : bits::popcount8(mask);
  }
  uint32_t at = node + 1 + merged_bytes_;
  if (node >= level_3_) {
    return at + count_bytes_ <= nodes_end_ ? load_number(at, count_bytes_) : 0;
  }
  uint32_t leaves = 0;
  for (unsigned left = bits::popcount8(mask); left > 0 && at < nodes_end_; --left, ++at) {
    leaves += base_[at] == 0 ? 1 : bits::popcount8(base_[at]);
  }
  return leaves;
}

uint64_t SharedTree::bytes_with_materials() const {
  if (materials_ != nullptr || base_ == nullptr) {
    return size_bytes_;
  }
  uint64_t counted = 0;  // nodes that would get a count
  uint64_t links = 0;
  for (uint32_t at = level_3_; at < nodes_end_; ++counted) {
    const uint32_t children = bits::popcount8(base_[at]);
    links += children;
    at += 1 + merged_bytes_ + children * link_bytes_;
  }
  const uint64_t others = nodes_end_ - links * link_bytes_ + counted * bytes_for(leaf_count_);
  uint64_t end = 0;
  for (unsigned link_bytes = 1; link_bytes <= 4; ++link_bytes) {
    end = others + links * link_bytes;
    if (end <= uint64_t{1} << (8 * link_bytes)) {
      break;
    }
  }
  return ((end + 3) & ~uint64_t{3}) + ((uint64_t{leaf_count_} + 3) & ~uint64_t{3});
}

uint8_t SharedTree::material(const Vec3i& voxel) const {
  if (!is_in_world(voxel, level_)) {
    return 0;
  }
  uint32_t number = 0;  // leaves before the one looked for
  uint32_t node = root_;
  uint8_t mask = 0;
  for (int level = level_; level > 0; --level) {
    if (!load(node, &mask)) {
      return 0;
    }
    if (mask == 0) {
      break;
    }
    const unsigned octant = octant_of(voxel, level);
    if (((uint32_t{mask} >> octant) & 1U) == 0) {
      return 0;
    }
    if (level == 1) {
      number += bits::popcount8(mask & ((1U << octant) - 1));
      break;
    }
    if (materials_ != nullptr) {
      for (uint32_t siblings = mask & ((1U << octant) - 1); siblings != 0; siblings &= siblings - 1) {
        number += leaves_of(child(node, mask, bits::lowest_bit(siblings)));
      }
    }
    node = child(node, mask, octant);
  }
  if (materials_ == nullptr) {
    return uniform_material_;
  }
  return number < leaf_count_ ? materials_[number] : uint8_t{0};
}

const char* SharedTree::validate(ConstBytes bytes, Bytes work, uint32_t* place) {
  using namespace shared_header;
  if (const char* text = header_fault(bytes, place)) {
    return text;
  }
  const uint8_t* base = bytes.data;
  const uint32_t size = bits::load32(base + kSizeOffset);
  if (checksum_around(base, size, kChecksumOffset) != bits::load32(base + kChecksumOffset)) {
    return fault(place, kChecksumOffset, "checksum does not match");
  }
  SharedTree tree;
  if (open(bytes, &tree) != Status::kOk) {
    return fault(place, 0, "not a shared tree");
  }
  if (work.size < shared_check_bytes(size)) {
    return fault(place, 0, "the workspace is too small");
  }
  // A bit for each byte at which a node begins.
  for (size_t i = 0; i < shared_check_bytes(size); ++i) {
    work[i] = 0;
  }
  const auto is_node = [&](uint32_t at) { return (work[at >> 3] >> (at & 7U) & 1) != 0; };

  uint32_t nodes = 0;
  uint32_t at = tree.first_node_;
  for (int level = 2; level <= tree.level_; ++level) {
    const uint32_t list = kLevelsOffset + 4 * static_cast<uint32_t>(level - 2);
    const uint32_t below = level > 2 ? bits::load32(base + list - 4) : 0;
    const uint32_t begin = bits::load32(base + list);
    const uint32_t end = level < tree.level_ ? bits::load32(base + list + 4) : tree.nodes_end_;
    if (begin != at || end < begin || end > tree.nodes_end_) {
      return fault(place, list, "a level that does not begin where the one before ends");
    }
    while (at < end) {
      const uint32_t node = at;
      const uint8_t mask = base[node];
      const uint32_t children = bits::popcount8(mask);
      const uint32_t rest =
          tree.merged_bytes_ +
          (level == 2 ? children : uint32_t{tree.count_bytes_} + children * tree.link_bytes_);
      if (mask == 0 || rest >= end - node) {
        return fault(place, node, "a node that is no node");
      }
      uint32_t merged = tree.merged_bytes_ != 0 ? base[node + 1] : 0U;
      uint32_t leaves = 0;
      for (uint32_t left = mask; left != 0; left &= left - 1) {
        const unsigned octant = bits::lowest_bit(left);
        const uint32_t child = tree.child(node, mask, octant);
        if ((child & kInline) == 0 && (child < below || child >= begin || !is_node(child))) {
          return fault(place, node, "a link that leads to no node of the level below");
        }
        if ((child & kInline) != 0 && static_cast<uint8_t>(child) == 0) {
          merged &= ~(1U << octant);
        } else if (level > 2 && (child & kInline) != 0) {
          return fault(place, node, "a link that leads to no node of the level below");
        }
        leaves += tree.leaves_of(child);
      }
      if (merged != 0) {
        return fault(place, node, "what is no solid block is marked as merged");
      }
      if (level > 2 && tree.count_bytes_ != 0 && leaves != tree.leaves_of(node)) {
        return fault(place, node, "wrong count of leaves");
      }
      work[node >> 3] = static_cast<uint8_t>(work[node >> 3] | 1U << (node & 7U));
      ++nodes;
      at = node + 1 + rest;
    }
  }
  if (at != tree.nodes_end_ || nodes != tree.node_count_) {
    return fault(place, kNodesOffset, "another number of nodes");
  }
  if (tree.root_ == kNowhere) {
    return nullptr;
  }
  const bool solid_root = tree.root_ == kInline || (tree.merged() && tree.root_ == (kInline | kMergedBit));
  const uint32_t top = tree.level_ >= 2 ? bits::load32(base + shared_front_bytes(tree.level_) - 4) : 0;
  const bool voxel_root = tree.level_ == 1 && (tree.root_ & ~uint32_t{0xFF}) == kInline;
  if (!solid_root && !voxel_root &&
      (tree.level_ < 2 || tree.root_ < top || tree.root_ >= tree.nodes_end_ || !is_node(tree.root_))) {
    return fault(place, kRootOffset, "a root that is no node");
  }
  if (tree.materials_ != nullptr && tree.leaves_of(tree.root_) != tree.leaf_count_) {
    return fault(place, kLeavesOffset, "wrong count of leaves");
  }
  return nullptr;
}

}  // namespace thimble
