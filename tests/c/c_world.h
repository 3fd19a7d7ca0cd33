/// A baked scene with everything that one can hold, for the tests of the C face: several materials, palette,
/// camera, brick map, name, light of every kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "support/scene_under_test.h"
#include "support/small_scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/thimble_c.h"

namespace thimble::tests {

constexpr int kWorldLevel = 5;

/// Not to be moved: scene and handles point into it.
class CWorld {
 public:
  explicit CWorld(std::uint64_t salt = 0, bool with_extras = true) {
    fill(octree, salt);
    tree_ = compact_of(octree);
    compact = open_or_throw(tree_);
    bake(with_extras);
  }
  CWorld(const CWorld&) = delete;
  CWorld& operator=(const CWorld&) = delete;

  /// The bytes, which start at a multiple of 8.
  ConstBytes bytes() const { return bytes_.view(); }
  thimble_scene_t opened() const {
    thimble_scene_t handle = {};
    REQUIRE(thimble_scene_open(&handle, bytes().data, bytes().size) == THIMBLE_OK);
    return handle;
  }

  /// A floor, three balls that overlap, and single voxels, in five materials. The same with both faces.
  template <class Tree>
  static void fill(Tree& tree, std::uint64_t salt) {
    for (std::int32_t z = 0; z < 32; ++z) {
      for (std::int32_t y = 0; y < 32; ++y) {
        for (std::int32_t x = 0; x < 32; ++x) {
          const int material = material_of(x, y, z, salt);
          if (material >= 0) {
            put(tree, x, y, z, material);
          }
        }
      }
    }
  }
  static int material_of(std::int32_t x, std::int32_t y, std::int32_t z, std::uint64_t salt) {
    const auto in_ball = [&](std::int32_t cx, std::int32_t cy, std::int32_t cz, std::int32_t radius) {
      return (x - cx) * (x - cx) + (y - cy) * (y - cy) + (z - cz) * (z - cz) < radius * radius;
    };
    if (in_ball(11, 12, 9 + static_cast<std::int32_t>(salt % 3), 7)) {
      return 1;
    }
    if (in_ball(20, 19, 10, 6)) {
      return 2;
    }
    if (in_ball(19, 8, 17, 5)) {
      return 3;
    }
    return z < 2 ? 0 : (x * 7 + y * 5 + z * 3) % 97 == 0 ? 4 : -1;
  }

  OwnedPool pool{kWorldLevel};
  Octree& octree = pool.octree;
  CompactTree compact;
  BakedScene scene;
  BakedLighting lighting;

 private:
  static void put(Octree& tree, std::int32_t x, std::int32_t y, std::int32_t z, int material) {
    REQUIRE(tree.insert({x, y, z}, static_cast<std::uint8_t>(material)) == Status::kOk);
  }
  static void put(thimble_octree_t& tree, std::int32_t x, std::int32_t y, std::int32_t z, int material) {
    REQUIRE(thimble_octree_insert(&tree, x, y, z, material) == THIMBLE_OK);
  }

  void bake(bool with_extras) {
    static constexpr Rgb8 kColors[] = {{120, 110, 90}, {230, 40, 30}, {40, 200, 60}, {40, 80, 240}};
    static constexpr char kName[] = "a world";
    const std::vector<std::uint8_t> section = lighting_of_all_effects(kWorldLevel);
    const HeapBytes map = map_of(compact);
    SceneCamera camera;
    camera.eye = {Q8::from_raw(-3000), Q8::from_raw(-5100), Q8::from_raw(7900)};
    camera.target = {Q8::from_raw(4096), Q8::from_raw(4096), Q8::from_raw(2300)};
    camera.fov_degrees = Q16::saturate(45);

    BakedParts parts;
    parts.tree = {compact.bytes(), compact.size_bytes()};
    if (with_extras) {
      parts.palette = Span<const Rgb8>(kColors);
      parts.camera = &camera;
      parts.brick_map = map.view();
      parts.name = {reinterpret_cast<const std::uint8_t*>(kName), sizeof kName - 1};
      parts.lighting = {section.data(), section.size()};
    }
    bytes_ = HeapBytes(baked_bytes(parts));
    REQUIRE(BakedScene::make(parts, bytes_.span(), &scene) == Status::kOk);
    if (with_extras) {
      REQUIRE(BakedLighting::open(scene.section(SectionKind::kLighting), kWorldLevel, &lighting) ==
              Status::kOk);
    }
  }

  HeapBytes tree_;
  HeapBytes bytes_;
};

}  // namespace thimble::tests
