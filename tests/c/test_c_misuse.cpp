// The C face with arguments that nobody means: null, empty handles, handles of another kind, numbers of any size.
// Each is a status and nothing has changed; the sanitized build sees the rest.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "c/c_world.h"
#include "misuse/odd_values.h"
#include "support/small_scene.h"
#include "thimble/plane/particles.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// Everything that a call may want, made well; a round puts other things in place of some.
struct Things {
  explicit Things(const CWorld& world) : baked(world.bytes()) {
    REQUIRE(thimble_scene_open(&scene, world.bytes().data, world.bytes().size) == THIMBLE_OK);
    REQUIRE(thimble_scene_tree(&scene, &tree) == THIMBLE_OK);
    REQUIRE(thimble_scene_view(&scene, &view) == THIMBLE_OK);
    REQUIRE(thimble_scene_camera(&scene, nullptr, 24, 16, &camera) == THIMBLE_OK);
    REQUIRE(thimble_scene_shading(&scene, &shading) == THIMBLE_OK);
    REQUIRE(thimble_scene_light(&scene, &light) == THIMBLE_OK);
    REQUIRE(thimble_scene_bricks(&scene, &bricks) == THIMBLE_OK);
    pool = HeapBytes(thimble_octree_bytes(400));
    REQUIRE(thimble_octree_make(&octree, 4, pool.span().data, pool.span().size) == THIMBLE_OK);
    thimble_particle_config_default(&config);
    config.width = 60;
    config.height = 40;
    config.capacity = 12;
    balls = HeapBytes(thimble_particles_bytes(&config));
    REQUIRE(thimble_particles_make(&particles, &config, balls.span().data, balls.span().size) == THIMBLE_OK);
    frame_bytes = HeapBytes(thimble_frame_bytes(THIMBLE_FORMAT_GRAY4, 24, 16));
    REQUIRE(thimble_frame_make(&frame, &tree, &camera, &shading, THIMBLE_FORMAT_GRAY4,
                               frame_bytes.span().data, frame_bytes.span().size) == THIMBLE_OK);
  }

  ConstBytes baked;
  thimble_scene_t scene = {};
  thimble_tree_t tree = {};
  thimble_octree_t octree = {};
  thimble_camera_t camera = {};
  thimble_bricks_t bricks = {};
  thimble_light_t light = {};
  thimble_frame_t frame = {};
  thimble_particles_t particles = {};
  thimble_view_t view = {};
  thimble_shading_t shading = {};
  thimble_particle_config_t config = {};
  HeapBytes pool, balls, frame_bytes;
};

// Hands out one thing or what is no such thing: null, a handle that holds nothing, one of another kind, one that
// stands between the words.
class Odd {
 public:
  explicit Odd(OddValues& odd, int how_often) : odd_(odd), how_often_(how_often) {}

  template <class T>
  T* handle(T* good) {
    static_assert(sizeof(T) <= sizeof(nothing_) - 8);
    if (!spoils()) {
      return good;
    }
    spoiled_ = true;
    switch (odd_.bits() % 4) {
      case 0:
        return nullptr;
      case 1:
        std::memset(nothing_, 0, sizeof nothing_);
        return reinterpret_cast<T*>(nothing_);
      case 2:
        std::memset(nothing_, 0x54, sizeof nothing_);
        return reinterpret_cast<T*>(nothing_);
      default:
        std::memset(nothing_, 0, sizeof nothing_);
        return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(nothing_) + 4);
    }
  }
  // A handle to write: null or between the words, or the good one.
  template <class T>
  T* target(T* good) {
    if (!spoils()) {
      return good;
    }
    spoiled_ = true;
    return odd_.one_in(2) ? nullptr : reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(nothing_) + 4);
  }
  // Plain data, which stands where its numbers may.
  template <class T>
  T* data(T* good) {
    if (!spoils()) {
      return good;
    }
    spoiled_ = true;
    return nullptr;
  }
  // Whether anything was spoiled since the last question.
  bool spoiled() {
    const bool was = spoiled_;
    spoiled_ = false;
    return was;
  }

 private:
  bool spoils() { return odd_.one_in(static_cast<std::uint64_t>(how_often_)); }

  OddValues& odd_;
  int how_often_;
  bool spoiled_ = false;
  alignas(8) std::uint8_t nothing_[512] = {};
};

thimble_vec3_t any_vector(OddValues& odd) {
  return {odd.any<std::int32_t>(), odd.any<std::int32_t>(), odd.any<std::int32_t>()};
}

// Anything, or something near the scene's own.
thimble_view_t odd_view(OddValues& odd, const thimble_view_t& good) {
  thimble_view_t view = good;
  if (odd.one_in(3)) {
    view.projection = odd.any<std::int32_t>();
  } else if (odd.one_in(2)) {
    view.projection = THIMBLE_ORTHOGRAPHIC;
    view.span_q14 = odd.one_in(2) ? 30 << 14 : odd.any<std::int32_t>();
  }
  view.direction_bits = odd.one_in(2) ? 0 : odd.any<std::int32_t>();
  view.eye_q8 = odd.one_in(2) ? good.eye_q8 : any_vector(odd);
  view.target_q8 = odd.one_in(2) ? good.target_q8 : any_vector(odd);
  view.forward = odd.one_in(2) ? good.forward : any_vector(odd);
  view.up = odd.one_in(2) ? good.up : any_vector(odd);
  view.fov_q16 = odd.one_in(2) ? good.fov_q16 : odd.any<std::int32_t>();
  return view;
}

thimble_shading_t odd_shading(OddValues& odd, const thimble_shading_t& good) {
  thimble_shading_t shading = good;
  shading.mode = odd.any_or(3, 0, 3);
  if (odd.one_in(4)) {
    shading.palette_rgb = nullptr;
    shading.palette_colors = odd.one_in(2) ? 0 : odd.any<std::uint32_t>();
  }
  shading.near_q8 = odd.any<std::int32_t>();
  shading.far_q8 = odd.any<std::int32_t>();
  for (std::uint16_t& face : shading.face_light) {
    face = odd.any<std::uint16_t>();
  }
  return shading;
}

thimble_band_t odd_band(OddValues& odd, HeapBytes* bytes) {
  *bytes = HeapBytes(odd.bits() % 3000);
  thimble_band_t band = {};
  band.pixels = odd.one_in(9) ? nullptr : bytes->span().data;
  band.size_bytes = odd.one_in(9) ? 0 : bytes->span().size;
  band.stride_bytes = odd.one_in(2) ? 0 : odd.one_in(2) ? odd.bits() % 100 : odd.any<std::size_t>();
  band.format = odd.any_or(6, 0, kPixelFormats);
  band.first_row = odd.one_in(3) ? odd.any<std::int32_t>() : odd.between_32(0, 2) * 8;
  band.rows = odd.any_or(3, 0, 16);
  return band;
}

// A status that there is; with an argument spoiled, the one for that.
void check(std::int32_t status, Odd& odd) {
  CHECK(status >= THIMBLE_OK);
  CHECK(status <= THIMBLE_STEP_LIMIT);
  if (odd.spoiled()) {
    CHECK(status == THIMBLE_BAD_ARGUMENT);
  }
}

}  // namespace

TEST_CASE("misuse: C face, pictures and rays with anything in place of any argument -> a status") {
  const CWorld world;
  int drawn = 0;
  misuse(71, 1500, [&](OddValues& values) {
    Things things(world);
    Odd odd(values, values.one_in(2) ? 12 : 1000000);
    if (values.one_in(2)) {
      const thimble_view_t view = odd_view(values, things.view);
      const std::int32_t width = values.any_or(3, 0, 40);
      const std::int32_t height = values.any_or(3, 0, 40);
      const std::int32_t level = values.one_in(3) ? values.any<std::int32_t>() : kWorldLevel;
      const thimble_view_t* const from = odd.data(&view);
      check(thimble_camera_set(odd.target(&things.camera), from, width, height, level), odd);
      check(thimble_scene_camera(odd.handle(&things.scene), values.one_in(2) ? nullptr : &view, width, height,
                                 odd.target(&things.camera)),
            odd);
    }
    std::int32_t width = 0;
    std::int32_t height = 0;
    REQUIRE(thimble_camera_size(&things.camera, &width, &height) == THIMBLE_OK);
    check(thimble_camera_size(odd.handle(&things.camera), odd.data(&width), odd.data(&height)), odd);
    if (width > 64 || height > 64) {
      REQUIRE(thimble_scene_camera(&things.scene, nullptr, 24, 16, &things.camera) == THIMBLE_OK);
    }
    thimble_box_t box = {any_vector(values), any_vector(values)};
    if (values.one_in(2)) {
      box = {{0, 0, 0}, {values.between_32(0, 4096), 32, 32}};
    }
    check(thimble_shading_planes(odd.data(&things.shading), odd.handle(&things.camera), odd.data(&box)), odd);
    const thimble_vec3_t toward = any_vector(values);
    (void)thimble_shading_light(odd.data(&things.shading), toward.x, toward.y, toward.z);
    (void)odd.spoiled();
    const thimble_shading_t shading = odd_shading(values, things.shading);
    HeapBytes pixels;
    const thimble_band_t band = odd_band(values, &pixels);
    const auto draws = [&](auto&& draw) {
      const thimble_camera_t* const camera = odd.handle(&things.camera);
      const std::int32_t status = draw(camera, odd.data(&shading), odd.data(&band));
      drawn += status == THIMBLE_OK ? 1 : 0;
      check(status, odd);
    };
    draws([&](auto... rest) { return thimble_scene_render(odd.handle(&things.scene), rest...); });
    draws([&](auto... rest) { return thimble_tree_render(odd.handle(&things.tree), rest...); });
    draws([&](auto... rest) { return thimble_octree_render(odd.handle(&things.octree), rest...); });
    draws([&](auto... rest) {
      return thimble_scene_render_fast(odd.handle(&things.scene), odd.handle(&things.bricks), rest...);
    });
    const std::uint32_t effects =
        values.one_in(2) ? thimble_light_effects(&things.light) : values.any<std::uint32_t>();
    draws([&](auto... rest) {
      return thimble_scene_render_lit(odd.handle(&things.scene), odd.handle(&things.light), effects, rest...);
    });
    thimble_ray_t ray = {any_vector(values), any_vector(values)};
    const std::int32_t px = values.any<std::int32_t>() % 50;
    const std::int32_t py = values.any<std::int32_t>();
    const std::int32_t rayed = thimble_camera_ray(odd.handle(&things.camera), px, py, odd.data(&ray));
    CHECK((rayed == THIMBLE_OK || rayed == THIMBLE_OUT_OF_RANGE || rayed == THIMBLE_BAD_ARGUMENT));
    (void)odd.spoiled();
    thimble_hit_t hit = {};
    const std::uint32_t limit = values.any<std::uint32_t>();
    check(thimble_scene_trace(odd.handle(&things.scene), odd.data(&ray), limit, odd.data(&hit)), odd);
    check(thimble_tree_trace(odd.handle(&things.tree), odd.data(&ray), limit, odd.data(&hit)), odd);
    check(thimble_octree_trace(odd.handle(&things.octree), odd.data(&ray), limit, odd.data(&hit)), odd);
    check(thimble_scene_pick(odd.handle(&things.scene), odd.handle(&things.camera), px, py, odd.data(&hit)),
          odd);
    (void)thimble_band_bytes(values.any<std::int32_t>(), values.any<std::int32_t>(),
                             values.any<std::int32_t>());
    (void)thimble_band_row_multiple(values.any<std::int32_t>());
    const std::int32_t frame_format = values.any_or(2, 0, kPixelFormats - 1);
    (void)thimble_frame_bytes(frame_format, values.any<std::int32_t>(), values.any<std::int32_t>());
    HeapBytes memory(values.bits() % 3000);
    thimble_frame_t frame = {};
    const std::int32_t begun = thimble_frame_make(
        odd.target(&frame), odd.handle(&things.tree), odd.handle(&things.camera), odd.data(&shading),
        frame_format, values.one_in(9) ? nullptr : memory.span().data, memory.span().size);
    check(begun, odd);
    check(thimble_frame_refine(odd.handle(begun == THIMBLE_OK ? &frame : &things.frame),
                               odd.handle(&things.tree), values.one_in(2) ? limit : limit % 5000),
          odd);
    (void)thimble_frame_inexact(odd.handle(&frame));
    (void)odd.spoiled();
  });
  CHECK(drawn > 300);
}

TEST_CASE("misuse: C face, scenes of damaged bytes and anything for a handle -> refused, or safe to draw") {
  const CWorld world;
  const std::vector<std::uint8_t> deep_scene = small_scene(9);
  const ConstBytes deep(deep_scene.data(), deep_scene.size());
  int opened = 0;
  misuse(72, 2500, [&](OddValues& values) {
    Things things(world);
    Odd odd(values, 10);
    const HeapBytes bytes = damaged(values, values.one_in(3) ? deep : world.bytes());
    thimble_scene_t scene = {};
    (void)thimble_scene_validate(values.one_in(9) ? nullptr : bytes.span().data, bytes.span().size, nullptr);
    const std::int32_t status =
        thimble_scene_open(&scene, values.one_in(9) ? nullptr : bytes.span().data, bytes.span().size);
    CHECK((status == THIMBLE_OK || status == THIMBLE_DAMAGED || status == THIMBLE_BAD_ARGUMENT));
    if (status != THIMBLE_OK) {
      CHECK(scene.opaque[0] == 0);
    }
    check(thimble_scene_open(odd.target(&things.scene), world.bytes().data, world.bytes().size), odd);
    thimble_scene_info_t info = {};
    thimble_tree_info_t tree_info = {};
    if (status == THIMBLE_OK) {
      ++opened;
      REQUIRE(thimble_scene_get_info(&scene, &info) == THIMBLE_OK);
      thimble_camera_t camera = things.camera;
      thimble_shading_t shading;
      REQUIRE(thimble_scene_shading(&scene, &shading) == THIMBLE_OK);
      (void)thimble_scene_camera(&scene, nullptr, 24, 16, &camera);
      std::uint8_t pixels[24 * 16];
      const thimble_band_t band = {pixels, sizeof pixels, 0, THIMBLE_FORMAT_GRAY8, 0, 16};
      (void)thimble_scene_render(&scene, &camera, &shading, &band);
      thimble_light_t light = {};
      if (thimble_scene_light(&scene, &light) == THIMBLE_OK) {
        (void)thimble_scene_render_lit(&scene, &light, thimble_light_effects(&light), &camera, &shading,
                                       &band);
        thimble_lamp_t lamp;
        (void)thimble_light_lamp(&light, values.any<std::uint32_t>(), &lamp);
      }
      thimble_bricks_t bricks = {};
      if (thimble_scene_bricks(&scene, &bricks) == THIMBLE_OK) {
        (void)thimble_scene_render_fast(&scene, &bricks, &camera, &shading, &band);
      }
    }
    thimble_view_t view = {};
    thimble_shading_t shading = {};
    thimble_lamp_t lamp = {};
    check(thimble_scene_get_info(odd.handle(&things.scene), odd.data(&info)), odd);
    check(thimble_scene_tree(odd.handle(&things.scene), odd.target(&things.tree)), odd);
    check(thimble_scene_view(odd.handle(&things.scene), odd.data(&view)), odd);
    check(thimble_scene_shading(odd.handle(&things.scene), odd.data(&shading)), odd);
    check(thimble_scene_bricks(odd.handle(&things.scene), odd.target(&things.bricks)), odd);
    check(thimble_scene_light(odd.handle(&things.scene), odd.target(&things.light)), odd);
    check(thimble_light_lamp(odd.handle(&things.light), values.any<std::uint32_t>(), odd.data(&lamp)), odd);
    (void)thimble_light_effects(odd.handle(&things.light));
    (void)thimble_light_lamps(odd.handle(&things.light));
    (void)odd.spoiled();
    check(thimble_tree_get_info(odd.handle(&things.tree), odd.data(&tree_info)), odd);
    check(thimble_tree_open(odd.target(&things.tree), world.compact.bytes(), world.compact.size_bytes()),
          odd);
    (void)thimble_status_text(values.any<std::int32_t>());
    (void)thimble_effect_name(values.any<std::uint32_t>());
    thimble_view_default(odd.data(&view));
    thimble_shading_default(odd.data(&shading));
    (void)odd.spoiled();
  });
  CHECK(opened > 100);
}

TEST_CASE("misuse: C face, edited worlds with any numbers -> a status, and the world is whole") {
  const CWorld world;
  misuse(74, 1500, [&](OddValues& values) {
    Things things(world);
    Odd odd(values, 25);
    const std::size_t least = thimble_world_bytes(&things.tree);
    REQUIRE(least != 0);
    (void)thimble_world_bytes(odd.handle(&things.tree));
    HeapBytes room(least + 64 + values.bits() % 4000 / 8 * 8);
    HeapBytes entries(values.bits() % 900);
    thimble_world_t edited = {};
    thimble_journal_t journal = {};
    REQUIRE(thimble_world_make(&edited, &things.tree, room.span().data, room.span().size) == THIMBLE_OK);
    REQUIRE(thimble_journal_make(&journal, entries.span().data, entries.span().size) == THIMBLE_OK);
    CHECK(thimble_world_make(&edited, &things.tree, nullptr, 100) == THIMBLE_BAD_ARGUMENT);
    CHECK(thimble_world_make(&edited, &things.tree, room.span().data, least - 1) == THIMBLE_OUT_OF_MEMORY);
    (void)odd.spoiled();
    const auto number = [&] { return values.any_or(4, -1, 16); };
    for (int i = 0; i < 30; ++i) {
      const std::int32_t material = values.any_or(4, -1, 3);
      thimble_box_t box = {{number(), number(), number()}, {}};
      box.high = {box.low.x / 2 + number() % 8, box.low.y / 2 + 5, box.low.z / 2 + 9};
      check(thimble_world_put(odd.handle(&edited), number(), number(), number(), material), odd);
      check(thimble_world_edit(odd.handle(&edited), odd.handle(&journal), odd.data(&box),
                               values.any_or(4, 0, 1), material),
            odd);
      (void)thimble_world_material(odd.handle(&edited), number(), number(), number());
      (void)odd.spoiled();
      thimble_hit_t hit;
      check(thimble_world_tree(odd.handle(&edited), odd.target(&things.tree)), odd);
      check(thimble_world_bricks(odd.handle(&edited), odd.target(&things.bricks)), odd);
      check(thimble_tree_pick(odd.handle(&things.tree), odd.handle(&things.camera), number(), number(),
                              odd.data(&hit)),
            odd);
      if (values.one_in(3)) {
        check(thimble_world_undo(odd.handle(&edited), odd.handle(&journal)), odd);
      }
    }
    std::size_t size = 0;
    REQUIRE(thimble_world_pack(&edited, nullptr, 0, &size) == THIMBLE_OUT_OF_MEMORY);
    HeapBytes packed(size);
    REQUIRE(thimble_world_pack(&edited, packed.span().data, size, nullptr) == THIMBLE_OK);
    REQUIRE(CompactTree::validate(packed.span()) == nullptr);
  });
}

TEST_CASE("misuse: C face, octrees and particles with any numbers -> a status, and the world is whole") {
  const CWorld world;
  misuse(73, 1500, [&](OddValues& values) {
    Things things(world);
    Odd odd(values, 25);
    (void)thimble_octree_bytes(values.any<std::uint32_t>());
    HeapBytes pool(values.bits() % 4000);
    (void)thimble_octree_make(&things.octree, values.one_in(2) ? values.any<std::int32_t>() : 4,
                              values.one_in(9) ? nullptr : pool.span().data, pool.span().size);
    thimble_octree_info_t info;
    REQUIRE(thimble_octree_get_info(&things.octree, &info) == THIMBLE_OK);
    const auto number = [&] { return values.any_or(4, -1, 16); };
    for (int i = 0; i < 30; ++i) {
      const std::int32_t material = values.any_or(4, 0, 3);
      const thimble_box_t box = {{number(), number(), number()}, {number(), number(), number()}};
      check(thimble_octree_insert(odd.handle(&things.octree), number(), number(), number(), material), odd);
      check(thimble_octree_erase(odd.handle(&things.octree), number(), number(), number()), odd);
      check(thimble_octree_insert_box(odd.handle(&things.octree), odd.data(&box), material), odd);
      (void)thimble_octree_contains(odd.handle(&things.octree), number(), number(), number());
      (void)thimble_octree_material(odd.handle(&things.octree), number(), number(), number());
      (void)odd.spoiled();
    }
    check(thimble_octree_set_coarsen(odd.handle(&things.octree), values.any<std::int32_t>()), odd);
    check(thimble_octree_get_info(odd.handle(&things.octree), odd.data(&info)), odd);
    HeapBytes tree(odd_size(values, thimble_tree_bytes(&things.octree)));
    check(thimble_tree_make(odd.target(&things.tree), odd.handle(&things.octree), tree.span().data,
                            tree.span().size),
          odd);
    CHECK(thimble_tree_make(&things.tree, &things.octree, nullptr, 100) == THIMBLE_BAD_ARGUMENT);
    check(thimble_octree_clear(odd.handle(&things.octree)), odd);

    thimble_particle_config_t config = things.config;
    const auto field = [&](std::int32_t* value) {
      *value = values.one_in(5) ? values.any<std::int32_t>() : *value;
    };
    field(&config.width);
    field(&config.height);
    field(&config.least_diameter);
    field(&config.most_diameter);
    field(&config.gravity_x_q16);
    field(&config.gravity_y_q16);
    field(&config.substeps_log2);
    field(&config.subpixel_bits);
    config.capacity = values.one_in(5) ? values.any<std::uint32_t>() : config.capacity;
    config.restitution_q16 = values.one_in(5) ? values.any<std::uint32_t>() : config.restitution_q16;
    HeapBytes memory(odd_size(values, thimble_particles_bytes(&config)));
    check(thimble_particles_make(odd.target(&things.particles), odd.data(&config),
                                 values.one_in(9) ? nullptr : memory.span().data,
                                 values.one_in(2) ? memory.span().size : 0),
          odd);
    HeapBytes again(thimble_particles_bytes(&things.config));
    REQUIRE(thimble_particles_make(&things.particles, &things.config, again.span().data, again.span().size) ==
            THIMBLE_OK);
    for (int i = 0; i < 12; ++i) {
      const auto cell = [&] { return values.any_or(3, -9, 70); };
      const auto speed = [&] { return values.any_or(3, -99999, 99999); };
      const auto cell_q16 = [&] { return values.any_or(4, -(9 << 16), 70 << 16); };
      std::int32_t id = 0;
      thimble_particle_t particle;
      check(thimble_particles_add(odd.handle(&things.particles), cell_q16(), cell_q16(), speed(), speed(),
                                  values.between_32(-1, 17), values.one_in(2) ? nullptr : &id),
            odd);
      check(thimble_particles_add_random(odd.handle(&things.particles), speed(), &id), odd);
      check(thimble_particles_set_velocity(odd.handle(&things.particles), cell(), speed(), speed()), odd);
      check(thimble_particles_set_gravity(odd.handle(&things.particles), speed(), speed()), odd);
      check(thimble_particles_draw_box(odd.handle(&things.particles), cell(), cell(), cell(), cell()), odd);
      check(thimble_particles_erase_box(odd.handle(&things.particles), cell(), cell(), cell(), cell()), odd);
      check(thimble_particles_step(odd.handle(&things.particles)), odd);
      check(thimble_particles_get(odd.handle(&things.particles), cell(), odd.data(&particle)), odd);
      check(thimble_particles_remove(odd.handle(&things.particles), cell()), odd);
      thimble_particles_info_t info_now;
      check(thimble_particles_get_info(odd.handle(&things.particles), odd.data(&info_now)), odd);
      (void)thimble_particles_at(odd.handle(&things.particles), cell(), cell());
      (void)thimble_particles_cells(odd.handle(&things.particles), cell(), cell());
      (void)thimble_particles_crc32(odd.handle(&things.particles));
      (void)odd.spoiled();
    }
    thimble_particle_config_default(nullptr);
    CHECK(thimble_particles_bytes(nullptr) == 0);
  });
}
