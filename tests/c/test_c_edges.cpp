// The C face where one thing stands for another: a stored orthographic camera, a camera of another world, a
// pool that is said to have bytes and has none.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "c/c_world.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/thimble_c.h"

namespace thimble::tests::c_edges {
namespace {

TEST_CASE("C face: a scene with an orthographic camera -> its view, member by member, and the same rays") {
  const CWorld world;
  SceneCamera camera;
  camera.is_perspective = false;
  camera.direction_bits = 12;
  camera.eye = {Q8::from_raw(-700), Q8::from_raw(900), Q8::from_raw(5000)};
  camera.target = {Q8::from_raw(4000), Q8::from_raw(4001), Q8::from_raw(2)};
  camera.up = {1, 2, 9};
  camera.span = Q14::from_raw(40 << 14);
  BakedParts parts;
  parts.tree = {world.compact.bytes(), world.compact.size_bytes()};
  parts.camera = &camera;
  std::vector<std::uint64_t> words(baked_bytes(parts) / 8 + 1);
  const Bytes bytes{reinterpret_cast<std::uint8_t*>(words.data()), baked_bytes(parts)};
  REQUIRE(BakedScene::make(parts, bytes, nullptr) == Status::kOk);
  thimble_scene_t scene = {};
  REQUIRE(thimble_scene_open(&scene, bytes.data, bytes.size) == THIMBLE_OK);
  thimble_view_t view;
  REQUIRE(thimble_scene_view(&scene, &view) == THIMBLE_OK);
  CHECK(view.projection == THIMBLE_ORTHOGRAPHIC);
  CHECK(view.direction_bits == 12);
  CHECK(view.eye_q8.x == -700);
  CHECK(view.target_q8.y == 4001);
  CHECK(view.up.z == 9);
  CHECK(view.span_q14 == 40 << 14);

  // Parallel rays: one direction for all, origins a pixel of 40/20 voxels apart.
  thimble_camera_t through = {};
  REQUIRE(thimble_scene_camera(&scene, &view, 20, 10, &through) == THIMBLE_OK);
  thimble_ray_t first;
  thimble_ray_t last;
  REQUIRE(thimble_camera_ray(&through, 0, 3, &first) == THIMBLE_OK);
  REQUIRE(thimble_camera_ray(&through, 10, 3, &last) == THIMBLE_OK);
  CHECK(first.direction.x == last.direction.x);
  CHECK(first.direction.y == last.direction.y);
  CHECK(first.direction.z == last.direction.z);
  double square = 0;
  square += double(last.origin_q8.x - first.origin_q8.x) * (last.origin_q8.x - first.origin_q8.x);
  square += double(last.origin_q8.y - first.origin_q8.y) * (last.origin_q8.y - first.origin_q8.y);
  square += double(last.origin_q8.z - first.origin_q8.z) * (last.origin_q8.z - first.origin_q8.z);
  CHECK(square == doctest::Approx(20.0 * 256 * 20 * 256).epsilon(0.002));
}

TEST_CASE("C face: a pixel of a camera for another world -> refused; of this one -> the ray's hit") {
  const CWorld world;
  thimble_scene_t scene = {};
  REQUIRE(thimble_scene_open(&scene, world.bytes().data, world.bytes().size) == THIMBLE_OK);
  thimble_view_t view;
  REQUIRE(thimble_scene_view(&scene, &view) == THIMBLE_OK);
  for (const std::int32_t level : {4, 5, 6}) {
    thimble_camera_t camera = {};
    REQUIRE(thimble_camera_set(&camera, &view, 24, 16, level) == THIMBLE_OK);
    thimble_hit_t hit = {};
    hit.visits = 77;
    const std::int32_t status = thimble_scene_pick(&scene, &camera, 12, 8, &hit);
    CHECK(status == (level == 5 ? THIMBLE_OK : THIMBLE_BAD_ARGUMENT));
    if (level != 5) {
      CHECK(hit.visits == 77);
      continue;
    }
    thimble_ray_t ray;
    REQUIRE(thimble_camera_ray(&camera, 12, 8, &ray) == THIMBLE_OK);
    thimble_hit_t traced = {};
    REQUIRE(thimble_scene_trace(&scene, &ray, UINT32_MAX, &traced) == THIMBLE_OK);
    CHECK(traced.kind == hit.kind);
    CHECK(traced.visits == hit.visits);
    CHECK(traced.voxel.z == hit.voxel.z);
  }
}

TEST_CASE("C face: a pool of bytes that are not there -> refused; of none -> a pool that takes nothing") {
  thimble_octree_t octree = {};
  CHECK(thimble_octree_make(&octree, 4, nullptr, 100) == THIMBLE_BAD_ARGUMENT);
  std::uint8_t bytes[64];
  CHECK(thimble_octree_make(nullptr, 4, bytes, sizeof bytes) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_octree_insert(&octree, 1, 1, 1, 1) == THIMBLE_BAD_ARGUMENT);
  REQUIRE(thimble_octree_make(&octree, 4, nullptr, 0) == THIMBLE_OK);
  CHECK(thimble_octree_insert(&octree, 1, 1, 1, 1) == THIMBLE_OUT_OF_MEMORY);
  CHECK(thimble_octree_contains(&octree, 1, 1, 1) == 0);
}

}  // namespace
}  // namespace thimble::tests::c_edges
