/// A baked scene with everything that one can hold, for the tests of the C face: several materials, palette,
/// camera, brick map, name, light of every kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"
#include "thimble/thimble_c.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {

constexpr int kWorldLevel = 5;

/// Not to be moved: scene and handles point into it.
class CWorld {
 public:
  explicit CWorld(std::uint64_t salt = 0, bool with_extras = true) {
    pool_.resize(Octree::octree_bytes(20000));
    REQUIRE(Octree::make(kWorldLevel, {pool_.data(), pool_.size()}, &octree) == Status::kOk);
    fill(octree, salt);
    tree_.resize(compact_bytes(compact_shape(octree)));
    REQUIRE(CompactTree::make(octree, {tree_.data(), tree_.size()}, &compact) == Status::kOk);
    bake(with_extras);
  }
  CWorld(const CWorld&) = delete;
  CWorld& operator=(const CWorld&) = delete;

  /// The bytes, which start at a multiple of 8.
  ConstBytes bytes() const { return {reinterpret_cast<const std::uint8_t*>(words_.data()), size_}; }

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

  Octree octree;
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
    const Surface surfaces[] = {{kColors[0], SurfaceKind::kDiffuse, 0, 255, 5325, 64, 256},
                                {kColors[1], SurfaceKind::kMetal, 40, 200, 5325, 64, 256},
                                {kColors[2], SurfaceKind::kGlass, 0, 255, 6144, 64, 256},
                                {kColors[3], SurfaceKind::kMedia, 0, 255, 5325, 300, 256},
                                {{255, 240, 200}, SurfaceKind::kEmit, 0, 255, 5325, 64, 512}};
    Light lights[2];
    lights[1].is_point = true;
    lights[1].place = PackedVec3i(16 * 256, 16 * 256, 28 * 256);
    lights[1].reach = 12;
    BakedLighting lit;
    lit.scene.surfaces = Span<const Surface>(surfaces);
    lit.scene.lights = Span<const Light>(lights);
    lit.scene.has_shadows = true;
    lit.scene.has_sky = true;
    lit.scene.fog.density_q16 = 900;
    lit.scene.occlusion.rays = 4;
    lit.scene.has_water = true;
    lit.scene.water = still_water({0, 0, 2}, 32, 12, 3 * 256);
    lit.effects = effects_of(lit.scene);
    std::vector<std::uint8_t> section(lighting_bytes(lit.scene));
    REQUIRE(BakedLighting::make(lit, kWorldLevel, {section.data(), section.size()}) == Status::kOk);

    std::vector<std::uint64_t> map(most_brick_map_bytes(kWorldLevel) / 8 + 1);
    std::size_t map_size = 0;
    REQUIRE(BrickMap::make(compact, {reinterpret_cast<std::uint8_t*>(map.data()), map.size() * 8}, nullptr,
                           &map_size) == Status::kOk);
    SceneCamera camera;
    camera.eye = {Q8::from_raw(-3000), Q8::from_raw(-5100), Q8::from_raw(7900)};
    camera.target = {Q8::from_raw(4096), Q8::from_raw(4096), Q8::from_raw(2300)};
    camera.fov_degrees = Q16::saturate(45);

    BakedParts parts;
    parts.tree = {compact.bytes(), compact.size_bytes()};
    if (with_extras) {
      parts.palette = Span<const Rgb8>(kColors);
      parts.camera = &camera;
      parts.brick_map = {reinterpret_cast<const std::uint8_t*>(map.data()), map_size};
      parts.name = {reinterpret_cast<const std::uint8_t*>(kName), sizeof kName - 1};
      parts.lighting = {section.data(), section.size()};
    }
    size_ = baked_bytes(parts);
    words_.resize(size_ / 8 + 1);
    REQUIRE(BakedScene::make(parts, {reinterpret_cast<std::uint8_t*>(words_.data()), size_}, &scene) ==
            Status::kOk);
    if (with_extras) {
      REQUIRE(BakedLighting::open(scene.section(SectionKind::kLighting), kWorldLevel, &lighting) ==
              Status::kOk);
    }
  }

  std::vector<std::uint8_t> pool_;
  std::vector<std::uint8_t> tree_;
  std::vector<std::uint64_t> words_;
  std::size_t size_ = 0;
};

}  // namespace thimble::tests
