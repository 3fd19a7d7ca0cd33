/// The golden scenes as compact trees in flash, so that every golden frame can be drawn on a board whose RAM
/// would never hold the octree that the scene is built in. golden_trees.bin is written by
/// `thimble_golden_tests --trees`, and the build makes numbers of it; a case builds each scene anew where there
/// is room and compares the bytes.
#pragma once

#include "golden/scenes.h"
#include "thimble/base/memory.h"

namespace thimble::portable {

ConstBytes golden_tree(golden::SceneId id);

}  // namespace thimble::portable
