/// One set of voxels in every structure that the core traces, and in the reference's grid; and the comparison
/// of an engine's answer with the reference's.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "reference/reference.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tests {

/// Bytes on the heap of exactly that size, so that AddressSanitizer sees the first byte beyond; `offset`
/// moves the start off its alignment.
class HeapBytes {
 public:
  explicit HeapBytes(std::size_t size = 0, std::size_t offset = 0)
      : storage_(new std::uint8_t[size + offset]), offset_(offset), size_(size) {}
  explicit HeapBytes(ConstBytes from) : HeapBytes(from.size) {
    std::copy(from.begin(), from.end(), storage_.get());
  }
  Bytes span() const { return {storage_.get() + offset_, size_}; }
  ConstBytes view() const { return {storage_.get() + offset_, size_}; }
  bool operator==(const HeapBytes& other) const {
    return std::equal(view().begin(), view().end(), other.view().begin(), other.view().end());
  }

 private:
  std::unique_ptr<std::uint8_t[]> storage_;
  std::size_t offset_;
  std::size_t size_;
};

/// A pool in words of its own.
struct OwnedPool {
  explicit OwnedPool(int level, std::size_t nodes = 40000);
  OwnedPool(const OwnedPool&) = delete;
  OwnedPool& operator=(const OwnedPool&) = delete;
  std::vector<std::uint32_t> words;
  Octree octree;
};

/// Which material a voxel of a test scene has: a hash of its place with as many values as `materials`.
std::uint8_t material_at(const reference::Voxel& voxel, unsigned materials, std::uint64_t salt);

reference::Ray to_reference(const Ray& ray);
Ray to_core(const reference::Ray& ray);
/// The first `count` hard rays (ray_cases.h) in a world of 2^level voxels that `check_ray` takes.
std::vector<Ray> accepted_rays(std::uint64_t seed, int level, int count);

/// The compact tree's bytes of an octree; exactly as many as `compact_bytes` says.
HeapBytes compact_of(const Octree& octree, int rank_shift = kDefaultRankShift, std::size_t offset = 0);
/// The same from the voxels' Morton keys, sorted by the core. 32-bit keys want one material.
HeapBytes compact_of_keys_32(const std::vector<reference::Voxel>& voxels, int level, std::uint8_t material,
                             int rank_shift = kDefaultRankShift);
HeapBytes compact_of_keys_64(const std::vector<reference::Voxel>& voxels, int level, unsigned materials,
                             std::uint64_t salt, int rank_shift = kDefaultRankShift);

/// The bytes of the tree's brick map, and of the shared tree of the same voxels; exactly as many as they take,
/// none where a level has no map.
HeapBytes map_of(const CompactTree& tree);
HeapBytes shared_of(const CompactTree& tree);

/// The bytes of an edited world's tree.
HeapBytes packed(const EditedWorld& world);

/// Opens bytes that must be a compact tree; throws `std::logic_error` when they are none.
CompactTree open_or_throw(const HeapBytes& bytes);

/// A tree's brick map in room of its own; `status` says whether it was made.
struct OwnedMap {
  OwnedMap(const CompactTree& from, std::size_t room_bytes)
      : tree(from), room(room_bytes), status(BrickMap::make(tree, room.span(), &map, &size)) {}

  CompactTree tree;
  HeapBytes room;
  BrickMap map;
  std::size_t size = 0;
  Status status;
};

/// A tree and its brick map; throws `std::logic_error` where the bytes give none.
struct MappedTree {
  explicit MappedTree(HeapBytes bytes);

  HeapBytes tree_bytes;
  CompactTree tree;
  HeapBytes map_room;
  BrickMap map;
};

/// Whether an engine's hit is the reference's: kind, voxel, t as a fraction, axis.
bool same_answer(const Hit& hit, const reference::Hit& expected);
/// The same answer of two engines of the core's: all but the visits.
bool same_hit(const Hit& one, const Hit& other);

/// "miss", "step limit" or "voxel (i, j, k) t n/d axis a block b material m".
std::string describe(const Hit& hit);

/// The voxels in all structures. The dense grid is there where it takes at most 1 MiB.
class SceneUnderTest {
 public:
  /// `size` is the grid's; the trees' world is the least cube of a power of two that holds it.
  SceneUnderTest(const reference::Voxel& size, const std::vector<reference::Voxel>& voxels,
                 unsigned materials = 1, std::uint64_t salt = 0, int rank_shift = kDefaultRankShift);
  SceneUnderTest(const SceneUnderTest&) = delete;
  SceneUnderTest& operator=(const SceneUnderTest&) = delete;

  int level() const { return level_; }
  const reference::BitGrid& reference() const { return reference_; }
  const std::vector<reference::Voxel>& voxels() const { return voxels_; }

  const Octree& pool() const { return pool_; }
  /// Made from the pool.
  const CompactTree& compact() const { return compact_; }
  /// Made from keys.
  const CompactTree& from_keys() const { return from_keys_; }
  const std::optional<DenseGrid>& dense() const { return dense_; }
  /// Whether the pool's, the 64-bit keys' and (one material, level to 10) the 32-bit keys' bytes are equal.
  bool same_bytes() const { return same_bytes_; }

  struct Tally {
    std::int64_t traced = 0;      ///< answers compared
    std::int64_t narrow = 0;      ///< rays that the 32-bit path takes
    std::int64_t mismatches = 0;  ///< answers that differ
    std::string first;            ///< what the first ones were
    Tally& operator+=(const Tally& other);
  };
  /// Traces `ray` in every structure and width, closest and any hit, and compares with `expected`.
  void compare(const Ray& ray, const reference::Hit& expected, Tally& tally) const;

 private:
  std::vector<reference::Voxel> voxels_;
  unsigned materials_;
  std::uint64_t salt_;
  int level_;
  reference::BitGrid reference_;
  std::vector<std::uint8_t> pool_bytes_;
  Octree pool_;
  HeapBytes compact_bytes_;
  HeapBytes keys_bytes_;
  CompactTree compact_;
  CompactTree from_keys_;
  std::vector<std::uint8_t> dense_bytes_;
  std::optional<DenseGrid> dense_;
  bool same_bytes_ = true;
};

}  // namespace thimble::tests
