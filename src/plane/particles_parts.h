// What the parts of the particle world share. Internal to src/.
#pragma once

// gcc packs neighbouring scalars, coordinates above all, into vector registers and takes them apart again:
// here that made a step a tenth slower. Before everything else, so that it holds for what is inlined too.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

#include "../base/bits.h"
#include "../base/integers.h"
#include "thimble/plane/particles.h"

namespace thimble {

// Ball::flags
inline constexpr uint8_t kAsleep = 1;  // not in the set of those awake, velocity 0
inline constexpr uint8_t kGrounded =
    2;  // under gravity, in its last step it came to lie on something that lies
inline constexpr uint8_t kSupports = 4;  // a sleeper may count on it

// A ball that keeps within so many cells of its place for so many steps may sleep.
inline constexpr int32_t kStillReach = 1;
inline constexpr uint8_t kStillSteps = 24;
inline constexpr int32_t kConfinedReach = 4;
inline constexpr uint8_t kConfinedSteps = 200;
// Steps that two must have kept to their places for their contact to be a lasting one, without bounces.
inline constexpr uint8_t kLastingSteps = 4;
// A ball that slides on something loses 1 / 2^this of its speed in a step.
inline constexpr int kFrictionShift = 5;

// Between 0.97 and 1.03 times the length, for normals, velocities and accelerations alike.
template <class Number>
constexpr Number rough_length(Number x, Number y) {
  x = x < 0 ? -x : x;
  y = y < 0 ? -y : y;
  const Number larger = x > y ? x : y;
  const Number smaller = x > y ? y : x;
  const Number slanted = larger - (larger >> 3) + (smaller >> 1);
  return larger > slanted ? larger : slanted;
}
constexpr int32_t rough_length(Vec2i v) {
  return rough_length(v.x, v.y);
}

constexpr int32_t held_within_limit(int64_t speed) {
  return speed > kMaxSpeedQ16    ? kMaxSpeedQ16
         : speed < -kMaxSpeedQ16 ? -kMaxSpeedQ16
                                 : static_cast<int32_t>(speed);
}

// Four times the square of a ball's speed half of `kick` later, below 2^62.
inline int64_t square_of(const particle_detail::Ball& ball, Vec2i kick) {
  const int32_t x = 2 * ball.vx + kick.x;
  const int32_t y = 2 * ball.vy + kick.y;
  return int64_t{x} * x + int64_t{y} * y;
}

// Cells of the index, [x0, x1] x [y0, y1], inclusive.
struct ParticleWorld::CellRange {
  int32_t x0, y0, x1, y1;

  // Calls `visit(id)` for the balls whose centres lie there, until it is false; it may remove that ball.
  template <class Visit>
  void each_ball(const ParticleWorld& world, const Visit& visit) const {
    for (int32_t y = y0; y <= y1; ++y) {
      for (int32_t x = x0; x <= x1; ++x) {
        for (uint32_t id = world.cells_[y * world.cells_across_ + x]; id != kNoBall;) {
          const uint32_t next = world.balls_[id].next;
          if (!visit(id)) {
            return;
          }
          id = next;
        }
      }
    }
  }
};

// Rows of the field or of a disc that are worked on together (bitfield.h). Where there are four, a ball of any size takes the
// same way through the code, sixteen rows with masks that are empty where there is nothing to do, so that the processor
// need not guess.
using Rows = field_detail::Block;
using field_detail::any_of;
using field_detail::for_rows;
using field_detail::load;
using field_detail::store;
inline constexpr int32_t kLanes = field_detail::kRowsAtOnce;
inline constexpr int32_t kBlock = kMaxSmallDisc;  // rows of a disc, and of a small window

// Bits 0 .. 15 for the rows that are not empty: gathered a few rows at a time, then put together.
#if defined(__SSE2__) || defined(__ARM_NEON)
inline Rows rows_that_have(Rows rows, int32_t first_row) {
  constexpr Rows kBits{1, 2, 4, 8};
  return (rows != 0) & (kBits << first_row);
}
inline uint32_t together(Rows bits) {
  typedef uint64_t Halves __attribute__((vector_size(16)));
  const Halves halves = reinterpret_cast<Halves>(bits);
  const uint64_t half = halves[0] | halves[1];
  return static_cast<uint32_t>(half) | static_cast<uint32_t>(half >> 32);
}
#else
inline Rows rows_that_have(Rows rows, int32_t first_row) {
  return (rows != 0 ? 1U : 0U) << first_row;
}
inline uint32_t together(Rows bits) {
  return bits;
}
#endif

// Where the rows of each disc begin: looked up, this is a third of the instructions of working it out.
struct DiscPlaces {
  uint16_t first[kMaxSmallDisc + 1] = {};
  constexpr DiscPlaces() {
    for (int32_t diameter = 0; diameter <= kMaxSmallDisc; ++diameter) {
      first[diameter] = static_cast<uint16_t>(field_detail::SmallDiscs::first(diameter));
    }
  }
};
inline constexpr DiscPlaces kDiscPlaces;
inline DiscStamp small_disc(int32_t diameter) {
  return {diameter, field_detail::kSmallDiscs.rows + kDiscPlaces.first[diameter]};
}

// A piece of the field around a ball, without the ball itself: row r, bit c is cell base + (c, r). What lies
// outside the box is set.
struct ParticleWorld::Window {
  static constexpr int32_t kSide = 32;  // at most so many columns and rows
  uint32_t rows[kSide + kBlock];        // as many as were loaded, and kBlock that mean nothing
  Vec2i base;
  Vec2i end;  // what was loaded is [base, end)

  bool covers(const CellBox& box) const {
    return ((box.low.x - base.x) | (box.low.y - base.y) | (end.x - box.high.x) | (end.y - box.high.y)) >= 0;
  }
  // Whether there are any in `box`, which lies in the window.
  bool any_in(const CellBox& box) const {
    uint32_t found = 0;
    for (int32_t row = box.low.y - base.y; row < box.high.y - base.y; ++row) {
      found |= rows[row];
    }
    return (found >> (box.low.x - base.x)) << (32 - (box.high.x - box.low.x)) != 0;
  }
  // The cells under a disc at `place`, which lies in the window, as rows from its corner on; which rows have
  // any, as bits.
  uint32_t under(const DiscStamp& disc, Vec2i place, uint32_t (&out)[kBlock]) const {
    const uint32_t* const from = rows + (place.y - base.y);
    const int32_t shift = place.x - base.x;
    Rows set{};
    for_rows(disc.diameter, [&](int32_t row) {
      const Rows found = (load(from + row) >> shift) & load(disc.rows + row);
      store(out + row, found);
      set |= rows_that_have(found, row);
    });
    return together(set);
  }
  bool is_free(const DiscStamp& disc, Vec2i place) const {
    const uint32_t* const from = rows + (place.y - base.y);
    const int32_t shift = place.x - base.x;
    Rows any{};
    for_rows(disc.diameter, [&](int32_t row) { any |= (load(from + row) >> shift) & load(disc.rows + row); });
    return !any_of(any);
  }
};

// Where and how the way of a ball ended early.
struct ParticleWorld::Blocked {
  static constexpr uint32_t kX = 1;       // the step along x meets something
  static constexpr uint32_t kY = 2;       // the step along y
  static constexpr uint32_t kCorner = 4;  // only the step along both
  uint32_t axes = 0;                      // 0: it did not end early
  Vec2i sign;                             // of the displacement
  Vec2i corner;                           // of the disc where it stands now
  uint32_t left_q16 = 0;                  // the part of the displacement that was not made
};

// What a disc would cover: balls in order of number, and walls.
struct ParticleWorld::Contacts {
  static constexpr int32_t kMost = 32;  // a disc of 16 cells meets no more balls in one step
  uint32_t ids[kMost];
  uint8_t axes[kMost];
  int32_t count = 0;
  bool wall = false;
  uint32_t wall_axes = 0;
  Vec2i wall_offset;  // of all cells of walls from the middle of the disc, in half cells, summed

  void add(uint32_t id, uint32_t axis_bits) {
    int32_t at = count;
    while (at > 0 && ids[at - 1] > id) {
      --at;
    }
    if (at > 0 && ids[at - 1] == id) {
      axes[at - 1] = static_cast<uint8_t>(axes[at - 1] | axis_bits);
      return;
    }
    if (count == kMost) {
      return;
    }
    for (int32_t i = count; i > at; --i) {
      ids[i] = ids[i - 1];
      axes[i] = axes[i - 1];
    }
    ids[at] = id;
    axes[at] = static_cast<uint8_t>(axis_bits);
    ++count;
  }
};

inline ParticleWorld::CellRange ParticleWorld::cells_around(const CellBox& box, int32_t reach) const {
  const auto first = [](int32_t value) { return value < 0 ? 0 : value; };
  const auto last = [](int32_t value, int32_t limit) { return value < limit ? value : limit - 1; };
  return {first((box.low.x - reach) >> cell_shift_), first((box.low.y - reach) >> cell_shift_),
          last((box.high.x - 1 + reach) >> cell_shift_, cells_across_),
          last((box.high.y - 1 + reach) >> cell_shift_, cells_down_)};
}

inline void ParticleWorld::set_awake_bit(uint32_t id) {
  awake_[id >> 5] |= uint32_t{1} << (id & 31);
  awake_middle_[id >> 10] |= uint32_t{1} << (id >> 5 & 31);
  awake_top_[id >> 15] |= uint32_t{1} << (id >> 10 & 31);
}

inline void ParticleWorld::clear_awake_bit(uint32_t id) {
  awake_[id >> 5] &= ~(uint32_t{1} << (id & 31));
  if (awake_[id >> 5] == 0) {
    awake_middle_[id >> 10] &= ~(uint32_t{1} << (id >> 5 & 31));
    if (awake_middle_[id >> 10] == 0) {
      awake_top_[id >> 15] &= ~(uint32_t{1} << (id >> 10 & 31));
    }
  }
}

// The first ball awake of number `from` or more, or kNoBall.
inline uint32_t ParticleWorld::next_awake(uint32_t from) const {
  // No bit is set from id_limit_ on.
  if (from >= id_limit_) {
    return kNoBall;
  }
  uint32_t word = awake_[from >> 5] >> (from & 31);
  if (word != 0) {
    return from + bits::lowest_bit(word);
  }
  const uint32_t leaf = (from >> 5) + 1;
  if (leaf >= (id_limit_ + 31) >> 5) {
    return kNoBall;
  }
  word = awake_middle_[leaf >> 5] >> (leaf & 31);
  uint32_t found = leaf;
  if (word != 0) {
    found += bits::lowest_bit(word);
  } else {
    uint32_t middle = (leaf >> 5) + 1;
    uint32_t top = middle >> 5;
    if (top >= top_words_) {
      return kNoBall;
    }
    word = awake_top_[top] >> (middle & 31);
    while (word == 0) {
      if (++top >= top_words_) {
        return kNoBall;
      }
      middle = top << 5;
      word = awake_top_[top];
    }
    middle += bits::lowest_bit(word);
    found = (middle << 5) + bits::lowest_bit(awake_middle_[middle]);
  }
  return (found << 5) + bits::lowest_bit(awake_[found]);
}

}  // namespace thimble
