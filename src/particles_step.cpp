// One step: the way of each ball awake through the field.
#include "particles_parts.h"

namespace thimble {
namespace {

using field_detail::Word;

// Bounces of one ball in one substep; what is left of its way after that is not made.
constexpr int kMostBounces = 4;
// Crossings of cell boundaries that are looked at together, by one look at the box around them.
constexpr int32_t kStride = 16;
// Displacements of up to this many cells on each axis take the short way.
constexpr int32_t kShortWay = 8;

// In fields larger than this, what a ball is about to look at is unlikely to be in the nearest cache.
constexpr size_t kFarFieldBytes = 256 * 1024;
constexpr uint32_t kLookAhead = 8;

constexpr int32_t sign_of(int32_t value) {
  return value < 0 ? -1 : 1;
}
constexpr uint32_t magnitude(int32_t value) {
  return value < 0 ? 0U - static_cast<uint32_t>(value) : static_cast<uint32_t>(value);
}
constexpr int32_t least(int32_t a, int32_t b) {
  return a < b ? a : b;
}
constexpr int32_t most(int32_t a, int32_t b) {
  return a > b ? a : b;
}

// kLines + 16 - n: n full words, then empty ones.
constexpr uint32_t kLines[32] = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                 UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                 UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};

}  // namespace

// The cells of `box`, at most Window::kSide on a side, without those of `disc` at `own`.
void ParticleWorld::load_window(const CellBox& box, const DiscStamp& disc, Vec2i own, Window* window) const {
  window->base = box.min;
  const int32_t height = box.max.y - box.min.y;
  uint32_t* const out = window->rows;
  if (box.min.x >= 0 && box.min.y >= 0 && box.max.x <= config_.width && box.max.y <= config_.height) {
    const int32_t shift = box.min.x & 31;
    const Word* const column = words_ + (box.min.x >> 5) * config_.height + box.min.y;
    // Where the box does not reach beyond the column it does not matter what is taken for the next.
    const bool wide = shift + (box.max.x - box.min.x) > 32;
    const Word* const beyond = wide ? column + config_.height : column;
    for (int32_t row = 0; row < height; row += kLanes) {
      store_rows(out + row,
                 (load_rows(column + row) >> shift) | ((load_rows(beyond + row) << 1) << (31 - shift)));
    }
  } else {
    for (int32_t row = 0; row < height; ++row) {
      const int32_t y = box.min.y + row;
      out[row] = UINT32_MAX;
      if (y >= 0 && y < config_.height) {
        out[row] = field_.window(box.min.x, y);
        const int32_t before = -box.min.x;
        const int32_t after = config_.width - box.min.x;
        if (before > 0) {
          out[row] |= before >= 32 ? UINT32_MAX : (uint32_t{1} << before) - 1;
        }
        if (after < 32) {
          out[row] |= after <= 0 ? UINT32_MAX : UINT32_MAX << after;
        }
      }
    }
  }
  const int32_t right = own.x - box.min.x;
  const int32_t down = own.y - box.min.y;
  if (right <= -Window::kSide || right >= Window::kSide) {
    return;
  }
  const int32_t last = least(disc.diameter, height - down);
  for (int32_t row = most(0, -down); row < last; ++row) {
    out[down + row] &= ~(right < 0 ? disc.rows[row] >> -right : disc.rows[row] << right);
  }
}

// Displacement of a substep for a velocity, to the nearest unit, halves away from zero.
inline int32_t ParticleWorld::displacement(int32_t velocity) const {
  const uint32_t sign = static_cast<uint32_t>(velocity >> 31);
  const uint32_t size =
      (((static_cast<uint32_t>(velocity) ^ sign) - sign + round_) >> config_.substeps_log2) &
      (0U - static_cast<uint32_t>(unit_));
  return static_cast<int32_t>((size ^ sign) - sign);
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
  ++steps_;
}

template <bool kPulled>
void ParticleWorld::advance_all(bool last) {
  const bool large = field_.used_bytes() > kFarFieldBytes;
  for (uint32_t id = next_awake(0); id != kNoBall; id = next_awake(id + 1)) {
    if (large && id + kLookAhead < id_limit_) {
      // Balls lie in memory by number, but their cells anywhere: those of one soon to come are asked for now.
      const Ball& ahead = balls_[id + kLookAhead];
      const Word* const cells = words_ + (ahead.x >> 21) * config_.height + (ahead.y >> 16);
      __builtin_prefetch(cells - ahead.diameter / 2);
      __builtin_prefetch(cells + ahead.diameter / 2);
    }
    advance<kPulled>(id);
    const Ball& ball = balls_[id];
    if (last && (kPulled || (ball.vx | ball.vy) == 0 || ball.still != 0)) {
      rest(id);
    }
  }
}

template <bool kPulled>
inline void ParticleWorld::advance(uint32_t id) {
  Ball& ball = balls_[id];
  if (kPulled) {
    ball.flags = static_cast<uint8_t>(ball.flags & ~kGrounded);
    if (id != dragged_) {
      ball.vx = least(most(ball.vx + gravity_part_.x, -kMaxSpeedQ16), kMaxSpeedQ16);
      ball.vy = least(most(ball.vy + gravity_part_.y, -kMaxSpeedQ16), kMaxSpeedQ16);
    }
  }
  const Vec2i way{displacement(ball.vx), displacement(ball.vy)};
  if ((way.x | way.y) == 0) {
    return;
  }
  ++counters_.moves;
  const Vec2i start{ball.x, ball.y};
  const Vec2i end{start.x + way.x, start.y + way.y};
  const int32_t diameter = ball.diameter;
  const Vec2i from{disc_corner(start.x, diameter), disc_corner(start.y, diameter)};
  const Vec2i to{disc_corner(end.x, diameter), disc_corner(end.y, diameter)};
  if (from == to) {
    ball.x = end.x;
    ball.y = end.y;
  } else {
    const DiscStamp disc = small_disc(diameter);
    const CellBox box{{least(from.x, to.x), least(from.y, to.y)},
                      {most(from.x, to.x) + diameter, most(from.y, to.y) + diameter}};
    const int32_t width = box.max.x - box.min.x;
    const int32_t height = box.max.y - box.min.y;
    Window window;
    ++counters_.mask_tests;
    const bool loaded = width <= kBlock + kShortWay && height <= kBlock && (box.min.x | box.min.y) >= 0 &&
                        box.max.x <= config_.width && box.max.y <= config_.height;
    bool made = false;
    if (loaded) {
      // What the disc could cover on any way from corner to corner: where that holds nothing but the ball,
      // the ball is simply put elsewhere.
      window.base = box.min;
      const int32_t shift = box.min.x & 31;
      const int32_t back = 32 - shift;
      Word* const column = words_ + (box.min.x >> 5) * config_.height + box.min.y;
      Word* const beyond = column + config_.height;
      const bool wide = shift + width > 32;
      const uint32_t* const own = disc.rows + (box.min.y - from.y);
      const uint32_t* const next = disc.rows + (box.min.y - to.y);
      const int32_t own_shift = from.x - box.min.x;
      const int32_t next_shift = to.x - box.min.x;
      Rows found{};
      const auto look = [&](auto&& reach_of) {
        if (wide) {
          for_rows(height, [&](int32_t row) {
            const Rows cells = ((load_rows(column + row) >> shift) | (load_rows(beyond + row) << back)) &
                               ~(load_rows(own + row) << own_shift);
            store_rows(window.rows + row, cells);
            found |= cells & reach_of(row);
          });
        } else {
          for_rows(height, [&](int32_t row) {
            const Rows cells = (load_rows(column + row) >> shift) & ~(load_rows(own + row) << own_shift);
            store_rows(window.rows + row, cells);
            found |= cells & reach_of(row);
          });
        }
      };
      // Where it goes no further than its outermost rows are long, that is its first and last place, moved
      // together by the way across: the box with the disc's own round corners.
      const int32_t across = width - diameter;
      const int32_t round = static_cast<int32_t>(bits::popcount32(disc.rows[0]));
      if (across <= round && height - diameter <= round) {
        look([&](int32_t row) {
          const Rows either = load_rows(own + row) | load_rows(next + row);
          return either | (either << across);
        });
      } else {
        const uint32_t* const lines = kLines + kBlock - height;
        const uint32_t columns = (uint32_t{1} << width) - 1;
        look([&](int32_t row) { return load_rows(lines + row) & columns; });
      }
      if (any_of(found) == 0) {
        for_rows(height, [&](int32_t row) {
          const Rows clear = (load_rows(own + row) << own_shift) << shift;
          const Rows set = (load_rows(next + row) << next_shift) << shift;
          store_rows(column + row, (load_rows(column + row) & ~clear) | set);
        });
        if (wide) {
          for_rows(height, [&](int32_t row) {
            const Rows clear = (load_rows(own + row) << own_shift) >> back;
            const Rows set = (load_rows(next + row) << next_shift) >> back;
            store_rows(beyond + row, (load_rows(beyond + row) & ~clear) | set);
          });
        }
        ball.x = end.x;
        ball.y = end.y;
        made = true;
      }
    }
    if (!made) {
      trace(id, way, from, loaded, &window);
      const Vec2i corner = corner_of(ball);
      if (corner != from) {
        field_.clear_inside(disc, from);
        field_.set_inside(disc, corner);
      }
    }
  }
  // Both cells as one difference: the coordinates of a cell are what stands above its side.
  const int32_t in_cell = 16 + cell_shift_;
  if ((((ball.x ^ start.x) | (ball.y ^ start.y)) >> in_cell) != 0) {
    relink(id, cell_of(start.x, start.y), cell_of(ball.x, ball.y));
  }
  if (kPulled) {
    const Vec2i corner = corner_of(ball);
    if (corner != from) {
      const auto add = [](int8_t* sum, int32_t cells) {
        *sum = static_cast<int8_t>(least(most(*sum + cells, -100), 100));
      };
      add(&ball.near_x, corner.x - from.x);
      add(&ball.near_y, corner.y - from.y);
      add(&ball.far_x, corner.x - from.x);
      add(&ball.far_y, corner.y - from.y);
      if ((ball.flags & kSupports) != 0) {
        ball.flags = static_cast<uint8_t>(ball.flags & ~kSupports);
        support_left({from, {from.x + diameter, from.y + diameter}}, ball.confined < kStillSteps);
      }
    }
  }
}

// The way of a ball whose cells in the field stay at `own` meanwhile, with its bounces. With `loaded`, the
// window holds the box around all of the way and something is in that.
void ParticleWorld::trace(uint32_t id, Vec2i way, Vec2i own, bool loaded, Window* window) {
  Ball& ball = balls_[id];
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    const Blocked blocked = walk(&ball, way, own, loaded && bounce == 0, window);
    if (blocked.axes == 0) {
      return;
    }
    collide(id, blocked, *window, own);
    const auto rest_of = [&blocked, this](int32_t velocity) {
      const int32_t whole = displacement(velocity);
      const uint64_t part = (uint64_t{magnitude(whole)} * blocked.left_q16) >> 16;
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
      return;
    }
  }
}

// Moves a ball along the line of `way` as far as its disc is free, and says what ended it. The boundaries
// between cells are crossed in their exact order along the line; both at once where it goes through a corner.
ParticleWorld::Blocked ParticleWorld::walk(Ball* ball, Vec2i way, Vec2i own, bool loaded, Window* window) {
  const DiscStamp disc = small_disc(ball->diameter);
  Blocked blocked;
  Vec2i corner = corner_of(*ball);
  const Vec2i sign{sign_of(way.x), sign_of(way.y)};
  const int32_t length[2] = {static_cast<int32_t>(magnitude(way.x)), static_cast<int32_t>(magnitude(way.y))};
  const int32_t start[2] = {ball->x, ball->y};
  // Distance to the first boundary, odd, and crossings on the way.
  const int32_t half = ball->diameter * 32768;
  const int32_t first[2] = {32768 - sign.x * (ball->x - corner.x * 65536 - half),
                            32768 - sign.y * (ball->y - corner.y * 65536 - half)};
  const int32_t crossings[2] = {(length[0] - first[0] + 65536) >> 16, (length[1] - first[1] + 65536) >> 16};
  int32_t done[2] = {0, 0};
  // Positive: the next boundary across y comes first.
  int64_t order = int64_t{first[0]} * length[1] - int64_t{first[1]} * length[0];
  const int64_t order_x = int64_t{length[1]} << 16;
  const int64_t order_y = int64_t{length[0]} << 16;
  // Which boundary comes next, as bits of Blocked.
  const auto next_axes = [&]() -> uint32_t {
    if (done[0] == crossings[0]) {
      return Blocked::kY;
    }
    if (done[1] == crossings[1]) {
      return Blocked::kX;
    }
    return order < 0 ? Blocked::kX : order > 0 ? Blocked::kY : Blocked::kX | Blocked::kY;
  };
  const auto take = [&](uint32_t axes) {
    if ((axes & Blocked::kX) != 0) {
      ++done[0];
      order += order_x;
      corner.x += sign.x;
    }
    if ((axes & Blocked::kY) != 0) {
      ++done[1];
      order -= order_y;
      corner.y += sign.y;
    }
  };
  int32_t careful = loaded ? INT32_MAX : 0;  // crossings to be looked at one by one
  const auto free_at = [&](Vec2i place) {
    ++counters_.mask_tests;
    return window->is_free(disc, place);
  };
  while (done[0] < crossings[0] || done[1] < crossings[1]) {
    if (careful == 0) {
      // The next stretch of the way, at one look; when something is there, it is gone again cell by cell.
      careful = kStride;
      const int32_t done_before[2] = {done[0], done[1]};
      const Vec2i corner_before = corner;
      const int64_t order_before = order;
      for (int32_t i = 0; i < kStride && (done[0] < crossings[0] || done[1] < crossings[1]); ++i) {
        take(next_axes());
      }
      ++counters_.mask_tests;
      const CellBox box{
          {least(corner.x, corner_before.x), least(corner.y, corner_before.y)},
          {most(corner.x, corner_before.x) + disc.diameter, most(corner.y, corner_before.y) + disc.diameter}};
      load_window(box, disc, own, window);
      uint32_t found = 0;
      for (int32_t row = 0; row < box.max.y - box.min.y; ++row) {
        found |= window->rows[row];
      }
      if ((found << (32 - (box.max.x - box.min.x))) == 0) {
        careful = 0;
        continue;
      }
      done[0] = done_before[0];
      done[1] = done_before[1];
      corner = corner_before;
      order = order_before;
    }
    --careful;
    const uint32_t axes = next_axes();
    if (axes != (Blocked::kX | Blocked::kY)) {
      const Vec2i place{corner.x + ((axes & Blocked::kX) != 0 ? sign.x : 0),
                        corner.y + ((axes & Blocked::kY) != 0 ? sign.y : 0)};
      if (free_at(place)) {
        take(axes);
        continue;
      }
      blocked.axes = axes;
      break;
    }
    if (free_at({corner.x + sign.x, corner.y + sign.y})) {
      take(axes);
      continue;
    }
    const bool free_x = free_at({corner.x + sign.x, corner.y});
    const bool free_y = free_at({corner.x, corner.y + sign.y});
    if (free_x && free_y) {
      blocked.axes = Blocked::kCorner;
    } else if (free_x) {
      take(Blocked::kX);
      blocked.axes = Blocked::kY;
    } else if (free_y) {
      take(Blocked::kY);
      blocked.axes = Blocked::kX;
    } else {
      blocked.axes = axes;
    }
    break;
  }
  if (blocked.axes == 0) {
    ball->x += way.x;
    ball->y += way.y;
    return blocked;
  }
  // How far it came: to the boundary that it could not cross.
  const int axis = (blocked.axes & (Blocked::kX | Blocked::kCorner)) != 0 ? 0 : 1;
  const uint32_t reached = static_cast<uint32_t>(first[axis]) + (static_cast<uint32_t>(done[axis]) << 16);
  const int excess = most(bits::bit_length(static_cast<uint32_t>(length[axis])) - 16, 0);
  const uint32_t came_q16 = ((reached >> excess) << 16) / (static_cast<uint32_t>(length[axis]) >> excess);
  blocked.left_q16 = 65536U - came_q16;
  blocked.sign = sign;
  blocked.corner = corner;
  int32_t* const position[2] = {&ball->x, &ball->y};
  for (int a = 0; a < 2; ++a) {
    // On the way, but within the cell in which the disc stands, and short of a boundary.
    const int32_t middle = corner[a] * 65536 + half;
    const uint32_t part =
        static_cast<uint32_t>((uint64_t{static_cast<uint32_t>(length[a])} * came_q16) >> 16) &
        ~(static_cast<uint32_t>(unit_) - 1);
    const int32_t reach = 32768 - (unit_ >> 1);
    const int32_t offset = start[a] + sign[a] * static_cast<int32_t>(part) - middle;
    *position[a] = middle + least(most(offset, -reach), reach);
  }
  return blocked;
}

}  // namespace thimble
