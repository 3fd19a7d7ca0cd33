/// The nodes of an octree counted by hand, without the core: every block is written as a text.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>

#include "reference/reference.h"
#include "thimble/trace/ray.h"

namespace thimble::tests {

/// How often each block of a level (1 and up) occurs that is neither empty nor full: "#" is a full block, "."
/// an empty one, (........) eight of them in Morton order. Worlds of one material.
using BlockTexts = std::array<std::map<std::string, int>, kMaxLevel + 1>;

/// The text of the block; `texts` is added to.
inline std::string text_of(const reference::BitGrid& grid, const reference::Voxel& corner, int level,
                           BlockTexts* texts) {
  if (level == 0) {
    return grid.test(corner) ? "#" : ".";
  }
  const int half = 1 << (level - 1);
  std::string text;
  for (int octant = 0; octant < 8; ++octant) {
    text += text_of(grid,
                    {corner[0] + ((octant & 1) != 0 ? half : 0), corner[1] + ((octant & 2) != 0 ? half : 0),
                     corner[2] + ((octant & 4) != 0 ? half : 0)},
                    level - 1, texts);
  }
  if (text == "........") {
    return ".";
  }
  if (text == "########") {
    return "#";
  }
  text = "(" + text + ")";
  ++(*texts)[static_cast<std::size_t>(level)][text];
  return text;
}

/// Blocks in the first pair of parentheses that are not empty.
inline std::size_t children_of(const std::string& text) {
  int depth = 0;
  std::size_t children = 0;
  for (const char c : text) {
    depth -= c == ')' ? 1 : 0;
    children += depth == 1 && (c == '(' || c == '#') ? 1 : 0;
    depth += c == '(' ? 1 : 0;
  }
  return children;
}
/// Of these, the full ones.
inline std::size_t full_children_of(const std::string& text) {
  int depth = 0;
  std::size_t children = 0;
  for (const char c : text) {
    depth -= c == ')' ? 1 : 0;
    children += depth == 1 && c == '#' ? 1 : 0;
    depth += c == '(' ? 1 : 0;
  }
  return children;
}

/// What trees of a world of `level` take, which is neither empty nor full.
struct CountedTrees {
  std::size_t nodes = 0;         ///< of the pool and the compact tree, solid blocks among them
  std::size_t leaves = 0;        ///< solid blocks and voxels
  std::size_t shared_nodes = 0;  ///< different blocks of level 2 and up
  std::size_t shared_bytes = 0;

  std::size_t compact_bytes() const { return 56 + (nodes + 3) / 4 * 4 + 4 * ((nodes + 63) / 64); }
};

inline CountedTrees count_trees(const reference::BitGrid& grid, int level) {
  BlockTexts texts;
  text_of(grid, {0, 0, 0}, level, &texts);
  CountedTrees counted;
  for (std::size_t each = 1; each <= kMaxLevel; ++each) {
    for (const auto& [text, times] : texts[each]) {
      const std::size_t solid = full_children_of(text);
      counted.nodes += static_cast<std::size_t>(times) * (1 + (each == 1 ? 0 : solid));
      counted.leaves += static_cast<std::size_t>(times) * solid;
    }
    counted.shared_nodes += each == 1 ? 0 : texts[each].size();
  }
  for (std::size_t link = 1; counted.shared_bytes == 0; ++link) {
    std::size_t bytes = 64 + 4 * static_cast<std::size_t>(level - 1);
    for (std::size_t each = 2; each <= kMaxLevel; ++each) {
      for (const auto& [text, times] : texts[each]) {
        bytes += 1 + children_of(text) * (each == 2 ? 1 : link);
      }
    }
    if (bytes <= std::size_t{1} << (8 * link)) {
      counted.shared_bytes = (bytes + 3) / 4 * 4;
    }
  }
  return counted;
}

}  // namespace thimble::tests
