// Treats all rays of a tile at once: which way they go, and the first slab of voxels in which one of them may meet
// something. Internal to src/.
#pragma once

#include "../../base/ranges.h"
#include "../../base/wide_arithmetic.h"
#include "course.h"

namespace thimble::bricks {
namespace {

// A tile's directions are found with so many bits behind the point. On the picture they have 15 before it. A tile
// reaches beyond the picture by less than the picture's size, either way, so they stay below 2^(15 + 3 + 12).
constexpr int kFanBits = 12;

// The directions of a tile: for each axis the least and the greatest, and what the rays have in common.
struct Fan {
  Vec3i low;
  Vec3i high;
  int c = 0;              // the fastest axis
  unsigned mirrored = 0;  // bit a: most rays go down on axis a
  unsigned mixed = 0;     // bit a: not all rays have the same sign on axis a

  // Directions lie from value + least to value + greatest (`margins_of`).
  [[THIMBLE_HOT]] Fan(const Camera::Vec3Q32& value, const Vec3i& least, const Vec3i& greatest) {
    int32_t most = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t at = static_cast<int32_t>(value[axis] >> (32 - kFanBits));
      THIMBLE_NOTE(Range::kBrickFan, Exact(value[axis] >> (32 - kFanBits)) + Exact(least[axis]));
      THIMBLE_NOTE(Range::kBrickFan, Exact(value[axis] >> (32 - kFanBits)) + Exact(greatest[axis]));
      low[axis] = (at + least[axis]) >> kFanBits;
      high[axis] = (at + greatest[axis]) >> kFanBits;
      const int32_t sum = low[axis] + high[axis];
      if (sum < 0) {
        mirrored |= 1U << axis;
        mixed |= high[axis] >= 0 ? 1U << axis : 0U;
      } else {
        mixed |= low[axis] < 0 ? 1U << axis : 0U;
      }
      const int32_t size = sum < 0 ? -sum : sum;
      if (size > most) {
        most = size;
        c = axis;
      }
    }
  }
  // Whether all rays go the same way along c.
  bool usable() const { return (mixed >> c & 1U) == 0 && low[c] != 0; }
};

// Finds the bounds of a tile's rounded directions: what is to be added to its first pixel's affine function, both with
// kFanBits bits behind the point. The sum is cut off afterwards; one unit either way makes up for what was cut off
// before.
void margins_of(const Camera& camera, int32_t across_px, int32_t down_px, Vec3i* low, Vec3i* high) {
  const Camera::Affine& affine = camera.affine();
  across_px = across_px < camera.width_px() ? across_px : camera.width_px();
  down_px = down_px < camera.height_px() ? down_px : camera.height_px();
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t across = wide_multiple(affine.step_x[axis], across_px - 1);
    const int64_t down = wide_multiple(affine.step_y[axis], down_px - 1);
    const int64_t least = (across < 0 ? across : 0) + (down < 0 ? down : 0);
    const int64_t greatest = (across < 0 ? 0 : across) + (down < 0 ? 0 : down);
    // Halves are rounded away from zero, so half a unit below may be rounded down.
    (*low)[axis] = static_cast<int32_t>(least >> (32 - kFanBits)) + (1 << (kFanBits - 1)) - 1;
    (*high)[axis] = static_cast<int32_t>(greatest >> (32 - kFanBits)) + (1 << (kFanBits - 1)) + 2;
  }
}

// A beam's slopes are in 1/1024; times distances in 1/256 voxel they give positions in 1/2^18 voxel.
constexpr int kSlopeBits = 10;
constexpr int kCellShift = kSlopeBits + 8;
constexpr int kBrickShift = kCellShift + 2;
// A beam may be so many bricks wide. The search stops where it is wider: rays then start early, which is right.
constexpr int32_t kBeamBricks = 4;
constexpr int32_t kDeepBeamBricks = 8;  // of level 9 and 10: a word has bits for the cells of so many

// Slopes of at most 2 either way, of several rises to one run of at most 15 bits, cut off. Without a divider they take one
// division, by which they are, before that, too far from 0 by less than 1 where `away`, else too near by less than 1; code
// in fast RAM, where the compiler's library would divide, finds the 12 bits of each one by one.
class SlopeTo {
 public:
  [[gnu::always_inline]] SlopeTo(int32_t run, bool away)
      : by_(kDivides || kFastRam ? run : (1 << kRunBits) / run + (away ? 1 : 0)) {}
  [[gnu::always_inline]] int32_t operator()(int32_t rise) const {
    return kDivides   ? rise * (1 << kSlopeBits) / by_
           : kFastRam ? by_bits(rise, by_)
                      : rise * by_ >> (kRunBits - kSlopeBits);
  }

 private:
  static constexpr int kRunBits = 28;
  [[THIMBLE_HOT]] static int32_t by_bits(int32_t rise, int32_t run) {
    uint32_t rest = static_cast<uint32_t>(rise < 0 ? -rise : rise) << kSlopeBits;
    int32_t quotient = 0;
#pragma GCC unroll 12
    for (int bit = kSlopeBits + 1; bit >= 0; --bit) {
      const uint32_t part = static_cast<uint32_t>(run) << bit;
      if (rest >= part) {
        rest -= part;
        quotient += 1 << bit;
      }
    }
    return rise < 0 ? -quotient : quotient;
  }

  int32_t by_;  // 2^28 by the run, or the run
};

// The interval of one axis that all rays of a fan stay in within a slab of voxels, in the box's own coordinates.
struct Shadow {
  int32_t low;
  int32_t high;
  int32_t low_step;  // to the next slab
  int32_t high_step;
  int32_t low_more;  // what a further slab adds to the shadow at its lower end, at most 0
  int32_t high_more;

  void advance(int32_t voxels) {
    low += voxels * low_step;
    high += voxels * high_step;
  }
  // The first and the last brick of the next `voxels` slabs.
  int32_t first_brick(int32_t voxels) const {
    const int32_t first = (low + (voxels - 1) * low_more) >> kBrickShift;
    return first < 0 ? 0 : first;
  }
  int32_t last_brick(int32_t voxels) const { return (high + (voxels - 1) * high_more) >> kBrickShift; }
  // The cells of this slab as bits, from cell `base` on. The last cell is below base + 32; both ends may
  // be negative.
  uint32_t cells_from(int32_t base) const {
    const int32_t from = (low >> kCellShift) - base;
    const int32_t to = (high >> kCellShift) - base;
    const int32_t first = from < 0 ? 0 : from;
    return to < first ? 0U : (2U << to) - (1U << first);
  }
};

// The fan along c: slopes to its slowest and to its fastest ray, the distance from the origin to the first slab's plane
// (negative where that lies behind it), and the same distance, but not below 0.
struct AlongC {
  SlopeTo slow;
  SlopeTo fast;
  int32_t plane;
  int32_t ahead;
};

// Finds a fan's shadow on one axis. Where the first slab begins behind the origin, each bound starts from the plane or
// from the origin, whichever is wider.
[[gnu::always_inline]] inline Shadow shadow_of(const BrickFrame& frame, const Fan& fan, const AlongC& c,
                                               int axis) {
  const int32_t low = component(fan.low, axis);
  const int32_t high = component(fan.high, axis);
  const int32_t low_slope = (low < 0 ? c.slow : c.fast)(low)-1;
  const int32_t high_slope = (high < 0 ? c.fast : c.slow)(high) + 1;
  const int32_t from = component(frame.eye, axis) * (1 << kSlopeBits);
  const int32_t low_step = low_slope * Q8::kOne;
  const int32_t high_step = high_slope * Q8::kOne;
  const int32_t low_more = low_step < 0 ? low_step : 0;
  const int32_t high_more = high_step > 0 ? high_step : 0;
  THIMBLE_NOTE(Range::kBrickSlope, Exact(low_slope < 0 ? c.ahead : c.plane) * Exact(low_slope));
  THIMBLE_NOTE(Range::kBrickSlope, Exact(high_slope < 0 ? c.plane : c.ahead) * Exact(high_slope));
  return Shadow{from + (low_slope < 0 ? c.ahead : c.plane) * low_slope - 1 + low_more,
                from + (high_slope < 0 ? c.plane : c.ahead) * high_slope + 1 + high_more,
                low_step,
                high_step,
                low_more,
                high_more};
}

// kRows moves bit y of four to bit 4 y; kHalves makes bit z of two all of halfword z.
constexpr uint16_t kRows[16] = {0x0000, 0x0001, 0x0010, 0x0011, 0x0100, 0x0101, 0x0110, 0x0111,
                                0x1000, 0x1001, 0x1010, 0x1011, 0x1100, 0x1101, 0x1110, 0x1111};
constexpr uint32_t kHalves[4] = {0, 0xFFFFU, 0xFFFF0000U, 0xFFFFFFFFU};

// A brick in the way of a beam, and where its cells begin, counted from the beam's first cell.
struct NearBrick {
  const uint8_t* bits;
  int32_t a;
  int32_t b;
};

// Whether the brick's layer `own` on c has a solid voxel among the cells that are set in `in_a` and `in_b`.
[[gnu::always_inline]] inline bool any_solid(const uint8_t* bits, int c, uint32_t own, uint32_t in_a,
                                             uint32_t in_b) {
  if (c == 2) {
    return (half_at(bits, static_cast<int32_t>(2 * own)) & (in_a * kRows[in_b])) != 0;
  }
  const uint32_t rows = (word_at(bits, 0) & kHalves[in_b & 3U]) | (word_at(bits, 4) & kHalves[in_b >> 2]);
  const uint32_t wanted = c == 1 ? in_a << 4 * own : static_cast<uint32_t>(kRows[in_a]) << own;
  return ((rows | rows >> 16) & wanted) != 0;
}

// Whether slab `slab` begins a layer of pages, and those under the shadow are empty.
constexpr int32_t kPageVoxels = 4 * deep_place::kPageSide;
template <int kC>
bool has_empty_layer(const DeepCourse& course, const Shadow& a, const Shadow& b, int32_t slab) {
  const Vec3i& side = course.frame->side;
  const bool flipped = (course.mirrored >> kC & 1U) != 0;
  const int32_t layer = flipped ? side[kC] - 1 - (slab >> 2) : slab >> 2;
  if ((slab & 3) != 0 || (layer & 3) != (flipped ? 3 : 0) || slab + kPageVoxels > 4 * side[kC]) {
    return false;
  }
  Vec3i low;
  Vec3i high;
  low[kC] = layer;
  high[kC] = layer;
  const auto set = [&](int axis, const Shadow& shadow) {
    const int32_t last = shadow.last_brick(kPageVoxels);
    low[axis] = shadow.first_brick(kPageVoxels);
    high[axis] = last < side[axis] ? last : side[axis] - 1;
  };
  set(kOtherA<kC>, a);
  set(kOtherB<kC>, b);
  return has_empty_pages(course.directory, course.empty_page, low, high);
}

// Finds the first slab of voxels from `slab` on in which rays of `fan` may meet something, or the number of slabs when
// there is none. Sets `waiting` of the fan's course: whether rays may still be outside of the box at that slab; and `far`.
// kC is kAnyAxis where one function serves all courses.
template <int kC, bool kDeep>
[[gnu::noinline, THIMBLE_HOT]] int32_t first_slab(Course& course, const Fan& fan, int32_t slab) {
  const int along = kC == kAnyAxis ? course.c : kC;
  const int axis_a = other_a(along);
  const int axis_b = other_b(along);
  constexpr int32_t kMost = kDeep ? kDeepBeamBricks : kBeamBricks;
  course.waiting = kWaiting;
#ifdef THIMBLE_FAST_RAM
  course.far = true;
#endif
  const BrickFrame& frame = *course.frame;
  const int32_t slabs = 4 * component(frame.side, along);
  const int32_t origin = course.origin[along];
  const int32_t nearest = origin < 0 ? 0 : origin >> 8;
  slab = slab < nearest ? nearest : slab;
  if (slab >= slabs) {
    return slabs;
  }
  const bool flipped = (course.mirrored >> along & 1U) != 0;
  const int32_t plane = slab * Q8::kOne - origin;
  const int32_t slow = flipped ? -component(fan.high, along) : component(fan.low, along);
  if (component(fan.high, axis_a) > 2 * slow || component(fan.low, axis_a) < -2 * slow ||
      component(fan.high, axis_b) > 2 * slow || component(fan.low, axis_b) < -2 * slow) {
    return slab;
  }
  const AlongC c{SlopeTo(slow, true),
                 SlopeTo(flipped ? -component(fan.low, along) : component(fan.high, along), false), plane,
                 plane < 0 ? 0 : plane};
  Shadow a = shadow_of(frame, fan, c, axis_a);
  Shadow b = shadow_of(frame, fan, c, axis_b);
  const int32_t last_a = component(frame.side, axis_a) - 1;
  const int32_t last_b = component(frame.side, axis_b) - 1;
  const int32_t stride_a = component(frame.stride, axis_a);
  const int32_t stride_b = component(frame.stride, axis_b);
  const uint8_t* directory = course.directory;
  while (slab < slabs) {
    if constexpr (kDeep) {
      if (has_empty_layer<kC>(static_cast<DeepCourse&>(course), a, b, slab)) {
        a.advance(kPageVoxels);
        b.advance(kPageVoxels);
        slab += kPageVoxels;
        continue;
      }
    }
    // How many slabs of this layer of bricks are left, and which of its bricks the rays may pass.
    const int32_t voxels = 4 - (slab & 3);
    const int32_t from_a = a.first_brick(voxels);
    const int32_t from_b = b.first_brick(voxels);
    int32_t to_a = a.last_brick(voxels);
    int32_t to_b = b.last_brick(voxels);
    if (to_a - from_a >= kMost || to_b - from_b >= kMost) {
      return slab;
    }
    to_a = to_a > last_a ? last_a : to_a;
    to_b = to_b > last_b ? last_b : to_b;
    // Keeps the bricks that are not empty.
    NearBrick bricks[size_t{kMost * kMost}];
    NearBrick* bricks_end = bricks;
    const int32_t layer = flipped ? component(frame.side, along) - 1 - (slab >> 2) : slab >> 2;
    int32_t row = layer * component(frame.stride, along) + from_b * stride_b + from_a * stride_a;
    for (int32_t j = from_b; j <= to_b; ++j, row += stride_b) {
      int32_t cell = row;
      for (int32_t i = from_a; i <= to_a; ++i, cell += stride_a) {
        const uint32_t number = number_at<kDeep>(directory, cell);
        if (number != 0) {
          *bricks_end++ = {course.bricks + 8 * number, 4 * (i - from_a), 4 * (j - from_b)};
        }
      }
    }
    if (bricks_end == bricks) {
      a.advance(voxels);
      b.advance(voxels);
      slab += voxels;
      continue;
    }
    const int32_t base_a = 4 * from_a;
    const int32_t base_b = 4 * from_b;
    for (const int32_t end = slab + voxels; slab < end; ++slab, a.advance(1), b.advance(1)) {
      const uint32_t cells_a = a.cells_from(base_a);
      const uint32_t cells_b = b.cells_from(base_b);
      const uint32_t own = (static_cast<uint32_t>(slab) & 3U) ^ course.flip[along];
      for (const NearBrick* near = bricks; near != bricks_end; ++near) {
        if (any_solid(near->bits, along, own, cells_a >> near->a & 15U, cells_b >> near->b & 15U)) {
          // Where both ends are within the box no ray waits outside.
          const bool outside =
              a.low < 0 || b.low < 0 || a.high >> kBrickShift > last_a || b.high >> kBrickShift > last_b;
          course.waiting = outside ? kWaiting : 0;
#ifdef THIMBLE_FAST_RAM
          course.far = false;
#endif
          return slab;
        }
      }
    }
  }
  return slabs;
}

template <bool kDeep = false>
int32_t first_slab_along(Course& course, const Fan& fan, int32_t slab) {
  if constexpr (kFastRam && !kDeep) {
    return first_slab<kAnyAxis, false>(course, fan, slab);
  }
  return course.c == 0   ? first_slab<0, kDeep>(course, fan, slab)
         : course.c == 1 ? first_slab<1, kDeep>(course, fan, slab)
                         : first_slab<2, kDeep>(course, fan, slab);
}

}  // namespace
}  // namespace thimble::bricks
