// Traces the camera's rays for their hits, not for inks; at these hits other rays start towards lights. Internal to
// src/.
//
// BrickRay walks with signs that it looks up, so that there are three copies of it and not 24. What a ray hits through
// an edge is left to the tree, which knows which face counts and of which voxel.
#pragma once

#include "place_across.h"
#include "shadow.h"
#include "tile_painter.h"

namespace thimble::bricks {
namespace {

// Where a ray of the camera ends: 64 times the brick's number plus the voxel's bit, the counts of bricks, the offset in
// the directory, the axis of the face.
struct Landing {
  uint32_t voxel;
  uint32_t left;
  int32_t cell;
  int axis;
};

// A course whose signs are data.
template <bool kDeep>
struct SightCourse : Choose<kDeep, DeepCourse, Course> {
  static constexpr Aim kAim = Aim::kSight;
  uint32_t last[3];     // the last voxel of a brick, shifted to its place
  int32_t one_step[3];  // what a step adds to a voxel's place
  int32_t way_base[3];  // the place of the eye in 1/256 voxel where a count of bricks is 0
  mutable Landing landing;
  mutable uint32_t near_cell[2];

  void set_signs() {
    for (int i = 0; i < 3; ++i) {
      last[i] = this->flip[i] != 0 ? 0U : 3U << kPlaceShift[i];
      one_step[i] = this->flip[i] != 0 ? -(1 << kPlaceShift[i]) : 1 << kPlaceShift[i];
      way_base[i] = (512 - this->frame->side[i]) * (4 * Q8::kOne) + this->origin[i] - outside_q8(*this, i);
    }
  }
};

// Finds the point at which the ray of direction `d` (mirrored) has landed, as `start_on_face` does: coordinates across
// the face are rounded down, in the world's own direction.
template <int kAxis, class OneCourse, class Direction>
[[gnu::always_inline]] inline void find_within(const OneCourse& course, const int32_t (&way)[3],
                                               const Direction& d, FacePoint* point) {
  const uint32_t speed = d[kAxis];
#pragma GCC unroll(kDivides ? 3 : 1)
  for (int i = 0; i < 3; ++i) {
    if (i == kAxis) {
      point->within[i] = 0;
      continue;
    }
    const uint32_t in = static_cast<uint32_t>(way[kAxis]) * d[i] - static_cast<uint32_t>(way[i]) * speed;
    // Of level 9 and 10 the products have more bits, but not their difference.
    THIMBLE_NOTE(Range::kDeepPlace, Exact(way[kAxis]) * Exact(d[i]) - Exact(way[i]) * Exact(speed));
    point->within[i] = place_across<kDivides>(in, speed, course.flip[i] != 0);
  }
  point->axis = kAxis;
  point->faces_up = course.flip[kAxis] != 0;
}
template <class OneCourse, class Direction>
[[gnu::always_inline]] inline void find_within(int axis, const OneCourse& course, const int32_t (&way)[3],
                                               const Direction& d, FacePoint* point) {
  switch (axis) {
    case 0:
      return find_within<0>(course, way, d, point);
    case 1:
      return find_within<1>(course, way, d, point);
    default:
      return find_within<2>(course, way, d, point);
  }
}
// The way along an axis from the eye to the near plane of the voxel at which a ray has landed.
template <bool kDeep>
[[gnu::always_inline]] inline int32_t way_to(const SightCourse<kDeep>& course, int axis) {
  const Landing& landing = course.landing;
  const uint32_t place = (landing.voxel >> 2 * axis & 3U) ^ course.flip[axis];
  return static_cast<int32_t>(count_of(landing.left, axis) * 4 + place) * Q8::kOne - course.way_base[axis];
}

// Finds where on its face the ray of direction `d` has landed: all of the point but its voxel.
template <bool kDeep>
void find_place(const SightCourse<kDeep>& course, const Vec3<uint32_t>& d, FacePoint* point) {
  const int32_t way[3] = {way_to(course, 0), way_to(course, 1), way_to(course, 2)};
  find_within(course.landing.axis, course, way, d, point);
}
// Finds the face on which a ray has landed; not where on it.
template <bool kDeep>
void find_face(const SightCourse<kDeep>& course, FacePoint* face) {
  const Landing& landing = course.landing;
  for (int i = 0; i < 3; ++i) {
    const int32_t side = course.frame->side[i];
    const int32_t brick = static_cast<int32_t>(count_of(landing.left, i)) - (512 - side);
    face->voxel[i] = 4 * (course.flip[i] != 0 ? side - 1 - brick : brick) +
                     static_cast<int32_t>(landing.voxel >> 2 * i & 3U);
  }
  face->axis = landing.axis;
  face->faces_up = course.flip[landing.axis] != 0;
}
template <bool kDeep>
void find_point(const SightCourse<kDeep>& course, const Vec3<uint32_t>& d, FacePoint* point) {
  find_face(course, point);
  find_place(course, d, point);
}

template <int kC, class OneCourse>
[[gnu::noinline]] int32_t sight_along(const OneCourse& course, const Vec3<uint32_t>& d) {
  return BrickRay<kC, kAnySigns, OneCourse>(course, d[kOtherA<kC>], d[kOtherB<kC>], d[kC]).trace();
}

// Traces the ray of a pixel, of direction `d`, mirrored, and tells the sink what it meets.
template <class Sink>
[[gnu::always_inline]] inline void see(Sink& sink, const SightCourse<Sink::kDeep>& course, int32_t x,
                                       int32_t y, const Vec3<uint32_t>& d) {
  const int32_t answer = course.c == 0   ? sight_along<0>(course, d)
                         : course.c == 1 ? sight_along<1>(course, d)
                                         : sight_along<2>(course, d);
  if (answer == kShadowed) {
    sink.hit(x, y, course, d);
  } else if (answer == kMissed) {
    sink.miss(x, y);
  } else {
    sink.ask(x, y);
  }
}

// A face that a sweep has found: its voxel (as Landing's), the distances from the eye to the voxel's near planes, the
// face's axis, and the voxel's place in the box. `point.within` is not set.
struct SeenFace {
  uint32_t voxel;
  int32_t way[3];
  FacePoint point;
};

// Finds where the ray of direction `d` meets the face.
void find_point(const Course& course, const Vec3<uint32_t>& d, SeenFace* face) {
  find_within(face->point.axis, course, face->way, d, &face->point);
}

// The pixels of a tile that show one face.
struct SeenPixels {
  const Course& course;
  const Sweep& sweep;
  const FirstDirection& first;
  const TilePlace& place;
  const Pixels& pixels;

  // The direction of one of the pixels, mirrored.
  Vec3<uint32_t> direction(uint32_t pixel) const {
    uint32_t turned[3];
    find_direction(sweep, first, pixel, turned);
    return in_world(course, turned);
  }
  static Vec3<uint32_t> in_world(const Course& course, const uint32_t (&turned)[3]) {
    const int c = course.c;
    return {turned[c == 0 ? 2 : 0], turned[c == 0 ? 0 : 3 - c], turned[c == 2 ? 2 : 1]};
  }
};

// Hands what a sweep finds to a sink, where no inks are wanted.
template <class Sink>
struct SightPaint {
  static constexpr bool kDeep = Sink::kDeep;
  Sweep& sweep_;
  SightCourse<kDeep>& course_;
  const FirstDirection& first_direction_;
  const TilePlace& place_;
  Sink& sink_;

  void begin_tile() {}

  void paint_face(int32_t place, const int32_t (&cell)[3], int k, const Pixels& pixels) {
    SeenFace face;
    face.voxel = voxel_of<kDeep>(course_, sweep_, place, cell);
    face.point.axis = course_.axis[k];
    face.point.faces_up = course_.flip[face.point.axis] != 0;
    for (int m = 0; m < 3; ++m) {
      const int axis = course_.axis[m];
      face.way[axis] = distance_of(sweep_, m, cell[m]);
      face.point.voxel[axis] = course_.flip[axis] != 0 ? 4 * sweep_.side[m] - 1 - cell[m] : cell[m];
    }
    sink_.face({course_, sweep_, first_direction_, place_, pixels}, face);
  }

  void paint_ray(uint32_t pixel, const uint32_t (&d)[3]) {
    sweep_.left.word[pixel >> 5] &= ~(1U << (pixel & 31U));
    see(sink_, course_, place_.x + static_cast<int32_t>(pixel & (kTileAcrossPx - 1)),
        place_.y + static_cast<int32_t>(pixel / kTileAcrossPx), SeenPixels::in_world(course_, d));
  }
};

// Goes through the tiles of one band, and tells the sink what each pixel's ray meets:
//
//   miss(x, y)            it meets nothing
//   ask(x, y)             only the tree can tell
//   hit(x, y, course, d)  the ray of direction d, mirrored, meets `course.landing`
//
// and where tiles are swept (with `sweep`)
//
//   face(pixels, face)    all of these pixels show that face
//   miss(place, pixels)   all of these pixels show nothing
//
// Sink::kDeep says whether the world has level 9 or 10.
template <class Sink>
class SightPainter : public TilePainter<SightCourse<Sink::kDeep>, SightPainter<Sink>> {
  using Tiles = TilePainter<SightCourse<Sink::kDeep>, SightPainter>;
  friend Tiles;

 public:
  SightPainter(const BrickFrame& frame, Sweep* sweep, Sink& sink) : Tiles(frame, sweep), sink_(sink) {
    course_.inks = nullptr;
    course_.exact_ties = false;
    course_.near_cell[0] = 0;
    course_.near_cell[1] = 0;
  }

 private:
  using Tiles::course_;
  using Tiles::sweep_;

  using Paint = SightPaint<Sink>;
  static TilePlace place_of(const Tile& tile) {
    return {nullptr, 0, tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0};
  }
  Paint paint(const FirstDirection& first, const TilePlace& place) {
    return {*sweep_, course_, first, place, sink_};
  }
  void miss(const TilePlace& place, const Pixels& pixels) { sink_.miss(place, pixels); }
  [[gnu::noinline]] void miss(const Tile& tile) {
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      for (int32_t x = tile.x0; x < tile.x1; ++x) {
        sink_.miss(x, y);
      }
    }
  }

  void trace_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& fan, int32_t slab) {
    if (!fan.usable()) {
      for (int32_t y = quad.y0; y < quad.y1; ++y) {
        for (int32_t x = quad.x0; x < quad.x1; ++x) {
          sink_.ask(x, y);
        }
      }
      return;
    }
    if (fan.mixed != 0) {
      trace_mixed(quad, value, fan.c, slab);
      return;
    }
    // Mirrored, and with a half added, the affine function is positive all over the quad, so rounding is cutting off.
    Vec3<uint64_t> at;
    Camera::Vec3Q32 next_row;  // the step from a row's last pixel
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<uint64_t>((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) +
                 (uint64_t{1} << 31);
      next_row[axis] = course_.step_y[axis] - wide_multiple(quad.x1 - quad.x0 - 1, course_.step_x[axis]);
    }
    // One loop with one direction, for which the registers do.
    for (int32_t x = quad.x0, y = quad.y0; y < quad.y1;) {
      see(sink_, course_, x, y,
          {static_cast<uint32_t>(at.x >> 32), static_cast<uint32_t>(at.y >> 32),
           static_cast<uint32_t>(at.z >> 32)});
      const bool ends = ++x == quad.x1;
      const Camera::Vec3Q32& step = ends ? next_row : course_.step_x;
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] += static_cast<uint64_t>(step[axis]);
      }
      x = ends ? quad.x0 : x;
      y += ends ? 1 : 0;
    }
  }

  [[gnu::noinline]] void trace_mixed(const Tile& quad, const Camera::Vec3Q32& value, int c, int32_t slab) {
    this->trace_each(quad, value, c, slab,
                     [&](int32_t x, int32_t y, const Vec3<uint32_t>& d) { see(sink_, course_, x, y, d); });
  }

  Sink& sink_;
};

}  // namespace
}  // namespace thimble::bricks
