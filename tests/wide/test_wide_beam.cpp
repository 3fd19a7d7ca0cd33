// Where the rays of neighbouring pixels can first meet something.
#include <doctest/doctest.h>

#include <random>

#include "support/counts.h"
#include "support/wide_cases.h"
#include "wide/lit/beam.h"

namespace thimble::tests {

TEST_CASE(
    "wide: beams -> no ray meets anything before its plane; most rays begin not far before what they meet") {
  std::mt19937_64 random(81);
  std::int64_t wrong = 0;
  std::int64_t clear = 0;
  std::int64_t sky = 0;
  std::int64_t met = 0;
  std::int64_t near = 0;
  WideScene scene;
  HeapBytes map_bytes(0);
  wide::RayMap map;
  const int trials = many_or_few(400, 120);
  for (int trial = 0; trial < trials;) {
    if (trial % 8 == 0) {
      scene = random_scene(random);
      map_bytes = HeapBytes(wide::RayMap::bytes(scene.tree));
      Arena arena(map_bytes.span());
      REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
    }
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    ++trial;
    CAPTURE(trial);
    const Camera& camera = frame.camera;
    const wide::Beams beams(camera, map);
    for (int turn = 0; turn < 20; ++turn) {
      wide::PixelBox pixels;
      pixels.x0 = pick_int(random, 0, camera.width_px() - 1);
      pixels.y0 = pick_int(random, 0, camera.height_px() - 1);
      pixels.x1 = pick_int(random, pixels.x0 + 1, std::min(pixels.x0 + 8, camera.width_px()));
      pixels.y1 = pick_int(random, pixels.y0 + 1, std::min(pixels.y0 + 8, camera.height_px()));
      const wide::PixelBox more{pixels.x0 - pick_int(random, 0, 20), pixels.y0 - 3, pixels.x1 + 9, pixels.y1};
      const wide::FirstPlane first =
          beams.first_plane(pixels, turn % 2 == 0 ? wide::FirstPlane() : beams.first_plane(more));
      for (std::int32_t y = pixels.y0; y < pixels.y1; ++y) {
        for (std::int32_t x = pixels.x0; x < pixels.x1; ++x) {
          const Ray ray = camera.ray(x, y);
          Hit hit;
          REQUIRE(closest_hit(scene.tree, ray, &hit) == Status::kOk);
          clear += first.is_clear ? 1 : 0;
          if (hit.kind != HitKind::kHit) {
            ++sky;
            continue;
          }
          const RayPoint from = first.on(ray);
          const double left = static_cast<double>(hit.t_numerator) / hit.t_denominator -
                              static_cast<double>(from.t_numerator) / from.t_denominator;
          wrong += first.is_clear || left < 0 ? 1 : 0;
          ++met;
          near += left * std::abs(ray.direction[first.axis]) < 12 ? 1 : 0;  // voxels along the axis
        }
      }
    }
  }
  CHECK(wrong == 0);
  CAPTURE(clear);
  CAPTURE(sky);
  CAPTURE(met);
  CAPTURE(near);
  CHECK(clear > sky / 2);
  CHECK(near > met / 2);
}

}  // namespace thimble::tests
