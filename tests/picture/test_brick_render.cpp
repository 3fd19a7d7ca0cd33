// Frames by bricks are the frames of render_band, byte for byte; and what damaged maps and small buffers do.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "support/compact_damage.h"
#include "support/counts.h"
#include "support/formats.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using testing::kFormats;
using namespace thimble::tests;

const int kScenes = thimble::tests::many_or_few(400, 40);
const int kDamages = thimble::tests::many_or_few(1500, 150);

constexpr ShadeMode kModes[] = {ShadeMode::kColor, ShadeMode::kNormal, ShadeMode::kMono, ShadeMode::kDepth};

bool one_in(std::mt19937_64& random, int n) {
  return pick_int(random, 1, n) == 1;
}

/// A random world with everything that a compact tree may hold: voxels, solid blocks, merged blocks, many
/// materials or one, a hollow middle for cameras to stand in.
HeapBytes random_tree(std::mt19937_64& random, int level, unsigned materials) {
  const int side = 1 << level;
  std::vector<std::uint8_t> pool_bytes(Octree::octree_bytes(300000));
  Octree pool;
  REQUIRE(Octree::make(level, {pool_bytes.data(), pool_bytes.size()}, &pool) == Status::kOk);
  const auto material = [&] {
    return static_cast<std::uint8_t>(pick_int(random, 0, static_cast<int>(materials) - 1));
  };
  const auto cell = [&] {
    return Vec3i{pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)};
  };
  const int kind = pick_int(random, 0, 7);
  if (kind == 1) {
    REQUIRE(pool.insert_block({0, 0, 0}, level, material()) == Status::kOk);
  } else if (kind >= 2) {
    const int blocks = kind == 2 ? 0 : pick_int(random, 0, 30);
    for (int i = 0; i < blocks; ++i) {
      const int block = pick_int(random, 0, level - 1);
      const Vec3i at = cell();
      const int mask = ~((1 << block) - 1);
      REQUIRE(pool.insert_block({at.x & mask, at.y & mask, at.z & mask}, block, material()) == Status::kOk);
    }
    const int voxels = kind == 3 ? 0 : pick_int(random, 1, one_in(random, 3) ? 4000 : 60);
    for (int i = 0; i < voxels; ++i) {
      REQUIRE(pool.insert(cell(), material()) == Status::kOk);
    }
    if (kind == 6) {  // hills
      const int top = pick_int(random, 1, side);
      for (int x = 0; x < std::min(side, 32); ++x) {
        for (int y = 0; y < std::min(side, 32); ++y) {
          const int height = pick_int(random, 0, top) / 2 + 1;
          for (int z = std::max(0, height - 6); z < height; ++z) {
            REQUIRE(pool.insert({x, y, z}, material()) == Status::kOk);
          }
        }
      }
    }
    if (kind == 7 && pool.nodes_used() > 40) {
      REQUIRE(pool.coarsen_to(pool.nodes_used() / 2) == Status::kOk);
    }
  }
  return compact_of(pool, pick_int(random, kMinRankShift, 7));
}

HeapBytes map_of(const CompactTree& tree) {
  const HeapBytes room(most_brick_map_bytes(tree.level()));
  std::size_t written = 0;
  REQUIRE(BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOk);
  HeapBytes map(written);
  std::copy_n(room.view().data, written, map.span().data);
  return map;
}
BrickMap open_map(const HeapBytes& bytes) {
  BrickMap map;
  REQUIRE(BrickMap::open(bytes.view(), &map) == Status::kOk);
  return map;
}

/// Cameras outside, inside, on planes and corners, along axes, far away; wide and tele; some parallel.
Camera random_camera(std::mt19937_64& random, int level) {
  const int side_q8 = 256 << level;
  for (;;) {
    const int place = pick_int(random, 0, 5);
    Vec3Q8 eye;
    for (int axis = 0; axis < 3; ++axis) {
      const int raw = place == 0   ? pick_int(random, -side_q8, 2 * side_q8)
                      : place == 1 ? pick_int(random, 0, side_q8)
                      : place == 2 ? pick_int(random, -1, (1 << level) + 1) * 256
                      : place == 3 ? pick_int(random, -4 * side_q8, 5 * side_q8)
                      : place == 4 ? pick_int(random, 0, 2) * side_q8 / 2
                                   : pick_int(random, -side_q8 / 4, side_q8 + side_q8 / 4);
      eye[axis] = Q8::from_raw(raw);
    }
    Vec3i forward;
    const int look = pick_int(random, 0, 3);
    for (int axis = 0; axis < 3; ++axis) {
      forward[axis] = look == 0   ? pick_int(random, -1, 1)
                      : look == 1 ? pick_int(random, -1000, 1000)
                                  : pick_int(random, 0, side_q8) - eye[axis].raw;
    }
    const int width = pick_int(random, 1, 70);
    const int height = pick_int(random, 1, 40);
    Camera camera;
    if (one_in(random, 12)) {
      const OrthographicView view{eye,   forward, {}, Q14::saturate(pick_int(random, 1, 2 << level)),
                                  width, height,  0};
      if (camera.set(view, level) == Status::kOk) {
        return camera;
      }
      continue;
    }
    const int bits = one_in(random, 3) ? pick_int(random, kMinDirectionBits, 14) : 0;
    const Vec3i up = one_in(random, 3)
                         ? Vec3i{pick_int(random, -9, 9), pick_int(random, -9, 9), pick_int(random, -9, 9)}
                         : Vec3i{};
    const PerspectiveView view{eye,   forward, up,  Q16::from_raw(pick_int(random, 65536, 120 * 65536)),
                               width, height,  bits};
    if (camera.set(view, level) == Status::kOk) {
      return camera;
    }
  }
}

Shading random_shading(std::mt19937_64& random, const Camera& camera, const CompactTree& tree,
                       Span<const Rgb8> palette) {
  Shading shading;
  shading.mode = kModes[pick_int(random, 0, 3)];
  shading.palette = palette;
  shading.background = {static_cast<std::uint8_t>(pick_int(random, 0, 255)), 90, 17};
  const DepthRange range = depth_range(camera, tree.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

struct Drawn {
  std::vector<std::uint8_t> bytes;
  RenderCounts counts;
};

template <class Draw>
Drawn in_bands(const Camera& camera, PixelFormat format, int rows, std::size_t gap, Draw draw) {
  const std::size_t stride = row_bytes(format, camera.width_px()) + gap;
  Drawn result;
  result.bytes.assign(stride * static_cast<std::size_t>(camera.height_px()), 0xA5);
  for (int y = 0; y < camera.height_px(); y += rows) {
    Band band;
    band.format = format;
    band.stride_bytes = stride;
    band.first_row = y;
    band.rows = std::min(rows, camera.height_px() - y);
    const std::size_t at = stride * static_cast<std::size_t>(y);
    // Not a byte more than the band needs, so that the sanitizer sees one written behind it.
    std::vector<std::uint8_t> pixels(stride * static_cast<std::size_t>(band.rows) - gap, 0xA5);
    band.pixels = {pixels.data(), pixels.size()};
    REQUIRE(draw(band, &result.counts) == Status::kOk);
    std::copy(pixels.begin(), pixels.end(), result.bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return result;
}

std::vector<Rgb8> random_palette(std::mt19937_64& random) {
  std::vector<Rgb8> palette(200);
  for (Rgb8& color : palette) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  return palette;
}

// So many scenes of six views each, by the map and without.
void check_frames(std::uint64_t first_seed, int scenes) {
  std::mt19937_64 random(first_seed);
  const auto palette = random_palette(random);
  std::uint64_t fast = 0;
  std::uint64_t hits = 0;
  for (int scene = 0; scene < scenes; ++scene) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 2, one_in(own, 4) ? 8 : 6);
    CAPTURE(level);
    const HeapBytes tree_bytes =
        random_tree(own, level, static_cast<unsigned>(one_in(own, 3) ? 1 : pick_int(own, 2, 250)));
    const CompactTree tree = open_or_throw(tree_bytes);
    const HeapBytes map_bytes = map_of(tree);
    REQUIRE(BrickMap::validate(map_bytes.view()) == nullptr);
    const BrickMap map = open_map(map_bytes);
    CHECK(map.belongs_to(tree));
    for (int view = 0; view < 6; ++view) {
      const Camera camera = random_camera(own, level);
      const Shading shading = random_shading(own, camera, tree, {palette.data(), palette.size()});
      const PixelFormat format = kFormats[pick_int(own, 0, 4)];
      CAPTURE(view);
      CAPTURE(static_cast<int>(format));
      CAPTURE(static_cast<int>(shading.mode));
      const Drawn wanted =
          in_bands(camera, format, camera.height_px(), 0, [&](const Band& band, RenderCounts* counts) {
            return render_band(tree, camera, shading, band, counts);
          });
      const Drawn drawn =
          in_bands(camera, format, camera.height_px(), 0, [&](const Band& band, RenderCounts* counts) {
            return render_band(tree, map, camera, shading, band, counts);
          });
      REQUIRE(drawn.bytes == wanted.bytes);
      REQUIRE(drawn.counts.hits == wanted.counts.hits);
      REQUIRE(drawn.counts.rays == wanted.counts.rays);
      fast += draws_fast(map, camera) ? 1U : 0U;
      hits += drawn.counts.hits;
      const std::size_t gap = static_cast<std::size_t>(pick_int(own, 0, 5));
      const int rows = pick_int(own, 1, 11);
      const Drawn banded = in_bands(camera, format, rows, gap, [&](const Band& band, RenderCounts* counts) {
        return render_band(tree, map, camera, shading, band, counts);
      });
      const std::size_t line = row_bytes(format, camera.width_px());
      for (int y = 0; y < camera.height_px(); ++y) {
        const std::size_t row = static_cast<std::size_t>(y);
        REQUIRE(std::memcmp(banded.bytes.data() + row * (line + gap), wanted.bytes.data() + row * line,
                            line) == 0);
      }
      REQUIRE(banded.counts.hits == wanted.counts.hits);
    }
  }
  CHECK(fast > static_cast<std::uint64_t>(scenes) * 3);
  CHECK(hits > static_cast<std::uint64_t>(scenes) * 100);
}

TEST_CASE("brick frames: any scene, camera, shading, format and band -> the bytes and hits of render_band") {
  check_frames(20260101, kScenes);
}

// The same, fast enough for whoever changes a line and wants to know.
TEST_CASE("brick frames: a few of those scenes") {
  check_frames(20260941, 24);
}

TEST_CASE(
    "brick frames: cameras that do not take 32 bits -> the general call draws, the narrow one refuses") {
  std::mt19937_64 random(7);
  const HeapBytes tree_bytes = random_tree(random, 6, 5);
  const CompactTree tree = open_or_throw(tree_bytes);
  const HeapBytes map_bytes = map_of(tree);
  const BrickMap map = open_map(map_bytes);
  Camera camera;
  const Vec3Q8 eye{Q8::from_raw(-9000), Q8::from_raw(-8000), Q8::from_raw(14000)};
  const Vec3Q8 middle{Q8::from_raw(8192), Q8::from_raw(8192), Q8::from_raw(8192)};
  REQUIRE(camera.set(PerspectiveView{eye, look_at(eye, middle), {}, Q16::saturate(50), 60, 40, 18}, 6) ==
          Status::kOk);
  CHECK_FALSE(draws_fast(map, camera));
  const Shading shading;
  std::vector<std::uint8_t> pixels(60 * 40);
  std::vector<std::uint8_t> wanted(60 * 40);
  Band band;
  band.format = PixelFormat::kGray8;
  band.rows = 40;
  band.pixels = {pixels.data(), pixels.size()};
  CHECK(render_band_32(tree, map, camera, shading, band) == Status::kBadArgument);
  CHECK(render_band_32(tree, camera, shading, band) == Status::kBadArgument);
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOk);
  band.pixels = {wanted.data(), wanted.size()};
  REQUIRE(render_band(tree, camera, shading, band) == Status::kOk);
  CHECK(pixels == wanted);

  REQUIRE(camera.set(PerspectiveView{eye, look_at(eye, middle), {}, Q16::saturate(50), 60, 40, 0}, 6) ==
          Status::kOk);
  REQUIRE(draws_fast(map, camera));
  REQUIRE(render_band(tree, camera, shading, band) == Status::kOk);
  band.pixels = {pixels.data(), pixels.size()};
  RenderCounts counts;
  REQUIRE(render_band_32(tree, camera, shading, band, &counts) == Status::kOk);
  CHECK(pixels == wanted);
  CHECK(counts.rays == 60 * 40);
  pixels.assign(pixels.size(), 0);
  REQUIRE(render_band_32(tree, map, camera, shading, band, &counts) == Status::kOk);
  CHECK(pixels == wanted);
  CHECK(counts.rays == 2 * 60 * 40);
}

TEST_CASE("brick frames: arguments that contradict the picture -> a status, and not a byte is written") {
  std::mt19937_64 random(11);
  const HeapBytes tree_bytes = random_tree(random, 5, 3);
  const HeapBytes other_bytes = random_tree(random, 5, 3);
  const CompactTree tree = open_or_throw(tree_bytes);
  const HeapBytes map_bytes = map_of(tree);
  const BrickMap map = open_map(map_bytes);
  Camera camera;
  const Vec3Q8 eye{Q8::from_raw(-3000), Q8::from_raw(-2000), Q8::from_raw(9000)};
  REQUIRE(camera.set(PerspectiveView{eye, {3, 3, -2}, {}, Q16::saturate(60), 21, 16, 0}, 5) == Status::kOk);
  REQUIRE(draws_fast(map, camera));
  const Shading shading;
  std::vector<std::uint8_t> pixels(11 * 16, 0x5A);
  const std::vector<std::uint8_t> before = pixels;
  Band band;
  band.format = PixelFormat::kGray4;
  band.rows = 16;
  band.pixels = {pixels.data(), pixels.size() - 1};
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.pixels.size = pixels.size();
  band.stride_bytes = 10;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.stride_bytes = 12;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.stride_bytes = 0;
  band.first_row = 1;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.first_row = 0;
  CHECK(render_band(open_or_throw(other_bytes), map, camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, BrickMap(), camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, map, Camera(), shading, band) == Status::kBadArgument);
  CHECK(pixels == before);
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOk);
  CHECK(pixels != before);
}

TEST_CASE(
    "brick map: too few bytes, wrong levels, odd addresses -> a status, and the least that works is known") {
  std::mt19937_64 random(5);
  for (int scene = 0; scene < 12; ++scene) {
    const HeapBytes tree_bytes = random_tree(random, 5, 4);
    const CompactTree tree = open_or_throw(tree_bytes);
    const HeapBytes map_bytes = map_of(tree);
    const std::size_t size = map_bytes.view().size;
    BrickMap map = open_map(map_bytes);
    CHECK(size == map.size_bytes());
    CHECK(size == brick_map_bytes(static_cast<std::uint32_t>((map.box().high.x - map.box().low.x) *
                                                             (map.box().high.y - map.box().low.y) *
                                                             (map.box().high.z - map.box().low.z)),
                                  map.brick_count(), map.mixed_count()));
    std::size_t written = 0;
    // Exactly as many bytes on the heap: the sanitizer sees the first beyond.
    for (std::size_t less = 0; less <= size; less += 1 + less / 2) {
      const HeapBytes room(size - less);
      CHECK(BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOutOfMemory);
      BrickMap none;
      if (less != 0) {
        CHECK(BrickMap::open({map_bytes.view().data, size - less}, &none) == Status::kDamaged);
      }
    }
    bool built = false;
    for (std::size_t more = 0; !built && more < 100000; more += 64) {
      const HeapBytes room(size + more);
      built = BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOk;
      if (built) {
        CHECK(written == size);
        CHECK(std::equal(map_bytes.view().begin(), map_bytes.view().end(), room.view().data));
      }
    }
    CHECK(built);
    const HeapBytes shifted(size, 4);
    CHECK(BrickMap::open(shifted.view(), &map) == Status::kBadArgument);
    CHECK(BrickMap::make(tree, shifted.span(), nullptr, &written) == Status::kBadArgument);
  }
  const HeapBytes small = random_tree(random, 1, 2);
  const HeapBytes room(most_brick_map_bytes(2));
  std::size_t written = 0;
  CHECK(BrickMap::make(open_or_throw(small), room.span(), nullptr, &written) == Status::kOutOfRange);
  CHECK(BrickMap::make(CompactTree(), room.span(), nullptr, &written) == Status::kOutOfRange);
}

TEST_CASE(
    "brick map: damaged bytes of map and tree -> validate says so; drawing ends and stays in its bytes") {
  std::mt19937_64 random(20260202);
  const auto palette = random_palette(random);
  int opened = 0;
  for (int damage = 0; damage < kDamages; ++damage) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 2, 5);
    const HeapBytes tree_bytes = random_tree(own, level, 5);
    const HeapBytes map_bytes = map_of(open_or_throw(tree_bytes));
    const bool in_tree = one_in(own, 3);
    const Bytes target = in_tree ? tree_bytes.span() : map_bytes.span();
    const std::size_t first = in_tree ? 16 : 0;
    const int flips = pick_int(own, 1, 6);
    for (int i = 0; i < flips; ++i) {
      const std::size_t at = first + static_cast<std::size_t>(own() % (target.size - first));
      target[at] = static_cast<std::uint8_t>(target[at] ^ (1 + own() % 255));
    }
    BrickMap map;
    CompactTree tree;
    if (CompactTree::open(tree_bytes.view(), &tree) != Status::kOk ||
        BrickMap::open(map_bytes.view(), &map) != Status::kOk) {
      continue;
    }
    ++opened;
    if (!in_tree) {
      // Flips may cancel out, but hardly ever do.
      const char* fault = BrickMap::validate(map_bytes.view());
      CHECK((fault != nullptr || map.belongs_to(tree)));
    }
    std::size_t written = 0;
    const HeapBytes room(most_brick_map_bytes(level));
    static_cast<void>(BrickMap::make(tree, room.span(), nullptr, &written));
    const Camera camera = random_camera(own, level);
    const Shading shading = random_shading(own, camera, tree, {palette.data(), palette.size()});
    std::vector<std::uint8_t> pixels(row_bytes(PixelFormat::kGray4, camera.width_px()) *
                                     static_cast<std::size_t>(camera.height_px()));
    Band band;
    band.format = PixelFormat::kGray4;
    band.rows = camera.height_px();
    band.pixels = {pixels.data(), pixels.size()};
    const Status status = render_band(tree, map, camera, shading, band);
    CHECK((status == Status::kOk || status == Status::kDamaged || status == Status::kBadArgument));
  }
  CHECK(opened > kDamages / 4);
}

}  // namespace
