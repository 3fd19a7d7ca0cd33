// Draws frames by bricks: rays go from voxel to voxel through the 64-bit bricks of a map, plane by plane along the axis
// on which the rays of a tile move fastest. src/picture/BRICKS.md derives what is used here.
#include "thimble/picture/render.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"
#include "../tree/deep_map.h"
#include "band.h"

// Compiles this file and the headers that follow for speed, whatever the rest is optimised for. ("rename-registers"
// saves one instruction in a hundred.)
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#pragma GCC optimize("O2", "rename-registers", "no-tree-loop-distribute-patterns")
#endif

#define THIMBLE_RECIPROCALS
#include "bricks/painter.h"

namespace thimble {

using namespace bricks;

namespace {

// Whether pixels share bytes, among the formats behind kRgb888. (A page is as high as a tile, so clearing it once for
// each of its rows harms nothing: no tile is drawn yet.)
bool shares_bytes(PixelFormat format) {
  return kHasPanelFormats && format > PixelFormat::kBgr565 && format != PixelFormat::kRgb332;
}

// In worlds of level 9 and 10 only beams are bounded: a slope of up to 2 and 1/1024 times a distance is below 2^30.
constexpr int32_t kMostDeepDistance = (1 << 19) - 512;

[[maybe_unused]] bool draws_deep(const Camera& camera) {
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t eye = camera.eye()[axis].raw;
    const int32_t beyond = (Q8::kOne << camera.level()) - eye;
    if ((eye > beyond ? eye : beyond) > kMostDeepDistance) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool draws_fast(const BrickMap& map, const Camera& camera) {
  if (!camera.is_perspective() || camera.width_px() == 0 || camera.level() != map.level() ||
      camera.direction_bits() > kMaxBrickDirectionBits) {
    return false;
  }
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_deep(map.level())) {
      return draws_deep(camera);
    }
  }
  // Of the world, for the tree's rays, and of the box: where a ray starts is the sum of two products of such a distance
  // and a direction, and kOutsideQ8 is added to one of the distances. Their 32 bits hold from -2^31 to 2^32.
  uint32_t distances = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t eye = camera.eye()[axis].raw;
    const auto farther = [eye](int32_t low, int32_t high) {
      return static_cast<uint32_t>(eye - low > high - eye ? eye - low : high - eye);
    };
    constexpr int32_t kBrickQ8 = 4 * Q8::kOne;
    distances |= farther(0, Q8::kOne << map.level());
    distances |=
        farther(map.box().low[axis] * kBrickQ8, map.box().high[axis] * kBrickQ8) + kOutsideQ8 / 2 - 1;
  }
  return distances >> (31 - camera.direction_bits()) == 0;
}

namespace {

// Draws a band of a frame that `draws_fast`.
template <class OneCourse>
[[gnu::noinline]] Status draw_by_bricks(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                                        const Shading& shading, const Band& band, RenderCounts* counts) {
  size_t stride = 0;
  const Status status = check_band(camera, tree.level(), band, &stride);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  const int32_t width = camera.width_px();
  const size_t line_bytes = row_bytes(band.format, width);
  Inks inks;
  inks.forget();
  BrickFrame frame = brick_frame<OneCourse::kDeep>(tree, map, camera, shading, band.format);
  frame.halfwords =
      is_halfword(band.format) && ((reinterpret_cast<size_t>(band.pixels.data) | stride) & 1U) == 0;
  frame.background = ink_of(band.format, shade(Hit{}, Ray{}, camera, shading));
  RenderCounts done;
  Sweep sweep;
  sweep.misses = 0;
  sweep.counts = &done;
  sweep.begin(map);
  const bool swept = kSlots != 0 && shading.mode != ShadeMode::kDepth && set_steps(camera, &sweep) &&
                     !touches_solid<OneCourse::kDeep>(frame);
  BrickPainter<OneCourse> painter(frame, inks, swept ? &sweep : nullptr, band.pixels.data, stride,
                                  band.first_row, &done);
  const int32_t end = band.first_row + band.rows;
  for (int32_t y = band.first_row; y < end;) {
    const int32_t tile_end = (y / kBrickTilePx + 1) * kBrickTilePx;
    const int32_t y1 = tile_end < end ? tile_end : end;
    // Where no quad stores whole bytes, pixels of less than a byte are put into bytes that must be 0.
    const bool cleared = band.format == PixelFormat::kMono1 ||
                         (band.format == PixelFormat::kGray4 && width % kQuadAcrossPx != 0) ||
                         shares_bytes(band.format);
    for (int32_t row = y; row < y1 && cleared; ++row) {
      uint8_t* line = band.pixels.data + stride * row_place(band.format, row - band.first_row);
      for (size_t i = 0; i < line_bytes; ++i) {
        line[i] = 0;
      }
    }
    for (int32_t x = 0; x < width; x += kTileAcrossPx) {
      const int32_t x1 = x + kTileAcrossPx < width ? x + kTileAcrossPx : width;
      painter.draw_tile({x, x1, y, y1});
    }
    y = y1;
  }
  const uint64_t rays = wide_product_u(static_cast<uint32_t>(width), static_cast<uint32_t>(band.rows));
  done.hits = rays - painter.misses();
  if (counts != nullptr) {
    counts->rays += rays;
    counts->hits += done.hits;
    counts->node_visits += done.node_visits;
  }
  return Status::kOk;
}

}  // namespace

Status render_band(const CompactTree& tree, const BrickMap& map, const Camera& camera, const Shading& shading,
                   const Band& band, RenderCounts* counts) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_deep(map.level())) {
      return draws_fast(map, camera) ? draw_by_bricks<DeepCourse>(tree, map, camera, shading, band, counts)
                                     : render_band(tree, camera, shading, band, counts);
    }
  }
  return draws_fast(map, camera) ? draw_by_bricks<Course>(tree, map, camera, shading, band, counts)
                                 : render_band(tree, camera, shading, band, counts);
}

Status render_band_32(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                      const Shading& shading, const Band& band, RenderCounts* counts) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  return !DeepMap::is_deep(map.level()) && draws_fast(map, camera)
             ? draw_by_bricks<Course>(tree, map, camera, shading, band, counts)
             : Status::kBadArgument;
}

}  // namespace thimble
