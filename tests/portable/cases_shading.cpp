// From a hit to a colour.
#include "portable/groups.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

// A parallel camera along +x whose t is just depth: a hit with numerator n lies at depth n.
bool camera_along_x(Check& check) {
  const OrthographicView view{{}, {1, 0, 0}, {}, Q14::saturate(8), 8, 8, 8};
  return check.equal(check.camera.set(view, 5), Status::kOk, THIMBLE_WHAT("camera along x")) &&
         check.equal(check.camera.depth_per_t_q8(), 255 * 256, THIMBLE_WHAT("depth a unit of t"));
}
Hit hit_at(int32_t depth_q8) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = 0;
  hit.t_numerator = depth_q8;
  hit.t_denominator = 255 * 256;
  return hit;
}
Hit hit_on(int axis) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(axis);
  return hit;
}

Rgb8 color_of(Check& check, const Hit& hit, const Vec3i& direction) {
  return shade(hit, {{}, direction}, check.camera, check.shading);
}

// Brightness from near to far: 255 at near, kFarBrightness at far, never rising.
void depth_scale(Check& check, int index) {
  constexpr DepthRange kRanges[] = {{0, 256}, {1000, 70000}, {77, 78}, {-500, 8000000}};
  THIMBLE_REQUIRE(camera_along_x(check));
  const DepthRange range = kRanges[index];
  check.shading.near_q8 = range.near_q8;
  check.shading.far_q8 = range.far_q8;
  int before = 255;
  for (int i = 0; i <= 40; ++i) {
    const int32_t depth = range.near_q8 + (range.far_q8 - range.near_q8) / 32 * i;
    const Rgb8 color = color_of(check, hit_at(depth < 0 ? 0 : depth), {255, 0, 0});
    THIMBLE_CHECK(color.r == color.g && color.g == color.b);
    THIMBLE_CHECK(color.r <= before && color.r >= kFarBrightness);
    before = color.r;
    check.note(color.r);
  }
  THIMBLE_EQUAL(color_of(check, hit_at(range.far_q8 + range.far_q8 / 1000 + 9), {255, 0, 0}).r,
                kFarBrightness);
}

constexpr Case kCases[] = {
    {"depth: from near to far -> 255 down to the least, never rising", 0, depth_scale, 0, "planes", 4},
    {"depth: far before near -> bright up to near, dim behind", 0,
     [](Check& check, int) {
       THIMBLE_REQUIRE(camera_along_x(check));
       check.shading.near_q8 = 5000;
       check.shading.far_q8 = 100;
       THIMBLE_EQUAL(color_of(check, hit_at(4000), {255, 0, 0}).r, 255);
       THIMBLE_EQUAL(color_of(check, hit_at(5100), {255, 0, 0}).r, kFarBrightness);
     }},
    {"depth: planes at the ends of the numbers -> a colour in range", 0,
     [](Check& check, int) {
       THIMBLE_REQUIRE(camera_along_x(check));
       constexpr int32_t kNearQ8s[] = {INT32_MIN, -1, INT32_MAX};
       for (const int32_t near_q8 : kNearQ8s) {
         constexpr int32_t kFarQ8s[] = {INT32_MIN, 0, INT32_MAX};
         for (const int32_t far_q8 : kFarQ8s) {
           check.shading.near_q8 = near_q8;
           check.shading.far_q8 = far_q8;
           const int gray = color_of(check, hit_at(1 << 20), {255, 0, 0}).r;
           THIMBLE_CHECK(gray >= kFarBrightness);
           check.note(gray);
         }
       }
     }},
    {"planar depth: a start inside, or no camera -> 0", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(planar_depth_q8(hit_at(1000), check.camera), 0);
       THIMBLE_REQUIRE(camera_along_x(check));
       THIMBLE_EQUAL(planar_depth_q8(hit_on(-1), check.camera), 0);
     }},
    {"depth_range: an empty box, no camera, a box behind -> 0 and one voxel", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(depth_range(check.camera, {{0, 0, 0}, {4, 4, 4}}).far_q8, 256);
       THIMBLE_REQUIRE(camera_along_x(check));
       THIMBLE_EQUAL(depth_range(check.camera, {}).near_q8, 0);
       THIMBLE_EQUAL(depth_range(check.camera, {}).far_q8, 256);
       const OrthographicView away{{}, {-1, 0, 0}, {}, Q14::saturate(8), 8, 8, 8};
       THIMBLE_REQUIRE_OK(check.camera.set(away, 5));
       THIMBLE_EQUAL(depth_range(check.camera, {{3, 0, 0}, {7, 9, 9}}).near_q8, 0);
       THIMBLE_EQUAL(depth_range(check.camera, {{3, 0, 0}, {7, 9, 9}}).far_q8, 256);
     }},
    {"light_from: no light -> 141 everywhere", 0,
     [](Check& check, int) {
       uint16_t light[6];
       light_from({0, 0, 0}, light);
       for (const uint16_t face : light) {
         THIMBLE_EQUAL(face, 141);
       }
     }},
    {"face_of: an entered face -> looks against the ray", 0,
     [](Check& check, int) {
       const Vec3i direction{5, -7, 9};
       THIMBLE_CHECK(face_of(hit_on(0), direction).negative);
       THIMBLE_CHECK(!face_of(hit_on(1), direction).negative);
       THIMBLE_CHECK(face_of(hit_on(2), direction).negative);
       THIMBLE_EQUAL(face_of(hit_on(2), direction).axis, 2);
     }},
    {"face_of: a start inside -> opposed to the largest component, the lowest axis on a tie", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(face_of(hit_on(-1), {1, -3, 2}).axis, 1);
       THIMBLE_CHECK(!face_of(hit_on(-1), {1, -3, 2}).negative);
       THIMBLE_EQUAL(face_of(hit_on(-1), {0, 0, 1}).axis, 2);
       THIMBLE_EQUAL(face_of(hit_on(-1), {-2, 2, 2}).axis, 0);
       THIMBLE_EQUAL(face_of(hit_on(-1), {1, 2, -2}).axis, 1);
     }},
    {"face_of: starts inside, any mix of components -> the largest of them by its definition", 0,
     [](Check& check, int) {
       for (int32_t i = 0; i < 125; ++i) {
         const int32_t parts[3] = {i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2};
         int wanted = 0;
         for (int axis = 1; axis < 3; ++axis) {
           wanted = parts[axis] * parts[axis] > parts[wanted] * parts[wanted] ? axis : wanted;
         }
         const Vec3i direction{parts[0] * 500000, parts[1] * 500000, parts[2] * 500000};
         const Face face = face_of(hit_on(-1), direction);
         THIMBLE_EQUAL(face.axis, wanted);
         THIMBLE_EQUAL(face.negative, parts[wanted] > 0);
       }
     }},
    {"normal: each face -> its direction, -1 .. 1 as 0 .. 255", 0,
     [](Check& check, int) {
       check.shading.mode = ShadeMode::kNormal;
       THIMBLE_EQUAL(color_of(check, hit_on(0), {1, 1, 1}), (Rgb8{0, 128, 128}));
       THIMBLE_EQUAL(color_of(check, hit_on(0), {-1, 1, 1}), (Rgb8{255, 128, 128}));
       THIMBLE_EQUAL(color_of(check, hit_on(1), {1, 1, 1}), (Rgb8{128, 0, 128}));
       THIMBLE_EQUAL(color_of(check, hit_on(1), {1, -1, 1}), (Rgb8{128, 255, 128}));
       THIMBLE_EQUAL(color_of(check, hit_on(2), {1, 1, 1}), (Rgb8{128, 128, 0}));
       THIMBLE_EQUAL(color_of(check, hit_on(2), {1, 1, -1}), (Rgb8{128, 128, 255}));
     }},
    {"color: a material -> its palette entry; beyond the palette -> the default", 0,
     [](Check& check, int) {
       const Rgb8 palette[] = {{10, 20, 30}, {200, 100, 50}};
       check.shading.mode = ShadeMode::kColor;
       check.shading.palette = Span<const Rgb8>(palette);
       check.shading.default_color = {1, 2, 3};
       check.shading.face_light[0] = 256;
       Hit hit = hit_on(0);
       THIMBLE_EQUAL(color_of(check, hit, {1, 0, 0}), palette[0]);
       hit.material = 1;
       THIMBLE_EQUAL(color_of(check, hit, {1, 0, 0}), palette[1]);
       hit.material = 255;
       THIMBLE_EQUAL(color_of(check, hit, {1, 0, 0}), (Rgb8{1, 2, 3}));
       check.shading.palette = {};
       hit.material = 0;
       THIMBLE_EQUAL(color_of(check, hit, {1, 0, 0}), (Rgb8{1, 2, 3}));
     }},
    {"color: the face's light -> times the colour, clamped and not wrapped", 0,
     [](Check& check, int) {
       const Rgb8 palette[] = {{200, 100, 50}};
       check.shading.mode = ShadeMode::kColor;
       check.shading.palette = Span<const Rgb8>(palette);
       check.shading.face_light[0] = 128;
       THIMBLE_EQUAL(color_of(check, hit_on(0), {1, 0, 0}), (Rgb8{100, 50, 25}));
       check.shading.face_light[0] = 700;
       THIMBLE_EQUAL(color_of(check, hit_on(0), {1, 0, 0}), (Rgb8{255, 255, 136}));
       check.shading.face_light[0] = 65535;
       THIMBLE_EQUAL(color_of(check, hit_on(0), {1, 0, 0}), (Rgb8{255, 255, 255}));
       check.shading.face_light[0] = 0;
       THIMBLE_EQUAL(color_of(check, hit_on(0), {1, 0, 0}), (Rgb8{0, 0, 0}));
     }},
    {"a miss or a stopped ray -> the background", 0,
     [](Check& check, int) {
       check.shading.background = {9, 8, 7};
       constexpr ShadeMode kModes[] = {ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor};
       for (const ShadeMode mode : kModes) {
         check.shading.mode = mode;
         check.hit = Hit{};
         THIMBLE_EQUAL(color_of(check, check.hit, {1, 0, 0}), (Rgb8{9, 8, 7}));
         check.hit.kind = HitKind::kStepLimit;
         THIMBLE_EQUAL(color_of(check, check.hit, {1, 0, 0}), (Rgb8{9, 8, 7}));
       }
     }},
    {"mono -> white where something is, black where not", 0,
     [](Check& check, int) {
       check.shading.background = {9, 8, 7};
       check.shading.mode = ShadeMode::kMono;
       THIMBLE_EQUAL(color_of(check, Hit{}, {1, 0, 0}), (Rgb8{0, 0, 0}));
       THIMBLE_EQUAL(color_of(check, hit_on(1), {1, 0, 0}), (Rgb8{255, 255, 255}));
     }},
};

}  // namespace

const Group kShadingGroup = group_of<kCases>("shading", "cases_shading.cpp");

}  // namespace thimble::portable
