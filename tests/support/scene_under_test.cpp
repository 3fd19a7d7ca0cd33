// One set of voxels in every structure.
#include "support/scene_under_test.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "support/ray_cases.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tests {

namespace {

Vec3i to_core(const reference::Voxel& voxel) {
  return {voxel[0], voxel[1], voxel[2]};
}

int level_for(const reference::Voxel& size) {
  int level = kMinLevel;
  while ((1 << level) < std::max({size[0], size[1], size[2]})) {
    ++level;
  }
  return level;
}

std::uint64_t code_of(const reference::Voxel& voxel) {
  return morton_code(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]),
                     static_cast<std::uint32_t>(voxel[2]));
}

Octree fill_pool(std::vector<std::uint8_t>& bytes, int level, const std::vector<reference::Voxel>& voxels,
                 unsigned materials, std::uint64_t salt) {
  // Every voxel brings at most a node a level and, where materials differ, eight of level 0.
  std::size_t nodes = 256 + std::min<std::size_t>(voxels.size() * static_cast<std::size_t>(level + 2),
                                                  std::size_t{1} << std::min(3 * level + 1, 27));
  bytes.resize(Octree::octree_bytes(nodes));
  Octree pool;
  if (Octree::make(level, {bytes.data(), bytes.size()}, &pool) != Status::kOk) {
    throw std::logic_error("scene under test: the pool refuses its level");
  }
  for (const reference::Voxel& voxel : voxels) {
    if (pool.insert(to_core(voxel), material_at(voxel, materials, salt)) != Status::kOk) {
      throw std::logic_error("scene under test: the pool refuses a voxel");
    }
  }
  return pool;
}

template <class Key>
HeapBytes from_sorted(std::vector<Key> keys, int key_bits, int level, std::uint8_t material, int rank_shift) {
  sort_keys(Span<Key>{keys.data(), keys.size()}, key_bits);
  const std::size_t count = unique_keys(Span<Key>{keys.data(), keys.size()});
  const Span<const Key> sorted{keys.data(), count};
  const auto write = [&](Bytes out, std::size_t* needed) {
    if constexpr (sizeof(Key) == 4) {
      return CompactTree::make(sorted, level, material, out, nullptr, needed, rank_shift);
    } else {
      static_cast<void>(material);
      return CompactTree::make(sorted, level, out, nullptr, needed, rank_shift);
    }
  };
  std::size_t needed = 0;
  if (write({}, &needed) != Status::kOutOfMemory) {
    throw std::logic_error("scene under test: a compact tree in no bytes");
  }
  HeapBytes bytes(needed);
  if (write(bytes.span(), &needed) != Status::kOk) {
    throw std::logic_error("scene under test: the size given is not enough");
  }
  return bytes;
}

}  // namespace

OwnedPool::OwnedPool(int level, std::size_t nodes) : words(2 * nodes + 1) {
  REQUIRE(Octree::make(level, {reinterpret_cast<std::uint8_t*>(words.data()), 8 * nodes}, &octree) ==
          Status::kOk);
}

std::uint8_t material_at(const reference::Voxel& voxel, unsigned materials, std::uint64_t salt) {
  std::uint64_t hash = code_of(voxel) + salt * 0x9E3779B97F4A7C15ULL;
  hash = (hash ^ (hash >> 31)) * 0xBF58476D1CE4E5B9ULL;
  hash = (hash ^ (hash >> 29)) * 0x94D049BB133111EBULL;
  return static_cast<std::uint8_t>((hash >> 40) % materials);
}

reference::Ray to_reference(const Ray& ray) {
  reference::Ray result;
  for (int axis = 0; axis < 3; ++axis) {
    result.origin_q8[static_cast<std::size_t>(axis)] = ray.origin[axis].raw;
    result.direction[static_cast<std::size_t>(axis)] = ray.direction[axis];
  }
  return result;
}

Ray to_core(const reference::Ray& ray) {
  Ray result;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t a = static_cast<std::size_t>(axis);
    result.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(ray.origin_q8[a]));
    result.direction[axis] = static_cast<std::int32_t>(ray.direction[a]);
  }
  return result;
}

std::vector<Ray> accepted_rays(std::uint64_t seed, int level, int count) {
  const int side = 1 << level;
  RayCases cases(seed, {side, side, side});
  std::vector<Ray> rays;
  while (rays.size() < static_cast<std::size_t>(count)) {
    const Ray ray = to_core(cases.next().ray);
    if (check_ray(ray, level) == Status::kOk) {
      rays.push_back(ray);
    }
  }
  return rays;
}

HeapBytes compact_of(const Octree& octree, int rank_shift, std::size_t offset) {
  HeapBytes bytes(compact_bytes(compact_shape(octree, rank_shift)), offset);
  std::size_t written = 0;
  if (CompactTree::make(octree, bytes.span(), nullptr, &written, rank_shift) != Status::kOk ||
      written != bytes.view().size) {
    throw std::logic_error("scene under test: compact_bytes is not what is written");
  }
  return bytes;
}

HeapBytes compact_of_keys_32(const std::vector<reference::Voxel>& voxels, int level, std::uint8_t material,
                             int rank_shift) {
  std::vector<std::uint32_t> keys;
  keys.reserve(voxels.size());
  for (const reference::Voxel& voxel : voxels) {
    keys.push_back(static_cast<std::uint32_t>(code_of(voxel)));
  }
  return from_sorted(std::move(keys), 3 * level, level, material, rank_shift);
}

HeapBytes compact_of_keys_64(const std::vector<reference::Voxel>& voxels, int level, unsigned materials,
                             std::uint64_t salt, int rank_shift) {
  std::vector<std::uint64_t> keys;
  keys.reserve(voxels.size());
  for (const reference::Voxel& voxel : voxels) {
    keys.push_back(code_of(voxel) << 8 | material_at(voxel, materials, salt));
  }
  return from_sorted(std::move(keys), 3 * level + 8, level, 0, rank_shift);
}

HeapBytes map_of(const CompactTree& tree) {
  const HeapBytes room(most_brick_map_bytes(tree));
  std::size_t size = 0;
  REQUIRE((room.view().empty() || BrickMap::make(tree, room.span(), nullptr, &size) == Status::kOk));
  return HeapBytes(room.view().subspan(0, size));
}

HeapBytes shared_of(const CompactTree& tree) {
  const HeapBytes work(shared_work_bytes(tree.node_count()));
  SharedBuild build;
  REQUIRE(SharedTree::make(tree, {}, work.span(), nullptr, &build) == Status::kOutOfMemory);
  HeapBytes bytes(build.bytes);
  REQUIRE(SharedTree::make(tree, bytes.span(), work.span(), nullptr) == Status::kOk);
  return bytes;
}

HeapBytes packed(const EditedWorld& world) {
  std::size_t size = 0;
  if (world.pack({}, &size) != Status::kOutOfMemory) {
    throw std::logic_error("scene under test: no bytes hold a tree");
  }
  HeapBytes bytes(size);
  if (world.pack(bytes.span()) != Status::kOk) {
    throw std::logic_error("scene under test: an edited world is not packed into its bytes");
  }
  return bytes;
}

CompactTree open_or_throw(const HeapBytes& bytes) {
  CompactTree tree;
  if (CompactTree::open(bytes.view(), &tree) != Status::kOk) {
    throw std::logic_error("scene under test: a fresh compact tree does not open");
  }
  return tree;
}

MappedTree::MappedTree(HeapBytes bytes)
    : tree_bytes(std::move(bytes)), tree(open_or_throw(tree_bytes)), map_room(most_brick_map_bytes(tree)) {
  if (BrickMap::make(tree, map_room.span(), &map) != Status::kOk) {
    throw std::logic_error("the tree has no brick map");
  }
}

bool same_answer(const Hit& hit, const reference::Hit& expected) {
  if (hit.kind == HitKind::kStepLimit || (hit.kind == HitKind::kHit) != expected.hit) {
    return false;
  }
  if (!expected.hit) {
    return true;
  }
  const reference::Hit converted{
      true, {hit.voxel.x, hit.voxel.y, hit.voxel.z}, hit.t_numerator, hit.t_denominator, hit.axis};
  return hit.t_denominator > 0 && reference::same_answer(converted, expected);
}

bool same_hit(const Hit& one, const Hit& other) {
  return one.kind == other.kind &&
         (one.kind != HitKind::kHit ||
          (one.voxel == other.voxel && one.axis == other.axis && one.material == other.material &&
           one.block_level == other.block_level && one.t_numerator == other.t_numerator &&
           one.t_denominator == other.t_denominator));
}

std::string describe(const Hit& hit) {
  if (hit.kind != HitKind::kHit) {
    return hit.kind == HitKind::kMiss ? "miss" : "step limit";
  }
  return "voxel (" + std::to_string(hit.voxel.x) + ", " + std::to_string(hit.voxel.y) + ", " +
         std::to_string(hit.voxel.z) + ") t " + std::to_string(hit.t_numerator) + "/" +
         std::to_string(hit.t_denominator) + " axis " + std::to_string(hit.axis) + " block " +
         std::to_string(hit.block_level) + " material " + std::to_string(hit.material);
}

SceneUnderTest::SceneUnderTest(const reference::Voxel& size, const std::vector<reference::Voxel>& voxels,
                               unsigned materials, std::uint64_t salt, int rank_shift)
    : voxels_(voxels),
      materials_(materials),
      salt_(salt),
      level_(level_for(size)),
      reference_(size, voxels),
      pool_(fill_pool(pool_bytes_, level_, voxels, materials, salt)),
      compact_bytes_(compact_of(pool_, rank_shift)),
      keys_bytes_(compact_of_keys_64(voxels, level_, materials, salt, rank_shift)),
      compact_(open_or_throw(compact_bytes_)),
      from_keys_(open_or_throw(keys_bytes_)) {
  same_bytes_ = compact_bytes_ == keys_bytes_;
  if (materials == 1 && level_ <= 10) {
    same_bytes_ = same_bytes_ && compact_bytes_ == compact_of_keys_32(voxels, level_, 0, rank_shift);
  }
  const Vec3i grid_size = to_core(size);
  const std::size_t dense_size = dense_grid_bytes(grid_size);
  if (dense_size <= std::size_t{1} << 20) {
    dense_bytes_.resize(dense_size);
    DenseGrid grid;
    if (DenseGrid::make(grid_size, {dense_bytes_.data(), dense_bytes_.size()}, &grid) != Status::kOk) {
      throw std::logic_error("scene under test: the dense grid refuses its size");
    }
    for (const reference::Voxel& voxel : voxels) {
      if (grid.set(to_core(voxel)) != Status::kOk) {
        throw std::logic_error("scene under test: the dense grid refuses a voxel");
      }
    }
    dense_ = grid;
  }
}

SceneUnderTest::Tally& SceneUnderTest::Tally::operator+=(const Tally& other) {
  traced += other.traced;
  narrow += other.narrow;
  mismatches += other.mismatches;
  if (first.size() < 2000) {
    first += other.first;
  }
  return *this;
}

namespace {

// One structure: both widths, closest and any hit. Everything that both calls and both widths say must agree,
// the count of visits included.
template <class Structure>
void compare_structure(const Structure& structure, const char* name, const Ray& ray, bool narrow,
                       const reference::Hit& expected, int material, std::uint32_t* visits,
                       SceneUnderTest::Tally& tally) {
  const auto complain = [&](const char* width, const std::string& what) {
    ++tally.mismatches;
    if (tally.first.size() < 2000) {
      tally.first += std::string("\n") + name + " " + width + ": " + reference::describe(to_reference(ray)) +
                     ": " + what + ", expected " + reference::describe(expected);
    }
  };
  std::uint32_t wide_visits = 0;
  for (const Width width : {Width::k64, Width::k32}) {
    const bool wide = width == Width::k64;
    const char* label = wide ? "64" : "32";
    if (!wide && !narrow) {
      continue;
    }
    const TraceOptions options{UINT32_MAX, width};
    Hit hit;
    hit.kind = HitKind::kStepLimit;
    if (closest_hit(structure, ray, &hit, options) != Status::kOk) {
      complain(label, "refused");
      continue;
    }
    ++tally.traced;
    if (!tests::same_answer(hit, expected)) {
      complain(label, describe(hit));
    } else if (hit.kind == HitKind::kHit && (hit.material != material || hit.block_level != 0)) {
      complain(label, describe(hit) + ", expected material " + std::to_string(material));
    }
    HitKind kind = HitKind::kStepLimit;
    std::uint32_t any_visits = 0;
    if (any_hit(structure, ray, &kind, &any_visits, options) != Status::kOk) {
      complain(label, "any_hit refused");
    } else if (kind != hit.kind || any_visits != hit.visits) {
      complain(label, "any_hit differs from closest_hit");
    }
    if (wide) {
      wide_visits = hit.visits;
    } else if (hit.visits != wide_visits) {
      complain(label,
               "visits " + std::to_string(hit.visits) + ", with 64 bits " + std::to_string(wide_visits));
    }
  }
  *visits = wide_visits;
}

}  // namespace

void SceneUnderTest::compare(const Ray& ray, const reference::Hit& expected, Tally& tally) const {
  const bool narrow = accepts_32(ray, level_);
  tally.narrow += narrow ? 1 : 0;
  const int material = expected.hit ? material_at(expected.voxel, materials_, salt_) : -1;
  std::uint32_t compact_visits = 0;
  std::uint32_t pool_visits = 0;
  std::uint32_t ignored = 0;
  // Equal bytes give equal answers; every second ray goes to the one made from keys all the same.
  const bool keys_turn = !same_bytes_ || (ray.direction.x & 1) != 0;
  compare_structure(keys_turn ? from_keys_ : compact_, "compact", ray, narrow, expected, material,
                    &compact_visits, tally);
  compare_structure(pool_, "pool", ray, narrow, expected, material, &pool_visits, tally);
  if (compact_visits != pool_visits) {
    ++tally.mismatches;
    tally.first += "\npool and compact visit a different number of nodes";
  }
  if (dense_) {
    compare_structure(*dense_, "dense", ray, narrow, expected, expected.hit ? 0 : -1, &ignored, tally);
  }
}

}  // namespace thimble::tests
