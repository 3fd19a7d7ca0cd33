// Bands: each pixel is its ray's shade, whatever the structure, the format and the way the picture is cut.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"

namespace thimble::portable {
namespace {

constexpr PixelFormat kFormats[] = {PixelFormat::kMono1, PixelFormat::kGray4, PixelFormat::kGray8,
                                    PixelFormat::kRgb565, PixelFormat::kRgb888};
constexpr int32_t kWidth = 13;
constexpr int32_t kHeight = 9;
constexpr uint8_t kGuard = 0xA5;
constexpr uint32_t kRowBytes = 40;
constexpr uint32_t kPictureBytes = 352;

// A few boxes in a world of 16, and a camera in front of it.
constexpr RayScene::Box kBoxes[] = {
    {{2, 2, 0}, {14, 14, 2}}, {{4, 4, 2}, {8, 8, 6}}, {{10, 9, 2}, {11, 10, 9}}};
constexpr RayScene kScene = {4, 3, 260, kBoxes};
constexpr uint32_t kSceneBytes = scene_bytes(4, 260);

bool set_up(Check& check, bool perspective = true, int level = 4, int bits = 0) {
  const Vec3Q8 eye = point_q8(-1501, -3003, 4207);
  const Vec3i forward = look_at(eye, point_q8(2048, 2048, 900));
  Status status = Status::kOk;
  if (perspective) {
    status =
        check.camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(28), kWidth, kHeight, bits}, level);
  } else {
    status =
        check.camera.set(OrthographicView{eye, forward, {}, Q14::saturate(17), kWidth, kHeight, bits}, level);
  }
  const DepthRange range = depth_range(check.camera, {{0, 0, 0}, {16, 16, 16}});
  check.shading.near_q8 = range.near_q8;
  check.shading.far_q8 = range.far_q8;
  check.shading.background = {12, 34, 56};
  check.options = {};
  return check.equal(status, Status::kOk, THIMBLE_WHAT("camera of the picture"));
}
bool make_scene(Check& check) {
  return build(check, kScene) && set_up(check);
}

Status draw(Check& check, int structure) {
  if (structure == 0) {
    return render_band(check.world.grid, check.camera, check.shading, check.band, &check.counts,
                       check.options);
  }
  if (structure == 1) {
    return render_band(check.world.pool, check.camera, check.shading, check.band, &check.counts,
                       check.options);
  }
  return render_band(check.world.compact, check.camera, check.shading, check.band, &check.counts,
                     check.options);
}
void set_band(Check& check, Bytes pixels, PixelFormat format, int32_t first_row, int32_t rows) {
  check.band = Band{};
  check.band.pixels = pixels;
  check.band.format = format;
  check.band.first_row = first_row;
  check.band.rows = rows;
}

// Row by row by the definition: trace, shade, store; and the band of that row.
void against_rays(Check& check, int number) {
  const PixelFormat format = kFormats[number % 5];
  const int structure = number / 5;
  THIMBLE_REQUIRE(make_scene(check));
  check.shading.mode = static_cast<ShadeMode>(number % 4);
  const Bytes wanted = check.arena.take(kRowBytes);
  const Bytes drawn = check.arena.take(kRowBytes);
  const size_t size = row_bytes(format, kWidth);
  uint64_t visits = 0;
  uint64_t hits = 0;
  for (int32_t y = 0; y < kHeight; ++y) {
    for (size_t i = 0; i < kRowBytes; ++i) {
      wanted[i] = 0;
      drawn[i] = kGuard;
    }
    for (int32_t x = 0; x < kWidth; ++x) {
      const Ray ray = check.camera.ray(x, y);
      THIMBLE_REQUIRE_OK(closest(check, structure, ray, check.options));
      store_pixel(wanted.data, x, y, format, shade(check.hit, ray, check.camera, check.shading));
      visits += check.hit.visits;
      hits += check.hit.kind == HitKind::kHit ? 1 : 0;
    }
    set_band(check, drawn, format, y, 1);
    THIMBLE_REQUIRE_OK(draw(check, structure));
    THIMBLE_CHECK(check.equal(ConstBytes(drawn.subspan(0, size)), ConstBytes(wanted.subspan(0, size)),
                              THIMBLE_WHAT("row of the band")));
    THIMBLE_EQUAL(drawn[size], kGuard);
  }
  THIMBLE_EQUAL(check.counts.rays, kWidth * kHeight);
  THIMBLE_EQUAL(check.counts.hits, hits);
  THIMBLE_EQUAL(check.counts.node_visits, visits);
  THIMBLE_EQUAL(check.counts.step_limited, 0U);
  THIMBLE_CHECK(hits > 20);
}

uint32_t picture_crc(Check& check, int structure, Bytes pixels, PixelFormat format, int32_t step) {
  uint32_t crc = 0;
  for (int32_t y = 0; y < kHeight; y += step) {
    const int32_t rows = kHeight - y < step ? kHeight - y : step;
    set_band(check, pixels, format, y, rows);
    if (draw(check, structure) != Status::kOk) {
      return 0;
    }
    crc = crc32(pixels.subspan(0, band_bytes(format, kWidth, rows)), crc);
  }
  return crc;
}

void any_band_height(Check& check, int number) {
  THIMBLE_REQUIRE(make_scene(check));
  const PixelFormat format = kFormats[number];
  const Bytes pixels = check.arena.take(kPictureBytes);
  const uint32_t whole = picture_crc(check, 2, pixels, format, kHeight);
  THIMBLE_CHECK(whole != 0);
  // No format of today keeps rows together: a band of one row is drawn, and takes the bytes of one.
  THIMBLE_EQUAL(band_row_multiple(format), 1);
  constexpr int32_t kSteps[] = {1, 2, 4, 5, 8};
  for (const int32_t step : kSteps) {
    THIMBLE_EQUAL(whole_rows(format, step), step);
    THIMBLE_CHECK(band_bytes(format, kWidth, step) == row_bytes(format, kWidth) * static_cast<size_t>(step));
    THIMBLE_EQUAL(picture_crc(check, 2, pixels, format, step), whole);
  }
}

// Draws what must be refused: a status, no byte, no count.
void refuse(Check& check, Status wanted, What what) {
  for (int structure = 0; structure < 3; ++structure) {
    check.counts = {1, 2, 3, 4};
    for (uint8_t& byte : check.band.pixels) {
      byte = kGuard;
    }
    check.equal(draw(check, structure), wanted, what);
    bool untouched = true;
    for (const uint8_t byte : check.band.pixels) {
      untouched = untouched && byte == kGuard;
    }
    check.that(untouched, what);
    check.that(check.counts.rays == 1 && check.counts.node_visits == 3, what);
  }
}

void stride_with_gaps(Check& check, int number) {
  THIMBLE_REQUIRE(make_scene(check));
  const PixelFormat format = kFormats[number];
  const size_t line = row_bytes(format, kWidth);
  const size_t stride = line + 5;
  const Bytes pixels = check.arena.take(stride * 2 + line + 8, 1);
  const Bytes row = check.arena.take(kRowBytes);
  for (uint8_t& byte : pixels) {
    byte = kGuard;
  }
  // Just enough: no gap is needed behind the last row.
  set_band(check, pixels.subspan(0, stride * 2 + line), format, 3, 3);
  check.band.stride_bytes = stride;
  THIMBLE_REQUIRE_OK(draw(check, 2));
  for (int32_t y = 0; y < 3; ++y) {
    set_band(check, row, format, 3 + y, 1);
    THIMBLE_REQUIRE_OK(draw(check, 2));
    const ConstBytes there = pixels.subspan(stride * static_cast<size_t>(y), line);
    THIMBLE_CHECK(check.equal(there, ConstBytes(row.subspan(0, line)), THIMBLE_WHAT("row in place")));
    for (size_t gap = 0; gap < 5; ++gap) {
      THIMBLE_EQUAL(pixels[stride * static_cast<size_t>(y) + line + gap], kGuard);
    }
  }
}

void step_limit(Check& check, int limit) {
  THIMBLE_REQUIRE(make_scene(check));
  const Bytes pixels = check.arena.take(kPictureBytes);
  check.shading.mode = ShadeMode::kNormal;
  check.options.max_visits = static_cast<uint32_t>(limit);
  set_band(check, pixels, PixelFormat::kRgb888, 0, kHeight);
  THIMBLE_REQUIRE_OK(draw(check, 2));
  THIMBLE_CHECK(check.counts.step_limited > 0);
  THIMBLE_CHECK(check.counts.node_visits <= static_cast<uint64_t>(limit) * check.counts.rays);
  check.note(static_cast<int64_t>(check.counts.step_limited));
  check.note_bytes(pixels.subspan(0, band_bytes(PixelFormat::kRgb888, kWidth, kHeight)));
}

constexpr uint32_t kRayBytes = kSceneBytes + 2 * kRowBytes;
constexpr uint32_t kDrawBytes = kSceneBytes + kPictureBytes + kRowBytes;
constexpr const char kByRays[] = "each pixel -> its ray's shade; counts -> the sums";

constexpr Case kCases[] = {
    {kByRays, kRayBytes, against_rays, 0, "structure, format and mode", 15},
    {"bands of any height -> the picture of one frame", kDrawBytes, any_band_height, 0, "format", 5},
    {"both widths, all structures, both projections -> one picture", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       const Bytes pixels = check.arena.take(kPictureBytes);
       for (int projection = 0; projection < 2; ++projection) {
         THIMBLE_REQUIRE(set_up(check, projection == 0));
         const uint32_t wanted = picture_crc(check, 2, pixels, PixelFormat::kGray8, kHeight);
         check.note(wanted);
         constexpr Width kWidths[] = {Width::k32, Width::k64, Width::kAuto};
         for (const Width width : kWidths) {
           check.options.width = width;
           for (int structure = 0; structure < 3; ++structure) {
             THIMBLE_EQUAL(picture_crc(check, structure, pixels, PixelFormat::kGray8, 4), wanted);
           }
         }
       }
     }},
    {"a stride with gaps -> rows in place, gaps untouched", kDrawBytes, stride_with_gaps, 0, "format", 5},
    {"rows outside the picture -> bad argument, nothing drawn", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       const Bytes pixels = check.arena.take(kPictureBytes);
       constexpr int32_t kRows[][2] = {{-1, 1},        {0, -1},        {0, kHeight + 1}, {kHeight, 1},
                                       {INT32_MAX, 1}, {INT32_MIN, 1}, {1, INT32_MAX},   {kHeight - 1, 2}};
       for (const int32_t(&range)[2] : kRows) {
         set_band(check, pixels, PixelFormat::kGray8, range[0], range[1]);
         refuse(check, Status::kBadArgument, THIMBLE_HERE);
       }
     }},
    {"a stride below a row -> bad argument, nothing drawn", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 2);
       check.band.stride_bytes = kWidth - 1;
       refuse(check, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"bytes too few by one -> out of memory, nothing drawn", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       const Bytes pixels = check.arena.take(kPictureBytes);
       set_band(check, pixels.subspan(0, kWidth * 4 - 1), PixelFormat::kGray8, 2, 4);
       refuse(check, Status::kOutOfMemory, THIMBLE_HERE);
       set_band(check, {}, PixelFormat::kGray8, 2, 1);
       refuse(check, Status::kOutOfMemory, THIMBLE_HERE);
     }},
    {"a stride whose product wraps -> out of memory", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 3);
       check.band.stride_bytes = SIZE_MAX / 2 + 1;
       refuse(check, Status::kOutOfMemory, THIMBLE_HERE);
     }},
    {"no rows -> ok, nothing counted", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       set_band(check, {}, PixelFormat::kGray8, kHeight, 0);
       THIMBLE_EQUAL(draw(check, 2), Status::kOk);
       THIMBLE_EQUAL(check.counts.rays, 0U);
     }},
    {"a camera never set up -> bad argument, nothing drawn", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kScene));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 1);
       refuse(check, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"a camera for another level -> bad argument, nothing drawn", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kScene));
       THIMBLE_REQUIRE(set_up(check, true, 5));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 1);
       refuse(check, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"rays too long for 32 bits -> refused with k32, drawn with kAuto", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(build(check, kScene));
       THIMBLE_REQUIRE(set_up(check, true, 4, 20));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 1);
       check.options.width = Width::k32;
       refuse(check, Status::kBadArgument, THIMBLE_HERE);
       check.options.width = Width::kAuto;
       THIMBLE_EQUAL(draw(check, 2), Status::kOk);
       check.note_bytes(check.band.pixels.subspan(0, kWidth));
     }},
    {"a step limit -> counted, never passed", kDrawBytes, step_limit, 0, "limit", 5},
    {"an empty world -> background, no node visited", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 0, 4));
       THIMBLE_REQUIRE(make_compact(check));
       THIMBLE_REQUIRE(set_up(check));
       const Bytes pixels = check.arena.take(kPictureBytes);
       set_band(check, pixels, PixelFormat::kRgb888, 0, kHeight);
       THIMBLE_REQUIRE_OK(draw(check, 2));
       THIMBLE_EQUAL(check.counts.hits, 0U);
       THIMBLE_EQUAL(check.counts.node_visits, 0U);
       THIMBLE_EQUAL((Rgb8{pixels[0], pixels[1], pixels[2]}), (Rgb8{12, 34, 56}));
       THIMBLE_EQUAL((Rgb8{pixels[348], pixels[349], pixels[350]}), (Rgb8{12, 34, 56}));
     }},
    {"counts -> added to", kDrawBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_scene(check));
       set_band(check, check.arena.take(kPictureBytes), PixelFormat::kGray8, 0, 2);
       check.counts = {1000, 2000, 3000, 4000};
       THIMBLE_REQUIRE_OK(draw(check, 2));
       THIMBLE_EQUAL(check.counts.rays, 1000U + 2 * kWidth);
       THIMBLE_EQUAL(check.counts.step_limited, 4000U);
       THIMBLE_CHECK(check.counts.hits >= 2000 && check.counts.node_visits >= 3000);
     }},
    {"band_bytes -> rows of whole bytes", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(band_bytes(PixelFormat::kMono1, 61, 3), 24U);
       THIMBLE_EQUAL(band_bytes(PixelFormat::kGray4, 61, 3), 93U);
       THIMBLE_EQUAL(band_bytes(PixelFormat::kGray8, 61, 0), 0U);
       THIMBLE_EQUAL(band_bytes(PixelFormat::kRgb565, 320, 240), 153600U);
       THIMBLE_EQUAL(band_bytes(PixelFormat::kRgb888, 16384, 16384), 805306368U);
     }},
};

}  // namespace

const Group kRenderGroup = group_of<kCases>("render", "cases_render.cpp");

}  // namespace thimble::portable
