// Water for a ray: a walk over columns, from where the ray meets the box of the water.
//
// x and y are mirrored where the direction is negative, so that every walk goes up; z is not, as heights have
// only one end that moves. "Plane at distance n along a direction d" is crossed at t = n / (256 * d); the 256
// is common to all and left out until the hit.
#include "thimble/light/water.h"

#include "../base/bits.h"
#include "../base/integers.h"
#include "../base/wide_arithmetic.h"

namespace thimble {
namespace {

constexpr int32_t kNormalLength = int32_t{1} << 14;
constexpr int32_t kSteepest = int32_t{1} << 17;  // a slope of 2, in 1/65536

// t = distance / speed, speed > 0. Distances are below 2^23 and speeds below 2^20 in magnitude, so a cross
// product is below 2^43.
struct Time {
  int32_t distance = 0;
  int32_t speed = 1;
};
constexpr bool before(const Time& a, const Time& b) {
  return is_product_less(a.distance, b.speed, b.distance, a.speed);
}
constexpr bool same(const Time& a, const Time& b) {
  return wide_product(a.distance, b.speed) == wide_product(b.distance, a.speed);
}
constexpr Time later(const Time& a, const Time& b) {
  return before(a, b) ? b : a;
}

struct WaterWalk {
  const WaterSurface& water;
  // Relative to the corner; x and y mirrored; in 1/256 voxel.
  int32_t place[3];
  int32_t speed[3];  // magnitudes
  bool mirrored[2];
  bool down;  // z is not mirrored
  // Where the walk is: column in mirrored numbers, its height, and when it was entered, x and y alone.
  int32_t cell[2];
  int32_t height;
  Time since;
  uint32_t visits;

  WaterWalk(const WaterSurface& surface, const Vec3Q8& origin, const Vec3i& direction)
      : water(surface), down(direction.z < 0), cell{0, 0}, height(0), visits(0) {
    for (int axis = 0; axis < 3; ++axis) {
      speed[axis] = absolute(direction[axis]);
      place[axis] = origin[axis].raw - 256 * surface.corner[axis];
    }
    for (int axis = 0; axis < 2; ++axis) {
      mirrored[axis] = direction[axis] < 0;
      if (mirrored[axis]) {
        place[axis] = 256 * side(axis) - place[axis];
      }
    }
  }

  int32_t side(int axis) const { return axis == 0 ? water.width : water.depth; }
  int32_t column(int axis) const { return mirrored[axis] ? side(axis) - 1 - cell[axis] : cell[axis]; }
  // Way to the plane at which the ray enters, or leaves, a column `top` high along an axis.
  int32_t way_in(int axis, int32_t top) const {
    if (axis < 2) {
      return 256 * cell[axis] - place[axis];
    }
    return down ? place[2] - top : -place[2];
  }
  int32_t way_out(int axis, int32_t top) const {
    if (axis < 2) {
      return 256 * (cell[axis] + 1) - place[axis];
    }
    return down ? place[2] : top - place[2];
  }

  void look() {
    ++visits;
    height = water.height_q8(column(0), column(1));
  }

  // The box of columns `top` high: when the ray enters it (t = 0 or later) and whether it spends a positive
  // length in it at all.
  bool clip(int32_t top, Time* enters) const {
    Time in;
    Time out;
    bool ends = false;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t size = axis < 2 ? 256 * side(axis) : top;
      if (speed[axis] == 0) {
        if (place[axis] < 0 || place[axis] >= size) {
          return false;
        }
        continue;
      }
      const bool falls = axis == 2 && down;
      in = later(in, {falls ? place[2] - size : -place[axis], speed[axis]});
      const Time leaves{falls ? place[2] : size - place[axis], speed[axis]};
      if (!ends || before(leaves, out)) {
        out = leaves;
        ends = true;
      }
    }
    *enters = in;
    return before(in, out);
  }

  // Goes to the column in which the ray is just after `time`, or just before it; it is within the columns
  // then. The quotient is a column's number, so at most twelve bits of it are all: no division.
  void start(const Time& time, bool just_before) {
    since = time;
    for (int axis = 0; axis < 2; ++axis) {
      // Where the ray is, times time.speed: 0 .. 2^20 * 2^20, made of two products below 2^43.
      int64_t rest = wide_product(place[axis], time.speed) + wide_product(speed[axis], time.distance);
      // Just before a plane is the column below it: ceil - 1 of the quotient, for integers.
      rest -= just_before && speed[axis] != 0 ? 1 : 0;
      int32_t number = 0;
      for (int bit = bits::bit_length(static_cast<uint32_t>(side(axis) - 1)) - 1; bit >= 0; --bit) {
        // Without a branch, which nobody could predict: all ones where the part fits.
        const int64_t left = rest - (int64_t{time.speed} << (bit + 8));
        const int64_t fits = ~(left >> 63);
        rest += (left - rest) & fits;
        number |= (int32_t{1} << bit) & static_cast<int32_t>(fits);
      }
      cell[axis] = number;
    }
    look();
  }

  // Where every column holds water, what lies below the lowest surface need not be walked: goes to the last
  // column before the ray comes up to that height or ends at the box. Called in the water.
  void skip_depths() {
    const int32_t lowest = water.lowest_q8;
    if (water.has_blocked) {
      return;
    }
    Time end;
    bool ends = speed[2] != 0;
    if (ends && down) {
      if (before(since, {place[2] - lowest, speed[2]})) {
        return;
      }
      end = {place[2], speed[2]};
    } else if (ends) {
      end = {lowest - place[2], speed[2]};
    } else if (place[2] >= lowest) {
      return;
    }
    for (int axis = 0; axis < 2; ++axis) {
      const Time leaves{256 * side(axis) - place[axis], speed[axis]};
      if (speed[axis] != 0 && (!ends || before(leaves, end))) {
        end = leaves;
        ends = true;
      }
    }
    if (before(since, end)) {
      start(end, true);
    }
  }

  // When the ray leaves the column through its sides; false when never.
  bool side_time(Time* time) const {
    if (speed[0] == 0 && speed[1] == 0) {
      return false;
    }
    const Time x{way_out(0, 0), speed[0]};
    const Time y{way_out(1, 0), speed[1]};
    *time = speed[0] == 0 ? y : speed[1] == 0 || before(x, y) ? x : y;
    return true;
  }
  // Into the next column, across an edge or a corner, at `time` (its side_time). False: beyond the last one.
  bool step(const Time& time) {
    since = time;
    for (int axis = 0; axis < 2; ++axis) {
      if (speed[axis] != 0 && same({way_out(axis, 0), speed[axis]}, time)) {
        ++cell[axis];
      }
    }
    if (cell[0] >= water.width || cell[1] >= water.depth) {
      return false;
    }
    look();
    return true;
  }

  // Whether the ray, in this column from `since` on, is at `since` at a height where it is in the water.
  bool in_water() const {
    if (height <= 0) {
      return false;
    }
    if (speed[2] == 0) {
      return place[2] >= 0 && place[2] < height;
    }
    return !before(since, {way_in(2, height), speed[2]}) && before(since, {way_out(2, height), speed[2]});
  }
  // Whether it spends a positive length in this column's water before `until` (null: ever).
  bool meets(const Time* until) const {
    if (height <= 0) {
      return false;
    }
    if (speed[2] == 0) {
      return place[2] >= 0 && place[2] < height;
    }
    const Time in = later(since, {way_in(2, height), speed[2]});
    return before(in, {way_out(2, height), speed[2]}) && (until == nullptr || before(in, *until));
  }

  // Writes the face of this column that is crossed at `time`.
  void report(const Time& time, bool leaving, WaterHit* hit) const {
    hit->visits = visits;
    hit->column_x = column(0);
    hit->column_y = column(1);
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t way = leaving ? way_out(axis, height) : way_in(axis, height);
      if (speed[axis] != 0 && same({way, speed[axis]}, time)) {
        const bool negative = axis < 2 ? mirrored[axis] : down;
        hit->axis = static_cast<int8_t>(axis);
        hit->side = negative == leaving ? int8_t{-1} : int8_t{1};
        hit->t_numerator = way;
        hit->t_denominator = 256 * speed[axis];
        return;
      }
    }
  }
};

// Whether the ray is in the water from t = 0 on; the walk then stands in its first column.
bool starts_inside(WaterWalk& walk) {
  Time enters;
  if (!walk.clip(walk.water.highest_q8, &enters) || enters.distance > 0) {
    return false;
  }
  walk.start({0, 1}, false);
  return walk.in_water();
}

// Slope of the surface in a column along an axis, in 1/65536, within +-2. A neighbour that holds no water
// does not count.
int32_t slope_at(const WaterSurface& water, int32_t x, int32_t y, int axis) {
  const int32_t here = water.height_q16(x, y);
  const int32_t dx = axis == 0 ? 1 : 0;
  const int32_t dy = axis == 1 ? 1 : 0;
  const bool has_low = axis == 0 ? x > 0 : y > 0;
  const bool has_high = axis == 0 ? x + 1 < water.width : y + 1 < water.depth;
  int32_t low = has_low ? water.height_q16(x - dx, y - dy) : -1;
  int32_t high = has_high ? water.height_q16(x + dx, y + dy) : -1;
  const int32_t columns = (low >= 0 ? 1 : 0) + (high >= 0 ? 1 : 0);
  low = low >= 0 ? low : here;
  high = high >= 0 ? high : here;
  const int32_t rise = high - low;
  const int32_t size = absolute(rise) >> (columns == 2 ? 1 : 0);
  const int32_t slope = size > kSteepest ? kSteepest : size;
  return rise < 0 ? -slope : slope;
}

// The column nearest to `place`.
constexpr int32_t nearest_column(int32_t place, int32_t count) {
  return place < 0 ? 0 : place >= count ? count - 1 : place;
}

}  // namespace

Vec3i water_normal(const WaterSurface& surface, Q8 x, Q8 y) {
  Vec3i normal{0, 0, kNormalLength};
  if (surface.heights_q16 == nullptr) {
    return normal;
  }
  const int32_t at[2] = {x.raw - 256 * surface.corner.x, y.raw - 256 * surface.corner.y};
  const int32_t own[2] = {nearest_column(at[0] >> 8, surface.width),
                          nearest_column(at[1] >> 8, surface.depth)};
  // The four columns around the point, by their centres.
  const int32_t first[2] = {(at[0] - 128) >> 8, (at[1] - 128) >> 8};
  const int32_t share[2] = {(at[0] - 128) & 255, (at[1] - 128) & 255};
  int64_t sum[2] = {0, 0};
  for (int corner = 0; corner < 4; ++corner) {
    int32_t column[2] = {0, 0};
    int32_t weight = 1;
    for (int axis = 0; axis < 2; ++axis) {
      const bool far = (corner >> axis & 1) != 0;
      column[axis] = nearest_column(first[axis] + (far ? 1 : 0), axis == 0 ? surface.width : surface.depth);
      weight *= far ? share[axis] : 256 - share[axis];
    }
    const bool counts = surface.height_q16(column[0], column[1]) >= 0;
    for (int axis = 0; axis < 2; ++axis) {
      // Weights are 2^16 together, slopes at most 2^17.
      sum[axis] += wide_product(
          weight, slope_at(surface, counts ? column[0] : own[0], counts ? column[1] : own[1], axis));
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    // From 2^-32 to 2^-14, towards zero, so that a mirrored surface has the mirrored normal.
    const int32_t slope = static_cast<int32_t>((sum[axis] < 0 ? -sum[axis] : sum[axis]) >> 18);
    normal[axis] = sum[axis] < 0 ? slope : -slope;
  }
  return normal;
}

bool water_enter(const WaterSurface& surface, const Ray& ray, WaterHit* hit) {
  hit->visits = 0;
  WaterWalk walk(surface, ray.origin, ray.direction);
  Time enters;
  if (!walk.clip(surface.highest_q8, &enters)) {
    return false;
  }
  walk.start(enters, false);
  const int32_t limit = surface.width + surface.depth;
  for (int32_t count = 0; count <= limit; ++count) {
    Time until;
    const bool ends = walk.side_time(&until);
    if (walk.meets(ends ? &until : nullptr)) {
      Time in = walk.since;
      if (walk.speed[2] != 0) {
        in = later(in, {walk.way_in(2, walk.height), walk.speed[2]});
      }
      if (in.distance <= 0) {
        hit->visits = walk.visits;
        hit->column_x = walk.column(0);
        hit->column_y = walk.column(1);
        hit->axis = -1;
        hit->side = 0;
        hit->t_numerator = 0;
        hit->t_denominator = 1;
        return true;
      }
      walk.report(in, false, hit);
      return true;
    }
    if (!ends || !walk.step(until)) {
      break;
    }
  }
  hit->visits = walk.visits;
  return false;
}

bool water_leave(const WaterSurface& surface, const Ray& ray, WaterHit* hit) {
  hit->visits = 0;
  WaterWalk walk(surface, ray.origin, ray.direction);
  if (!starts_inside(walk)) {
    hit->visits = walk.visits;
    return false;
  }
  const int32_t limit = surface.width + surface.depth;
  for (int32_t count = 0; count <= limit; ++count) {
    walk.skip_depths();
    Time until;
    const bool ends = walk.side_time(&until);
    if (walk.speed[2] != 0) {
      const Time out{walk.way_out(2, walk.height), walk.speed[2]};
      if (!ends || before(out, until)) {
        walk.report(out, true, hit);
        return true;
      }
    }
    // The column is left through a side: into water or out of it.
    WaterWalk next = walk;
    if (!next.step(until) || !next.in_water()) {
      walk.visits = next.visits;
      walk.report(until, true, hit);
      return true;
    }
    walk.visits = next.visits;
    walk.cell[0] = next.cell[0];
    walk.cell[1] = next.cell[1];
    walk.height = next.height;
    walk.since = next.since;
  }
  return false;
}

bool water_holds(const WaterSurface& surface, const Vec3Q8& point, const Vec3i& direction) {
  WaterWalk walk(surface, point, direction);
  return starts_inside(walk);
}

}  // namespace thimble
