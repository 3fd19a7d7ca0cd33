// Scenes, octrees, particles and handles through the C face against C++, and what is refused.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "c/c_world.h"
#include "c/face.h"
#include "support/allocation_trap.h"
#include "thimble/base/memory.h"
#include "thimble/plane/particles.h"
#include "thimble/tree/edited_world.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

std::vector<std::uint8_t> copy_of(ConstBytes bytes) {
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_CASE("C face: a program in C builds, keeps, draws, picks and edits -> no line of it fails") {
  set_allocation_trap();
  const int line = thimble_face_in_c();
  CHECK(clear_allocation_trap() == 0);
  CHECK_MESSAGE(line == 0, "tests/c/face.c:", line);
}

TEST_CASE("C face: status as text -> the phrases of C++, one for any other number") {
  for (std::int32_t status = THIMBLE_OK; status <= THIMBLE_STEP_LIMIT; ++status) {
    CHECK(std::string(thimble_status_text(status)) == status_text(static_cast<Status>(status)));
    CHECK(std::string(thimble_status_text(status)) != "unknown status");
  }
  for (const std::int32_t status : {-1, 7, 255, 256, 257, 1 << 16, INT32_MAX, INT32_MIN}) {
    CHECK(std::string(thimble_status_text(status)) == "unknown status");
  }
}

TEST_CASE("C face: effects by name -> those of C++; of a set, of none -> no name") {
  for (int effect = 0; effect < 32; ++effect) {
    CHECK(std::string(thimble_effect_name(1U << effect)) == effect_name(1U << effect));
  }
  CHECK(std::string(thimble_effect_name(THIMBLE_EFFECT_SHADOWS)) == "shadows");
  CHECK(std::string(thimble_effect_name(0)).empty());
  CHECK(std::string(thimble_effect_name(3)).empty());
}

TEST_CASE("C face: a scene at any address -> what C++ says of it") {
  const CWorld world;
  for (std::size_t offset = 0; offset < 3; ++offset) {
    std::vector<std::uint8_t> moved(offset, 0);
    moved.insert(moved.end(), world.bytes().begin(), world.bytes().end());
    thimble_scene_t scene = {};
    REQUIRE(thimble_scene_open(&scene, moved.data() + offset, moved.size() - offset) == THIMBLE_OK);
    CHECK(thimble_scene_validate(moved.data() + offset, moved.size() - offset, nullptr) == nullptr);
    const thimble_scene_t copy = scene;  // by assignment
    thimble_scene_info_t info;
    REQUIRE(thimble_scene_get_info(&copy, &info) == THIMBLE_OK);
    CHECK(info.tree.level == kWorldLevel);
    CHECK(info.tree.voxels == world.compact.voxel_count());
    CHECK(info.tree.nodes == world.compact.node_count());
    CHECK(info.tree.size_bytes == world.compact.size_bytes());
    CHECK(std::memcmp(info.tree.bytes, world.compact.bytes(), info.tree.size_bytes) == 0);
    CHECK(info.tree.bounds.high.x == world.compact.bounds().high.x);
    CHECK(info.palette_colors == 4);
    CHECK(info.palette_rgb[3] == 230);
    CHECK(info.crc32 == world.scene.crc32());
    CHECK(std::string(info.name, info.name_bytes) == "a world");
    CHECK(info.has_view == 1);
    CHECK(info.has_light == 1);
    CHECK(info.has_bricks == 1);
    thimble_bricks_t bricks = {};
    CHECK((thimble_scene_bricks(&scene, &bricks) == THIMBLE_OK) ==
          (reinterpret_cast<std::uintptr_t>(moved.data() + offset) % 8 == 0));
    thimble_light_t light;
    REQUIRE(thimble_scene_light(&scene, &light) == THIMBLE_OK);
    REQUIRE(thimble_light_lamps(&light) == 2);
    thimble_lamp_t lamp;
    REQUIRE(thimble_light_lamp(&light, 0, &lamp) == THIMBLE_OK);
    CHECK(lamp.is_point == 0);
    CHECK(lamp.place.z == 9);
    REQUIRE(thimble_light_lamp(&light, 1, &lamp) == THIMBLE_OK);
    CHECK(lamp.is_point == 1);
    CHECK(lamp.place.z == 6 * 256);
    CHECK(lamp.reach == 4);
    CHECK(lamp.color_q8[1] == 256);
    CHECK(thimble_light_lamp(&light, 2, &lamp) == THIMBLE_OUT_OF_RANGE);
  }
}

TEST_CASE("C face: a scene without camera, light and palette -> opens, and says what it lacks") {
  const CWorld world(0, false);
  const thimble_scene_t scene = world.opened();
  thimble_scene_info_t info;
  REQUIRE(thimble_scene_get_info(&scene, &info) == THIMBLE_OK);
  CHECK(info.palette_rgb == nullptr);
  CHECK(info.name == nullptr);
  CHECK(info.palette_colors + info.name_bytes == 0);
  CHECK(info.has_view + info.has_light + info.has_bricks == 0);
  thimble_view_t view = {};
  view.fov_q16 = 99;
  CHECK(thimble_scene_view(&scene, &view) == THIMBLE_BAD_ARGUMENT);
  CHECK(view.fov_q16 == 99);
  thimble_camera_t camera = {};
  CHECK(thimble_scene_camera(&scene, nullptr, 8, 8, &camera) == THIMBLE_BAD_ARGUMENT);
  thimble_light_t light = {};
  CHECK(thimble_scene_light(&scene, &light) == THIMBLE_DAMAGED);
  CHECK(thimble_light_effects(&light) == 0);
  // A view of the program's own serves.
  thimble_view_default(&view);
  view.eye_q8 = {4096, -9000, 5000};
  view.target_q8 = {4096, 4096, 2000};
  CHECK(thimble_scene_camera(&scene, &view, 8, 8, &camera) == THIMBLE_OK);
  thimble_shading_t shading;
  CHECK(thimble_scene_shading(&scene, &shading) == THIMBLE_OK);
  std::uint8_t pixels[64];
  const thimble_band_t band = {pixels, sizeof pixels, 0, THIMBLE_FORMAT_GRAY8, 0, 8};
  CHECK(thimble_scene_render(&scene, &camera, &shading, &band) == THIMBLE_OK);
}

TEST_CASE("C face: bytes of another version, cut off, flipped -> refused, and said in words") {
  const CWorld world;
  std::vector<std::uint8_t> bytes = copy_of(world.bytes());
  thimble_scene_t scene = {};
  const thimble_scene_t before = scene;
  const auto opens = [&] { return thimble_scene_open(&scene, bytes.data(), bytes.size()); };
  const auto fault = [&] {
    std::uint32_t place = 0;
    const char* const text = thimble_scene_validate(bytes.data(), bytes.size(), &place);
    return text == nullptr ? std::string() : text;
  };
  bytes[3] = THIMBLE_BAKED_VERSION + 1;
  CHECK(opens() == THIMBLE_DAMAGED);
  CHECK(fault() == kAnotherVersion);
  bytes[3] = THIMBLE_BAKED_VERSION;
  bytes[0] ^= 1;
  CHECK(opens() == THIMBLE_DAMAGED);
  bytes[0] ^= 1;
  CHECK(thimble_scene_open(&scene, bytes.data(), bytes.size() - 1) == THIMBLE_DAMAGED);
  CHECK(thimble_scene_open(&scene, bytes.data(), 0) == THIMBLE_DAMAGED);
  CHECK(std::memcmp(&scene, &before, sizeof scene) == 0);
  CHECK(fault().empty());
  // A flipped bit of the tree is the checksum's to find: the header alone does not tell.
  bytes[bytes.size() / 2] ^= 4;
  CHECK(opens() == THIMBLE_OK);
  CHECK(fault() == "checksum does not match");
}

TEST_CASE("C face: voxels in and out, full pools, coarsening -> the octree of C++, node by node") {
  for (const bool coarsen : {false, true}) {
    std::vector<std::uint8_t> c_bytes(thimble_octree_bytes(300));
    std::vector<std::uint8_t> cpp_bytes(Octree::octree_bytes(300));
    REQUIRE(c_bytes.size() == cpp_bytes.size());
    thimble_octree_t octree = {};
    Octree expected;
    REQUIRE(thimble_octree_make(&octree, 4, c_bytes.data(), c_bytes.size()) == THIMBLE_OK);
    REQUIRE(Octree::make(4, {cpp_bytes.data(), cpp_bytes.size()}, &expected) == Status::kOk);
    REQUIRE(thimble_octree_set_coarsen(&octree, coarsen ? 1 : 0) == THIMBLE_OK);
    expected.set_coarsen(coarsen);
    std::mt19937 random(3);
    int statuses[8] = {};
    const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 18) - 1; };
    for (int round = 0; round < 4000; ++round) {
      const Vec3i at{coordinate(), coordinate(), coordinate()};
      const std::int32_t material = static_cast<std::int32_t>(random() % 3);
      std::int32_t told = 0;
      Status status = Status::kOk;
      switch (random() % 16) {
        case 0: {
          const Vec3i end{at.x + 3, at.y + 2, at.z + 4};
          const thimble_box_t box = {{at.x, at.y, at.z}, {end.x, end.y, end.z}};
          told = thimble_octree_insert_box(&octree, &box, material);
          status = expected.insert_box({at, end}, static_cast<std::uint8_t>(material));
          break;
        }
        case 1:
        case 2:
        case 3:
        case 4:
        case 5:
          told = thimble_octree_erase(&octree, at.x, at.y, at.z);
          status = expected.remove(at);
          break;
        default:
          told = thimble_octree_insert(&octree, at.x, at.y, at.z, material);
          status = expected.insert(at, static_cast<std::uint8_t>(material));
      }
      REQUIRE(told == static_cast<std::int32_t>(status));
      ++statuses[told];
      REQUIRE(thimble_octree_contains(&octree, at.x, at.y, at.z) == (expected.test(at) ? 1 : 0));
      REQUIRE(thimble_octree_material(&octree, at.x, at.y, at.z) == expected.material(at));
      if (round == 2500) {
        REQUIRE(thimble_octree_clear(&octree) == THIMBLE_OK);
        expected.clear();
      }
    }
    CHECK(statuses[THIMBLE_OK] > 1000);
    CHECK(statuses[THIMBLE_OUT_OF_RANGE] > 100);
    if (!coarsen) {
      CHECK(statuses[THIMBLE_OUT_OF_MEMORY] > 100);
    }
    thimble_octree_info_t info;
    REQUIRE(thimble_octree_get_info(&octree, &info) == THIMBLE_OK);
    CHECK(info.voxels == expected.voxels());
    CHECK(info.solid_added == expected.solid_added());
    CHECK((info.solid_added != 0) == coarsen);
    CHECK(info.level == 4);
    CHECK(info.nodes == expected.nodes_used());
    CHECK(info.nodes_free == expected.nodes_free());
    CHECK(info.nodes_high_water == expected.nodes_high_water());
    CHECK(info.bounds.low.y == expected.bounds().low.y);
    CHECK(info.bounds.high.z == expected.bounds().high.z);

    const std::size_t size = thimble_tree_bytes(&octree);
    std::vector<std::uint8_t> c_tree(size, 0xEE);
    std::vector<std::uint8_t> cpp_tree(size, 0);
    thimble_tree_t tree = {};
    CHECK(thimble_tree_make(&tree, &octree, c_tree.data(), size - 1) == THIMBLE_OUT_OF_MEMORY);
    CHECK(c_tree[0] == 0xEE);
    REQUIRE(thimble_tree_make(&tree, &octree, c_tree.data(), size) == THIMBLE_OK);
    REQUIRE(CompactTree::make(expected, {cpp_tree.data(), size}, nullptr) == Status::kOk);
    CHECK(c_tree == cpp_tree);
    thimble_tree_t opened = {};
    REQUIRE(thimble_tree_open(&opened, c_tree.data(), size) == THIMBLE_OK);
    CHECK(thimble_tree_open(&opened, c_tree.data(), size - 1) == THIMBLE_DAMAGED);
    thimble_tree_info_t tree_info;
    REQUIRE(thimble_tree_get_info(&opened, &tree_info) == THIMBLE_OK);
    CHECK(tree_info.bytes == c_tree.data());
    CHECK(tree_info.size_bytes == size);
    CHECK(tree_info.voxels == expected.voxels());
    CHECK(tree_info.solid_added == expected.solid_added());
  }
}

TEST_CASE("C face: balls that are added, thrown, taken away -> the state of C++ after every step") {
  thimble_particle_config_t config;
  thimble_particle_config_default(&config);
  CHECK(thimble_particles_bytes(&config) == particles_bytes(ParticleConfig{}));
  config.width = 128;
  config.height = 64;
  config.capacity = 60;
  config.most_diameter = 8;
  config.seed = 5;
  ParticleConfig cpp_config;
  cpp_config.width = 128;
  cpp_config.height = 64;
  cpp_config.capacity = 60;
  cpp_config.most_diameter = 8;
  cpp_config.seed = 5;
  const std::size_t size = thimble_particles_bytes(&config);
  CHECK(size == 3604);
  std::vector<std::uint8_t> c_bytes(size);
  std::vector<std::uint8_t> cpp_bytes(size);
  thimble_particles_t world = {};
  ParticleWorld expected;
  CHECK(thimble_particles_make(&world, &config, c_bytes.data(), size - 1) == THIMBLE_OUT_OF_MEMORY);
  REQUIRE(thimble_particles_make(&world, &config, c_bytes.data(), size) == THIMBLE_OK);
  REQUIRE(ParticleWorld::make(cpp_config, {cpp_bytes.data(), size}, &expected) == Status::kOk);
  CHECK(thimble_particles_draw_box(&world, 20, 50, 60, 3) == THIMBLE_OK);
  expected.draw_box({{20, 50}, {80, 53}});
  for (int ball = 0; ball < 40; ++ball) {
    std::int32_t id = -5;
    std::uint32_t expected_id = 0;
    const Status status = expected.spawn_random(65536, &expected_id);
    CHECK(thimble_particles_add_random(&world, 65536, &id) == static_cast<std::int32_t>(status));
    CHECK(id == static_cast<std::int32_t>(expected_id));
  }
  std::int32_t id = -5;
  CHECK(thimble_particles_add(&world, 0, 0, 0, 0, 4, &id) == THIMBLE_OUT_OF_RANGE);
  CHECK(thimble_particles_add(&world, 40 << 16, 51 << 16, 0, 0, 4, &id) == THIMBLE_OUT_OF_MEMORY);
  CHECK(id == -5);
  CHECK(thimble_particles_add(&world, 100 << 16, 4 << 16, 9, -9, 3, nullptr) ==
        static_cast<std::int32_t>(expected.spawn(100 << 16, 4 << 16, 9, -9, 3, nullptr)));
  for (int step = 0; step < 300; ++step) {
    CHECK(thimble_particles_step(&world) == THIMBLE_OK);
    expected.step();
    if (step == 100) {
      CHECK(thimble_particles_erase_box(&world, -4, -4, 60, 200) == THIMBLE_OK);
      expected.erase_box({{-4, -4}, {56, 196}});
      CHECK(thimble_particles_remove(&world, 7) == THIMBLE_OK);
      CHECK(expected.remove(7) == Status::kOk);
      CHECK(thimble_particles_remove(&world, 7) == THIMBLE_OUT_OF_RANGE);
      CHECK(thimble_particles_set_velocity(&world, 3, -99999, -200000) == THIMBLE_OK);
      CHECK(expected.set_velocity(3, -99999, -200000) == Status::kOk);
      CHECK(thimble_particles_set_gravity(&world, 500, -6554) == THIMBLE_OK);
      CHECK(expected.set_gravity({500, -6554}) == Status::kOk);
    }
    REQUIRE(thimble_particles_crc32(&world) == expected.state_crc32());
  }
  thimble_particles_info_t info;
  REQUIRE(thimble_particles_get_info(&world, &info) == THIMBLE_OK);
  CHECK(info.width == 128);
  CHECK(info.height == 64);
  CHECK(info.count == expected.count());
  CHECK(info.asleep == expected.asleep());
  CHECK(info.id_limit == expected.id_limit());
  CHECK(info.steps == 300);
  int covered = 0;
  for (std::int32_t y = -2; y < 67; ++y) {
    for (std::int32_t x = -40; x < 140; ++x) {
      REQUIRE(thimble_particles_cells(&world, x, y) == expected.field().window(x, y));
      REQUIRE(thimble_particles_at(&world, x, y) == static_cast<std::int32_t>(expected.ball_at({x, y})));
      covered += thimble_particles_at(&world, x, y) != THIMBLE_NO_PARTICLE ? 1 : 0;
    }
  }
  CHECK(covered > 100);
  for (std::int32_t ball = -1; ball <= static_cast<std::int32_t>(info.id_limit); ++ball) {
    thimble_particle_t told;
    Particle one;
    REQUIRE((thimble_particles_get(&world, ball, &told) == THIMBLE_OK) ==
            expected.particle(static_cast<std::uint32_t>(ball), &one));
    if (one.id != kNoBall) {
      CHECK(told.id == ball);
      CHECK(told.x_q16 == one.x_q16);
      CHECK(told.y_q16 == one.y_q16);
      CHECK(told.vx_q16 == one.vx_q16);
      CHECK(told.vy_q16 == one.vy_q16);
      CHECK(told.diameter == one.diameter);
      CHECK(told.corner_x == one.corner.x);
      CHECK(told.corner_y == one.corner.y);
      CHECK(told.is_asleep == (one.asleep ? 1 : 0));
    }
  }
  // Boxes of no cells and beyond what a number can say.
  const std::uint32_t before = thimble_particles_crc32(&world);
  CHECK(thimble_particles_draw_box(&world, 5, 5, 0, 9) == THIMBLE_OK);
  CHECK(thimble_particles_draw_box(&world, INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX) == THIMBLE_OK);
  CHECK(thimble_particles_draw_box(&world, 5, 5, -1, 9) == THIMBLE_OUT_OF_RANGE);
  CHECK(thimble_particles_erase_box(&world, 5, 5, 1, INT32_MIN) == THIMBLE_OUT_OF_RANGE);
  CHECK(thimble_particles_crc32(&world) == before);
  CHECK(thimble_particles_draw_box(&world, INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX) == THIMBLE_OK);
  CHECK(thimble_particles_crc32(&world) == before);
  CHECK(thimble_particles_draw_box(&world, -3, -3, INT32_MAX, INT32_MAX) == THIMBLE_OK);
  CHECK(thimble_particles_cells(&world, 3, 3) == UINT32_MAX);
}
