// What a tree says of itself. Internal to src/c.
#pragma once

#include "kinds.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::c_face {

void tell_tree(const CompactTree& tree, thimble_tree_info_t* to);

}  // namespace thimble::c_face
