// Frames by bricks where they end: cameras that are not narrow, arguments that contradict the picture, small buffers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

TEST_CASE("brick frames: arguments that contradict the picture -> a status, and not a byte is written") {
  std::mt19937_64 random(11);
  const ChipScene scene = make_chip_scene(random, ChipWorld::kBlocks, 5);
  const ChipScene other = make_chip_scene(random, ChipWorld::kBlocks, 5);
  const CompactTree& tree = scene.tree;
  const BrickMap& map = scene.map;
  Camera camera;
  const Vec3Q8 eye{Q8::from_raw(-3000), Q8::from_raw(-2000), Q8::from_raw(9000)};
  REQUIRE(camera.set(PerspectiveView{eye, {3, 3, -2}, {}, Q16::saturate(60), 21, 16, 0}, 5) == Status::kOk);
  REQUIRE(draws_fast(map, camera));
  const Shading shading;
  std::vector<std::uint8_t> pixels(11 * 16, 0x5A);
  const std::vector<std::uint8_t> before = pixels;
  Band band;
  band.format = PixelFormat::kGray4;
  band.rows = 16;
  band.pixels = {pixels.data(), pixels.size() - 1};
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.pixels.size = pixels.size();
  band.stride_bytes = 10;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.stride_bytes = 12;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.stride_bytes = 0;
  band.first_row = 1;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.first_row = 0;
  CHECK(render_band(other.tree, map, camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, BrickMap(), camera, shading, band) == Status::kDamaged);
  CHECK(render_band_32(other.tree, map, camera, shading, band) == Status::kDamaged);
  CHECK(render_band_32(tree, BrickMap(), camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, map, Camera(), shading, band) == Status::kBadArgument);
  CHECK(pixels == before);
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOk);
  CHECK(pixels != before);
}

TEST_CASE(
    "brick map: too few bytes, wrong levels, odd addresses -> a status, and the least that works is known") {
  std::mt19937_64 random(5);
  for (const ChipWorld world : kChipWorlds) {
    const ChipScene scene = make_chip_scene(random, world, 5);
    const CompactTree& tree = scene.tree;
    BrickMap map = scene.map;
    const std::size_t size = map.size_bytes();
    const HeapBytes map_bytes(size);
    std::memcpy(map_bytes.span().data, scene.map_words.data(), size);
    CHECK(size == brick_map_bytes(static_cast<std::uint32_t>((map.box().high.x - map.box().low.x) *
                                                             (map.box().high.y - map.box().low.y) *
                                                             (map.box().high.z - map.box().low.z)),
                                  map.brick_count(), map.mixed_count()));
    std::size_t written = 0;
    // Exactly as many bytes on the heap: the sanitizer sees the first beyond.
    for (std::size_t less = 0; less <= size; less += 1 + less / 2) {
      const HeapBytes room(size - less);
      CHECK(BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOutOfMemory);
      BrickMap none;
      if (less != 0) {
        CHECK(BrickMap::open({map_bytes.view().data, size - less}, &none) == Status::kDamaged);
      }
    }
    bool built = false;
    for (std::size_t more = 0; !built && more < 100000; more += 64) {
      const HeapBytes room(size + more);
      built = BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOk;
      if (built) {
        CHECK(written == size);
        CHECK(std::equal(map_bytes.view().begin(), map_bytes.view().end(), room.view().data));
      }
    }
    CHECK(built);
    const HeapBytes shifted(size, 4);
    CHECK(BrickMap::open(shifted.view(), &map) == Status::kBadArgument);
    CHECK(BrickMap::make(tree, shifted.span(), nullptr, &written) == Status::kBadArgument);
  }
  const HeapBytes room(most_brick_map_bytes(2));
  std::size_t written = 0;
  CHECK(BrickMap::make(CompactTree(), room.span(), nullptr, &written) == Status::kOutOfRange);
}

}  // namespace
