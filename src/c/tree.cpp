#include "parts.h"

#include "thimble/tree/octree.h"

namespace thimble::c_face {

void tell_tree(const CompactTree& tree, thimble_tree_info_t* to) {
  to->voxels = tree.voxel_count();
  to->solid_added = tree.solid_added();
  to->bytes = tree.bytes();
  to->size_bytes = tree.size_bytes();
  to->bounds = to_c(tree.bounds());
  to->level = tree.level();
  to->nodes = tree.node_count();
}

extern "C" size_t thimble_tree_bytes(const thimble_octree_t* octree) {
  const Octree* const from = held<Octree>(octree);
  return from == nullptr ? 0 : compact_bytes(compact_shape(*from));
}

extern "C" int32_t thimble_tree_make(thimble_tree_t* tree, const thimble_octree_t* octree, void* bytes,
                                     size_t size_bytes) {
  const Octree* const from = held<Octree>(octree);
  Bytes out;
  if (from == nullptr || !stands(tree) || !take_bytes(bytes, size_bytes, &out)) {
    return number(Status::kBadArgument);
  }
  CompactTree made;
  return hold(CompactTree::make(*from, out, &made), made, tree);
}

extern "C" int32_t thimble_tree_open(thimble_tree_t* tree, const void* bytes, size_t size_bytes) {
  ConstBytes from;
  if (!stands(tree) || bytes == nullptr || !take_bytes(bytes, size_bytes, &from)) {
    return number(Status::kBadArgument);
  }
  CompactTree opened;
  return hold(CompactTree::open(from, &opened), opened, tree);
}

extern "C" int32_t thimble_tree_get_info(const thimble_tree_t* tree, thimble_tree_info_t* info) {
  const CompactTree* const from = held<CompactTree>(tree);
  if (from == nullptr || info == nullptr) {
    return number(Status::kBadArgument);
  }
  tell_tree(*from, info);
  return number(Status::kOk);
}

}  // namespace thimble::c_face
