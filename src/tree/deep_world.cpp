// Edits of worlds of level 9 and 10, in which nothing moves but the children of one node and the voxels of one brick.
#include "deep_world.h"

#include "../base/bits.h"
#include "brick_parts.h"
#include "compact_header.h"

namespace thimble {
namespace {

using brick_parts::kOriginBytes;
using brick_parts::up8;
using deep_place::kPageEntries;
using deep_place::kPageLevel;

constexpr uint32_t kPlaces = 8;   // of a group
constexpr uint32_t kVoxels = 64;  // of a brick
constexpr uint32_t kMaterials = 256;
constexpr uint32_t kNobody = UINT32_MAX;  // in the counts of a place that is free
// The first group is the root's, and has more places than it needs: this one is free, so its mask is 0.
constexpr uint32_t kSolidPlace = 1;
// What follows the header: the first of the free groups above level 1 and of the free pages (0: none), and how many.
constexpr uint32_t kNodeChain = 0;
constexpr uint32_t kNodesLeft = 4;
constexpr uint32_t kPageChain = 8;
constexpr uint32_t kPagesLeft = 12;
constexpr uint32_t kStateBytes = 16;
// Page 0 is empty, the next are solid of a material each, and others have 64 bricks of their own.
constexpr uint32_t kFirstPage = 1 + kSolidBrickKinds;

uint32_t load(const uint8_t* words, uint32_t at) {
  return bits::load32(words + 4 * size_t{at});
}
void store(uint8_t* words, uint32_t at, uint32_t value) {
  bits::store32(words + 4 * size_t{at}, value);
}
uint32_t upper_places(const EditRoom& room) {
  return (room.nodes + kPlaces - 1) & ~(kPlaces - 1);
}
// In a row of bytes, `inserted` of `value` take the place of `removed`.
void change_row(uint8_t* row, uint32_t size, uint32_t at, uint32_t removed, uint32_t inserted,
                uint8_t value) {
  const uint32_t most = removed > inserted ? removed : inserted;
  __builtin_memmove(row + at + inserted, row + at + removed, size - at - most);
  for (uint32_t i = 0; i < inserted; ++i) {
    row[at + i] = value;
  }
}
size_t table_bytes(int level) {
  const size_t last = (size_t{1} << (level - kPageLevel)) - 1;
  return up8(4 * (last * (1 + 64 + 4096) + 1));
}

}  // namespace

uint32_t DeepWorld::places(const EditedWorld& world) {
  return upper_places(world.room_) + kPlaces * world.room_.bricks;
}
uint8_t* DeepWorld::state(const EditedWorld& world) {
  return world.header_ + kCompactHeaderBytes;
}

// ---- groups

uint32_t DeepWorld::take_group(EditedWorld* world, int level) {
  uint32_t group = world->free_brick_;
  if (level == 1) {
    world->free_brick_ = load(world->block_ranks_, group);
    --world->free_bricks_;
  } else {
    uint8_t* const own = state(*world);
    group = bits::load32(own + kNodeChain);
    bits::store32(own + kNodeChain, load(world->block_ranks_, group));
    bits::store32(own + kNodesLeft, bits::load32(own + kNodesLeft) - kPlaces);
  }
  return group;
}

void DeepWorld::free_group(EditedWorld* world, uint32_t group, int level) {
  for (uint32_t i = 0; i < kPlaces; ++i) {
    world->masks_[group + i] = 0;
    store(world->ranks_, group + i, kNobody);
  }
  if (level == 1) {
    store(world->block_ranks_, group, world->free_brick_);
    world->free_brick_ = group;
    ++world->free_bricks_;
  } else {
    uint8_t* const own = state(*world);
    store(world->block_ranks_, group, bits::load32(own + kNodeChain));
    bits::store32(own + kNodeChain, group);
    bits::store32(own + kNodesLeft, bits::load32(own + kNodesLeft) + kPlaces);
  }
}

// The first `count` places of a group of `level` are solid blocks of one material.
void DeepWorld::fill_group(EditedWorld* world, uint32_t group, uint32_t count, int level, uint8_t material) {
  for (uint32_t i = 0; i < count; ++i) {
    world->masks_[group + i] = 0;
    store(world->ranks_, group + i, 0);
    store(world->block_ranks_, group + i, material);
  }
  if (level == 1) {
    count_group(world, group);
    change_blocks(world, group, 0, count, material);
  }
}

// Within a group; what is at `from` stays there, too.
void DeepWorld::move_children(EditedWorld* world, uint32_t from, uint32_t to, uint32_t count) {
  __builtin_memmove(world->masks_ + to, world->masks_ + from, count);
  __builtin_memmove(world->ranks_ + 4 * size_t{to}, world->ranks_ + 4 * size_t{from}, 4 * size_t{count});
  __builtin_memmove(world->block_ranks_ + 4 * size_t{to}, world->block_ranks_ + 4 * size_t{from},
                    4 * size_t{count});
}

// The rows of a brick, of which `node` is a place; its counts must be right.
void DeepWorld::change_blocks(EditedWorld* world, uint32_t node, uint32_t removed, uint32_t inserted,
                              uint8_t material) {
  const uint32_t first = kMaterials + (((node - upper_places(world->room_)) & ~(kPlaces - 1)));
  change_row(world->leaves_ + first, kPlaces, load(world->block_ranks_, node) - first, removed, inserted,
             material);
}
void DeepWorld::change_voxels(EditedWorld* world, uint32_t node, uint32_t at, uint32_t removed,
                              uint32_t inserted, uint8_t material) {
  const uint32_t first = (node - upper_places(world->room_)) / kPlaces * kVoxels;
  const uint32_t own = world->tree_.first_child(node) - places(*world) - first;
  change_row(world->leaves_ + world->tree_.solid_blocks_ + first, kVoxels, own + at, removed, inserted,
             material);
}

// Counts what is before each place of the group round `node`, of level 1.
void DeepWorld::count_group(EditedWorld* world, uint32_t node) {
  const uint32_t group = node & ~(kPlaces - 1);
  const uint32_t brick = (group - upper_places(world->room_)) / kPlaces;
  uint32_t voxel = places(*world) + kVoxels * brick;
  uint32_t block = kMaterials + kPlaces * brick;
  for (uint32_t at = group; at < group + kPlaces && load(world->ranks_, at) != kNobody; ++at) {
    store(world->ranks_, at, voxel - 1);
    store(world->block_ranks_, at, block);
    voxel += bits::popcount8(world->masks_[at]);
    block += world->masks_[at] == 0 ? 1U : 0U;
  }
}

// ---- steps

void DeepWorld::add_root(EditedWorld* world, uint8_t material) {
  world->tree_.node_count_ = places(*world);
  fill_group(world, 0, 1, world->level(), material);
}

void DeepWorld::open_block(EditedWorld* world, uint32_t node, int level, unsigned mask) {
  const uint8_t material = world->tree_.block_material(node);
  const uint32_t count = bits::popcount8(mask);
  if (level == 1) {
    change_blocks(world, node, 1, 0, 0);
    change_voxels(world, node, 0, 0, count, material);
  } else {
    const uint32_t group = take_group(world, level - 1);
    store(world->ranks_, node, group - 1);
    fill_group(world, group, count, level - 1, material);
  }
  world->masks_[node] = static_cast<uint8_t>(mask);
  if (level == 1) {
    count_group(world, node);
  }
}

void DeepWorld::close_node(EditedWorld* world, uint32_t node, int level) {
  const uint32_t child = world->tree_.first_child(node);
  if (level == 1) {
    const uint8_t material = world->tree_.voxel_material(child);
    change_voxels(world, node, 0, bits::popcount8(world->masks_[node]), 0, 0);
    change_blocks(world, node, 0, 1, material);
    world->masks_[node] = 0;
    count_group(world, node);
    return;
  }
  store(world->block_ranks_, node, world->tree_.block_material(child));
  free_group(world, child, level - 1);
  world->masks_[node] = 0;
}

void DeepWorld::add_child(EditedWorld* world, uint32_t node, int level, unsigned octant, uint8_t material) {
  const unsigned mask = world->masks_[node];
  const uint32_t at = bits::popcount8(mask & ((1U << octant) - 1));
  world->masks_[node] = static_cast<uint8_t>(mask | 1U << octant);
  if (level == 1) {
    change_voxels(world, node, at, 0, 1, material);
    count_group(world, node);
    return;
  }
  const uint32_t child = world->tree_.first_child(node) + at;
  move_children(world, child, child + 1, bits::popcount8(mask) - at);
  world->masks_[child] = 0;
  store(world->ranks_, child, 0);
  store(world->block_ranks_, child, material);
  if (level == 2) {
    count_group(world, child);
    change_blocks(world, child, 0, 1, material);
  }
}

void DeepWorld::remove_child(EditedWorld* world, uint32_t node, int level, unsigned octant) {
  const unsigned mask = world->masks_[node] & ~(1U << octant);
  const uint32_t at = bits::popcount8(mask & ((1U << octant) - 1));
  const uint32_t child = world->tree_.first_child(node) + at;
  if (level == 1) {
    change_voxels(world, node, at, 1, 0, 0);
  } else {
    if (level == 2) {
      change_blocks(world, child, 1, 0, 0);
    }
    const uint32_t left = bits::popcount8(mask) - at;
    move_children(world, child + 1, child, left);
    world->masks_[child + left] = 0;
    store(world->ranks_, child + left, kNobody);
  }
  world->masks_[node] = static_cast<uint8_t>(mask);
  if (level <= 2) {
    count_group(world, level == 1 ? node : child);
  }
}

// ---- room

EditRoom DeepWorld::free_room(const EditedWorld& world) {
  return {bits::load32(state(world) + kNodesLeft), 0, world.free_bricks_,
          bits::load32(state(world) + kPagesLeft)};
}

bool DeepWorld::has_room(const EditedWorld& world, const Vec3i& voxel, int level) {
  const EditRoom left = free_room(world);
  const uint32_t nodes = level > 2 ? kPlaces * static_cast<uint32_t>(level - 2) : 0;
  const bool has_page = left.pages != 0 || page_in(world, cell_of(world, voxel)) >= kFirstPage;
  return nodes <= left.nodes && (level < 2 || left.bricks != 0) && has_page;
}

// ---- the map

uint8_t* DeepWorld::cell_of(const EditedWorld& world, const Vec3i& voxel) {
  return world.cells_ + 4 * size_t{deep_place::page_of(deep_place::of_voxel(voxel))};
}
uint8_t* DeepWorld::page_at(const EditedWorld& world, uint32_t page) {
  return world.cells_ + table_bytes(world.level()) + kPageBytes * size_t{page};
}
uint32_t DeepWorld::page_in(const EditedWorld& world, const uint8_t* cell) {
  return (bits::load32(cell) - static_cast<uint32_t>(table_bytes(world.level()))) / kPageBytes;
}

// The brick round `voxel`, in a page that has bricks of its own.
void DeepWorld::update_brick(EditedWorld* world, uint8_t* page, const Vec3i& voxel) {
  const uint32_t entry = deep_place::entry_of(deep_place::of_voxel(voxel));
  const uint32_t number = bits::load32(page) + 1 + entry;
  EditedWorld::Place place{};
  page[4 + entry] = 0;
  if (!world->find(voxel, 2, &place)) {
    return;
  }
  page[4 + entry] = static_cast<uint8_t>(entry + 1);
  bits::store64(world->bricks_ + 8 * size_t{number}, brick_parts::bits_of_node(world->tree_, place.node));
  uint8_t* const origin = world->origins_ + kOriginBytes * size_t{number - kPageEntries};
  if (world->masks_[place.node] != 0) {
    brick_parts::store_origin(world->tree_, place.node, origin);
    return;
  }
  bits::store32(origin, kSolidPlace);
  bits::store32(origin + 4, 0);
  bits::store32(origin + 8, world->tree_.block_material(place.node));
}

Status DeepWorld::update_cell(EditedWorld* world, const Vec3i& voxel) {
  uint8_t* const cell = cell_of(*world, voxel);
  uint8_t* const own = state(*world);
  const uint32_t old = page_in(*world, cell);
  uint32_t page = 0;
  EditedWorld::Place place{};
  if (world->find(voxel, kPageLevel, &place)) {
    page = kFirstPage;
    if (world->masks_[place.node] == 0) {
      const uint8_t material = world->tree_.block_material(place.node);
      const uint32_t kind = world->kind_of(material);
      if (kind < kSolidBrickKinds) {
        world->kinds_[kind] = material;
        world->kind_count_ = kind < world->kind_count_ ? world->kind_count_ : kind + 1;
        page = 1 + kind;
      }
    }
  }
  bool all = false;
  if (page == kFirstPage && old < kFirstPage) {
    page = bits::load32(own + kPageChain);
    if (page == 0) {
      return Status::kOutOfMemory;
    }
    uint8_t* const taken = page_at(*world, page);
    bits::store32(own + kPageChain, bits::load32(taken + 4));
    bits::store32(own + kPagesLeft, bits::load32(own + kPagesLeft) - 1);
    all = true;
  } else if (page == kFirstPage) {
    page = old;
  } else if (old >= kFirstPage) {
    bits::store32(page_at(*world, old) + 4, bits::load32(own + kPageChain));
    bits::store32(own + kPageChain, old);
    bits::store32(own + kPagesLeft, bits::load32(own + kPagesLeft) + 1);
  }
  bits::store32(cell, static_cast<uint32_t>(table_bytes(world->level()) + kPageBytes * size_t{page}));
  if (page >= kFirstPage) {
    constexpr int32_t kWithin = (1 << kPageLevel) - 1;
    for (int32_t entry = 0; all && entry < static_cast<int32_t>(kPageEntries); ++entry) {
      update_brick(world, page_at(*world, page),
                   {(voxel.x & ~kWithin) + 4 * (entry & 3), (voxel.y & ~kWithin) + 4 * (entry >> 2 & 3),
                    (voxel.z & ~kWithin) + 4 * (entry >> 4)});
    }
    update_brick(world, page_at(*world, page), voxel);
  }
  return Status::kOk;
}

// ---- making

// Depth first; nodes of a level come in the order in which they stand, so that no directory is read that may be damaged.
void DeepWorld::copy_nodes(const CompactTree& tree, EditedWorld* world) {
  struct Level {
    uint32_t node;  // the next one's number, and that of the next solid block
    uint32_t block;
    uint32_t place;  // of the next child of the open node, and children that there are left
    uint32_t rest;
  } levels[kMaxDeepMapLevel + 1];
  uint32_t next = 0;
  uint32_t blocks = 0;
  uint32_t end = 1;
  for (int level = tree.level(); level >= 1; --level) {
    levels[level] = {next, blocks, 0, 0};
    uint32_t children = 0;
    for (; next < end; ++next) {
      children += bits::popcount8(tree.mask(next));
      blocks += tree.mask(next) == 0 ? 1U : 0U;
    }
    end += level > 1 ? children : 0;
  }
  uint32_t voxel = tree.node_count();
  uint32_t place = 0;
  for (int level = tree.level();;) {
    Level& here = levels[level];
    const uint8_t mask = tree.mask(here.node++);
    const uint8_t material = mask == 0 ? tree.material_of_block(here.block++) : uint8_t{0};
    fill_group(world, place, 1, level + 1, material);
    world->masks_[place] = mask;
    if (level == 1) {
      // Behind those of its brick that were there before.
      count_group(world, place);
      change_blocks(world, place, 0, mask == 0 ? 1 : 0, material);
      for (uint32_t i = 0; i < bits::popcount8(mask); ++i) {
        change_voxels(world, place, i, 0, 1, tree.voxel_material(voxel++));
      }
    } else if (mask != 0) {
      here.place = take_group(world, level - 1);
      here.rest = bits::popcount8(mask);
      store(world->ranks_, place, here.place - 1);
    }
    while (levels[level].rest == 0) {
      if (++level > tree.level()) {
        return;
      }
    }
    --levels[level].rest;
    place = levels[level].place++;
    --level;
  }
}

Status DeepWorld::make(const CompactTree& tree, uint8_t* bytes, EditedWorld* world) {
  const EditRoom& room = world->room_;
  const uint32_t nodes = places(*world);
  const size_t numbers = kPageEntries * (size_t{room.pages} + 1);
  const auto take = [&bytes](size_t size) {
    uint8_t* const first = bytes;
    bytes += up8(size);
    return first;
  };
  world->header_ = take(kCompactHeaderBytes + kStateBytes);
  world->masks_ = take(size_t{nodes} + 8);
  world->ranks_ = take(4 * size_t{nodes});
  world->block_ranks_ = take(4 * size_t{nodes});
  world->leaves_ = take(kMaterials + (kPlaces + kVoxels) * size_t{room.bricks});
  world->cells_ = take(table_bytes(tree.level()));
  take(kPageBytes * (kFirstPage + size_t{room.pages}));
  world->bricks_ = take(8 * numbers);
  uint8_t* const ranks = take(numbers / 4);
  world->kinds_ = take(numbers) + 1;
  world->origins_ = take(kOriginBytes * (numbers - kPageEntries));

  world->look_at_sections(tree, 0);
  CompactTree& view = world->tree_;
  view.node_count_ = tree.empty() ? 0 : nodes;
  view.solid_blocks_ = kMaterials + kPlaces * room.bricks;
  view.voxel_bits_ = kVoxels * room.bricks;
  for (uint32_t material = 0; material < kMaterials; ++material) {
    world->leaves_[material] = static_cast<uint8_t>(material);
  }
  for (uint32_t i = 0; i < kStateBytes; ++i) {
    state(*world)[i] = 0;
  }
  bits::store64(world->masks_ + nodes, 0);
  for (uint32_t group = nodes; group != 0; group -= kPlaces) {
    free_group(world, group - kPlaces, group > upper_places(room) ? 1 : 2);
  }
  take_group(world, 2);  // the first, for the root
  if (!tree.empty()) {
    copy_nodes(tree, world);
  }
  return make_map(world, ranks);
}

Status DeepWorld::make_map(EditedWorld* world, uint8_t* ranks) {
  const EditRoom& room = world->room_;
  const int level = world->level();
  const uint32_t numbers = kPageEntries * (room.pages + 1);
  BrickMap& map = world->map_;
  const int32_t side = map.box_.high.x;
  const size_t table = table_bytes(level);
  map.materials_ = world->kinds_ - 1;
  map.cells_ = static_cast<uint32_t>(table / 4);
  map.brick_count_ = numbers;
  map.mixed_count_ = map.brick_count_ - 1;
  world->tree_.size_bytes_ = map.size_bytes_;
  for (size_t cell = 0; cell < table / 4; ++cell) {
    bits::store32(world->cells_ + 4 * cell, static_cast<uint32_t>(table));
  }
  for (uint32_t number = 0; number < kPageEntries; ++number) {
    bits::store64(world->bricks_ + 8 * size_t{number}, number == 0 ? 0 : ~uint64_t{0});
  }
  // All bricks of pages are mixed, so that an origin's number follows from its brick's.
  for (uint32_t i = 0; i < numbers / 32; ++i) {
    store(ranks, 2 * i, i < 2 ? 0 : UINT32_MAX);
    store(ranks, 2 * i + 1, i < 2 ? 0 : 32 * (i - 2));
  }
  for (uint32_t page = kFirstPage + room.pages; page-- != 0;) {
    const bool is_kind = page < kFirstPage;
    uint8_t* const bytes_of = page_at(*world, page);
    for (uint32_t entry = 0; entry < kPageEntries; ++entry) {
      bytes_of[4 + entry] = page != 0 && is_kind ? 1 : 0;
    }
    bits::store32(bytes_of, page == 0 ? 0 : is_kind ? page - 1 : kPageEntries * (page - kFirstPage + 1) - 1);
    if (!is_kind) {
      bits::store32(bytes_of + 4, bits::load32(state(*world) + kPageChain));
      bits::store32(state(*world) + kPageChain, page);
    }
  }
  bits::store32(state(*world) + kPagesLeft, room.pages);
  world->write_header(0);
  world->forget_changes();
  constexpr int32_t kSide = 1 << kPageLevel;
  Status status = Status::kOk;
  for (int32_t z = 0; z < 4 * side; z += kSide) {
    for (int32_t y = 0; y < 4 * side; y += kSide) {
      for (int32_t x = 0; x < 4 * side && status == Status::kOk; x += kSide) {
        status = update_cell(world, {x, y, z});
      }
    }
  }
  return status;
}

}  // namespace thimble
