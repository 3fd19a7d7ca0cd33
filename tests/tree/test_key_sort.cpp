// Building large scenes on a desktop: keys sorted with scratch and threads are those that the core sorts, and
// the tree made from them is the octree's, byte by byte.
#include <doctest/doctest.h>

#include <algorithm>

#include "scene/built_scene.h"
#include "scene/host_memory.h"
#include "scene/point_tree.h"
#include "scene/scene_source.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

using tools::key_sort_scratch_bytes;

const int kLists = thimble::tests::many_or_few(40, 10);
const std::int64_t kMostKeys = thimble::tests::many_or_few<std::int64_t>(600'000, 150'000);
const int kWorlds = thimble::tests::many_or_few(60, 12);
const std::int64_t kMostVoxels = thimble::tests::many_or_few<std::int64_t>(80'000, 20'000);

// Keys anywhere, in few places, in long runs of equal ones, or in order.
template <class Key>
std::vector<Key> random_keys(std::mt19937_64& random, int bits, std::int64_t count) {
  const std::uint64_t all = (std::uint64_t{1} << bits) - 1;
  std::vector<Key> keys;
  const std::int64_t kind = pick(random, 0, 4);
  const std::uint64_t place = random() & all;
  const int spread = pick_int(random, 0, bits);
  for (std::int64_t i = 0; i < count; ++i) {
    std::uint64_t key = random() & all;
    switch (kind) {
      case 1:
        key = (place & ~((std::uint64_t{1} << spread) - 1)) | (key & ((std::uint64_t{1} << spread) - 1));
        break;
      case 2:
        key %= 100;
        break;
      case 3:
        key = (i % 2 == 0 ? static_cast<std::uint64_t>(i) : all - static_cast<std::uint64_t>(i)) & all;
        break;
      default:
        break;
    }
    keys.push_back(static_cast<Key>(key));
  }
  return keys;
}

template <class Key>
void check_sorted(std::mt19937_64& random, int bits) {
  const std::int64_t count =
      pick(random, 0, 3) == 0 ? pick(random, 0, 3000) : pick(random, 60'000, kMostKeys);
  const std::vector<Key> keys = random_keys<Key>(random, bits, count);
  std::vector<Key> expected = keys;
  std::sort(expected.begin(), expected.end());
  const int threads = pick_int(random, 1, 4);
  const std::size_t most = key_sort_scratch_bytes(keys.size(), threads);
  CHECK(most <= keys.size());
  // All the scratch there may be, some of it, or none.
  const std::size_t scratch =
      pick(random, 0, 2) == 0 ? most
                              : static_cast<std::size_t>(pick(random, 0, static_cast<std::int64_t>(most))) /
                                    sizeof(Key) * sizeof(Key);
  HeapBytes room(scratch);
  std::vector<Key> sorted = keys;
  tools::sort_keys_fast(Span<Key>(sorted.data(), sorted.size()), bits, room.span(), threads);
  CAPTURE(bits);
  CAPTURE(count);
  CAPTURE(threads);
  CAPTURE(scratch);
  CHECK(sorted == expected);
}

// Voxels held in memory: a source of whatever a test wants.
class Voxels : public tools::SceneSource {
 public:
  struct Voxel {
    Vec3i at;
    std::uint8_t material;
  };
  Voxels(int level, const std::vector<Voxel>& voxels, bool single)
      : SceneSource(facts_of(level, voxels.size(), single), [voxels](const tools::VoxelSink& sink) {
          for (const Voxel& voxel : voxels) {
            sink(voxel.at.x, voxel.at.y, voxel.at.z, voxel.material);
          }
        }) {}

 private:
  static tools::SourceFacts facts_of(int level, std::size_t points, bool single) {
    tools::SourceFacts facts;
    facts.level = level;
    facts.points = points;
    facts.is_point_set = true;
    facts.single_material = single;
    return facts;
  }
};

// Points, crowds and solid boxes; every third time voxels repeat, with other materials.
Voxels random_world(std::mt19937_64& random, int least_level = 1) {
  const int level = pick_int(random, least_level, 12);
  const std::int32_t side = std::int32_t{1} << level;
  const bool single = pick(random, 0, 1) == 0;
  const std::int64_t materials = pick(random, 1, 4);
  std::vector<Voxels::Voxel> voxels;
  std::int64_t of_all = -1;  // where it is not a voxel's own
  const auto add = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto inside = [&](std::int64_t value) {
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, 0, side - 1));
    };
    const std::int64_t material = single ? 0 : of_all >= 0 ? of_all : pick(random, 0, materials - 1);
    voxels.push_back({{inside(x), inside(y), inside(z)}, static_cast<std::uint8_t>(material)});
  };
  for (std::int64_t i = pick(random, 0, pick(random, 0, 1) == 0 ? 3000 : kMostVoxels); i > 0; --i) {
    add(pick(random, 0, side - 1), pick(random, 0, side - 1), pick(random, 0, side - 1));
  }
  for (std::int64_t box = pick(random, 0, 3); box > 0; --box) {
    const std::int64_t size = pick(random, 1, 20);
    of_all = pick(random, -1, materials - 1);
    const std::int64_t at[3] = {pick(random, 0, side - 1) & -8, pick(random, 0, side - 1) & -8,
                                pick(random, 0, side - 1) & -8};
    for (std::int64_t z = 0; z < size; ++z) {
      for (std::int64_t y = 0; y < size; ++y) {
        for (std::int64_t x = 0; x < size; ++x) {
          add(at[0] + x, at[1] + y, at[2] + z);
        }
      }
    }
  }
  if (!voxels.empty() && pick(random, 0, 2) == 0) {
    for (std::int64_t i = pick(random, 1, 2000); i > 0; --i) {
      const auto from =
          voxels[static_cast<std::size_t>(pick(random, 0, static_cast<std::int64_t>(voxels.size()) - 1))];
      add(from.at.x, from.at.y, from.at.z);
    }
  }
  std::shuffle(voxels.begin(), voxels.end(), random);
  return Voxels(level, voxels, single);
}

// The same scene through the core's octree.
HeapBytes tree_by_octree(const Voxels& source) {
  HeapBytes pool(std::size_t{64} << 20);
  Octree octree;
  REQUIRE(Octree::make(source.level(), pool.span(), &octree) == Status::kOk);
  source.stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        const Vec3i at{x, y, z};
        if (!octree.test(at) || octree.material(at) < material) {
          REQUIRE(octree.insert(at, material) == Status::kOk);
        }
      },
      {});
  return compact_of(octree);
}

}  // namespace

TEST_CASE("key sort: any keys, scratch and number of threads -> what std::sort gives") {
  const std::uint64_t seed = std::random_device{}();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  for (int list = 0; list < kLists; ++list) {
    check_sorted<std::uint32_t>(random, pick_int(random, 3, 30));
    check_sorted<std::uint64_t>(random, pick_int(random, 3, 44));
  }
}

TEST_CASE("key sort: any voxels, repeats, materials and threads -> the tree that the octree gives") {
  const std::uint64_t seed = std::random_device{}();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  for (int world = 0; world < kWorlds; ++world) {
    CAPTURE(world);
    const Voxels source = random_world(random);
    tools::BuildOptions options;
    options.threads = pick_int(random, 1, 3);
    options.memory_bytes = std::uint64_t{8} << 20;
    const tools::BuiltScene built(source, options);
    const HeapBytes expected = tree_by_octree(source);
    REQUIRE(built.compact().size_bytes() == expected.view().size);
    CHECK(std::memcmp(built.compact().bytes(), expected.view().data, expected.view().size) == 0);
    // The least budget is enough, and gives the same tree.
    options.memory_bytes = built.least_budget_bytes();
    const tools::BuiltScene tight(source, options);
    REQUIRE(tight.compact().size_bytes() == expected.view().size);
    CHECK(std::memcmp(tight.compact().bytes(), expected.view().data, expected.view().size) == 0);
  }
}

TEST_CASE(
    "points in parts: any voxels, repeats, materials, threads and room for lists -> the tree that the octree "
    "gives") {
  const std::uint64_t seed = std::random_device{}();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  const tools::HostMemory memory(std::size_t{4} << 30);
  for (int world = 0; world < many_or_few(60, 5); ++world) {  // of up to 4,096 parts
    CAPTURE(world);
    const Voxels source = random_world(random, tools::kPartLevel + 1);
    const std::uint64_t lists = std::uint64_t{1} << pick(random, 10, 24);
    const int threads = static_cast<int>(pick(random, 1, 3));
    const auto place = static_cast<std::size_t>(pick(random, 0, 600) * 8);
    const Bytes tree =
        tools::build_point_tree(source, memory.bytes().subspan(place), threads, {}, lists).tree;
    const HeapBytes expected = tree_by_octree(source);
    CHECK(tree.empty() == (source.points() == 0));
    if (!tree.empty()) {
      REQUIRE(tree.size == expected.view().size);
      CHECK(std::memcmp(tree.data, expected.view().data, tree.size) == 0);
    }
    CHECK(tools::build_point_tree(source, memory.bytes().subspan(0, 4096), 1, {}, lists).tree.empty());
  }
}

TEST_CASE("points in parts: points that repeat -> no more memory than a grid of their part takes") {
  constexpr std::size_t kGridBytes = std::size_t{2} << 20;
  constexpr std::int32_t kSide = 30;
  tools::SourceFacts facts;
  facts.level = tools::kPartLevel + 1;
  facts.points = 4'000'000;
  facts.is_point_set = true;
  facts.single_material = true;
  const tools::SceneSource source(std::move(facts), [](const tools::VoxelSink& sink) {
    for (std::int32_t i = 0; i < 4'000'000; ++i) {
      const std::int32_t place = i % (kSide * kSide * kSide);
      sink(100 + place % kSide, 100 + place / kSide % kSide, 100 + place / kSide / kSide, 0);
    }
  });
  const tools::HostMemory memory(std::size_t{1} << 30);
  const tools::PointTree built = tools::build_point_tree(source, memory.bytes(), 2, {});
  CHECK(built.most_bytes < 2 * kGridBytes + 65536);
  CHECK(built.voxels == kSide * kSide * kSide);
  CompactTree tree;
  REQUIRE(CompactTree::open({built.tree.data, built.tree.size}, &tree) == Status::kOk);
  CHECK(CompactTree::validate({built.tree.data, built.tree.size}) == nullptr);
}

TEST_CASE("key sort: many points -> built within twice the bytes of their keys, whatever the threads") {
  const std::uint64_t kPoints = thimble::tests::many_or_few<std::uint64_t>(2'000'000, 500'000);
  for (const char* const name : {"points:", "cluster:"}) {
    tools::SceneArguments arguments;
    arguments.scene = name + std::to_string(kPoints);
    const auto source = tools::open_scene(arguments);
    std::vector<std::uint8_t> first;
    for (const int threads : {1, 2, 5}) {
      tools::BuildOptions options;
      options.threads = threads;
      const tools::BuiltScene built(*source, options);
      CHECK(built.high_water_bytes() <= 2 * 4 * kPoints);
      const std::uint8_t* const bytes = built.compact().bytes();
      if (first.empty()) {
        first.assign(bytes, bytes + built.compact().size_bytes());
      }
      REQUIRE(built.compact().size_bytes() == first.size());
      CHECK(std::equal(first.begin(), first.end(), bytes));
    }
  }
}

}  // namespace thimble::tests
