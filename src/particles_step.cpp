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

// Any cell set in rows [y, y + count) of the column of words that begins at `column`, under `mask`; with
// the cells of a disc left out, whose masks (moved by `shift` to the left) are own[row]. Rows are taken four
// at a time, the last four again where the count is no multiple: looking twice changes nothing.
inline uint32_t rows_besides(const Word* column, const uint32_t* own, int32_t count, int32_t right,
                             int32_t left, int32_t shift) {
  uint32_t found[4] = {};
  if (count < 4) {
    for (int32_t row = 0; row < count; ++row) {
      found[0] |= ((column[row] >> right) << left) & ~(own[row] << shift);
    }
    return found[0];
  }
  for (int32_t row = 0;;) {
    for (int32_t i = 0; i < 4; ++i) {
      found[i] |= ((column[row + i] >> right) << left) & ~(own[row + i] << shift);
    }
    if (row == count - 4) {
      break;
    }
    row = least(row + 4, count - 4);
  }
  return found[0] | found[1] | found[2] | found[3];
}

}  // namespace

// Whether the box around a disc at `from` and at `to`, at most kShortWay apart and both in the field, is free
// of all but the disc at `from`.
bool ParticleWorld::box_is_free(const DiscStamp& disc, Vec2i from, Vec2i to) const {
  const int32_t x = least(from.x, to.x);
  const int32_t y = least(from.y, to.y);
  const int32_t width = disc.diameter + most(from.x, to.x) - x;
  const int32_t height = disc.diameter + most(from.y, to.y) - y;
  const int32_t right = x & 31;
  const Word* column = words_ + (x >> 5) * config_.height + y;
  const uint32_t* own = disc.rows + (y - from.y);
  uint32_t found = rows_besides(column, own, height, right, 0, from.x - x);
  if (right + width > 32) {
    found |= rows_besides(column + config_.height, own, height, 0, 32 - right, from.x - x);
  }
  return (found & ((uint32_t{1} << width) - 1)) == 0;
}

// Displacement of a substep for a velocity, to the nearest unit, halves away from zero.
inline int32_t ParticleWorld::displacement(int32_t velocity) const {
  const int32_t shift = config_.substeps_log2;
  const uint32_t half = (static_cast<uint32_t>(unit_) << shift) >> 1;
  const uint32_t size = ((magnitude(velocity) + half) >> shift) & ~(static_cast<uint32_t>(unit_) - 1);
  return velocity < 0 ? -static_cast<int32_t>(size) : static_cast<int32_t>(size);
}

void ParticleWorld::step() {
  counters_ = StepCounters{};
  if (pointer_mode_ != PointerMode::kNone) {
    apply_pointer();
  }
  const int32_t substeps = int32_t{1} << config_.substeps_log2;
  for (int32_t substep = 0; substep < substeps; ++substep) {
    for (uint32_t id = next_awake(0); id != kNoBall; id = next_awake(id + 1)) {
      advance(id);
    }
  }
  for (uint32_t id = next_awake(0); id != kNoBall; id = next_awake(id + 1)) {
    rest(id);
  }
  ++steps_;
}

void ParticleWorld::advance(uint32_t id) {
  Ball& ball = balls_[id];
  if (pulled_) {
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
  const Vec2i from = corner_of(ball);
  const uint32_t cell = cell_of(ball.x, ball.y);
  const int32_t diameter = ball.diameter;
  const Vec2i to{disc_corner(ball.x + way.x, diameter), disc_corner(ball.y + way.y, diameter)};
  if (from == to) {
    ball.x += way.x;
    ball.y += way.y;
  } else {
    const DiscStamp disc = disc_stamp(diameter);
    const uint32_t dx = static_cast<uint32_t>(to.x - from.x + kShortWay);
    const uint32_t dy = static_cast<uint32_t>(to.y - from.y + kShortWay);
    ++counters_.mask_tests;
    if (dx <= 2 * kShortWay && dy <= 2 * kShortWay && field_.holds(disc, to) && box_is_free(disc, from, to)) {
      field_.clear_inside(disc, from);
      field_.set_inside(disc, to);
      ball.x += way.x;
      ball.y += way.y;
    } else {
      field_.clear_inside(disc, from);
      trace(id, way);
      field_.set_inside(disc, corner_of(ball));
    }
  }
  const uint32_t new_cell = cell_of(ball.x, ball.y);
  if (new_cell != cell) {
    relink(id, cell, new_cell);
  }
  if ((ball.flags & kSupports) != 0 && corner_of(ball) != from) {
    ball.flags = static_cast<uint8_t>(ball.flags & ~kSupports);
    support_left({from, {from.x + diameter, from.y + diameter}});
  }
}

// The way of a ball that does not stand in the field just now, with its bounces.
void ParticleWorld::trace(uint32_t id, Vec2i way) {
  Ball& ball = balls_[id];
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    const Blocked blocked = walk(&ball, way);
    if (blocked.axes == 0) {
      return;
    }
    collide(id, blocked);
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
ParticleWorld::Blocked ParticleWorld::walk(Ball* ball, Vec2i way) {
  const DiscStamp disc = disc_stamp(ball->diameter);
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
  int32_t careful = 0;  // crossings to be looked at one by one
  const auto free_at = [&](Vec2i place) {
    ++counters_.mask_tests;
    return is_free(disc, place);
  };
  while (done[0] < crossings[0] || done[1] < crossings[1]) {
    if (careful == 0) {
      careful = kStride;
      if (crossings[0] - done[0] + crossings[1] - done[1] > 4) {
        const int32_t done_before[2] = {done[0], done[1]};
        const Vec2i corner_before = corner;
        const int64_t order_before = order;
        for (int32_t i = 0; i < kStride && (done[0] < crossings[0] || done[1] < crossings[1]); ++i) {
          take(next_axes());
        }
        ++counters_.mask_tests;
        const CellBox box{{least(corner.x, corner_before.x), least(corner.y, corner_before.y)},
                          {most(corner.x, corner_before.x) + disc.diameter,
                           most(corner.y, corner_before.y) + disc.diameter}};
        if (field_.holds(disc, corner) && !field_.any(box)) {
          careful = 0;
          continue;
        }
        done[0] = done_before[0];
        done[1] = done_before[1];
        corner = corner_before;
        order = order_before;
      }
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
