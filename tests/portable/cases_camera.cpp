// Cameras: rays worked out by hand, symmetries, rounding, and what is refused.
#include "portable/groups.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

// Views that slant, to be turned, mirrored and moved.
PerspectiveView slanting_perspective(int number) {
  PerspectiveView view = simple_perspective();
  Random random{static_cast<uint32_t>(50 + number)};
  for (int axis = 0; axis < 3; ++axis) {
    view.forward[axis] = random.below(2001) - 1000;
    view.up[axis] = random.below(2001) - 1000;
    view.eye[axis] = Q8::from_raw(random.below(20000) - 2000);
  }
  view.fov_degrees = Q16::saturate(20 + random.below(90));
  view.width_px = 31;
  view.height_px = 23;
  return view;
}

void expect_ray(Check& check, const Ray& got, const Ray& wanted, What what) {
  for (int axis = 0; axis < 3; ++axis) {
    check.equal(got.origin[axis], wanted.origin[axis], what);
    check.equal(got.direction[axis], wanted.direction[axis], what);
  }
}

// A view that must be refused leaves the camera as it was.
void refuse(Check& check, const PerspectiveView& view, int level, Status wanted, What what) {
  THIMBLE_REQUIRE_OK(check.camera.set(simple_perspective(), 6));
  check.equal(check.camera.set(view, level), wanted, what);
  check.equal(check.camera.width_px(), 2, what);
  check.equal(check.camera.level(), 6, what);
}
void refuse(Check& check, const OrthographicView& view, int level, Status wanted, What what) {
  THIMBLE_REQUIRE_OK(check.camera.set(simple_perspective(), 6));
  check.equal(check.camera.set(view, level), wanted, what);
  check.that(check.camera.is_perspective(), what);
}

void eye_beyond(Check& check, int axis) {
  PerspectiveView view = simple_perspective();
  constexpr int32_t kBeyonds[] = {5 * 64 * 256 + 1, -4 * 64 * 256 - 1, INT32_MIN, INT32_MAX};
  for (const int32_t beyond : kBeyonds) {
    view.eye[axis] = Q8::from_raw(beyond);
    refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
  }
  view.eye[axis] = Q8::from_raw(5 * 64 * 256);
  THIMBLE_EQUAL(check.camera.set(view, 6), Status::kOk);
  view.eye[axis] = Q8::from_raw(-4 * 64 * 256);
  THIMBLE_EQUAL(check.camera.set(view, 6), Status::kOk);
}

// The eye moved by whole units: every origin moves along, no direction changes.
void moved(Check& check, int number) {
  PerspectiveView view = slanting_perspective(number);
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  Ray before[4];
  for (int i = 0; i < 4; ++i) {
    before[i] = check.camera.ray(i % 2 * 30, i / 2 * 22);
  }
  view.eye.x = view.eye.x + Q8::from_raw(777);
  view.eye.z = view.eye.z - Q8::from_raw(1234);
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  for (int i = 0; i < 4; ++i) {
    Ray wanted = before[i];
    wanted.origin.x = wanted.origin.x + Q8::from_raw(777);
    wanted.origin.z = wanted.origin.z - Q8::from_raw(1234);
    expect_ray(check, check.camera.ray(i % 2 * 30, i / 2 * 22), wanted, THIMBLE_HERE);
  }
}

// Eye, forward and up mirrored in an axis: rays mirrored, the picture left to right.
void mirrored(Check& check, int axis) {
  PerspectiveView view = slanting_perspective(axis);
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  Ray before[4];
  for (int i = 0; i < 4; ++i) {
    before[i] = check.camera.ray(3 + i * 7, 2 + i * 5);
  }
  view.eye[axis] = Q8::from_raw((256 << 8) - view.eye[axis].raw);
  view.forward[axis] = -view.forward[axis];
  view.up[axis] = -view.up[axis];
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  for (int i = 0; i < 4; ++i) {
    Ray wanted = before[i];
    wanted.origin[axis] = Q8::from_raw((256 << 8) - wanted.origin[axis].raw);
    wanted.direction[axis] = -wanted.direction[axis];
    expect_ray(check, check.camera.ray(30 - (3 + i * 7), 2 + i * 5), wanted, THIMBLE_HERE);
  }
}

template <class V>
V turned_vector(const V& v) {
  return {v.z, v.x, v.y};
}
// x to y to z to x: every ray turns along.
void turned(Check& check, int number) {
  PerspectiveView view = slanting_perspective(number);
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  Ray before[4];
  for (int i = 0; i < 4; ++i) {
    before[i] = check.camera.ray(3 + i * 7, 2 + i * 5);
  }
  view.eye = turned_vector(view.eye);
  view.forward = turned_vector(view.forward);
  view.up = turned_vector(view.up);
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  for (int i = 0; i < 4; ++i) {
    const Ray wanted{turned_vector(before[i].origin), turned_vector(before[i].direction)};
    expect_ray(check, check.camera.ray(3 + i * 7, 2 + i * 5), wanted, THIMBLE_HERE);
  }
}

// A row walked along: the rays of its pixels, one by one.
void walked(Check& check, int number) {
  if (number == 0) {
    THIMBLE_REQUIRE_OK(check.camera.set(slanting_perspective(4), 8));
  } else {
    OrthographicView view = simple_orthographic();
    view.forward = {3, -7, -2};
    view.width_px = 31;
    view.height_px = 23;
    view.span = Q14::saturate(90);
    THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  }
  for (int32_t py = 0; py < 23; py += 11) {
    RowRays rays(check.camera, 2, py);
    for (int32_t px = 2; px < 31; ++px, rays.next()) {
      const Ray ray = check.camera.ray(px, py);
      expect_ray(check, rays.ray(), ray, THIMBLE_HERE);
      THIMBLE_EQUAL(check_ray(ray, 8), Status::kOk);
    }
  }
}

// Every component along a row and a column only rises or only falls.
void monotone(Check& check, int number) {
  THIMBLE_REQUIRE_OK(check.camera.set(slanting_perspective(number), 8));
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t left = check.camera.ray(0, 7).direction[axis];
    const int32_t right = check.camera.ray(30, 7).direction[axis];
    int32_t before = left;
    bool steady = true;
    for (int32_t px = 1; px < 31; ++px) {
      const int32_t now = check.camera.ray(px, 7).direction[axis];
      steady = steady && (left <= right ? now >= before : now <= before);
      before = now;
    }
    THIMBLE_CHECK(steady);
    check.note(left);
    check.note(right);
  }
}

void direction_bits(Check& check, int bits) {
  PerspectiveView view = slanting_perspective(2);
  view.direction_bits = bits;
  THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
  THIMBLE_EQUAL(check.camera.direction_bits(), bits);
  int32_t largest = 0;
  for (int i = 0; i < 4; ++i) {
    const Ray ray = check.camera.ray(i % 2 * 30, i / 2 * 22);
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t size = ray.direction[axis] < 0 ? -ray.direction[axis] : ray.direction[axis];
      largest = size > largest ? size : largest;
    }
    check.note(ray);
  }
  THIMBLE_EQUAL(largest, (1 << bits) - 1);
}

constexpr Case kCases[] = {
    {"never set up -> no pixels", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(check.camera.width_px(), 0);
       THIMBLE_EQUAL(check.camera.height_px(), 0);
     }},
    {"2 x 2 pixels at 90 degrees -> the four diagonals by hand", 0,
     [](Check& check, int) {
       // The plane at distance 1 shows -1 .. 1; pixel centres are at +-1/2: directions (1, -+1/2, +-1/2).
       THIMBLE_REQUIRE_OK(check.camera.set(simple_perspective(), 6));
       const Vec3Q8 eye = simple_perspective().eye;
       expect_ray(check, check.camera.ray(0, 0), {eye, {255, 127, 127}}, THIMBLE_HERE);
       expect_ray(check, check.camera.ray(1, 0), {eye, {255, -127, 127}}, THIMBLE_HERE);
       expect_ray(check, check.camera.ray(0, 1), {eye, {255, 127, -127}}, THIMBLE_HERE);
       expect_ray(check, check.camera.ray(1, 1), {eye, {255, -127, -127}}, THIMBLE_HERE);
       THIMBLE_EQUAL(check.camera.direction_bits(), 8);
       THIMBLE_CHECK(check.camera.is_perspective());
     }},
    {"parallel view along x, a voxel a pixel -> origins at pixel centres", 0,
     [](Check& check, int) {
       THIMBLE_REQUIRE_OK(check.camera.set(simple_orthographic(), 6));
       // Right is -y. Row 0 lies half a voxel above the eye, column 0 one and a half to the left.
       expect_ray(check, check.camera.ray(0, 0), ray_q8({8192, 33 * 256 + 128, 32 * 256 + 128}, {255, 0, 0}),
                  THIMBLE_HERE);
       expect_ray(check, check.camera.ray(3, 1), ray_q8({8192, 30 * 256 + 128, 31 * 256 + 128}, {255, 0, 0}),
                  THIMBLE_HERE);
       THIMBLE_EQUAL(check.camera.depth_per_t_q8(), 255 * 256);
       THIMBLE_CHECK(!check.camera.is_perspective());
     }},
    {"parallel view straight down -> y is up in the picture", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.forward = {0, 0, -5};
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       expect_ray(check, check.camera.ray(0, 0), ray_q8({30 * 256 + 128, 32 * 256 + 128, 8192}, {0, 0, -255}),
                  THIMBLE_HERE);
     }},
    {"forward along a diagonal -> equal components in the middle", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {1000003, -1000003, 1000003};
       view.width_px = 81;
       view.height_px = 61;
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       const Vec3i middle = check.camera.ray(40, 30).direction;
       THIMBLE_EQUAL(middle.y, -middle.x);
       THIMBLE_EQUAL(middle.z, middle.x);
     }},
    {"parallel view along a diagonal -> equal components", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.forward = {3, 3, -3};
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       THIMBLE_EQUAL(check.camera.direction(), (Vec3i{255, 255, -255}));
     }},
    {"a component that is 0 for every pixel -> stays 0", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {5, 7, 0};
       view.height_px = 1;
       view.width_px = 40;
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       for (int32_t px = 0; px < 40; ++px) {
         THIMBLE_EQUAL(check.camera.ray(px, 0).direction.z, 0);
       }
     }},
    {"the eye moved -> origins moved by just that, directions as before", 0, moved, 0, "one view"},
    {"the eye moved -> origins moved by just that, directions as before", 0, moved, 3, "another"},
    {"mirrored in an axis -> rays mirrored, the picture left to right", 0, mirrored, 0, "axis", 3},
    {"axes turned -> rays turned", 0, turned, 1, "one view"},
    {"axes turned -> rays turned", 0, turned, 5, "another"},
    {"a row walked along -> the rays of its pixels", 0, walked, 0, "view", 2},
    {"components along a row -> monotone", 0, monotone, 2, "one view"},
    {"components along a row -> monotone", 0, monotone, 3, "another"},
    {"direction bits as given -> all of them used", 0, direction_bits, 8, "8"},
    {"direction bits as given -> all of them used", 0, direction_bits, 13, "13"},
    {"direction bits as given -> all of them used", 0, direction_bits, 20, "20"},
    {"rounding: halves -> away from zero", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(Camera::rounded(int64_t{1} << 31), 1);
       THIMBLE_EQUAL(Camera::rounded(-(int64_t{1} << 31)), -1);
       THIMBLE_EQUAL(Camera::rounded((int64_t{1} << 31) - 1), 0);
       THIMBLE_EQUAL(Camera::rounded(1 - (int64_t{1} << 31)), 0);
       THIMBLE_EQUAL(Camera::rounded(-(int64_t{3} << 31)), -2);
     }},
    {"origins half way between two numbers -> away from the eye on both sides", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.width_px = 2;
       view.height_px = 1;
       view.span = Q14::from_raw(2 * 64 * 9);  // pixels of 9/256 voxel: centres 4.5/256 off the eye
       view.eye.y = Q8::from_raw(1001);
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       THIMBLE_EQUAL(check.camera.ray(0, 0).origin.y.raw, 1006);
       THIMBLE_EQUAL(check.camera.ray(1, 0).origin.y.raw, 996);
     }},
    {"automatic bits -> a bound of 1/8 pixel at most", 0,
     [](Check& check, int) {
       for (int number = 0; number < 6; ++number) {
         THIMBLE_REQUIRE_OK(check.camera.set(slanting_perspective(number), 8));
         THIMBLE_CHECK(check.camera.error_bound_px_q16() <= 8192);
         check.note(check.camera.error_bound_px_q16());
         check.note(check.camera.direction_bits());
         check.note(check.camera.depth_per_t_q8());
       }
     }},
    {"look_at: differences -> exact", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(look_at(point_q8(1, 2, 3), point_q8(-4, 2, 7)), (Vec3i{-5, 0, 4}));
       THIMBLE_EQUAL(look_at(point_q8(5, 5, 5), point_q8(5, 5, 5)), (Vec3i{0, 0, 0}));
     }},
    {"look_at: differences beyond 2^30 -> halved until they fit", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(look_at(point_q8(INT32_MIN, 0, 40), point_q8(INT32_MAX, 1 << 20, 0)),
                     (Vec3i{(1 << 30) - 1, 1 << 18, -10}));
       THIMBLE_EQUAL(look_at({}, point_q8(1 << 30, 0, 0)), (Vec3i{1 << 30, 0, 0}));
       THIMBLE_EQUAL(look_at({}, point_q8(INT32_MIN, 0, 0)), (Vec3i{-(1 << 30), 0, 0}));
     }},
    {"default_up -> z, and y where the view is along z", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(default_up({1, 2, 3}), (Vec3i{0, 0, 1}));
       THIMBLE_EQUAL(default_up({0, 0, -3}), (Vec3i{0, 1, 0}));
       THIMBLE_EQUAL(default_up({0, 1, 0}), (Vec3i{0, 0, 1}));
     }},
    {"no pixels -> bad argument, the camera as it was", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.width_px = 0;
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
       view.width_px = 3;
       view.height_px = -1;
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"more pixels than the limit -> out of range", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.width_px = kMaxPicturePx + 1;
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
       view.width_px = 2;
       view.height_px = INT32_MAX;
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
     }},
    {"levels 0 and 13 -> out of range", 0,
     [](Check& check, int) {
       refuse(check, simple_perspective(), 0, Status::kOutOfRange, THIMBLE_HERE);
       refuse(check, simple_perspective(), 13, Status::kOutOfRange, THIMBLE_HERE);
       refuse(check, simple_orthographic(), 13, Status::kOutOfRange, THIMBLE_HERE);
     }},
    {"field of view beyond 1 .. 120 degrees -> out of range", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.fov_degrees = Q16::from_raw(kMinFov.raw - 1);
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
       view.fov_degrees = Q16::from_raw(kMaxFov.raw + 1);
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
     }},
    {"direction bits beyond 8 .. 20 -> out of range", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       constexpr int kBits[] = {-1, 1, 7, 21};
       for (const int bits : kBits) {
         view.direction_bits = bits;
         refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
       }
     }},
    {"no forward -> bad argument", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {};
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"up parallel to forward -> bad argument", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {1000, 2000, -3000};
       view.up = {-1, -2, 3};
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"up a hair off forward -> a picture", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {kMaxViewComponent, 1, 0};
       view.up = {kMaxViewComponent, 0, 0};
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       check.note(check.camera.ray(0, 0));
     }},
    {"vectors beyond 2^30 -> out of range", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward.y = INT32_MIN;
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
       view = simple_perspective();
       view.up.z = kMaxViewComponent + 1;
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
     }},
    {"eye beyond -4 .. 5 worlds -> out of range, at the limits a camera", 0, eye_beyond, 0, "axis", 3},
    {"no span -> bad argument", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.span = {};
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
       view.span = Q14::from_raw(-1);
       refuse(check, view, 6, Status::kBadArgument, THIMBLE_HERE);
     }},
    {"parallel origins to the limits -> a camera; one unit beyond -> out of range", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.forward = {0, 0, -1};
       view.width_px = 10;
       view.height_px = 1;
       view.span = Q14::saturate(640);  // centres from -4.5 to 4.5 worlds around the eye
       THIMBLE_REQUIRE_OK(check.camera.set(view, 6));
       THIMBLE_EQUAL(check.camera.ray(0, 0).origin.x, Q8::saturate(-256));
       THIMBLE_EQUAL(check.camera.ray(9, 0).origin.x, Q8::saturate(320));
       view.eye.x = Q8::from_raw(view.eye.x.raw + 1);
       refuse(check, view, 6, Status::kOutOfRange, THIMBLE_HERE);
     }},
    {"a picture too fine for 20 bits -> too fine; with bits as given -> a camera that says how coarse", 0,
     [](Check& check, int) {
       PerspectiveView view = simple_perspective();
       view.forward = {3, 2, -1};
       view.fov_degrees = Q16::saturate(1);
       view.width_px = 1;
       view.height_px = 8000;
       refuse(check, view, 8, Status::kTooFine, THIMBLE_HERE);
       view.direction_bits = 20;
       THIMBLE_REQUIRE_OK(check.camera.set(view, 8));
       THIMBLE_CHECK(check.camera.error_bound_px_q16() > 8192);
       check.note(check.camera.error_bound_px_q16());
     }},
    {"parallel pixels of 6/256 voxel -> too fine; of the least span -> a camera", 0,
     [](Check& check, int) {
       OrthographicView view = simple_orthographic();
       view.forward = {-1000, -999, -1001};
       view.width_px = 20;
       view.height_px = 1;
       view.span = Q14::from_raw(20 * 6 * 64);
       refuse(check, view, 6, Status::kTooFine, THIMBLE_HERE);
       view.span = least_orthographic_span(20, 6);
       THIMBLE_EQUAL(check.camera.set(view, 6), Status::kOk);
       THIMBLE_CHECK(check.camera.error_bound_px_q16() <= 8192);
     }},
};

}  // namespace

const Group kCameraGroup = group_of<kCases>("camera", "cases_camera.cpp");

}  // namespace thimble::portable
