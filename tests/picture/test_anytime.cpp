// Any-time frames: exact in the end, sound bounds on the way, less error at each doubling of work.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "golden/scenes.h"
#include "scene/random.h"
#include "support/formats.h"
#include "support/scene_under_test.h"
#include "thimble/picture/anytime.h"

namespace {

using namespace thimble;
using testing::kFormats;
using tests::OwnedPool;
using thimble::tools::SplitMix64;

constexpr std::uint8_t kGuard = 0xA5;

#ifdef __SANITIZE_ADDRESS__
constexpr int kRandomFrames = 12;
constexpr std::uint32_t kStarts[] = {32};
#else
constexpr int kRandomFrames = 120;
constexpr std::uint32_t kStarts[] = {32, 37, 42, 47, 53, 59};
#endif

/// What a display shows of a pixel.
Rgb8 shown(const std::uint8_t* picture, int width, int x, int y, PixelFormat format) {
  return load_pixel(picture + row_bytes(format, width) * static_cast<std::size_t>(y), x, y, format);
}

struct Error {
  std::uint64_t wrong = 0;
  std::uint64_t squares = 0;  ///< of all channels
  std::uint64_t grays = 0;    ///< absolute differences
  int largest = 0;            ///< of them
};

/// One camera, shading and format, and what is exact for them.
template <class Structure>
struct Case {
  const Structure& structure;
  Camera camera;
  Shading shading;
  PixelFormat format;
  std::vector<std::uint8_t> wanted;

  Case(const Structure& drawn, const Camera& seen_from, const Shading& shaded, PixelFormat stored)
      : structure(drawn), camera(seen_from), shading(shaded), format(stored) {
    wanted.resize(band_bytes(format, camera.width_px(), camera.height_px()));
    Band band{.pixels = Bytes(wanted.data(), wanted.size()), .format = format, .rows = camera.height_px()};
    REQUIRE(render_band(structure, camera, shading, band) == Status::kOk);
  }
  std::size_t bytes() const { return anytime_bytes(camera.width_px(), camera.height_px(), format); }

  Error error(const std::uint8_t* picture) const {
    Error error;
    for (int y = 0; y < camera.height_px(); ++y) {
      for (int x = 0; x < camera.width_px(); ++x) {
        const Rgb8 is = shown(picture, camera.width_px(), x, y, format);
        const Rgb8 should = shown(wanted.data(), camera.width_px(), x, y, format);
        const auto square = [](int a, int b) { return static_cast<std::uint64_t>((a - b) * (a - b)); };
        const int gray = std::abs(int{gray_of(is)} - int{gray_of(should)});
        error.wrong += is == should ? 0U : 1U;
        error.squares += square(is.r, should.r) + square(is.g, should.g) + square(is.b, should.b);
        error.grays += static_cast<std::uint64_t>(gray);
        error.largest = std::max(error.largest, gray);
      }
    }
    return error;
  }
};

/// A frame in bytes of its own, which are guarded on both sides and lie at an odd address.
template <class Structure>
class Drawing {
 public:
  explicit Drawing(const Case<Structure>& drawn) : case_(drawn), memory_(drawn.bytes() + 2, kGuard) {
    REQUIRE(AnytimeFrame::make(case_.structure, case_.camera, case_.shading, case_.format,
                               Bytes(memory_.data() + 1, case_.bytes()), &frame) == Status::kOk);
    check();
  }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  void refine(std::uint32_t visits, Width width = Width::kAuto) {
    const std::uint64_t given = frame.given_visits();
    const std::uint32_t inexact = frame.inexact();
    const std::uint32_t bound = frame.mean_error_bound_q8();
    const int range = frame.gray_range();
    REQUIRE(frame.refine(case_.structure, visits, width) == Status::kOk);
    REQUIRE(frame.given_visits() == given + visits);
    REQUIRE(frame.inexact() <= inexact);
    REQUIRE(frame.mean_error_bound_q8() <= bound);
    REQUIRE(frame.gray_range() == range);
    check();
  }
  /// Everything that is promised of a frame at any time.
  void check() {
    REQUIRE(memory_.front() == kGuard);
    REQUIRE(memory_.back() == kGuard);
    REQUIRE(frame.spent_visits() <= frame.given_visits());
    REQUIRE(frame.counts().node_visits <= frame.spent_visits());
    REQUIRE((frame.done() || frame.given_visits() - frame.spent_visits() < frame.reserve_visits()));
    REQUIRE(frame.counts().step_limited == 0);
    REQUIRE(frame.done() == (frame.inexact() == 0));
    const Error error = case_.error(picture());
    REQUIRE(error.wrong <= frame.inexact());
    REQUIRE(error.largest <= frame.gray_range());
    REQUIRE(256 * error.grays <= std::uint64_t{frame.mean_error_bound_q8()} * frame.pixels());
  }
  /// Pixels that are called exact are, and the others are counted.
  void check_pixels() {
    std::uint32_t inexact = 0;
    int wrong = 0;
    const int width = case_.camera.width_px();
    for (int y = 0; y < case_.camera.height_px(); ++y) {
      for (int x = 0; x < width; ++x) {
        inexact += frame.exact(x, y) ? 0U : 1U;
        const bool equal = shown(picture(), width, x, y, case_.format) ==
                           shown(case_.wanted.data(), width, x, y, case_.format);
        wrong += frame.exact(x, y) && !equal ? 1 : 0;
      }
    }
    REQUIRE(wrong == 0);
    REQUIRE(inexact == frame.inexact());
  }
  bool equals_wanted() const { return std::equal(case_.wanted.begin(), case_.wanted.end(), picture()); }
  const std::uint8_t* picture() const { return memory_.data() + 1; }
  std::vector<std::uint8_t> bytes() const { return memory_; }

  AnytimeFrame frame;

 private:
  const Case<Structure>& case_;
  std::vector<std::uint8_t> memory_;
};

/// Calls `use(name, case)` for every golden frame in one of the structures.
template <class Use>
void for_golden(golden::Structure structure, const Use& use) {
  std::vector<std::uint8_t> bytes(std::size_t{1} << 18);
  for (int i = 0; i < golden::frame_count(); ++i) {
    const golden::Frame& frame = golden::frame(i);
    if (!golden::applies(frame, {structure, Width::kAuto, 0})) {
      continue;
    }
    CAPTURE(frame.name);
    Arena arena{Bytes(bytes.data(), bytes.size())};
    golden::World world;
    Camera camera;
    Shading shading;
    REQUIRE(golden::build_scene(frame.scene, structure, &arena, &world) == Status::kOk);
    REQUIRE(golden::set_up(frame, &camera, &shading) == Status::kOk);
    if (structure == golden::Structure::kDense) {
      use(frame, Case<DenseGrid>(world.grid, camera, shading, frame.format));
    } else if (structure == golden::Structure::kPool) {
      use(frame, Case<Octree>(world.pool, camera, shading, frame.format));
    } else {
      use(frame, Case<CompactTree>(world.compact, camera, shading, frame.format));
    }
  }
}

/// A level-5 pool of random voxels and blocks, with a palette that some materials are beyond.
class RandomScene {
 public:
  explicit RandomScene(SplitMix64& random) : bytes_(Octree::octree_bytes(8000)) {
    REQUIRE(Octree::make(5, Bytes(bytes_.data(), bytes_.size()), &pool) == Status::kOk);
    const int voxels = static_cast<int>(random.below(300));
    for (int i = 0; i < voxels; ++i) {
      const Vec3i at{random.between(0, 31), random.between(0, 31), random.between(0, 31)};
      REQUIRE(pool.insert(at, static_cast<std::uint8_t>(random.below(5))) == Status::kOk);
    }
    if (random.below(2) == 0) {
      const int z = random.between(1, 12);
      REQUIRE(pool.insert_box({{3, 2, 0}, {29, 31, z}}, 1) == Status::kOk);
    }
  }

  Octree pool;

 private:
  std::vector<std::uint8_t> bytes_;
};

constexpr Rgb8 kPalette[] = {{250, 120, 30}, {20, 200, 90}, {70, 80, 240}};

Camera random_camera(SplitMix64& random, int width, int height) {
  const auto place = [&random] {
    return Vec3Q8{Q8::from_raw(random.between(-9000, 17000)), Q8::from_raw(random.between(-9000, 17000)),
                  Q8::from_raw(random.between(-9000, 17000))};
  };
  Camera camera;
  for (;;) {
    const Vec3Q8 eye = place();
    const Vec3Q8 middle{Q8::from_raw(4000), Q8::from_raw(4100), Q8::from_raw(random.between(0, 8000))};
    const bool perspective = random.below(3) != 0;
    const Status status =
        perspective
            ? camera.set(PerspectiveView{eye,
                                         look_at(eye, middle),
                                         {},
                                         Q16::saturate(random.between(20, 100)),
                                         width,
                                         height,
                                         0},
                         5)
            : camera.set(
                  OrthographicView{
                      eye, look_at(eye, middle), {}, Q14::saturate(random.between(8, 60)), width, height, 0},
                  5);
    if (status == Status::kOk) {
      return camera;
    }
  }
}

Shading random_shading(SplitMix64& random) {
  Shading shading{.mode = static_cast<ShadeMode>(random.below(4)),
                  .palette = Span<const Rgb8>(kPalette),
                  .background = {static_cast<std::uint8_t>(random.below(256)),
                                 static_cast<std::uint8_t>(random.below(256)),
                                 static_cast<std::uint8_t>(random.below(256))},
                  .near_q8 = random.between(-1000, 3000),
                  .far_q8 = random.between(2000, 20000)};
  return shading;
}

}  // namespace

TEST_CASE("anytime: every golden frame in every structure, in one call and in two widths -> as render_band") {
  for (const auto structure :
       {golden::Structure::kCompact, golden::Structure::kPool, golden::Structure::kDense}) {
    for_golden(structure, [](const golden::Frame& frame, const auto& drawn) {
      for (const Width width : {Width::kAuto, Width::k32, Width::k64}) {
        if (width == Width::k32 && !frame.narrow) {
          continue;
        }
        Drawing drawing(drawn);
        drawing.refine(UINT32_MAX, width);
        REQUIRE(drawing.frame.done());
        REQUIRE(drawing.equals_wanted());
        REQUIRE(drawing.frame.mean_error_bound_q8() == 0);
      }
    });
  }
}

TEST_CASE(
    "anytime: every golden frame, work doubled -> the measured error falls, never grows, and ends at 0") {
  int steps = 0;
  int falls = 0;  // strict ones that are required
  for_golden(golden::Structure::kCompact, [&](const golden::Frame&, const auto& drawn) {
    Drawing whole(drawn);
    whole.refine(UINT32_MAX);
    const std::uint64_t needed = whole.frame.spent_visits() + whole.frame.reserve_visits();
    // From 1 on, and between the powers of two as well.
    for (const std::uint32_t start : kStarts) {
      Error before;
      for (std::uint64_t work = start;; work *= 2) {
        Drawing drawing(drawn);
        if (work == start) {
          before = drawn.error(drawing.picture());
        }
        drawing.refine(static_cast<std::uint32_t>(work));
        const Error error = drawn.error(drawing.picture());
        CAPTURE(work);
        REQUIRE(error.wrong <= before.wrong);
        REQUIRE(error.squares <= before.squares);
        // Twice what no ray may be begun without has been given, and more than a pixel in 64 is wrong; or an
        // eighth of the work is done, and some pixels are: then every doubling finds something.
        const std::uint64_t given_before = work == start ? 0 : work / 2;
        const std::uint64_t pixels = static_cast<std::uint64_t>(drawn.camera.width_px()) *
                                     static_cast<std::uint64_t>(drawn.camera.height_px());
        const bool early = given_before >= 2 * whole.frame.reserve_visits() && 64 * before.wrong > pixels;
        const bool late = 8 * given_before >= needed && before.wrong > 8;
        if (early || late) {
          REQUIRE(error.wrong < before.wrong);
          REQUIRE(error.squares < before.squares);
          ++falls;
        }
        steps += given_before != 0 && before.wrong != 0 ? 1 : 0;
        before = error;
        if (work >= needed) {
          REQUIRE(drawing.frame.done());
          REQUIRE(error.wrong == 0);
          break;
        }
      }
    }
  });
  CAPTURE(steps);
  CHECK(falls > steps / 3);
}

TEST_CASE("anytime: random scenes, cameras, shadings, formats, sizes and slices -> all that is promised") {
  for (int i = 0; i < kRandomFrames; ++i) {
    const std::uint64_t seed = 0xA117 + static_cast<std::uint64_t>(i);
    CAPTURE(seed);
    SplitMix64 random(seed);
    const RandomScene scene(random);
    constexpr int kSizes[][2] = {{1, 1}, {1, 40}, {50, 1}, {7, 9}, {8, 8}, {17, 33}, {40, 31}, {64, 16}};
    const auto& size = kSizes[random.below(std::size(kSizes))];
    const Camera camera = random_camera(random, size[0], size[1]);
    const Case<Octree> drawn(scene.pool, camera, random_shading(random), kFormats[random.below(5)]);
    Drawing drawing(drawn);
    drawing.check_pixels();
    const std::uint32_t slice = 64U << random.below(8);
    while (!drawing.frame.done()) {
      drawing.refine(static_cast<std::uint32_t>(random.below(2 * slice)));
      if (random.below(8) == 0) {
        drawing.check_pixels();
        // Another way to give the same sum.
        Drawing other(drawn);
        for (std::uint64_t left = drawing.frame.given_visits(); left != 0;) {
          const auto part = static_cast<std::uint32_t>(1 + random.below(std::min<std::uint64_t>(left, 5000)));
          other.refine(part);
          left -= part;
        }
        REQUIRE(other.bytes() == drawing.bytes());
        REQUIRE(other.frame.spent_visits() == drawing.frame.spent_visits());
      }
    }
    REQUIRE(drawing.equals_wanted());
  }
}

TEST_CASE("anytime: nothing solid, or nothing in view -> done at once") {
  OwnedPool owned(5, 100);
  Octree& pool = owned.octree;
  SplitMix64 random(7);
  const Camera camera = random_camera(random, 21, 10);
  CHECK(Drawing(Case<Octree>(pool, camera, {}, PixelFormat::kGray4)).frame.done());
  REQUIRE(pool.insert({1, 1, 1}, 0) == Status::kOk);
  const Vec3Q8 eye{Q8::from_raw(-300), Q8::from_raw(4000), Q8::from_raw(4000)};
  Camera away;
  REQUIRE(away.set(PerspectiveView{eye, {-1, 0, 0}, {}, Q16::saturate(60), 21, 10, 0}, 5) == Status::kOk);
  CHECK(Drawing(Case<Octree>(pool, away, {}, PixelFormat::kGray4)).frame.done());
}

TEST_CASE("anytime: what can be seen -> the range of greys") {
  OwnedPool owned(5, 100);
  Octree& pool = owned.octree;
  REQUIRE(pool.insert({16, 16, 16}, 0) == Status::kOk);
  Camera along;  // in direction +y only, a little up and down
  const OrthographicView view{{Q8::from_raw(4200), Q8::from_raw(-256), Q8::from_raw(4200)},
                              {0, 1, 0},
                              {},
                              Q14::saturate(20),
                              20,
                              20,
                              0};
  REQUIRE(along.set(view, 5) == Status::kOk);
  Shading shading;
  const auto range = [&](PixelFormat format) {
    return Drawing(Case<Octree>(pool, along, shading, format)).frame.gray_range();
  };
  shading.mode = ShadeMode::kMono;
  CHECK(range(PixelFormat::kGray8) == 255);
  CHECK(range(PixelFormat::kMono1) == 255);
  // Black background, and the face -y: (128, 0, 128).
  shading.mode = ShadeMode::kNormal;
  CHECK(range(PixelFormat::kGray8) == 53);
  CHECK(range(PixelFormat::kRgb888) == 53);
  CHECK(range(PixelFormat::kGray4) == 51);
  shading.mode = ShadeMode::kDepth;
  CHECK(range(PixelFormat::kGray8) == 255);
  shading.background = {100, 100, 100};
  CHECK(range(PixelFormat::kGray8) == 215);
  // One material on an equal background under full light looks like it.
  const Rgb8 palette[] = {{100, 100, 100}, {100, 100, 100}};
  shading.mode = ShadeMode::kColor;
  shading.palette = Span<const Rgb8>(palette);
  shading.default_color = palette[0];
  shading.face_light[2] = 256;
  CHECK(range(PixelFormat::kGray8) == 0);
  CHECK(range(PixelFormat::kMono1) == 0);
  shading.face_light[2] = 250;  // 97: another bit where the threshold is 98
  CHECK(range(PixelFormat::kGray8) == 3);
  CHECK(range(PixelFormat::kMono1) == 255);
  shading.face_light[2] = 255;  // 99: no threshold between
  CHECK(range(PixelFormat::kMono1) == 0);
  shading.default_color = {0, 0, 0};  // materials beyond the palette
  CHECK(range(PixelFormat::kGray8) == 100);
}

TEST_CASE("anytime: a face that only the rays of one corner can enter -> its grey counts") {
  OwnedPool owned(5, 100);
  Octree& pool = owned.octree;
  REQUIRE(pool.insert({16, 16, 16}, 0) == Status::kOk);
  Shading shading;
  shading.mode = ShadeMode::kColor;
  for (std::uint16_t& light : shading.face_light) {
    light = 0;
  }
  shading.default_color = {255, 255, 255};
  shading.face_light[0] = 256;  // only the face -x can be seen
  unsigned corners = 0;
  for (const Vec3i& up : {Vec3i{1, 0, 1}, Vec3i{1, 0, -1}, Vec3i{-1, 0, 1}, Vec3i{-1, 0, -1}}) {
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{{}, {-1, 2, 0}, up, Q16::saturate(60), 20, 20, 0}, 5) == Status::kOk);
    unsigned going_up = 0;
    for (unsigned corner = 0; corner < 4; ++corner) {
      const Ray ray = camera.ray((corner & 1U) != 0 ? 19 : 0, (corner & 2U) != 0 ? 19 : 0);
      going_up |= ray.direction.x > 0 ? 1U << corner : 0U;
    }
    CAPTURE(going_up);
    CHECK((going_up & (going_up - 1)) == 0);
    corners |= going_up;
    CHECK(Drawing(Case<Octree>(pool, camera, shading, PixelFormat::kGray8)).frame.gray_range() == 255);
  }
  CHECK(corners == 15);
}

TEST_CASE("anytime: what cannot be -> an error, and nothing changed") {
  SplitMix64 random(11);
  const RandomScene scene(random);
  const Camera camera = random_camera(random, 30, 20);
  const Case<Octree> drawn(scene.pool, camera, {}, PixelFormat::kGray8);
  AnytimeFrame nothing;
  CHECK(nothing.done());
  CHECK(nothing.pixels() == 0);
  CHECK(nothing.mean_error_bound_q8() == 0);
  CHECK(nothing.band(0, 10).rows == 0);
  CHECK(nothing.refine(scene.pool, 100) == Status::kBadArgument);
  std::vector<std::uint8_t> memory(drawn.bytes(), kGuard);
  const std::vector<std::uint8_t> before = memory;
  const Bytes bytes(memory.data(), memory.size());
  CHECK(AnytimeFrame::make(scene.pool, Camera{}, {}, PixelFormat::kGray8, bytes, &nothing) ==
        Status::kBadArgument);
  CHECK(AnytimeFrame::make(scene.pool, camera, {}, PixelFormat::kGray8, bytes.subspan(1), &nothing) ==
        Status::kOutOfMemory);
  CHECK(AnytimeFrame::make(scene.pool, camera, {}, PixelFormat::kRgb565, bytes, &nothing) ==
        Status::kOutOfMemory);
  OwnedPool other_pool(6, 10);
  Octree& other = other_pool.octree;
  CHECK(AnytimeFrame::make(other, camera, {}, PixelFormat::kGray8, bytes, &nothing) == Status::kBadArgument);
  CHECK(memory == before);
  CHECK(nothing.pixels() == 0);

  Drawing drawing(drawn);
  drawing.refine(1000);
  const auto drawn_so_far = drawing.bytes();
  CHECK(drawing.frame.refine(other, 1000) == Status::kBadArgument);
  CHECK(AnytimeFrame::make(other, camera, {}, PixelFormat::kGray8, bytes, &drawing.frame) ==
        Status::kBadArgument);
  CHECK(drawing.frame.given_visits() == 1000);
  CHECK(drawing.bytes() == drawn_so_far);

  // Rays that are too long for 32 bits.
  Camera fine;
  REQUIRE(fine.set(PerspectiveView{camera.eye(), {3, 4, 5}, {}, Q16::saturate(60), 30, 20, 20}, 5) ==
          Status::kOk);
  const Case<Octree> wide(scene.pool, fine, {}, PixelFormat::kGray8);
  Drawing frame(wide);
  CHECK(frame.frame.refine(scene.pool, 1000, Width::k32) == Status::kBadArgument);
  CHECK(frame.frame.given_visits() == 0);
}

TEST_CASE("anytime: rows for a flush -> those of the picture, cut off at its end") {
  SplitMix64 random(12);
  const RandomScene scene(random);
  const Case<Octree> drawn(scene.pool, random_camera(random, 30, 20), {}, PixelFormat::kRgb565);
  const Drawing drawing(drawn);
  const Band band = drawing.frame.band(13, 10);
  CHECK(band.first_row == 13);
  CHECK(band.rows == 7);
  CHECK(band.format == PixelFormat::kRgb565);
  CHECK(band.pixels.data == drawing.picture() + std::size_t{13} * 60);
  CHECK(band.pixels.size == 7 * 60);
  CHECK(drawing.frame.band(20, 1).rows == 0);
  CHECK(drawing.frame.band(-3, 2).first_row == 0);
}

TEST_CASE("anytime: bytes -> picture and bits") {
  static_assert(anytime_bytes(128, 64, PixelFormat::kGray4) == 5120);
  static_assert(anytime_bytes(1, 1, PixelFormat::kMono1) == 2);
  static_assert(anytime_bytes(9, 3, PixelFormat::kRgb888) == 81 + 6);
  CHECK(sizeof(AnytimeFrame) <= 320);
}
