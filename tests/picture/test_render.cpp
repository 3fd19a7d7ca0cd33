#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scene/random.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble;
using thimble::tools::SplitMix64;

constexpr int kWidthPx = 29;
constexpr int kHeightPx = 23;
constexpr std::uint8_t kGuard = 0xA5;
constexpr Rgb8 kPalette[] = {{250, 120, 30}, {20, 200, 90}, {70, 80, 240}};

/// A level-5 world of random voxels. Not to be moved: they point into it.
class Scene {
 public:
  explicit Scene(std::uint64_t seed) {
    pool_bytes_.resize(Octree::octree_bytes(8000));
    REQUIRE(Octree::make(5, Bytes(pool_bytes_.data(), pool_bytes_.size()), &pool) == Status::kOk);
    SplitMix64 random(seed);
    for (int i = 0; i < 400; ++i) {
      insert({static_cast<int>(random.below(32)), static_cast<int>(random.below(32)),
              static_cast<int>(random.below(32))},
             static_cast<std::uint8_t>(random.below(5)));
    }
    finish();
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void insert(const Vec3i& at, std::uint8_t material) { REQUIRE(pool.insert(at, material) == Status::kOk); }
  void finish() {
    tree_bytes_.resize(compact_bytes(compact_shape(pool)));
    std::size_t written = 0;
    REQUIRE(CompactTree::make(pool, Bytes(tree_bytes_.data(), tree_bytes_.size()), nullptr, &written) ==
            Status::kOk);
    REQUIRE(CompactTree::open(ConstBytes(tree_bytes_.data(), written), &compact) == Status::kOk);
  }

  Octree pool;
  CompactTree compact;

 private:
  std::vector<std::uint8_t> pool_bytes_;
  std::vector<std::uint8_t> tree_bytes_;
};

Vec3Q8 point(int x, int y, int z) {
  return {Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)};
}
Camera pinhole(const Vec3Q8& eye, const Vec3Q8& target, int level = 5, int bits = 0) {
  Camera camera;
  const PerspectiveView view{eye, look_at(eye, target), {}, Q16::saturate(50), kWidthPx, kHeightPx, bits};
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}
Camera parallel(const Vec3Q8& eye, const Vec3Q8& target) {
  Camera camera;
  const OrthographicView view{eye, look_at(eye, target), {}, Q14::saturate(48), kWidthPx, kHeightPx, 0};
  REQUIRE(camera.set(view, 5) == Status::kOk);
  return camera;
}
Camera usual_camera() {
  return pinhole(point(-3001, -7003, 9987), point(4096, 4096, 4000));
}

Shading shading_of(ShadeMode mode, const Camera& camera) {
  Shading shading;
  shading.mode = mode;
  shading.palette = Span<const Rgb8>(kPalette);
  shading.background = {12, 34, 56};
  const DepthRange range = depth_range(camera, {{0, 0, 0}, {32, 32, 32}});
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

Band band_over(std::vector<std::uint8_t>& bytes, PixelFormat format, int first_row, int rows,
               std::size_t stride = 0) {
  Band band;
  band.pixels = Bytes(bytes.data(), bytes.size());
  band.format = format;
  band.stride_bytes = stride;
  band.first_row = first_row;
  band.rows = rows;
  return band;
}

/// Draws what must be refused, and checks the status, the bytes and the counters.
template <class Structure>
void check_refused(Status wanted, const Structure& structure, const Camera& camera, Band band,
                   const TraceOptions& options = {}) {
  RenderCounts counts{1, 2, 3, 4};
  const std::vector<std::uint8_t> before(band.pixels.begin(), band.pixels.end());
  CHECK(render_band(structure, camera, shading_of(ShadeMode::kNormal, camera), band, &counts, options) ==
        wanted);
  CHECK(std::equal(before.begin(), before.end(), band.pixels.begin()));
  CHECK(counts.rays == 1);
  CHECK(counts.hits == 2);
  CHECK(counts.node_visits == 3);
  CHECK(counts.step_limited == 4);
}

}  // namespace

TEST_CASE("render_band: Width::k32 at the border of what it takes -> all rays of a picture or none") {
  const Scene scene(0xB04D);
  TraceOptions options;
  options.width = Width::k32;
  constexpr std::uint64_t kSeed = 0xB04DE4;
  SplitMix64 random(kSeed);
  int taken = 0;
  int refused = 0;
  for (int turn = 0; turn < 600; ++turn) {
    // Parallel pictures about the plane where distances take one more bit, so that the longest rays may be
    // those of one corner alone; and pinholes of every kind.
    const bool is_parallel = random.below(3) != 0;
    Vec3Q8 eye;
    Vec3i forward;
    Vec3i up;
    for (int axis = 0; axis < 3; ++axis) {
      eye[axis] =
          Q8::from_raw(static_cast<int>(random.below(is_parallel ? 8192 : 60000)) - (axis == 0 ? 28672 : 0));
      forward[axis] = static_cast<int>(random.below(2001)) - 1000;
      up[axis] = static_cast<int>(random.below(2001)) - 1000;
    }
    const int bits = 14 + static_cast<int>(random.below(4));
    Camera camera;
    const Status status =
        is_parallel ? camera.set(OrthographicView{eye, forward, up, Q14::saturate(40), 5, 4, bits}, 5)
                    : camera.set(PerspectiveView{eye, forward, up, Q16::saturate(120), 5, 4, bits}, 5);
    if (status != Status::kOk) {
      continue;
    }
    bool all = true;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 5; ++x) {
        all = all && accepts_32(camera.ray(x, y), 5);
      }
    }
    std::vector<std::uint8_t> bytes(band_bytes(PixelFormat::kGray8, 5, 4), kGuard);
    const Band band = band_over(bytes, PixelFormat::kGray8, 0, 4);
    CAPTURE(kSeed);
    CAPTURE(turn);
    if (all) {
      ++taken;
      CHECK(render_band(scene.compact, camera, Shading{}, band, nullptr, options) == Status::kOk);
    } else {
      ++refused;
      check_refused(Status::kBadArgument, scene.compact, camera, band, options);
    }
  }
  CHECK(taken > 50);
  CHECK(refused > 50);
}

TEST_CASE("render_band: hits lie between the planes of depth_range -> depth shading uses its whole scale") {
  const Scene scene(0xD4);
  for (const Camera& camera :
       {usual_camera(), parallel(point(-3001, -7003, 9987), point(4096, 4096, 4000))}) {
    const DepthRange range = depth_range(camera, scene.compact.bounds());
    for (int y = 0; y < kHeightPx; ++y) {
      for (int x = 0; x < kWidthPx; ++x) {
        Hit hit;
        REQUIRE(closest_hit(scene.compact, camera.ray(x, y), &hit) == Status::kOk);
        if (hit.kind == HitKind::kHit) {
          const int depth = planar_depth_q8(hit, camera);
          // Rays are rounded, so their depths are off by up to 0.4 per cent at 8 bits.
          CHECK(depth >= range.near_q8 - range.near_q8 / 200);
          CHECK(depth <= range.far_q8 + range.far_q8 / 200);
        }
      }
    }
  }
}

TEST_CASE("band_bytes: no columns -> 0; a product beyond size_t -> SIZE_MAX") {
  CHECK(band_bytes(PixelFormat::kRgb888, 0, 5) == 0);
  if constexpr (sizeof(std::size_t) == 4) {
    CHECK(band_bytes(PixelFormat::kRgb888, 1 << 20, 1 << 20) == SIZE_MAX);
  } else {
    CHECK(band_bytes(PixelFormat::kRgb888, 1 << 20, 1 << 20) == std::size_t{3} << 40);
  }
  static_assert(render_bytes() >= sizeof(Camera) + sizeof(Shading));
}
