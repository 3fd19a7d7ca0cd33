// A compact tree and a brick map that change in place. Both are views on sections with room behind them; an
// edit is a row of steps that each leave a sound tree: a solid block is opened into children, or children that
// are all alike close into a block, and a child comes or goes.
#include "thimble/tree/edited_world.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "brick_parts.h"
#include "compact_header.h"
#include "deep_world.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

using brick_parts::kChildBits;
using brick_parts::kOriginBytes;
using brick_parts::up8;

constexpr unsigned kAllChildren = 0xFF;
constexpr uint32_t kNodeBits = kMostEditRoom.nodes;
static_assert(kNodeBits == (uint32_t{1} << kChildBits) - 1);

// Opens or closes a gap in an array of bytes.
void move_bytes(uint8_t* array, uint32_t from, uint32_t to, uint32_t end) {
  __builtin_memmove(array + to, array + from, end - from);
}

// Adds `by` to a word of each brick's origin of which the bits of `mask` are `from` or more.
void move_origins(uint8_t* word, uint32_t bricks, uint32_t mask, uint32_t from, uint32_t by) {
  for (; bricks != 0; --bricks, word += kOriginBytes) {
    const uint32_t own = bits::load32(word);
    bits::store32(word, own + ((own & mask) >= from ? by : 0));
  }
}

// Without those of level 9 and 10 where the core has none.
size_t room_bytes(int level, const EditRoom& room) {
  if constexpr (kDeepWorlds) {
    return edited_world_bytes(level, room);
  }
  return packed_world_bytes(level, room);
}
[[gnu::always_inline]] inline bool is_deep(const CompactTree& tree) {
  return DeepMap::is_deep(tree.level());
}

// Whether the masks have children where they should: what `open` does not look at. Counts mixed bricks, and of level 9 and
// 10 what else takes room.
bool is_sound(const CompactTree& tree, uint32_t voxels, uint32_t blocks, EditRoom* room) {
  uint32_t groups = 1;
  *room = {tree.node_count(), voxels + blocks, 0, 0};
  uint32_t first = 0;
  uint32_t end = tree.empty() ? 0 : 1;
  uint32_t solid = 0;
  for (int level = tree.level(); level >= 1; --level) {
    uint32_t children = 0;
    for (uint32_t node = first; node < end; ++node) {
      const unsigned mask = tree.mask(node);
      children += bits::popcount8(mask);
      solid += mask == 0 ? 1U : 0U;
      room->bricks += level == 2 && mask != 0 ? 1U : 0U;
      if (is_deep(tree) && mask != 0) {
        groups += level > 2 ? 1U : 0U;
        room->pages += level == 4 ? 1U : 0U;
      }
    }
    if (level == 1) {
      if (is_deep(tree)) {
        room->nodes = 8 * groups;
        room->leaves = 0;
      }
      return end == tree.node_count() && children == voxels && solid == blocks;
    }
    first = end;
    end += children;
    if (end > tree.node_count()) {
      return false;
    }
  }
  return false;
}

}  // namespace

EditRoom EditedWorld::room_of(const CompactTree& tree) {
  EditRoom room;
  is_sound(tree, tree.voxel_bits_, tree.solid_blocks_, &room);
  return room;
}

size_t EditedWorld::least_bytes(const CompactTree& tree) {
  return tree.merged() ? 0 : room_bytes(tree.level(), room_of(tree));
}

EditRoom EditedWorld::room_in(const CompactTree& tree, size_t bytes) {
  // A brick that digging opens: its own 20 bytes, 9 nodes with their counts, and the leaves of half of them.
  constexpr uint32_t kNodesABrick = 9;
  constexpr uint32_t kLeavesABrick = 24;
  constexpr size_t kBytesABrick = 8 + kOriginBytes + kNodesABrick + kLeavesABrick + 2;
  constexpr size_t kRounding = 64;
  EditRoom room = room_of(tree);
  const size_t least = room_bytes(tree.level(), room);
  if (least == 0 || least > bytes) {
    return {};
  }
  if (is_deep(tree) && bytes - least > kRounding) {
    // A page that digging opens, with twelve bricks and six nodes above them.
    constexpr EditRoom kMore{48, 0, 12, 1};
    constexpr size_t kBytesAPage = 9 * size_t{kMore.nodes} + 144 * size_t{kMore.bricks} + 1428;
    const size_t most_nodes =
        (kMostEditRoom.nodes - room.nodes - 8 * room.bricks) / (kMore.nodes + 8 * kMore.bricks);
    const size_t most_pages = kMostEditRoom.pages - room.pages;
    const size_t most = most_nodes < most_pages ? most_nodes : most_pages;
    const size_t fit = (bytes - least - kRounding) / kBytesAPage;
    const auto more = static_cast<uint32_t>(fit < most ? fit : most);
    room.nodes += kMore.nodes * more;
    room.bricks += kMore.bricks * more;
    room.pages += more;
  } else if (bytes - least > kRounding) {
    size_t more = (bytes - least - kRounding) / kBytesABrick;
    more = more < kMostEditRoom.bricks - room.bricks ? more : kMostEditRoom.bricks - room.bricks;
    room.bricks += static_cast<uint32_t>(more);
    room.nodes += kNodesABrick * static_cast<uint32_t>(more);
    room.leaves += kLeavesABrick * static_cast<uint32_t>(more);
  }
  return room;
}

Status EditedWorld::make(const CompactTree& tree, const EditRoom& room, Bytes bytes, EditedWorld* world) {
  const size_t needed = room_bytes(tree.level(), room);
  if (needed == 0) {
    return Status::kOutOfRange;
  }
  if (tree.bytes() == nullptr || tree.merged() || (reinterpret_cast<size_t>(bytes.data) & 7U) != 0) {
    return Status::kBadArgument;
  }
  EditRoom used;
  if (!is_sound(tree, tree.voxel_bits_, tree.solid_blocks_, &used)) {
    return Status::kDamaged;
  }
  if (used.nodes > room.nodes || used.leaves > room.leaves || used.bricks > room.bricks ||
      used.pages > room.pages || bytes.size < needed) {
    return Status::kOutOfMemory;
  }
  EditedWorld made;
  made.room_ = room;
  if (is_deep(tree)) {
    const Status status = DeepWorld::make(tree, bytes.data, &made);
    *world = status == Status::kOk ? made : *world;
    return status;
  }
  const size_t blocks = (size_t{room.nodes} >> kDefaultRankShift) + 1;
  const uint32_t cells = uint32_t{1} << (3 * (tree.level() - 2));
  uint8_t* next = bytes.data;
  const auto take = [&next](size_t size) {
    uint8_t* const first = next;
    next += up8(size);
    return first;
  };
  made.header_ = take(kCompactHeaderBytes);
  made.masks_ = take(size_t{room.nodes} + 8);
  made.ranks_ = take(4 * blocks);
  made.block_ranks_ = take(4 * blocks);
  made.leaves_ = take(room.leaves);
  made.cells_ = take(2 * size_t{cells});
  made.bricks_ = take(8 * (1 + size_t{room.bricks} + kSolidBrickKinds));
  made.origins_ = take(kOriginBytes * size_t{room.bricks});
  made.kinds_ = next;

  for (uint32_t node = 0; node < room.nodes + 8; ++node) {
    made.masks_[node] = node < used.nodes ? tree.mask(node) : uint8_t{0};
  }
  for (uint32_t leaf = 0; leaf < used.leaves; ++leaf) {
    made.leaves_[leaf] = tree.materials_ == nullptr ? tree.uniform_material_ : tree.materials_[leaf];
  }
  for (size_t i = 0; i < 2 * size_t{cells}; ++i) {
    made.cells_[i] = 0;
  }
  made.look_at_sections(tree, kDefaultRankShift);
  made.count_from(0);
  BrickMap& map = made.map_;
  map.materials_ = made.kinds_;
  map.cells_ = cells;
  map.mixed_count_ = room.bricks;
  map.brick_count_ = 1 + room.bricks + kSolidBrickKinds;
  bits::store64(made.bricks_, 0);
  for (uint32_t number = room.bricks; number != 0; --number) {
    bits::store16(made.bricks_ + 8 * size_t{number}, made.free_brick_);
    made.free_brick_ = number;
  }
  made.free_bricks_ = room.bricks;
  for (uint32_t kind = 0; kind < kSolidBrickKinds; ++kind) {
    bits::store64(made.bricks_ + 8 * (1 + size_t{room.bricks} + kind), ~uint64_t{0});
  }
  made.write_header(0);
  made.forget_changes();
  const int32_t side = map.box_.high.x;
  const int bits_a_side = tree.level() - 2;
  for (int32_t cell = 0; cell < static_cast<int32_t>(cells); ++cell) {
    const Status status = made.update_cell(
        {4 * (cell & (side - 1)), 4 * (cell >> bits_a_side & (side - 1)), 4 * (cell >> 2 * bits_a_side)});
    if (status != Status::kOk) {
      return status;
    }
  }
  *world = made;
  return Status::kOk;
}

// The views are on the sections, which are laid out, and the header is the tree's.
void EditedWorld::look_at_sections(const CompactTree& tree, int rank_shift) {
  for (size_t i = 0; i < kCompactHeaderBytes; ++i) {
    header_[i] = tree.base_[i];
  }
  tree_ = tree;
  tree_.base_ = header_;
  tree_.masks_ = masks_;
  tree_.ranks_ = ranks_;
  tree_.block_ranks_ = block_ranks_;
  tree_.materials_ = leaves_;
  tree_.rank_shift_ = static_cast<uint8_t>(rank_shift);
  const int32_t side = int32_t{1} << (tree.level() - 2);
  map_.directory_ = cells_;
  map_.bricks_ = bricks_;
  map_.origins_ = origins_;
  map_.box_ = {{0, 0, 0}, {side, side, side}};
  map_.size_bytes_ = edited_world_bytes(tree.level(), room_);
  map_.level_ = static_cast<uint8_t>(tree.level());
}

EditRoom EditedWorld::free_room() const {
  if (is_deep(tree_)) {
    return DeepWorld::free_room(*this);
  }
  return {room_.nodes - tree_.node_count_, room_.leaves - tree_.solid_blocks_ - tree_.voxel_bits_,
          free_bricks_, 0};
}

// ---- looking

uint32_t EditedWorld::child_of(uint32_t node, unsigned octant) const {
  return tree_.first_child(node) + bits::popcount8(masks_[node] & ((1U << octant) - 1));
}

// Goes down to `to_level` or to the solid block above it; false, and the node that lacks the child, where
// nothing is.
bool EditedWorld::find(const Vec3i& voxel, int to_level, Place* place) const {
  *place = {0, tree_.level()};
  if (tree_.empty()) {
    return false;
  }
  while (place->level > to_level && masks_[place->node] != 0) {
    const unsigned octant = octant_of(voxel, place->level);
    if ((unsigned{masks_[place->node]} >> octant & 1U) == 0) {
      return false;
    }
    place->node = child_of(place->node, octant);
    --place->level;
  }
  return true;
}

int EditedWorld::material_within(const Vec3i& voxel) const {
  Place place{};
  if (!find(voxel, 1, &place)) {
    return kEmpty;
  }
  const unsigned mask = masks_[place.node];
  const unsigned octant = octant_of(voxel, 1);
  return mask == 0                    ? tree_.block_material(place.node)
         : (mask >> octant & 1U) == 0 ? kEmpty
                                      : tree_.voxel_material(child_of(place.node, octant));
}

// Whether there is room for `voxel` to become `material` (-1: empty), and whether anything changes.
Status EditedWorld::check_room(const Vec3i& voxel, int material, bool* changes) const {
  *changes = false;
  if (tree_.bytes() == nullptr || !is_in_world(voxel, tree_.level())) {
    return Status::kOutOfRange;
  }
  Place place{};
  uint32_t nodes = 0;
  uint32_t leaves = 0;
  const bool found = find(voxel, 1, &place);
  const auto level = static_cast<uint32_t>(place.level);
  if (!found) {
    if (material < 0) {
      return Status::kOk;
    }
    nodes = tree_.empty() ? level : level - 1;
    leaves = 1;
  } else if (masks_[place.node] == 0) {
    if (material == tree_.block_material(place.node)) {
      return Status::kOk;
    }
    nodes = 8 * (level - 1);
    leaves = 7 * level;
  } else {
    const unsigned octant = octant_of(voxel, 1);
    const bool is_solid = (unsigned{masks_[place.node]} >> octant & 1U) != 0;
    if (is_solid ? material == tree_.voxel_material(child_of(place.node, octant)) : material < 0) {
      return Status::kOk;
    }
    leaves = material >= 0 && !is_solid ? 1 : 0;
  }
  *changes = true;
  if (is_deep(tree_)) {
    const int opened = !found                    ? place.level - (tree_.empty() ? 0 : 1)
                       : masks_[place.node] == 0 ? place.level
                                                 : 0;
    return DeepWorld::has_room(*this, voxel, opened) ? Status::kOk : Status::kOutOfMemory;
  }
  const EditRoom left = free_room();
  const uint32_t number = bits::load16(cell_of(voxel));
  const bool wants_brick = number == 0 || number > room_.bricks;
  bool wants_kind = false;
  if (material >= 0 && !wants_brick && kind_of(static_cast<uint8_t>(material)) == kSolidBrickKinds) {
    const unsigned bit = (static_cast<unsigned>(voxel.x) & 3U) | (static_cast<unsigned>(voxel.y) & 3U) << 2 |
                         (static_cast<unsigned>(voxel.z) & 3U) << 4;
    wants_kind = (bits::load64(bricks_ + 8 * size_t{number}) | uint64_t{1} << bit) == ~uint64_t{0};
  }
  const bool fits = nodes <= left.nodes && leaves <= left.leaves && (!wants_brick || left.bricks != 0);
  return fits && !wants_kind ? Status::kOk : Status::kOutOfMemory;
}

bool EditedWorld::is_uniform(uint32_t node, int level, uint8_t material) const {
  if (masks_[node] != kAllChildren) {
    return false;
  }
  const uint32_t child = tree_.first_child(node);
  for (uint32_t i = 0; i < 8; ++i) {
    const bool same = level == 1 ? tree_.voxel_material(child + i) == material
                                 : masks_[child + i] == 0 && tree_.block_material(child + i) == material;
    if (!same) {
      return false;
    }
  }
  return true;
}

// ---- steps

void EditedWorld::insert_nodes(uint32_t at, uint32_t count) {
  move_bytes(masks_, at, at + count, tree_.node_count_);
  for (uint32_t i = 0; i < count; ++i) {
    masks_[at + i] = 0;
  }
  tree_.node_count_ += count;
  move_origins(origins_, room_.bricks, kNodeBits, at, count);
}

void EditedWorld::remove_nodes(uint32_t at, uint32_t count) {
  move_bytes(masks_, at + count, at, tree_.node_count_);
  tree_.node_count_ -= count;
  move_origins(origins_, room_.bricks, kNodeBits, at + count, 0 - count);
}

// In the row of leaves, blocks then voxels, `inserted` of `material` take the place of `removed`.
void EditedWorld::move_leaves(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material) {
  move_bytes(leaves_, at + removed, at + inserted, tree_.solid_blocks_ + tree_.voxel_bits_);
  for (uint32_t i = 0; i < inserted; ++i) {
    leaves_[at + i] = material;
  }
}

void EditedWorld::change_blocks(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material) {
  move_leaves(at, removed, inserted, material);
  tree_.solid_blocks_ += inserted - removed;
  move_origins(origins_ + 8, room_.bricks, UINT32_MAX, at + removed, inserted - removed);
}

void EditedWorld::change_voxels(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material) {
  move_leaves(tree_.solid_blocks_ + at, removed, inserted, material);
  tree_.voxel_bits_ += inserted - removed;
  move_origins(origins_ + 4, room_.bricks, UINT32_MAX, at + removed, inserted - removed);
}

// The directory of counts, from the entry of `node` on.
void EditedWorld::count_from(uint32_t node) {
  constexpr uint32_t kCounted = uint32_t{1} << kDefaultRankShift;
  uint32_t block = node >> kDefaultRankShift;
  uint32_t children = block == 0 ? 0 : bits::load32(ranks_ + 4 * size_t{block});
  uint32_t blocks = block == 0 ? 0 : bits::load32(block_ranks_ + 4 * size_t{block});
  for (uint32_t at = block * kCounted;; at += kCounted, ++block) {
    bits::store32(ranks_ + 4 * size_t{block}, children);
    bits::store32(block_ranks_ + 4 * size_t{block}, blocks);
    if (at + kCounted >= tree_.node_count_) {
      return;
    }
    for (uint32_t i = at; i < at + kCounted; i += 4) {
      const uint32_t word = bits::load32(masks_ + i);
      children += bits::popcount32(word);
      // A byte's lowest bit, where any of its bits is set.
      uint32_t any = word | word >> 4;
      any |= any >> 2;
      any |= any >> 1;
      blocks += 4 - bits::popcount32(any & 0x01010101U);
    }
  }
}

void EditedWorld::add_root(uint8_t material) {
  if (is_deep(tree_)) {
    return DeepWorld::add_root(this, material);
  }
  insert_nodes(0, 1);
  count_from(0);
  change_blocks(0, 0, 1, material);
}

// The solid block that is all of the world goes.
void EditedWorld::remove_root() {
  tree_.bounds_ = {};
  if (is_deep(tree_)) {
    tree_.node_count_ = 0;
    return;
  }
  change_blocks(0, 1, 0, 0);
  remove_nodes(0, 1);
  count_from(0);
}

// The solid block `node` gets children of its material, those of `mask`.
void EditedWorld::open_block(uint32_t node, int level, unsigned mask) {
  if (is_deep(tree_)) {
    return DeepWorld::open_block(this, node, level, mask);
  }
  const uint32_t own = tree_.blocks_before(node);
  const uint8_t material = leaves_[own];
  const uint32_t child = tree_.first_child(node);
  const uint32_t count = bits::popcount8(mask);
  change_blocks(own, 1, 0, 0);
  masks_[node] = static_cast<uint8_t>(mask);
  if (level == 1) {
    count_from(node);
    change_voxels(child - tree_.node_count_, 0, count, material);
    return;
  }
  insert_nodes(child, count);
  count_from(node);
  change_blocks(tree_.blocks_before(child), 0, count, material);
}

// The children of `node`, leaves of one material, become one: a solid block.
void EditedWorld::close_node(uint32_t node, int level) {
  if (is_deep(tree_)) {
    return DeepWorld::close_node(this, node, level);
  }
  const uint32_t child = tree_.first_child(node);
  const uint32_t count = bits::popcount8(masks_[node]);
  uint8_t material = 0;
  if (level == 1) {
    const uint32_t voxel = child - tree_.node_count_;
    material = leaves_[tree_.solid_blocks_ + voxel];
    change_voxels(voxel, count, 0, 0);
  } else {
    const uint32_t block = tree_.blocks_before(child);
    material = leaves_[block];
    change_blocks(block, count, 0, 0);
    remove_nodes(child, count);
  }
  masks_[node] = 0;
  count_from(node);
  change_blocks(tree_.blocks_before(node), 0, 1, material);
}

void EditedWorld::add_child(uint32_t node, int level, unsigned octant, uint8_t material) {
  if (is_deep(tree_)) {
    return DeepWorld::add_child(this, node, level, octant, material);
  }
  const uint32_t child = child_of(node, octant);
  masks_[node] = static_cast<uint8_t>(masks_[node] | 1U << octant);
  if (level == 1) {
    count_from(node);
    change_voxels(child - tree_.node_count_, 0, 1, material);
    return;
  }
  insert_nodes(child, 1);
  count_from(node);
  change_blocks(tree_.blocks_before(child), 0, 1, material);
}

// A leaf that is not its parent's only child.
void EditedWorld::remove_child(uint32_t node, int level, unsigned octant) {
  if (is_deep(tree_)) {
    return DeepWorld::remove_child(this, node, level, octant);
  }
  const uint32_t child = child_of(node, octant);
  if (level == 1) {
    change_voxels(child - tree_.node_count_, 1, 0, 0);
  } else {
    change_blocks(tree_.blocks_before(child), 1, 0, 0);
    remove_nodes(child, 1);
  }
  masks_[node] = static_cast<uint8_t>(masks_[node] & ~(1U << octant));
  count_from(node);
}

// ---- the map

uint8_t* EditedWorld::cell_of(const Vec3i& voxel) const {
  const int32_t side = map_.box_.high.x;
  return cells_ + 2 * static_cast<size_t>(((voxel.z >> 2) * side + (voxel.y >> 2)) * side + (voxel.x >> 2));
}

// Which of the kinds of solid bricks has `material`; kSolidBrickKinds where none has and all are taken.
uint32_t EditedWorld::kind_of(uint8_t material) const {
  uint32_t kind = 0;
  while (kind < kind_count_ && kinds_[kind] != material) {
    ++kind;
  }
  return kind;
}

// The brick round `voxel` becomes what the tree has there. Fails only where check_room was not asked.
Status EditedWorld::update_cell(const Vec3i& voxel) {
  if (is_deep(tree_)) {
    return DeepWorld::update_cell(this, voxel);
  }
  uint8_t* const cell = cell_of(voxel);
  const uint32_t old = bits::load16(cell);
  uint32_t number = 0;
  Place place{};
  if (find(voxel, 2, &place)) {
    if (masks_[place.node] == 0) {
      const uint8_t material = tree_.block_material(place.node);
      const uint32_t kind = kind_of(material);
      if (kind == kSolidBrickKinds) {
        return Status::kOutOfMemory;
      }
      kinds_[kind] = material;
      kind_count_ = kind < kind_count_ ? kind_count_ : kind + 1;
      number = 1 + room_.bricks + kind;
    } else {
      number = old != 0 && old <= room_.bricks ? old : free_brick_;
      if (number == 0) {
        return Status::kOutOfMemory;
      }
      uint8_t* const brick = bricks_ + 8 * size_t{number};
      if (number != old) {
        free_brick_ = bits::load16(brick);
        --free_bricks_;
      }
      bits::store64(brick, brick_parts::bits_of_node(tree_, place.node));
      brick_parts::store_origin(tree_, place.node, origins_ + kOriginBytes * size_t{number - 1});
    }
  }
  if (number != old && old != 0 && old <= room_.bricks) {
    bits::store16(bricks_ + 8 * size_t{old}, free_brick_);
    free_brick_ = old;
    ++free_bricks_;
  }
  bits::store16(cell, number);
  return Status::kOk;
}

// Header and map agree on a stamp that no view of before has.
void EditedWorld::write_header(int64_t voxels) {
  using namespace compact_header;
  const uint32_t stamp = bits::load32(header_ + kChecksumOffset) + 1;
  bits::store32(header_ + kChecksumOffset, stamp);
  map_.tree_checksum_ = stamp;
  bits::store64(header_ + kVoxelCountOffset, tree_.voxel_count() + static_cast<uint64_t>(voxels));
  if (!is_deep(tree_)) {
    CompactShape shape;
    shape.level = tree_.level();
    shape.nodes = tree_.node_count_;
    shape.solid_blocks = tree_.solid_blocks_;
    shape.voxel_bits = tree_.voxel_bits_;
    shape.many_materials = true;
    tree_.size_bytes_ = compact_bytes(shape);
  }
}

Status EditedWorld::note_change(const Vec3i& voxel, int64_t voxels) {
  VoxelBox* const boxes[2] = {&changed_, &tree_.bounds_};
  for (int i = 0; i < (voxels < 0 ? 1 : 2); ++i) {
    grow_box(boxes[i], voxel, 0, 0);
  }
  write_header(voxels);
  return update_cell(voxel);
}

// ---- edits

Status EditedWorld::set(const Vec3i& voxel, uint8_t material) {
  bool changes = false;
  const Status status = check_room(voxel, material, &changes);
  if (status != Status::kOk || !changes) {
    return status;
  }
  uint32_t path[kMostMapLevel + 1] = {};
  bool is_new = tree_.empty();  // of what lies above, nothing was solid here
  if (is_new) {
    add_root(material);
  }
  uint32_t node = 0;
  for (int level = tree_.level();; --level) {
    path[level] = node;
    const unsigned octant = octant_of(voxel, level);
    if (masks_[node] == 0) {
      open_block(node, level, is_new ? 1U << octant : kAllChildren);
    } else if ((unsigned{masks_[node]} >> octant & 1U) == 0) {
      add_child(node, level, octant, material);
      is_new = true;
    }
    node = child_of(node, octant);
    if (level == 1) {
      break;
    }
  }
  leaves_[tree_.solid_blocks_ + node - tree_.node_count_] = material;
  for (int level = 1; level <= tree_.level() && is_uniform(path[level], level, material); ++level) {
    close_node(path[level], level);
  }
  return note_change(voxel, is_new ? 1 : 0);
}

Status EditedWorld::clear(const Vec3i& voxel) {
  bool changes = false;
  const Status status = check_room(voxel, -1, &changes);
  if (status != Status::kOk || !changes) {
    return status;
  }
  uint32_t path[kMostMapLevel + 1] = {};
  uint32_t node = 0;
  for (int level = tree_.level(); level >= 1; --level) {
    path[level] = node;
    if (masks_[node] == 0) {
      open_block(node, level, kAllChildren);
    }
    node = level == 1 ? node : child_of(node, octant_of(voxel, level));
  }
  // Up from the voxel, what would be left without children goes, too.
  int level = 1;
  while (level <= tree_.level() && bits::popcount8(masks_[path[level]]) == 1) {
    close_node(path[level], level);
    ++level;
  }
  if (level <= tree_.level()) {
    remove_child(path[level], level, octant_of(voxel, level));
  } else {
    remove_root();
  }
  return note_change(voxel, -1);
}

Status EditedWorld::pack(Bytes out, size_t* size) const {
  return CompactTree::make(Span<const CompactTree>(&tree_, 1), out, nullptr, size);
}

}  // namespace thimble
