/// The view of the demonstration: one home for the applications, the simulator, the benchmark and the golden
/// frames.
///
/// The camera goes round a point of the scene. With a camera in the baked scene it begins there and keeps the
/// distance from its target; without one it goes round the middle of what is solid. All in integers, without
/// a division of 64 bits, so that a frame has the same camera on every chip.
///
///   angles     1/65536 of a turn: yaw from +x towards +y, pitch upwards
///   positions  1/256 voxel
///
/// The buttons steer it: left and right turn, up and down tilt, and with select held up and down come nearer
/// and go away. However it is steered, the eye does not end in something solid: it is lifted, then moved away
/// from the target, until it is free.
#pragma once

#include <stdint.h>

#include "port.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"

namespace thimble::apps {

inline constexpr int32_t kTurn = 65536;
/// Frames in a round.
inline constexpr int32_t kFramesARound = 128;
/// The golden frames: kGoldenFrames of them, kGoldenStep apart, which is once round.
inline constexpr uint32_t kGoldenFrames = 8;
inline constexpr uint32_t kGoldenStep = 17;
/// The eye nods by this much to either side, twice a round.
inline constexpr int32_t kNod = kTurn / 256;
/// How far the eye is lifted and lowered by hand.
inline constexpr int32_t kLowestPitch = kTurn / 128;
inline constexpr int32_t kHighestPitch = kTurn * 15 / 64;

/// sin(angle) * 16384, exact at 64ths of a quarter turn and linear in between; any angle.
constexpr int32_t sine_q14(int32_t angle) {
  constexpr int16_t kQuarter[] = {0,     402,   804,   1205,  1606,  2006,  2404,  2801,  3196,  3590,  3981,
                                  4370,  4756,  5139,  5520,  5897,  6270,  6639,  7005,  7366,  7723,  8076,
                                  8423,  8765,  9102,  9434,  9760,  10080, 10394, 10702, 11003, 11297, 11585,
                                  11866, 12140, 12406, 12665, 12916, 13160, 13395, 13623, 13842, 14053, 14256,
                                  14449, 14635, 14811, 14978, 15137, 15286, 15426, 15557, 15679, 15791, 15893,
                                  15986, 16069, 16143, 16207, 16261, 16305, 16340, 16364, 16379, 16384};
  const int32_t within = angle & (kTurn / 2 - 1);
  const int32_t from_zero = within <= kTurn / 4 ? within : kTurn / 2 - within;
  const int32_t step = from_zero >> 8;
  const int32_t low = kQuarter[step];
  const int32_t high = kQuarter[step < 64 ? step + 1 : 64];
  const int32_t value = low + ((high - low) * (from_zero & 255) >> 8);
  return (angle & kTurn / 2) != 0 ? -value : value;
}
constexpr int32_t cosine_q14(int32_t angle) {
  return sine_q14(angle + kTurn / 4);
}

/// The angle of the vector (x, y), 0 .. kTurn - 1: found bit by bit with the sine's table, 16 steps.
/// |x| and |y| below 2^40; 0 for (0, 0).
constexpr int32_t angle_of(int64_t x, int64_t y) {
  int32_t angle = y < 0 || (y == 0 && x < 0) ? kTurn / 2 : 0;
  for (int32_t bit = kTurn / 4; bit != 0; bit >>= 1) {
    const int32_t tried = angle + bit;
    // Whether the vector lies at the tried angle or beyond, by less than half a turn.
    if (y * cosine_q14(tried) - x * sine_q14(tried) >= 0 && (x != 0 || y != 0)) {
      angle = tried;
    }
  }
  return angle;
}

/// The length of a vector with components below 2^26, rounded down: 27 steps, no division.
constexpr int32_t length_of(int64_t x, int64_t y, int64_t z) {
  const int64_t square = x * x + y * y + z * z;
  int64_t length = 0;
  for (int64_t bit = int64_t{1} << 27; bit != 0; bit >>= 1) {
    if ((length + bit) * (length + bit) <= square) {
      length += bit;
    }
  }
  return static_cast<int32_t>(length);
}

/// Where the eye goes round.
struct Orbit {
  SceneCamera camera;       ///< target, projection, and where the round begins
  int32_t yaw = 0;          ///< of the eye as seen from the target
  int32_t pitch = 0;        ///< likewise
  int32_t distance_q8 = 0;  ///< from the target to the eye
};

/// The orbit of a baked camera.
inline Orbit orbit_of(const SceneCamera& camera) {
  Orbit orbit;
  orbit.camera = camera;
  const int64_t x = int64_t{camera.eye.x.raw} - camera.target.x.raw;
  const int64_t y = int64_t{camera.eye.y.raw} - camera.target.y.raw;
  const int64_t z = int64_t{camera.eye.z.raw} - camera.target.z.raw;
  orbit.yaw = angle_of(x, y);
  orbit.pitch = angle_of(length_of(x, y, 0), z);
  if (orbit.pitch > kTurn / 2) {
    orbit.pitch -= kTurn;
  }
  orbit.distance_q8 = length_of(x, y, z);
  return orbit;
}

/// The orbit round a box of voxels: 26 degrees up, three quarters of its diagonal away from its middle.
inline Orbit orbit_of(const VoxelBox& box) {
  Orbit orbit;
  const auto middle = [](int32_t low, int32_t high) { return Q8::from_raw((low + high) * (Q8::kOne / 2)); };
  orbit.camera.target = {middle(box.low.x, box.high.x), middle(box.low.y, box.high.y),
                         middle(box.low.z, box.high.z)};
  orbit.yaw = kTurn / 20;
  orbit.pitch = kTurn * 26 / 360;
  orbit.distance_q8 = length_of(int64_t{box.high.x - box.low.x} * 192, int64_t{box.high.y - box.low.y} * 192,
                                int64_t{box.high.z - box.low.z} * 192) +
                      Q8::kOne;
  return orbit;
}

inline Orbit orbit_of(const BakedScene& scene) {
  return scene.has_camera() ? orbit_of(scene.camera()) : orbit_of(scene.tree().bounds());
}

/// What the hand has added to the orbit so far.
struct Steering {
  int32_t yaw = 0;
  int32_t pitch = 0;
  int32_t zoom = 0;  ///< sixteenths of the distance, kNearest .. kFarthest
};
inline constexpr int32_t kNearest = -7;
inline constexpr int32_t kFarthest = 8;

/// Adds what the buttons (port::Button) ask for in one frame.
constexpr void steer(uint32_t buttons, Steering* steering) {
  const auto pressed = [buttons](port::Button minus, port::Button plus) {
    return ((buttons & plus) != 0 ? 1 : 0) - ((buttons & minus) != 0 ? 1 : 0);
  };
  const auto limit = [](int32_t value, int32_t low, int32_t high) {
    return value < low ? low : value > high ? high : value;
  };
  steering->yaw = (steering->yaw + pressed(port::kLeft, port::kRight) * (kTurn / 64)) & (kTurn - 1);
  const int32_t vertical = pressed(port::kDown, port::kUp);
  if ((buttons & port::kSelect) != 0) {
    steering->zoom = limit(steering->zoom - vertical, kNearest, kFarthest);
  } else {
    steering->pitch = limit(steering->pitch + vertical * (kTurn / 128), -kTurn / 4, kTurn / 4);
  }
}

/// A number of Q14 parts of a length, to the nearest.
constexpr int32_t scaled(int64_t length, int32_t factor_q14) {
  return static_cast<int32_t>((length * factor_q14 + 8192) >> 14);
}

/// One camera of the orbit, without a look at what it might stand in.
inline Status place_camera(const Orbit& orbit, int32_t yaw, int32_t pitch, int32_t zoom, int32_t width_px,
                           int32_t height_px, int level, Camera* camera) {
  const SceneCamera& at = orbit.camera;
  const auto zoomed = [zoom](int32_t length) {
    return static_cast<int32_t>(int64_t{length} * (16 + zoom) >> 4);
  };
  const int32_t distance = zoomed(orbit.distance_q8);
  const int32_t across = scaled(distance, cosine_q14(pitch));
  const Vec3Q8 eye{at.target.x + Q8::from_raw(scaled(across, cosine_q14(yaw))),
                   at.target.y + Q8::from_raw(scaled(across, sine_q14(yaw))),
                   at.target.z + Q8::from_raw(scaled(distance, sine_q14(pitch)))};
  // An up of its own turns with the eye.
  const int32_t turned = yaw - orbit.yaw;
  const auto part = [turned](int32_t cosine_of, int32_t sine_of) {
    return static_cast<int32_t>(
        (int64_t{cosine_of} * cosine_q14(turned) + int64_t{sine_of} * sine_q14(turned)) >> 14);
  };
  SceneCamera moved = at;
  moved.eye = eye;
  moved.forward = {};
  if (at.up != Vec3i{}) {
    moved.up = {part(at.up.x, -at.up.y), part(at.up.y, at.up.x), at.up.z};
  }
  moved.span = Q14::from_raw(zoomed(at.span.raw));
  return set_camera(moved, width_px, height_px, level, camera);
}

/// The camera of frame `frame`. `tree` (CompactTree or Octree) says whether the eye is in something
/// solid, by the ray in the picture's middle: a ray or two. Errors: those of Camera::set, when 24 places that
/// were tried had one; `*camera` is then the last that had none, or as it was.
template <class Tree>
Status view_at(const Orbit& orbit, const Tree& tree, uint32_t frame, const Steering& steering,
               int32_t width_px, int32_t height_px, Camera* camera) {
  const int32_t turned = static_cast<int32_t>(frame % kFramesARound) * (kTurn / kFramesARound);
  const int32_t yaw = orbit.yaw + turned + steering.yaw;
  int32_t pitch = orbit.pitch + steering.pitch;
  // A baked camera may look from below or from above; a hand leads it between the limits only.
  const int32_t lowest = orbit.pitch < kLowestPitch ? orbit.pitch : kLowestPitch;
  const int32_t highest = orbit.pitch > kHighestPitch ? orbit.pitch : kHighestPitch;
  pitch = pitch < lowest ? lowest : pitch > highest ? highest : pitch;
  pitch += sine_q14(2 * turned) * kNod >> 14;
  int32_t zoom = steering.zoom;
  Status status = Status::kOk;
  for (int tries = 0; tries < 24; ++tries) {
    status = place_camera(orbit, yaw, pitch, zoom, width_px, height_px, tree.level(), camera);
    if (status == Status::kOutOfRange && zoom > kNearest) {
      --zoom;  // beyond what rays may start from: nearer
      continue;
    }
    // A ray that starts inside knows after one way down the tree.
    TraceOptions options;
    options.max_visits = static_cast<uint32_t>(tree.level()) + 1;
    Hit hit;
    if (status != Status::kOk ||
        closest_hit(tree, camera->ray(width_px / 2, height_px / 2), &hit, options) != Status::kOk ||
        hit.kind != HitKind::kHit || hit.axis >= 0) {
      return status;
    }
    if (pitch < kHighestPitch - kTurn / 64) {
      pitch += kTurn / 64;
    } else {
      zoom += 4;
    }
  }
  return status;
}

/// The light of the demonstration: from above and the left, the dark sides bright enough for 16 greys.
inline Shading demo_shading(Span<const Rgb8> palette) {
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = palette;
  shading.background = {146, 186, 222};
  const uint16_t face_light[6] = {182, 148, 218, 126, 72, 256};
  for (int face = 0; face < 6; ++face) {
    shading.face_light[face] = face_light[face];
  }
  return shading;
}

}  // namespace thimble::apps
