// The compact tree's bytes: how many, which, and what happens when they are too few or damaged; and the
// Morton keys that they are made from.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "support/compact_damage.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
using Voxels = std::vector<reference::Voxel>;

const int kScale = thimble::tests::many_or_few(4, 1);

// A pool that owns its bytes.
struct OwnedPool {
  OwnedPool(std::size_t nodes, int level) : bytes(Octree::octree_bytes(nodes)) {
    REQUIRE(Octree::make(level, {bytes.data(), bytes.size()}, &pool) == Status::kOk);
  }
  OwnedPool(const OwnedPool&) = delete;
  OwnedPool& operator=(const OwnedPool&) = delete;

  std::vector<std::uint8_t> bytes;
  Octree pool;
};

void insert_all(Octree& pool, const Voxels& voxels, unsigned materials, std::uint64_t salt) {
  for (const reference::Voxel& voxel : voxels) {
    REQUIRE(pool.insert({voxel[0], voxel[1], voxel[2]}, material_at(voxel, materials, salt)) == Status::kOk);
  }
}

bool equal(const HeapBytes& a, const HeapBytes& b) {
  return std::equal(a.view().begin(), a.view().end(), b.view().begin(), b.view().end());
}

// Uniformly random points at level 10 as sorted keys.
std::vector<std::uint32_t> random_keys(std::size_t points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint32_t> keys(points);
  for (std::uint32_t& key : keys) {
    key = static_cast<std::uint32_t>(random() & ((1U << 30) - 1));
  }
  sort_keys(Span<std::uint32_t>{keys.data(), keys.size()}, 30);
  keys.resize(unique_keys(Span<std::uint32_t>{keys.data(), keys.size()}));
  return keys;
}

double bytes_per_voxel(std::size_t points) {
  const std::vector<std::uint32_t> keys = random_keys(points, points);
  std::size_t needed = 0;
  const Span<const std::uint32_t> span{keys.data(), keys.size()};
  REQUIRE(CompactTree::make(span, 10, 0, {}, nullptr, &needed) == Status::kOutOfMemory);
  HeapBytes bytes(needed);
  REQUIRE(CompactTree::make(span, 10, 0, bytes.span(), nullptr, &needed) == Status::kOk);
  CHECK(CompactTree::validate(bytes.view()) == nullptr);
  CHECK(open_or_throw(bytes).voxel_count() == keys.size());
  return static_cast<double>(needed) / static_cast<double>(keys.size());
}

// The four kinds of small tree that are damaged below.
enum class Kind { kPlain, kMaterials, kMerged, kMergedMaterials };

HeapBytes small_tree(Kind kind) {
  OwnedPool owner(4000, 4);
  Octree& pool = owner.pool;
  std::mt19937_64 random(7);
  const unsigned materials = kind == Kind::kMaterials || kind == Kind::kMergedMaterials ? 4 : 1;
  Voxels voxels;
  for (int i = 0; i < 60; ++i) {
    const int x = static_cast<int>(pick(random, 0, 15));
    const int y = static_cast<int>(pick(random, 0, 15));
    voxels.push_back({x, y, static_cast<int>(pick(random, 0, 15))});
  }
  insert_all(pool, voxels, materials, 7);
  REQUIRE(pool.insert_block({8, 8, 0}, 2, static_cast<std::uint8_t>(materials - 1)) == Status::kOk);
  REQUIRE(pool.insert_block({2, 2, 14}, 1, 0) == Status::kOk);
  if (kind == Kind::kMerged || kind == Kind::kMergedMaterials) {
    REQUIRE(pool.coarsen_to(pool.nodes_used() * 2 / 3) == Status::kOk);
  }
  return compact_of(pool, kMinRankShift);
}

constexpr std::array<Kind, 4> kKinds = {Kind::kPlain, Kind::kMaterials, Kind::kMerged,
                                        Kind::kMergedMaterials};

std::vector<Ray> some_rays(int level, int count) {
  const int side = 1 << level;
  RayCases cases(91, {side, side, side});
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    rays.push_back(to_core(cases.next().ray));
  }
  return rays;
}

}  // namespace

TEST_CASE(
    "compact tree: any voxels, materials and rank shift -> pool and keys give the same bytes, sound ones") {
  std::mt19937_64 random(1);
  for (int world = 0; world < 40 * kScale; ++world) {
    const int level = static_cast<int>(pick(random, 1, 6));
    const auto kind = static_cast<WorldKind>(pick(random, 0, std::int64_t{kWorldKinds} - 1));
    const World voxels = make_world(kind, {1 << level, 1 << level, 1 << level}, random);
    const unsigned materials = world % 2 == 0 ? 1 : 3;
    const int rank_shift = static_cast<int>(pick(random, kMinRankShift, kMaxRankShift));
    const SceneUnderTest scene(voxels.size, voxels.voxels, materials, 5, rank_shift);
    CHECK(scene.same_bytes());
    const CompactTree& tree = scene.compact();
    const CompactShape shape = compact_shape(scene.pool(), rank_shift);
    CHECK(tree.size_bytes() == compact_bytes(shape));
    CHECK(tree.node_count() == shape.nodes);
    CHECK(tree.many_materials() == shape.many_materials);
    CHECK(tree.merged() == shape.merged);
    CHECK(tree.level() == shape.level);
    CHECK(tree.rank_shift() == rank_shift);
    CHECK(tree.voxel_count() == voxels.voxels.size());
    CHECK(tree.voxel_count() == scene.pool().voxels());
    CHECK(tree.solid_added() == 0);
    CHECK(tree.bounds() == scene.pool().bounds());
    CHECK(CompactTree::validate({tree.bytes(), tree.size_bytes()}) == nullptr);
  }
}

TEST_CASE("compact tree: a full world of 2^10, of two boxes -> the bytes of one block") {
  OwnedPool by_block(200, 10);
  REQUIRE(by_block.pool.insert_block({0, 0, 0}, 10, 3) == Status::kOk);
  const HeapBytes block_bytes = compact_of(by_block.pool);
  CHECK(CompactTree::validate(block_bytes.view()) == nullptr);
  OwnedPool by_box(2000, 10);
  REQUIRE(by_box.pool.insert_box({{0, 0, 0}, {1024, 1024, 448}}, 3) == Status::kOk);
  CHECK(compact_of(by_box.pool).view().size > 64);
  REQUIRE(by_box.pool.insert_box({{0, 0, 448}, {1024, 1024, 1024}}, 3) == Status::kOk);
  CHECK(equal(compact_of(by_box.pool), block_bytes));
}

TEST_CASE("compact tree: an empty world -> the header alone") {
  for (const int level : {kMinLevel, 7, kMaxLevel}) {
    OwnedPool owner(0, level);
    const HeapBytes bytes = compact_of(owner.pool);
    CHECK(bytes.view().size == kCompactHeaderBytes);
    CHECK(CompactTree::validate(bytes.view()) == nullptr);
    const CompactTree tree = open_or_throw(bytes);
    CHECK(tree.empty());
    CHECK(tree.level() == level);
    CHECK(tree.bounds().empty());
    CHECK(tree.voxel_count() == 0);
    CHECK(equal(bytes, compact_of_keys_64({}, level, 1, 0)));
  }
}

TEST_CASE("compact tree: random points at level 10 -> the bytes a voxel that were promised") {
  // Measured 4.45 for 100,000 and 3.28 for 1,000,000.
  CHECK(bytes_per_voxel(100000) < 4.6);
  CHECK(bytes_per_voxel(1000000) < 3.4);
}

TEST_CASE("compact tree: one material, whichever -> no byte more than with none") {
  std::mt19937_64 random(3);
  const World world = make_world(WorldKind::kRandom, {16, 16, 16}, random);
  const auto size_with = [&](std::uint8_t first, std::uint8_t others) {
    OwnedPool owner(8000, 4);
    for (std::size_t i = 0; i < world.voxels.size(); ++i) {
      const reference::Voxel& voxel = world.voxels[i];
      REQUIRE(owner.pool.insert({voxel[0], voxel[1], voxel[2]}, i == 0 ? first : others) == Status::kOk);
    }
    return compact_of(owner.pool).view().size;
  };
  CHECK(size_with(0, 0) == size_with(255, 255));
  CHECK(size_with(0, 0) < size_with(0, 255));
}

TEST_CASE("compact tree: every output that is too small -> out of memory, not a byte written") {
  constexpr std::uint8_t kGuard = 0xA5;
  std::mt19937_64 random(4);
  for (const unsigned materials : {1U, 3U}) {
    const World world = make_world(WorldKind::kSparse, {16, 16, 16}, random);
    OwnedPool owner(4000, 4);
    insert_all(owner.pool, world.voxels, materials, 9);
    std::vector<std::uint64_t> keys;
    for (const reference::Voxel& voxel : world.voxels) {
      keys.push_back(morton_code(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]),
                                 static_cast<std::uint32_t>(voxel[2]))
                         << 8 |
                     material_at(voxel, materials, 9));
    }
    std::sort(keys.begin(), keys.end());
    const std::size_t exact = compact_bytes(compact_shape(owner.pool));
    for (std::size_t size = 0; size <= exact + 9; ++size) {
      // One byte more than the size is there to be left alone.
      const std::size_t used = size < exact ? 0 : exact;
      for (const bool from_keys : {false, true}) {
        std::vector<std::uint8_t> bytes(size + 1, kGuard);
        std::size_t needed = 0;
        const Status status = from_keys
                                  ? CompactTree::make(Span<const std::uint64_t>{keys.data(), keys.size()}, 4,
                                                      {bytes.data(), size}, nullptr, &needed)
                                  : CompactTree::make(owner.pool, {bytes.data(), size}, nullptr, &needed);
        REQUIRE(status == (size < exact ? Status::kOutOfMemory : Status::kOk));
        REQUIRE(needed == exact);
        REQUIRE(std::all_of(bytes.begin() + static_cast<std::ptrdiff_t>(used), bytes.end(),
                            [](std::uint8_t byte) { return byte == kGuard; }));
        if (used != 0) {
          REQUIRE(CompactTree::validate({bytes.data(), size}) == nullptr);
        }
      }
    }
  }
}

TEST_CASE("compact tree: 32-bit keys of levels beyond the limits -> refused") {
  std::array<std::uint8_t, 100> bytes{};
  std::size_t needed = 0;
  for (const int level : {-1, 0, 11, 12, 13}) {
    CHECK(CompactTree::make(Span<const std::uint32_t>(), level, 0, {bytes.data(), bytes.size()}, nullptr,
                            &needed) == Status::kOutOfRange);
  }
}

TEST_CASE("compact tree: bytes at any address, more behind them -> the same tree, the same answers") {
  for (const Kind kind : kKinds) {
    const HeapBytes aligned = small_tree(kind);
    const std::vector<Ray> rays = some_rays(4, 50);
    const CompactTree tree = open_or_throw(aligned);
    for (std::size_t offset = 0; offset < 8; ++offset) {
      HeapBytes moved(aligned.view().size + offset, offset);
      std::copy(aligned.view().begin(), aligned.view().end(), moved.span().begin());
      CHECK(CompactTree::validate(moved.view()) == nullptr);
      const CompactTree there = open_or_throw(moved);
      CHECK(there.size_bytes() == tree.size_bytes());
      for (const Ray& ray : rays) {
        Hit a;
        Hit b;
        REQUIRE(closest_hit(tree, ray, &a) == Status::kOk);
        REQUIRE(closest_hit(there, ray, &b) == Status::kOk);
        CHECK(describe(a) == describe(b));
      }
    }
  }
}

TEST_CASE("compact tree: every truncation -> refused, the tree handed in as it was") {
  for (const Kind kind : kKinds) {
    const HeapBytes whole = small_tree(kind);
    for (std::size_t size = 0; size < whole.view().size; ++size) {
      HeapBytes cut(size);
      std::copy_n(whole.view().begin(), size, cut.span().begin());
      CompactTree tree;
      CHECK(CompactTree::open(cut.view(), &tree) == Status::kDamaged);
      CHECK(tree.bytes() == nullptr);
      CHECK(CompactTree::validate(cut.view()) != nullptr);
    }
  }
}

TEST_CASE("compact tree: every flipped bit -> reported, and tracing stays inside the bytes and the bound") {
  const std::vector<Ray> rays = some_rays(4, 300);
  const std::vector<Ray> far_rays = some_rays(kMaxLevel, 20);
  std::int64_t flips = 0;
  std::int64_t opened = 0;
  std::int64_t sound = 0;
  for (const Kind kind : kKinds) {
    const HeapBytes whole = small_tree(kind);
    HeapBytes damaged(whole.view().size);
    for (std::size_t bit = 0; bit < 8 * whole.view().size; ++bit) {
      std::copy(whole.view().begin(), whole.view().end(), damaged.span().begin());
      damaged.span()[bit / 8] = static_cast<std::uint8_t>(damaged.span()[bit / 8] ^ 1U << (bit % 8));
      ++flips;
      std::uint32_t place = 0;
      const char* text = CompactTree::validate(damaged.view(), &place);
      CHECK_MESSAGE(text != nullptr, "bit ", bit);
      // With and without a checksum that hides the damage.
      for (const bool repaired : {false, true}) {
        if (repaired) {
          repair_checksum(damaged.span());
          sound += CompactTree::validate(damaged.view(), &place) == nullptr ? 1 : 0;
        }
        CompactTree tree;
        if (CompactTree::open(damaged.view(), &tree) != Status::kOk) {
          CHECK(text != nullptr);
          continue;
        }
        ++opened;
        const std::vector<Ray>& cases = tree.level() > 8 ? far_rays : rays;
        for (const Ray& ray : cases) {
          if (check_ray(ray, tree.level()) == Status::kOk) {
            const char* broken = trace_damaged(tree, ray);
            REQUIRE_MESSAGE(broken == nullptr,
                            (std::string(broken != nullptr ? broken : "") + ", bit " + std::to_string(bit)));
          }
        }
      }
    }
  }
  MESSAGE("flips ", flips, ", trees traced ", opened, ", sound again with a new checksum ", sound);
  // Some bits say things that no structure contradicts: a material, the volume added.
  CHECK(sound > 0);
  CHECK(sound < flips / 2);
}

TEST_CASE("compact tree: counts beyond 2^32 bytes and a size of 0 -> refused") {
  // compact_bytes says 0 for such counts; a header that says 0 too once passed, and its nodes were anywhere.
  for (const std::ptrdiff_t count_offset : {16, 20, 24}) {
    const HeapBytes bytes = small_tree(Kind::kMaterials);
    std::fill_n(bytes.span().begin() + 8, 4, std::uint8_t{0});
    std::fill_n(bytes.span().begin() + count_offset, 4, std::uint8_t{0xFF});
    CompactTree tree;
    CHECK(CompactTree::open(bytes.view(), &tree) == Status::kDamaged);
    std::uint32_t place = 0;
    CHECK(CompactTree::validate(bytes.view(), &place) != nullptr);
    CHECK(place == 8);
  }
}

TEST_CASE(
    "compact tree: random damage under a valid checksum -> tracing stays inside the bytes and the bound") {
  const std::vector<Ray> rays = some_rays(4, 100);
  std::mt19937_64 random(95);
  for (const Kind kind : kKinds) {
    const HeapBytes whole = small_tree(kind);
    HeapBytes damaged(whole.view().size);
    for (int round = 0; round < 300 * kScale; ++round) {
      std::copy(whole.view().begin(), whole.view().end(), damaged.span().begin());
      // The header's sizes stay, so that most of these open.
      const std::int64_t bytes = pick(random, 1, 40);
      for (std::int64_t i = 0; i < bytes; ++i) {
        const std::int64_t first = round % 4 == 0 ? 28 : static_cast<std::int64_t>(kCompactHeaderBytes);
        const auto at =
            static_cast<std::size_t>(pick(random, first, static_cast<std::int64_t>(whole.view().size) - 1));
        damaged.span()[at] = static_cast<std::uint8_t>(random());
      }
      repair_checksum(damaged.span());
      static_cast<void>(CompactTree::validate(damaged.view()));
      CompactTree tree;
      if (CompactTree::open(damaged.view(), &tree) != Status::kOk) {
        continue;
      }
      for (const Ray& ray : rays) {
        const char* broken = trace_damaged(tree, ray);
        REQUIRE_MESSAGE(broken == nullptr,
                        (std::string(broken != nullptr ? broken : "") + ", round " + std::to_string(round)));
      }
    }
  }
}

TEST_CASE("morton: voxels to codes and back -> the same, bit by bit interleaved") {
  std::mt19937_64 random(101);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    const auto x = static_cast<std::uint32_t>(bits & 0x1FFFFF);
    const auto y = static_cast<std::uint32_t>((bits >> 21) & 0x1FFFFF);
    const auto z = static_cast<std::uint32_t>((bits >> 42) & 0x1FFFFF);
    std::uint64_t plain = 0;
    for (int bit = 0; bit < 21; ++bit) {
      plain |= std::uint64_t{(x >> bit) & 1} << (3 * bit) | std::uint64_t{(y >> bit) & 1} << (3 * bit + 1) |
               std::uint64_t{(z >> bit) & 1} << (3 * bit + 2);
    }
    REQUIRE(morton_code(x, y, z) == plain);
    REQUIRE(morton_voxel(plain) ==
            Vec3i{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)});
  }
}

namespace {

template <class Key>
void check_sort(std::uint64_t seed) {
  constexpr int kKeyBits = 8 * static_cast<int>(sizeof(Key));
  std::mt19937_64 random(seed);
  const std::size_t sizes[] = {0, 1, 2, 3, 47, 48, 49, 50, 255, 256, 257, 1000, 5000, 20000};
  for (const std::size_t size : sizes) {
    for (int key_bits = 1; key_bits <= kKeyBits; key_bits += size > 1000 ? 7 : 1) {
      for (int pattern = 0; pattern < 6; ++pattern) {
        std::vector<Key> keys(size);
        for (std::size_t i = 0; i < size; ++i) {
          std::uint64_t key = random();
          switch (pattern) {
            case 1:  // few values
              key = key % 3 * 0x0123456789ABCDEFULL;
              break;
            case 2:  // ascending
              key = i;
              break;
            case 3:  // descending, in the upper bits
              key = ~std::uint64_t{i} << (key_bits > 16 ? key_bits - 16 : 0);
              break;
            case 4:  // all the same
              key = 0x5555555555555555ULL;
              break;
            case 5:  // log-uniform
              key >>= key % 64;
              break;
            default:
              break;
          }
          keys[i] = static_cast<Key>(key & (~std::uint64_t{0} >> (64 - key_bits)));
        }
        std::vector<Key> expected = keys;
        std::sort(expected.begin(), expected.end());
        sort_keys(Span<Key>{keys.data(), keys.size()}, key_bits);
        REQUIRE_MESSAGE(keys == expected,
                        "size " << size << ", bits " << key_bits << ", pattern " << pattern);

        // Unique: bare codes once; of codes with a material the greatest.
        std::vector<Key> unique;
        for (std::size_t i = 0; i < size; ++i) {
          constexpr int kShift = sizeof(Key) == 4 ? 0 : 8;
          if (i + 1 == size || (expected[i] >> kShift) != (expected[i + 1] >> kShift)) {
            unique.push_back(expected[i]);
          }
        }
        keys.resize(unique_keys(Span<Key>{keys.data(), keys.size()}));
        REQUIRE(keys == unique);
      }
    }
  }
}

}  // namespace

TEST_CASE("sort_keys, unique_keys: any size, key bits and pattern -> what std::sort gives, each once") {
  check_sort<std::uint32_t>(111);
  check_sort<std::uint64_t>(112);
}

namespace {

// The compact bytes of a pool.
std::vector<std::uint8_t> compacted(const Octree& pool) {
  std::vector<std::uint8_t> bytes(compact_bytes(compact_shape(pool)));
  std::size_t size = 0;
  REQUIRE(CompactTree::make(pool, {bytes.data(), bytes.size()}, nullptr, &size) == Status::kOk);
  REQUIRE(size == bytes.size());
  return bytes;
}

struct Parts {
  std::vector<std::vector<std::uint8_t>> bytes;
  std::vector<CompactTree> trees;

  void add(const Octree& pool) {
    bytes.push_back(compacted(pool));
    CompactTree tree;
    REQUIRE(CompactTree::open({bytes.back().data(), bytes.back().size()}, &tree) == Status::kOk);
    trees.push_back(tree);
  }
  Status join(std::vector<std::uint8_t>* out) const {
    const Span<const CompactTree> span{trees.data(), trees.size()};
    std::size_t size = 0;
    const Status status = CompactTree::make(span, {}, nullptr, &size);
    if (status != Status::kOutOfMemory) {
      return status;
    }
    out->assign(size, 0);
    return CompactTree::make(span, {out->data(), out->size()}, nullptr, &size);
  }
};

// A world of 2^level with full, empty and mixed regions.
void fill_world(Octree& pool, int level, unsigned materials, std::mt19937_64& random) {
  const std::int32_t side = std::int32_t{1} << level;
  for (int i = 0; i < 40; ++i) {
    const int block_level = static_cast<int>(random() % static_cast<unsigned>(level));
    const std::int32_t cells = side >> block_level;
    const auto place = [&] {
      return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(cells)) << block_level;
    };
    const Vec3i corner{place(), place(), place()};
    REQUIRE(pool.insert_block(corner, block_level, static_cast<std::uint8_t>(random() % materials)) ==
            Status::kOk);
  }
}

}  // namespace

TEST_CASE("compact tree: a world joined from its parts -> the bytes of the whole") {
  const std::uint64_t seed = 11;
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  constexpr int kLevel = 5;
  constexpr std::int32_t kSide = 1 << kLevel;
  for (int round = 0; round < 12 * kScale; ++round) {
    CAPTURE(round);
    const unsigned materials = round % 3 == 0 ? 1 : 3;
    OwnedPool whole(200000, kLevel);
    if (round % 4 == 3) {  // the world itself, or an octant of it, is one block
      REQUIRE(whole.pool.insert_block({0, 0, 0}, round % 8 == 3 ? kLevel : kLevel - 1, 2) == Status::kOk);
    } else if (round % 4 != 2) {
      fill_world(whole.pool, kLevel, materials, random);
    }
    for (int split = 0; split <= 3; ++split) {
      CAPTURE(split);
      const int part_level = kLevel - split;
      Parts parts;
      for (std::uint64_t part = 0; part < std::uint64_t{1} << (3 * split); ++part) {
        OwnedPool piece(40000, part_level);
        const Vec3i at = morton_voxel(part);
        const std::int32_t side = kSide >> split;
        for (std::int32_t i = 0; i < side * side * side; ++i) {
          const Vec3i local{i % side, i / side % side, i / side / side};
          const int material =
              whole.pool.material({at.x * side + local.x, at.y * side + local.y, at.z * side + local.z});
          if (material >= 0) {
            REQUIRE(piece.pool.insert(local, static_cast<std::uint8_t>(material)) == Status::kOk);
          }
        }
        parts.add(piece.pool);
      }
      std::vector<std::uint8_t> joined;
      REQUIRE(parts.join(&joined) == Status::kOk);
      CHECK(joined == compacted(whole.pool));
    }
  }
}

TEST_CASE("compact tree: parts that were coarsened -> merged blocks, volume and added volume come along") {
  std::mt19937_64 random(5);
  Parts parts;
  std::uint64_t volume = 0;
  std::uint64_t added = 0;
  for (int part = 0; part < 8; ++part) {
    OwnedPool piece(40000, 4);
    for (int i = 0; i < 300; ++i) {
      const auto place = [&] { return static_cast<std::int32_t>(random() % 16); };
      REQUIRE(piece.pool.insert({place(), place(), place()}, 7) == Status::kOk);
    }
    REQUIRE(piece.pool.coarsen_to(20) == Status::kOk);
    volume += piece.pool.voxels();
    added += piece.pool.solid_added();
    parts.add(piece.pool);
  }
  std::vector<std::uint8_t> joined;
  REQUIRE(parts.join(&joined) == Status::kOk);
  CHECK(CompactTree::validate({joined.data(), joined.size()}) == nullptr);
  CompactTree tree;
  REQUIRE(CompactTree::open({joined.data(), joined.size()}, &tree) == Status::kOk);
  CHECK(tree.merged());
  CHECK(tree.level() == 5);
  CHECK(tree.voxel_count() == volume);
  CHECK(tree.solid_added() == added);
}

TEST_CASE("compact tree: parts that do not fit together -> refused") {
  OwnedPool small(100, 3);
  OwnedPool large(100, 4);
  Parts parts;
  std::vector<std::uint8_t> joined;
  CHECK(parts.join(&joined) == Status::kBadArgument);
  for (int i = 0; i < 7; ++i) {
    parts.add(small.pool);
  }
  CHECK(parts.join(&joined) == Status::kBadArgument);
  parts.add(large.pool);
  CHECK(parts.join(&joined) == Status::kBadArgument);
  OwnedPool largest(100, kMaxLevel);
  Parts beyond;
  for (int i = 0; i < 8; ++i) {
    beyond.add(largest.pool);
  }
  CHECK(beyond.join(&joined) == Status::kOutOfRange);
}
