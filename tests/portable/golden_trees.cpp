#include "portable/golden_trees.h"

namespace thimble::portable {
namespace {

// One behind the other, each from a multiple of four on.
alignas(4) constexpr uint8_t kTrees[] = {
#include "portable/golden_trees.inc"
};
constexpr size_t kSizeAt = 8;  // FORMAT.md: where a tree has its number of bytes

uint32_t size_of(const uint8_t* tree) {
  return tree[kSizeAt] | static_cast<uint32_t>(tree[kSizeAt + 1]) << 8 |
         static_cast<uint32_t>(tree[kSizeAt + 2]) << 16;
}

}  // namespace

ConstBytes golden_tree(golden::SceneId id) {
  const uint8_t* tree = kTrees;
  for (int i = 0; i < static_cast<int>(id); ++i) {
    tree += (size_of(tree) + 3) & ~3U;
  }
  return {tree, size_of(tree)};
}

}  // namespace thimble::portable
