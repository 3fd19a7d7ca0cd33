#include "portable/golden_trees.h"

namespace thimble::portable {
namespace {

// kTreeN is the tree of the scene whose SceneId is N.
#include "portable/golden_trees.inc"

constexpr ConstBytes kTrees[golden::kSceneCount] = {kTree0, kTree1, kTree2, kTree3, kTree4, kTree5,
                                                    kTree6, kTree7, kTree8, kTree9, kTree10};

}  // namespace

ConstBytes golden_tree(golden::SceneId id) {
  return kTrees[static_cast<int>(id)];
}

}  // namespace thimble::portable
