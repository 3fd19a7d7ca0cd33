// Rays from a point on a face towards a distant light. Internal to src/.
#pragma once

#include "brick_ray.h"
#include "sun_plane.h"

namespace thimble::bricks {
namespace {

// Empty: rays end at bricks with nothing behind them.
struct NoSunPlane {};

struct SunEnds : SunPlane {
  mutable uint32_t planes;  // that the last ray may cross
};

// Rays of one direction from any point: what BrickRay reads of a course, and what starting a ray takes. Of level 9 and 10
// they end where the light's plane says.
template <bool kIsDeep>
struct ShadowCourse : Choose<kIsDeep, SunEnds, NoSunPlane> {
  static constexpr Aim kAim = Aim::kShadow;
  static constexpr bool kDeep = kIsDeep;
  const uint8_t* directory;
  const uint8_t* bricks;
  // One bit for each brick of the directory: nothing behind it is solid; or a byte for each cell of the plane. Or null.
  const uint8_t* behind_bits;
  int32_t next_brick[3];
  uint32_t last[3];
  int32_t one_step[3];
  uint32_t d[3];       // the direction, mirrored
  int32_t cells[3];    // sides of the box
  uint32_t near_left;  // counts of bricks for a ray in the box's lowest brick
  uint32_t both_left;  // counts of a brick from both sides, added
  int32_t near_place;  // offset in the directory of the corner brick that all rays come from
  // d / d[c], rounded down and up, in 1/2^16.
  int32_t low_slope[3];
  int32_t high_slope[3];
  int c;
  int axes[3];  // a, b and c
  unsigned mirrored;
  bool wide;

  [[gnu::always_inline]] bool is_free(int32_t at) const {
    return !kDeep && behind_bits != nullptr &&
           (static_cast<uint32_t>(behind_bits[at >> 4]) >> (at >> 1 & 7) & 1U) != 0;
  }
  [[gnu::always_inline]] bool goes_down(int axis) const { return (mirrored >> axis & 1U) != 0; }

  void set(const BrickMap& map, const Vec3i& direction, const uint8_t* free_bricks) {
    directory = map.directory();
    bricks = map.bricks();
    behind_bits = free_bricks;
    c = 0;
    mirrored = 0;
    near_left = 0;
    both_left = 0;
    near_place = 0;
    uint32_t all = 0;
    int32_t step = 2;
    for (int i = 0; i < 3; ++i) {
      const bool down = direction[i] < 0;
      d[i] = static_cast<uint32_t>(down ? -direction[i] : direction[i]);
      all |= d[i];
      c = d[i] > d[c] ? i : c;
      mirrored |= down ? 1U << i : 0U;
      last[i] = down ? 0U : 3U << kPlaceShift[i];
      one_step[i] = down ? -(1 << kPlaceShift[i]) : 1 << kPlaceShift[i];
      const int32_t side = map.box().high[i] - map.box().low[i];
      if constexpr (kDeep) {
        step = deep_place::kStride[i];
      }
      cells[i] = 4 * side;
      next_brick[i] = down ? -step : step;
      near_left += static_cast<uint32_t>(down ? 511 : 512 - side) << 10 * i;
      both_left += static_cast<uint32_t>(1023 - side) << 10 * i;
      near_place += down ? (side - 1) * step : 0;
      step *= side;
    }
    for (int i = 0; i < 3; ++i) {
      low_slope[i] = static_cast<int32_t>((d[i] << 16) / d[c]);
      high_slope[i] = low_slope[i] + (static_cast<uint32_t>(low_slope[i]) * d[c] < d[i] << 16 ? 1 : 0);
    }
    wide = all >= 1U << 11;
    axes[0] = c == 0 ? 1 : 0;
    axes[1] = c == 2 ? 1 : 2;
    axes[2] = c;
    if constexpr (kDeep) {
      for (int k = 0; k < 2; ++k) {
        SunPlane::set(k, low_slope[axes[k]], cells[axes[k]] >> 2, cells[c] >> 2);
      }
    }
  }

  // The slab of voxels along c at which rays end from some points, which lie between two corners, by a, b and c, mirrored,
  // in 1/256 voxel.
  int32_t end_of(const int32_t (&low)[3], const int32_t (&high)[3]) const {
    int32_t layers = behind_bits == nullptr ? SunPlane::kAll : 0;
    if (layers == 0) {
      const int32_t to_a = this->cell_of(0, high[0], low[2]);
      const int32_t to_b = this->cell_of(1, high[1], low[2]);
      for (int32_t b = this->cell_of(1, low[1], high[2]); b <= to_b; ++b) {
        for (int32_t a = this->cell_of(0, low[0], high[2]); a <= to_a; ++a) {
          const int32_t own = behind_bits[b * this->count[0] + a];
          layers = own > layers ? own : layers;
        }
      }
    }
    return layers == SunPlane::kAll ? cells[c] : 4 * layers;
  }
};

// A point on a face of a voxel: on each axis the voxel, counted from the box's lowest corner, and how far the point is
// in it, in 1/256. On `axis` the point lies on the face's plane, whatever `within` says.
struct FacePoint {
  int32_t voxel[3];
  int32_t within[3];
  int axis;
  bool faces_up;  // the face looks to larger coordinates
};

// The fields of counts of bricks on some axes, a bit each.
constexpr uint32_t kFields[8] = {0, 0x3FF, 0xFFC00, 0xFFFFF, 0x3FF00000, 0x3FF003FF, 0x3FFFFC00, 0x3FFFFFFF};

// Where a ray towards a light starts: counts of bricks in its numbering, the voxel, and the place in that voxel, mirrored.
struct ShadowStart {
  uint32_t left;
  int32_t cell;    // offset in the directory
  uint32_t place;  // the voxel's bit in its brick
  uint32_t within[3];
};

template <int kC, class OneCourse>
[[gnu::noinline]] int32_t shadow_along(const OneCourse& course, uint32_t number, const ShadowStart& start) {
  constexpr int kA = kOtherA<kC>;
  constexpr int kB = kOtherB<kC>;
  const uint32_t d_a = course.d[kA];
  const uint32_t d_b = course.d[kB];
  const uint32_t d_c = course.d[kC];
  BrickRay<kC, kAnySigns, OneCourse> ray(course, d_a, d_b, d_c);
  // The rests on the plane of c before the point.
  const uint32_t rest_a = start.within[kA] * d_c - start.within[kC] * d_a - (d_c << 8);
  const uint32_t rest_b = start.within[kB] * d_c - start.within[kC] * d_b - (d_c << 8);
  ray.begin(number, start.left, start.cell, start.place, rest_a, rest_b);
  if constexpr (OneCourse::kDeep) {
    ray.end_after(course.planes);
  }
  return ray.trace();
}

// Whether a ray meets something solid.
template <bool kDeep>
bool is_shadowed(const ShadowCourse<kDeep>& course, const ShadowStart& start) {
  if constexpr (kDeep) {
    int32_t at[3];
    for (int k = 0; k < 3; ++k) {
      const int axis = course.axes[k];
      const auto brick = static_cast<int32_t>(count_of(start.left, axis)) - (512 - (course.cells[axis] >> 2));
      const auto own = static_cast<int32_t>(start.place >> 2 * axis & 3U);
      at[k] = 256 * (4 * brick + (course.goes_down(axis) ? 3 - own : own)) +
              static_cast<int32_t>(start.within[axis]);
    }
    const int32_t slabs = course.end_of(at, at) - (at[2] >> 8);
    if (slabs <= 0) {
      return false;
    }
    course.planes = static_cast<uint32_t>(slabs - 1);
  }
  const uint32_t number = number_at<kDeep>(course.directory, start.cell);
  if (number == 0 && course.is_free(start.cell)) {
    return false;
  }
  const int32_t answer = course.c == 0   ? shadow_along<0>(course, number, start)
                         : course.c == 1 ? shadow_along<1>(course, number, start)
                                         : shadow_along<2>(course, number, start);
  return answer != kMissed;
}

// Whether the ray that leaves a face at a point meets something solid, as `any_hit` says for the tree.
template <bool kDeep>
bool is_shadowed(const ShadowCourse<kDeep>& course, const FacePoint& point) {
  ShadowStart start{course.near_left, 0, 0, {}};
  for (int i = 0; i < 3; ++i) {
    const bool down = course.goes_down(i);
    int32_t voxel = point.voxel[i];
    uint32_t in = static_cast<uint32_t>(point.within[i]);
    if (i == point.axis) {
      voxel += point.faces_up ? 1 : -1;
    } else if (down) {
      // A ray that goes down from a plane is in the voxel below.
      voxel -= in == 0 ? 1 : 0;
      in = in == 0 ? 0 : 256 - in;
    }
    if (static_cast<uint32_t>(voxel) >= static_cast<uint32_t>(course.cells[i])) {
      return false;  // it leaves the box
    }
    const int32_t brick = voxel >> 2;
    start.left += static_cast<uint32_t>((down ? -brick : brick) * (1 << 10 * i));
    start.cell += brick * (down ? -course.next_brick[i] : course.next_brick[i]);
    start.place |= (static_cast<uint32_t>(voxel) & 3U) << 2 * i;
    start.within[i] = in;
  }
  return is_shadowed(course, start);
}

// Whether the ray towards a light meets something solid that starts where a ray of the camera, of a SightCourse, has landed:
// at `point` on its face. It starts from the counts of the camera's ray: on axes on which the two go opposite ways they count
// from the other side.
template <bool kDeep, class Sight>
bool is_shadowed(const ShadowCourse<kDeep>& light, const Sight& course, const FacePoint& point) {
  const auto& landing = course.landing;
  const uint32_t fields = kFields[light.mirrored ^ course.mirrored];
  uint32_t left = landing.left + (light.both_left & fields) - 2 * (landing.left & fields);
  int32_t cell = landing.cell;
  uint32_t place = landing.voxel & 63U;
  uint32_t within[3];
#pragma GCC unroll(kDivides ? 3 : 1)
  for (int i = 0; i < 3; ++i) {
    const auto in = static_cast<uint32_t>(point.within[i]);
    within[i] = light.goes_down(i) && in != 0 ? 256 - in : in;
    if (in == 0 && (i == point.axis || light.goes_down(i))) {
      // Goes to the next voxel: across the face, or where a ray that goes down starts on a plane.
      const uint32_t field = 3U << 2 * i;
      if ((place & field) == (light.goes_down(i) ? 0 : field)) {
        place ^= field;
        cell += light.next_brick[i];
        left += 1U << 10 * i;
      } else {
        place += light.goes_down(i) ? 0U - (1U << 2 * i) : 1U << 2 * i;
      }
    }
  }
  return (left & kLeft) == 0 &&
         is_shadowed(light, ShadowStart{left, cell, place, {within[0], within[1], within[2]}});
}

}  // namespace
}  // namespace thimble::bricks
