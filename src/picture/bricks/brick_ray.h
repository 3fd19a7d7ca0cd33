// Traces one ray from voxel to voxel through the bricks, plane by plane along its fastest axis. Internal to src/.
//
// Everything is mirrored as in crossings.h, so that no direction has a negative component, and relative to
// the map's box: planes and cells are counted from the side at which the rays come in. Axis c is the one that
// a tile's rays move fastest on, a and b are the others. Between two planes of c a ray crosses few planes of
// a and b. For a and for b it keeps its position on the next plane of c:
//
//   rest_a = P_a - (cell_a + 1) * den       P_a = o_a * d_c + s_c * d_a, the position times den = 256 * d_c
//
// A rest is negative while the ray is still in its cell at that plane; adding 256 * d_a steps to the next plane of c.
// When rest_a is positive the ray crosses a plane of a before that plane of c; when it is 0 it crosses both together.
// When both rests are positive, comparing rest_a * d_b with rest_b * d_a says which plane comes first, since rest / d
// is the time that is left.
#pragma once

#include "../../base/ranges.h"
#include "inks.h"
#include "layers.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"

namespace thimble::bricks {
namespace {

// Answers that are not inks.
constexpr int32_t kMissed = -1;
constexpr int32_t kAsk = -2;  // only closest_hit of the tree can tell
// No answer yet.
constexpr int32_t kGoOn = 0;
// There is a hit, and the aim is not kInk.
constexpr int32_t kShadowed = 1;
// In place of an axis: two planes were crossed together.
constexpr int kEdge = 3;

// Divides on a core without a divider: dividend / divisor, both below 2^31. It starts from the last quotient, since
// that of a neighbouring ray is a step or two away. `most` times the divisor is below 2^31.
uint32_t quotient(uint32_t dividend, uint32_t divisor, uint32_t most, uint32_t* last) {
  uint32_t result = *last;
  int32_t rest = static_cast<int32_t>(dividend - result * divisor);
  for (int step = 0;; ++step) {
    if (step == 6) {
      result = dividend / divisor;
      break;
    }
    if (rest < 0) {
      rest += static_cast<int32_t>(divisor);
      --result;
    } else if (rest >= static_cast<int32_t>(divisor)) {
      rest -= static_cast<int32_t>(divisor);
      ++result;
    } else {
      break;
    }
  }
  // `most` is a mask: it keeps the next product below 2^31.
  *last = result & most;
  return result;
}

// With up to 12 direction bits products of rests and directions have at most 32 bits (8 + 12 + 12).
constexpr bool kHasWideProducts = kMaxBrickDirectionBits > 12;

// Returns a number with the sign of rest_a * d_b - rest_b * d_a, which says which plane comes first. Rests are below
// 2^23, directions below 2^15. Where products may have more than 31 bits, both rests are divided by 256 first. That
// result is wrong by less than 2^15; where it leaves the sign open, the exact difference is below 2^24, so its lower
// 32 bits are all of it. (64-bit products take 1 per cent more on a Cortex-M3, and a call each on a Cortex-M0.)
template <class OneCourse>
[[gnu::always_inline]] inline int32_t order_of(const OneCourse& course, uint32_t rest_a, uint32_t d_b,
                                               uint32_t rest_b, uint32_t d_a) {
  if (seldom(course.wide)) {
    const int32_t rough = static_cast<int32_t>((rest_a >> 8) * d_b - (rest_b >> 8) * d_a);
    if (rough >= 1 << 15 || rough <= -(1 << 15)) {
      return rough;
    }
  }
  return static_cast<int32_t>(rest_a * d_b - rest_b * d_a);
}

constexpr bool is_negative(uint32_t value) {
  return static_cast<int32_t>(value) < 0;
}
constexpr bool is_positive(uint32_t value) {
  return static_cast<int32_t>(value) > 0;
}

// In place of signs: they are read from the course at run time.
constexpr unsigned kAnySigns = 8;

// A ray of direction (d_a, d_b, d_c), mirrored on the axes of kMirrored. Everything is inlined into `trace_one`, where
// the members become registers. The course names the ray's aim (sight.h, shadow.h and near.h have others).
template <int kC, unsigned kMirrored, class OneCourse = Course>
class BrickRay {
 public:
  [[gnu::always_inline]] BrickRay(const OneCourse& course, uint32_t d_a, uint32_t d_b, uint32_t d_c)
      : course_(course), d_a_(d_a), d_b_(d_b), d_c_(d_c), den_(d_c << 8) {}

  // Lets the ray begin in a voxel of brick `number`, the first one in which it spends a length. `left`, `cell` and
  // `place` are that voxel's; the rests are those on the plane of c before the point.
  [[gnu::always_inline]] void begin(uint32_t number, uint32_t left, int32_t cell, uint32_t place,
                                    uint32_t rest_a, uint32_t rest_b) {
    left_ = left;
    cell_ = cell;
    shift_ = place & 15U;
    at_ = course_.bricks + 8 * number + (place >> 4 << 1);
    rest_a_ = rest_a;
    rest_b_ = rest_b;
    axis_ = kC;
  }
  // Lets the ray end at the first plane of c after it has crossed so many.
  [[gnu::always_inline]] void end_after(uint32_t planes) { planes_ = planes; }

  // Returns the ink of what the ray hits (kShadowed where no ink is wanted), kMissed or kAsk. A ray from a face needs
  // `begin` first.
  [[gnu::always_inline]] int32_t trace() {
    const int32_t started = start();
    if (started != kGoOn) {
      return started;
    }
    const uint32_t go_a = d_a_ << 8;
    const uint32_t go_b = d_b_ << 8;

    if constexpr (kFromFace) {
      goto entered;
    }
  enter:  // a brick, by a plane of axis_
    if (seldom((left_ & kSpecial) != 0)) {
      if (kFromFace || (left_ & kLeft) != 0) {
        return kMissed;
      }
      if constexpr (!kFromFace) {
        if (!begin_brick()) {
          return kAsk;
        }
        goto entered;
      }
    }
    if (!find_brick() || !skip_air()) {
      return kMissed;
    }
  entered:
    if (solid()) {
      goto hit;
    }
    if (axis_ != kC) {
      goto between;
    }
  slab:  // from plane to plane of c
    rest_a_ += go_a;
    rest_b_ += go_b;
    THIMBLE_NOTE(Range::kBrickRest, Exact(static_cast<int32_t>(rest_a_)));
    THIMBLE_NOTE(Range::kBrickRest, Exact(static_cast<int32_t>(rest_b_)));
  between:
    if (!is_negative(rest_a_ & rest_b_)) {
      if (is_positive(rest_a_)) {
        if (is_positive(rest_b_)) {
          const auto time = times();
          if (time.a < time.b) {
            goto cross_b;
          }
          if (time.a == time.b) {
            goto tie;
          }
        }
        goto cross_a;
      }
      if (is_positive(rest_b_)) {
        goto cross_b;
      }
      goto tie;
    }
    if (ends()) {
      return kMissed;
    }
    if (step<kC>()) {
      axis_ = kC;
      goto enter;
    }
    if (!solid()) {
      goto slab;
    }
    axis_ = kC;
    goto hit;
  cross_a:
    rest_a_ -= den_;
    axis_ = kA;
    if (step<kA>()) {
      goto enter;
    }
    if (solid()) {
      goto hit;
    }
    goto between;
  cross_b:
    rest_b_ -= den_;
    axis_ = kB;
    if (step<kB>()) {
      goto enter;
    }
    if (solid()) {
      goto hit;
    }
    goto between;
  tie:
    if (!cross_together()) {
      return kFromFace ? kMissed : kAsk;
    }
    goto enter;
  hit:
    return answer();
  }

 private:
  template <class Time>
  struct Times {
    Time a;
    Time b;
  };

  static constexpr int kA = kOtherA<kC>;
  static constexpr int kB = kOtherB<kC>;
  static constexpr bool kMirrors = OneCourse::kAim == Aim::kMirror;
  static constexpr bool kFromFace =
      OneCourse::kAim == Aim::kShadow || OneCourse::kAim == Aim::kNear || kMirrors;
  // Whether rays end at a plane of c: those of shadow at bricks with nothing behind them, but of level 9 and 10.
  static constexpr bool kEnds =
      OneCourse::kAim == Aim::kNear || (OneCourse::kAim == Aim::kShadow && OneCourse::kDeep);
  // Whether rays pass layers of empty bricks at once. Cores without a divider have little flash, and leave this out.
  static constexpr bool skips_layers() {
    if constexpr (OneCourse::kAim == Aim::kNear || kMirrors) {
      return OneCourse::kRunsFar && kDivides;
    } else {
      return OneCourse::kDeep;
    }
  }
  static constexpr uint32_t kFarPlanes = 8;  // with fewer planes to go, voxel by voxel is quicker
  static constexpr bool mirrored(int axis) { return (kMirrored >> axis & 1U) != 0; }
  static constexpr uint32_t flip(int axis) { return mirrored(axis) ? 3U : 0U; }
  // The last voxel of a brick on an axis, shifted to its place; and what a step adds.
  template <int kAxis>
  [[gnu::always_inline]] uint32_t last() const {
    if constexpr (kMirrored == kAnySigns) {
      return course_.last[kAxis];
    } else {
      return mirrored(kAxis) ? 0U : kField<kAxis>;
    }
  }
  template <int kAxis>
  [[gnu::always_inline]] int32_t one_step() const {
    if constexpr (kMirrored == kAnySigns) {
      return course_.one_step[kAxis];
    } else {
      constexpr int32_t kStep = (mirrored(kAxis) ? -1 : 1) * (1 << kPlaceShift[kAxis]);
      return kStep;
    }
  }

  // Where the last ray started, on a and b.
  [[gnu::always_inline]] uint32_t* near_cell() const {
    if constexpr (OneCourse::kAim == Aim::kInk) {
      return course_.inks->near_cell;
    } else {
      return course_.near_cell;
    }
  }

  // Two numbers that compare as the times at which the ray meets the next planes of a and b.
  [[gnu::always_inline]] auto times() const {
    THIMBLE_NOTE(Range::kBrickTime, Exact(rest_a_) * Exact(d_b_));
    THIMBLE_NOTE(Range::kBrickTime, Exact(rest_b_) * Exact(d_a_));
    if constexpr (kHasWideProducts || kFromFace) {
      return Times<int32_t>{order_of(course_, rest_a_, d_b_, rest_b_, d_a_), 0};
    } else {
      return Times<uint32_t>{rest_a_ * d_b_, rest_b_ * d_a_};
    }
  }

  // The greatest quotient that `quotient` may start from.
  [[gnu::always_inline]] uint32_t most_cells() const { return kHasWideProducts ? course_.most_cells : 1023; }

  // Finds the cell that the ray starts in.
  [[gnu::always_inline]] int32_t start() {
    if constexpr (kFromFace) {
      return kGoOn;  // begin() did
    } else if constexpr (OneCourse::kDeep) {
      const int32_t cell_a = cell_on(kA, d_a_, &rest_a_, near_cell() + 0);
      const int32_t cell_b = cell_on(kB, d_b_, &rest_b_, near_cell() + 1);
      if (seldom(static_cast<uint32_t>(cell_a | cell_b) >= 2048)) {
        return (cell_a | cell_b) < 0 ? kAsk : kMissed;
      }
      enter_at(static_cast<uint32_t>(cell_a), static_cast<uint32_t>(cell_b));
      // A ray that is faster on another axis may enter several bricks of a layer, and goes voxel by voxel.
      planes_ = d_a_ <= d_c_ && d_b_ <= d_c_ ? UINT32_MAX : 0;
      return kGoOn;
    } else {
      const uint32_t at_a = static_cast<uint32_t>(course_.origin[kA]) * d_c_ + course_.plane * d_a_;
      const uint32_t at_b = static_cast<uint32_t>(course_.origin[kB]) * d_c_ + course_.plane * d_b_;
      if (seldom(!kDivides && is_negative(at_a | at_b))) {
        return kAsk;
      }
      // 2^31 and more look negative, too. What does not is exact.
      THIMBLE_NOTE(Range::kBrickPlace, is_negative(at_a) ? Exact(0)
                                                         : Exact(course_.origin[kA]) * Exact(d_c_) +
                                                               Exact(course_.plane) * Exact(d_a_));
      THIMBLE_NOTE(Range::kBrickPlace, is_negative(at_b) ? Exact(0)
                                                         : Exact(course_.origin[kB]) * Exact(d_c_) +
                                                               Exact(course_.plane) * Exact(d_b_));
      const uint32_t cell_a = kDivides ? at_a / den_ : quotient(at_a, den_, most_cells(), near_cell() + 0);
      const uint32_t cell_b = kDivides ? at_b / den_ : quotient(at_b, den_, most_cells(), near_cell() + 1);
      // Where at_a or at_b is negative the ray starts far outside, and the quotient means nothing.
      if (seldom((cell_a | cell_b | (at_a | at_b) >> 21) >= 1024)) {
        return is_negative(at_a | at_b) ? kAsk : kMissed;
      }
      rest_a_ = at_a - (cell_a + 1) * den_;
      rest_b_ = at_b - (cell_b + 1) * den_;
      THIMBLE_NOTE(Range::kBrickRest, Exact(static_cast<int32_t>(rest_a_)));
      THIMBLE_NOTE(Range::kBrickRest, Exact(static_cast<int32_t>(rest_b_)));
      enter_at(cell_a, cell_b);
      return kGoOn;
    }
  }

  // Lets the ray start in this cell of a and b.
  [[gnu::always_inline]] void enter_at(uint32_t cell_a, uint32_t cell_b) {
    left_ = course_.left + ((cell_a >> 2) << 10 * kA) + ((cell_b >> 2) << 10 * kB);
    cell_ = course_.start + static_cast<int32_t>(cell_a >> 2) * course_.stride[kA] +
            static_cast<int32_t>(cell_b >> 2) * course_.stride[kB];
    constexpr bool kAny = kMirrored == kAnySigns;
    const uint32_t in_a = ((cell_a & 3U) ^ (kAny ? course_.flip[kA] : flip(kA))) << kPlaceShift[kA];
    const uint32_t in_b = ((cell_b & 3U) ^ (kAny ? course_.flip[kB] : flip(kB))) << kPlaceShift[kB];
    shift_ = in_a | (kB == 2 ? course_.first : in_b);
    at_ = course_.bricks + (kB == 2 ? in_b : course_.first);
    axis_ = kC;
  }

  // Finds the cell and the rest on a or b at the plane where the ray starts. The position times den has more than 32 bits
  // in worlds of level 9 and 10, so that the way is divided in two: by whole voxels along c, then what is left of these
  // and what lies within a voxel.
  [[gnu::always_inline]] int32_t cell_on(int axis, uint32_t d, uint32_t* rest, uint32_t* last) const {
    const uint32_t way = (course_.plane >> 8) * d;
    const uint32_t whole = kDivides ? way / d_c_ : quotient(way, d_c_, 0xFFFF, last);
    const auto origin = static_cast<uint32_t>(course_.origin[axis]);
    const uint32_t part = ((way - whole * d_c_) << 8) + (origin & 255U) * d_c_ + (course_.plane & 255U) * d;
    THIMBLE_NOTE(Range::kDeepPlace, Exact(part));
    uint32_t none = 0;
    const uint32_t more = kDivides ? part / den_ : quotient(part, den_, 0xFFFF, &none);
    *rest = part - (more + 1) * den_;
    THIMBLE_NOTE(Range::kBrickRest, Exact(static_cast<int32_t>(*rest)));
    return (course_.origin[axis] >> 8) + static_cast<int32_t>(whole + more);
  }

  // The halfword of brick `number` at the same place as at_ in its brick.
  [[gnu::always_inline]] const uint8_t* brick_at(uint32_t number) const {
    return course_.bricks + 8 * number + row_of(at_);
  }
  [[gnu::always_inline]] bool solid() const { return (half_at(at_, 0) >> shift_ & 1U) != 0; }

  // Finds the brick that the ray has entered. Returns false where a ray of shadow ends: the brick is empty, and it is
  // known that nothing behind it is solid.
  [[gnu::always_inline]] bool find_brick() {
    if constexpr (OneCourse::kAim == Aim::kShadow && !kEnds) {
      const uint32_t number = number_at<false>(course_.directory, cell_);
      if (number == 0 && course_.is_free(cell_)) {
        return false;
      }
      at_ = brick_at(number);
    } else {
      at_ = brick_at(number_at<OneCourse::kDeep>(course_.directory, cell_));
    }
    return true;
  }

  // Whether the ray is in an empty brick: the directory gives all of them number 0.
  [[gnu::always_inline]] bool is_empty() const { return static_cast<size_t>(at_ - course_.bricks) < 8; }

  // Whether the plane of c that was crossed last lies between two layers of bricks. (A ray that crosses planes of
  // several axes together enters a brick anew, though it may be in the middle of a layer.)
  [[gnu::always_inline]] bool comes_from_layer() const {
    const uint32_t own = kC == 2 ? row_of(at_) : shift_ & kField<kC>;
    return own == (last<kC>() ^ kField<kC>);
  }
  // Goes on through empty bricks if the ray has just entered one. Returns false when the ray ends there.
  [[gnu::always_inline]] bool skip_air() {
    if constexpr (skips_layers()) {
      return planes_ < kFarPlanes || axis_ != kC || !is_empty() || !comes_from_layer() || skip_empty();
    } else {
      return true;
    }
  }
  // Goes on from a plane of c between two layers of bricks.
  [[gnu::always_inline]] bool skip_empty() {
    LayerPlace at{{rest_a_, rest_b_}, left_, cell_, planes_, row_of(at_) << 3 | shift_, 0};
    if constexpr (OneCourse::kDeep) {
      DeepWay way{course_.directory, course_.next_brick, {}, {last<0>(), last<1>(), last<2>()}};
      way.d[kA] = d_a_;
      way.d[kB] = d_b_;
      way.d[kC] = d_c_;
      if (!skip_layers(way, kC, &at)) {
        return false;
      }
    } else if (!skip_layers(course_, kC, &at)) {
      return false;
    }
    rest_a_ = at.rest[0];
    rest_b_ = at.rest[1];
    left_ = at.left;
    cell_ = at.cell;
    planes_ = at.planes;
    shift_ = at.place & 15U;
    at_ = course_.bricks + 8 * at.number + (at.place >> 4 << 1);
    return true;
  }

  // The result for a ray that meets something.
  [[gnu::always_inline]] int32_t answer() {
    if constexpr (OneCourse::kAim == Aim::kInk) {
      return name_axis() ? ink() : kAsk;
    } else if constexpr (OneCourse::kAim == Aim::kShadow) {
      return kShadowed;
    } else {
      // Aim::kNear asks only for t, which is the same for all faces entered there.
      if constexpr (OneCourse::kAim == Aim::kSight || kMirrors) {
        if ((kMirrors && axis_ == kEdge) || !name_axis()) {
          return kAsk;
        }
      }
      course_.landing = {static_cast<uint32_t>(at_ - course_.bricks) * 8 + shift_, left_, cell_, axis_};
      return kShadowed;
    }
  }

  // Enters a brick in the unusual cases: the ray waits outside of the box, or starts here.
  [[gnu::always_inline]] bool begin_brick() {
    if ((left_ & kInside) != 0) {
      rest_a_ -= course_.behind * d_a_;
      rest_b_ -= course_.behind * d_b_;
    }
    // A count of 512 - bricks is the box's near side; below it the ray is still outside and waits.
    const Vec3i& side = course_.frame->side;
    uint32_t number = 0;
    if ((left_ & kWaiting) == 0 || (count_of(left_, kA) >= 512U - static_cast<uint32_t>(side[kA]) &&
                                    count_of(left_, kB) >= 512U - static_cast<uint32_t>(side[kB]))) {
      left_ &= ~kWaiting;
      number = number_at<OneCourse::kDeep>(course_.directory, cell_);
    }
    at_ = brick_at(number);
    if ((left_ & kInside) != 0 && solid()) {
      return false;
    }
    left_ &= ~kInside;
    return true;
  }

  // Goes to the next voxel on an axis; returns whether it lies in the next brick.
  template <int kAxis>
  [[gnu::always_inline]] bool step() {
    const uint32_t own = kAxis == 2 ? row_of(at_) : shift_ & kField<kAxis>;
    if (own == last<kAxis>()) {
      if (kAxis == 2) {
        at_ += 6 - 2 * static_cast<int32_t>(own);
      } else {
        shift_ ^= kField<kAxis>;
      }
      left_ += uint32_t{1} << 10 * kAxis;
      cell_ += course_.next_brick[kAxis];
      return true;
    }
    if (kAxis == 2) {
      at_ += one_step<kAxis>();
    } else {
      shift_ += static_cast<uint32_t>(one_step<kAxis>());
    }
    return false;
  }

  // Whether the ray ends here, before a plane of c.
  [[gnu::always_inline]] bool ends() {
    if constexpr (kEnds) {
      return planes_-- == 0;
    } else {
      return false;
    }
  }

  // Crosses the planes that the ray reaches at the same time; it spends no time in the voxels between them. Returns
  // false when closest_hit must say what the ray hits, or when the ray ends here.
  [[gnu::always_inline]] bool cross_together() {
    if (rest_a_ == 0 || rest_b_ == 0) {  // with the plane of c
      if (ends()) {
        return false;
      }
      if (rest_a_ == 0) {
        rest_a_ -= den_;
        step<kA>();
      }
      if (rest_b_ == 0) {
        rest_b_ -= den_;
        step<kB>();
      }
      step<kC>();
      axis_ = kC;
      return true;
    }
    rest_a_ -= den_;
    rest_b_ -= den_;
    step<kA>();
    step<kB>();
    axis_ = kMirrors ? kEdge : kA;
    if constexpr (kFromFace) {
      return true;  // these rays ask only whether and when they hit
    } else {
      return course_.exact_ties;
    }
  }

  // Names the face of the hit: a voxel entered by a plane of c may be entered by others at the same t, and then the
  // lowest axis counts. Returns false when only closest_hit can name it.
  [[gnu::always_inline]] bool name_axis() {
    if (seldom(axis_ == kC && (rest_a_ == 0U - den_ || rest_b_ == 0U - den_))) {
      const bool a = rest_a_ == 0U - den_ && d_a_ != 0;
      const bool b = rest_b_ == 0U - den_ && d_b_ != 0;
      if ((a || b) && !course_.exact_ties) {
        return false;
      }
      if (kA < kC && a) {
        axis_ = kA;
      } else if (kB < kC && b) {
        axis_ = kB;
      }
    }
    return true;
  }

  [[gnu::always_inline]] int32_t ink() const {
    const uint32_t voxel = static_cast<uint32_t>(at_ - course_.bricks) * 8 + shift_;
    const uint32_t face = kMirrored == kAnySigns
                              ? course_.face[axis_]
                              : static_cast<uint32_t>(2 * axis_) + (kMirrored >> axis_ & 1U);
    const uint32_t key = voxel << 3 | face;
    const Inks::Seen& seen = course_.inks->face[Inks::slot(key)];
    if (seen.key == key) {
      return static_cast<int32_t>(seen.ink);
    }
    if (course_.frame->shading.mode != ShadeMode::kDepth) {
      return look_up(course_, voxel, axis_);
    }
    return depth_ink(course_, axis_, left_, voxel, axis_ == kA ? d_a_ : axis_ == kB ? d_b_ : d_c_);
  }

  const OneCourse& course_;
  const uint32_t d_a_;
  const uint32_t d_b_;
  const uint32_t d_c_;
  const uint32_t den_;
  uint32_t rest_a_;
  uint32_t rest_b_;
  uint32_t left_;      // counts of bricks
  int32_t cell_;       // offset in the directory
  uint32_t shift_;     // the voxel's place: x and y
  const uint8_t* at_;  // and z: its halfword
  int axis_;           // of the plane that was crossed last
  uint32_t planes_;    // planes of c that the ray may still cross (kEnds, Aim::kMirror)
};

template <int kC, unsigned kMirrored, class OneCourse>
[[gnu::noinline, THIMBLE_HOT]] int32_t trace_one(const OneCourse& course, uint32_t d_a, uint32_t d_b,
                                                 uint32_t d_c) {
  return BrickRay<kC, kMirrored, OneCourse>(course, d_a, d_b, d_c).trace();
}

// Traces through the tree a ray that the bricks leave open.
template <bool kDeep>
[[maybe_unused]] int32_t ask(const BrickFrame& frame, int32_t x, int32_t y, RenderCounts* counts) {
  const Ray ray = frame.camera.ray(x, y);
  Hit hit;
  if ((kDeep ? closest_hit(frame.tree, ray, &hit) : closest_hit_32(frame.tree, ray, &hit)) != Status::kOk) {
    return kMissed;
  }
  counts->node_visits += hit.visits;
  if (hit.kind != HitKind::kHit) {
    return kMissed;
  }
  return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
}

// The axes that a course mirrors, as a type, so that code is compiled once for each.
template <unsigned kAxes>
struct Mirrored {
  static constexpr unsigned kMirrored = kAxes;
};
template <class Call>
[[gnu::always_inline]] inline int32_t with_mirrored(unsigned mirrored, const Call& call) {
  if constexpr (kFastRam) {
    return call(Mirrored<kAnySigns>{});
  }
  switch (mirrored) {
    case 0:
      return call(Mirrored<0>{});
    case 1:
      return call(Mirrored<1>{});
    case 2:
      return call(Mirrored<2>{});
    case 3:
      return call(Mirrored<3>{});
    case 4:
      return call(Mirrored<4>{});
    case 5:
      return call(Mirrored<5>{});
    case 6:
      return call(Mirrored<6>{});
    default:
      return call(Mirrored<7>{});
  }
}

// Traces one ray of direction `d`, whose signs are the course's.
template <int kC, class OneCourse>
int32_t trace_by_signs(const OneCourse& course, uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  return with_mirrored(course.mirrored, [&](auto axes) {
    return trace_one<kC, decltype(axes)::kMirrored>(course, d_a, d_b, d_c);
  });
}

}  // namespace
}  // namespace thimble::bricks
