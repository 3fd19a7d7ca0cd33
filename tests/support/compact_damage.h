/// What must hold for any bytes whatever that are handed over as a compact tree: used by the tests and by the
/// fuzz target.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "thimble/base/memory.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tests {

/// No ray visits more nodes than this in a tree of `level`, whatever its bytes: between two lattice planes,
/// of which it crosses at most 3 * 2^level, it goes down at most `level` nodes.
constexpr std::uint32_t most_visits(int level) {
  return (3 * (std::uint32_t{1} << level) + 1) * static_cast<std::uint32_t>(level);
}

/// Traces `ray` through `tree`, which may be damaged, in every way that takes it. Returns a phrase when the
/// result breaks a promise, else nullptr. Reads outside the tree are for AddressSanitizer to see.
inline const char* trace_damaged(const CompactTree& tree, const Ray& ray) {
  const std::uint32_t limit = most_visits(tree.level());
  Hit wide;
  for (const Width width : {Width::k64, Width::k32}) {
    if (width == Width::k32 && !accepts_32(ray, tree.level())) {
      continue;
    }
    Hit hit;
    if (closest_hit(tree, ray, &hit, {UINT32_MAX, width}) != Status::kOk) {
      return "a ray within the limits is refused";
    }
    if (hit.visits > limit) {
      return "more visits than the bound";
    }
    if (hit.kind == HitKind::kHit) {
      const std::int32_t side = std::int32_t{1} << tree.level();
      for (int axis = 0; axis < 3; ++axis) {
        if (hit.voxel[axis] < 0 || hit.voxel[axis] >= side) {
          return "a voxel outside the world";
        }
      }
      if (hit.axis < -1 || hit.axis > 2 || hit.block_level > tree.level() || hit.t_denominator <= 0 ||
          hit.t_numerator < 0) {
        return "a hit that makes no sense";
      }
    }
    HitKind kind = HitKind::kStepLimit;
    if (any_hit(tree, ray, &kind, nullptr, {UINT32_MAX, width}) != Status::kOk || kind != hit.kind) {
      return "any_hit differs from closest_hit";
    }
    if (width == Width::k64) {
      wide = hit;
    } else if (hit.kind != wide.kind || hit.visits != wide.visits || hit.voxel != wide.voxel ||
               hit.axis != wide.axis || hit.t_numerator != wide.t_numerator ||
               hit.t_denominator != wide.t_denominator || hit.material != wide.material ||
               hit.block_level != wide.block_level) {
      return "the two widths differ";
    }
    if (closest_hit(tree, ray, &hit, {3, width}) != Status::kOk || hit.visits > 3) {
      return "the step limit is passed";
    }
  }
  return nullptr;
}

/// Makes the brick map of `tree`, which may be damaged, in at most 256 KiB. Returns a phrase when it is not sound, else
/// nullptr. Leaves out boxes so large that it takes long.
inline const char* map_damaged(const CompactTree& tree) {
  const VoxelBox& box = tree.bounds();
  std::int64_t volume = 1;
  for (int axis = 0; axis < 3; ++axis) {
    volume *= box.high[axis] - box.low[axis];
  }
  if (volume > std::int64_t{1} << 24) {
    return nullptr;
  }
  const std::size_t most = most_brick_map_bytes(tree);
  const std::size_t size = std::min(most, std::size_t{1} << 18);
  const std::unique_ptr<std::uint8_t[]> room(new std::uint8_t[size]);
  BrickMap map;
  std::size_t made = 0;
  const Status status = BrickMap::make(tree, {room.get(), size}, &map, &made);
  if (status == Status::kOk) {
    return BrickMap::validate({room.get(), made}) != nullptr || !map.belongs_to(tree)
               ? "a map that is not sound"
               : nullptr;
  }
  return status == Status::kOutOfMemory && size == most ? "a map takes more than it may" : nullptr;
}

/// Puts the right checksum into bytes that are at least a header long; for damage that it is not to catch.
inline void repair_checksum(Bytes bytes) {
  constexpr std::size_t kChecksumOffset = 12;
  const std::size_t size = static_cast<std::size_t>(bytes[8]) | static_cast<std::size_t>(bytes[9]) << 8 |
                           static_cast<std::size_t>(bytes[10]) << 16 |
                           static_cast<std::size_t>(bytes[11]) << 24;
  if (size < kCompactHeaderBytes || size > bytes.size) {
    return;
  }
  const std::uint32_t front = crc32({bytes.data, kChecksumOffset});
  const std::uint32_t checksum = crc32({bytes.data + kChecksumOffset + 4, size - kChecksumOffset - 4}, front);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kChecksumOffset + i] = static_cast<std::uint8_t>(checksum >> (8 * i));
  }
}

}  // namespace thimble::tests
