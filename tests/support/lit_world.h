/// Small worlds for the tests of lit pictures: boxes and voxels, a camera, a picture as a list of colours.
#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/light/render.h"
#include "thimble/picture/camera.h"

namespace thimble::testing {

/// Not to be moved: the tree points into it.
class LitWorld {
 public:
  explicit LitWorld(int level = 5, std::uint32_t nodes = 60000) : surfaces(16), pool_(level, nodes) {}
  LitWorld(const LitWorld&) = delete;
  LitWorld& operator=(const LitWorld&) = delete;

  void box(const Vec3i& min, const Vec3i& max, int material) {
    REQUIRE(pool_.octree.insert_box({min, max}, static_cast<std::uint8_t>(material)) == Status::kOk);
  }
  void voxel(const Vec3i& at, int material) {
    REQUIRE(pool_.octree.insert(at, static_cast<std::uint8_t>(material)) == Status::kOk);
  }
  /// The tree and the scene of what was put in.
  void finish() {
    tree_bytes_ = tests::compact_of(pool_.octree);
    tree = tests::open_or_throw(tree_bytes_);
    scene.surfaces = {surfaces.data(), surfaces.size()};
    scene.lights = {lights.data(), lights.size()};
  }
  /// A camera at `eye` that looks at `target`, both in 1/256 voxel.
  void look(const Vec3i& eye, const Vec3i& target, int fov = 60, int width = 48, int height = 36) {
    const Vec3Q8 from = point(eye);
    const Vec3i forward = look_at(from, point(target));
    REQUIRE(camera.set(PerspectiveView{from, forward, {}, Q16::saturate(fov), width, height, 0},
                       tree.level()) == Status::kOk);
  }
  /// A parallel camera that looks down along z.
  void look_straight_down(const Vec3i& eye_q8, std::int32_t span_q14, int width, int height) {
    REQUIRE(
        camera.set(
            OrthographicView{point(eye_q8), {0, 0, -1}, {0, 1, 0}, Q14::from_raw(span_q14), width, height, 0},
            tree.level()) == Status::kOk);
  }
  static Vec3Q8 point(const Vec3i& raw) {
    return {Q8::from_raw(raw.x), Q8::from_raw(raw.y), Q8::from_raw(raw.z)};
  }

  /// What calls for every effect: 1 metal, 2 glass, 3 lamp, 4 cloud, 5 rough metal; water is to be set.
  void call_for_everything();
  /// Greys and depth cues between what is solid.
  void set_depth_range() {
    const DepthRange range = depth_range(camera, tree.bounds());
    shading.near_q8 = range.near_q8;
    shading.far_q8 = range.far_q8;
  }

  /// The picture that `draw(band)` draws.
  template <class Draw>
  std::vector<Rgb8> picture_of(const Draw& draw) const {
    std::vector<std::uint8_t> bytes(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
    REQUIRE(draw(Band{{bytes.data(), bytes.size()}, PixelFormat::kRgb888, 0, 0, camera.height_px()}) ==
            Status::kOk);
    std::vector<Rgb8> picture;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      picture.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
    }
    return picture;
  }
  std::vector<Rgb8> draw(EffectSet effects, LitCounts* counts = nullptr) const {
    return picture_of([&](const Band& band) {
      return render_lit_band(effects, tree, camera, shading, scene, band, counts);
    });
  }
  Rgb8 middle(EffectSet effects) const {
    const std::vector<Rgb8> picture = draw(effects);
    return picture[static_cast<std::size_t>(camera.height_px() / 2 * camera.width_px() +
                                            camera.width_px() / 2)];
  }

  CompactTree tree;
  Camera camera;
  Shading shading;
  LitScene scene;
  std::vector<Surface> surfaces;
  std::vector<Light> lights;

 private:
  tests::OwnedPool pool_;
  tests::HeapBytes tree_bytes_;
};

inline Surface surface(SurfaceKind kind, const Rgb8& albedo) {
  Surface made;
  made.kind = kind;
  made.albedo = albedo;
  return made;
}
/// What light passes, bent where its index says so.
inline Surface medium(SurfaceKind kind, const Rgb8& albedo, int density_q8, int index_q12 = kMinIndexQ12) {
  Surface made = surface(kind, albedo);
  made.density_q8 = static_cast<std::uint16_t>(density_q8);
  made.index_q12 = static_cast<std::uint16_t>(index_q12);
  return made;
}
inline void LitWorld::call_for_everything() {
  surfaces[1] = surface(SurfaceKind::kMetal, {220, 210, 190});
  surfaces[2] = surface(SurfaceKind::kGlass, {220, 240, 230});
  surfaces[3] = surface(SurfaceKind::kEmit, {255, 200, 90});
  surfaces[4] = surface(SurfaceKind::kMedia, {240, 240, 250});
  surfaces[5] = surface(SurfaceKind::kMetal, {200, 160, 90});
  surfaces[5].roughness = 80;
  surfaces[5].mirror = 200;
  scene.has_shadows = true;
  scene.has_sky = true;
  scene.has_depth_cue = true;
  scene.fog.density_q16 = 300;
  scene.occlusion.rays = 8;
  scene.has_water = true;
}
inline Light sun(const Vec3i& toward, int brightness = 256) {
  Light light;
  light.place = toward;
  for (PackedU16& channel : light.color_q8) {
    channel = static_cast<std::uint16_t>(brightness);
  }
  return light;
}
inline Light lamp(const Vec3i& place_q8, int brightness = 256, int reach = 32) {
  Light light = sun(place_q8, brightness);
  light.is_point = true;
  light.reach = static_cast<std::uint16_t>(reach);
  return light;
}
inline void set_ambient(LitScene* scene, int brightness) {
  for (std::uint16_t& channel : scene->ambient_q8) {
    channel = static_cast<std::uint16_t>(brightness);
  }
}

}  // namespace thimble::testing
