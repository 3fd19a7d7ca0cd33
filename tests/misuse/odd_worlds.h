/// Trees, cameras, bands and rays for the tests of this folder: sound, empty, damaged, or of any numbers at
/// all.
#pragma once

#include <cstdint>

#include <doctest/doctest.h>

#include "misuse/odd_values.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/plane/particles.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tests {

/// A world of balls whose numbers `number(low, high)` gives, sound or not.
template <class Number>
ParticleConfig particles_of(OddValues& odd, const Number& number) {
  ParticleConfig config;
  config.width = number(0, 110);
  config.height = number(0, 110);
  config.capacity = static_cast<std::uint32_t>(number(0, 12));
  config.least_diameter = number(1, 8);
  config.most_diameter = number(8, kMaxBallDiameter);
  config.restitution_q16 = static_cast<std::uint32_t>(number(0, 65536));
  config.gravity_q16 = {number(-kMaxAccelerationQ16, kMaxAccelerationQ16),
                        number(-kMaxAccelerationQ16, kMaxAccelerationQ16)};
  config.seed = odd.any<std::uint32_t>();
  config.substeps_log2 = number(0, 4);
  config.subpixel_bits = number(1, 15);
  return config;
}

/// One world in each of the structures; the compact and shared bytes may be damaged afterwards.
struct OddWorld {
  HeapBytes pool, grid_bytes, compact_bytes, shared_bytes;
  Octree octree;
  DenseGrid grid;
  CompactTree compact;
  SharedTree shared;

  explicit OddWorld(OddValues& odd, int level) {
    const std::int32_t side = std::int32_t{1} << level;
    pool = HeapBytes(Octree::octree_bytes(6000));
    REQUIRE(Octree::make(level, pool.span(), &octree) == Status::kOk);
    grid_bytes = HeapBytes(dense_grid_bytes({side, side, side}));
    REQUIRE(DenseGrid::make({side, side, side}, grid_bytes.span(), &grid) == Status::kOk);
    const bool one_material = odd.one_in(2);
    for (std::uint64_t count = odd.bits() % 80; count > 0; --count) {
      const Vec3i at = odd.vector_between(0, side - 1);
      REQUIRE(octree.insert(at, one_material ? 1 : static_cast<std::uint8_t>(odd.bits() % 5)) == Status::kOk);
      REQUIRE(grid.set(at) == Status::kOk);
    }
    if (odd.one_in(3)) {
      REQUIRE(octree.insert_block({0, side / 2, 0}, level - 1, 2) == Status::kOk);
    }
    if (odd.one_in(3) && !octree.empty()) {
      (void)octree.coarsen_to(1 + octree.nodes_used() / 2);
    }
    compact_bytes = compact_of(octree);
    compact = open_or_throw(compact_bytes);
    shared_bytes = shared_of(compact);
    REQUIRE(SharedTree::open(shared_bytes.span(), &shared) == Status::kOk);
  }

  /// Writes over what the two views read behind their headers, which stay.
  void damage(OddValues& odd) {
    for (int i = 0; i < 6; ++i) {
      for (HeapBytes* bytes : {&compact_bytes, &shared_bytes}) {
        const std::size_t size = bytes->span().size;
        if (size > kSharedHeaderBytes) {
          bytes->span()[kSharedHeaderBytes + odd.bits() % (size - kSharedHeaderBytes)] =
              odd.any<std::uint8_t>();
        }
      }
    }
  }
};

/// Changes numbers of a sound map of level 9 or 10 to others that may stand there, or are one too many; all but the
/// checksum of its tree.
inline void damage_deep_map(OddValues& odd, Bytes map) {
  const auto word_at = [&](std::size_t at) {
    return map[at] | std::size_t{map[at + 1]} << 8 | std::size_t{map[at + 2]} << 16 |
           std::size_t{map[at + 3]} << 24;
  };
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) {
      map[at++] = static_cast<std::uint8_t>(value >> 8 * i);
    }
  };
  const auto below = [&](std::size_t count) { return count == 0 ? 0 : odd.bits() % count; };
  const std::size_t pages = word_at(32);
  const std::size_t bricks = word_at(36);
  const std::size_t origins_at = map.size - 12 * word_at(40);
  const std::size_t ranks = (bricks + 31) / 32;
  const std::size_t ranks_at = origins_at - (bricks + 3) / 4 * 4 - 8 * ranks;
  const std::size_t pages_at = ranks_at - 8 * bricks - (68 * pages + 7) / 8 * 8;
  constexpr std::size_t kTableAt = 48;
  for (int i = odd.between_32(1, 2); i > 0; --i) {
    const std::size_t page_at = pages_at + 68 * below(pages);
    const std::size_t rank_at = ranks_at + 8 * below(ranks);
    switch (odd.bits() % 6) {
      case 0: {
        const std::size_t at = below(kTableAt);
        map[at] = at < 16 || at >= 20 ? static_cast<std::uint8_t>(map[at] + odd.between(-2, 2)) : map[at];
        break;
      }
      case 1: {
        const std::size_t page = odd.one_in(2) ? below(pages + 2) : odd.any<std::uint32_t>() / 68;
        const auto along = [&](std::size_t at) { return below(word_at(at) & 0xFFFF) / 4; };
        put(kTableAt + 4 * (along(26) + 64 * along(28) + 4096 * along(30)),
            static_cast<std::uint32_t>(pages_at - kTableAt + 68 * page));
        break;
      }
      case 2:
        put(page_at,
            odd.one_in(2) ? static_cast<std::uint32_t>(below(bricks + 2)) : odd.any<std::uint32_t>());
        break;
      case 3:
        map[page_at + 4 + below(64)] = static_cast<std::uint8_t>(below(bricks + 2));
        break;
      case 4:
        put(rank_at + 4 * below(2),
            odd.one_in(2) ? static_cast<std::uint32_t>(below(bricks)) : odd.any<std::uint32_t>());
        break;
      default:
        map[ranks_at + 8 * ranks + below(map.size - ranks_at - 8 * ranks)] = odd.any<std::uint8_t>();
        break;
    }
  }
}

/// A world of level 9 or 10 with little in it, and its brick map in as many bytes as it has.
struct OddDeepWorld {
  HeapBytes compact_bytes, map_bytes;
  CompactTree compact;
  BrickMap map;

  explicit OddDeepWorld(OddValues& odd) {
    const int level = odd.between_32(kMaxBrickMapLevel + 1, kMaxDeepMapLevel);
    const std::int32_t side = std::int32_t{1} << level;
    OwnedPool pool(level, 3000);
    Octree& octree = pool.octree;
    // Mostly within a few pages at the world's lowest corner, so that the table is small.
    const std::int32_t part = odd.one_in(6) ? side : odd.between_32(4, 40);
    const Vec3i from = odd.one_in(4) ? odd.vector_between(0, side - part) : Vec3i{};
    const bool one_material = odd.one_in(4);
    const auto material = [&] { return static_cast<std::uint8_t>(one_material ? 1 : odd.bits() % 5); };
    const auto place = [&] {
      const Vec3i step = odd.vector_between(0, part - 1);
      return Vec3i{from.x + step.x, from.y + step.y, from.z + step.z};
    };
    for (std::uint64_t count = odd.bits() % 60; count > 0; --count) {
      REQUIRE(octree.insert(place(), material()) == Status::kOk);
    }
    for (std::uint64_t count = odd.bits() % 4; count > 0; --count) {
      const int block = odd.between_32(1, odd.one_in(8) ? level : 5);
      const Vec3i at = place();
      const std::int32_t mask = -(1 << block);
      REQUIRE(octree.insert_block({at.x & mask, at.y & mask, at.z & mask}, block, material()) == Status::kOk);
    }
    if (odd.one_in(3) && !octree.empty()) {
      (void)octree.coarsen_to(1 + octree.nodes_used() / 2);
    }
    compact_bytes = compact_of(octree);
    compact = open_or_throw(compact_bytes);
    map_bytes = map_of(compact);
    REQUIRE(BrickMap::open(map_bytes.span(), &map) == Status::kOk);
  }

  /// A camera by what is solid that looks at it from outside or from within.
  Camera near(OddValues& odd) const {
    const auto solid = [&](std::int32_t beyond) {
      Vec3Q8 point;
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = Q8::from_raw(
            256 * odd.between_32(compact.bounds().low[axis] - beyond, compact.bounds().high[axis] + beyond));
      }
      return point;
    };
    const Vec3Q8 eye = solid(odd.one_in(3) ? 0 : 20);
    Camera camera;
    (void)camera.set(PerspectiveView{eye, look_at(eye, solid(0)), {}, Q16::saturate(70), 24, 16, 0},
                     compact.level());
    return camera;
  }
};

/// A ray that `check_ray` takes in a world of 2^level, most of them hard: lattice points, diagonals, insides.
inline Ray good_ray(OddValues& odd, int level) {
  const std::int32_t side = Q8::kOne << level;
  const bool on_lattice = odd.one_in(2);
  Ray ray;
  do {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t at = odd.one_in(2) ? odd.between_32(kMinOriginWorlds * side, kMaxOriginWorlds * side)
                                            : odd.between_32(0, side);
      ray.origin[axis] = Q8::from_raw(on_lattice ? at & ~255 : at);
      ray.direction[axis] =
          odd.one_in(2) ? odd.between_32(-1, 1) : odd.between_32(-kMaxDirection, kMaxDirection);
    }
  } while (ray.direction == Vec3i{});
  return ray;
}

/// Any ray at all, or a good one.
inline Ray odd_ray(OddValues& odd, int level) {
  return odd.one_in(2) ? Ray{odd.any_point(), odd.any_vector()} : good_ray(odd, level);
}

inline TraceOptions odd_options(OddValues& odd) {
  return {odd.one_in(2) ? UINT32_MAX : odd.any<std::uint32_t>(), static_cast<Width>(odd.bits() % 3)};
}

/// A camera set to any numbers; one without pixels where they are refused. At most 40 x 40 pixels are drawn.
inline Camera odd_camera(OddValues& odd, int level) {
  const std::int32_t side = Q8::kOne << level;
  const bool sane = !odd.one_in(3);
  const auto point = [&] {
    return Vec3Q8{Q8::from_raw(odd.between_32(-4 * side, 5 * side)),
                  Q8::from_raw(odd.between_32(-4 * side, 5 * side)),
                  Q8::from_raw(odd.between_32(-4 * side, 5 * side))};
  };
  const Vec3Q8 eye = sane ? point() : odd.any_point();
  const Vec3i forward =
      sane ? odd.one_in(2) ? look_at(eye, point()) : odd.vector_between(-3, 3) : odd.any_vector();
  const Vec3i up = sane && odd.one_in(2) ? Vec3i{} : odd.any_vector();
  const auto size = [&] { return sane ? odd.between_32(1, 40) : odd.any<std::int32_t>(); };
  const int bits = sane ? odd.one_in(2) ? 0 : odd.between_32(8, 20) : odd.any<std::int32_t>();
  const int world = odd.one_in(8) ? odd.any<std::int32_t>() : level;
  Camera camera;
  Status status = Status::kOk;
  if (odd.one_in(2)) {
    const Q16 fov = sane ? Q16::from_raw(odd.between_32(kMinFov.raw, kMaxFov.raw))
                         : Q16::from_raw(odd.any<std::int32_t>());
    status = camera.set(PerspectiveView{eye, forward, up, fov, size(), size(), bits}, world);
  } else {
    const Q14 span =
        sane ? Q14::from_raw(odd.between_32(1, 1 << 22)) : Q14::from_raw(odd.any<std::int32_t>());
    status = camera.set(OrthographicView{eye, forward, up, span, size(), size(), bits}, world);
  }
  if (status != Status::kOk) {
    CHECK(camera.width_px() == 0);
  } else if (camera.width_px() > 64 || camera.height_px() > 64) {
    (void)camera.ray(camera.width_px() - 1, camera.height_px() - 1);
    return Camera();
  }
  return camera;
}

inline Shading odd_shading(OddValues& odd, Span<const Rgb8> palette) {
  Shading shading;
  shading.mode = static_cast<ShadeMode>(odd.bits() % 4);
  shading.palette = palette.subspan(0, odd.bits() % (palette.size + 1));
  shading.near_q8 = odd.any<std::int32_t>();
  shading.far_q8 = odd.any<std::int32_t>();
  return shading;
}

/// A band of any numbers over `pixels`, which it sizes about as needed.
inline Band odd_band(OddValues& odd, const Camera& camera, HeapBytes* pixels) {
  Band band;
  band.format = static_cast<PixelFormat>(odd.bits() % 5);
  const bool sane = !odd.one_in(3);
  band.first_row = sane ? odd.between_32(0, std::max(camera.height_px() - 1, 0)) : odd.any<std::int32_t>();
  band.rows = sane ? odd.between_32(0, camera.height_px() - band.first_row) : odd.any<std::int32_t>();
  const std::size_t row = row_bytes(band.format, camera.width_px());
  band.stride_bytes = odd.one_in(2) ? 0 : sane ? row + odd.bits() % 9 : odd.any<std::size_t>();
  const std::size_t stride = band.stride_bytes == 0 ? row : band.stride_bytes;
  const std::size_t rows = band.rows > 0 ? static_cast<std::size_t>(band.rows) : 0;
  const std::size_t needed = rows == 0 || stride > 100000 || rows > 10000 ? 64 : stride * (rows - 1) + row;
  *pixels = HeapBytes(odd_size(odd, needed));
  band.pixels = pixels->span();
  return band;
}

}  // namespace thimble::tests
