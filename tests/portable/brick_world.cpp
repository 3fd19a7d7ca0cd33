#include "portable/brick_world.h"

#include "portable/scene.h"

namespace thimble::portable::brick_world {
namespace {

constexpr SolidBox kBoxes[] = {
    {{{0, 0, 0}, {16, 16, 4}}, 1},  {{{4, 4, 4}, {8, 8, 12}}, 2},   {{{10, 8, 4}, {12, 12, 6}}, 3},
    {{{12, 2, 4}, {13, 3, 11}}, 4}, {{{2, 12, 4}, {4, 14, 16}}, 5},
};
constexpr Rgb8 kPalette[] = {{9, 9, 9}, {200, 180, 140}, {190, 60, 50}, {60, 120, 210}, {250, 250, 120}};

struct Course {
  int32_t eye[3];
  int32_t target[3];
  int32_t fov;   // degrees; 0: parallel
  int32_t span;  // voxels, of a parallel camera
};
constexpr Course kCourses[] = {
    {{-1501, -3003, 4207}, {2048, 2048, 900}, 28, 0},
    {{2048, 9000, 2048}, {2048, 2048, 2048}, 40, 0},
    {{2000, 2600, 1500}, {4100, 500, 1200}, 90, 0},
    {{1300, 1300, 1300}, {4100, 500, 1200}, 60, 0},
    {{-2048, -2048, 6144}, {2048, 2048, 2048}, 50, 0},
    {{9000, 1000, 7000}, {2048, 2048, 700}, 0, 20},
    {{2048, 2048, 9000}, {2048, 2048, 0}, 0, 17},
    {{30 * 256, -40 * 256, 20 * 256}, {2048, 2048, 700}, 5, 0},
};
static_assert(kLookCount == sizeof kCourses / sizeof kCourses[0]);

}  // namespace

bool make_world(Check& check, const Site& site) {
  return make_pool(check, kPoolNodes, site.level, kBoxes, site.corner) && make_compact(check);
}

bool look(Check& check, int number, const Site& site) {
  const Course& how = kCourses[number];
  const auto place = [&site](const int32_t(&at)[3]) {
    return point_q8(at[0] + site.corner.x * Q8::kOne, at[1] + site.corner.y * Q8::kOne,
                    at[2] + site.corner.z * Q8::kOne);
  };
  const Vec3Q8 eye = place(how.eye);
  const Vec3i forward = look_at(eye, place(how.target));
  Status status = Status::kOk;
  if (how.fov != 0) {
    status = check.camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(how.fov), kWidth, kHeight, 0},
                              site.level);
  } else {
    status = check.camera.set(OrthographicView{eye, forward, {}, Q14::saturate(how.span), kWidth, kHeight, 0},
                              site.level);
  }
  check.shading = {};
  check.shading.palette = {kPalette, sizeof kPalette / sizeof kPalette[0]};
  check.shading.background = {12, 34, 56};
  const Vec3i& low = site.corner;
  const DepthRange range = depth_range(check.camera, {low, {low.x + 16, low.y + 16, low.z + 16}});
  check.shading.near_q8 = range.near_q8;
  check.shading.far_q8 = range.far_q8;
  return check.equal(status, Status::kOk, THIMBLE_WHAT("camera"));
}

void set_band(Check& check, Bytes bytes, PixelFormat format, int32_t y, int32_t rows) {
  check.band = Band{};
  check.band.pixels = bytes.subspan(0, band_bytes(format, kWidth, rows));
  check.band.format = format;
  check.band.first_row = y;
  check.band.rows = rows;
  check.counts = RenderCounts{};
}

}  // namespace thimble::portable::brick_world
