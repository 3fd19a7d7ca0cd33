#include "thimble/tree/octree.h"

#include "handle.h"

namespace thimble::c_face {
namespace {

bool is_material(int32_t material) {
  return material >= 0 && material <= 255;
}

}  // namespace

extern "C" size_t thimble_octree_bytes(uint32_t nodes) {
  return Octree::octree_bytes(nodes);
}

extern "C" int32_t thimble_octree_make(thimble_octree_t* octree, int32_t level, void* bytes,
                                       size_t size_bytes) {
  return make_held<Octree>(octree, bytes, size_bytes,
                           [=](Bytes pool, Octree* made) { return Octree::make(level, pool, made); });
}

extern "C" int32_t thimble_octree_clear(thimble_octree_t* octree) {
  return with<Octree>(octree, [](Octree& tree) {
    tree.clear();
    return Status::kOk;
  });
}

extern "C" int32_t thimble_octree_set_coarsen(thimble_octree_t* octree, int32_t yes) {
  return with<Octree>(octree, [=](Octree& tree) {
    tree.set_coarsen(yes != 0);
    return Status::kOk;
  });
}

extern "C" int32_t thimble_octree_insert(thimble_octree_t* octree, int32_t x, int32_t y, int32_t z,
                                         int32_t material) {
  return with<Octree>(octree, [=](Octree& tree) {
    return is_material(material) ? tree.insert({x, y, z}, static_cast<uint8_t>(material))
                                 : Status::kOutOfRange;
  });
}

extern "C" int32_t thimble_octree_insert_box(thimble_octree_t* octree, const thimble_box_t* box,
                                             int32_t material) {
  return with<Octree>(octree, [=](Octree& tree) {
    return box == nullptr ? Status::kBadArgument
           : is_material(material)
               ? tree.insert_box({vector_of(box->low), vector_of(box->high)}, static_cast<uint8_t>(material))
               : Status::kOutOfRange;
  });
}

extern "C" int32_t thimble_octree_erase(thimble_octree_t* octree, int32_t x, int32_t y, int32_t z) {
  return with<Octree>(octree, [=](Octree& tree) { return tree.remove({x, y, z}); });
}

extern "C" int32_t thimble_octree_contains(const thimble_octree_t* octree, int32_t x, int32_t y, int32_t z) {
  const Octree* const tree = held<Octree>(octree);
  return tree != nullptr && tree->test({x, y, z}) ? 1 : 0;
}

extern "C" int32_t thimble_octree_material(const thimble_octree_t* octree, int32_t x, int32_t y, int32_t z) {
  const Octree* const tree = held<Octree>(octree);
  return tree == nullptr ? -1 : tree->material({x, y, z});
}

extern "C" int32_t thimble_octree_get_info(const thimble_octree_t* octree, thimble_octree_info_t* info) {
  return tell<Octree>(octree, info, [=](const Octree& tree) {
    info->voxels = tree.voxels();
    info->solid_added = tree.solid_added();
    info->bounds = to_c(tree.bounds());
    info->level = tree.level();
    info->nodes = tree.nodes_used();
    info->nodes_free = tree.nodes_free();
    info->nodes_high_water = tree.nodes_high_water();
  });
}

}  // namespace thimble::c_face
