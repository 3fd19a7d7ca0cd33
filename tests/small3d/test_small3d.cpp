// What stands between small3dlib and a voxel model (benchmarks/small3d): the faces, the camera, the judge; by a stand-in
// of that library.
#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "thimble/trace/ray.h"

#define THIMBLE_SMALL3DLIB_HEADER "small3d/small3dlib.h"
#include "benchmarks/small3d/small3d_drawing.h"
#include "scene/baking.h"

namespace thimble {
namespace {

using benchmarks::FaceRect;
using benchmarks::kSmall3dHeightPx;
using benchmarks::kSmall3dPixels;
using benchmarks::kSmall3dWidthPx;
using benchmarks::Small3dDrawing;
using benchmarks::Small3dTuning;
using benchmarks::VoxelFaces;
using benchmarks::wrong_pixels;

std::unique_ptr<tools::SceneSource> small3d_scene(const char* name) {
  tools::SceneArguments arguments;
  arguments.scene = name;
  return tools::open_scene(arguments);
}

Camera small3d_camera(int level) {
  const std::int32_t side = 256 << level;
  PerspectiveView view;
  view.width_px = kSmall3dWidthPx;
  view.height_px = kSmall3dHeightPx;
  view.eye = {Q8::from_raw(-side * 2 / 3), Q8::from_raw(-side), Q8::from_raw(side * 3 / 2)};
  view.forward = look_at(view.eye, {Q8::from_raw(side / 2), Q8::from_raw(side / 2), Q8::from_raw(side / 2)});
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

std::vector<std::uint32_t> exact_rects(const CompactTree& tree, const Camera& camera,
                                       const VoxelFaces& faces) {
  std::vector<std::uint32_t> rects;
  for (std::int32_t y = 0; y < kSmall3dHeightPx; ++y) {
    for (std::int32_t x = 0; x < kSmall3dWidthPx; ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      REQUIRE(closest_hit(tree, ray, &hit) == Status::kOk);
      rects.push_back(faces.rect_of(ray, hit));
    }
  }
  return rects;
}

TEST_CASE("a model's surface as rectangles: every exposed face once, joined ones of one plane and material") {
  const auto source = small3d_scene("spheres,depth=5");
  const VoxelFaces faces(*source, false);
  const VoxelFaces joined(*source, true);
  CHECK(faces.rects().size() > 1000);
  CHECK(joined.rects().size() * 2 < faces.rects().size());
  std::size_t covered = 0;
  for (std::uint32_t i = 0; i < joined.rects().size(); ++i) {
    const FaceRect& rect = joined.rects()[i];
    REQUIRE(rect.low[rect.axis] == rect.high[rect.axis]);
    Vec3i at;
    for (at.x = rect.low.x; at.x <= rect.high.x; ++at.x) {
      for (at.y = rect.low.y; at.y <= rect.high.y; ++at.y) {
        for (at.z = rect.low.z; at.z <= rect.high.z; ++at.z) {
          REQUIRE(joined.rect_of(at, rect.axis, rect.up) == i);
          const std::uint32_t single = faces.rect_of(at, rect.axis, rect.up);
          REQUIRE(single != VoxelFaces::kNone);
          REQUIRE(faces.rects()[single].material == rect.material);
          ++covered;
        }
      }
    }
  }
  CHECK(covered == faces.rects().size());
}

TEST_CASE("a model drawn as triangles: the exact picture but for edges, and what is wrong is counted") {
  const auto source = small3d_scene("spheres,depth=5");
  const tools::Baked baked = tools::bake_scene(*source, {});
  const Camera camera = small3d_camera(source->level());
  for (const bool joins : {false, true}) {
    CAPTURE(joins);
    const VoxelFaces faces(*source, joins);
    const std::vector<std::uint32_t> exact = exact_rects(baked.scene.tree(), camera, faces);
    CHECK(std::set<std::uint32_t>(exact.begin(), exact.end()).size() > (joins ? 200 : 800));
    std::vector<std::uint16_t> colors(faces.rects().size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      colors[i] = static_cast<std::uint16_t>(i);
    }
    Small3dDrawing drawing(faces, colors);
    S3L_stand_in_fault_px = 0;
    const Small3dTuning tuning = tune(&drawing, camera, exact);
    CHECK(tuning.right_px == -0.5);
    CHECK(tuning.down_px == -0.5);
    std::vector<std::uint16_t> pixels(kSmall3dPixels);
    std::vector<std::uint32_t> rects(kSmall3dPixels);
    drawing.draw(camera, tuning, 0xFFFF, pixels.data(), rects.data());
    const std::size_t wrong = wrong_pixels(exact, rects);
    MESSAGE("wrong: " << wrong << " of " << kSmall3dPixels);
    CHECK(wrong * 1000 < kSmall3dPixels);
    // The pixels are those of the rectangles.
    for (std::size_t i = 0; i < kSmall3dPixels; ++i) {
      REQUIRE(pixels[i] == (rects[i] == VoxelFaces::kNone ? 0xFFFF : colors[rects[i]]));
    }
    // One more.
    std::size_t right = 0;
    while (exact[right] == VoxelFaces::kNone || exact[right] != rects[right]) {
      ++right;
    }
    rects[right] = VoxelFaces::kNone;
    CHECK(wrong_pixels(exact, rects) == wrong + 1);
    // Triangles two pixels to the right, which no tuning can help.
    S3L_stand_in_fault_px = 2;
    drawing.draw(camera, tune(&drawing, camera, exact), 0, pixels.data(), rects.data());
    CHECK(wrong_pixels(exact, rects) > 4 * wrong + kSmall3dPixels / 50);
    S3L_stand_in_fault_px = 0;
  }
}

}  // namespace
}  // namespace thimble
