// Pictures and rays through the C face against those of C++: the same bytes and the same numbers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "c/c_world.h"
#include "thimble/light/render.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/render.h"
#include "thimble/trace/secondary_ray.h"

// thimble_scene_render_lit, compiled for one set (tests/CMakeLists.txt).
extern "C" std::int32_t thimble_scene_render_lit_of_set(const thimble_scene_t* scene,
                                                        const thimble_light_t* light, std::uint32_t effects,
                                                        const thimble_camera_t* camera,
                                                        const thimble_shading_t* shading,
                                                        const thimble_band_t* band);

namespace {

using namespace thimble;
using namespace thimble::tests;
using Picture = std::vector<std::uint8_t>;

constexpr std::int32_t kWidth = 43;
constexpr std::int32_t kHeight = 37;

// Every format that there is, by its number in C.
std::vector<std::int32_t> formats() {
  std::vector<std::int32_t> all;
  for (std::int32_t format = -1; format <= 300; ++format) {
    if (thimble_band_row_multiple(format) != 0) {
      all.push_back(format);
    }
  }
  return all;
}

// The octree of C, filled as that of C++ is.
struct COctree {
  COctree() : pool(thimble_octree_bytes(20000)) {
    REQUIRE(thimble_octree_make(&octree, kWorldLevel, pool.data(), pool.size()) == THIMBLE_OK);
    CWorld::fill(octree, 0);
  }
  std::vector<std::uint8_t> pool;
  thimble_octree_t octree = {};
};

// The picture in bands of some rows, the last one lower, from the bottom up. `draw(band)` is a C function's status.
template <class Draw>
Picture c_picture(std::int32_t format, Draw&& draw) {
  const std::int32_t rows = 8 * thimble_band_row_multiple(format);
  Picture picture(thimble_band_bytes(format, kWidth, kHeight), 0xA5);
  for (std::int32_t first = (kHeight - 1) / rows * rows; first >= 0; first -= rows) {
    thimble_band_t band = {};
    band.pixels = picture.data() + thimble_band_bytes(format, kWidth, first);
    band.rows = std::min(rows, kHeight - first);
    band.size_bytes = thimble_band_bytes(format, kWidth, band.rows);
    band.format = format;
    band.first_row = first;
    REQUIRE(draw(&band) == THIMBLE_OK);
  }
  return picture;
}
// The whole of it at once. `draw(band)` is a Status of C++.
template <class Draw>
Picture cpp_picture(std::int32_t format, Draw&& draw) {
  Picture picture(band_bytes(static_cast<PixelFormat>(format), kWidth, kHeight));
  REQUIRE(draw(Band{{picture.data(), picture.size()}, static_cast<PixelFormat>(format), 0, 0, kHeight}) ==
          Status::kOk);
  return picture;
}

struct Look {
  thimble_view_t view;
  Camera camera;
  Shading shading;
  thimble_camera_t c_camera;
  thimble_shading_t c_shading;
};

// The scene's own view, from another place, and in parallel; in every mode.
std::vector<Look> looks(const CWorld& world, const thimble_scene_t& scene) {
  std::vector<Look> all;
  for (int place = 0; place < 3; ++place) {
    for (std::int32_t mode = THIMBLE_SHADE_DEPTH; mode <= THIMBLE_SHADE_MONO; ++mode) {
      Look look = {};
      SceneCamera camera = world.scene.camera();
      REQUIRE(thimble_scene_view(&scene, &look.view) == THIMBLE_OK);
      if (place != 0) {
        camera.eye.x = Q8::from_raw(look.view.eye_q8.x += 1234);
        camera.forward = {};
        look.view.forward = {};
      }
      if (place == 2) {
        camera.is_perspective = false;
        camera.span = Q14::saturate(40);
        camera.up = {1, 2, 9};
        camera.direction_bits = 14;
        look.view.projection = THIMBLE_ORTHOGRAPHIC;
        look.view.span_q14 = 40 << 14;
        look.view.up = {1, 2, 9};
        look.view.direction_bits = 14;
      }
      REQUIRE(set_camera(camera, kWidth, kHeight, kWorldLevel, &look.camera) == Status::kOk);
      REQUIRE(thimble_camera_set(&look.c_camera, &look.view, kWidth, kHeight, kWorldLevel) == THIMBLE_OK);
      look.shading.mode = static_cast<ShadeMode>(mode);
      look.shading.palette = world.scene.palette();
      look.shading.background = {9, 99, 199};
      const DepthRange range = depth_range(look.camera, world.compact.bounds());
      look.shading.near_q8 = range.near_q8;
      look.shading.far_q8 = range.far_q8;
      light_from({-3, -5, 11}, look.shading.face_light);
      thimble_scene_info_t info;
      REQUIRE(thimble_scene_get_info(&scene, &info) == THIMBLE_OK);
      REQUIRE(thimble_scene_shading(&scene, &look.c_shading) == THIMBLE_OK);
      CHECK(look.c_shading.mode == THIMBLE_SHADE_COLOR);
      REQUIRE(thimble_shading_planes(&look.c_shading, &look.c_camera, &info.tree.bounds) == THIMBLE_OK);
      REQUIRE(thimble_shading_light(&look.c_shading, -3, -5, 11) == THIMBLE_OK);
      look.c_shading.mode = mode;
      look.c_shading.background_rgb[0] = 9;
      look.c_shading.background_rgb[1] = 99;
      look.c_shading.background_rgb[2] = 199;
      all.push_back(look);
    }
  }
  return all;
}

bool same(const thimble_vec3_t& a, const Vec3i& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}
bool same(const thimble_vec3_t& a, const Vec3Q8& b) {
  return a.x == b.x.raw && a.y == b.y.raw && a.z == b.z.raw;
}

// A hit as C tells it is that of C++, and its other forms follow from the fraction.
void check_hit(const thimble_hit_t& told, const Ray& ray, const Hit& hit) {
  REQUIRE(told.kind == static_cast<std::int32_t>(hit.kind));
  CHECK(told.visits == hit.visits);
  if (hit.kind != HitKind::kHit) {
    return;
  }
  CHECK(same(told.voxel, hit.voxel));
  CHECK(told.axis == hit.axis);
  CHECK(told.material == hit.material);
  CHECK(told.block_level == hit.block_level);
  CHECK(told.t_numerator == hit.t_numerator);
  CHECK(told.t_denominator == hit.t_denominator);
  CHECK(told.side == (hit.axis < 0 ? 0 : ray.direction[hit.axis] > 0 ? -1 : 1));
  __extension__ using Wide = unsigned __int128;
  const Wide t = (static_cast<Wide>(static_cast<std::uint32_t>(hit.t_numerator)) << 32) /
                 static_cast<std::uint32_t>(hit.t_denominator);
  CHECK(static_cast<Wide>(static_cast<std::uint64_t>(told.t_q32)) == t);
  CHECK(same(told.point_q8, start_on_face(ray, hit)));
}

}  // namespace

TEST_CASE("C face: scene, tree and octree in every format, mode and projection -> the bytes of C++") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_tree_t tree = {};
  REQUIRE(thimble_scene_tree(&scene, &tree) == THIMBLE_OK);
  const COctree filled;
  REQUIRE(formats().size() == std::size_t{kPixelFormats});
  for (const Look& look : looks(world, scene)) {
    for (const std::int32_t format : formats()) {
      CAPTURE(format);
      CAPTURE(look.c_shading.mode);
      CAPTURE(look.view.projection);
      const Picture expected = cpp_picture(format, [&](const Band& band) {
        return render_band(world.scene.tree(), look.camera, look.shading, band);
      });
      CHECK(std::any_of(expected.begin(), expected.end(), [&](auto byte) { return byte != expected[0]; }));
      const auto draws = [&](auto&& draw) {
        return c_picture(format, [&](const thimble_band_t* band) {
                 return draw(&look.c_camera, &look.c_shading, band);
               }) == expected;
      };
      CHECK(draws([&](auto... rest) { return thimble_scene_render(&scene, rest...); }));
      CHECK(draws([&](auto... rest) { return thimble_tree_render(&tree, rest...); }));
      CHECK(draws([&](auto... rest) { return thimble_octree_render(&filled.octree, rest...); }));
      thimble_bricks_t bricks;
      REQUIRE(thimble_scene_bricks(&scene, &bricks) == THIMBLE_OK);
      CHECK(draws([&](auto... rest) { return thimble_scene_render_fast(&scene, &bricks, rest...); }));
    }
  }
}

TEST_CASE("C face: bytes of a band -> those of C++; an unknown format, a negative size -> 0") {
  for (const std::int32_t format : formats()) {
    for (const auto& [width, rows] : {std::pair{0, 0}, {1, 1}, {43, 37}, {16384, 16384}}) {
      CHECK(thimble_band_bytes(format, width, rows) ==
            band_bytes(static_cast<PixelFormat>(format), width, rows));
    }
    CHECK(thimble_band_bytes(format, -1, 4) == 0);
    CHECK(thimble_band_bytes(format, 4, -1) == 0);
    CHECK(thimble_band_bytes(format, 16385, 1) == 0);
    CHECK(thimble_band_bytes(format, 1, INT32_MAX) == 0);
  }
  for (const std::int32_t format : {-1, 200, 255, 256, 260, INT32_MIN, INT32_MAX}) {
    CHECK(thimble_band_bytes(format, 8, 8) == 0);
    CHECK(thimble_frame_bytes(format, 8, 8) == 0);
    CHECK(thimble_band_row_multiple(format) == 0);
  }
}

TEST_CASE("C face: another scene's brick map -> damaged; none in the scene -> damaged, as it was") {
  const CWorld world;
  const CWorld other(1);
  const CWorld bare(0, false);
  const thimble_scene_t scene = world.opened();
  const thimble_scene_t other_scene = other.opened();
  const thimble_scene_t bare_scene = bare.opened();
  thimble_bricks_t bricks = {};
  CHECK(thimble_scene_bricks(&bare_scene, &bricks) == THIMBLE_DAMAGED);
  CHECK(bricks.opaque[0] == 0);
  REQUIRE(thimble_scene_bricks(&other_scene, &bricks) == THIMBLE_OK);
  const Look look = looks(world, scene).front();
  Picture picture(kWidth);
  const thimble_band_t band = {picture.data(), picture.size(), 0, THIMBLE_FORMAT_GRAY8, 0, 1};
  CHECK(thimble_scene_render_fast(&scene, &bricks, &look.c_camera, &look.c_shading, &band) ==
        THIMBLE_DAMAGED);
}

TEST_CASE(
    "C face: bands that are too small, outside the picture, with gaps -> what C++ says, byte for byte") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  const Look look = looks(world, scene)[2];
  std::mt19937 random(7);
  int drawn = 0;
  for (int round = 0; round < 3000; ++round) {
    Picture c_bytes(600, 0x5A);
    Picture cpp_bytes = c_bytes;
    const std::int32_t format = formats()[random() % formats().size()];
    const std::size_t size = random() % (c_bytes.size() + 1);
    const std::size_t stride = random() % 3 == 0 ? 0 : random() % 200;
    const std::int32_t first = static_cast<std::int32_t>(random() % 44) - 3;
    const std::int32_t rows = static_cast<std::int32_t>(random() % 8) - 2;
    const Band band{{cpp_bytes.data(), size}, static_cast<PixelFormat>(format), stride, first, rows};
    const thimble_band_t c_band = {c_bytes.data(), size, stride, format, first, rows};
    const Status status = render_band(world.scene.tree(), look.camera, look.shading, band);
    CHECK(thimble_scene_render(&scene, &look.c_camera, &look.c_shading, &c_band) ==
          static_cast<std::int32_t>(status));
    CHECK(c_bytes == cpp_bytes);
    drawn += status == Status::kOk && rows > 0 ? 1 : 0;
  }
  CHECK(drawn > 50);
}

TEST_CASE("C face: the rays of every pixel, and what is under it -> those of C++") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  int hits = 0;
  for (const Look& look : looks(world, scene)) {
    std::int32_t width = 0;
    std::int32_t height = 0;
    REQUIRE(thimble_camera_size(&look.c_camera, &width, &height) == THIMBLE_OK);
    REQUIRE(width == kWidth);
    REQUIRE(height == kHeight);
    for (std::int32_t y = 0; y < height; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        const Ray ray = look.camera.ray(x, y);
        thimble_ray_t c_ray = {};
        REQUIRE(thimble_camera_ray(&look.c_camera, x, y, &c_ray) == THIMBLE_OK);
        REQUIRE(same(c_ray.origin_q8, ray.origin));
        REQUIRE(same(c_ray.direction, ray.direction));
        thimble_hit_t picked;
        REQUIRE(thimble_scene_pick(&scene, &look.c_camera, x, y, &picked) == THIMBLE_OK);
        Hit hit;
        REQUIRE(closest_hit(world.compact, ray, &hit) == Status::kOk);
        check_hit(picked, ray, hit);
        hits += picked.kind == THIMBLE_HIT ? 1 : 0;
      }
    }
    thimble_hit_t hit = {};
    hit.material = 77;
    for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {kWidth, 0}, {0, kHeight}}) {
      CHECK(thimble_scene_pick(&scene, &look.c_camera, x, y, &hit) == THIMBLE_OUT_OF_RANGE);
      thimble_ray_t ray = {};
      CHECK(thimble_camera_ray(&look.c_camera, x, y, &ray) == THIMBLE_OUT_OF_RANGE);
    }
    CHECK(hit.material == 77);
  }
  CHECK(hits > 1000);
}

TEST_CASE("C face: rays from anywhere, with and without a limit of visits -> the hits of C++") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_tree_t tree = {};
  REQUIRE(thimble_scene_tree(&scene, &tree) == THIMBLE_OK);
  const COctree filled;
  std::mt19937 random(11);
  const auto between = [&](std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(high - low + 1));
  };
  int kinds[3] = {};
  int inside = 0;
  for (int round = 0; round < 4000; ++round) {
    Ray ray;
    for (int axis = 0; axis < 3; ++axis) {
      const bool far = random() % 2 == 0;
      ray.origin[axis] = Q8::from_raw(far ? between(-32768, 40960) : between(0, 8192));
      ray.direction[axis] =
          random() % 2 == 0 ? between(-3, 3) : between(-kMaxDirection - 2, kMaxDirection + 2);
    }
    const std::uint32_t limit = random() % 3 == 0 ? static_cast<std::uint32_t>(random() % 12) : UINT32_MAX;
    const thimble_ray_t c_ray = {{ray.origin.x.raw, ray.origin.y.raw, ray.origin.z.raw},
                                 {ray.direction.x, ray.direction.y, ray.direction.z}};
    Hit hit;
    Hit pool_hit;
    const Status status = closest_hit(world.compact, ray, &hit, {limit, Width::kAuto});
    thimble_hit_t told = {};
    CHECK(thimble_scene_trace(&scene, &c_ray, limit, &told) == static_cast<std::int32_t>(status));
    if (status != Status::kOk) {
      CHECK(told.t_denominator == 0);  // as it was
      continue;
    }
    check_hit(told, ray, hit);
    ++kinds[told.kind];
    inside += told.kind == THIMBLE_HIT && told.axis < 0 ? 1 : 0;
    REQUIRE(thimble_tree_trace(&tree, &c_ray, limit, &told) == THIMBLE_OK);
    check_hit(told, ray, hit);
    REQUIRE(closest_hit(world.octree, ray, &pool_hit, {limit, Width::kAuto}) == Status::kOk);
    REQUIRE(thimble_octree_trace(&filled.octree, &c_ray, limit, &told) == THIMBLE_OK);
    check_hit(told, ray, pool_hit);
  }
  CHECK(kinds[THIMBLE_MISS] > 50);
  CHECK(kinds[THIMBLE_HIT] > 50);
  CHECK(kinds[THIMBLE_STOPPED] > 50);
  CHECK(inside > 10);
}

TEST_CASE("C face: every effect alone and many together -> the lit bytes of C++") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_light_t light = {};
  REQUIRE(thimble_scene_light(&scene, &light) == THIMBLE_OK);
  CHECK(thimble_light_effects(&light) == world.lighting.effects);
  CHECK((world.lighting.effects & Effect::kShadows) != 0);
  const std::vector<Look> all = looks(world, scene);
  std::vector<std::uint32_t> sets = {0, Effect::kAll, 0xFFFFFFFFU, world.lighting.effects};
  for (int effect = 0; effect < Effect::kCount; ++effect) {
    sets.push_back(1U << effect);
    sets.push_back(Effect::kAll & ~(1U << effect));
  }
  int number = 0;
  for (const std::uint32_t set : sets) {
    CAPTURE(set);
    const Look& look = all[static_cast<std::size_t>(number) % all.size()];
    const std::int32_t format = formats()[static_cast<std::size_t>(number++) % formats().size()];
    const Picture expected = cpp_picture(format, [&](const Band& band) {
      return render_lit_band(set, world.scene.tree(), look.camera, look.shading, world.lighting.scene, band);
    });
    CHECK(c_picture(format, [&](const thimble_band_t* band) {
            return thimble_scene_render_lit(&scene, &light, set, &look.c_camera, &look.c_shading, band);
          }) == expected);
  }
}

TEST_CASE("C face: compiled for a set of effects -> the same bytes for that set, other sets are refused") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_light_t light = {};
  REQUIRE(thimble_scene_light(&scene, &light) == THIMBLE_OK);
  const Look look = looks(world, scene)[2];
  // What tests/CMakeLists.txt compiled it for.
  constexpr std::uint32_t kSet = Effect::kDirectLight | Effect::kShadows | Effect::kFog | Effect::kSky;
  for (const std::uint32_t set : {kSet, kSet & ~Effect::kFog, kSet & ~Effect::kSky & ~Effect::kDirectLight}) {
    CAPTURE(set);
    const Picture expected = cpp_picture(THIMBLE_FORMAT_RGB888, [&](const Band& band) {
      return render_lit_band(set, world.scene.tree(), look.camera, look.shading, world.lighting.scene, band);
    });
    CHECK(c_picture(THIMBLE_FORMAT_RGB888, [&](const thimble_band_t* band) {
            return thimble_scene_render_lit_of_set(&scene, &light, set, &look.c_camera, &look.c_shading,
                                                   band);
          }) == expected);
  }
  Picture untouched(kWidth, 0x77);
  const thimble_band_t band = {untouched.data(), untouched.size(), 0, THIMBLE_FORMAT_GRAY8, 0, 1};
  for (const std::uint32_t set : {std::uint32_t{0}, kSet & ~Effect::kShadows, kSet | Effect::kMirror,
                                  kSet | Effect::kEmission, std::uint32_t{Effect::kAll}}) {
    CAPTURE(set);
    CHECK(thimble_scene_render_lit_of_set(&scene, &light, set, &look.c_camera, &look.c_shading, &band) ==
          THIMBLE_OUT_OF_RANGE);
  }
  CHECK(untouched == Picture(kWidth, 0x77));
}

TEST_CASE("C face: a frame that is refined -> the picture of C++ after every step, the exact one at last") {
  const CWorld world;
  const thimble_scene_t scene = world.opened();
  thimble_tree_t tree = {};
  REQUIRE(thimble_scene_tree(&scene, &tree) == THIMBLE_OK);
  const Look look = looks(world, scene)[2];
  for (const std::int32_t format : formats()) {
    const std::size_t size = thimble_frame_bytes(format, kWidth, kHeight);
    REQUIRE(size == anytime_bytes(kWidth, kHeight, static_cast<PixelFormat>(format)));
    Picture c_bytes(size, 1);
    Picture cpp_bytes(size, 2);
    thimble_frame_t frame = {};
    AnytimeFrame expected;
    CHECK(thimble_frame_make(&frame, &tree, &look.c_camera, &look.c_shading, format, c_bytes.data(),
                             size - 1) == THIMBLE_OUT_OF_MEMORY);
    CHECK(frame.opaque[0] == 0);
    REQUIRE(thimble_frame_make(&frame, &tree, &look.c_camera, &look.c_shading, format, c_bytes.data(),
                               size) == THIMBLE_OK);
    REQUIRE(AnytimeFrame::make(world.scene.tree(), look.camera, look.shading,
                               static_cast<PixelFormat>(format), {cpp_bytes.data(), size},
                               &expected) == Status::kOk);
    CHECK(c_bytes == cpp_bytes);
    int steps = 0;
    while (thimble_frame_inexact(&frame) != 0 && steps < 1000) {
      REQUIRE(thimble_frame_refine(&frame, &tree, 3000) == THIMBLE_OK);
      REQUIRE(expected.refine(world.scene.tree(), 3000) == Status::kOk);
      CHECK(thimble_frame_inexact(&frame) == expected.inexact());
      CHECK(c_bytes == cpp_bytes);
      ++steps;
    }
    CHECK(steps > 1);
    CHECK(expected.done());
    const Picture exact = c_picture(format, [&](const thimble_band_t* band) {
      return thimble_tree_render(&tree, &look.c_camera, &look.c_shading, band);
    });
    CHECK(std::equal(exact.begin(), exact.end(), c_bytes.begin()));
  }
}
