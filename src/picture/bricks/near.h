// Rays from a point on a face into any direction, for as far as that is asked: to a lamp, or as far as occlusion
// reaches. Internal to src/.
#ifndef THIMBLE_SRC_PICTURE_BRICKS_NEAR_H
#define THIMBLE_SRC_PICTURE_BRICKS_NEAR_H

#include "sight.h"

namespace thimble::bricks {
namespace {

// A ray: what BrickRay reads of a course, its direction, mirrored, and where it begins.
struct NearRay {
  static constexpr Aim kAim = Aim::kNear;
  static constexpr bool wide = true;  // the comparison serves directions of few bits, too
  const uint8_t* directory;
  const uint8_t* bricks;
  int32_t next_brick[3];
  uint32_t last[3];
  int32_t one_step[3];
  uint32_t d[3];
  uint32_t within[3];  // the voxel, mirrored, in 1/256
  uint32_t left;       // counts of bricks
  int32_t cell;        // offset in the directory
  uint32_t place;      // of the voxel
  uint32_t planes;     // of c, that it may cross
  mutable Landing landing;
};

template <int kC>
[[gnu::noinline]] bool near_along(const NearRay& from) {
  constexpr int kA = kOtherA<kC>;
  constexpr int kB = kOtherB<kC>;
  const uint32_t d_a = from.d[kA];
  const uint32_t d_b = from.d[kB];
  const uint32_t d_c = from.d[kC];
  BrickRay<kC, kAnySigns, NearRay> ray(from, d_a, d_b, d_c);
  // Back to the plane of c before it, and on from there.
  const uint32_t rest_a = from.within[kA] * d_c - from.within[kC] * d_a - (d_c << 8);
  const uint32_t rest_b = from.within[kB] * d_c - from.within[kC] * d_b - (d_c << 8);
  ray.begin(half_at(from.directory, from.cell), from.left, from.cell, from.place, rest_a, rest_b);
  ray.end_after(from.planes);
  return ray.trace() != kMissed;
}

// What a ray from a point meets.
struct NearHit {
  int axis;        // of a face by which it is entered
  uint32_t way;    // to there along the axis, in 1/256 voxel; 0 where the ray begins in something solid
  uint32_t voxel;  // as Landing's
};

// A point on a face, from which rays leave.
class NearPoint {
 public:
  NearPoint(const BrickMap& map, const FacePoint& point) {
    ray_.directory = map.directory();
    ray_.bricks = map.bricks();
    int32_t stride = 2;
    for (int i = 0; i < 3; ++i) {
      side_[i] = map.box().high[i] - map.box().low[i];
      stride_[i] = stride;
      stride *= side_[i];
      at_[i] = 256 * point.voxel[i] + (i != point.axis ? point.within[i] : point.faces_up ? 256 : 0);
    }
  }

  // Sets the signs of the rays that follow: bit a, axis a is mirrored. False when they leave the box at once. They leave
  // the face.
  bool begin(unsigned mirrored) {
    mirrored_ = mirrored;
    ray_.left = 0;
    ray_.cell = 0;
    ray_.place = 0;
    for (int i = 0; i < 3; ++i) {
      const bool down = (mirrored >> i & 1U) != 0;
      // A ray that goes down from a plane is in the voxel below.
      const int32_t own = own_place(i, down);
      const int32_t cell = own >> 8;
      const int32_t side = side_[i];
      if (cell >= 4 * side) {
        return false;
      }
      const int32_t voxel = down ? 4 * side - 1 - cell : cell;
      const int32_t step = 1 << kPlaceShift[i];
      ray_.next_brick[i] = down ? -stride_[i] : stride_[i];
      ray_.one_step[i] = down ? -step : step;
      ray_.last[i] = down ? 0U : 3U << kPlaceShift[i];
      ray_.within[i] = static_cast<uint32_t>(own) & 255U;
      ray_.left += static_cast<uint32_t>(512 - side + (cell >> 2)) << 10 * i;
      ray_.cell += (voxel >> 2) * stride_[i];
      ray_.place |= (static_cast<uint32_t>(voxel) & 3U) << 2 * i;
    }
    return true;
  }

  // The hit of a ray of direction `d`, mirrored, nearer than `reach` along its fastest axis `c` (1/256 voxel, not 0);
  // others may be found, too.
  [[gnu::always_inline]] bool trace(const uint32_t (&d)[3], int c, uint32_t reach, NearHit* hit) {
    ray_.d[0] = d[0];
    ray_.d[1] = d[1];
    ray_.d[2] = d[2];
    ray_.planes = (reach + ray_.within[c] - 1) >> 8;
    return (c == 0 ? near_along<0>(ray_) : c == 1 ? near_along<1>(ray_) : near_along<2>(ray_)) && find(hit);
  }

 private:
  bool find(NearHit* hit) const {
    const Landing& landing = ray_.landing;
    const int axis = landing.axis;
    const bool down = (mirrored_ >> axis & 1U) != 0;
    const auto bricks = static_cast<int32_t>(count_of(landing.left, axis) - count_of(ray_.left, axis));
    const auto place = static_cast<int32_t>(landing.voxel >> 2 * axis & 3U);
    const int32_t way = 256 * (4 * bricks + (down ? 3 - place : place)) - (own_place(axis, down) & 1023);
    hit->axis = axis;
    hit->way = way > 0 ? static_cast<uint32_t>(way) : 0;
    hit->voxel = landing.voxel;
    return true;
  }
  // From the box's near side, in 1/256 voxel.
  int32_t own_place(int axis, bool down) const { return down ? 1024 * side_[axis] - at_[axis] : at_[axis]; }

  int32_t side_[3];    // of the box, in bricks
  int32_t stride_[3];  // of the directory, in bytes
  int32_t at_[3];      // in the box, in 1/256 voxel
  unsigned mirrored_;
  NearRay ray_;
};

}  // namespace
}  // namespace thimble::bricks

#endif
