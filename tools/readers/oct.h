/// What is solid in the trees that `.oct` files hold.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>

#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// The bits of at most 8 words, by lanes: there may be no instruction that counts them.
inline unsigned count_bits(Span<const std::uint64_t> words) {
  constexpr std::uint64_t kOnes = 0x0101010101010101;
  std::uint64_t bytes = 0;
  for (const std::uint64_t word : words) {
    const std::uint64_t pairs = word - (word >> 1 & 0x55 * kOnes);
    const std::uint64_t fours = (pairs & 0x33 * kOnes) + (pairs >> 2 & 0x33 * kOnes);
    bytes += (fours + (fours >> 4)) & 0x0F * kOnes;
  }
  constexpr std::uint64_t kEven = 0x00FF00FF00FF00FF;
  return static_cast<unsigned>(((bytes & kEven) + (bytes >> 8 & kEven)) * 0x0001000100010001 >> 48);
}

/// Which palette entries occur in what was built.
struct UsedMaterials {
  bool is[256] = {};
  friend bool operator==(const UsedMaterials&, const UsedMaterials&) = default;
};

/// Of a tree, block by block.
UsedMaterials used_materials(const CompactTree& tree);

/// A solid block of one material: its lowest corner, the log2 of its side (0 for a voxel), its material.
using VisitBlock = std::function<void(const Vec3i& corner, int level, std::uint8_t material)>;

/// The lowest corner of what has that number in a sound tree whose nodes are in order: a node, or, on from `node_count()`,
/// a voxel.
Vec3i corner_of(const CompactTree& tree, std::uint32_t number);

/// Visits everything solid of a sound tree, in Morton order: visit(corner, level, material).
template <class Visit>
void walk_blocks(const CompactTree& tree, const Visit& visit) {
  if (tree.empty()) {
    return;
  }
  struct Frame {
    std::uint32_t left = 0;  // the children that are not yet visited
    Vec3i corner;
  };
  std::array<Frame, kMaxLevel + 1> stack{};
  // Nodes of a level stand in the order of this walk: each one's children come right after the last one's.
  constexpr std::uint32_t kUnknown = UINT32_MAX;
  std::array<std::uint32_t, kMaxLevel + 1> next{};
  next.fill(kUnknown);
  next[static_cast<std::size_t>(tree.level())] = 0;
  const bool many_materials = tree.many_materials();
  const std::uint8_t only_material = tree.uniform_material();
  const auto child_corner = [](Frame* frame, int child_level) {
    const auto octant = static_cast<unsigned>(std::countr_zero(frame->left));
    frame->left &= frame->left - 1;
    const auto along = [&](unsigned axis) {
      return static_cast<std::int32_t>(octant >> axis & 1U) << child_level;
    };
    return Vec3i{frame->corner.x + along(0), frame->corner.y + along(1), frame->corner.z + along(2)};
  };
  Frame world{1, {}};
  for (int level = tree.level();;) {  // of the frame's children
    Frame& frame = level == tree.level() ? world : stack[static_cast<std::size_t>(level) + 1];
    if (frame.left == 0) {
      if (level == tree.level()) {
        return;
      }
      ++level;
      continue;
    }
    const Vec3i corner = child_corner(&frame, level);
    const std::uint32_t node = next[static_cast<std::size_t>(level)]++;
    const std::uint32_t mask = tree.mask(node);
    if (mask == 0) {
      visit(corner, level, many_materials ? tree.block_material(node) : only_material);
      continue;
    }
    std::uint32_t& child = next[static_cast<std::size_t>(level - 1)];
    child = child == kUnknown ? tree.first_child(node) : child;
    Frame inner{mask, corner};
    if (level > 1) {
      stack[static_cast<std::size_t>(level)] = inner;
      --level;
      continue;
    }
    for (; inner.left != 0; ++child) {
      visit(child_corner(&inner, 0), 0, many_materials ? tree.voxel_material(child) : only_material);
    }
  }
}

}  // namespace thimble::tools
