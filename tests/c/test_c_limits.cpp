// The C face's defaults, member by member, and each limit from both sides.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "c/c_world.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/shading.h"
#include "thimble/plane/particles.h"
#include "thimble/thimble_c.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// Where nothing was written, no default stands by chance.
template <class T>
T garbage() {
  T value;
  std::memset(&value, 0x5A, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("C face: defaults -> every member is set to what C++ has") {
  auto view = garbage<thimble_view_t>();
  thimble_view_default(&view);
  const SceneCamera camera;
  CHECK(view.projection == (camera.is_perspective ? THIMBLE_PERSPECTIVE : THIMBLE_ORTHOGRAPHIC));
  CHECK(view.direction_bits == camera.direction_bits);
  CHECK(view.fov_q16 == camera.fov_degrees.raw);
  CHECK(view.span_q14 == 1 << 14);
  CHECK(view.eye_q8.x == camera.eye.x.raw);
  CHECK(view.target_q8.y == 256);
  CHECK(view.up.z == camera.up.z);

  auto shading = garbage<thimble_shading_t>();
  thimble_shading_default(&shading);
  const Shading look;
  CHECK(shading.palette_rgb == nullptr);
  CHECK(shading.palette_colors == 0);
  CHECK(shading.mode == THIMBLE_SHADE_DEPTH);
  CHECK(shading.near_q8 == look.near_q8);
  CHECK(shading.far_q8 == look.far_q8);
  for (int face = 0; face < 6; ++face) {
    CHECK(shading.face_light[face] == look.face_light[face]);
  }
  const Rgb8 colors[] = {look.default_color, look.background};
  CHECK(std::memcmp(shading.default_rgb, &colors[0], 3) == 0);
  CHECK(std::memcmp(shading.background_rgb, &colors[1], 3) == 0);

  auto config = garbage<thimble_particle_config_t>();
  thimble_particle_config_default(&config);
  const ParticleConfig from;
  CHECK(config.width == from.width);
  CHECK(config.height == from.height);
  CHECK(config.capacity == from.capacity);
  CHECK(config.least_diameter == from.least_diameter);
  CHECK(config.most_diameter == from.most_diameter);
  CHECK(config.restitution_q16 == from.restitution_q16);
  CHECK(config.gravity_x_q16 == from.gravity_q16.x);
  CHECK(config.gravity_y_q16 == from.gravity_q16.y);
  CHECK(config.seed == from.seed);
  CHECK(config.substeps_log2 == from.substeps_log2);
  CHECK(config.subpixel_bits == from.subpixel_bits);
}

TEST_CASE("C face: sizes of a refined frame -> 1 and the largest are taken, one beyond is not") {
  constexpr std::int32_t kMost = kMaxPicturePx;
  CHECK(thimble_frame_bytes(THIMBLE_FORMAT_GRAY8, 1, 1) != 0);
  CHECK(thimble_frame_bytes(THIMBLE_FORMAT_GRAY8, kMost, 1) != 0);
  CHECK(thimble_frame_bytes(THIMBLE_FORMAT_GRAY8, 1, kMost) != 0);
  const std::int32_t wrong[][2] = {{0, 1}, {1, 0}, {-1, 1}, {1, -1}, {kMost + 1, 1}, {1, kMost + 1}};
  for (const auto& size : wrong) {
    CHECK(thimble_frame_bytes(THIMBLE_FORMAT_GRAY8, size[0], size[1]) == 0);
  }
}

TEST_CASE("C face: corners and lights -> their limits are taken, one beyond is not") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_camera_t camera = {};
  REQUIRE(thimble_scene_camera(&scene, nullptr, 16, 16, &camera) == THIMBLE_OK);
  thimble_shading_t shading;
  thimble_shading_default(&shading);
  std::int32_t thimble_vec3_t::*const axes[] = {&thimble_vec3_t::x, &thimble_vec3_t::y, &thimble_vec3_t::z};
  for (const auto axis : axes) {
    for (const bool high : {false, true}) {
      thimble_box_t box = {{0, 0, 0}, {4096, 4096, 4096}};
      CHECK(thimble_shading_planes(&shading, &camera, &box) == THIMBLE_OK);
      thimble_vec3_t& corner = high ? box.high : box.low;
      corner.*axis = 4097;
      CHECK(thimble_shading_planes(&shading, &camera, &box) == THIMBLE_OUT_OF_RANGE);
      corner.*axis = -1;
      CHECK(thimble_shading_planes(&shading, &camera, &box) == THIMBLE_OUT_OF_RANGE);
    }
    for (const std::int32_t sign : {-1, 1}) {
      thimble_vec3_t light = {};
      light.*axis = sign * 16384;
      CHECK(thimble_shading_light(&shading, light.x, light.y, light.z) == THIMBLE_OK);
      light.*axis = sign * 16385;
      CHECK(thimble_shading_light(&shading, light.x, light.y, light.z) == THIMBLE_OUT_OF_RANGE);
    }
  }
  CHECK(thimble_shading_light(&shading, 0, 0, 0) == THIMBLE_BAD_ARGUMENT);
}

TEST_CASE("C face: nothing for a handle, nothing for bytes -> the answer that the header states") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  CHECK(thimble_octree_material(nullptr, 1, 2, 3) == -1);
  CHECK(thimble_octree_contains(nullptr, 1, 2, 3) == 0);
  CHECK(thimble_tree_bytes(nullptr) == 0);
  thimble_tree_t tree = {};
  CHECK(thimble_tree_open(&tree, nullptr, 0) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_tree_open(&tree, nullptr, 9) == THIMBLE_BAD_ARGUMENT);
  thimble_light_t light = {};
  CHECK(thimble_scene_light(nullptr, &light) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_scene_light(&scene, nullptr) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_scene_light(&scene, &light) == THIMBLE_OK);
  // No byte at all is a memory, only too small a one; null with a size is none.
  std::vector<std::uint64_t> memory(1000);
  thimble_octree_t octree = {};
  CHECK(thimble_octree_make(&octree, 4, nullptr, 100) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_octree_make(nullptr, 4, memory.data(), 8000) == THIMBLE_BAD_ARGUMENT);
  CHECK(thimble_octree_insert(&octree, 1, 1, 1, 1) == THIMBLE_BAD_ARGUMENT);
  REQUIRE(thimble_octree_make(&octree, 4, nullptr, 0) == THIMBLE_OK);
  CHECK(thimble_octree_insert(&octree, 1, 1, 1, 1) == THIMBLE_OUT_OF_MEMORY);
  CHECK(thimble_octree_contains(&octree, 1, 1, 1) == 0);
  REQUIRE(thimble_octree_make(&octree, 3, memory.data(), 8000) == THIMBLE_OK);
  CHECK(thimble_tree_make(&tree, &octree, nullptr, 0) == THIMBLE_OUT_OF_MEMORY);
  CHECK(thimble_tree_make(&tree, &octree, nullptr, 1) == THIMBLE_BAD_ARGUMENT);
}

TEST_CASE("C face: a scene with an orthographic camera -> its view, member by member, and C++'s rays") {
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
  const HeapBytes bytes(baked_bytes(parts));
  REQUIRE(BakedScene::make(parts, bytes.span(), nullptr) == Status::kOk);
  thimble_scene_t scene = {};
  REQUIRE(thimble_scene_open(&scene, bytes.view().data, bytes.view().size) == THIMBLE_OK);
  thimble_view_t view;
  REQUIRE(thimble_scene_view(&scene, &view) == THIMBLE_OK);
  CHECK(view.projection == THIMBLE_ORTHOGRAPHIC);
  CHECK(view.direction_bits == 12);
  CHECK(view.eye_q8.x == -700);
  CHECK(view.target_q8.y == 4001);
  CHECK(view.up.z == 9);
  CHECK(view.span_q14 == 40 << 14);

  Camera through;
  REQUIRE(set_camera(camera, 20, 10, kWorldLevel, &through) == Status::kOk);
  thimble_camera_t c_through = {};
  REQUIRE(thimble_scene_camera(&scene, nullptr, 20, 10, &c_through) == THIMBLE_OK);
  thimble_ray_t ray;
  REQUIRE(thimble_camera_ray(&c_through, 10, 3, &ray) == THIMBLE_OK);
  CHECK(ray.origin_q8.x == through.ray(10, 3).origin.x.raw);
  CHECK(ray.direction.z == through.ray(10, 3).direction.z);
}

TEST_CASE("C face: a pixel of a camera for another world -> refused, the hit as it was") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_view_t view;
  REQUIRE(thimble_scene_view(&scene, &view) == THIMBLE_OK);
  for (const std::int32_t level : {4, 5, 6}) {
    thimble_camera_t camera = {};
    REQUIRE(thimble_camera_set(&camera, &view, 24, 16, level) == THIMBLE_OK);
    thimble_hit_t hit = {};
    hit.visits = 77;
    const std::int32_t status = thimble_scene_pick(&scene, &camera, 12, 8, &hit);
    CHECK(status == (level == 5 ? THIMBLE_OK : THIMBLE_BAD_ARGUMENT));
    CHECK((hit.visits == 77) == (level != 5));
  }
}
