// One step: the way of each ball awake through the field.
#include "particles_parts.h"

namespace thimble {
namespace {

using field_detail::Word;

// Bounces of one ball in one substep; what is left of its way after that is not made.
constexpr int kMostBounces = 4;
// What is lost in blows covers the gains of later ones for about 2^this steps.
constexpr int kForgetShift = 4;
// Crossings of cell boundaries that are looked at together, by one look at the box around them.
constexpr int32_t kStride = 16;
// A ball takes the short way when the box around both places is at most this wide, and kBlock high.
constexpr int32_t kShortWidth = 24;

// In fields larger than this, what a ball is about to look at is unlikely to be in the nearest cache.
constexpr size_t kFarFieldBytes = 256 * 1024;
constexpr uint32_t kLookAhead = 8;

constexpr int32_t towards(int32_t value) {
  return value < 0 ? -1 : 1;
}

// kLines + 16 - n: n full words, then empty ones.
constexpr uint32_t kLines[32] = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                 UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                 UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};

}  // namespace

// The cells of `box`, at most Window::kSide on a side, without those of `disc` at `own`. The box shares cells
// with the field.
void ParticleWorld::load_window(const CellBox& box, const DiscStamp& disc, Vec2i own, Window* window) const {
  window->base = box.low;
  window->end = box.high;
  const int32_t height = box.high.y - box.low.y;
  uint32_t* const out = window->rows;
  // Two words a row, of which one may lie beyond a side: it counts for nothing then, and what is outside is
  // set.
  const int32_t column = box.low.x >> 5;
  const int32_t shift = box.low.x & 31;
  const int32_t back = (32 - shift) & 31;
  const int32_t after = config_.width - box.low.x;
  const bool has_next = shift + box.high.x - box.low.x > 32 && column + 1 < field_.columns();
  const uint32_t first_mask = column < 0 ? 0 : UINT32_MAX;
  const uint32_t next_mask = has_next ? UINT32_MAX : 0;
  const uint32_t outside =
      (box.low.x < 0 ? (uint32_t{1} << -box.low.x) - 1 : 0) | (after < 32 ? UINT32_MAX << after : 0);
  const int32_t top = greater(-box.low.y, 0);
  const int32_t bottom = lesser(config_.height - box.low.y, height);
  const Word* const first = words_ + greater(column, 0) * config_.height + box.low.y;
  const Word* const next = has_next ? words_ + (column + 1) * config_.height + box.low.y : first;
  for (int32_t row = top; row < bottom; row += kLanes) {
    store(out + row,
          ((load(first + row) & first_mask) >> shift) | ((load(next + row) & next_mask) << back) | outside);
  }
  for (int32_t row = 0; row < top; ++row) {
    out[row] = UINT32_MAX;
  }
  for (int32_t row = bottom; row < height; ++row) {
    out[row] = UINT32_MAX;
  }
  const int32_t right = own.x - box.low.x;
  const int32_t down = own.y - box.low.y;
  if (right >= 0 && down >= 0 && right < Window::kSide && down < Window::kSide) {
    for_rows(disc.diameter, [&](int32_t row) {
      store(out + down + row, load(out + down + row) & ~(load(disc.rows + row) << right));
    });
  } else if (right > -Window::kSide && right < Window::kSide) {
    const int32_t last = lesser(disc.diameter, height - down);
    for (int32_t row = greater(0, -down); row < last; ++row) {
      out[down + row] &= ~(right < 0 ? disc.rows[row] >> -right : disc.rows[row] << right);
    }
  }
}

// Displacement of a substep for a velocity, to the nearest unit, halves away from zero. (Below zero that is
// upwards of what is a 2^-16 less than a half, so one is taken off before it is cut downwards.)
inline int32_t ParticleWorld::displacement(int32_t velocity) const {
  return ((velocity + round_ + (velocity >> 31)) & grid_) >> config_.substeps_log2;
}

void ParticleWorld::step() {
  counters_ = StepCounters{};
  if (pointer_mode_ != PointerMode::kNone) {
    apply_pointer();
  }
  const int32_t substeps = int32_t{1} << config_.substeps_log2;
  for (int32_t substep = 1; substep <= substeps; ++substep) {
    if (pulled_) {
      advance_all<true>(substep == substeps);
    } else {
      advance_all<false>(substep == substeps);
    }
  }
  if (owed_ > 0 && !lossless()) {
    owed_ -= owed_ >> kForgetShift;
  }
  ++steps_;
}

// After a step under gravity: counts how long a ball has kept to its place, and says whether that is long
// enough to sleep. Most balls do neither; there are no branches, since for many it is as good as random.
inline bool ParticleWorld::has_settled(Ball& ball) {
  const auto within = [](int32_t x, int32_t y, int32_t reach) -> uint32_t {
    return static_cast<uint32_t>(static_cast<uint32_t>(x + reach) <= static_cast<uint32_t>(2 * reach)) &
           static_cast<uint32_t>(static_cast<uint32_t>(y + reach) <= static_cast<uint32_t>(2 * reach));
  };
  const auto count = [](uint8_t steps, uint32_t kept, uint8_t most_steps) {
    return static_cast<uint8_t>((steps + (steps < most_steps ? 1U : 0U)) & (0U - kept));
  };
  const uint32_t near = within(ball.near_x, ball.near_y, kStillReach);
  const uint32_t confined = within(ball.far_x, ball.far_y, kConfinedReach);
  ball.near_x = static_cast<int8_t>(ball.near_x & -static_cast<int32_t>(near));
  ball.near_y = static_cast<int8_t>(ball.near_y & -static_cast<int32_t>(near));
  ball.far_x = static_cast<int8_t>(ball.far_x & -static_cast<int32_t>(confined));
  ball.far_y = static_cast<int8_t>(ball.far_y & -static_cast<int32_t>(confined));
  ball.still = count(ball.still, near, kStillSteps);
  ball.confined = count(ball.confined, confined, kConfinedSteps);
  return (ball.still >= kStillSteps) | (ball.confined >= kConfinedSteps);
}

template <bool kPulled>
void ParticleWorld::advance_all(bool last) {
  const bool large = field_.used_bytes() > kFarFieldBytes;
  for (uint32_t id = next_awake(0); id != kNoBall;) {
    if (large && id + kLookAhead < id_limit_) {
      // Balls lie in memory by number, but their cells anywhere: those of one soon to come are prefetched.
      const Ball& ahead = balls_[id + kLookAhead];
      const Word* const cells = words_ + (ahead.x >> 21) * config_.height + (ahead.y >> 16);
      __builtin_prefetch(cells - ahead.diameter / 2);
      __builtin_prefetch(cells + ahead.diameter / 2);
    }
    advance<kPulled>(id);
    Ball& ball = balls_[id];
    if (last && (kPulled ? has_settled(ball) : (ball.vx | ball.vy) == 0 || ball.still != 0)) {
      rest(id);
    }
    // The next one, which is most often the next number. Bits are read again, for balls may have woken.
    ++id;
    if ((id & 31) == 0 || (awake_[id >> 5] >> (id & 31) & 1U) == 0) {
      id = next_awake(id);
    }
  }
}

namespace {

// A disc of the field that goes from one place to another, both in a box of at most 31 x kBlock cells that
// lies in the field. Rows and shifts are those of the box.
struct Shift {
  Word* column;          // the box's first row, in the column of words of its left edge
  Word* beyond;          // and in the one after that, for `wide`
  const uint32_t* own;   // the disc's rows where it is, from the box's first row on
  const uint32_t* next;  // and where it goes
  int32_t own_right;     // how far right in the box it is
  int32_t next_right;    // and where it goes
  int32_t right;         // of the box in its column
  int32_t height;        // of the box
  bool wide;             // the box reaches into the column after

  // `low` is the lesser of both corners on each axis, `way` from one to the other.
  Shift(Word* words, int32_t field_height, const DiscStamp& disc, Vec2i from, Vec2i low, Vec2i way) {
    column = words + (low.x >> 5) * field_height + low.y;
    beyond = column + field_height;
    own = disc.rows + (low.y - from.y);
    next = own - way.y;
    own_right = from.x - low.x;
    next_right = own_right + way.x;
    right = low.x & 31;
    height = disc.diameter + (from.y - low.y) * 2 + way.y;
    wide = right + own_right + next_right + disc.diameter > 32;  // one of the two is 0
  }
  // The cells that differ.
  Rows changed(int32_t row) const {
    return (load(own + row) << own_right) ^ (load(next + row) << next_right);
  }
  // Makes them differ.
  void put() const {
    for_rows(height,
             [this](int32_t row) { store(column + row, load(column + row) ^ (changed(row) << right)); });
    if (wide) {
      for_rows(height, [this](int32_t row) {
        store(beyond + row, load(beyond + row) ^ (changed(row) >> (32 - right)));
      });
    }
  }
};

// The cells that a disc may cover on any way from its place to the next, in the rows of a Shift, without its
// own. Where it goes no further than its outermost rows are long, that is its first and last place, moved
// together by the way across: the box with the disc's own round corners.
struct RoundSweep {
  int32_t across;
  Rows operator()(const Shift& shift, int32_t row) const {
    const Rows own = load(shift.own + row);
    const Rows either = own | load(shift.next + row);
    return (either | (either << across)) & ~(own << shift.own_right);
  }
};
// Else it is all of the box.
struct BoxSweep {
  const uint32_t* lines;
  uint32_t columns;
  Rows operator()(const Shift& shift, int32_t row) const {
    return load(lines + row) & columns & ~(load(shift.own + row) << shift.own_right);
  }
};

// Does `visit(0)`, `visit(1)` and so on for each four of 12 or 16 rows: a loop that the compiler cannot leave
// one.
template <int32_t kMostRows, class Visit>
__attribute__((always_inline)) inline void for_blocks(Visit visit) {
  visit(0);
  visit(1);
  visit(2);
  if constexpr (kMostRows > 12) {
    visit(3);
  }
}

// Puts the disc elsewhere when nothing is in its sweep; says whether it did. kWide as shift.wide; kMostRows
// is no less than shift.height.
template <bool kWide, int32_t kMostRows, class Sweep>
__attribute__((always_inline)) inline bool put_if_free(const Shift& shift, const Sweep& sweep) {
  const int32_t back = 32 - shift.right;
  Rows found{};
  if constexpr (kLanes > 1) {
    // The new rows wait in registers for what is found.
    Rows low[4];
    Rows high[4];
    for_blocks<kMostRows>([&](int32_t i) __attribute__((always_inline)) {
      const int32_t row = i * kLanes;
      const Rows swept = sweep(shift, row);
      const Rows changed = shift.changed(row);
      const Rows cells = load(shift.column + row);
      found |= cells & (swept << shift.right);
      low[i] = cells ^ (changed << shift.right);
      if constexpr (kWide) {
        const Rows cells_beyond = load(shift.beyond + row);
        found |= cells_beyond & (swept >> back);
        high[i] = cells_beyond ^ (changed >> back);
      }
    });
    if (any_of(found)) {
      return false;
    }
    for_blocks<kMostRows>([&](int32_t i)
                              __attribute__((always_inline)) { store(shift.column + i * kLanes, low[i]); });
    if constexpr (kWide) {
      // After those, some of which may be the same words, where the field is less high than these rows.
      for_blocks<kMostRows>([&](int32_t i) __attribute__((always_inline)) {
        store(shift.beyond + i * kLanes, high[i]);
      });
    }
    return true;
  }
  for (int32_t row = 0; row < shift.height; ++row) {
    const Rows swept = sweep(shift, row);
    found |= load(shift.column + row) & (swept << shift.right);
    if constexpr (kWide) {
      found |= load(shift.beyond + row) & (swept >> back);
    }
  }
  if (any_of(found)) {
    return false;
  }
  shift.put();
  return true;
}
template <int32_t kMostRows, class Sweep>
__attribute__((always_inline)) inline bool put_where_free(const Shift& shift, const Sweep& sweep) {
  return shift.wide ? put_if_free<true, kMostRows>(shift, sweep)
                    : put_if_free<false, kMostRows>(shift, sweep);
}

}  // namespace

template <bool kPulled>
__attribute__((always_inline)) inline void ParticleWorld::advance(uint32_t id) {
  Ball& ball = balls_[id];
  if (kPulled) {
    ball.flags = static_cast<uint8_t>(ball.flags & ~kGrounded);
    if (id != dragged_) {
      const auto faster = [](int32_t* speed, int32_t more) {
        *speed += more;
        if (*speed > kMaxSpeedQ16 || *speed < -kMaxSpeedQ16) {
          *speed = *speed < 0 ? -kMaxSpeedQ16 : kMaxSpeedQ16;
        }
      };
      faster(&ball.vx, gravity_part_.x);
      faster(&ball.vy, gravity_part_.y);
    }
  }
  const Vec2i way{displacement(ball.vx), displacement(ball.vy)};
  if (kPulled && lossless() && id != dragged_) {
    // What the rounding of the way is worth.
    const int64_t pulled = int64_t{gravity_part_.x} * ball.vx + int64_t{gravity_part_.y} * ball.vy;
    account((pulled - fall(gravity_part_, way)) * 8, uint32_t{ball.diameter} * ball.diameter);
  }
  if ((way.x | way.y) == 0) {
    return;
  }
  ++counters_.moves;
  const Vec2i start{ball.x, ball.y};
  Vec2i end{start.x + way.x, start.y + way.y};
  const int32_t diameter = ball.diameter;
  const Vec2i from{disc_corner(start.x, diameter), disc_corner(start.y, diameter)};
  Vec2i gone{disc_corner(end.x, diameter) - from.x, disc_corner(end.y, diameter) - from.y};
  if ((gone.x | gone.y) != 0) {
    const Vec2i back{gone.x & (gone.x >> 31), gone.y & (gone.y >> 31)};
    const Vec2i low{from.x + back.x, from.y + back.y};
    const int32_t across = gone.x - 2 * back.x;
    const int32_t down = gone.y - 2 * back.y;
    const int32_t width = across + diameter;
    const int32_t height = down + diameter;
    const DiscStamp disc = small_disc(diameter);
    bool made = false;
    if ((low.x | low.y | (config_.width - width - low.x) | (config_.height - height - low.y) |
         (kShortWidth - width) | (kBlock - height)) >= 0) {
      ++counters_.mask_tests;
      const Shift shift(words_, config_.height, disc, from, low, gone);
      const int32_t round = static_cast<int32_t>(bits::popcount32(disc.rows[0]));
      if (across <= round && down <= round) {
        const RoundSweep sweep{across};
        made =
            kLanes > 1 && height <= 12 ? put_where_free<12>(shift, sweep) : put_where_free<16>(shift, sweep);
      } else {
        made = put_where_free<16>(shift, BoxSweep{kLines + kBlock - height, (uint32_t{1} << width) - 1});
      }
    }
    if (!made) {
      trace(id, way, from, ((kShortWidth - width) | (kBlock - height)) >= 0);
      end = {ball.x, ball.y};
      gone = {disc_corner(end.x, diameter) - from.x, disc_corner(end.y, diameter) - from.y};
    }
  }
  ball.x = end.x;
  ball.y = end.y;
  // Both cells as one difference: the coordinates of a cell are what stands above its side.
  const int32_t in_cell = 16 + cell_shift_;
  if ((((end.x ^ start.x) | (end.y ^ start.y)) >> in_cell) != 0) {
    unlink(id, cell_of(start.x, start.y));
    link(id);
  }
  if (kPulled) {
    if ((gone.x | gone.y) != 0) {
      const auto cut = [](int32_t cells) { return clamped(cells, -100, 100); };
      if (config_.substeps_log2 == 0) {
        // The sums begin within the reach of the last step: they cannot leave a byte.
        const Vec2i cells{cut(gone.x), cut(gone.y)};
        ball.near_x = static_cast<int8_t>(ball.near_x + cells.x);
        ball.near_y = static_cast<int8_t>(ball.near_y + cells.y);
        ball.far_x = static_cast<int8_t>(ball.far_x + cells.x);
        ball.far_y = static_cast<int8_t>(ball.far_y + cells.y);
      } else {
        ball.near_x = static_cast<int8_t>(cut(ball.near_x + gone.x));
        ball.near_y = static_cast<int8_t>(cut(ball.near_y + gone.y));
        ball.far_x = static_cast<int8_t>(cut(ball.far_x + gone.x));
        ball.far_y = static_cast<int8_t>(cut(ball.far_y + gone.y));
      }
      if ((ball.flags & kSupports) != 0) {
        ball.flags = static_cast<uint8_t>(ball.flags & ~kSupports);
        support_left({from, {from.x + diameter, from.y + diameter}}, ball.confined < kStillSteps);
      }
    }
  }
}

// The way of a ball with its bounces, where something may be in it. The ball's cells in the field stay at
// `own`, its corner, until the end. `looked`: something is near the way, a side of
// the box at least.
void ParticleWorld::trace(uint32_t id, Vec2i way, Vec2i own, bool looked) {
  Ball& ball = balls_[id];
  const Vec2i start{ball.x, ball.y};
  const Vec2i kick = id == dragged_ ? Vec2i{} : gravity_part_;
  const int64_t before = square_of(ball, kick) - fall(kick, way) * 8;
  Window window;
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    const Blocked blocked = walk(&ball, way, own, bounce == 0, looked && bounce == 0, &window);
    if (blocked.axes == 0) {
      break;
    }
    collide(id, blocked, window, own);
    const auto rest_of = [&blocked, this](int32_t velocity) {
      const int32_t whole = displacement(velocity);
      const uint64_t part = (uint64_t{magnitude_32(whole)} * blocked.left_q16) >> 16;
      const int32_t size =
          static_cast<int32_t>(static_cast<uint32_t>(part) & ~(static_cast<uint32_t>(unit_) - 1));
      return whole < 0 ? -size : size;
    };
    way = {rest_of(ball.vx), rest_of(ball.vy)};
    // Along what blocked it, it only gets on by turning round.
    if ((blocked.axes & (Blocked::kX | Blocked::kCorner)) != 0 && way.x * int64_t{blocked.sign.x} > 0) {
      way.x = 0;
    }
    if ((blocked.axes & (Blocked::kY | Blocked::kCorner)) != 0 && way.y * int64_t{blocked.sign.y} > 0) {
      way.y = 0;
    }
    if ((way.x | way.y) == 0) {
      break;
    }
  }
  if (pulled_) {
    const Vec2i made{ball.x - start.x, ball.y - start.y};
    settle(ball, kick, square_of(ball, kick) - before - fall(kick, made) * 8);
  }
  const Vec2i corner = corner_of(ball);
  if (corner == own) {
    return;
  }
  const DiscStamp disc = small_disc(ball.diameter);
  const Vec2i low{lesser(corner.x, own.x), lesser(corner.y, own.y)};
  if (greater(corner.x, own.x) - low.x + disc.diameter > kShortWidth ||
      greater(corner.y, own.y) - low.y + disc.diameter > kBlock) {
    field_.clear_inside(disc, own);
    field_.set_inside(disc, corner);
    return;
  }
  Shift(words_, config_.height, disc, own, low, {corner.x - own.x, corner.y - own.y}).put();
}

// A line along which a disc moves, and the boundaries between cells that its corner has still to cross on it.
struct ParticleWorld::Line {
  Vec2i start;      // the centre
  Vec2i sign;       // which way it goes
  Vec2i length;     // how far
  Vec2i first;      // distance to the first boundary, odd
  Vec2i crossings;  // boundaries in all
  Vec2i left;       // still to be crossed
  Vec2i corner;     // of the disc, where it stands
  int64_t order;    // positive: the next boundary across y comes first
  int64_t order_x;  // what crossing one adds or takes
  int64_t order_y;

  // As a centre never lies on a boundary, they are as many as the corner goes cells.
  Line(Vec2i from, Vec2i way, Vec2i corner_from, Vec2i corner_to, int32_t half)
      : start(from),
        sign{towards(way.x), towards(way.y)},
        length{static_cast<int32_t>(magnitude_32(way.x)), static_cast<int32_t>(magnitude_32(way.y))},
        first{32768 - sign.x * (from.x - corner_from.x * 65536 - half),
              32768 - sign.y * (from.y - corner_from.y * 65536 - half)},
        crossings{static_cast<int32_t>(magnitude_32(corner_to.x - corner_from.x)),
                  static_cast<int32_t>(magnitude_32(corner_to.y - corner_from.y))},
        left(crossings),
        corner(corner_from),
        order(int64_t{first.x} * length.y - int64_t{first.y} * length.x),
        order_x(int64_t{length.y} << 16),
        order_y(int64_t{length.x} << 16) {}

  bool done() const { return (left.x | left.y) == 0; }
  // Which boundary comes next, as bits of Blocked.
  uint32_t next_axes() const {
    if (left.x == 0) {
      return Blocked::kY;
    }
    if (left.y == 0) {
      return Blocked::kX;
    }
    return order < 0 ? Blocked::kX : order > 0 ? Blocked::kY : Blocked::kX | Blocked::kY;
  }
  void take(uint32_t axes) {
    if ((axes & Blocked::kX) != 0) {
      --left.x;
      order += order_x;
      corner.x += sign.x;
    }
    if ((axes & Blocked::kY) != 0) {
      --left.y;
      order -= order_y;
      corner.y += sign.y;
    }
  }
  // What part of the line ends at the next boundary across `axis`, of 65536.
  uint32_t part_q16(int axis) const {
    const uint32_t reached =
        static_cast<uint32_t>(first[axis]) + (static_cast<uint32_t>(crossings[axis] - left[axis]) << 16);
    const int excess = greater(bits::bit_length(static_cast<uint32_t>(length[axis])) - 16, 0);
    return ((reached >> excess) << 16) / (static_cast<uint32_t>(length[axis]) >> excess);
  }
  // The centre after that part, in whole units: on the way, but within the cell in which the disc stands, and
  // short of a boundary.
  int32_t place(int axis, uint32_t came_q16, int32_t half, int32_t unit) const {
    const int32_t middle = corner[axis] * 65536 + half;
    const uint32_t part =
        static_cast<uint32_t>((uint64_t{static_cast<uint32_t>(length[axis])} * came_q16) >> 16) &
        ~(static_cast<uint32_t>(unit) - 1);
    const int32_t reach = 32768 - (unit >> 1);
    const int32_t offset = start[axis] + sign[axis] * static_cast<int32_t>(part) - middle;
    return middle + clamped(offset, -reach, reach);
  }
};

// Moves a ball along the line of `way` as far as its disc is free, and says what ended it. The boundaries
// between cells are crossed in their exact order along the line; both at once where it goes through a corner.
// `first_walk`: the window is not loaded yet. `looked`: something is known to be near the way.
ParticleWorld::Blocked ParticleWorld::walk(Ball* ball, Vec2i way, Vec2i own, bool first_walk, bool looked,
                                           Window* window) {
  const DiscStamp disc = small_disc(ball->diameter);
  const int32_t half = disc.diameter * 32768;
  const Vec2i from = corner_of(*ball);
  const Vec2i start{ball->x, ball->y};
  ball->x += way.x;
  ball->y += way.y;
  const Vec2i goal = corner_of(*ball);
  Blocked blocked;
  if (goal == from) {
    return blocked;
  }
  Line line(start, way, from, goal, half);
  const auto free_at = [&](Vec2i place) {
    ++counters_.mask_tests;
    return window->is_free(disc, place);
  };
  int32_t careful = 0;  // crossings to be looked at one by one
  uint32_t axes = 0;
  for (;;) {
    if (careful == 0) {
      // The next stretch of the way, at one look; when something is there, it is gone again cell by cell.
      careful = kStride;
      const Vec2i left_before = line.left;
      const Vec2i corner_before = line.corner;
      const int64_t order_before = line.order;
      if (line.left.x + line.left.y <= kStride) {
        line.corner = goal;
        line.left = {0, 0};
      } else {
        for (int32_t i = 0; i < kStride && !line.done(); ++i) {
          line.take(line.next_axes());
        }
      }
      const CellBox box{{lesser(line.corner.x, corner_before.x), lesser(line.corner.y, corner_before.y)},
                        {greater(line.corner.x, corner_before.x) + disc.diameter,
                         greater(line.corner.y, corner_before.y) + disc.diameter}};
      const Vec2i size{box.high.x - box.low.x, box.high.y - box.low.y};
      if (first_walk || !window->covers(box)) {
        // With room to turn round.
        const int32_t margin = lesser(greater(size.x, size.y) - disc.diameter + 1,
                                      (Window::kSide - greater(size.x, size.y)) >> 1);
        load_window({{box.low.x - margin, box.low.y - margin}, {box.high.x + margin, box.high.y + margin}},
                    disc, own, window);
      }
      const int32_t stretch = left_before.x + left_before.y - line.left.x - line.left.y;
      if (stretch > 2 && !looked && !window->any_in(box)) {
        if (line.done()) {
          return blocked;
        }
        careful = 0;
        continue;
      }
      line.left = left_before;
      line.corner = corner_before;
      line.order = order_before;
    }
    --careful;
    axes = line.next_axes();
    if (!free_at({line.corner.x + ((axes & Blocked::kX) != 0 ? line.sign.x : 0),
                  line.corner.y + ((axes & Blocked::kY) != 0 ? line.sign.y : 0)})) {
      break;
    }
    line.take(axes);
    if (line.done()) {
      return blocked;
    }
  }
  blocked.axes = axes;
  if (axes == (Blocked::kX | Blocked::kY)) {
    const bool free_x = free_at({line.corner.x + line.sign.x, line.corner.y});
    const bool free_y = free_at({line.corner.x, line.corner.y + line.sign.y});
    if (free_x && free_y) {
      blocked.axes = Blocked::kCorner;
    } else if (free_x) {
      line.take(Blocked::kX);
      blocked.axes = Blocked::kY;
    } else if (free_y) {
      line.take(Blocked::kY);
      blocked.axes = Blocked::kX;
    }
  }
  // How far it came: to the boundary that it could not cross.
  const uint32_t came_q16 = line.part_q16((blocked.axes & (Blocked::kX | Blocked::kCorner)) != 0 ? 0 : 1);
  blocked.left_q16 = 65536U - came_q16;
  blocked.sign = line.sign;
  blocked.corner = line.corner;
  ball->x = line.place(0, came_q16, half, unit_);
  ball->y = line.place(1, came_q16, half, unit_);
  return blocked;
}

}  // namespace thimble
