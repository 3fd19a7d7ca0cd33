// Frames in which faces cover many pixels: cameras that make ties, in scenes of every kind, give the bytes of
// render_band. THIMBLE_LONG draws 100 million pixels; THIMBLE_SEED begins elsewhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/picture/brick_render.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

std::uint64_t pixels_to_draw() {
  if (std::getenv("THIMBLE_LONG") != nullptr) {
    return 100'000'000;
  }
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
  return 100'000;
#else
  return 1'000'000;
#endif
}

enum class World { kHills, kBlocks, kDust, kRoom, kMerged, kTower };
constexpr World kWorlds[] = {World::kHills, World::kBlocks, World::kDust,
                             World::kRoom,  World::kMerged, World::kTower};

void fill_hills(std::mt19937_64& random, int side, Octree* pool) {
  const int steep = pick_int(random, 1, 3);
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      const int height = side / 4 + (x * steep + y * 2) % 7 + (x / 5 + y / 6) % 5;
      for (int z = std::max(0, height - 4); z < std::min(side, height); ++z) {
        REQUIRE(pool->insert({x, y, z}, static_cast<std::uint8_t>((x + y + z) % 5)) == Status::kOk);
      }
    }
  }
}

void fill(std::mt19937_64& random, World world, int level, Octree* pool) {
  const int side = 1 << level;
  const auto cell = [&] {
    return Vec3i{pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)};
  };
  const auto material = [&] { return static_cast<std::uint8_t>(pick_int(random, 0, 9)); };
  switch (world) {
    case World::kHills:
      fill_hills(random, side, pool);
      return;
    case World::kBlocks:
    case World::kMerged:
      for (int i = 0; i < 40; ++i) {
        const int block = pick_int(random, 0, level - 2);
        const Vec3i at = cell();
        const int mask = ~((1 << block) - 1);
        REQUIRE(pool->insert_block({at.x & mask, at.y & mask, at.z & mask}, block, material()) ==
                Status::kOk);
      }
      for (int i = 0; i < 200; ++i) {
        REQUIRE(pool->insert(cell(), material()) == Status::kOk);
      }
      if (world == World::kMerged) {
        REQUIRE(pool->coarsen_to(pool->nodes_used() / 2) == Status::kOk);
      }
      return;
    case World::kDust:
      for (int i = 0; i < 300; ++i) {
        REQUIRE(pool->insert(cell(), material()) == Status::kOk);
      }
      return;
    case World::kRoom:
    case World::kTower:  // walls all round, or a wall of single steps
      for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
          const Vec3i voxels[] = {{i, j, 0}, {i, 0, j}, {0, i, j}, {i, j, side - 1}, {side - 1, i, j}};
          const int count = world == World::kRoom ? 5 : 2;
          for (int n = 0; n < count; ++n) {
            REQUIRE(pool->insert(voxels[n], material()) == Status::kOk);
          }
        }
        REQUIRE(pool->insert({i, i, i / 2}, material()) == Status::kOk);
      }
      return;
  }
}

struct Scene {
  HeapBytes tree_bytes;
  std::vector<std::uint64_t> map_words;
  CompactTree tree;
  BrickMap map;
};

Scene make_scene(std::mt19937_64& random, World world, int level) {
  std::vector<std::uint8_t> pool_bytes(Octree::octree_bytes(100000));
  Octree pool;
  REQUIRE(Octree::make(level, {pool_bytes.data(), pool_bytes.size()}, &pool) == Status::kOk);
  fill(random, world, level, &pool);
  Scene scene{compact_of(pool, kMinRankShift), {}, {}, {}};
  scene.tree = open_or_throw(scene.tree_bytes);
  scene.map_words.resize(most_brick_map_bytes(level) / 8 + 1);
  const Bytes room(static_cast<std::uint8_t*>(static_cast<void*>(scene.map_words.data())),
                   8 * scene.map_words.size());
  REQUIRE(BrickMap::make(scene.tree, room, &scene.map) == Status::kOk);
  return scene;
}

/// On lattice points and beside them, on diagonals, inside solids, outside; 1 to 120 degrees.
Camera hard_camera(std::mt19937_64& random, int level) {
  const int side = 1 << level;
  const int side_q8 = 256 * side;
  for (;;) {
    const int place = pick_int(random, 0, 5);
    Vec3Q8 eye;
    for (int axis = 0; axis < 3; ++axis) {
      const int raw = place == 0   ? pick_int(random, -side_q8 / 2, side_q8 + side_q8 / 2)
                      : place == 1 ? 256 * pick_int(random, 0, side)
                      : place == 2 ? 256 * pick_int(random, 0, side) + pick_int(random, -1, 1)
                      : place == 3 ? 256 * pick_int(random, -side / 4, side + side / 4) + 128
                                   : pick_int(random, 0, side_q8);
      eye[axis] = Q8::from_raw(raw);
    }
    Vec3i forward;
    const int look = pick_int(random, 0, 2);
    for (int axis = 0; axis < 3; ++axis) {
      forward[axis] = look == 0   ? pick_int(random, -1, 1)
                      : look == 1 ? pick_int(random, -1000, 1000)
                                  : pick_int(random, 0, side_q8) - eye[axis].raw;
    }
    const Q16 fov = Q16::from_raw(pick_int(random, 0, 2) == 0 ? pick_int(random, 65536, 8 * 65536)
                                                              : pick_int(random, 20 * 65536, 120 * 65536));
    const int width = pick_int(random, 0, 2) == 0 ? 320 : pick_int(random, 1, 250);
    const int height = width == 320 ? pick_int(random, 1, 80) : pick_int(random, 1, 120);
    const int bits = pick_int(random, 0, 3) == 0 ? pick_int(random, kMinDirectionBits, 15) : 0;
    Camera camera;
    if (pick_int(random, 0, 15) == 0) {
      const OrthographicView view{eye,   forward, {}, Q14::saturate(pick_int(random, 1, 2 * side)),
                                  width, height,  0};
      if (camera.set(view, level) == Status::kOk) {
        return camera;
      }
    } else if (camera.set(PerspectiveView{eye, forward, {}, fov, width, height, bits}, level) ==
               Status::kOk) {
      return camera;
    }
  }
}

using Draw = Status (*)(const Scene& scene, const Camera& camera, const Shading& shading, const Band& band,
                        RenderCounts* counts);

std::vector<std::uint8_t> drawn(const Scene& scene, const Camera& camera, const Shading& shading,
                                PixelFormat format, std::size_t stride, int rows, Draw draw,
                                RenderCounts* counts) {
  const int height = camera.height_px();
  std::vector<std::uint8_t> bytes(stride * static_cast<std::size_t>(height), 0x5A);
  for (int y = 0; y < height; y += rows) {
    const int count = std::min(rows, height - y);
    Band band{{bytes.data() + stride * static_cast<std::size_t>(y), stride * static_cast<std::size_t>(count)},
              format,
              stride,
              y,
              count};
    REQUIRE(draw(scene, camera, shading, band, counts) == Status::kOk);
  }
  return bytes;
}

TEST_CASE("brick sweep: a million pixels of hard cameras -> the bytes and hits of render_band, none wrong") {
  const char* text = std::getenv("THIMBLE_SEED");
  std::mt19937_64 random(text != nullptr ? std::strtoull(text, nullptr, 10) : 20260401);
  std::vector<Rgb8> palette(10);
  for (Rgb8& color : palette) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  const std::uint64_t wanted_pixels = pixels_to_draw();
  std::uint64_t pixels = 0;
  std::uint64_t fast = 0;
  std::uint64_t hits = 0;
  for (unsigned turn = 0; pixels < wanted_pixels; ++turn) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 3, 6);
    const Scene scene = make_scene(own, kWorlds[turn % 6], level);
    for (int view = 0; view < 6; ++view) {
      CAPTURE(view);
      const Camera camera = hard_camera(own, level);
      Shading shading;
      shading.mode = pick_int(own, 0, 5) == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
      shading.palette = {palette.data(), palette.size()};
      shading.far_q8 = 256 << level;
      const PixelFormat format = static_cast<PixelFormat>(pick_int(own, 0, 4));
      const std::size_t stride =
          row_bytes(format, camera.width_px()) + static_cast<std::size_t>(pick_int(own, 0, 3));
      RenderCounts counts;
      RenderCounts counts_wanted;
      const auto wanted = drawn(
          scene, camera, shading, format, stride, camera.height_px(),
          [](const Scene& of, const Camera& by, const Shading& with, const Band& band, RenderCounts* sum) {
            return render_band(of.tree, by, with, band, sum);
          },
          &counts_wanted);
      const auto got = drawn(
          scene, camera, shading, format, stride,
          pick_int(own, 0, 1) == 0 ? camera.height_px() : pick_int(own, 1, 20),
          [](const Scene& of, const Camera& by, const Shading& with, const Band& band, RenderCounts* sum) {
            return render_band(of.tree, of.map, by, with, band, sum);
          },
          &counts);
      REQUIRE(got == wanted);  // the gaps between rows too
      REQUIRE(counts.hits == counts_wanted.hits);
      const auto area =
          static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
      pixels += area;
      fast += draws_fast(scene.map, camera) ? area : 0;
      hits += counts.hits;
    }
  }
  CHECK(fast > wanted_pixels / 2);
  CHECK(hits > wanted_pixels / 10);
}

TEST_CASE("brick sweep: pictures of every size that displays have take the fast way from inside the world") {
  std::mt19937_64 random(3);
  const Scene scene = make_scene(random, World::kHills, 6);
  const Vec3Q8 eye{Q8::from_raw(20 * 256), Q8::from_raw(9 * 256 + 7), Q8::from_raw(40 * 256)};
  const struct {
    int width;
    int height;
  } kSizes[] = {{128, 64}, {160, 128}, {240, 240}, {320, 240}, {640, 480}, {800, 600}};
  for (const auto& size : kSizes) {
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, {3, 5, -2}, {}, Q16::saturate(60), size.width, size.height, 0},
                       6) == Status::kOk);
    CAPTURE(size.width);
    CHECK(draws_fast(scene.map, camera));
  }
}

}  // namespace
