// From a compact tree to a shared one: the nodes in Morton order, each after its children; equal ones are
// found in a hash table with chains and kept once. Then they are written level by level, from the lowest up,
// so that every link leads backwards.
#include "../base/bits.h"
#include "../base/fault.h"
#include "shared_header.h"
#include "thimble/base/memory.h"
#include "thimble/tree/shared_tree.h"

namespace thimble {
namespace {

// Walks over a compact tree's nodes from the root down in Morton order. All counts are made from the masks,
// level by level, so that a damaged tree can neither lead outside nor round in circles: each node is visited
// once.
class MortonWalk {
 public:
  explicit MortonWalk(const CompactTree& tree) : tree_(tree) {}

  // Where each level begins, and the leaves. kDamaged when the masks call for another number of nodes.
  Status begin() {
    const uint64_t nodes = tree_.node_count();
    uint64_t start = 0;
    uint64_t count = 1;
    uint64_t blocks = 0;
    for (int level = tree_.level(); level >= 1; --level) {
      if (count > nodes - start) {
        return Status::kDamaged;
      }
      node_[level] = static_cast<uint32_t>(start);
      block_[level] = static_cast<uint32_t>(blocks);
      uint64_t next = 0;
      for (uint64_t end = start + count; start < end; ++start) {
        const uint8_t mask = tree_.mask(static_cast<uint32_t>(start));
        next += bits::popcount8(mask);
        blocks += mask == 0 ? 1U : 0U;
      }
      count = next;
    }
    voxel_ = tree_.node_count();
    leaves_ = blocks + count;
    return start == nodes ? Status::kOk : Status::kDamaged;
  }
  uint64_t leaves() const { return leaves_; }

  // Calls visitor.block(level, merged, material), visitor.voxels(mask, number of the first),
  // visitor.enter(level, mask) and, after all children, visitor.leave(level), which may be false to stop.
  template <class Visitor>
  bool run(Visitor* visitor) {
    uint8_t rest[kMaxLevel + 1];  // children to come, the one that the walk is in included
    const int top = tree_.level();
    int level = top;
    for (;;) {
      const uint32_t node = node_[level]++;
      const uint8_t mask = tree_.mask(node);
      if (mask == 0) {
        visitor->block(level, tree_.is_merged(node), tree_.material_of_block(block_[level]++));
      } else if (level == 1) {
        visitor->voxels(mask, voxel_);
        voxel_ += bits::popcount8(mask);
      } else {
        visitor->enter(level, mask);
        rest[level] = mask;
        --level;
        continue;
      }
      for (;;) {
        ++level;
        if (level > top) {
          return true;
        }
        rest[level] = static_cast<uint8_t>(rest[level] & (rest[level] - 1));
        if (rest[level] != 0) {
          --level;
          break;
        }
        if (!visitor->leave(level)) {
          return false;
        }
      }
    }
  }

 private:
  const CompactTree& tree_;
  uint32_t node_[kMaxLevel + 1];   // the next node of a level
  uint32_t block_[kMaxLevel + 1];  // and solid block
  uint32_t voxel_ = 0;
  uint64_t leaves_ = 0;
};

// The different nodes of level 2 and above. The workspace, in 32-bit words:
//
//   way down              8 a level: children of the nodes that the walk is in
//   heads                 1/8 of what follows, and one: the first record of each chain
//   records               one after the other
//
//   record:  0  the next in its chain; later where the node is written
//            1  | unused 12 | level 4 | merged 8 | mask 8 |
//            2  leaves
//            3  children, in octant order: at level 2 masks, four a word; above, words
//
// A record is known by its place among the records, plus one; 0 is none. Children above level 2 are records,
// or 0 for a solid block.
class NodeTable {
 public:
  static constexpr uint32_t kWayWords = 8 * (kMaxLevel + 2);
  static constexpr uint32_t kHeaderWords = 3;

  // False when the workspace is too small for any tree.
  bool set(Bytes work) {
    const size_t past = reinterpret_cast<size_t>(work.data) & (sizeof(uint32_t) - 1);
    work = work.subspan(past == 0 ? 0 : sizeof(uint32_t) - past);
    size_t words = work.size / 4;
    constexpr uint32_t kMostWords = uint32_t{1} << 30;
    words = words < kMostWords ? words : kMostWords;
    if (words <= kWayWords) {
      return false;
    }
    way_ = static_cast<uint32_t*>(static_cast<void*>(work.data));  // aligned just now
    heads_ = way_ + kWayWords;
    const uint32_t left = static_cast<uint32_t>(words) - kWayWords;
    head_count_ = left / 8 + 1;
    records_ = heads_ + head_count_;
    capacity_ = left - head_count_;
    for (uint32_t i = 0; i < head_count_; ++i) {
      heads_[i] = 0;
    }
    return true;
  }

  // The least workspace in bytes that would have done.
  size_t least_bytes() const {
    // The least w with w - (w / 8 + 1) >= used, which is near used * 8 / 7 = used (1 + 1/8 + 1/64 + ...).
    uint32_t words = used_ + 1;
    for (uint32_t part = used_ >> 3; part != 0; part >>= 3) {
      words += part;
    }
    while (words - (words / 8 + 1) < used_) {
      ++words;
    }
    return 4 * (size_t{kWayWords} + words);
  }

  // As a visitor of the walk.
  void enter(int level, uint8_t mask) {
    OpenNode& frame = frames_[level];
    frame = OpenNode{};
    frame.mask = mask;
  }
  void block(int level, bool merged, uint8_t) { add(level + 1, 0, merged, 1); }
  void voxels(uint8_t mask, uint32_t) { add(2, mask, false, bits::popcount8(mask)); }
  bool leave(int level) {
    const OpenNode& frame = frames_[level];
    const uint32_t* children = way_ + 8 * level;
    const uint32_t head =
        uint32_t{frame.mask} | uint32_t{frame.merged} << 8 | static_cast<uint32_t>(level) << 16;
    // Masks are packed, so that a record of level 2 has at most two words of them.
    uint32_t packed[2] = {0, 0};
    uint32_t count = frame.count;
    if (level == 2) {
      for (uint32_t i = 0; i < frame.count; ++i) {
        packed[i >> 2] |= children[i] << (8 * (i & 3U));
      }
      children = packed;
      count = (frame.count + 3U) / 4;
    }
    uint32_t hash = mixed(0x9E3779B9U, head);
    for (uint32_t i = 0; i < count; ++i) {
      hash = mixed(hash, children[i]);
    }
    uint32_t* const chain = heads_ + static_cast<uint32_t>((uint64_t{hash} * head_count_) >> 32);
    uint32_t found = *chain;
    while (found != 0 && !equals(records_ + (found - 1), head, children, count)) {
      found = records_[found - 1];
    }
    if (found == 0) {
      if (kHeaderWords + count > capacity_ - used_) {
        return false;
      }
      uint32_t* const record = records_ + used_;
      record[0] = *chain;
      record[1] = head;
      record[2] = frame.leaves;
      for (uint32_t i = 0; i < count; ++i) {
        record[kHeaderWords + i] = children[i];
      }
      found = used_ + 1;
      *chain = found;
      used_ += kHeaderWords + count;
      ++count_;
    }
    add(level + 1, found, false, frame.leaves);
    return true;
  }

  uint32_t count() const { return count_; }
  // What the walk came to: a record, a mask (level 1), or 0 with `root_merged` for a solid world.
  uint32_t root(int level) const { return way_[8 * (level + 1)]; }
  bool root_merged(int level) const { return frames_[level + 1].merged != 0; }

  // Calls `take(record)` for all records of a level, in the order in which they came.
  template <class Take>
  void for_level(int level, const Take& take) const {
    for (uint32_t at = 0; at < used_;) {
      uint32_t* const record = records_ + at;
      if (level_of(record) == level) {
        take(record);
      }
      const uint32_t children = bits::popcount8(record[1] & 0xFFU);
      at += kHeaderWords + (level_of(record) == 2 ? (children + 3) / 4 : children);
    }
  }
  uint32_t* record(uint32_t number) const { return records_ + (number - 1); }

 private:
  struct OpenNode {
    uint32_t leaves = 0;
    uint8_t mask = 0;
    uint8_t merged = 0;  // octants that are merged blocks
    uint8_t count = 0;   // children so far
  };

  static int level_of(const uint32_t* record) { return static_cast<int>(record[1] >> 16); }
  static uint32_t mixed(uint32_t hash, uint32_t word) {
    hash = (hash ^ word) * 0x85EBCA6BU;
    hash = (hash ^ (hash >> 15)) * 0xC2B2AE35U;
    return hash ^ (hash >> 13);
  }
  static bool equals(const uint32_t* record, uint32_t head, const uint32_t* children, uint32_t count) {
    if (record[1] != head) {
      return false;
    }
    for (uint32_t i = 0; i < count; ++i) {
      if (record[kHeaderWords + i] != children[i]) {
        return false;
      }
    }
    return true;
  }
  // Another child of the node of `level` that the walk is in.
  void add(int level, uint32_t child, bool merged, uint32_t leaves) {
    OpenNode& frame = frames_[level];
    if (merged) {
      // The octant is that of the set bit of the mask which this child is.
      uint32_t left = frame.mask;
      for (uint32_t i = 0; i < frame.count; ++i) {
        left &= left - 1;
      }
      frame.merged = static_cast<uint8_t>(frame.merged | (left == 0 ? 1U : left & (~left + 1)));
    }
    way_[8 * level + frame.count] = child;
    ++frame.count;
    frame.leaves += leaves;
  }

  uint32_t* way_ = nullptr;
  uint32_t* heads_ = nullptr;
  uint32_t* records_ = nullptr;
  uint32_t head_count_ = 1;
  uint32_t capacity_ = 0;
  uint32_t used_ = 0;
  uint32_t count_ = 0;
  OpenNode frames_[kMaxLevel + 2];
};

// The materials, as they come.
struct MaterialWriter {
  const CompactTree& tree;
  uint8_t* to;

  void block(int, bool, uint8_t material) { *to++ = material; }
  void voxels(uint8_t mask, uint32_t number) {
    for (unsigned left = bits::popcount8(mask); left > 0; --left) {
      *to++ = tree.voxel_material(number++);
    }
  }
  void enter(int, uint8_t) {}
  bool leave(int) { return true; }
};

uint8_t* put_number(uint8_t* to, uint32_t number, unsigned bytes) {
  for (unsigned i = 0; i < bytes; ++i) {
    *to++ = static_cast<uint8_t>(number >> (8 * i));
  }
  return to;
}

// How the nodes are laid out.
struct Layout {
  uint32_t merged_bytes = 0;
  uint32_t count_bytes = 0;
  uint32_t link_bytes = 0;
  uint64_t nodes_end = 0;

  uint32_t node_bytes(const uint32_t* record) const {
    const uint32_t children = bits::popcount8(record[1] & 0xFFU);
    return 1 + merged_bytes + ((record[1] >> 16) == 2 ? children : count_bytes + children * link_bytes);
  }
};

// Bytes of all nodes and what is in front of them, with the fewest bytes a link that can say it.
Layout layout_of(const NodeTable& table, int level, bool merged, uint32_t count_bytes) {
  Layout layout;
  layout.merged_bytes = merged ? 1 : 0;
  layout.count_bytes = count_bytes;
  do {
    ++layout.link_bytes;
    layout.nodes_end = shared_front_bytes(level);
    for (int each = 2; each <= level; ++each) {
      table.for_level(each, [&](const uint32_t* record) { layout.nodes_end += layout.node_bytes(record); });
    }
  } while (layout.link_bytes < 4 && layout.nodes_end > uint64_t{1} << (8 * layout.link_bytes));
  return layout;
}

uint8_t* write_node(const NodeTable& table, const Layout& layout, const uint32_t* record, uint8_t* to) {
  *to++ = static_cast<uint8_t>(record[1]);
  if (layout.merged_bytes != 0) {
    *to++ = static_cast<uint8_t>(record[1] >> 8);
  }
  const uint32_t children = bits::popcount8(record[1] & 0xFFU);
  const uint32_t* const words = record + NodeTable::kHeaderWords;
  if ((record[1] >> 16) == 2) {
    for (uint32_t i = 0; i < children; ++i) {
      *to++ = static_cast<uint8_t>(words[i >> 2] >> (8 * (i & 3U)));
    }
    return to;
  }
  to = put_number(to, record[2], layout.count_bytes);
  for (uint32_t i = 0; i < children; ++i) {
    to = put_number(to, words[i] == 0 ? 0 : *table.record(words[i]), layout.link_bytes);
  }
  return to;
}

// All but magic and checksum, and the list of levels.
void write_header(const CompactTree& tree, const NodeTable& table, const Layout& layout, uint32_t leaves,
                  size_t size, uint8_t* base) {
  using namespace shared_header;
  const int level = tree.level();
  bits::store32(base, kMagic);
  base[kLevelOffset] = static_cast<uint8_t>(level);
  base[kLinkBytesOffset] = static_cast<uint8_t>(layout.link_bytes);
  base[kFlagsOffset] = static_cast<uint8_t>((tree.many_materials() ? kManyMaterialsFlag : 0) |
                                            (layout.merged_bytes != 0 ? kMergedFlag : 0));
  base[kMaterialOffset] = tree.uniform_material();
  bits::store32(base + kSizeOffset, static_cast<uint32_t>(size));
  bits::store32(base + kNodesOffset, table.count());
  bits::store32(base + kLeavesOffset, leaves);
  uint32_t root = SharedTree::kNowhere;
  if (!tree.empty()) {
    const uint32_t found = table.root(level);
    if (level == 1 || found == 0) {
      root = SharedTree::kInline | found | (table.root_merged(level) ? SharedTree::kMergedBit : 0);
    } else {
      root = *table.record(found);
    }
  }
  bits::store32(base + kRootOffset, root);
  store_bounds(tree.bounds(), base);
  bits::store64(base + kVoxelCountOffset, tree.voxel_count());
  bits::store64(base + kSolidAddedOffset, tree.solid_added());
  bits::store32(base + kNodesEndOffset, static_cast<uint32_t>(layout.nodes_end));
  bits::store32(base + kCountBytesOffset, layout.count_bytes);
}

}  // namespace

Status SharedTree::make(const CompactTree& tree, Bytes out, Bytes work, SharedTree* shared,
                        SharedBuild* build) {
  using namespace shared_header;
  NodeTable table;
  if (!table.set(work)) {
    return Status::kOutOfMemory;
  }
  MortonWalk walk(tree);
  if (!tree.empty()) {
    const Status status = walk.begin();
    if (status != Status::kOk) {
      return status;
    }
    if (walk.leaves() > UINT32_MAX) {
      return Status::kOutOfRange;
    }
    if (!walk.run(&table)) {
      return Status::kOutOfMemory;
    }
  }
  const uint32_t leaves = static_cast<uint32_t>(walk.leaves());
  const bool many = tree.many_materials();
  const Layout layout = layout_of(table, tree.level(), tree.merged(), many ? bytes_for(leaves) : 0);
  if (layout.nodes_end >= SharedTree::kNowhere) {
    return Status::kOutOfRange;
  }
  const uint64_t materials = (layout.nodes_end + 3) & ~uint64_t{3};
  const uint64_t size = materials + (many ? (uint64_t{leaves} + 3) & ~uint64_t{3} : 0);
  if (size > UINT32_MAX) {
    return Status::kOutOfRange;
  }
  if (build != nullptr) {
    build->bytes = static_cast<size_t>(size);
  }
  if (size > out.size) {
    return Status::kOutOfMemory;
  }
  if (build != nullptr) {
    build->work_bytes = table.least_bytes();
  }

  // Chains are not needed any more: a record's first word becomes its node's place, from the lowest level up.
  uint8_t* const base = out.data;
  uint8_t* to = base + shared_front_bytes(tree.level());
  for (int level = 2; level <= tree.level(); ++level) {
    bits::store32(base + kLevelsOffset + 4 * (level - 2), static_cast<uint32_t>(to - base));
    table.for_level(level, [&](uint32_t* record) {
      record[0] = static_cast<uint32_t>(to - base);
      to = write_node(table, layout, record, to);
    });
  }
  while (to < base + materials) {
    *to++ = 0;
  }
  if (many && !tree.empty()) {
    MortonWalk again(tree);
    MaterialWriter writer{tree, to};
    if (again.begin() == Status::kOk) {
      again.run(&writer);
    }
    to = writer.to;
  }
  while (to < base + size) {
    *to++ = 0;
  }
  write_header(tree, table, layout, leaves, static_cast<size_t>(size), base);
  bits::store32(base + kChecksumOffset, checksum_around(base, static_cast<size_t>(size), kChecksumOffset));
  return shared == nullptr ? Status::kOk : open({base, static_cast<size_t>(size)}, shared);
}

}  // namespace thimble
