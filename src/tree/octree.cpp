// The mutable octree: the pool, descending, inserting, removing. Nothing here recurses: a path has at most 12
// levels, so arrays of that size stand in. Coarsening is in octree_coarsen.cpp.
#include "thimble/tree/octree.h"

#include "compact_header.h"
#include "octree_parts.h"

namespace thimble {

namespace {

constexpr uint32_t kFullMask = 0xFF;

/// How many links along the chain of children `octant` is.
constexpr uint32_t links_before(uint32_t mask, uint32_t octant) {
  return count_bits(mask & ((uint32_t{1} << octant) - 1));
}

// The rank orders pieces by volume: 1..7 for that many voxels of a voxel node, kRankOfLevel0 + k for a solid
// block of 8^k (k >= 1). A merged block keeps the rank of the piece that gave it its material, so that the
// outcome does not depend on the order or the number of merges.
constexpr int kRankOfLevel0 = 7;
constexpr int kRankShift = 8;

}  // namespace

// --- bits of a node ------------------------------------------------------------------------------------

void Octree::set_mask(uint32_t index, uint32_t mask) {
  nodes_[index].link_mask = (nodes_[index].link_mask & ~kFullMask) | mask;
}

void Octree::set_link(uint32_t index, uint32_t link) {
  Node& node = nodes_[index];
  node.link_mask = (node.link_mask & kFullMask) | (link << 8);
  node.next_flags = (node.next_flags & ~kLinkHigh) | (link >> 24);
}

void Octree::set_next(uint32_t index, uint32_t next) {
  Node& node = nodes_[index];
  node.next_flags = (node.next_flags & ((uint32_t{1} << kNextShift) - 1)) | (next << kNextShift);
}

/// Makes a node a solid block (at level 0: a voxel), keeping its place among its siblings.
void Octree::make_leaf(uint32_t index, uint8_t material) {
  Node& node = nodes_[index];
  node.link_mask = uint32_t{material} << 8;
  node.next_flags &= ~(kLinkHigh | kMerged | kChain);
}

void Octree::make_merged(uint32_t index, uint8_t material, uint8_t rank) {
  make_leaf(index, material);
  set_link(index, material | (uint32_t{rank} << kRankShift));
  nodes_[index].next_flags |= kMerged;
  grow_bounds({}, level_);  // where the block lies is not known here
}

/// The rank of the piece that the material of a solid block or voxel stands for.
uint8_t Octree::leaf_rank(Node leaf, int level) {
  if (is_merged(leaf)) {
    return static_cast<uint8_t>(leaf.link_mask >> (8 + kRankShift));
  }
  return static_cast<uint8_t>(level == 0 ? 1 : kRankOfLevel0 + level);
}

// --- the pool ------------------------------------------------------------------------------------------

Status Octree::make(int level, Bytes bytes, Octree* octree) {
  if (level < kMinLevel || level > kMaxLevel) {
    return Status::kOutOfRange;
  }
  const size_t address = reinterpret_cast<size_t>(bytes.data);
  const size_t padding = (0 - address) & (sizeof(uint32_t) - 1);
  const size_t size = bytes.size < padding ? 0 : bytes.size - padding;
  const size_t count = size / kNodeBytes;
  octree->capacity_ = count < kMaxNodes ? static_cast<uint32_t>(count) : kMaxNodes;
  // Through void*: the alignment was just seen to.
  octree->nodes_ = count == 0 ? nullptr : static_cast<Node*>(static_cast<void*>(bytes.data + padding));
  octree->level_ = static_cast<uint8_t>(level);
  octree->coarsen_ = false;
  octree->clear();
  return Status::kOk;
}

void Octree::clear() {
  used_ = 0;
  fresh_ = 0;
  free_head_ = kNone;
  root_ = kNone;
  voxels_ = 0;
  solid_added_ = 0;
  bounds_ = {};
  threshold_hint_ = 0;
  path_low_ = level_;
}

/// Not inlined: there are two calls, and code for both takes flash.
[[gnu::noinline]] void Octree::grow_bounds(Vec3i corner, int block_level) {
  grow_box(&bounds_, corner, block_level, 0);
}

/// A node with nothing in it. The caller has counted: there is one.
uint32_t Octree::allocate() {
  uint32_t index = free_head_;
  if (index == kNone) {
    index = fresh_;
    ++fresh_;
  } else {
    free_head_ = next_of(nodes_[index]);
  }
  nodes_[index] = {0, kNone << kNextShift};
  ++used_;
  return index;
}

void Octree::release(uint32_t index) {
  nodes_[index] = {0, free_head_ << kNextShift};
  free_head_ = index;
  --used_;
}

/// Gives back a chain of siblings and all below them. Children go in front of what is still to be given back,
/// so no stack is needed.
void Octree::release_chain(uint32_t first) {
  while (first != kNone) {
    const Node node = nodes_[first];
    uint32_t rest = next_of(node);
    if (has_children(node)) {
      const uint32_t head = link_of(node);
      set_next(walk(head, count_bits(mask_of(node)) - 1), rest);
      rest = head;
    }
    release(first);
    first = rest;
  }
}

/// `links` links along a chain.
uint32_t Octree::walk(uint32_t index, uint32_t links) const {
  for (; links > 0; --links) {
    index = next_of(nodes_[index]);
  }
  return index;
}

/// Puts `child` into the chain of `parent` and `octant` into its mask.
void Octree::attach(uint32_t parent, uint32_t octant, uint32_t child) {
  const Node node = nodes_[parent];
  const uint32_t mask = mask_of(node);
  const uint32_t before = links_before(mask, octant);
  if (before == 0) {
    set_next(child, mask == 0 ? kNone : link_of(node));
    set_link(parent, child);
  } else {
    const uint32_t previous = walk(link_of(node), before - 1);
    set_next(child, next_of(nodes_[previous]));
    set_next(previous, child);
  }
  set_mask(parent, mask | (uint32_t{1} << octant));
  nodes_[parent].next_flags |= kChain;
}

/// Takes the child in `octant`, which has nothing below it any more, out of the chain and gives it back.
void Octree::detach(uint32_t parent, uint32_t octant) {
  const Node node = nodes_[parent];
  const uint32_t mask = mask_of(node);
  const uint32_t before = links_before(mask, octant);
  uint32_t child = link_of(node);
  if (before == 0) {
    set_link(parent, next_of(nodes_[child]));
  } else {
    const uint32_t previous = walk(child, before - 1);
    child = next_of(nodes_[previous]);
    set_next(previous, next_of(nodes_[child]));
  }
  set_mask(parent, mask & ~(uint32_t{1} << octant));
  release(child);
}

// --- descending ----------------------------------------------------------------------------------------

bool Octree::inside(Vec3i voxel) const {
  return is_in_world(voxel, level_);
}

/// The lowest level, `lowest` or above, whose node above `voxel` is in the cached path.
int Octree::cached_level(Vec3i voxel, int lowest) const {
  const uint32_t differs = static_cast<uint32_t>(voxel.x ^ cursor_.x) |
                           static_cast<uint32_t>(voxel.y ^ cursor_.y) |
                           static_cast<uint32_t>(voxel.z ^ cursor_.z);
  int level = path_low_ > lowest ? path_low_ : lowest;
  while (level < level_ && (differs >> level) != 0) {
    ++level;
  }
  return level;
}

/// The lowest node that holds `voxel`, which lies in the world, in a tree that is not empty: a solid block, a
/// node without the octant asked for, or a voxel node. Returns its level.
int Octree::descend(Vec3i voxel, uint32_t& index) const {
  int level = cached_level(voxel, 1);
  index = path_[level];
  while (level > 1) {
    const Node node = nodes_[index];
    const uint32_t mask = mask_of(node);
    const uint32_t octant = octant_of(voxel, level);
    if (((mask >> octant) & 1) == 0) {
      break;
    }
    index = walk(link_of(node), links_before(mask, octant));
    --level;
  }
  return level;
}

bool Octree::test(Vec3i voxel) const {
  return material(voxel) >= 0;
}

int Octree::material(Vec3i voxel) const {
  if (used_ == 0 || !inside(voxel)) {
    return -1;
  }
  uint32_t index = kNone;
  const int level = descend(voxel, index);
  const Node node = nodes_[index];
  const uint32_t mask = mask_of(node);
  if (mask == 0) {
    return leaf_material(node);
  }
  const uint32_t octant = octant_of(voxel, level);
  if (level > 1 || ((mask >> octant) & 1) == 0) {
    return -1;
  }
  if (!has_children(node)) {
    return leaf_material(node);
  }
  return leaf_material(nodes_[walk(link_of(node), links_before(mask, octant))]);
}

Octree::NodeView Octree::node(uint32_t index) const {
  NodeView view;
  if (index >= fresh_) {
    return view;
  }
  const Node node = nodes_[index];
  view.mask = mask_of(node);
  view.merged = is_merged(node);
  view.next = next_of(node);
  view.has_children = has_children(node);
  if (view.has_children) {
    view.first_child = link_of(node);
  } else {
    view.material = leaf_material(node);
  }
  return view;
}

uint32_t Octree::child(const NodeView& parent, int octant) const {
  if (!parent.has_children || ((parent.mask >> octant) & 1) == 0) {
    return kNone;
  }
  uint32_t index = parent.first_child;
  for (uint32_t links = links_before(parent.mask, static_cast<uint32_t>(octant)); links > 0; --links) {
    if (index >= fresh_) {
      return kNone;
    }
    index = next_of(nodes_[index]);
  }
  return index;
}

// --- inserting -----------------------------------------------------------------------------------------

Status Octree::insert_block(Vec3i corner, int block_level, uint8_t material) {
  if (block_level < 0 || block_level > level_ || !inside(corner)) {
    return Status::kOutOfRange;
  }
  const uint32_t all =
      static_cast<uint32_t>(corner.x) | static_cast<uint32_t>(corner.y) | static_cast<uint32_t>(corner.z);
  if ((all & ((uint32_t{1} << block_level) - 1)) != 0) {
    return Status::kBadArgument;
  }
  uint32_t needed = try_insert(corner, block_level, material);
  if (needed == 0) {
    grow_bounds(corner, block_level);
    return Status::kOk;
  }
  if (!coarsen_ || capacity_ == 0) {
    return Status::kOutOfMemory;
  }
  if (used_ > 1) {
    const uint32_t batch = capacity_ / 16;
    const uint32_t wanted = (needed > batch ? needed : batch) - nodes_free();
    free_nodes(wanted < used_ ? wanted : used_ - 1);
    needed = try_insert(corner, block_level, material);
  }
  // Still no room: the tree is empty or one node.
  if (needed != 0) {
    insert_merged(corner, block_level, material);
  }
  return Status::kOk;
}

/// Inserts where the pool cannot hold the result, whatever is merged: the tree is empty, or one node. What
/// comes of it is what coarsening would make of the tree with the block in it, if there were a place for
/// that.
void Octree::insert_merged(Vec3i corner, int block_level, uint8_t material) {
  if (used_ == 0) {
    // The longest path that fits, its last block merged.
    const int reached = level_ - static_cast<int>(capacity_) + 1;
    root_ = build_path(corner, level_, reached, material);
    const uint8_t rank = static_cast<uint8_t>(block_level == 0 ? 1 : kRankOfLevel0 + block_level);
    make_merged(path_[reached], material, rank);
    voxels_ = kVolume[reached];
    solid_added_ += kVolume[reached] - kVolume[block_level];
    return;
  }
  const Node root = nodes_[root_];
  const uint32_t mask = mask_of(root);
  uint8_t kept = leaf_material(root);
  if (mask == 0) {
    // A full world of another material: nothing is added, the larger piece keeps its material.
    make_merged(root_, kept, leaf_rank(root, level_));
    return;
  }
  // A world of one voxel node.
  const uint32_t bit = uint32_t{1} << octant_of(corner, 1);
  if (bit < mask && count_bits(mask) == 1) {
    kept = material;
  }
  make_merged(root_, kept, static_cast<uint8_t>(count_bits(mask)));
  voxels_ = kVolume[1];
  solid_added_ += kVolume[1] - count_bits(mask | bit);
}

/// New nodes from `from_level` down to a solid block of `block_level` (0: a voxel in a voxel node) at
/// `corner`, also as the cached path. Returns the top one.
uint32_t Octree::build_path(Vec3i corner, int from_level, int block_level, uint8_t material) {
  const uint32_t top = allocate();
  cursor_ = corner;
  path_[from_level] = top;
  int level = from_level;
  while (level > block_level && level > 1) {
    const uint32_t below = allocate();
    attach(path_[level], octant_of(corner, level), below);
    --level;
    path_[level] = below;
  }
  make_leaf(path_[level], material);
  if (block_level == 0) {
    set_mask(path_[level], uint32_t{1} << octant_of(corner, level));
  }
  path_low_ = static_cast<uint8_t>(level);
  return top;
}

/// Gives a solid block at `level` >= 2 its eight children, solid and merged as it is. Returns that in
/// `octant`.
uint32_t Octree::split(uint32_t index, int level, uint32_t octant) {
  const Node node = nodes_[index];
  const uint8_t material = leaf_material(node);
  const uint8_t rank = leaf_rank(node, level);
  const uint8_t most = static_cast<uint8_t>(kRankOfLevel0 + level - 1);
  uint32_t chosen = kNone;
  uint32_t later = kNone;
  for (uint32_t place = 8; place-- > 0;) {
    const uint32_t created = allocate();
    if (is_merged(node)) {
      make_merged(created, material, rank < most ? rank : most);
    } else {
      make_leaf(created, material);
    }
    set_next(created, later);
    later = created;
    if (place == octant) {
      chosen = created;
    }
  }
  nodes_[index].next_flags &= ~kMerged;
  nodes_[index].next_flags |= kChain;
  set_mask(index, kFullMask);
  set_link(index, later);
  return chosen;
}

/// Inserts, and returns 0; or returns the number of nodes that it takes and are not free, having changed
/// nothing.
uint32_t Octree::try_insert(Vec3i corner, int block_level, uint8_t material) {
  const int lowest = block_level == 0 ? 1 : block_level;
  if (used_ == 0) {
    const uint32_t needed = static_cast<uint32_t>(level_ - lowest + 1);
    if (needed > nodes_free()) {
      return needed;
    }
    root_ = build_path(corner, level_, block_level, material);
    voxels_ = kVolume[block_level];
    return 0;
  }
  int level = cached_level(corner, lowest);
  cursor_ = corner;
  for (;;) {
    // Here and below the cached path leads to this node.
    path_low_ = static_cast<uint8_t>(level);
    const uint32_t index = path_[level];
    const Node node = nodes_[index];
    const uint32_t mask = mask_of(node);
    if (mask == 0) {
      if (is_merged(node) || leaf_material(node) == material) {
        return 0;
      }
      if (level == block_level) {
        make_leaf(index, material);
        collapse_above(level);
        return 0;
      }
      // Another material inside a solid block: 8 nodes for each level down to the block or voxel.
      const uint32_t needed = static_cast<uint32_t>(8 * (level - block_level));
      if (needed > nodes_free()) {
        return needed;
      }
      while (level > lowest) {
        const uint32_t inner = split(path_[level], level, octant_of(corner, level));
        --level;
        path_[level] = inner;
      }
      path_low_ = static_cast<uint8_t>(level);
      if (block_level > 0) {
        make_leaf(path_[level], material);
        return 0;
      }
      set_mask(path_[level], kFullMask);
      return try_insert_voxel(path_[level], octant_of(corner, level), material);
    }
    if (level == block_level) {
      voxels_ += kVolume[level] - solid_volume(index, level);
      if (has_children(node)) {
        release_chain(link_of(node));
      }
      make_leaf(index, material);
      collapse_above(level);
      return 0;
    }
    const uint32_t octant = octant_of(corner, level);
    if (level == 1) {
      return try_insert_voxel(index, octant, material);
    }
    if (((mask >> octant) & 1) == 0) {
      const uint32_t needed = static_cast<uint32_t>(level - lowest);
      if (level - 1 == block_level && (mask | (uint32_t{1} << octant)) == kFullMask &&
          uniform_children(node, material)) {
        // The block completes its parent, which takes no node at all.
        release_chain(link_of(node));
        make_leaf(index, material);
        voxels_ += kVolume[block_level];
        collapse_above(level);
        return 0;
      }
      if (needed > nodes_free()) {
        return needed;
      }
      attach(index, octant, build_path(corner, level - 1, block_level, material));
      voxels_ += kVolume[block_level];
      return 0;
    }
    --level;
    path_[level] = walk(link_of(node), links_before(mask, octant));
  }
}

/// The voxel `octant` of the voxel node `index`, which is not solid through. As `try_insert`.
uint32_t Octree::try_insert_voxel(uint32_t index, uint32_t octant, uint8_t material) {
  const Node node = nodes_[index];
  const uint32_t mask = mask_of(node);
  const uint32_t bit = uint32_t{1} << octant;
  const bool present = (mask & bit) != 0;
  if (!has_children(node)) {
    if (leaf_material(node) == material) {
      if (!present) {
        ++voxels_;
        set_mask(index, mask | bit);
        if ((mask | bit) == kFullMask) {
          set_mask(index, 0);
          collapse_above(1);
        }
      }
      return 0;
    }
    if (mask == bit) {
      make_leaf(index, material);
      set_mask(index, mask);
      return 0;
    }
    const uint32_t needed = count_bits(mask) + (present ? 0 : 1);
    if (needed > nodes_free()) {
      return needed;
    }
    make_voxel_chain(index);
  }
  if (present) {
    make_leaf(walk(link_of(nodes_[index]), links_before(mask, octant)), material);
    drop_uniform_chain(index);
    return 0;
  }
  if (nodes_free() == 0) {
    return 1;
  }
  const uint32_t voxel = allocate();
  make_leaf(voxel, material);
  attach(index, octant, voxel);
  ++voxels_;
  return 0;
}

/// Gives each voxel of a voxel node with one material a node of its own.
void Octree::make_voxel_chain(uint32_t index) {
  const uint8_t material = leaf_material(nodes_[index]);
  uint32_t later = kNone;
  for (uint32_t left = count_bits(mask_of(nodes_[index])); left > 0; --left) {
    const uint32_t voxel = allocate();
    make_leaf(voxel, material);
    set_next(voxel, later);
    later = voxel;
  }
  set_link(index, later);
  nodes_[index].next_flags |= kChain;
}

/// A voxel node whose voxels have come to one material needs no chain; a full one is a solid block then.
void Octree::drop_uniform_chain(uint32_t index) {
  const Node node = nodes_[index];
  const uint8_t material = leaf_material(nodes_[link_of(node)]);
  if (!has_children(node) || !uniform_children(node, material)) {
    return;
  }
  const uint32_t mask = mask_of(node);
  release_chain(link_of(node));
  make_leaf(index, material);
  if (mask == kFullMask) {
    collapse_above(1);
  } else {
    set_mask(index, mask);
  }
}

/// Whether all children are solid, not merged, and of `material`.
bool Octree::uniform_children(Node node, uint8_t material) const {
  uint32_t index = link_of(node);
  for (uint32_t left = count_bits(mask_of(node)); left > 0; --left) {
    const Node below = nodes_[index];
    if (mask_of(below) != 0 || is_merged(below) || leaf_material(below) != material) {
      return false;
    }
    index = next_of(below);
  }
  return true;
}

/// After the node at `level` of the cached path has become solid: its parents, as far as they are solid too.
void Octree::collapse_above(int level) {
  for (++level; level <= level_ && collapse(path_[level], level); ++level) {
    path_low_ = static_cast<uint8_t>(level);
  }
}

/// Makes one solid block of eight children that are all solid, of one material and alike in being merged or
/// not.
bool Octree::collapse(uint32_t index, int level) {
  const Node node = nodes_[index];
  if (mask_of(node) != kFullMask || !has_children(node)) {
    return false;
  }
  const Node first = nodes_[link_of(node)];
  const uint8_t material = leaf_material(first);
  uint8_t rank = 0;
  uint32_t below = link_of(node);
  for (int left = 8; left > 0; --left) {
    const Node other = nodes_[below];
    if (mask_of(other) != 0 || leaf_material(other) != material || is_merged(other) != is_merged(first)) {
      return false;
    }
    const uint8_t other_rank = leaf_rank(other, level - 1);
    rank = other_rank > rank ? other_rank : rank;
    below = next_of(other);
  }
  release_chain(link_of(node));
  if (is_merged(first)) {
    make_merged(index, material, rank);
  } else {
    make_leaf(index, material);
  }
  return true;
}

/// Solid voxels in the block of `index` at `top_level`.
uint64_t Octree::solid_volume(uint32_t index, int top_level) const {
  // pending[k] is the next node to visit at level k.
  uint32_t pending[kMaxLevel + 1];
  uint64_t total = 0;
  int level = top_level;
  pending[level] = index;
  for (;;) {
    const Node node = nodes_[pending[level]];
    const uint32_t mask = mask_of(node);
    if (mask != 0 && level > 1) {
      --level;
      pending[level] = link_of(node);
      continue;
    }
    total += mask == 0 ? kVolume[level] : count_bits(mask);
    // On to the next in Morton order: the top node's own siblings are not asked for.
    while (level < top_level && next_of(nodes_[pending[level]]) == kNone) {
      ++level;
    }
    if (level == top_level) {
      return total;
    }
    pending[level] = next_of(nodes_[pending[level]]);
  }
}

Status Octree::insert_all(Span<const Voxel> voxels, size_t& inserted) {
  for (inserted = 0; inserted < voxels.size; ++inserted) {
    const Status status = insert(voxels[inserted].position, voxels[inserted].material);
    if (status != Status::kOk) {
      return status;
    }
  }
  return Status::kOk;
}

Status Octree::insert_box(const VoxelBox& box, uint8_t material) {
  if (box.empty()) {
    return Status::kOk;
  }
  const Vec3i last{box.high.x - 1, box.high.y - 1, box.high.z - 1};
  if (!inside(box.low) || !inside(last)) {
    return Status::kOutOfRange;
  }
  // A walk over aligned blocks in Morton order; a block is its corner and its level, so there is no stack.
  Vec3i corner;
  int level = level_;
  for (;;) {
    const int32_t side = int32_t{1} << level;
    bool apart = false;
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t low = corner[axis];
      const int32_t high = low + side;
      apart = apart || low >= box.high[axis] || high <= box.low[axis];
      within = within && low >= box.low[axis] && high <= box.high[axis];
    }
    if (!apart && !within) {
      --level;
      continue;
    }
    if (within) {
      const Status status = insert_block(corner, level, material);
      if (status != Status::kOk) {
        return status;
      }
    }
    // The next block: the sibling, or that of the first parent that has one left.
    while (level < level_ && octant_of(corner, level + 1) == 7) {
      move_to_octant(0, level, &corner);
      ++level;
    }
    if (level == level_) {
      return Status::kOk;
    }
    move_to_octant(octant_of(corner, level + 1) + 1, level, &corner);
  }
}

// --- removing ------------------------------------------------------------------------------------------

Status Octree::remove(Vec3i voxel) {
  if (!inside(voxel)) {
    return Status::kOutOfRange;
  }
  if (used_ == 0) {
    return Status::kOk;
  }
  int level = cached_level(voxel, 1);
  cursor_ = voxel;
  for (;;) {
    path_low_ = static_cast<uint8_t>(level);
    const Node node = nodes_[path_[level]];
    const uint32_t mask = mask_of(node);
    const uint32_t octant = octant_of(voxel, level);
    if (mask == 0) {
      const uint32_t needed = static_cast<uint32_t>(8 * (level - 1));
      if (needed > nodes_free()) {
        return Status::kOutOfMemory;
      }
      for (; level > 1; --level) {
        path_[level - 1] = split(path_[level], level, octant_of(voxel, level));
      }
      path_low_ = 1;
      // What is left of the voxel node are single voxels, merged or not: a hit reports the same.
      const uint32_t index = path_[1];
      make_leaf(index, leaf_material(nodes_[index]));
      set_mask(index, kFullMask & ~(uint32_t{1} << octant_of(voxel, 1)));
      --voxels_;
      return Status::kOk;
    }
    if (((mask >> octant) & 1) == 0) {
      return Status::kOk;
    }
    if (level == 1) {
      break;
    }
    --level;
    path_[level] = walk(link_of(node), links_before(mask, octant));
  }
  remove_voxel(path_[1], octant_of(voxel, 1));
  return Status::kOk;
}

/// Clears the voxel `octant`, which is set, of the voxel node `index` at the end of the cached path.
void Octree::remove_voxel(uint32_t index, uint32_t octant) {
  --voxels_;
  const Node node = nodes_[index];
  if (has_children(node)) {
    // Voxels of several materials: at least one is left.
    detach(index, octant);
    drop_uniform_chain(index);
    return;
  }
  const uint32_t left = mask_of(node) & ~(uint32_t{1} << octant);
  if (left != 0) {
    set_mask(index, left);
    return;
  }
  // The node is empty, and with it every parent that holds nothing else.
  int level = 1;
  while (level < level_ && count_bits(mask_of(nodes_[path_[level + 1]])) == 1) {
    release(path_[level]);
    ++level;
  }
  if (level == level_) {
    release(root_);
    root_ = kNone;
    path_low_ = level_;
    return;
  }
  path_low_ = static_cast<uint8_t>(level + 1);
  detach(path_[level + 1], octant_of(cursor_, level + 1));
}

}  // namespace thimble
