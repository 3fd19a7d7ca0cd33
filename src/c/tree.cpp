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
  return from == nullptr ? number(Status::kBadArgument)
                         : make_held<CompactTree>(tree, bytes, size_bytes, [=](Bytes out, CompactTree* made) {
                             return CompactTree::make(*from, out, made);
                           });
}

extern "C" int32_t thimble_tree_open(thimble_tree_t* tree, const void* bytes, size_t size_bytes) {
  return bytes == nullptr ? number(Status::kBadArgument)
                          : make_held<CompactTree, const uint8_t>(tree, bytes, size_bytes, CompactTree::open);
}

extern "C" int32_t thimble_tree_get_info(const thimble_tree_t* tree, thimble_tree_info_t* info) {
  return tell<CompactTree>(tree, info, [=](const CompactTree& from) { tell_tree(from, info); });
}

}  // namespace thimble::c_face
