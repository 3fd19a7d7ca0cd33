// Rays that are asked for their hits, not for inks: those of the camera, and those that go on from where these end
// towards a light. Internal to src/.
//
// The walk is BrickRay's; the signs are looked up, so that there are three copies of it each and not 24. What a ray
// hits through an edge is left to the tree: there it is a question which face counts, and whose.
#ifndef THIMBLE_SRC_PICTURE_BRICKS_SIGHT_H
#define THIMBLE_SRC_PICTURE_BRICKS_SIGHT_H

#include "beam.h"
#include "brick_ray.h"
#include "thimble/picture/brick_render.h"
#include "tile.h"

namespace thimble::bricks {
namespace {

// Where a ray of the camera ends: 64 times the brick's number and the voxel's bit, counts of bricks, the place in the
// directory, the axis of the face.
struct Landing {
  uint32_t voxel;
  uint32_t left;
  int32_t cell;
  int axis;
};

// A course whose signs are data.
struct SightCourse : Course {
  static constexpr Aim kAim = Aim::kSight;
  uint32_t last[3];     // the voxel of a brick, in place, behind which the next brick comes
  int32_t one_step[3];  // what is added to the place of a voxel
  mutable Landing landing;
  mutable uint32_t near_cell[2];

  void set_signs() {
    for (int i = 0; i < 3; ++i) {
      last[i] = flip[i] != 0 ? 0U : 3U << kPlaceShift[i];
      one_step[i] = flip[i] != 0 ? -(1 << kPlaceShift[i]) : 1 << kPlaceShift[i];
    }
  }
};

// Rays of one direction, from wherever: what BrickRay reads of a course, and the way to start.
struct ShadowCourse {
  static constexpr Aim kAim = Aim::kShadow;
  const uint8_t* directory;
  const uint8_t* bricks;
  const uint8_t* behind_bits;  // a bit a brick of the directory: nothing solid behind it (or null)
  int32_t next_brick[3];
  uint32_t last[3];
  int32_t one_step[3];
  uint32_t d[3];       // the direction, mirrored
  int32_t cells[3];    // sides of the box
  uint32_t near_left;  // counts of bricks, were it in the box's lowest
  int c;
  unsigned mirrored;
  bool wide;

  [[gnu::always_inline]] bool is_free(int32_t at) const {
    return behind_bits != nullptr && (static_cast<uint32_t>(behind_bits[at >> 4]) >> (at >> 1 & 7) & 1U) != 0;
  }
  [[gnu::always_inline]] bool goes_down(int axis) const { return (mirrored >> axis & 1U) != 0; }

  void set(const BrickMap& map, const Vec3i& direction, const uint8_t* free_bricks) {
    directory = map.directory();
    bricks = map.bricks();
    behind_bits = free_bricks;
    c = 0;
    mirrored = 0;
    near_left = 0;
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
      cells[i] = 4 * side;
      next_brick[i] = down ? -step : step;
      near_left += static_cast<uint32_t>(down ? 511 : 512 - side) << 10 * i;
      step *= side;
    }
    wide = all >= 1U << 11;
  }
};

// A point on a face of a voxel: on each axis the voxel, from the box's lowest corner, and how far in it, in 1/256.
// Across the face it is on the voxel's plane.
struct FacePoint {
  int32_t voxel[3];
  int32_t within[3];
  int axis;
  bool faces_up;  // the face looks to larger coordinates
};

// The integer part of `dividend / divisor`, below 256, for a core without a divider.
[[gnu::always_inline]] inline uint32_t fraction_of(uint32_t dividend, uint32_t divisor) {
  if (kDivides) {
    return dividend / divisor;
  }
  uint32_t result = 0;
  divisor <<= 7;
  for (int i = 0; i < 8; ++i) {
    result <<= 1;
    if (dividend >= divisor) {
      dividend -= divisor;
      ++result;
    }
    dividend <<= 1;
  }
  return result;
}

// Finds where the ray of direction `d` (mirrored) has landed, as `start_on_face` does: what is across a ray is rounded
// down, in the world's own direction.
template <int kAxis>
void find_point(const SightCourse& course, const Vec3<uint32_t>& d, FacePoint* point) {
  const Landing& landing = course.landing;
  int32_t way[3];  // from the eye to the voxel's near plane
  for (int i = 0; i < 3; ++i) {
    const int32_t side = course.frame->side[i];
    const int32_t brick = static_cast<int32_t>(count_of(landing.left, i)) - (512 - side);
    const int32_t place = static_cast<int32_t>(landing.voxel >> 2 * i & 3U);
    const int32_t flip = static_cast<int32_t>(course.flip[i]);
    point->voxel[i] = 4 * (flip != 0 ? side - 1 - brick : brick) + place;
    way[i] = (4 * brick + (place ^ flip)) * Q8::kOne - (course.origin[i] - (i == course.c ? 0 : kOutsideQ8));
  }
  const uint32_t speed = d[kAxis];
  for (int i = 0; i < 3; ++i) {
    if (i == kAxis) {
      point->within[i] = 0;
      continue;
    }
    const uint32_t in = static_cast<uint32_t>(way[kAxis]) * d[i] - static_cast<uint32_t>(way[i]) * speed;
    THIMBLE_NOTE(Range::kBrickPlace, Exact(way[kAxis]) * Exact(d[i]));
    THIMBLE_NOTE(Range::kBrickPlace, Exact(way[i]) * Exact(speed));
    point->within[i] = course.flip[i] != 0 ? 256 - static_cast<int32_t>(fraction_of(in + speed - 1, speed))
                                           : static_cast<int32_t>(fraction_of(in, speed));
  }
  point->axis = kAxis;
  point->faces_up = course.flip[kAxis] != 0;
}
void find_point(const SightCourse& course, const Vec3<uint32_t>& d, FacePoint* point) {
  switch (course.landing.axis) {
    case 0:
      return find_point<0>(course, d, point);
    case 1:
      return find_point<1>(course, d, point);
    default:
      return find_point<2>(course, d, point);
  }
}

template <int kC>
[[gnu::noinline]] int32_t shadow_along(const ShadowCourse& course, uint32_t number, uint32_t left,
                                       int32_t cell, uint32_t place, const uint32_t (&within)[3]) {
  constexpr int kA = kOtherA<kC>;
  constexpr int kB = kOtherB<kC>;
  const uint32_t d_a = course.d[kA];
  const uint32_t d_b = course.d[kB];
  const uint32_t d_c = course.d[kC];
  BrickRay<kC, kAnySigns, ShadowCourse> ray(course, d_a, d_b, d_c);
  // Back to the plane of c before it, and on from there.
  const uint32_t rest_a = within[kA] * d_c - within[kC] * d_a - (d_c << 8);
  const uint32_t rest_b = within[kB] * d_c - within[kC] * d_b - (d_c << 8);
  ray.begin(number, left, cell, place, rest_a, rest_b);
  return ray.trace();
}

// Whether the ray from a point on a face, which it leaves, meets something solid: `any_hit` of the tree.
bool is_shadowed(const ShadowCourse& course, const FacePoint& point) {
  uint32_t within[3];
  uint32_t left = course.near_left;
  uint32_t place = 0;
  int32_t cell = 0;
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
    left += static_cast<uint32_t>((down ? -brick : brick) * (1 << 10 * i));
    cell += brick * (down ? -course.next_brick[i] : course.next_brick[i]);
    place |= (static_cast<uint32_t>(voxel) & 3U) << 2 * i;
    within[i] = in;
  }
  const uint32_t number = half_at(course.directory, cell);
  if (course.is_free(cell)) {
    if (number == 0) {
      return false;
    }
    left |= kInside;
  }
  const int32_t answer = course.c == 0   ? shadow_along<0>(course, number, left, cell, place, within)
                         : course.c == 1 ? shadow_along<1>(course, number, left, cell, place, within)
                                         : shadow_along<2>(course, number, left, cell, place, within);
  return answer != kMissed;
}

template <int kC>
[[gnu::noinline]] int32_t sight_along(const SightCourse& course, uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  return BrickRay<kC, kAnySigns, SightCourse>(course, d_a, d_b, d_c).trace();
}

// Goes through the tiles of one band, and says of each pixel what its ray meets:
//
//   miss(x, y)            nothing
//   ask(x, y)             what only the tree knows
//   hit(x, y, course, d)  `course.landing`, by the ray of direction d, mirrored
template <class Sink>
class SightPainter {
 public:
  SightPainter(const BrickFrame& frame, Sink& sink) : frame_(frame), sink_(sink) {
    course_.frame = &frame;
    course_.inks = nullptr;
    course_.directory = frame.map.directory();
    course_.bricks = frame.map.bricks();
    course_.exact_ties = false;
    course_.wide = frame.camera.direction_bits() > kNarrowDirectionBits;
    course_.most_cells = (1U << (23 - frame.camera.direction_bits())) - 1;
    course_.near_cell[0] = 0;
    course_.near_cell[1] = 0;
    set(0, 0);  // NOLINT: where rays start is set_start's
  }

  void draw_tile(const Tile& tile) {
    if (frame_.map.empty()) {
      miss(tile);
      return;
    }
    Camera::Vec3Q32 row;
    const Camera::Affine& affine = frame_.camera.affine();
    for (int axis = 0; axis < 3; ++axis) {
      row[axis] = affine.base[axis] + tile.x0 * affine.step_x[axis] + tile.y0 * affine.step_y[axis];
    }
    const Fan fan(row, frame_.tile_low, frame_.tile_high);
    int32_t slab = 0;
    if (fan.usable()) {
      use(fan.mirrored, fan.c);
      slab = first_slab_along(course_, fan, slab);
      if (slab == 4 * frame_.side[fan.c]) {
        miss(tile);
        return;
      }
    }
    for (int32_t y = tile.y0; y < tile.y1; y += kQuadDownPx) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = tile.x0; x < tile.x1; x += kQuadAcrossPx) {
        draw_quad({x, x + kQuadAcrossPx < tile.x1 ? x + kQuadAcrossPx : tile.x1, y,
                   y + kQuadDownPx < tile.y1 ? y + kQuadDownPx : tile.y1},
                  at, fan, slab);
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += kQuadAcrossPx * affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += kQuadDownPx * affine.step_y[axis];
      }
    }
  }

 private:
  void set(unsigned mirrored, int c) {
    set_course(course_, mirrored, c);
    course_.set_signs();
  }
  void use(unsigned mirrored, int c) {
    if (mirrored != course_.mirrored || c != course_.c) {
      set(mirrored, c);
    }
  }

  void miss(const Tile& tile) {
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      for (int32_t x = tile.x0; x < tile.x1; ++x) {
        sink_.miss(x, y);
      }
    }
  }

  void draw_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& tile_fan, int32_t slab) {
    const Fan fan(value, frame_.quad_low, frame_.quad_high);
    if (!fan.usable()) {
      for (int32_t y = quad.y0; y < quad.y1; ++y) {
        for (int32_t x = quad.x0; x < quad.x1; ++x) {
          sink_.ask(x, y);
        }
      }
      return;
    }
    use(fan.mirrored, fan.c);
    slab = first_slab_along(course_, fan, tile_fan.usable() && tile_fan.c == fan.c ? slab : 0);
    if (slab == 4 * frame_.side[fan.c]) {
      miss(quad);
      return;
    }
    set_start(course_, slab);
    if (fan.mixed != 0) {
      trace_mixed(quad, value, fan.c, slab);
      return;
    }
    // Mirrored and with a half the affine function is positive all over the quad, so rounding is cutting off.
    Vec3<uint64_t> row;
    for (int axis = 0; axis < 3; ++axis) {
      row[axis] = static_cast<uint64_t>((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) +
                  (uint64_t{1} << 31);
    }
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      Vec3<uint64_t> at = row;
      for (int32_t x = quad.x0; x < quad.x1; ++x) {
        trace(x, y,
              {static_cast<uint32_t>(at.x >> 32), static_cast<uint32_t>(at.y >> 32),
               static_cast<uint32_t>(at.z >> 32)});
        at.x += static_cast<uint64_t>(course_.step_x.x);
        at.y += static_cast<uint64_t>(course_.step_x.y);
        at.z += static_cast<uint64_t>(course_.step_x.z);
      }
      row.x += static_cast<uint64_t>(course_.step_y.x);
      row.y += static_cast<uint64_t>(course_.step_y.y);
      row.z += static_cast<uint64_t>(course_.step_y.z);
    }
  }

  [[gnu::always_inline]] void trace(int32_t x, int32_t y, const Vec3<uint32_t>& d) {
    const int32_t answer = course_.c == 0   ? sight_along<0>(course_, d.y, d.z, d.x)
                           : course_.c == 1 ? sight_along<1>(course_, d.x, d.z, d.y)
                                            : sight_along<2>(course_, d.x, d.y, d.z);
    if (answer == kShadowed) {
      sink_.hit(x, y, course_, d);
    } else if (answer == kMissed) {
      sink_.miss(x, y);
    } else {
      sink_.ask(x, y);
    }
  }

  // Traces a quad whose rays do not all go the same way, so each takes a course of its own.
  [[gnu::noinline]] void trace_mixed(const Tile& quad, const Camera::Vec3Q32& value, int c, int32_t slab) {
    const Camera::Affine& affine = frame_.camera.affine();
    Camera::Vec3Q32 row = value;
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = quad.x0; x < quad.x1; ++x) {
        const Vec3i d{Camera::rounded(at.x), Camera::rounded(at.y), Camera::rounded(at.z)};
        const unsigned signs = signs_of(d);
        if (signs != course_.mirrored) {
          set(signs, c);
          set_start(course_, slab);
        }
        const auto size = [](int32_t component) {
          return static_cast<uint32_t>(component < 0 ? -component : component);
        };
        trace(x, y, {size(d.x), size(d.y), size(d.z)});
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += affine.step_y[axis];
      }
    }
  }

  const BrickFrame& frame_;
  Sink& sink_;
  SightCourse course_;
};

// What the rays of a band have in common; no inks are wanted.
BrickFrame sight_frame(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                       const Shading& shading, PixelFormat format) {
  BrickFrame frame{tree, map, camera, shading, format, false, 0, {}, {}, {}, {}, {}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    frame.side[axis] = map.box().high[axis] - map.box().low[axis];
    frame.eye[axis] = camera.eye()[axis].raw - map.box().low[axis] * (4 * Q8::kOne);
  }
  frame.stride = {2, 2 * frame.side.x, 2 * frame.side.x * frame.side.y};
  margins_of(camera, kTileAcrossPx, kTileDownPx, &frame.tile_low, &frame.tile_high);
  margins_of(camera, kQuadAcrossPx, kQuadDownPx, &frame.quad_low, &frame.quad_high);
  return frame;
}

}  // namespace
}  // namespace thimble::bricks

#endif
