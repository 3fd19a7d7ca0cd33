// Compiled, as the core below it, with `thimble` as another name (CMakeLists.txt), so that a program may have both.
#include "counted/counted.h"

#include <algorithm>
#include <array>
#include <vector>

#include "apps/demo_view.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/ink.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

std::uint64_t blocks = 0;

}  // namespace

#ifdef __clang__
#pragma clang diagnostic ignored "-Wreserved-identifier"
#define THIMBLE_UNCOUNTED __attribute__((no_sanitize("coverage")))
#else
#define THIMBLE_UNCOUNTED __attribute__((no_sanitize_coverage))
#endif
// Called by the compiler's code. NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" THIMBLE_UNCOUNTED void __sanitizer_cov_trace_pc() {
  ++blocks;
}

namespace counted {
namespace {

using namespace thimble;

constexpr std::int32_t kRows = 8;  // of a band, as bench has them

struct Scene {
  BakedScene baked;
  BrickMap map;
};

// Every row of one picture.
Status draw(const Scene& scene, const Camera& camera, const Shading& shading, Bytes pixels,
            RenderCounts* counts) {
  const std::size_t row = band_bytes(PixelFormat::kGray8, camera.width_px(), 1);
  Status status = Status::kOk;
  for (std::int32_t y = 0; y < camera.height_px() && status == Status::kOk; y += kRows) {
    const std::int32_t rows = std::min(kRows, camera.height_px() - y);
    const Band band{pixels.subspan(static_cast<std::size_t>(y) * row, static_cast<std::size_t>(rows) * row),
                    PixelFormat::kGray8, 0, y, rows};
    status = render_band(scene.baked.tree(), scene.map, camera, shading, band, counts);
  }
  return status;
}

// The depths, then patterns and bits of the tones that are drawn.
Status draw_ink(const Scene& scene, const Camera& camera, InkPicture* ink, RenderCounts* counts) {
  Shading depths;
  const DepthRange range = depth_range(camera, scene.baked.tree().bounds());
  depths.near_q8 = range.near_q8;
  depths.far_q8 = range.far_q8;
  Status status = draw(scene, camera, depths, ink->depths().pixels, counts);
  if (status == Status::kOk) {
    ink->finish();
    std::vector<std::uint8_t> bits(band_bytes(PixelFormat::kMono1, camera.width_px(), camera.height_px()));
    status = ink->store({{bits.data(), bits.size()}, PixelFormat::kMono1, 0, 0, camera.height_px()});
  }
  return status;
}

}  // namespace

bool count_frames(const std::uint8_t* bytes, std::size_t size, std::int32_t width_px, std::int32_t height_px,
                  bool is_ink, FrameWork* work) {
  Scene scene;
  if (BakedScene::open({bytes, size}, &scene.baked) != Status::kOk ||
      BrickMap::open(scene.baked.section(SectionKind::kBrickMap), &scene.map) != Status::kOk) {
    return false;
  }
  const apps::Orbit orbit = apps::orbit_of(scene.baked);
  const Shading shading = apps::demo_shading(scene.baked.palette());
  std::vector<std::uint8_t> memory(ink_bytes(width_px, height_px));
  InkPicture ink;
  if (InkPicture::make(width_px, height_px, {memory.data(), memory.size()}, &ink) != Status::kOk) {
    return false;
  }
  std::array<std::uint64_t, apps::kGoldenFrames> counts{};
  RenderCounts rays;
  for (std::uint32_t i = 0; i < apps::kGoldenFrames; ++i) {
    blocks = 0;
    Camera camera;
    Status status =
        apps::view_at(orbit, scene.baked.tree(), i * apps::kGoldenStep, {}, width_px, height_px, &camera);
    status = status == Status::kOk ? draw(scene, camera, shading, ink.tones().pixels, &rays) : status;
    status = status == Status::kOk && is_ink ? draw_ink(scene, camera, &ink, &rays) : status;
    if (status != Status::kOk) {
      return false;
    }
    counts[i] = blocks;
  }
  std::sort(counts.begin(), counts.end());
  work->blocks = (counts[counts.size() / 2 - 1] + counts[counts.size() / 2]) / 2;
  work->hits = rays.hits / counts.size();
  return true;
}

}  // namespace counted
