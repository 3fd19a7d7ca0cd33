// Draws a tile face by face, nearest faces first: for pictures in which a face covers several pixels. Internal to src/;
// src/picture/BRICKS.md derives it.
#pragma once

#include "../../base/bits.h"
#include "beam.h"
#include "brick_ray.h"
#include "exposed.h"
#include "half_plane.h"
#include "tile_store.h"

// How many half-planes of a tile are kept in each of the three families: 4, 8 or 16; 0 leaves the sweep out.
#ifdef THIMBLE_SMALL_FRAMES
#define THIMBLE_SWEEP_SLOTS 0
#elif !defined(THIMBLE_SWEEP_SLOTS)
#define THIMBLE_SWEEP_SLOTS 16
#endif

namespace thimble::bricks {
namespace {

constexpr int kSlots = THIMBLE_SWEEP_SLOTS;
constexpr int kPlanes = kSlots == 0 ? 1 : 3 * kSlots;
constexpr uint32_t kNoKey = UINT32_MAX;
constexpr uint8_t kNoCourse = UINT8_MAX;
// How many bricks' faces are kept.
constexpr int kExposedKept = kSlots == 0 ? 1 : kSlots;
// Where more voxels of a slab lie under a tile's shadow, the rest of the tile is drawn by rays; but not in thin worlds as
// long as at most so many of them are solid. (On an ARM7 a ray takes longer beside a face: 28 gives 9 per cent more.)
constexpr int32_t kMostCells = kFastRam ? 64 : 28;
constexpr int32_t kMostSolid = 2;
// A world is thin where the bricks hold so many voxels on average, or fewer.
constexpr int32_t kThinBrick = 6;

// The interval that a tile's rays take on a or b within a slab, in 1/2^kCellShift voxel, mirrored: from `low` at the
// slab's near plane to `high` at its far one.
struct Reach {
  int32_t low;
  int32_t high;
  int32_t low_step;
  int32_t high_step;
};

[[gnu::noinline, gnu::cold, maybe_unused]] int32_t voxels_of(const uint8_t* bricks, uint32_t number) {
  const int32_t at = 8 * static_cast<int32_t>(number);
  return static_cast<int32_t>(bits::popcount32(word_at(bricks, at)) +
                              bits::popcount32(word_at(bricks, at + 4)));
}

// Whether the world is thin, by eight of its bricks.
[[maybe_unused]] bool is_thin(const BrickMap& map) {
  const uint32_t step = map.brick_count() / 8;
  int32_t room = 8 * kThinBrick;
  for (uint32_t number = step; step != 0 && number < map.brick_count() && room >= 0; number += step) {
    room -= voxels_of(map.bricks(), number);
  }
  return room >= 0;
}

// What the sweep keeps while it draws a tile, and from tile to tile of a band.
struct Sweep {
  TileRays rays;
  Pixels left;            // pixels that are not drawn yet
  uint32_t key[kPlanes];  // of the planes
  HalfPlane plane[kPlanes];
  Exposed exposed[kExposedKept];
  uint8_t course;     // the course (axis c and signs) whose bricks are kept, or kNoCourse
  bool thin;          // whether the world is
  int32_t origin[3];  // of the rays, on a, b and c
  int32_t base;       // the first brick's offset in the directory
  int32_t side[3];
  int32_t stride[3];
  int place_shift[3];  // of a voxel's place on a, b and c among the six bits of its place in the brick
  uint32_t flip;       // of these bits, where axes are mirrored
  uint32_t misses;
  RenderCounts* counts;
  SplitQ32 step_x[3];  // a direction's change from pixel to pixel
  SplitQ32 step_y[3];

  void begin(const BrickMap& map) {
    course = kNoCourse;
    thin = kSlots != 0 && is_thin(map);
  }
  void forget_bricks() {
    for (Exposed& kept : exposed) {
      kept.place = -1;
    }
  }
  void forget_planes() {
#pragma GCC unroll 8
    for (uint32_t& kept : key) {
      kept = kNoKey;
    }
  }
  void set_left(int32_t across, int32_t down) {
    const uint32_t row = 0xFFFFU >> (kTileAcrossPx - across);
    for (int32_t i = 0; i < kTileWords; ++i) {
      left.word[i] = (2 * i < down ? row : 0) | (2 * i + 1 < down ? row << 16 : 0);
    }
  }
  // Whether no pixel is drawn yet of the quad whose first pixel is (x, y) in the tile.
  bool has_quad(int32_t x, int32_t y) const {
    return (left.word[y >> 1] >> x & 1U) != 0;
  }
  bool done() const {
    return left.columns() == 0;
  }
};

// The families of half-planes: axis a against c, b against c, a against b.
enum Family { kAc = 0, kBc = 1, kAb = 2 };
constexpr int kFirstAxis[3] = {0, 1, 0};
constexpr int kSecondAxis[3] = {2, 2, 1};

int32_t distance_of(const Sweep& sweep, int k, int32_t plane) {
  return plane * Q8::kOne - sweep.origin[k];
}

// The half-plane of the rays that meet plane `i` of a family's first axis before plane `j` of its second.
template <bool kDeep>
[[gnu::always_inline]] inline const HalfPlane& half_plane(Sweep& sweep, Family family, int32_t i, int32_t j) {
  constexpr int kAcross = kSlots >= 16 ? 8 : kSlots >= 8 ? 4 : 2;
  constexpr int kAlong = kSlots / (kAcross == 0 ? 1 : kAcross);
  const uint32_t key = static_cast<uint32_t>(i) | static_cast<uint32_t>(j) << 16;
  const int slot = family * kSlots + (i & (kAcross - 1)) * kAlong + (j & (kAlong - 1));
  HalfPlane& kept = sweep.plane[slot];
  if (sweep.key[slot] != key) {
    sweep.key[slot] = key;
    find_half_plane<kDeep>(sweep.rays, kFirstAxis[family], kSecondAxis[family],
                           distance_of(sweep, kFirstAxis[family], i),
                           distance_of(sweep, kSecondAxis[family], j), &kept);
  }
  return kept;
}

// The direction of a tile's first pixel on a, b and c, mirrored, and a half: rounding is cutting off.
struct FirstDirection {
  SplitQ32 on[3];
};

FirstDirection first_direction(const Course& course, const Camera::Vec3Q32& value) {
  FirstDirection first;
  for (int k = 0; k < 3; ++k) {
    const int axis = course.axis[k];
    const int64_t own = component(value, axis);
    first.on[k] = split((course.mirrored >> axis & 1U) != 0 ? -own : own);
    first.on[k].high += 1U << 15;
  }
  return first;
}

// Finds a pixel's exact direction on a, b and c; the pixel's ray has the course's signs.
[[THIMBLE_HOT]] void find_direction(const Sweep& sweep, const FirstDirection& first, uint32_t pixel,
                                    uint32_t (&d)[3]) {
  const uint32_t x = pixel & (kTileAcrossPx - 1);
  const uint32_t y = pixel / kTileAcrossPx;
#pragma GCC unroll(kFastRam ? 1 : 3)
  for (int k = 0; k < 3; ++k) {
    const SplitQ32& step_x = sweep.step_x[k];
    const SplitQ32& step_y = sweep.step_y[k];
    const uint32_t low = first.on[k].low + x * step_x.low + y * step_y.low;
    d[k] = (first.on[k].high + x * step_x.high + y * step_y.high + (low >> 16)) >> 16;
  }
}

// Returns where a ray meets the plane of a face: 1 inside of the face, -1 outside, 0 on one of its edges.
template <bool kDeep>
int place_on_face(const Sweep& sweep, int k, const int32_t (&cell)[3], const uint32_t (&d)[3]) {
  using Whole = WholeOf<kDeep>;
  const Whole s_k = distance_of(sweep, k, cell[k]);
  const auto d_k = static_cast<int32_t>(d[k]);
  int result = 1;
  for (int m = 0; m < 3; ++m) {
    if (m == k) {
      continue;
    }
    const int32_t near_m = distance_of(sweep, m, cell[m]);
    const int32_t far_m = near_m + Q8::kOne;
    if (far_m <= 0) {
      return -1;
    }
    const Whole before = Whole{far_m} * d_k - s_k * static_cast<int32_t>(d[m]);
    const Whole after = near_m <= 0 ? 1 : Whole{Q8::kOne} * d_k - before;
    if (after < 0 || before < 0) {
      return -1;
    }
    result = after == 0 || before == 0 ? 0 : result;
  }
  return result;
}

// Traces the ray of direction `d` from where the course starts.
template <class OneCourse>
int32_t trace_turned(const OneCourse& course, const uint32_t (&d)[3]) {
  return course.c == 0   ? trace_by_signs<0>(course, d[0], d[1], d[2])
         : course.c == 1 ? trace_by_signs<1>(course, d[0], d[1], d[2])
                         : trace_by_signs<2>(course, d[0], d[1], d[2]);
}

// Chooses how many bits behind the point a band's directions have. Returns false where those of a tile differ too much
// for the least number of bits.
bool set_steps(const Camera& camera, Sweep* sweep) {
  const Camera::Affine& affine = camera.affine();
  int64_t most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t x = affine.step_x[axis] < 0 ? -affine.step_x[axis] : affine.step_x[axis];
    const int64_t y = affine.step_y[axis] < 0 ? -affine.step_y[axis] : affine.step_y[axis];
    const int64_t here = wide_multiple(kTileAcrossPx - 1, x) + wide_multiple(kTileDownPx - 1, y);
    most = here > most ? here : most;
  }
  constexpr int kMostBits = 12;
  constexpr int kLeastBits = 4;
  const int32_t whole = static_cast<int32_t>(most >> 32) + 2;  // 2: for `rest`, and for what was cut off
  int bits = kMostBits;
  while (bits >= kLeastBits && whole >= (1 << 15 >> bits)) {
    --bits;
  }
  if (bits < kLeastBits) {
    return false;
  }
  TileRays& rays = sweep->rays;
  rays.fraction_bits = bits;
  rays.unit = (1 << (bits - 1)) + (kTileAcrossPx + kTileDownPx) / 2;
  rays.reach = whole << bits;
  return true;
}

// Sets the sweep to a course.
void set_sweep_course(const Course& course, Sweep* sweep) {
  const unsigned id = course.mirrored << 2 | static_cast<unsigned>(course.c);
  if (sweep->course == id) {
    return;
  }
  sweep->course = static_cast<uint8_t>(id);
  sweep->forget_bricks();
  sweep->base = 0;
  sweep->flip = 0;
  for (int k = 0; k < 3; ++k) {
    const int axis = course.axis[k];
    const bool flipped = (course.mirrored >> axis & 1U) != 0;
    sweep->place_shift[k] = 2 * axis;
    sweep->flip |= flipped ? 3U << 2 * axis : 0;
    sweep->side[k] = course.frame->side[axis];
    sweep->stride[k] = course.stride[axis];
    sweep->origin[k] = course.origin[axis] - (k == 2 ? 0 : kOutsideQ8);
    sweep->base -= flipped ? (sweep->side[k] - 1) * course.stride[axis] : 0;
    sweep->step_x[k] = split(course.step_x[axis]);
    sweep->step_y[k] = split(course.step_y[axis]);
    const int cut = 16 - sweep->rays.fraction_bits;
    const auto rounded = [cut](const SplitQ32& step) {
      return (static_cast<int32_t>(step.high) + (1 << (cut - 1))) >> cut;
    };
    sweep->rays.step_x[k] = rounded(sweep->step_x[k]);
    sweep->rays.step_y[k] = rounded(sweep->step_y[k]);
  }
}

// Sets the sweep to a tile of `across` by `down` pixels.
void set_tile(const FirstDirection& first, int32_t across, int32_t down, Sweep* sweep) {
  TileRays& rays = sweep->rays;
  for (int k = 0; k < 3; ++k) {
    const uint32_t own = first.on[k].high - (1U << 15);
    rays.base[k] = static_cast<int32_t>(own) >> 16;
    rays.rest[k] = static_cast<int32_t>((own & 0xFFFFU) >> (16 - rays.fraction_bits));
  }
  sweep->forget_planes();
  sweep->set_left(across, down);
}

constexpr HalfPlane kAllPixels = {{{UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX}},
                                  {{UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX}}};
constexpr HalfPlane kNoPixels = {{{0, 0, 0, 0}}, {{0, 0, 0, 0}}};

// The planes of a face: its pixels have met two, and have not come past two others. And the pixels that it may have.
struct CellFace {
  const HalfPlane& met0;
  const HalfPlane& met1;
  const HalfPlane& past0;
  const HalfPlane& past1;
  Pixels possible;
};

// keep_met drops pixels that certainly have not crossed the plane, keep_not_met those that have. Whether any are left.
[[gnu::always_inline]] inline bool keep_met(Pixels& pixels, const HalfPlane& plane) {
  const Pixels& kept = words_of(plane.possible);
  uint32_t any = 0;
#pragma GCC unroll 4
  for (int i = 0; i < kTileWords; ++i) {
    pixels.word[i] &= kept.word[i];
    any |= pixels.word[i];
  }
  return any != 0;
}
[[gnu::always_inline]] inline bool keep_not_met(Pixels& pixels, const HalfPlane& plane) {
  const Pixels& lost = words_of(plane.certain);
  uint32_t any = 0;
#pragma GCC unroll 4
  for (int i = 0; i < kTileWords; ++i) {
    pixels.word[i] &= ~lost.word[i];
    any |= pixels.word[i];
  }
  return any != 0;
}

// A brick under the shadow of a tile.
struct SweptBrick {
  int32_t place;  // its offset in the directory
  int32_t a;
  int32_t b;
};

// Whether few of `cells` voxels of a slab are solid, as dense as voxels are in the bricks of a layer, of which so many
// lie under the tile's shadow.
template <bool kDeep>
[[gnu::noinline, maybe_unused]] bool is_sparse(const Course& course, const SweptBrick* brick,
                                               const SweptBrick* end, int32_t cells, int32_t under) {
  int32_t solid = 0;
  for (; brick != end; ++brick) {
    solid += voxels_of(course.bricks, number_at<kDeep>(course.directory, brick->place));
  }
  return solid * cells <= kMostSolid * 64 * under;
}

// Names the voxel of a cell on a, b and c: 64 times the number of the brick at `place`, plus the voxel's bit.
template <bool kDeep>
[[gnu::always_inline]] inline uint32_t voxel_of(const Course& course, const Sweep& sweep, int32_t place,
                                                const int32_t (&cell)[3]) {
  uint32_t voxel = number_at<kDeep>(course.directory, place) << 6;
#pragma GCC unroll 3
  for (int m = 0; m < 3; ++m) {
    voxel |= (static_cast<uint32_t>(cell[m]) & 3U) << sweep.place_shift[m];
  }
  return voxel ^ sweep.flip;
}

// Stores the inks of what a sweep finds: of a face's pixels, and of single rays.
template <class OneCourse>
struct InkPaint {
  static constexpr bool kDeep = OneCourse::kDeep;
  Sweep& sweep_;
  OneCourse& course_;
  const FirstDirection& first_direction_;
  const TilePlace& place_;

  void begin_tile() {
    if (course_.frame->format == PixelFormat::kGray4) {
      clear(place_);
    }
  }

  void paint_face(int32_t place, const int32_t (&cell)[3], int k, const Pixels& pixels) {
    store_pixels(place_, pixels, *course_.frame, ink_of_face(place, cell, k));
  }

  // Draws the pixel whose ray has direction `d`, traced from where the course starts.
  void paint_ray(uint32_t pixel, const uint32_t (&d)[3]) { draw_ray(pixel, trace_turned(course_, d)); }

 private:
  void draw_ray(uint32_t pixel, int32_t ink) {
    const int32_t x = place_.x + static_cast<int32_t>(pixel & (kTileAcrossPx - 1));
    const int32_t down = static_cast<int32_t>(pixel / kTileAcrossPx);
    const BrickFrame& frame = *course_.frame;
    sweep_.left.word[pixel >> 5] &= ~(1U << (pixel & 31U));
    if (ink == kAsk) {
      ink = ask<kDeep>(frame, x, place_.y + down, sweep_.counts);
    }
    if (ink < 0) {
      ink = static_cast<int32_t>(frame.background);
      ++sweep_.misses;
    }
    store_ink(place_.line + place_.stride * static_cast<size_t>(down), x, place_.y + down, frame.format,
              static_cast<uint32_t>(ink));
  }

  uint32_t ink_of_face(int32_t place, const int32_t (&cell)[3], int k) const {
    const uint32_t voxel = voxel_of<kDeep>(course_, sweep_, place, cell);
    const int axis = course_.axis[k];
    const uint32_t key = voxel << 3 | course_.face[axis];
    const Inks::Seen& seen = course_.inks->face[Inks::slot(key)];
    return seen.key == key ? seen.ink : static_cast<uint32_t>(look_up(course_, voxel, axis));
  }
};

// A tile being swept.
template <class Paint>
class TileSweep : private Paint {
 public:
  explicit TileSweep(const Paint& paint) : Paint(paint) {}

  // Whether the sweep has come to a brick that is not empty, and has drawn there.
  bool begun() const { return begun_; }

  // Draws what the rays meet from `slab` on. Returns the slab at which rays take over the pixels that are left, or the
  // number of slabs when those pixels miss everything.
  int32_t run(const Fan& fan, int32_t slab) {
    const int32_t slabs = 4 * sweep_.side[2];
    slab_ = slab;
    if (!set_reach(fan)) {
      return slab;
    }
    while (slab_ < slabs) {
      SweptBrick bricks[kBeamBricks * kBeamBricks];
      const SweptBrick* const end = next_layer(bricks);
      if (end == bricks) {
        break;
      }
      const int32_t cells = cells_at_once();
      if (cells > kMostCells &&
          !(sweep_.thin && is_sparse<kDeep>(course_, bricks, end, cells,
                                            (to_[0] - from_[0] + 1) * (to_[1] - from_[1] + 1)))) {
        break;
      }
      if (!begun_) {
        begin();
      }
      draw_layer(bricks, end);
      if (sweep_.done()) {
        return slabs;
      }
      const int32_t voxels = 4 - (slab_ & 3);
      slab_ += voxels;
      if (!narrow()) {
        for (Reach& reach : reach_) {
          reach.low += voxels * reach.low_step;
          reach.high += voxels * reach.high_step;
        }
      }
    }
    return slab_;
  }

 private:
  void begin() {
    begun_ = true;
    set_tile(first_direction_, place_.across, place_.down, &sweep_);
    this->begin_tile();
  }

  // Voxels of a slab under the tile's shadow.
  int32_t cells_at_once() const {
    int32_t cells = 1;
    for (const Reach& reach : reach_) {
      cells *= (reach.high >> kCellShift) - (reach.low >> kCellShift) + 1;
    }
    return cells;
  }

  bool set_reach(const Fan& fan) {
    int32_t low[3];
    int32_t high[3];
    for (int k = 0; k < 3; ++k) {
      const int axis = course_.axis[k];
      const bool flipped = (course_.mirrored >> axis & 1U) != 0;
      low[k] = flipped ? -fan.high[axis] : fan.low[axis];
      high[k] = flipped ? -fan.low[axis] : fan.high[axis];
    }
    return set_reach(low, high);
  }

  bool set_reach(const int32_t (&least)[3], const int32_t (&greatest)[3]) {
    const int32_t plane = slab_ * Q8::kOne - sweep_.origin[2];
    // Some rays may hardly advance along c: their directions have few bits. Both axes or none: a shadow that is not
    // narrowed grows from slab to slab.
    if (least[2] < 1 || greatest[0] > 2 * least[2] || greatest[1] > 2 * least[2]) {
      return false;
    }
    const SlopeTo slow(least[2], true);
    const SlopeTo fast(greatest[2], false);
    for (int k = 0; k < 2; ++k) {
      const int32_t low_slope = fast(least[k] < 0 ? 0 : least[k]);
      const int32_t high_slope = slow(greatest[k]) + 1;
      const int32_t at = sweep_.origin[k] * (1 << kSlopeBits);
      reach_[k] = {at + low_slope * plane - 1, at + high_slope * (plane + Q8::kOne) + 1, low_slope * Q8::kOne,
                   high_slope * Q8::kOne};
    }
    return true;
  }

  // Narrows the shadow to the pixels that are left. Returns false where that is not done: the rectangle around these
  // pixels has lost less than an eighth.
  bool narrow() {
    const Pixels& left = sweep_.left;
    uint32_t columns = 0;
    int32_t first = kTileWords;
    int32_t last = 0;
    for (int32_t i = 0; i < kTileWords; ++i) {
      if (left.word[i] != 0) {
        columns |= left.word[i];
        first = first < i ? first : i;
        last = i;
      }
    }
    columns = (columns | columns >> 16) & 0xFFFFU;
    const int32_t x0 = static_cast<int32_t>(bits::lowest_bit(columns));
    const int32_t x1 = bits::highest_bit(columns);
    const int32_t across = x1 - x0 + 1;
    const int32_t words = last - first + 1;
    if (8 * across * words > 7 * columns_ * words_) {
      return false;
    }
    columns_ = across;
    words_ = words;
    const TileRays& rays = sweep_.rays;
    int32_t low[3];
    int32_t high[3];
    for (int k = 0; k < 3; ++k) {
      const int32_t at_x0 = x0 * rays.step_x[k];
      const int32_t at_x1 = x1 * rays.step_x[k];
      const int32_t at_y0 = 2 * first * rays.step_y[k];
      const int32_t at_y1 = (2 * last + 1) * rays.step_y[k];
      const int32_t least = (at_x0 < at_x1 ? at_x0 : at_x1) + (at_y0 < at_y1 ? at_y0 : at_y1);
      const int32_t most = (at_x0 < at_x1 ? at_x1 : at_x0) + (at_y0 < at_y1 ? at_y1 : at_y0);
      low[k] = rays.base[k] + ((rays.rest[k] + least - rays.unit) >> rays.fraction_bits);
      high[k] = rays.base[k] + ((rays.rest[k] + most + rays.unit) >> rays.fraction_bits);
    }
    return set_reach(low, high);
  }

  // Goes on to the first layer, from `slab_` on, in which bricks under the shadow are not empty: lists these, the nearest
  // first, and returns their end. Where it lists none, rays take over at `slab_`.
  [[gnu::noinline, THIMBLE_HOT]] const SweptBrick* next_layer(SweptBrick* bricks) {
    Reach a = reach_[0];
    Reach b = reach_[1];
    const int32_t last_a = sweep_.side[0] - 1;
    const int32_t last_b = sweep_.side[1] - 1;
    const int32_t stride_a = sweep_.stride[0];
    const int32_t stride_b = sweep_.stride[1];
    const uint8_t* const directory = course_.directory;
    const int32_t slabs = 4 * sweep_.side[2];
    int32_t slab = slab_;
    int32_t layer = sweep_.base + (slab >> 2) * sweep_.stride[2];
    // The upper ends are those of a layer's last slab.
    int32_t voxels = 4 - (slab & 3);
    a.high += (voxels - 1) * a.high_step;
    b.high += (voxels - 1) * b.high_step;
    SweptBrick* end = bricks;
    while (slab < slabs) {
      int32_t from_a = a.low >> kBrickShift;
      int32_t from_b = b.low >> kBrickShift;
      from_a = from_a < 0 ? 0 : from_a;
      from_b = from_b < 0 ? 0 : from_b;
      if (from_a > last_a || from_b > last_b) {
        slab = slabs;
        break;
      }
      int32_t to_a = a.high >> kBrickShift;
      int32_t to_b = b.high >> kBrickShift;
      if (to_a - from_a >= kBeamBricks || to_b - from_b >= kBeamBricks) {
        break;
      }
      to_a = to_a > last_a ? last_a : to_a;
      to_b = to_b > last_b ? last_b : to_b;
      int32_t row = layer + from_b * stride_b + from_a * stride_a;
      for (int32_t at_b = from_b; at_b <= to_b; ++at_b, row += stride_b) {
        int32_t place = row;
        for (int32_t at_a = from_a; at_a <= to_a; ++at_a, place += stride_a) {
          if (number_at<kDeep>(directory, place) != 0) {
            *end++ = {place, at_a, at_b};
          }
        }
      }
      if (end != bricks) {
        from_[0] = from_a;
        from_[1] = from_b;
        to_[0] = to_a;
        to_[1] = to_b;
        reach_[0].low = a.low;
        reach_[1].low = b.low;
        reach_[0].high = a.high - (voxels - 1) * a.high_step;
        reach_[1].high = b.high - (voxels - 1) * b.high_step;
        break;
      }
      a.low += voxels * a.low_step;
      b.low += voxels * b.low_step;
      a.high += 4 * a.high_step;
      b.high += 4 * b.high_step;
      slab += voxels;
      voxels = 4;
      layer += sweep_.stride[2];
    }
    slab_ = slab;
    return end;
  }

  // Draws bricks of one layer from slab `slab_` on.
  [[THIMBLE_HOT]] void draw_layer(const SweptBrick* brick, const SweptBrick* end) {
    const int32_t slab = slab_;
    // The shadow's voxels as bits, from the one before the first brick on; bit 0 is set where the shadow begins before
    // the box. All rays have entered the lowest of them before the slab begins, and leave the highest after it ends.
    uint32_t under[2][4];
    const int32_t first_slab = slab & 3;
    for (int k = 0; k < 2; ++k) {
      int32_t low = reach_[k].low - (4 * from_[k] - 1) * (1 << kCellShift);
      int32_t high = reach_[k].high - (4 * from_[k] - 2) * (1 << kCellShift);
      for (int32_t i = first_slab; i < 4; ++i) {
        under[k][i] = (1U << bit_at(high >> kCellShift)) - (1U << bit_at(low >> kCellShift));
        low += reach_[k].low_step;
        high += reach_[k].high_step;
      }
    }
    for (; brick != end; ++brick) {
      Exposed& exposed =
          sweep_.exposed[((brick->a & 3) | (brick->b & 1) << 2 | (slab & 4) << 1) & (kExposedKept - 1)];
      if (exposed.place != brick->place) {
        find_exposed<kDeep>(course_, brick->place, {brick->a, brick->b, slab >> 2}, &exposed);
      }
      const int shift_a = 4 * (brick->a - from_[0]);
      const int shift_b = 4 * (brick->b - from_[1]);
      const Half* on = exposed.on + first_slab;
      for (int32_t i = first_slab; i < 4; ++i, ++on) {
        const uint32_t faces_a = on[0];
        const uint32_t faces_b = on[Exposed::kSlabs];
        const uint32_t faces_c = on[2 * Exposed::kSlabs];
        if ((faces_a | faces_b | faces_c) == 0) {
          continue;
        }
        // From the voxel before the brick to the one behind it.
        const uint32_t on_a = under[0][i] >> shift_a;
        const uint32_t on_b = under[1][i] >> shift_b;
        const uint32_t across = on_a >> 1 & 15U;
        const uint32_t rows = kRows[on_b >> 1 & 15U];
        if (((faces_a | faces_b | faces_c) & across * rows) == 0) {
          continue;
        }
        // Voxels that rays may enter by a plane of a, or of b, and those that they may leave by one.
        const uint32_t enter_a = (on_a & on_a >> 1 & 15U) * rows;
        const uint32_t enter_b = across * kRows[on_b & on_b >> 1 & 15U];
        const int32_t c = 4 * (slab >> 2) + i;
        if ((faces_c & across * rows) != 0 && distance_of(sweep_, 2, c) > 0) {
          draw_across(*brick, c, faces_c & across * rows, enter_a, enter_b,
                      (on_a >> 1 & on_a >> 2 & 15U) * rows, across * kRows[on_b >> 1 & on_b >> 2 & 15U]);
        }
        draw_along(*brick, c, faces_a & enter_a, faces_b & enter_b);
        if (sweep_.done()) {
          return;
        }
      }
    }
  }

  static constexpr int32_t bit_at(int32_t cell) { return cell < 0 ? 0 : cell > 31 ? 31 : cell; }

  [[gnu::always_inline]] const HalfPlane* plane(Family family, int32_t i, int32_t j) {
    return &half_plane<kDeep>(sweep_, family, i, j);
  }

  // Draws faces across c of a brick's voxels in one slab. No other face of the slab hides them: rays that meet them have
  // just come into it. A half-plane is made only while pixels are left to the face, and where rays may have met its plane
  // within the slab before, or may not have met it.
  [[gnu::always_inline]] void draw_across(const SweptBrick& brick, int32_t c, uint32_t faces,
                                          uint32_t enter_a, uint32_t enter_b, uint32_t leave_a,
                                          uint32_t leave_b) {
    for (; faces != 0; faces &= faces - 1) {
      const uint32_t bit = bits::lowest_bit(faces);
      const int32_t a = 4 * brick.a + static_cast<int32_t>(bit & 3U);
      const int32_t b = 4 * brick.b + static_cast<int32_t>(bit >> 2);
      Pixels possible = words_of(sweep_.left);
      const HalfPlane* met_a = &kAllPixels;
      const HalfPlane* met_b = &kAllPixels;
      const HalfPlane* past_a = &kNoPixels;
      const HalfPlane* past_b = &kNoPixels;
      if (((enter_a >> bit & 1U) == 0 || keep_met(possible, *(met_a = plane(kAc, a, c)))) &&
          ((enter_b >> bit & 1U) == 0 || keep_met(possible, *(met_b = plane(kBc, b, c)))) &&
          ((leave_a >> bit & 1U) == 0 || keep_not_met(possible, *(past_a = plane(kAc, a + 1, c)))) &&
          ((leave_b >> bit & 1U) == 0 || keep_not_met(possible, *(past_b = plane(kBc, b + 1, c))))) {
        draw_face(brick.place, {a, b, c}, 2, {*met_a, *met_b, *past_a, *past_b, possible});
      }
    }
  }

  // Draws faces across a and across b of a brick's voxels in one slab.
  [[gnu::always_inline]] void draw_along(const SweptBrick& brick, int32_t c, uint32_t on_a, uint32_t on_b) {
    for (uint32_t any = on_a | on_b; any != 0; any &= any - 1) {
      const uint32_t bit = bits::lowest_bit(any);
      const int32_t a = 4 * brick.a + static_cast<int32_t>(bit & 3U);
      const int32_t b = 4 * brick.b + static_cast<int32_t>(bit >> 2);
      if ((on_a >> bit & 1U) != 0) {
        draw_one_along<0>(brick.place, a, b, c);
      }
      if ((on_b >> bit & 1U) != 0) {
        draw_one_along<1>(brick.place, a, b, c);
      }
    }
  }
  template <int kAxis>
  [[gnu::always_inline]] void draw_one_along(int32_t place, int32_t a, int32_t b, int32_t c) {
    constexpr bool kOnA = kAxis == 0;
    constexpr Family kOverC = kOnA ? kAc : kBc;
    const int32_t own = kOnA ? a : b;
    if (distance_of(sweep_, kAxis, own) <= 0) {
      return;
    }
    Pixels possible = words_of(sweep_.left);
    const HalfPlane& met_c = *plane(kOverC, own, c + 1);
    if (keep_met(possible, met_c)) {
      const HalfPlane& met = *plane(kAb, a, kOnA ? b + 1 : b);
      if (keep_met(possible, met)) {
        const HalfPlane& past_c = *plane(kOverC, own, c);
        const HalfPlane& past = *plane(kAb, kOnA ? a : a + 1, b);
        if (keep_not_met(possible, past_c) && keep_not_met(possible, past)) {
          draw_face(place, {a, b, c}, kAxis, {met_c, met, past_c, past, possible});
        }
      }
    }
  }

  // Draws the face of `cell` on axis k.
  [[gnu::noinline, THIMBLE_HOT]] void draw_face(int32_t place, const int32_t (&cell)[3], int k,
                                                const CellFace& face) {
    const HalfPlane& met0 = face.met0;
    const HalfPlane& met1 = face.met1;
    const HalfPlane& past0 = face.past0;
    const HalfPlane& past1 = face.past1;
    Sweep& sweep = sweep_;
    Pixels mine;
    uint32_t any = 0;
#pragma GCC unroll 4
    for (int i = 0; i < kTileWords; ++i) {
      const uint32_t possible = face.possible.word[i];
      uint32_t own = 0;
      if (possible != 0) {
        own = met0.certain.word[i] & met1.certain.word[i] &
              ~(past0.possible.word[i] | past1.possible.word[i]) & possible;
        sweep.left.word[i] &= ~own;
        if (own != possible) {
          own |= decide(cell, k, static_cast<uint32_t>(i), possible ^ own);
        }
        any |= own;
      }
      mine.word[i] = own;
    }
    if (any != 0) {
      this->paint_face(place, cell, k, mine);
    }
  }

  // Decides open pixels of word `i` by their exact rays. Returns those that are the face's.
  [[gnu::noinline, THIMBLE_HOT]] uint32_t decide(const int32_t (&cell)[3], int k, uint32_t i, uint32_t open) {
    uint32_t mine = 0;
    for (; open != 0; open &= open - 1) {
      const uint32_t bit = bits::lowest_bit(open);
      uint32_t d[3];
      find_direction(sweep_, first_direction_, 32 * i + bit, d);
      const int where = place_on_face<kDeep>(sweep_, k, cell, d);
      if (where > 0) {
        mine |= 1U << bit;
      } else if (where == 0) {
        this->paint_ray(32 * i + bit, d);
      }
    }
    sweep_.left.word[i] &= ~mine;
    return mine;
  }

 public:
  // Draws the pixels that are left by rays, from where the course starts; leaves quads of which nothing is drawn yet.
  void draw_parts_of_quads() {
    uint32_t quads = 0;
    for (uint32_t i = 0; i < kTileWords; ++i) {
      if ((i & 1U) == 0) {
        // Bits 0, 4, 8 and 12: the quads of which nothing is drawn yet in these four rows.
        quads = sweep_.left.word[i] & sweep_.left.word[i + 1];
        quads &= quads >> 16;
        quads &= quads >> 1;
        quads = quads & quads >> 2 & 0x1111U;
      }
      for (uint32_t word = sweep_.left.word[i] & ~(quads * 0x000F000FU); word != 0; word &= word - 1) {
        const uint32_t pixel = 32 * i + bits::lowest_bit(word);
        uint32_t d[3];
        find_direction(sweep_, first_direction_, pixel, d);
        this->paint_ray(pixel, d);
      }
    }
  }

 private:
  using Paint::course_;
  using Paint::first_direction_;
  using Paint::kDeep;
  using Paint::place_;
  using Paint::sweep_;
  int32_t slab_;    // the next one
  Reach reach_[2];  // there
  // The bricks of the layer that is being drawn which lie under the shadow.
  int32_t from_[2];
  int32_t to_[2];
  // The rectangle that the shadow was last narrowed to: so many columns, and pairs of rows.
  int32_t columns_ = kTileAcrossPx;
  int32_t words_ = kTileWords;
  bool begun_ = false;
};

}  // namespace
}  // namespace thimble::bricks
