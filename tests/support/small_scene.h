/// The least scene that has all that brick maps tell apart: for tests that change each bit of it, and as what the fuzz
/// targets start from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {

/// A lighting section with each kind of surface, lamp and suns, water, fog and every effect, for worlds of 8 and more a side.
/// Empty where it is refused.
inline std::vector<std::uint8_t> lighting_of_all_effects(int level) {
  Surface surfaces[5] = {};
  surfaces[1].kind = SurfaceKind::kGlass;
  surfaces[1].density_q8 = 20;
  surfaces[2].kind = SurfaceKind::kMetal;
  surfaces[2].mirror = 200;
  surfaces[3].kind = SurfaceKind::kEmit;
  surfaces[3].emission_q8 = 400;
  surfaces[4].kind = SurfaceKind::kMedia;
  surfaces[4].density_q8 = 60;
  Light lights[2];
  lights[0].place = Vec3i{-3, -5, 9};
  lights[1].is_point = true;
  lights[1].place = Vec3i{4 * 256, 2 * 256, 6 * 256};
  lights[1].reach = 4;
  BakedLighting lit;
  lit.scene.surfaces = Span<const Surface>(surfaces);
  lit.scene.lights = Span<const Light>(lights);
  lit.scene.has_shadows = true;
  lit.scene.has_sky = true;
  lit.scene.has_water = true;
  lit.scene.water = still_water({4, 0, 1}, 4, 4, 300);
  lit.scene.fog.density_q16 = 300;
  lit.scene.occlusion = {4, 128, 3};
  lit.scene.bounces = 2;
  lit.effects = effects_of(lit.scene) | Effect::kShadows | Effect::kMirror | Effect::kGlass | Effect::kMedia |
                Effect::kWater | Effect::kSmoothNormals;
  std::vector<std::uint8_t> bytes(lighting_bytes(lit.scene));
  return BakedLighting::make(lit, level, {bytes.data(), bytes.size()}) == Status::kOk
             ? bytes
             : std::vector<std::uint8_t>();
}

/// Of level 5 or more, so with a map of version 1 or 2: stairs of three materials in a mixed brick and one that is not, a
/// solid brick, one voxel of it merged, a voxel on a page of its own, a palette, a name, a camera that sees them, and light up
/// to level 8. Empty where something is refused.
inline std::vector<std::uint8_t> small_scene(int level) {
  std::vector<std::uint8_t> pool(Octree::octree_bytes(100));
  Octree octree;
  bool is_made = Octree::make(level, {pool.data(), pool.size()}, &octree) == Status::kOk;
  for (int x = 0; x < 6; ++x) {
    is_made = is_made && octree.insert({x, x / 2, 0}, static_cast<std::uint8_t>(x / 2)) == Status::kOk;
  }
  is_made = is_made && octree.insert_block({8, 4, 0}, 2, 1) == Status::kOk &&
            octree.remove({8, 4, 0}) == Status::kOk && octree.insert({20, 3, 5}, 3) == Status::kOk &&
            octree.coarsen_to(octree.nodes_used() - 1) == Status::kOk;
  std::vector<std::uint8_t> tree_bytes(compact_bytes(compact_shape(octree)));
  CompactTree tree;
  is_made =
      is_made && CompactTree::make(octree, {tree_bytes.data(), tree_bytes.size()}, &tree) == Status::kOk;
  std::vector<std::uint8_t> map(most_brick_map_bytes(tree));
  std::size_t map_size = 0;
  is_made = is_made && BrickMap::make(tree, {map.data(), map.size()}, nullptr, &map_size) == Status::kOk;

  SceneCamera camera;
  camera.eye = {Q8::saturate(10), Q8::saturate(-9), Q8::saturate(8)};
  camera.forward = {0, 12, -6};
  camera.fov_degrees = Q16::saturate(80);
  constexpr Rgb8 kPalette[] = {{180, 170, 160}, {200, 240, 230}, {230, 220, 200}, {255, 200, 90}};
  constexpr std::uint8_t kName[] = {'s', 'm', 'a', 'l', 'l'};
  BakedParts parts;
  parts.tree = {tree_bytes.data(), tree_bytes.size()};
  parts.palette = Span<const Rgb8>(kPalette);
  parts.name = {kName, sizeof kName};
  parts.camera = &camera;
  parts.brick_map = {map.data(), map_size};
  std::vector<std::uint8_t> lighting;
  if (level <= 8) {
    lighting = lighting_of_all_effects(level);
    is_made = is_made && !lighting.empty();
    parts.lighting = {lighting.data(), lighting.size()};
  }
  std::vector<std::uint8_t> scene(is_made ? baked_bytes(parts) : 0);
  is_made = is_made && BakedScene::make(parts, {scene.data(), scene.size()}, nullptr) == Status::kOk;
  return is_made ? scene : std::vector<std::uint8_t>();
}

/// What a fuzzer hands over: as it is or, where it begins with a C or a D, changes of three bytes (two that say where, and
/// the new byte) to the first of `sounds` or the second, which no search would find.
inline std::vector<std::uint8_t> given_or_changed(ConstBytes input, const ConstBytes (&sounds)[2]) {
  const int which = input.empty() ? -1 : input[0] - 'C';
  if ((which != 0 && which != 1) || sounds[which].empty()) {
    return {input.begin(), input.end()};
  }
  const ConstBytes sound = sounds[which];
  std::vector<std::uint8_t> bytes(sound.begin(), sound.end());
  for (std::size_t at = 1; at + 2 < input.size; at += 3) {
    bytes[(input[at] | std::size_t{input[at + 1]} << 8) % bytes.size()] = input[at + 2];
  }
  return bytes;
}

}  // namespace thimble::tests
