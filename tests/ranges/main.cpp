// Measures how large the numbers of the tracing path become (src/base/ranges.h), with the rays and cameras that make
// them large: lattice points, diagonals, insides, 1 and 120 degrees, origins worlds away, all levels. Prints what was
// measured beside what is promised; exit status 1 where anything lies beyond.
//
//   thimble_ranges [RAYS [SEED]]      about so many rays, 1,000,000 by default
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>

#include "base/ranges.h"
#include "support/ray_cases.h"
#include "thimble/light/host/optics.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/octree.h"

namespace thimble {

Extremes measured_ranges[static_cast<int>(Range::kCount)] = {};

}  // namespace thimble

namespace thimble::tests {
namespace {

struct Promise {
  const char* name;
  bool is_signed;
  int bits;
  const char* page;
  const char* what;
};
constexpr Promise kPromises[] = {
#define THIMBLE_PROMISE(name, is_signed, bits, page, what) {#name, is_signed, bits, page, what},
    THIMBLE_RANGES_OF(THIMBLE_PROMISE)
#undef THIMBLE_PROMISE
};

std::uint64_t rays_traced = 0;
std::uint64_t cameras_set = 0;

std::int32_t number(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return pick_int(random, low, high);
}

// A tree of some level, its voxels in a corner, all over, or solid; with the brick map where it has one.
struct MeasuredWorld {
  int level = 0;
  std::vector<std::uint8_t> pool;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> map_bytes;
  std::vector<std::uint8_t> grid_bytes;
  std::vector<reference::Voxel> targets;
  Octree octree;
  CompactTree tree;
  BrickMap map;
  DenseGrid grid;
  bool has_map = false;
  bool has_grid = false;

  explicit MeasuredWorld(std::mt19937_64& random)
      : level(pick_int(random, kMinLevel, kMaxLevel)), pool(Octree::octree_bytes(60000)) {
    const std::int32_t side = std::int32_t{1} << level;
    if (Octree::make(level, {pool.data(), pool.size()}, &octree) != Status::kOk) {
      std::abort();
    }
    const std::int64_t spread = pick(random, 0, 1) == 0 ? side : std::min(side, 16);
    const std::int64_t from = pick(random, 0, side - spread);
    for (std::int64_t count = pick(random, 1, 400); count > 0; --count) {
      const Vec3i at{number(random, from, from + spread - 1), number(random, from, from + spread - 1),
                     number(random, from, from + spread - 1)};
      (void)octree.insert(at, static_cast<std::uint8_t>(pick(random, 0, 3)));
      targets.push_back({at.x, at.y, at.z});
    }
    if (pick(random, 0, 2) == 0) {
      (void)octree.insert_block({0, 0, 0}, level - 1, 1);
    }
    if (pick(random, 0, 3) == 0) {
      (void)octree.coarsen_to(octree.nodes_used() / 2 + 1);
    }
    bytes.resize(compact_bytes(compact_shape(octree)));
    if (CompactTree::make(octree, {bytes.data(), bytes.size()}, &tree) != Status::kOk) {
      std::abort();
    }
    if (most_brick_map_bytes(tree) != 0) {
      map_bytes.resize(std::min(most_brick_map_bytes(tree), std::size_t{1} << 22));
      has_map = BrickMap::make(tree, {map_bytes.data(), map_bytes.size()}, &map) == Status::kOk;
    }
    if (level <= 6) {
      grid_bytes.resize(dense_grid_bytes({side, side, side}));
      has_grid =
          DenseGrid::make({side, side, side}, {grid_bytes.data(), grid_bytes.size()}, &grid) == Status::kOk;
      for (const reference::Voxel& voxel : targets) {
        (void)grid.set({static_cast<std::int32_t>(voxel[0]), static_cast<std::int32_t>(voxel[1]),
                        static_cast<std::int32_t>(voxel[2])});
      }
    }
  }
};

Ray core_ray(const reference::Ray& from) {
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    ray.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(from.origin_q8[at]));
    ray.direction[axis] = static_cast<std::int32_t>(from.direction[at]);
  }
  return ray;
}

// What starts at a hit: a start on its face, a mirrored ray, the same ray behind it, light.
void go_on(const MeasuredWorld& world, const Ray& ray, const Hit& hit) {
  Ray next = ray;
  next.origin = start_on_face(ray, hit);
  if (hit.axis >= 0) {
    next.direction[hit.axis] = -next.direction[hit.axis];
  }
  Hit second;
  if (check_ray(next, world.level) == Status::kOk && closest_hit(world.tree, next, &second) == Status::kOk) {
    ++rays_traced;
  }
  const RayPoint from = point_of(hit);
  HitKind kind = HitKind::kMiss;
  (void)closest_hit_from(world.tree, ray, from, &second);
  (void)any_hit_before(world.tree, ray, from, &kind);
  MediumExit exit;
  (void)leave_medium(world.tree, ray, hit.material, &exit, from);
  rays_traced += 3;
  (void)distance_q8(ray.direction, hit.t_numerator, hit.t_denominator);
}

void bend_light(std::mt19937_64& random, const Vec3i& direction) {
  const Vec3i unit = unit_q14(direction);
  const Vec3i normal =
      unit_q14({number(random, -kMaxDirection, kMaxDirection), number(random, -kMaxDirection, kMaxDirection),
                number(random, 1, kMaxDirection)});
  (void)reflect(shorten(direction), normal);
  const std::uint32_t eta = eta_q12(static_cast<std::uint32_t>(pick(random, 4096, 16384)),
                                    static_cast<std::uint32_t>(pick(random, 4096, 16384)));
  Vec3i out;
  (void)refract(unit, normal, eta, &out);
  (void)refract(unit, number(random, 0, 2), eta, &out);
}

void trace_rays(std::mt19937_64& random, const MeasuredWorld& world, std::uint64_t count) {
  const int side = 1 << world.level;
  RayCases cases(random(), {side, side, side}, world.targets);
  for (std::uint64_t i = 0; i < count; ++i) {
    const Ray ray = core_ray(cases.next().ray);
    Hit hit;
    if (closest_hit(world.tree, ray, &hit, {UINT32_MAX, Width::k64}) != Status::kOk) {
      std::abort();
    }
    ++rays_traced;
    if (accepts_32(ray, world.level)) {
      Hit narrow;
      (void)closest_hit(world.tree, ray, &narrow, {UINT32_MAX, Width::k32});
      ++rays_traced;
    }
    if (world.has_grid && i % 4 == 0) {
      Hit cell;
      const Width width = accepts_32(ray, world.level) && i % 8 == 0 ? Width::k32 : Width::k64;
      (void)closest_hit(world.grid, ray, &cell, {UINT32_MAX, width});
      ++rays_traced;
    }
    if (hit.kind == HitKind::kHit) {
      go_on(world, ray, hit);
    }
    if (i % 4 == 0) {
      bend_light(random, ray.direction);
    }
  }
}

// At its limits more often than not.
std::int32_t extreme(std::mt19937_64& random, std::int32_t low, std::int32_t high) {
  const std::int64_t kind = pick(random, 0, 5);
  return kind == 0 ? low : kind == 1 ? high : number(random, low, high);
}

bool hard_camera(std::mt19937_64& random, int level, Camera* camera) {
  const std::int32_t world = Q8::kOne << level;
  const bool inside = pick(random, 0, 2) == 0;
  // As far away as frames by bricks take directions of so many bits.
  const bool is_far = pick(random, 0, 5) == 0;
  const int far_bits = pick_int(random, 13, 15);
  const std::int32_t reach = (1 << (31 - far_bits)) - 32 * Q8::kOne;
  const std::int32_t low = std::max(world - reach, kMinOriginWorlds * world);
  const std::int32_t high = std::min(reach, kMaxOriginWorlds * world);
  Vec3Q8 eye;
  Vec3i forward;
  const bool is_any = pick(random, 0, 1) == 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t at = is_far   ? extreme(random, std::min(low, high), std::max(low, high))
                            : inside ? extreme(random, 0, world)
                                     : extreme(random, kMinOriginWorlds * world, kMaxOriginWorlds * world);
    eye[axis] = Q8::from_raw(pick(random, 0, 1) == 0 ? at & ~255 : at);
    forward[axis] = is_any ? extreme(random, -kMaxViewComponent, kMaxViewComponent) : number(random, -1, 1);
  }
  if (pick(random, 0, 1) == 0) {
    const Vec3Q8 target{Q8::from_raw(number(random, 0, world)), Q8::from_raw(number(random, 0, world)),
                        Q8::from_raw(number(random, 0, world))};
    forward = look_at(eye, target);
  }
  Vec3i up;
  if (pick(random, 0, 3) == 0) {
    up = {extreme(random, -kMaxViewComponent, kMaxViewComponent), number(random, -9, 9),
          number(random, -9, 9)};
  }
  const bool large = pick(random, 0, 3) == 0;
  const std::int32_t width = large ? extreme(random, 1, kMaxPicturePx) : number(random, 1, 200);
  const std::int32_t height = large ? extreme(random, 1, kMaxPicturePx) : number(random, 1, 120);
  const int bits = is_far ? far_bits : pick(random, 0, 2) == 0 ? pick_int(random, 8, 20) : 0;
  ++cameras_set;
  if (pick(random, 0, 2) == 0) {
    const Q14 span =
        Q14::from_raw(pick(random, 0, 2) == 0 ? extreme(random, 1, INT32_MAX)
                                              : number(random, 1, std::int64_t{2} << (14 + level)));
    return camera->set(OrthographicView{eye, forward, up, span, width, height, bits}, level) == Status::kOk;
  }
  const Q16 fov = Q16::from_raw(extreme(random, kMinFov.raw, kMaxFov.raw));
  return camera->set(PerspectiveView{eye, forward, up, fov, width, height, bits}, level) == Status::kOk;
}

// Faces that cover several pixels: close by, or through a narrow view from as far away as level 9 and 10 take it.
bool near_camera(std::mt19937_64& random, const MeasuredWorld& world, Camera* camera) {
  const reference::Voxel& voxel = world.targets[static_cast<std::size_t>(
      pick(random, 0, static_cast<std::int64_t>(world.targets.size()) - 1))];
  const bool is_close = pick(random, 0, 1) == 0;
  const std::int32_t reach = is_close ? 20 : 2040;
  const std::int32_t world_q8 = Q8::kOne << world.level;
  Vec3Q8 eye;
  Vec3Q8 target;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::int32_t>(voxel[static_cast<std::size_t>(axis)]) * Q8::kOne;
    const std::int32_t most = std::max(reach * Q8::kOne, world_q8) - world_q8;
    target[axis] = Q8::from_raw(at + number(random, 0, Q8::kOne));
    eye[axis] = Q8::from_raw(is_close ? at + number(random, -reach * Q8::kOne, reach * Q8::kOne)
                                      : extreme(random, -most, world_q8 + most));
  }
  ++cameras_set;
  const Q16 fov = Q16::saturate(is_close ? number(random, 1, 120) : 1);
  return camera->set(PerspectiveView{eye,
                                     look_at(eye, target),
                                     {},
                                     fov,
                                     number(random, 1, 200),
                                     number(random, 1, 120),
                                     pick_int(random, 13, 15)},
                     world.level) == Status::kOk;
}

// Some rows of a picture by both of the core's renderers.
void draw_rows(std::mt19937_64& random, const MeasuredWorld& world, const Camera& camera) {
  Shading shading;
  shading.mode = pick(random, 0, 1) == 0 ? ShadeMode::kDepth : ShadeMode::kNormal;
  const DepthRange range = depth_range(camera, world.tree.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  if (camera.width_px() > 400) {
    return;  // such a camera was for its set-up
  }
  const std::int32_t rows = std::min(camera.height_px(), 16);
  Band band;
  band.format = PixelFormat::kGray8;
  band.rows = rows;
  band.first_row = number(random, 0, camera.height_px() - rows);
  std::vector<std::uint8_t> pixels(band_bytes(band.format, camera.width_px(), rows));
  band.pixels = {pixels.data(), pixels.size()};
  const auto rays = static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(camera.width_px());
  if (render_band(world.tree, camera, shading, band) != Status::kOk) {
    std::abort();
  }
  rays_traced += rays;
  if (world.has_map && render_band(world.tree, world.map, camera, shading, band) == Status::kOk) {
    rays_traced += rays;
  }
}

std::string text_of(Exact value) {
  const bool negative = value < 0;
  std::string backwards;
  int count = 0;
  do {
    if (count != 0 && count % 3 == 0) {
      backwards += ',';
    }
    const int digit = static_cast<int>(value % 10);
    backwards += static_cast<char>('0' + (negative ? -digit : digit));
    value /= 10;
    ++count;
  } while (value != 0);
  if (negative) {
    backwards += '-';
  }
  return {backwards.rbegin(), backwards.rend()};
}

// Bits of the larger end.
int bits_of(const Extremes& seen) {
  const Exact least = seen.least < 0 ? -seen.least : seen.least;
  const Exact greatest = seen.greatest < 0 ? -seen.greatest : seen.greatest;
  int bits = 0;
  for (Exact most = least > greatest ? least : greatest; most != 0; most /= 2) {
    ++bits;
  }
  return bits;
}

int report() {
  int beyond = 0;
  int unseen = 0;
  std::printf(
      "| page | what | promised | bits | least | greatest |\n| --- | --- | ---: | ---: | "
      "---: | ---: |\n");
  for (std::size_t row = 0; row < std::size(kPromises); ++row) {
    const Promise& promise = kPromises[row];
    const Extremes& seen = measured_ranges[row];
    const Exact bound = static_cast<Exact>(1) << promise.bits;
    if (seen.count == 0) {
      ++unseen;
      std::printf("| %s | %s | 2^%d | never made | | |\n", promise.page, promise.what, promise.bits);
      continue;
    }
    const bool fits = seen.greatest < bound && (promise.is_signed ? seen.least > -bound : seen.least >= 0);
    beyond += fits ? 0 : 1;
    std::printf("| %s | %s | %s2^%d | %d%s | %s | %s |\n", promise.page, promise.what,
                promise.is_signed ? "+-" : "", promise.bits, bits_of(seen), fits ? "" : " BEYOND",
                text_of(seen.least).c_str(), text_of(seen.greatest).c_str());
  }
  if (unseen != 0) {
    std::fprintf(stderr, "thimble_ranges: %d of %zu numbers were never made\n", unseen, std::size(kPromises));
  }
  if (beyond != 0) {
    std::fprintf(stderr, "thimble_ranges: %d of %zu numbers are beyond what is promised\n", beyond,
                 std::size(kPromises));
  }
  return beyond == 0 && unseen == 0 ? 0 : 1;
}

}  // namespace
}  // namespace thimble::tests

int main(int argc, char** argv) {
  using namespace thimble::tests;
  const std::uint64_t wanted = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::mt19937_64 random(seed);
  const auto begin = std::chrono::steady_clock::now();
  std::uint64_t worlds = 0;
  for (; rays_traced < wanted; ++worlds) {
    const MeasuredWorld world(random);
    trace_rays(random, world, 3000);
    for (int view = 0; view < 400; ++view) {
      thimble::Camera camera;
      if (hard_camera(random, world.level, &camera) && view % 16 == 0) {
        draw_rows(random, world, camera);
      }
    }
    for (int view = 0; view < 4; ++view) {
      thimble::Camera camera;
      if (near_camera(random, world, &camera)) {
        draw_rows(random, world, camera);
      }
    }
  }
  const int status = report();
  std::printf("\n%llu rays, %llu cameras, %llu worlds, seed %llu, %.0f s\n",
              static_cast<unsigned long long>(rays_traced), static_cast<unsigned long long>(cameras_set),
              static_cast<unsigned long long>(worlds), static_cast<unsigned long long>(seed),
              std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return status;
}
