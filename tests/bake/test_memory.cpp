// Memory: the arena; the way from voxels to pixels without a call of the global allocator; and one arena of every size for
// pool, tree and band.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "support/allocation_trap.h"
#include "support/scene_under_test.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr std::uint8_t kGuard = 0xC3;
constexpr std::size_t kGuardBytes = 64;

// A budget of bytes with guard bytes on both sides.
class Guarded {
 public:
  explicit Guarded(std::size_t size, std::size_t offset = 0)
      : storage_(size + offset + 2 * kGuardBytes, kGuard), first_(kGuardBytes + offset), size_(size) {}
  Bytes span() { return {storage_.data() + first_, size_}; }
  bool intact() const {
    const auto is_guard = [](std::uint8_t byte) { return byte == kGuard; };
    const auto begin = storage_.begin();
    return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(first_), is_guard) &&
           std::all_of(begin + static_cast<std::ptrdiff_t>(first_ + size_), storage_.end(), is_guard);
  }

 private:
  std::vector<std::uint8_t> storage_;
  std::size_t first_;
  std::size_t size_;
};

// A small scene: a slanted sheet of two materials and a block. Fixed arrays only.
constexpr int kLevel = 4;
constexpr int kSide = 1 << kLevel;
constexpr std::size_t kSheet = 96;

Vec3i sheet_voxel(std::size_t i) {
  const int n = static_cast<int>(i);
  return {n % kSide, (n * 7 / kSide) % kSide, (n * 5 + n / 9) % kSide};
}
std::uint8_t sheet_material(std::size_t i) {
  return static_cast<std::uint8_t>(i % 3 == 0 ? 2 : 1);
}

Status build(Octree& tree) {
  for (std::size_t i = 0; i < kSheet; ++i) {
    const Status status = tree.insert(sheet_voxel(i), sheet_material(i));
    if (status != Status::kOk) {
      return status;
    }
  }
  return tree.insert_block({8, 8, 4}, 2, 5);
}

Camera small_camera() {
  PerspectiveView view;
  view.eye = {Q8::saturate(-14), Q8::saturate(-9), Q8::saturate(25)};
  view.forward = look_at(view.eye, {Q8::saturate(8), Q8::saturate(8), Q8::saturate(8)});
  view.width_px = 40;
  view.height_px = 30;
  Camera camera;
  REQUIRE(camera.set(view, kLevel) == Status::kOk);
  return camera;
}

}  // namespace

TEST_CASE("memory: build, compact, render, sort with the global allocator trapped -> no call") {
  static std::array<std::uint8_t, 32768> pool_bytes;
  static std::array<std::uint8_t, 8192> tree_bytes;
  static std::array<std::uint8_t, 8192> keys_bytes;
  static std::array<std::uint8_t, 512> grid_bytes;
  static std::array<std::uint8_t, 40 * 30 * 3> pixels;
  static std::array<std::uint64_t, kSheet> keys;
  const Camera camera = small_camera();
  Status statuses[24] = {};
  std::size_t calls = 0;
  set_allocation_trap();
  const auto note = [&](Status status) { statuses[calls++] = status; };
  {
    Octree pool;
    note(Octree::make(kLevel, {pool_bytes.data(), pool_bytes.size()}, &pool));
    note(build(pool));
    std::size_t written = 0;
    note(CompactTree::make(pool, {tree_bytes.data(), tree_bytes.size()}, nullptr, &written));
    CompactTree tree;
    note(CompactTree::open({tree_bytes.data(), written}, &tree));
    note(CompactTree::validate({tree_bytes.data(), written}) == nullptr ? Status::kOk : Status::kDamaged);
    for (std::size_t i = 0; i < kSheet; ++i) {
      const Vec3i voxel = sheet_voxel(i);
      keys[i] = morton_code(static_cast<std::uint32_t>(voxel.x), static_cast<std::uint32_t>(voxel.y),
                            static_cast<std::uint32_t>(voxel.z))
                    << 8 |
                sheet_material(i);
    }
    sort_keys(Span<std::uint64_t>{keys.data(), keys.size()}, 3 * kLevel + 8);
    const std::size_t count = unique_keys(Span<std::uint64_t>{keys.data(), keys.size()});
    note(CompactTree::make(Span<const std::uint64_t>{keys.data(), count}, kLevel,
                           {keys_bytes.data(), keys_bytes.size()}, nullptr, &written));
    DenseGrid grid;
    note(DenseGrid::make({kSide, kSide, kSide}, {grid_bytes.data(), grid_bytes.size()}, &grid));
    for (std::size_t i = 0; i < kSheet; ++i) {
      static_cast<void>(grid.set(sheet_voxel(i)));
    }
    Shading shading;
    for (const ShadeMode mode :
         {ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor, ShadeMode::kMono}) {
      shading.mode = mode;
      const Band band{{pixels.data(), pixels.size()}, PixelFormat::kRgb888, 0, 0, 30};
      note(render_band(tree, camera, shading, band));
      note(render_band(pool, camera, shading, band));
      note(render_band(grid, camera, shading, band));
    }
    pool.set_coarsen(true);
    note(pool.coarsen_to(10));
    note(pool.remove({8, 8, 4}));
  }
  CHECK(clear_allocation_trap() == 0);
  for (std::size_t i = 0; i < calls; ++i) {
    CHECK_MESSAGE(statuses[i] == Status::kOk, i, status_text(statuses[i]));
  }
  // The trap does catch.
  set_allocation_trap();
  std::vector<int> some(3);
  some.clear();
  some.shrink_to_fit();
  CHECK(clear_allocation_trap() == 2);
}

TEST_CASE(
    "memory: one arena for pool, compact tree and band, every size -> the status of the part that lacks "
    "room") {
  const Camera camera = small_camera();
  const Shading shading;
  Guarded plenty(65536);
  Octree full;
  REQUIRE(Octree::make(kLevel, plenty.span(), &full) == Status::kOk);
  REQUIRE(build(full) == Status::kOk);
  const std::size_t pool_size = Octree::octree_bytes(full.nodes_high_water());
  const std::size_t tree_size = compact_bytes(compact_shape(full));
  const std::size_t band_size = band_bytes(PixelFormat::kGray8, camera.width_px(), 2);
  const std::size_t enough = pool_size + tree_size + band_size;
  std::vector<std::uint8_t> expected(band_size);
  REQUIRE(render_band(full, camera, shading, {{expected.data(), band_size}, PixelFormat::kGray8, 0, 12, 2}) ==
          Status::kOk);
  for (std::size_t size = 0; size <= enough + 2; ++size) {
    Guarded bytes(size, size % 8);
    Arena arena(bytes.span());
    Octree pool;
    const Bytes pool_bytes = arena.take(std::min(pool_size, size), 1);
    REQUIRE(Octree::make(kLevel, pool_bytes, &pool) == Status::kOk);
    const Status built = build(pool);
    REQUIRE((built == Status::kOk || built == Status::kOutOfMemory));
    REQUIRE((built == Status::kOk || size < pool_size));
    std::size_t written = 0;
    const Bytes rest = arena.rest();
    Status status = CompactTree::make(pool, rest, nullptr, &written);
    REQUIRE(status == (rest.size < compact_bytes(compact_shape(pool)) ? Status::kOutOfMemory : Status::kOk));
    if (status == Status::kOk) {
      const Bytes tree_bytes = arena.take(written, 1);
      CompactTree tree;
      REQUIRE(CompactTree::open(tree_bytes, &tree) == Status::kOk);
      const Band band{arena.rest(), PixelFormat::kGray8, 0, 12, 2};
      status = render_band(tree, camera, shading, band);
      REQUIRE(status == (arena.free_bytes() < band_size ? Status::kOutOfMemory : Status::kOk));
      if (status == Status::kOk && built == Status::kOk) {
        REQUIRE(std::equal(expected.begin(), expected.end(), band.pixels.begin()));
      }
      // What was drawn or refused left the tree alone.
      REQUIRE(CompactTree::validate(tree_bytes) == nullptr);
    }
    REQUIRE(bytes.intact());
    REQUIRE((status == Status::kOk) == (size >= enough));
  }
}
