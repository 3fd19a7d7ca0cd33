// Worlds of level 9 and 10 that are edited (README.md, "A world that changes"). Internal to src/.
#pragma once

#include "deep_map.h"
#include "thimble/tree/edited_world.h"

namespace thimble {

struct EditedWorld::Place {
  uint32_t node;
  int level;
};

// What EditedWorld does for these worlds. The children of a node have a group of eight places, those that there are at its
// front, and each place has counts of its own, as of a directory with an entry each node. So a group comes and goes
// without moving what else is there, and whatever reads compact trees reads these. Materials: a byte each number at first,
// which solid blocks above level 1 are counted by; then eight solid blocks of level 1 a brick; then 64 voxels a brick.
struct DeepWorld {
  static Status make(const CompactTree& tree, uint8_t* bytes, EditedWorld* world);
  static EditRoom free_room(const EditedWorld& world);
  // Whether there is room for a voxel in a block of `level` that is opened, solid or empty.
  static bool has_room(const EditedWorld& world, const Vec3i& voxel, int level);

  // The steps of an edit, as EditedWorld's of their names.
  static void add_root(EditedWorld* world, uint8_t material);
  static void open_block(EditedWorld* world, uint32_t node, int level, unsigned mask);
  static void close_node(EditedWorld* world, uint32_t node, int level);
  static void add_child(EditedWorld* world, uint32_t node, int level, unsigned octant, uint8_t material);
  static void remove_child(EditedWorld* world, uint32_t node, int level, unsigned octant);
  static Status update_cell(EditedWorld* world, const Vec3i& voxel);

 private:
  static uint32_t places(const EditedWorld& world);
  static uint8_t* state(const EditedWorld& world);
  static uint32_t take_group(EditedWorld* world, int level);
  static void free_group(EditedWorld* world, uint32_t group, int level);
  static void fill_group(EditedWorld* world, uint32_t group, uint32_t count, int level, uint8_t material);
  static void move_children(EditedWorld* world, uint32_t from, uint32_t to, uint32_t count);
  static void change_blocks(EditedWorld* world, uint32_t node, uint32_t removed, uint32_t inserted,
                            uint8_t material);
  static void change_voxels(EditedWorld* world, uint32_t node, uint32_t at, uint32_t removed,
                            uint32_t inserted, uint8_t material);
  static void count_group(EditedWorld* world, uint32_t node);
  static void copy_nodes(const CompactTree& tree, EditedWorld* world);
  static Status make_map(EditedWorld* world, uint8_t* ranks);
  static uint8_t* cell_of(const EditedWorld& world, const Vec3i& voxel);
  static uint32_t page_in(const EditedWorld& world, const uint8_t* cell);
  static uint8_t* page_at(const EditedWorld& world, uint32_t page);
  static void update_brick(EditedWorld* world, uint8_t* page, const Vec3i& voxel);
};

}  // namespace thimble
