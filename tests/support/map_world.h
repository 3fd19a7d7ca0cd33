/// A small world with a brick map, and its picture in both ways: by the map and by the tree.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/lit_world.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/brick_map.h"

namespace thimble::testing {

struct MapWorld : LitWorld {
  explicit MapWorld(int level = 5) : LitWorld(level) {
    scene.has_shadows = true;
    shading.background = {30, 60, 90};
    lights = {sun({-5, -9, 16})};
  }
  void map_it() {
    finish();
    map_bytes = tests::map_of(tree);
    REQUIRE(BrickMap::open(map_bytes.view(), &map) == Status::kOk);
  }

  tests::HeapBytes map_bytes;
  BrickMap map;
  LitOptions options;
};

/// What was counted for a picture.
struct BothCounts {
  LitCounts by_map;
  LitCounts by_tree;
};

/// Holds that both pictures are the same, that by the map uncounted and in bands of 1 to 7 rows as well (or as few as share
/// bytes), for a set that is known when running, and that both sent the same rays of the camera.
template <EffectSet kSet>
BothCounts draw_both(const MapWorld& world, PixelFormat format = PixelFormat::kRgb888, std::size_t offset = 0,
                     Span<const SunBricks> suns = {}) {
  const Camera& camera = world.camera;
  REQUIRE(draws_fast(world.map, camera));
  const std::size_t size = band_bytes(format, camera.width_px(), camera.height_px());
  std::vector<std::uint8_t> fast(size + offset, 0x5A);
  std::vector<std::uint8_t> right(size + offset, 0x5A);
  BothCounts counts;
  REQUIRE(render_lit_band<kSet>(world.tree, camera, world.shading, world.scene,
                                {{right.data() + offset, size}, format, 0, 0, camera.height_px()},
                                &counts.by_tree, world.options) == Status::kOk);
  for (LitCounts* const counted : {static_cast<LitCounts*>(nullptr), &counts.by_map}) {
    std::fill(fast.begin(), fast.end(), std::uint8_t{0x5A});
    REQUIRE(render_lit_band<kSet>(world.tree, world.map, camera, world.shading, world.scene, suns,
                                  {{fast.data() + offset, size}, format, 0, 0, camera.height_px()}, counted,
                                  world.options) == Status::kOk);
    REQUIRE(fast == right);
  }
  std::vector<std::uint8_t> parts(size + offset, 0x5A);
  const std::int32_t together = band_row_multiple(format);
  for (std::int32_t row = 0, turn = 1; row < camera.height_px(); ++turn) {
    const std::int32_t wanted = together * (turn * turn % 7 + 1);
    const std::int32_t rows = wanted < camera.height_px() - row ? wanted : camera.height_px() - row;
    const std::size_t at = offset + band_bytes(format, camera.width_px(), row);
    REQUIRE(render_lit_band(
                kSet, world.tree, world.map, camera, world.shading, world.scene, suns,
                {{parts.data() + at, band_bytes(format, camera.width_px(), rows)}, format, 0, row, rows},
                nullptr, world.options) == Status::kOk);
    row += rows;
  }
  REQUIRE(parts == right);
  constexpr int kPrimary = static_cast<int>(LitRayKind::kPrimary);
  REQUIRE(counts.by_map.rays[kPrimary] == counts.by_tree.rays[kPrimary]);
  return counts;
}

}  // namespace thimble::testing
