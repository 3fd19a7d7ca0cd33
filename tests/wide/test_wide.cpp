// The host's object-order renderer draws the core's picture: every pixel of every frame here is compared with
// render_band's.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "scene/wide_renderer.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/tree/octree.h"
#include "wide/renderer.h"

namespace thimble::tests {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr int kScenes = 120;
constexpr int kScenesEachSet = 12;
#else
constexpr int kScenes = 1500;
constexpr int kScenesEachSet = 100;
#endif

// A tree and its lists, in exactly the bytes that are asked for.
struct Scene {
  std::string what;
  int level = 0;
  std::unique_ptr<HeapBytes> bytes;
  std::unique_ptr<HeapBytes> list_bytes;
  CompactTree tree;
  wide::VoxelLists lists;
};

void make_lists(Scene* scene) {
  scene->tree = open_or_throw(*scene->bytes);
  scene->list_bytes = std::make_unique<HeapBytes>(wide::VoxelLists::bytes(scene->tree));
  Arena arena(scene->list_bytes->span());
  REQUIRE(wide::VoxelLists::make(scene->tree, &arena, &scene->lists) == Status::kOk);
}

Scene random_scene(std::mt19937_64& random) {
  Scene scene;
  scene.level = static_cast<int>(pick(random, 1, 12));
  const std::int32_t side = std::int32_t{1} << scene.level;
  HeapBytes pool(std::size_t{4} << 20);
  Octree octree;
  REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
  const auto materials = pick(random, 0, 3) == 0 ? 200 : 1;
  const auto material = [&] { return static_cast<std::uint8_t>(pick(random, 1, materials)); };
  const auto anywhere = [&](std::int32_t low, std::int32_t high) {
    return Vec3i{static_cast<std::int32_t>(pick(random, low, high)),
                 static_cast<std::int32_t>(pick(random, low, high)),
                 static_cast<std::int32_t>(pick(random, low, high))};
  };
  const std::int64_t kind = pick(random, 0, 9);
  switch (kind) {
    case 0:
      scene.what = "empty";
      break;
    case 1:
      scene.what = "full";
      REQUIRE(octree.insert_block({0, 0, 0}, scene.level, material()) == Status::kOk);
      break;
    case 2:
      scene.what = "one voxel";
      REQUIRE(octree.insert(anywhere(0, side - 1), material()) == Status::kOk);
      break;
    case 3:
    case 4:
      scene.what = "blocks";
      for (std::int64_t i = pick(random, 1, 60); i > 0; --i) {
        const int block = static_cast<int>(pick(random, 0, std::max(0, scene.level - 1)));
        const Vec3i at = anywhere(0, (side >> block) - 1);
        (void)octree.insert_block({at.x << block, at.y << block, at.z << block}, block, material());
      }
      break;
    case 5: {
      scene.what = "crowd";  // dense, around a point
      const Vec3i middle = anywhere(0, side - 1);
      const auto radius = static_cast<std::int32_t>(pick(random, 1, 12));
      for (std::int64_t i = pick(random, 100, 4000); i > 0; --i) {
        const Vec3i step = anywhere(-radius, radius);
        (void)octree.insert(
            {std::clamp(middle.x + step.x, 0, side - 1), std::clamp(middle.y + step.y, 0, side - 1),
             std::clamp(middle.z + step.z, 0, side - 1)},
            material());
      }
      break;
    }
    case 6: {
      scene.what = "floor";
      const std::int32_t height = static_cast<std::int32_t>(pick(random, 0, side - 1));
      const std::int32_t most = std::min(side, 60);
      for (std::int32_t y = 0; y < most; ++y) {
        for (std::int32_t x = 0; x < most; ++x) {
          (void)octree.insert({x, y, height}, material());
        }
      }
      break;
    }
    default:
      scene.what = "points";
      for (std::int64_t i = pick(random, 1, pick(random, 0, 9) == 0 ? 20000 : 2000); i > 0; --i) {
        (void)octree.insert(anywhere(0, side - 1), material());
      }
      break;
  }
  if (pick(random, 0, 9) == 0 && octree.nodes_used() > 8) {
    scene.what += ", merged";
    (void)octree.coarsen_to(octree.nodes_used() / 2);
  }
  scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
  make_lists(&scene);
  return scene;
}

// A point in 1/256 voxel: anywhere within `worlds` of the world, or on a plane, an edge or a corner of
// voxels.
Vec3Q8 random_point(std::mt19937_64& random, int level, std::int64_t low_worlds, std::int64_t high_worlds) {
  Vec3Q8 point;
  const std::int64_t world = std::int64_t{256} << level;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t raw = pick(random, low_worlds * world, high_worlds * world);
    if (pick(random, 0, 2) == 0) {
      raw = raw / 256 * 256;
    }
    point[axis] = Q8::from_raw(static_cast<std::int32_t>(raw));
  }
  return point;
}

// Sets up some camera; false where the core refuses what was drawn.
bool random_camera(std::mt19937_64& random, const Scene& scene, Camera* camera) {
  const int level = scene.level;
  const auto width = static_cast<std::int32_t>(pick(random, 1, 90));
  const auto height = static_cast<std::int32_t>(pick(random, 1, 40));
  const bool inside = pick(random, 0, 2) == 0;
  const Vec3Q8 eye = inside ? random_point(random, level, 0, 1) : random_point(random, level, -4, 5);
  // At something solid, or anywhere.
  Vec3Q8 target = random_point(random, level, 0, 1);
  const auto entries = scene.lists.entries();
  if (entries.size != 0 && pick(random, 0, 1) == 0) {
    const VoxelBox& bounds = scene.tree.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      target[axis] = Q8::from_raw(static_cast<std::int32_t>(
          pick(random, std::int64_t{256} * bounds.low[axis], std::int64_t{256} * bounds.high[axis])));
    }
  }
  Vec3i forward = look_at(eye, target);
  switch (pick(random, 0, 5)) {
    case 0: {  // along an axis
      const int axis = static_cast<int>(pick(random, 0, 2));
      const std::int32_t sign = pick(random, 0, 1) == 0 ? -1 : 1;
      forward = {};
      forward[axis] = sign;
      break;
    }
    case 1:  // in a plane
      forward[static_cast<int>(pick(random, 0, 2))] = 0;
      break;
    default:
      break;
  }
  const int bits = pick(random, 0, 3) == 0 ? static_cast<int>(pick(random, 8, 20)) : 0;
  if (pick(random, 0, 2) == 0) {
    OrthographicView view;
    view.eye = eye;
    view.forward = forward;
    const double most = std::ldexp(1.0, level) * 2;
    const double least = most / 4000;
    const double span = least * std::pow(most / least, static_cast<double>(pick(random, 0, 1000)) / 1000);
    view.span = Q14::from_raw(std::max(1, static_cast<std::int32_t>(span * Q14::kOne)));
    view.width_px = width;
    view.height_px = height;
    view.direction_bits = bits;
    return camera->set(view, level) == Status::kOk;
  }
  PerspectiveView view;
  view.eye = eye;
  view.forward = forward;
  view.fov_degrees =
      Q16::from_raw(static_cast<std::int32_t>(pick(random, 0, 3) == 0   ? 65536
                                              : pick(random, 0, 3) == 0 ? 120 * 65536
                                                                        : pick(random, 65536, 120 * 65536)));
  view.width_px = width;
  view.height_px = height;
  view.direction_bits = bits;
  return camera->set(view, level) == Status::kOk;
}

struct Frame {
  Camera camera;
  Shading shading;
  Band band;
  std::vector<Rgb8> palette;
};

bool random_frame(std::mt19937_64& random, const Scene& scene, Frame* frame) {
  if (!random_camera(random, scene, &frame->camera)) {
    return false;
  }
  Shading& shading = frame->shading;
  shading.mode = static_cast<ShadeMode>(pick(random, 0, 3));
  for (std::int64_t i = pick(random, 0, 255); i > 0; --i) {
    frame->palette.push_back({static_cast<std::uint8_t>(pick(random, 0, 255)),
                              static_cast<std::uint8_t>(pick(random, 0, 255)),
                              static_cast<std::uint8_t>(pick(random, 0, 255))});
  }
  shading.palette = Span<const Rgb8>(frame->palette.data(), frame->palette.size());
  if (pick(random, 0, 1) == 0) {
    shading.background = {static_cast<std::uint8_t>(pick(random, 0, 255)), 77, 200};
  }
  const DepthRange range = depth_range(frame->camera, scene.tree.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  if (pick(random, 0, 9) == 0) {
    shading.near_q8 = static_cast<std::int32_t>(pick(random, INT32_MIN, INT32_MAX));
    shading.far_q8 = static_cast<std::int32_t>(pick(random, INT32_MIN, INT32_MAX));
  }
  Band& band = frame->band;
  band.format = static_cast<PixelFormat>(pick(random, 0, 4));
  const std::int32_t height = frame->camera.height_px();
  band.first_row = pick(random, 0, 1) == 0 ? 0 : static_cast<std::int32_t>(pick(random, 0, height - 1));
  band.rows = pick(random, 0, 1) == 0 ? height - band.first_row
                                      : static_cast<std::int32_t>(pick(random, 0, height - band.first_row));
  if (pick(random, 0, 2) == 0) {
    band.stride_bytes =
        row_bytes(band.format, frame->camera.width_px()) + static_cast<std::size_t>(pick(random, 0, 9));
  }
  return true;
}

std::size_t band_size(const Frame& frame) {
  const std::size_t line = row_bytes(frame.band.format, frame.camera.width_px());
  const std::size_t stride = frame.band.stride_bytes == 0 ? line : frame.band.stride_bytes;
  return frame.band.rows == 0 ? 0 : stride * static_cast<std::size_t>(frame.band.rows - 1) + line;
}

// Kept from frame to frame, as those who draw films do.
wide::Threads* threads_of(int count) {
  static std::map<int, std::unique_ptr<wide::Threads>> kept;
  auto& threads = kept[count];
  if (threads == nullptr) {
    threads = std::make_unique<wide::Threads>(count);
  }
  return threads.get();
}
int thread_count(const wide::Options& options) {
  return options.threads == nullptr ? 1 : options.threads->count();
}

// The band by this renderer; nothing where it leaves the frame to the core.
std::optional<std::vector<std::uint8_t>> draw_wide(const Scene& scene, const Frame& frame,
                                                   const wide::Options& options,
                                                   std::uint64_t* hits = nullptr,
                                                   wide::Stats* stats = nullptr) {
  const HeapBytes pixels(band_size(frame));
  std::memset(pixels.span().data, 0xA5, pixels.span().size);
  const HeapBytes workspace(
      wide::workspace_bytes(frame.camera.width_px(), frame.band.rows, thread_count(options)));
  Band band = frame.band;
  band.pixels = pixels.span();
  RenderCounts counts;
  const Status status =
      wide::render(scene.lists, frame.camera, frame.shading, band, workspace.span(), &counts, options, stats);
  if (hits != nullptr) {
    *hits = counts.hits;
  }
  const std::vector<std::uint8_t> drawn(band.pixels.data, band.pixels.data + band.pixels.size);
  if (status == Status::kTooFine) {
    CHECK(std::all_of(drawn.begin(), drawn.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
    return std::nullopt;
  }
  CHECK(status == Status::kOk);
  return drawn;
}

std::vector<std::uint8_t> draw_core(const Scene& scene, const Frame& frame, std::uint64_t* hits) {
  std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
  Band band = frame.band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  RenderCounts counts;
  CHECK(render_band(scene.tree, frame.camera, frame.shading, band, &counts) == Status::kOk);
  *hits = counts.hits;
  return pixels;
}

wide::Options random_options(std::mt19937_64& random) {
  wide::Options options;
  constexpr int kThreads[] = {1, 1, 1, 2, 5};
  options.threads = threads_of(kThreads[pick(random, 0, 4)]);
  options.order = static_cast<wide::Order>(pick(random, 0, 2));
  return options;
}

struct BestInstructionSet {
  ~BestInstructionSet() { wide::use_instruction_set(-1); }
};

}  // namespace

TEST_CASE("wide: random scenes, cameras, shades, formats and bands -> every pixel is the core's") {
  const BestInstructionSet after;
  int left_to_core = 0;
  int drawn = 0;
  std::uint64_t all_hits = 0;
  for (int i = 0; i < kScenes; ++i) {
    const std::uint64_t seed = 7000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const Scene scene = random_scene(random);
    wide::use_instruction_set(static_cast<int>(pick(random, 0, wide::instruction_set_count() - 1)));
    for (int view = 0; view < 2; ++view) {
      Frame frame;
      if (!random_frame(random, scene, &frame)) {
        continue;
      }
      CAPTURE(seed);
      CAPTURE(view);
      CAPTURE(scene.what);
      CAPTURE(scene.level);
      CAPTURE(wide::instruction_set());
      CAPTURE(frame.camera.is_perspective());
      const wide::Options options = random_options(random);
      CAPTURE(thread_count(options));
      CAPTURE(static_cast<int>(options.order));
      std::uint64_t hits = 0;
      std::uint64_t expected_hits = 0;
      const auto ours = draw_wide(scene, frame, options, &hits);
      if (!ours) {
        ++left_to_core;
        continue;
      }
      ++drawn;
      const auto expected = draw_core(scene, frame, &expected_hits);
      CHECK(hits == expected_hits);
      std::size_t different = 0;
      for (std::size_t at = 0; at < expected.size(); ++at) {
        different += (*ours)[at] != expected[at] ? 1U : 0U;
      }
      CHECK(different == 0);
      all_hits += hits;
    }
  }
  CHECK(drawn > kScenes);
  CHECK(left_to_core < drawn / 4);
  CHECK(all_hits > static_cast<std::uint64_t>(drawn) * 50);
}

TEST_CASE("wide: greys found as voxels are met -> every pixel is the core's, between any two planes") {
  const BestInstructionSet after;
#ifdef __SANITIZE_ADDRESS__
  constexpr int kFrames = 150;
#else
  constexpr int kFrames = 800;
#endif
  std::uint64_t met = 0;
  std::uint64_t exact = 0;
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 52000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    Scene scene;
    scene.level = static_cast<int>(pick(random, 6, 10));
    const std::int64_t side = std::int64_t{1} << scene.level;
    const HeapBytes pool(std::size_t{4} << 20);
    Octree octree;
    REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
    // Near one another in part, so that some lie before others; no eight that make a block.
    for (std::int64_t n = pick(random, 1, 6000); n > 0; --n) {
      const std::int64_t most = pick(random, 0, 2) == 0 ? side - 1 : std::min<std::int64_t>(side - 1, 63);
      const Vec3i at{static_cast<std::int32_t>(pick(random, 0, most)),
                     static_cast<std::int32_t>(pick(random, 0, most)),
                     static_cast<std::int32_t>(pick(random, 0, most))};
      if ((at.x & at.y & at.z & 1) == 0) {
        REQUIRE(octree.insert(at, 1) == Status::kOk);
      }
    }
    scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
    make_lists(&scene);
    REQUIRE_FALSE(scene.lists.has_blocks());
    wide::use_instruction_set(static_cast<int>(pick(random, 0, wide::instruction_set_count() - 1)));
    Frame frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    frame.shading.mode = ShadeMode::kDepth;
    if (pick(random, 0, 1) == 0) {
      // Some part of the range; where floats do not tell greys, they are found at the end.
      const std::int64_t range = frame.shading.far_q8 - std::int64_t{frame.shading.near_q8};
      const std::int64_t part = range >> pick(random, 0, 3);
      if (range > 0 && part > 0 && frame.shading.near_q8 >= 0) {
        frame.shading.near_q8 += static_cast<std::int32_t>(pick(random, 0, range - part));
        frame.shading.far_q8 = frame.shading.near_q8 + static_cast<std::int32_t>(part);
      }
    }
    CAPTURE(scene.level);
    CAPTURE(wide::instruction_set());
    CAPTURE(frame.camera.is_perspective());
    CAPTURE(frame.shading.near_q8);
    CAPTURE(frame.shading.far_q8);
    const wide::Options options = random_options(random);
    wide::Stats stats;
    const auto ours = draw_wide(scene, frame, options, nullptr, &stats);
    if (!ours) {
      continue;
    }
    std::uint64_t expected_hits = 0;
    CHECK(*ours == draw_core(scene, frame, &expected_hits));
    met += stats.counts.hits;
    exact += stats.counts.exact;
  }
  CHECK(met > kFrames * std::uint64_t{20});
  INFO(exact << " of " << met);
  CHECK(exact > met / 500);
}

TEST_CASE("wide: several threads with a picture each -> put together, every pixel is the core's") {
  const BestInstructionSet after;
#ifdef __SANITIZE_ADDRESS__
  constexpr int kFrames = 2;
#else
  constexpr int kFrames = 24;
#endif
  std::mt19937_64 random(77);
  Scene scene;
  scene.level = 9;
  const HeapBytes pool(std::size_t{24} << 20);
  Octree octree;
  REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
  for (int i = 0; i < 200000; ++i) {
    const Vec3i at{static_cast<std::int32_t>(pick(random, 0, 511)),
                   static_cast<std::int32_t>(pick(random, 0, 511)),
                   static_cast<std::int32_t>(pick(random, 0, 511))};
    REQUIRE(octree.insert(at, static_cast<std::uint8_t>(pick(random, 1, 3))) == Status::kOk);
  }
  scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
  make_lists(&scene);
  int drawn = 0;
  for (int i = 0; i < kFrames; ++i) {
    Frame frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    frame.shading.mode = i % 2 == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
    wide::use_instruction_set(i % wide::instruction_set_count());
    std::uint64_t expected_hits = 0;
    const auto expected = draw_core(scene, frame, &expected_hits);
    for (const int threads : {2, 3, 4}) {
      CAPTURE(i);
      CAPTURE(threads);
      CAPTURE(wide::instruction_set());
      wide::Options options;
      options.threads = threads_of(threads);
      options.order = wide::Order::kFlat;
      std::uint64_t hits = 0;
      const auto ours = draw_wide(scene, frame, options, &hits);
      if (ours) {
        CHECK(*ours == expected);
        CHECK(hits == expected_hits);
        ++drawn;
      }
    }
  }
  CHECK(drawn >= kFrames);
}

TEST_CASE("wide: a few solid blocks among single voxels -> given as voxels; more of them, or merged, not") {
  Octree octree;
  const HeapBytes pool(std::size_t{1} << 20);
  const auto made = [&](int blocks, int voxels, int block_level) {
    Scene scene;
    scene.level = 8;
    REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
    for (int i = 0; i < blocks; ++i) {
      REQUIRE(octree.insert_block({i << 4, 64, 0}, block_level, static_cast<std::uint8_t>(i)) == Status::kOk);
    }
    for (int i = 0; i < voxels; ++i) {
      REQUIRE(octree.insert({2 * (i % 100), 0, 2 * (i / 100)}, 200) == Status::kOk);
    }
    scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
    make_lists(&scene);
    return scene;
  };
  // 8 voxels for 1 box: 7 more.
  Scene few = made(2, 7 * 2 * 8 - 2, 1);
  CHECK_FALSE(few.lists.has_blocks());
  CHECK(few.lists.entries().size == 7 * 2 * 8 - 2 + 2 * 8);
  CHECK(few.lists.face_area() == few.lists.entries().size);
  CHECK(made(2, 7 * 2 * 8 - 3, 1).lists.has_blocks());
  CHECK_FALSE(made(1, 8 * 63, 2).lists.has_blocks());
  CHECK(made(1, 8 * 60, 2).lists.has_blocks());
  // Blocks keep their colours, each voxel of them.
  Scene colored = made(3, 1600, 2);
  REQUIRE_FALSE(colored.lists.has_blocks());
  REQUIRE(colored.lists.materials().size == colored.lists.entries().size);
  std::size_t of_first = 0;
  for (std::size_t i = 0; i < colored.lists.entries().size; ++i) {
    of_first += colored.lists.materials()[i] == 0 ? 1U : 0U;
  }
  CHECK(of_first == 64);
  std::mt19937_64 random(5);
  for (int view = 0; view < 20; ++view) {
    Frame frame;
    if (!random_frame(random, colored, &frame)) {
      continue;
    }
    frame.shading.mode = view % 2 == 0 ? ShadeMode::kColor : ShadeMode::kDepth;
    const auto ours = draw_wide(colored, frame, random_options(random));
    std::uint64_t hits = 0;
    if (ours) {
      CHECK(*ours == draw_core(colored, frame, &hits));
    }
  }
  REQUIRE(Octree::make(8, pool.span(), &octree) == Status::kOk);
  for (int i = 0; i < 3000; ++i) {
    REQUIRE(octree.insert({2 * (i % 100), i / 1000, 2 * (i / 100 % 10)}, 1) == Status::kOk);
  }
  (void)octree.coarsen_to(octree.nodes_used() - 2);
  Scene merged;
  merged.level = 8;
  merged.bytes = std::make_unique<HeapBytes>(compact_of(octree));
  make_lists(&merged);
  REQUIRE(merged.tree.merged());
  CHECK(merged.lists.has_blocks());
}

TEST_CASE("wide: thick surfaces, voxels of about a pixel to many -> every pixel is the core's") {
  const BestInstructionSet after;
#ifdef __SANITIZE_ADDRESS__
  constexpr int kFrames = 4;
#else
  constexpr int kFrames = 48;
#endif
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 300 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    // Balls with holes, so that blocks of several sizes and single voxels lie before one another.
    Scene scene;
    scene.level = static_cast<int>(pick(random, 5, 8));
    const std::int32_t side = std::int32_t{1} << scene.level;
    const HeapBytes pool(std::size_t{48} << 20);
    Octree octree;
    REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
    const std::int64_t holes = pick(random, 0, 60);
    for (int ball = 0; ball < 4; ++ball) {
      const Vec3i middle{static_cast<std::int32_t>(pick(random, 0, side - 1)),
                         static_cast<std::int32_t>(pick(random, 0, side - 1)),
                         static_cast<std::int32_t>(pick(random, 0, side - 1))};
      const auto radius = static_cast<std::int32_t>(pick(random, 2, std::min(40, side / 3)));
      for (std::int32_t z = std::max(0, middle.z - radius); z < std::min(side, middle.z + radius); ++z) {
        for (std::int32_t y = std::max(0, middle.y - radius); y < std::min(side, middle.y + radius); ++y) {
          for (std::int32_t x = std::max(0, middle.x - radius); x < std::min(side, middle.x + radius); ++x) {
            const std::int32_t dx = x - middle.x;
            const std::int32_t dy = y - middle.y;
            const std::int32_t dz = z - middle.z;
            if (dx * dx + dy * dy + dz * dz < radius * radius && pick(random, 0, 99) >= holes) {
              REQUIRE(octree.insert({x, y, z}, static_cast<std::uint8_t>(ball)) == Status::kOk);
            }
          }
        }
      }
    }
    scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
    make_lists(&scene);
    Frame frame;
    const double world = 256.0 * side;
    PerspectiveView view;
    view.eye = {Q8::from_raw(static_cast<std::int32_t>(0.2 * world)),
                Q8::from_raw(static_cast<std::int32_t>(-0.62 * world)),
                Q8::from_raw(static_cast<std::int32_t>(0.75 * world))};
    view.forward = {static_cast<std::int32_t>(pick(random, 200, 400)), 1120, -300};
    view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(pick(random, 10, 70)) * 65536);
    view.width_px = 500;
    view.height_px = 360;
    REQUIRE(frame.camera.set(view, scene.level) == Status::kOk);
    frame.shading.mode = i % 2 == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
    const DepthRange range = depth_range(frame.camera, scene.tree.bounds());
    frame.shading.near_q8 = range.near_q8;
    frame.shading.far_q8 = range.far_q8;
    frame.band.rows = 360;
    std::uint64_t hits = 0;
    const auto expected = draw_core(scene, frame, &hits);
    for (const int threads : {1, 2}) {
      wide::use_instruction_set(static_cast<int>(pick(random, 0, wide::instruction_set_count() - 1)));
      CAPTURE(wide::instruction_set());
      CAPTURE(threads);
      wide::Options options;
      options.threads = threads_of(threads);
      options.order = wide::Order::kBlocks;
      const auto ours = draw_wide(scene, frame, options);
      REQUIRE(ours.has_value());
      CHECK(*ours == expected);
    }
  }
}

TEST_CASE("wide: clouds of voxels of a part of a pixel to some -> every pixel is the core's") {
  const BestInstructionSet after;
#ifdef __SANITIZE_ADDRESS__
  constexpr int kClouds = 2;
  constexpr int kViews = 3;
#else
  constexpr int kClouds = 8;
  constexpr int kViews = 12;
#endif
  std::uint64_t boxes = 0;
  std::uint64_t candidates = 0;
  for (int i = 0; i < kClouds; ++i) {
    const std::uint64_t seed = 9100 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    // Single voxels: so many that they hide one another, here more of them, there fewer.
    Scene scene;
    scene.level = static_cast<int>(pick(random, 6, 8));
    const std::int32_t side = std::int32_t{1} << scene.level;
    const HeapBytes pool(std::size_t{64} << 20);
    Octree octree;
    REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
    const std::int64_t per_thousand = pick(random, 5, 60);
    const std::int64_t points = std::int64_t{side} * side * side * per_thousand / 1000;
    for (std::int64_t n = 0; n < points; ++n) {
      const std::int32_t most = n % 3 == 0 ? side / 2 : side;
      REQUIRE(octree.insert({static_cast<std::int32_t>(pick(random, 0, most - 1)),
                             static_cast<std::int32_t>(pick(random, 0, side - 1)),
                             static_cast<std::int32_t>(pick(random, 0, most - 1))},
                            1) == Status::kOk);
    }
    scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
    make_lists(&scene);
    REQUIRE_FALSE(scene.lists.has_blocks());
    for (int v = 0; v < kViews; ++v) {
      CAPTURE(v);
      Frame frame;
      const auto width = static_cast<std::int32_t>(pick(random, 60, 260));
      const auto height = static_cast<std::int32_t>(pick(random, 40, 180));
      const Vec3Q8 middle{Q8::from_raw(128 * side), Q8::from_raw(128 * side), Q8::from_raw(128 * side)};
      // Voxels of `px` pixels at the middle of the world.
      const double px = 0.2 * std::pow(15.0, static_cast<double>(pick(random, 0, 1000)) / 1000);
      Vec3i away{static_cast<std::int32_t>(pick(random, -100, 100)),
                 static_cast<std::int32_t>(pick(random, -100, 100)),
                 static_cast<std::int32_t>(pick(random, -100, 100))};
      if (v % 4 == 3) {  // along an axis
        away = {0, 0, 0};
        away[static_cast<int>(pick(random, 0, 2))] = pick(random, 0, 1) == 0 ? 100 : -100;
      }
      if (away == Vec3i{0, 0, 0}) {
        away.x = 1;
      }
      const double length = std::sqrt(1.0 * away.x * away.x + 1.0 * away.y * away.y + 1.0 * away.z * away.z);
      bool is_set = false;
      if (v % 2 == 0) {
        const double fov = static_cast<double>(pick(random, 20, 100));
        const double focal_px = height / 2.0 / std::tan(fov / 360 * 3.14159265358979);
        const double far = std::min(focal_px / px, 4.0 * side);  // in voxels; inside the cloud, now and then
        PerspectiveView view;
        for (int axis = 0; axis < 3; ++axis) {
          view.eye[axis] =
              Q8::from_raw(middle[axis].raw + static_cast<std::int32_t>(256 * far * away[axis] / length));
        }
        view.forward = look_at(view.eye, middle);
        view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(fov * 65536));
        view.width_px = width;
        view.height_px = height;
        is_set = frame.camera.set(view, scene.level) == Status::kOk;
      } else {
        OrthographicView view;
        for (int axis = 0; axis < 3; ++axis) {
          view.eye[axis] =
              Q8::from_raw(middle[axis].raw + static_cast<std::int32_t>(256.0 * side * away[axis] / length));
        }
        view.forward = look_at(view.eye, middle);
        view.span = Q14::from_raw(static_cast<std::int32_t>(width / px * Q14::kOne));
        view.width_px = width;
        view.height_px = height;
        is_set = frame.camera.set(view, scene.level) == Status::kOk;
      }
      if (!is_set) {
        continue;
      }
      frame.shading.mode = v % 3 == 0 ? ShadeMode::kNormal : ShadeMode::kDepth;
      const DepthRange range = depth_range(frame.camera, scene.tree.bounds());
      frame.shading.near_q8 = range.near_q8;
      frame.shading.far_q8 = range.far_q8;
      frame.band.rows = height;
      std::uint64_t expected_hits = 0;
      const auto expected = draw_core(scene, frame, &expected_hits);
      for (int set = 0; set < wide::instruction_set_count(); ++set) {
        wide::use_instruction_set(set);
        CAPTURE(wide::instruction_set());
        wide::Options options;
        options.threads = threads_of(v % 3 == 1 ? 2 : 1);
        options.order = wide::Order::kBlocks;
        std::uint64_t hits = 0;
        wide::Stats stats;
        const auto ours = draw_wide(scene, frame, options, &hits, &stats);
        REQUIRE(ours.has_value());
        CHECK(hits == expected_hits);
        CHECK(*ours == expected);
        boxes += stats.counts.boxes;
        candidates += stats.counts.candidates;
      }
    }
  }
  CHECK(candidates < 2 * boxes);
}

TEST_CASE("wide: whole frames of the generators' scenes -> every pixel is the core's") {
#ifdef __SANITIZE_ADDRESS__
  constexpr int kFrames = 2;
  const std::vector<std::string> names{"spheres,depth=7"};
#else
  // Frames enough to see what goes wrong in one pixel of a hundred thousand.
  constexpr int kFrames = 5;
  const std::vector<std::string> names{"spheres,depth=9", "points:3000000", "water"};
#endif
  for (const std::string& name : names) {
    tools::SceneArguments arguments;
    arguments.scene = name;
    tools::BuiltScene built(*tools::open_scene(arguments), {});
    const auto renderer = tools::WideRenderer::make(&built, 800, 600, 1);
    REQUIRE(renderer != nullptr);
    const double side = 1 << built.level();
    for (int i = name == names.front() ? 0 : kFrames - 2; i < kFrames; ++i) {
      CAPTURE(name);
      CAPTURE(i);
      const double drift = 0.003 * side * (i + 1);
      tools::ViewWishes view;
      view.orthographic = i == 4;
      view.target = tools::Real3{side / 2 + drift / 3, side / 2, side / 2 + drift / 5};
      view.eye = i == 3 ? tools::Real3{side / 2, side * 0.3, side / 2}
                        : tools::Real3{side * 0.2 + drift, -side * 0.62, side * 0.75 - drift / 2};
      const Camera camera = tools::frame_box(view, built.level(), built.bounds()).camera;
      Shading shading;
      shading.near_q8 = depth_range(camera, built.bounds()).near_q8;
      shading.far_q8 = depth_range(camera, built.bounds()).far_q8;
      std::vector<std::uint8_t> ours(800 * 600);
      std::vector<std::uint8_t> expected(800 * 600);
      Band band;
      band.format = PixelFormat::kGray8;
      band.rows = 600;
      band.pixels = Bytes(ours.data(), ours.size());
      wide::Counts work;
      RenderCounts counts;
      REQUIRE(renderer->render(camera, shading, band, &counts, &work) == Status::kOk);
      CHECK(work.exact < work.candidates / 50);  // floats decide nearly all
      band.pixels = Bytes(expected.data(), expected.size());
      RenderCounts expected_counts;
      REQUIRE(built.render_band(camera, shading, band, &expected_counts, {}) == Status::kOk);
      CHECK(counts.hits == expected_counts.hits);
      std::size_t different = 0;
      for (std::size_t at = 0; at < ours.size(); ++at) {
        different += ours[at] != expected[at] ? 1U : 0U;
      }
      CHECK(different == 0);
    }
  }
}

TEST_CASE("wide: the order is chosen by what boxes hide -> few more tests than pixels, whatever the scene") {
#ifdef __SANITIZE_ADDRESS__
  const std::vector<std::string> names{"points:100000", "spheres", "water,depth=7"};
#else
  const std::vector<std::string> names{"points:100000", "points:2000000", "spheres", "spheres,depth=8",
                                       "water,depth=9"};
#endif
  for (const std::string& name : names) {
    tools::SceneArguments arguments;
    arguments.scene = name;
    const auto source = tools::open_scene(arguments);
    const tools::BuiltScene built(*source, {});
    HeapBytes list_bytes(wide::VoxelLists::bytes(built.compact()));
    Arena arena(list_bytes.span());
    wide::VoxelLists lists;
    REQUIRE(wide::VoxelLists::make(built.compact(), &arena, &lists) == Status::kOk);
    std::vector<std::uint8_t> workspace(wide::workspace_bytes(400, 300));
    std::vector<std::uint8_t> pixels(std::size_t{400} * 300);
    for (const bool orthographic : {false, true}) {
      CAPTURE(name);
      CAPTURE(orthographic);
      tools::ViewWishes view;
      view.orthographic = orthographic;
      view.width_px = 400;
      view.height_px = 300;
      const Camera camera = tools::frame_box(view, built.level(), built.bounds()).camera;
      Band band;
      band.format = PixelFormat::kGray8;
      band.rows = 300;
      band.pixels = Bytes(pixels.data(), pixels.size());
      const auto draw = [&](wide::Order order) {
        wide::Options options;
        options.order = order;
        wide::Stats stats;
        REQUIRE(wide::render(lists, camera, {}, band, Bytes(workspace.data(), workspace.size()), nullptr,
                             options, &stats) == Status::kOk);
        return stats;
      };
      const wide::Stats chosen = draw(wide::Order::kAuto);
      const wide::Stats flat = draw(wide::Order::kFlat);
      const wide::Stats blocks = draw(wide::Order::kBlocks);
      // A box costs about as much as two tests, a block as much as twenty boxes.
      const auto cost = [](const wide::Stats& stats) {
        return 2 * stats.counts.candidates + stats.counts.boxes + 20 * stats.counts.nodes;
      };
      CAPTURE(cost(flat));
      CAPTURE(cost(blocks));
      CHECK(cost(chosen) * 10 <= std::min(cost(flat), cost(blocks)) * 16);
      CHECK(chosen.counts.candidates < 4 * pixels.size());
    }
  }
}

TEST_CASE("wide: every instruction set, order and number of threads -> the same bytes") {
  const BestInstructionSet after;
  const int sets = wide::instruction_set_count();
  std::vector<std::string> names;
  for (int set = 0; set < sets; ++set) {
    wide::use_instruction_set(set);
    names.emplace_back(wide::instruction_set());
  }
  std::sort(names.begin(), names.end());
  CHECK(std::unique(names.begin(), names.end()) == names.end());
  for (int i = 0; i < kScenesEachSet; ++i) {
    const std::uint64_t seed = 90000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const Scene scene = random_scene(random);
    Frame frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    CAPTURE(seed);
    wide::use_instruction_set(-1);
    const auto first = draw_wide(scene, frame, {});
    for (int set = 0; set < sets; ++set) {
      wide::use_instruction_set(set);
      CAPTURE(wide::instruction_set());
      for (const int threads : {1, 2, 5}) {
        for (const wide::Order order : {wide::Order::kFlat, wide::Order::kBlocks}) {
          wide::Options options;
          options.threads = threads_of(threads);
          options.order = order;
          CHECK(draw_wide(scene, frame, options) == first);
        }
      }
    }
  }
}

TEST_CASE("wide: an arena or a workspace that is too small -> kOutOfMemory, nothing taken, nothing drawn") {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20; ++i) {
    const Scene scene = random_scene(random);
    const std::size_t bytes = wide::VoxelLists::bytes(scene.tree);
    const HeapBytes memory(bytes);
    Arena enough(memory.span());
    wide::VoxelLists lists;
    REQUIRE(wide::VoxelLists::make(scene.tree, &enough, &lists) == Status::kOk);
    const std::size_t used = enough.used_bytes();
    CHECK(used <= bytes);
    for (const std::size_t size : {std::size_t{0}, used / 3, used - 1}) {
      if (used == 0 || size >= used) {
        continue;
      }
      Arena arena(memory.span().subspan(0, size));
      CHECK(wide::VoxelLists::make(scene.tree, &arena, &lists) == Status::kOutOfMemory);
      CHECK(arena.used_bytes() == 0);
    }
    Frame frame;
    if (!random_frame(random, scene, &frame) || frame.band.rows == 0) {
      continue;
    }
    for (const int threads : {1, 3}) {
      std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
      const std::size_t wanted = wide::workspace_bytes(frame.camera.width_px(), frame.band.rows, threads);
      for (const std::size_t size : {std::size_t{0}, wanted / 2, wanted - 1}) {
        const HeapBytes workspace(size);
        Band band = frame.band;
        band.pixels = Bytes(pixels.data(), pixels.size());
        wide::Options options;
        options.threads = threads_of(threads);
        CHECK(wide::render(scene.lists, frame.camera, frame.shading, band, workspace.span(), nullptr,
                           options) == Status::kOutOfMemory);
        CHECK(std::all_of(pixels.begin(), pixels.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
      }
    }
  }
}

TEST_CASE("wide: numbers of threads that cannot be -> the nearest that can") {
  CHECK(wide::Threads(-1).count() == 1);
  CHECK(wide::Threads(wide::kMaxThreads + 1).count() == wide::kMaxThreads);
}

TEST_CASE("wide: bands that cannot be -> refused as render_band refuses them") {
  std::mt19937_64 random(6);
  Scene scene = random_scene(random);
  PerspectiveView view;
  view.eye = {Q8::from_raw(-5000), Q8::from_raw(77), Q8::from_raw(99)};
  view.forward = {3, 1, 1};
  view.width_px = 20;
  view.height_px = 10;
  Camera camera;
  REQUIRE(camera.set(view, scene.level) == Status::kOk);
  Camera other_level;
  REQUIRE(other_level.set(view, scene.level == 12 ? 11 : scene.level + 1) == Status::kOk);
  std::vector<std::uint8_t> pixels(600);
  std::vector<std::uint8_t> workspace(wide::workspace_bytes(20, 10));
  const auto draw = [&](const Camera& of, const Band& band) {
    return wide::render(scene.lists, of, {}, band, Bytes(workspace.data(), workspace.size()), nullptr);
  };
  Band band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  band.rows = 10;
  CHECK(draw(camera, band) == Status::kOk);
  CHECK(draw(Camera(), band) == Status::kBadArgument);
  CHECK(draw(other_level, band) == Status::kBadArgument);
  Band wrong = band;
  wrong.first_row = 1;
  CHECK(draw(camera, wrong) == Status::kBadArgument);
  wrong = band;
  wrong.stride_bytes = 59;
  CHECK(draw(camera, wrong) == Status::kBadArgument);
  wrong = band;
  wrong.pixels = Bytes(pixels.data(), 599);
  CHECK(draw(camera, wrong) == Status::kOutOfMemory);
  wrong = band;
  wrong.rows = 0;
  CHECK(draw(camera, wrong) == Status::kOk);
}

TEST_CASE("wide: damaged trees -> refused, or some picture within the bytes") {
  int refused = 0;
  int drawn = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    Scene scene = random_scene(random);
    if (scene.tree.empty()) {
      continue;
    }
    CAPTURE(seed);
    Bytes bytes = scene.bytes->span();
    for (std::int64_t i = pick(random, 1, 3); i > 0; --i) {
      bytes.data[pick(random, static_cast<std::int64_t>(kCompactHeaderBytes),
                      static_cast<std::int64_t>(bytes.size) - 1)] =
          static_cast<std::uint8_t>(pick(random, 0, 255));
    }
    CompactTree damaged;
    if (CompactTree::open(scene.bytes->view(), &damaged) != Status::kOk) {
      continue;
    }
    const HeapBytes memory(std::size_t{1} << 20);
    Arena arena(memory.span());
    wide::VoxelLists lists;
    const Status status = wide::VoxelLists::make(damaged, &arena, &lists);
    if (status != Status::kOk) {
      CHECK((status == Status::kDamaged || status == Status::kOutOfMemory));
      CHECK(arena.used_bytes() == 0);
      refused += status == Status::kDamaged ? 1 : 0;
      continue;
    }
    scene.lists = lists;
    Frame frame;
    if (random_frame(random, scene, &frame)) {
      (void)draw_wide(scene, frame, random_options(random));
      ++drawn;
    }
  }
  CHECK(refused > 10);
  CHECK(drawn > 10);
}

// A view of a cloud in a corner of a world of level 9: from before it, from above, from within, or parallel.
void look_at_corner(int view_number, std::int32_t width, std::int32_t height, Frame* frame) {
  if (view_number < 3) {
    PerspectiveView view;
    const Vec3i eyes[] = {{700, -300, 260}, {80, 90, 480}, {80, 80, 80}};
    for (int axis = 0; axis < 3; ++axis) {
      view.eye[axis] = Q8::from_raw(256 * eyes[view_number][axis] + 77);
    }
    view.forward = view_number == 1 ? Vec3i{3, 1, -30} : Vec3i{-7, 10, 0};
    view.fov_degrees = Q16::from_raw(70 << 16);
    view.width_px = width;
    view.height_px = height;
    REQUIRE(frame->camera.set(view, 9) == Status::kOk);
  } else {
    OrthographicView view;
    view.eye = {Q8::from_raw(900 << 8), Q8::from_raw(-(400 << 8)), Q8::from_raw(300 << 8)};
    view.forward = {-7, 10, -1};
    view.span = Q14::from_raw(600 << 14);
    view.width_px = width;
    view.height_px = height;
    REQUIRE(frame->camera.set(view, 9) == Status::kOk);
  }
  frame->shading.mode = view_number == 1 ? ShadeMode::kNormal : ShadeMode::kDepth;
  frame->band.first_row = view_number == 2 ? 5 : 0;
  frame->band.rows = height - 3 * frame->band.first_row;
}

TEST_CASE("wide: work in some rows, several threads -> parts change hands, every pixel is the core's") {
#ifdef __SANITIZE_ADDRESS__
  constexpr int kRepeats = 3;
  constexpr std::int64_t kPoints = 100000;
#else
  constexpr int kRepeats = 10;
  constexpr std::int64_t kPoints = 900000;
#endif
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t first_clock = std::clock();
  std::uint64_t splits = 0;
  for (const bool has_blocks : {false, true}) {
    CAPTURE(has_blocks);
    std::mt19937_64 random(has_blocks ? 31 : 30);
    Scene scene;
    scene.level = 9;
    const HeapBytes pool(std::size_t{64} << 20);
    Octree octree;
    REQUIRE(Octree::make(scene.level, pool.span(), &octree) == Status::kOk);
    for (std::int64_t n = 0; n < kPoints; ++n) {
      const std::int64_t most = n % 100 == 0 ? 511 : 300;
      const Vec3i at{static_cast<std::int32_t>(pick(random, 0, most)),
                     static_cast<std::int32_t>(pick(random, 0, most)),
                     static_cast<std::int32_t>(pick(random, 0, most))};
      if (has_blocks && n % 50 == 0) {
        REQUIRE(octree.insert_block({at.x & ~3, at.y & ~3, at.z & ~3}, 2, 1) == Status::kOk);
      } else if (has_blocks || (at.x & at.y & at.z & 1) == 0) {
        REQUIRE(octree.insert(at, 1) == Status::kOk);
      }
    }
    scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
    make_lists(&scene);
    REQUIRE(scene.lists.has_blocks() == has_blocks);
    for (int v = 0; v < 4; ++v) {
      CAPTURE(v);
      // Large pictures take long enough for other threads to come, whatever else the machine does.
      for (const int scale : {1, 5}) {
        CAPTURE(scale);
        Frame frame;
        look_at_corner(v, scale * 200, scale * 280, &frame);
        const DepthRange range = depth_range(frame.camera, scene.tree.bounds());
        frame.shading.near_q8 = range.near_q8;
        frame.shading.far_q8 = range.far_q8;
        wide::Options options;
        options.order = wide::Order::kBlocks;
        std::uint64_t expected_hits = 0;
        std::optional<std::vector<std::uint8_t>> expected;
        if (scale == 1) {
          expected = draw_core(scene, frame, &expected_hits);
        } else {
          expected = draw_wide(scene, frame, options, &expected_hits);
        }
        CHECK(expected_hits > 3000);
        for (const int threads : {2, 3, 8}) {
          CAPTURE(threads);
          options.threads = threads_of(threads);
          int wrong = 0;
          // The first large ones again and again, until there was a processor for the other thread.
          const auto is_early = [&] {
            return std::chrono::steady_clock::now() - start < std::chrono::seconds(10);
          };
          for (int i = 0; i < (scale == 1 ? kRepeats : 2) || (scale != 1 && splits == 0 && is_early()); ++i) {
            std::uint64_t hits = 0;
            wide::Stats stats;
            const auto ours = draw_wide(scene, frame, options, &hits, &stats);
            wrong += ours == expected && hits == expected_hits ? 0 : 1;
            splits += stats.splits;
          }
          CHECK(wrong == 0);
        }
      }
    }
  }
  // Other programs may have left us one processor all the time.
  const std::chrono::duration<double> clock_time = std::chrono::steady_clock::now() - start;
  const double processor_time = static_cast<double>(std::clock() - first_clock) / CLOCKS_PER_SEC;
  const bool was_alone = processor_time < 1.1 * clock_time.count();
  CHECK((splits > 0 || was_alone));
  if (splits == 0) {
    MESSAGE("never two processors at a time: no rows changed hands");
  }
}

}  // namespace thimble::tests
