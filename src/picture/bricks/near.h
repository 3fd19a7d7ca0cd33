// Rays from a point on a face into any direction: those that end at a given distance, at a lamp or where occlusion ends,
// and those that show what a mirror shows. Internal to src/.
#pragma once

#include "sight.h"

namespace thimble::bricks {
namespace {

// A ray: what BrickRay reads of a course, its direction, mirrored, and where it begins. kFar says that some of the rays
// run far through the air, to lamps.
template <bool kFar, bool kIsDeep>
struct NearRay {
  static constexpr Aim kAim = Aim::kNear;
  static constexpr bool kDeep = kIsDeep;
  static constexpr bool kRunsFar = kFar;
  using Near = NearRay;
  static constexpr bool wide = true;  // the wide comparison is right for directions of few bits, too
  static constexpr bool exact_ties = false;
  const uint8_t* directory;
  const uint8_t* bricks;
  int32_t next_brick[3];
  uint32_t last[3];
  int32_t one_step[3];
  uint32_t d[3];
  uint32_t within[3];  // where in its voxel the ray begins, mirrored, in 1/256
  uint32_t left;       // counts of bricks
  int32_t cell;        // offset in the directory
  uint32_t place;      // of the voxel
  uint32_t planes;     // planes of c that the ray may cross
  mutable Landing landing;
};

// The same for what a mirror shows.
template <bool kFar, bool kDeep>
struct MirrorRay : NearRay<kFar, kDeep> {
  static constexpr Aim kAim = Aim::kMirror;
  static constexpr bool kRunsFar = true;
};

// Whether a ray meets something; for a mirror what it meets, as BrickRay says.
template <int kC, class OneRay>
[[gnu::noinline]] auto near_along(const OneRay& from) {
  constexpr int kA = kOtherA<kC>;
  constexpr int kB = kOtherB<kC>;
  const uint32_t d_a = from.d[kA];
  const uint32_t d_b = from.d[kB];
  const uint32_t d_c = from.d[kC];
  BrickRay<kC, kAnySigns, OneRay> ray(from, d_a, d_b, d_c);
  // The rests on the plane of c before the point.
  const uint32_t rest_a = from.within[kA] * d_c - from.within[kC] * d_a - (d_c << 8);
  const uint32_t rest_b = from.within[kB] * d_c - from.within[kC] * d_b - (d_c << 8);
  ray.begin(number_at<OneRay::kDeep>(from.directory, from.cell), from.left, from.cell, from.place, rest_a,
            rest_b);
  ray.end_after(from.planes);
  if constexpr (OneRay::kAim == Aim::kMirror) {
    return ray.trace();
  } else {
    return ray.trace() != kMissed;
  }
}

// What a ray from a point meets.
struct NearHit {
  int axis;  // of a face by which the ray enters the voxel
  uint32_t
      way;  // how far that face is along the axis, in 1/256 voxel; 0 where the ray begins in something solid
  uint32_t voxel;  // as Landing's
};

// A point on a face, from which rays leave.
template <class OneRay>
class NearPoint {
 public:
  [[gnu::cold, gnu::noinline]] void set_map(const BrickMap& map) {
    ray_.directory = map.directory();
    ray_.bricks = map.bricks();
    near_left_ = 0;
    int32_t stride = 2;
    for (int i = 0; i < 3; ++i) {
      const int32_t side = map.box().high[i] - map.box().low[i];
      if constexpr (OneRay::kDeep) {
        stride = deep_place::kStride[i];
      }
      low_[i] = 1024 * map.box().low[i];
      size_[i] = 1024 * side;
      near_left_ += static_cast<uint32_t>(512 - side) << 10 * i;
      stride_[i] = stride;
      stride *= side;
    }
    set_signs(0);
  }
  void set(const FacePoint& point) {
    for (int i = 0; i < 3; ++i) {
      at_[i] = 256 * point.voxel[i] + point.within[i];
    }
    at_[point.axis] = 256 * (point.voxel[point.axis] + (point.faces_up ? 1 : 0));
  }
  // The point's coordinate in the world, in 1/256 voxel.
  int32_t place(int axis) const { return low_[axis] + at_[axis]; }
  // The same of the box's lowest corner.
  int32_t low(int axis) const { return low_[axis]; }

  // Sets the signs of the rays that follow, which leave the face: bit a is set where axis a is mirrored. Returns false
  // when they leave the box at once.
  bool begin(unsigned mirrored) {
    if (mirrored != mirrored_) {
      set_signs(mirrored);
    }
    uint32_t left = near_left_;
    uint32_t place = 0;
    int32_t cell = near_cell_;
    for (int i = 0; i < 3; ++i) {
      const int32_t own = own_place(i);
      if (own >= size_[i]) {
        return false;
      }
      const int32_t brick = own >> 10;
      left += static_cast<uint32_t>(brick) << 10 * i;
      cell += brick * ray_.next_brick[i];
      // Mirrored, the voxel's place in its brick is counted from the other side.
      const uint32_t voxel = static_cast<uint32_t>(own) >> 8 & 3U;
      place |= (is_mirrored(i) ? 3 - voxel : voxel) << 2 * i;
      ray_.within[i] = static_cast<uint32_t>(own) & 255U;
    }
    ray_.left = left;
    ray_.cell = cell;
    ray_.place = place;
    return true;
  }

  // Finds what the ray of direction `d`, mirrored, hits nearer than `reach` along its fastest axis `c` (in 1/256 voxel,
  // not 0). It may also find a hit somewhat beyond.
  [[gnu::always_inline]] bool trace(const uint32_t (&d)[3], int c, uint32_t reach, NearHit* hit) {
    ray_.d[0] = d[0];
    ray_.d[1] = d[1];
    ray_.d[2] = d[2];
    ray_.planes = (reach + ray_.within[c] - 1) >> 8;
    const typename OneRay::Near& ray = ray_;
    return (c == 0 ? near_along<0>(ray) : c == 1 ? near_along<1>(ray) : near_along<2>(ray)) && find(hit);
  }

 protected:
  bool is_mirrored(int axis) const { return (mirrored_ >> axis & 1U) != 0; }
  // The distance of the point from the side of the box at which the rays come in, in 1/256 voxel.
  int32_t own_place(int axis) const { return is_mirrored(axis) ? size_[axis] - at_[axis] : at_[axis]; }
  int32_t bricks_on(int axis) const { return size_[axis] >> 10; }
  void set_place(const Vec3Q8& place) {
    for (int i = 0; i < 3; ++i) {
      at_[i] = place[i].raw - low_[i];
    }
  }
  bool is_before_box() const { return own_place(0) < 0 || own_place(1) < 0 || own_place(2) < 0; }
  OneRay& ray() { return ray_; }

 private:
  [[gnu::noinline]] void set_signs(unsigned mirrored) {
    mirrored_ = mirrored;
    near_cell_ = 0;
    for (int i = 0; i < 3; ++i) {
      const bool down = is_mirrored(i);
      const int32_t step = 1 << kPlaceShift[i];
      ray_.next_brick[i] = down ? -stride_[i] : stride_[i];
      ray_.one_step[i] = down ? -step : step;
      ray_.last[i] = down ? 0U : static_cast<uint32_t>(3 * step);
      near_cell_ += down ? ((size_[i] >> 10) - 1) * stride_[i] : 0;
    }
  }

  bool find(NearHit* hit) const {
    const Landing& landing = ray_.landing;
    const int axis = landing.axis;
    const auto bricks = static_cast<int32_t>(count_of(landing.left, axis) - count_of(ray_.left, axis));
    const auto place = static_cast<int32_t>(landing.voxel >> 2 * axis & 3U);
    const int32_t way =
        256 * (4 * bricks + (is_mirrored(axis) ? 3 - place : place)) - (own_place(axis) & 1023);
    hit->axis = axis;
    hit->way = way > 0 ? static_cast<uint32_t>(way) : 0;
    hit->voxel = landing.voxel;
    return true;
  }

  // The box, in 1/256 voxel.
  int32_t low_[3];
  int32_t size_[3];
  int32_t stride_[3];  // of the directory, in bytes
  int32_t at_[3];      // in the box, in 1/256 voxel
  unsigned mirrored_;
  // The box's corner brick at which rays of these signs come in: counts of bricks, and its place in the directory.
  uint32_t near_left_;
  int32_t near_cell_;
  OneRay ray_;
};

// A point on a face that may be a metal's, from which rays go to what it mirrors, too; or any other place where rays
// start.
template <bool kFar, bool kDeep>
class MirrorPoint : public NearPoint<MirrorRay<kFar, kDeep>> {
 public:
  // Traces a ray of any direction that leaves the face: kMissed; kAsk, where only the tree knows what is hit, since the
  // ray enters that through an edge, or begins in it; else moves to the point that it hits, of `voxel` (as Landing's).
  template <bool kPlaced = false>
  int32_t go_on(const Vec3i& direction, uint32_t* voxel, FacePoint* point) {
    if constexpr (!kPlaced) {
      this->set(*point);
    }
    MirrorRay<kFar, kDeep>& ray = this->ray();
    unsigned mirrored = 0;
    int c = 0;
    for (int i = 0; i < 3; ++i) {
      ray.d[i] = static_cast<uint32_t>(direction[i] < 0 ? -direction[i] : direction[i]);
      mirrored |= direction[i] < 0 ? 1U << i : 0U;
      c = ray.d[i] > ray.d[c] ? i : c;
    }
    if (!this->begin(mirrored)) {
      return kMissed;
    }
    if (kPlaced && this->is_before_box()) {
      return kAsk;
    }
    ray.planes = UINT32_MAX;
    const int32_t answer = c == 0 ? near_along<0>(ray) : c == 1 ? near_along<1>(ray) : near_along<2>(ray);
    if (answer != kShadowed) {
      return answer;
    }
    *voxel = ray.landing.voxel;
    return find_point(point) ? answer : kAsk;
  }
  // The same from a place in the world; kAsk, too, where the ray may come into the box.
  int32_t go_on_from(const Vec3Q8& place, const Vec3i& direction, uint32_t* voxel, FacePoint* point) {
    this->set_place(place);
    return go_on<true>(direction, voxel, point);
  }

 private:
  // As that of rays of the camera. False where the ray begins in the voxel.
  bool find_point(FacePoint* point) {
    const MirrorRay<kFar, kDeep>& ray = this->ray();
    struct {
      uint32_t flip[3];
    } signs;
    int32_t way[3];
    for (int i = 0; i < 3; ++i) {
      signs.flip[i] = this->is_mirrored(i) ? 3 : 0;
      const int32_t side = this->bricks_on(i);
      const int32_t brick = static_cast<int32_t>(count_of(ray.landing.left, i)) - (512 - side);
      const auto place = static_cast<int32_t>(ray.landing.voxel >> 2 * i & 3U);
      point->voxel[i] = 4 * (this->is_mirrored(i) ? side - 1 - brick : brick) + place;
      way[i] = (4 * brick + (this->is_mirrored(i) ? 3 - place : place)) * Q8::kOne - this->own_place(i);
    }
    const int axis = ray.landing.axis;
    if (way[axis] <= 0) {
      return false;
    }
    find_within(axis, signs, way, ray.d, point);
    return true;
  }
};

}  // namespace
}  // namespace thimble::bricks
