#include "golden/scenes.h"

#include "thimble/base/memory.h"

namespace thimble::golden {
namespace {

// Nodes are what the scene needs at its fullest, found with `thimble_golden_tests --sizes`.
constexpr SceneInfo kScenes[kSceneCount] = {
    {"empty", 5, 1, false, true, true},         {"full", 5, 1, false, true, true},
    {"spheres", 5, 1619, false, true, false},   {"many_spheres", 6, 3733, false, true, false},
    {"few_points", 6, 224, false, true, false}, {"points", 6, 2390, false, true, true},
    {"shell", 5, 1233, false, true, true},      {"checkerboard", 4, 2633, false, true, false},
    {"coarsened", 6, 900, true, false, false},  {"corners", 12, 89, false, false, false},
    {"marks", 4, 208, false, true, false},
};

constexpr Rgb8 kPalette[6] = {{200, 200, 200}, {230, 60, 50},  {60, 190, 80},
                              {60, 90, 220},   {240, 200, 40}, {150, 70, 180}};
constexpr Rgb8 kBackground = {16, 24, 48};

// Marsaglia's 32-bit xorshift (Journal of Statistical Software 8(14), 2003): three shifts a number, no
// multiplication.
struct Random {
  uint32_t state;
  uint32_t next() {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
  }
};

// Where voxels go: either structure, through one pair of functions.
struct Sink {
  Octree* pool;
  DenseGrid* grid;

  Status voxel(const Vec3i& at, uint8_t material) {
    return pool != nullptr ? pool->insert(at, material) : grid->set(at);
  }
  Status box(const VoxelBox& box, uint8_t material) {
    if (pool != nullptr) {
      return pool->insert_box(box, material);
    }
    Status status = Status::kOk;
    for (int32_t z = box.low.z; z < box.high.z; ++z) {
      for (int32_t y = box.low.y; y < box.high.y; ++y) {
        for (int32_t x = box.low.x; x < box.high.x && status == Status::kOk; ++x) {
          status = grid->set({x, y, z});
        }
      }
    }
    return status;
  }
};

struct Sphere {
  int8_t x, y, z, radius;
  uint8_t material;
  int8_t inner = 0;  ///< radius of what is left empty
};

constexpr Sphere kThreeSpheres[] = {{11, 16, 11, 10, 1}, {21, 14, 13, 8, 2}, {16, 18, 24, 7, 3}};
constexpr Sphere kFiveSpheres[] = {
    {20, 30, 16, 13, 1}, {42, 24, 14, 11, 2}, {30, 44, 22, 12, 3}, {36, 30, 40, 10, 4}, {18, 20, 46, 7, 5}};
constexpr Sphere kShellSphere[] = {{16, 16, 16, 14, 0, 12}};

// Voxel by voxel over each sphere's box, as the paper filled its grid. Centres are voxel corners, so a voxel's
// centre lies at odd half units: all is doubled.
Status insert_spheres(Sink& sink, Span<const Sphere> spheres) {
  Status status = Status::kOk;
  for (const Sphere& sphere : spheres) {
    const int32_t radius = sphere.radius;
    for (int32_t z = -radius; z < radius; ++z) {
      for (int32_t y = -radius; y < radius; ++y) {
        for (int32_t x = -radius; x < radius && status == Status::kOk; ++x) {
          const int32_t square =
              (2 * x + 1) * (2 * x + 1) + (2 * y + 1) * (2 * y + 1) + (2 * z + 1) * (2 * z + 1);
          if (square <= 4 * radius * radius && square >= 4 * sphere.inner * sphere.inner) {
            status = sink.voxel({sphere.x + x, sphere.y + y, sphere.z + z}, sphere.material);
          }
        }
      }
    }
  }
  return status;
}

Status insert_points(Sink& sink, int count, int level, bool materials) {
  Random random{0x9E3779B9U};
  const int shift = 32 - level;
  Status status = Status::kOk;
  for (int i = 0; i < count && status == Status::kOk; ++i) {
    Vec3i at;
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<int32_t>(random.next() >> shift);
    }
    status = sink.voxel(at, materials ? static_cast<uint8_t>(random.next() >> 29) : uint8_t{0});
  }
  return status;
}

Status insert_checkerboard(Sink& sink, int level) {
  const int32_t side = int32_t{1} << level;
  Status status = Status::kOk;
  for (int32_t z = 0; z < side; ++z) {
    for (int32_t y = 0; y < side; ++y) {
      for (int32_t x = (y + z) & 1; x < side && status == Status::kOk; x += 2) {
        status = sink.voxel({x, y, z}, static_cast<uint8_t>(1 + (((x >> 1) ^ z) & 1)));
      }
    }
  }
  return status;
}

Status insert_corners(Sink& sink, int level) {
  const int32_t last = (int32_t{1} << level) - 1;
  Status status = Status::kOk;
  for (int32_t corner = 0; corner < 8 && status == Status::kOk; ++corner) {
    status = sink.voxel({(corner & 1) * last, (corner >> 1 & 1) * last, (corner >> 2) * last},
                        static_cast<uint8_t>(corner));
  }
  return status;
}

// A floor, a bar along x (red, from the origin), a shorter one along y (green), a shortest one up z (blue).
Status insert_marks(Sink& sink) {
  struct Part {
    VoxelBox box;
    uint8_t material;
  };
  constexpr Part kParts[] = {{{{0, 0, 0}, {16, 16, 1}}, 0},
                             {{{2, 2, 1}, {14, 4, 3}}, 1},
                             {{{2, 4, 1}, {4, 11, 3}}, 2},
                             {{{2, 2, 3}, {4, 4, 8}}, 3},
                             {{{11, 11, 1}, {13, 13, 3}}, 4}};
  Status status = Status::kOk;
  for (const Part& part : kParts) {
    status = status == Status::kOk ? sink.box(part.box, part.material) : status;
  }
  return status;
}

Status fill(SceneId id, Sink& sink) {
  const SceneInfo& info = scene_info(id);
  switch (id) {
    case SceneId::kEmpty:
      return Status::kOk;
    case SceneId::kFull:
      return sink.box({{0, 0, 0}, {32, 32, 32}}, 0);
    case SceneId::kSpheres:
      return insert_spheres(sink, kThreeSpheres);
    case SceneId::kManySpheres:
    case SceneId::kCoarsened:
      return insert_spheres(sink, kFiveSpheres);
    case SceneId::kFewPoints:
      return insert_points(sink, 60, info.level, true);
    case SceneId::kPoints:
      return insert_points(sink, 1000, info.level, false);
    case SceneId::kShell:
      return insert_spheres(sink, kShellSphere);
    case SceneId::kCheckerboard:
      return insert_checkerboard(sink, info.level);
    case SceneId::kCorners:
      return insert_corners(sink, info.level);
    case SceneId::kMarks:
      return insert_marks(sink);
  }
  return Status::kBadArgument;
}

Status build_grid(SceneId id, Arena* arena, DenseGrid* grid) {
  const int32_t side = int32_t{1} << scene_info(id).level;
  const Vec3i size{side, side, side};
  const Bytes bytes = arena->take(dense_grid_bytes(size));
  const Status status = DenseGrid::make(size, bytes, grid);
  if (status != Status::kOk) {
    return status;
  }
  Sink sink{nullptr, grid};
  return fill(id, sink);
}

Status build_pool(SceneId id, Arena* arena, Octree* pool) {
  const SceneInfo& info = scene_info(id);
  const Status status = Octree::make(info.level, arena->take(Octree::octree_bytes(info.pool_nodes)), pool);
  if (status != Status::kOk) {
    return status;
  }
  pool->set_coarsen(info.coarsen);
  Sink sink{pool, nullptr};
  return fill(id, sink);
}

// --- the frames ------------------------------------------------------------------------------------------

// A frame with default up and automatic bits, which the 32-bit path takes: true of all but a few.
constexpr Frame pinhole(const char* name, SceneId scene, Vec3i eye_q8, Vec3i target_q8, int32_t fov,
                        ShadeMode shade, PixelFormat format, int16_t width, int16_t height) {
  return {name, scene, true, eye_q8, target_q8, {}, fov, 0, shade, format, width, height, true};
}
constexpr Frame parallel(const char* name, SceneId scene, Vec3i eye_q8, Vec3i target_q8, int32_t span,
                         ShadeMode shade, PixelFormat format, int16_t width, int16_t height) {
  return {name, scene, false, eye_q8, target_q8, {}, span, 0, shade, format, width, height, true};
}
constexpr Frame with_up(Frame frame, Vec3i up) {
  frame.up = up;
  return frame;
}
constexpr Frame with_bits(Frame frame, uint8_t bits, bool narrow) {
  frame.direction_bits = bits;
  frame.narrow = narrow;
  return frame;
}

using enum SceneId;
using enum ShadeMode;
using enum PixelFormat;

constexpr int32_t side_q8(int level) {
  return Q8::kOne << level;
}
// In front of a world (small y), to its left (small x) and above it, at no lattice point.
constexpr Vec3i kFront5{-3001, -7003, 11987};
constexpr Vec3i kMiddle5{4096, 4096, 3301};
constexpr Vec3i kFront6{-2003, -11009, 22961};
constexpr Vec3i kMiddle6{8192, 7717, 6899};
constexpr Vec3i kLowest{128, 128, 128};
constexpr Vec3i kHighest{side_q8(12) - 128, side_q8(12) - 128, side_q8(12) - 128};

constexpr Frame kFrames[] = {
    pinhole("empty_depth_rgb888", kEmpty, kFront5, kMiddle5, 38, kDepth, kRgb888, 9, 7),
    parallel("empty_mono_mono1", kEmpty, kFront5, kMiddle5, 40, kMono, kMono1, 11, 5),

    // A solid cube: as one block, from far away, from a corner through edges, from inside.
    pinhole("full_depth_gray8", kFull, kFront5, kMiddle5, 50, kDepth, kGray8, 33, 21),
    parallel("full_normal_rgb888_diagonal", kFull, {-8192, -8192, 16384}, {0, 0, 8192}, 64, kNormal, kRgb888,
             33, 21),
    pinhole("full_color_rgb565_5_worlds_away", kFull, {40960, 40960, 40960}, {4096, 4096, 4096}, 14, kColor,
            kRgb565, 33, 21),
    pinhole("full_normal_rgb888_inside", kFull, {4096, 4096, 4096}, {5003, 4999, 4111}, 90, kNormal, kRgb888,
            21, 15),
    pinhole("full_depth_gray8_inside", kFull, {4096, 4096, 4096}, {5003, 4999, 4111}, 90, kDepth, kGray8, 21,
            15),

    // Every format and every shade mode of one view, and both projections.
    pinhole("spheres_depth_mono1", kSpheres, kFront5, kMiddle5, 38, kDepth, kMono1, 61, 37),
    pinhole("spheres_depth_gray4", kSpheres, kFront5, kMiddle5, 38, kDepth, kGray4, 61, 37),
    pinhole("spheres_depth_gray8", kSpheres, kFront5, kMiddle5, 38, kDepth, kGray8, 61, 37),
    pinhole("spheres_depth_rgb565", kSpheres, kFront5, kMiddle5, 38, kDepth, kRgb565, 61, 37),
    pinhole("spheres_depth_rgb888", kSpheres, kFront5, kMiddle5, 38, kDepth, kRgb888, 61, 37),
    pinhole("spheres_normal_rgb888", kSpheres, kFront5, kMiddle5, 38, kNormal, kRgb888, 61, 37),
    pinhole("spheres_color_rgb888", kSpheres, kFront5, kMiddle5, 38, kColor, kRgb888, 61, 37),
    pinhole("spheres_mono_mono1", kSpheres, kFront5, kMiddle5, 38, kMono, kMono1, 61, 37),
    parallel("spheres_parallel_depth_gray8", kSpheres, kFront5, kMiddle5, 42, kDepth, kGray8, 61, 37),
    parallel("spheres_parallel_color_rgb565", kSpheres, kFront5, kMiddle5, 42, kColor, kRgb565, 33, 21),
    with_bits(pinhole("spheres_depth_gray8_8_bits", kSpheres, kFront5, kMiddle5, 38, kDepth, kGray8, 33, 21),
              8, true),
    with_bits(pinhole("spheres_depth_gray8_20_bits", kSpheres, kFront5, kMiddle5, 38, kDepth, kGray8, 33, 21),
              20, false),

    pinhole("many_spheres_color_rgb888", kManySpheres, kFront6, kMiddle6, 34, kColor, kRgb888, 61, 37),
    pinhole("many_spheres_depth_mono1_128x64", kManySpheres, kFront6, kMiddle6, 30, kDepth, kMono1, 128, 64),
    parallel("many_spheres_parallel_normal_rgb565", kManySpheres, kFront6, kMiddle6, 90, kNormal, kRgb565, 33,
             21),

    pinhole("few_points_color_rgb888", kFewPoints, kFront6, kMiddle6, 34, kColor, kRgb888, 61, 37),
    parallel("few_points_parallel_mono_mono1", kFewPoints, kFront6, kMiddle6, 110, kMono, kMono1, 61, 37),
    pinhole("points_depth_gray4", kPoints, kFront6, kMiddle6, 34, kDepth, kGray4, 61, 37),
    pinhole("points_color_rgb565_inside", kPoints, {8000, 8100, 8200}, {9000, 16000, 7000}, 100, kColor,
            kRgb565, 33, 21),
    // The paper's first tracer: parallel, straight, black and white.
    parallel("points_parallel_mono_mono1_128x64", kPoints, {8192, -512, 8192}, {8192, 8192, 8192}, 128, kMono,
             kMono1, 128, 64),

    pinhole("shell_depth_gray8_inside", kShell, {4097, 4093, 4099}, {6001, 8009, 4507}, 120, kDepth, kGray8,
            33, 21),
    pinhole("shell_normal_rgb888_inside", kShell, {4097, 4093, 4099}, {6001, 8009, 4507}, 120, kNormal,
            kRgb888, 33, 21),
    parallel("shell_parallel_depth_gray4", kShell, kFront5, {4096, 4096, 4096}, 40, kDepth, kGray4, 33, 21),

    // Rays through edges and corners of the lattice, and within its planes.
    parallel("checkerboard_parallel_normal_rgb888_diagonal", kCheckerboard, {-2048, -2048, -2048},
             {2048, 2048, 2048}, 32, kNormal, kRgb888, 33, 33),
    parallel("checkerboard_parallel_color_rgb888_in_planes", kCheckerboard, {2048, -1024, 2048},
             {2048, 2048, 2048}, 33, kColor, kRgb888, 33, 21),
    pinhole("checkerboard_color_rgb888_at_corner", kCheckerboard, {-512, -512, 2048}, {2048, 2048, 2048}, 90,
            kColor, kRgb888, 33, 21),
    pinhole("checkerboard_normal_rgb888_inside", kCheckerboard, {2048, 2048, 2048}, {2048, 4096, 2048}, 120,
            kNormal, kRgb888, 15, 9),

    pinhole("coarsened_depth_gray8", kCoarsened, kFront6, kMiddle6, 34, kDepth, kGray8, 61, 37),
    pinhole("coarsened_color_rgb888", kCoarsened, kFront6, kMiddle6, 34, kColor, kRgb888, 61, 37),
    parallel("coarsened_parallel_normal_rgb565", kCoarsened, kFront6, kMiddle6, 90, kNormal, kRgb565, 33, 21),

    // The largest world, from beside its corners and from its other end, with the longest numbers.
    with_bits(pinhole("corners_color_rgb888_lowest", kCorners, {-701, -903, 1109}, kLowest, 30, kColor,
                      kRgb888, 33, 21),
              20, false),
    pinhole("corners_color_rgb888_highest", kCorners,
            {side_q8(12) + 511, side_q8(12) + 907, side_q8(12) + 603}, kHighest, 30, kColor, kRgb888, 33, 21),
    with_bits(parallel("corners_parallel_normal_rgb888", kCorners,
                       {side_q8(12) / 2, -4 * side_q8(12) + 8 * Q8::kOne, 128}, {128, 128, 128}, 6, kNormal,
                       kRgb888, 21, 15),
              0, false),

    // What is right, up and in front.
    pinhole("marks_color_rgb888", kMarks, {5003, -4007, 4001}, {2048, 1800, 512}, 50, kColor, kRgb888, 61,
            37),
    parallel("marks_parallel_color_rgb888_from_above", kMarks, {2048, 2048, 8192}, {2048, 2048, 0}, 30,
             kColor, kRgb888, 33, 21),
    with_up(pinhole("marks_normal_rgb565_tilted", kMarks, {5003, -4007, 4001}, {2048, 1800, 512}, 50, kNormal,
                    kRgb565, 33, 21),
            {1, 0, 1}),
    pinhole("marks_depth_rgb888_one_row", kMarks, {2048, -2048, 700}, {2048, 2048, 600}, 1, kDepth, kRgb888,
            61, 1),
};

constexpr Variant kVariants[] = {
    {Structure::kCompact, Width::k64, 0},   {Structure::kCompact, Width::k32, 3},
    {Structure::kCompact, Width::kAuto, 1}, {Structure::kPool, Width::kAuto, 8},
    {Structure::kPool, Width::k32, 0},      {Structure::kPool, Width::k64, 3},
    {Structure::kDense, Width::k64, 1},     {Structure::kDense, Width::k32, 8},
};

Vec3Q8 position(const Vec3i& raw) {
  return {Q8::from_raw(raw.x), Q8::from_raw(raw.y), Q8::from_raw(raw.z)};
}

Status draw_band(const World& world, const Camera& camera, const Shading& shading, const Band& band,
                 RenderCounts* counts, const TraceOptions& options) {
  switch (world.structure) {
    case Structure::kDense:
      return render_band(world.grid, camera, shading, band, counts, options);
    case Structure::kPool:
      return render_band(world.pool, camera, shading, band, counts, options);
    case Structure::kCompact:
      return render_band(world.compact, camera, shading, band, counts, options);
  }
  return Status::kBadArgument;
}

}  // namespace

const SceneInfo& scene_info(SceneId id) {
  return kScenes[static_cast<int>(id)];
}

Status build_scene(SceneId id, Structure structure, Arena* arena, World* world) {
  world->structure = structure;
  if (structure == Structure::kDense) {
    return build_grid(id, arena, &world->grid);
  }
  Status status = build_pool(id, arena, &world->pool);
  if (status != Status::kOk || structure == Structure::kPool) {
    return status;
  }
  const Bytes bytes = arena->take(compact_bytes(compact_shape(world->pool)));
  size_t written = 0;
  status = CompactTree::make(world->pool, bytes, nullptr, &written);
  if (status != Status::kOk) {
    return status;
  }
  return CompactTree::open({bytes.data, written}, &world->compact);
}

int frame_count() {
  return static_cast<int>(sizeof kFrames / sizeof kFrames[0]);
}
const Frame& frame(int index) {
  return kFrames[index];
}

Status set_up(const Frame& frame, Camera* camera, Shading* shading) {
  const int level = scene_info(frame.scene).level;
  const Vec3Q8 eye = position(frame.eye_q8);
  const Vec3i forward = look_at(eye, position(frame.target_q8));
  Status status = Status::kOk;
  if (frame.perspective) {
    status = camera->set(PerspectiveView{eye, forward, frame.up, Q16::saturate(frame.fov_or_span),
                                         frame.width_px, frame.height_px, frame.direction_bits},
                         level);
  } else {
    status = camera->set(OrthographicView{eye, forward, frame.up, Q14::saturate(frame.fov_or_span),
                                          frame.width_px, frame.height_px, frame.direction_bits},
                         level);
  }
  if (status != Status::kOk) {
    return status;
  }
  const int32_t side = int32_t{1} << level;
  const DepthRange range = depth_range(*camera, {{0, 0, 0}, {side, side, side}});
  *shading = Shading{};
  shading->mode = frame.shade;
  shading->palette = Span<const Rgb8>(kPalette);
  shading->background = kBackground;
  shading->near_q8 = range.near_q8;
  shading->far_q8 = range.far_q8;
  light_from({-3, -5, 9}, shading->face_light);
  return Status::kOk;
}

int variant_count() {
  return static_cast<int>(sizeof kVariants / sizeof kVariants[0]);
}
const Variant& variant(int index) {
  return kVariants[index];
}

bool applies(const Frame& frame, const Variant& variant) {
  const SceneInfo& info = scene_info(frame.scene);
  if (variant.structure == Structure::kDense) {
    if (frame.shade == ShadeMode::kColor ? !info.has_dense_color : !info.has_dense) {
      return false;
    }
  }
  return variant.width != Width::k32 || frame.narrow;
}

Status frame_crc32(const Frame& frame, const World& world, Width width, int32_t band_rows, Bytes band_bytes,
                   uint32_t* crc, RenderCounts* counts) {
  Camera camera;
  Shading shading;
  const Status status = set_up(frame, &camera, &shading);
  if (status != Status::kOk) {
    return status;
  }
  return frame_crc32(frame, world, camera, shading, width, band_rows, band_bytes, crc, counts);
}

Status frame_crc32(const Frame& frame, const World& world, const Camera& camera, const Shading& shading,
                   Width width, int32_t band_rows, Bytes band_bytes, uint32_t* crc, RenderCounts* counts) {
  const int32_t height = camera.height_px();
  const int32_t step = band_rows == 0 ? height : band_rows;
  TraceOptions options;
  options.width = width;
  uint32_t sum = 0;
  for (int32_t row = 0; row < height; row += step) {
    Band band{.pixels = band_bytes,
              .format = frame.format,
              .first_row = row,
              .rows = step < height - row ? step : height - row};
    const Status status = draw_band(world, camera, shading, band, counts, options);
    if (status != Status::kOk) {
      return status;
    }
    sum = crc32({band_bytes.data, thimble::band_bytes(frame.format, camera.width_px(), band.rows)}, sum);
  }
  *crc = sum;
  return Status::kOk;
}

}  // namespace thimble::golden
