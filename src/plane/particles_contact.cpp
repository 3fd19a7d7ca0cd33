// What a ball met, and how it bounces off it.
//
// Normals: off another ball it is the line of the centres, which the index of cells gives to a fraction of a
// cell; off a side of the box its axis; off drawn walls it is estimated from the cells that are in the way.
//
// The impulse along a normal n (any length) between masses A and B at relative velocity w, approaching:
//
//     change of A's velocity = + n * (1 + e) * |w.n| / |n|^2 * mB / (mA + mB)
//     change of B's velocity = - n * (1 + e) * |w.n| / |n|^2 * mA / (mA + mB)
//
// needs no root. The quotient is a product with a reciprocal of 32 bits (Newton's method on a 32-bit
// division). The heavier ball's change is rounded to the nearest, halves away from zero, on each axis; the
// lighter's is what keeps the momentum, rounded to the nearest likewise. So on each axis the momentum of the
// pair is kept to within half the lighter's mass times 2^-16 cells a step, and magnitudes know no
// handedness: a mirrored collision gives the mirrored result.
#include "../base/wide_arithmetic.h"
#include "particles_parts.h"

namespace thimble {
namespace {

constexpr int kNormalBits = 12;
constexpr int kAxisShift = kNormalBits - 1;
constexpr int32_t kAxisNormal = int32_t{1} << kAxisShift;
constexpr int kFactorBits = 24;
// A collision may be wrong by what gravity gives in a step and a half.
constexpr uint32_t kMostKicks = 2;
// The rest_speed_ of a gravity of half a cell a step a step.
constexpr int32_t kStrongRestSpeed = 5 * 65536 / 4;

constexpr int width_of(uint64_t value) {
  const uint32_t high = static_cast<uint32_t>(value >> 32);
  return high != 0 ? 32 + bits::bit_length(high) : bits::bit_length(static_cast<uint32_t>(value));
}

// 2^63 / value to within 2^-29 of it, at most 2^32 - 1; value 2^31 .. 2^32 - 1.
constexpr uint32_t reciprocal(uint32_t value) {
  // 16 bits from the divider, then one step of Newton's method.
  const uint32_t guess = (UINT32_MAX / ((value >> 16) + 1)) << 15;
  const uint64_t product = uint64_t{guess} * value;
  const uint32_t missing = static_cast<uint32_t>(((uint64_t{1} << 63) - product) >> 32);
  const uint64_t better = guess + ((uint64_t{missing} * guess) >> 30 >> 1);
  return better > UINT32_MAX ? UINT32_MAX : static_cast<uint32_t>(better);
}

// value / divisor to the nearest, halves to the even: halves are frequent here, and always up would add
// energy. Value below 2^46, divisor 1 .. 256. Two 32-bit divisions.
constexpr uint64_t divide_by_small(uint64_t value, uint32_t divisor) {
  const uint32_t high = static_cast<uint32_t>(value >> 16);
  const uint32_t high_quotient = high / divisor;
  const uint32_t low = (high - high_quotient * divisor) << 16 | (static_cast<uint32_t>(value) & 0xFFFFU);
  const uint32_t low_quotient = low / divisor;
  const uint64_t quotient = (uint64_t{high_quotient} << 16) + low_quotient;
  const uint32_t twice = 2 * (low - low_quotient * divisor);
  return quotient + (twice > divisor || (twice == divisor && (low_quotient & 1U) != 0) ? 1 : 0);
}

// The longer component with kNormalBits bits, the components cut towards zero; along an axis it is
// kAxisNormal.
constexpr Vec2i short_normal(Vec2i v) {
  const uint32_t x = magnitude_32(v.x);
  const uint32_t y = magnitude_32(v.y);
  if (x == 0 || y == 0) {
    const auto unit = [](int32_t part) { return part < 0 ? -kAxisNormal : part > 0 ? kAxisNormal : 0; };
    return {unit(v.x), unit(v.y)};
  }
  const int excess = bits::bit_length(x | y) - kNormalBits;
  const auto resized = [excess](uint32_t size) {
    return static_cast<int32_t>(excess > 0 ? size >> excess : size << -excess);
  };
  return {v.x < 0 ? -resized(x) : resized(x), v.y < 0 ? -resized(y) : resized(y)};
}

// The sign of mass_a * a + mass_b * b, for |a|, |b| below 2^62 and masses below 2^16.
constexpr bool sum_is_positive(int64_t a, uint32_t mass_a, int64_t b, uint32_t mass_b) {
  const int64_t low = static_cast<int64_t>((static_cast<uint64_t>(a) & UINT32_MAX) * mass_a +
                                           (static_cast<uint64_t>(b) & UINT32_MAX) * mass_b);
  const int64_t high = (a >> 32) * mass_a + (b >> 32) * mass_b + (low >> 32);
  return high > 0 || (high == 0 && (low & INT64_C(0xFFFFFFFF)) != 0);
}

}  // namespace

// The balls and walls that cells under `disc` at `place` belong to, added to `contacts` with `axis_bits`.
// rows[disc.diameter] are those cells, in the rows whose bits `rows_set` has, one at least; they are used up.
void ParticleWorld::contacts_at(uint32_t self, const DiscStamp& disc, Vec2i place,
                                uint32_t (&rows)[kMaxSmallDisc], uint32_t rows_set, uint32_t axis_bits,
                                Contacts* contacts) const {
  const int32_t first = static_cast<int32_t>(bits::lowest_bit(rows_set));
  const int32_t last = bits::bit_length(rows_set) - 1;
  uint32_t columns = rows[first];
  for (int32_t row = first + 1; row <= last; ++row) {
    columns |= rows[row];
  }
  const CellBox box{{place.x + static_cast<int32_t>(bits::lowest_bit(columns)), place.y + first},
                    {place.x + bits::bit_length(columns), place.y + last + 1}};
  // A ball's square shares cells with the box when its centre, moved by half its diameter less half a cell,
  // lies within that of the box's corner and the box's size and as much again: one comparison an axis.
  const uint32_t corner_x = static_cast<uint32_t>(box.low.x) << 16;
  const uint32_t corner_y = static_cast<uint32_t>(box.low.y) << 16;
  const uint32_t size_x = static_cast<uint32_t>(box.high.x - box.low.x) << 16;
  const uint32_t size_y = static_cast<uint32_t>(box.high.y - box.low.y) << 16;
  const CellRange range = cells_around(box, config_.most_diameter / 2);
  // From the side on which the cells lie of the disc: what they belong to is there, and the rest is not
  // looked at then. The order makes no difference to what is found.
  const bool upwards = box.low.y + box.high.y > 2 * place.y + disc.diameter;
  const bool leftwards = box.low.x + box.high.x > 2 * place.x + disc.diameter;
  const int32_t line_step = upwards ? -cells_across_ : cells_across_;
  const int32_t cell_step = leftwards ? -1 : 1;
  const uint32_t* line =
      cells_ + (upwards ? range.y1 : range.y0) * cells_across_ + (leftwards ? range.x1 : range.x0);
  const int32_t across = range.x1 - range.x0;
  for (int32_t lines = range.y1 - range.y0; lines >= 0; --lines, line += line_step) {
    const uint32_t* cell = line;
    for (int32_t cells = across; cells >= 0; --cells, cell += cell_step) {
      for (uint32_t id = *cell; id != kNoBall; id = balls_[id].next) {
        const Ball& other = balls_[id];
        const uint32_t half = (uint32_t{other.diameter} - 1) << 15;
        if (static_cast<uint32_t>(other.x) + half - corner_x >= size_x + 2 * half ||
            static_cast<uint32_t>(other.y) + half - corner_y >= size_y + 2 * half || id == self) {
          continue;
        }
        const Vec2i corner = corner_of(other);
        const uint32_t* masks = small_disc(other.diameter).rows + (place.y - corner.y);
        const int32_t left = corner.x < place.x ? place.x - corner.x : 0;
        const int32_t right = corner.x > place.x ? corner.x - place.x : 0;
        uint32_t met = 0;
        uint32_t remain = 0;
        for (int32_t row = first; row <= last; ++row) {
          const uint32_t mask = (masks[row] >> left) << right;
          met |= rows[row] & mask;
          rows[row] &= ~mask;
          remain |= rows[row];
        }
        if (met != 0) {
          contacts->add(id, axis_bits);
          if (remain == 0) {
            return;
          }
        }
      }
    }
  }
  contacts->wall = true;
  contacts->wall_axes |= axis_bits;
  for (int32_t row = first; row <= last; ++row) {
    for (uint32_t left = rows[row]; left != 0; left &= left - 1) {
      // From the middle of the disc, in half cells.
      contacts->wall_offset.x += 2 * static_cast<int32_t>(bits::lowest_bit(left)) + 1 - disc.diameter;
      contacts->wall_offset.y += 2 * row + 1 - disc.diameter;
    }
  }
}

// The direction away from the drawn walls around a ball, whose own cells are those at `own`. Where the
// cells in the way lie evenly about an axis that axis is the answer, so that level walls are exact; else the
// walls within two cells of the disc are weighed as well, which is a good deal less rough.
Vec2i ParticleWorld::wall_normal(uint32_t self, Vec2i offset, Vec2i own) const {
  if (offset.x == 0 || offset.y == 0) {
    return {-offset.x, -offset.y};
  }
  constexpr int32_t kWallReach = 2;
  constexpr int32_t kMostRows = kMaxSmallDisc + 2 * kWallReach;
  const DiscStamp disc = small_disc(balls_[self].diameter);
  const Vec2i corner = corner_of(balls_[self]);
  const int32_t size = disc.diameter + 2 * kWallReach;
  const Vec2i from{corner.x - kWallReach, corner.y - kWallReach};
  uint32_t rows[kMostRows];
  for (int32_t row = 0; row < size; ++row) {
    // The disc's rows, widened by kWallReach on all sides.
    uint32_t mask = 0;
    for (int32_t dy = -kWallReach; dy <= kWallReach; ++dy) {
      const uint32_t line = disc.rows[row - kWallReach + dy];
      const int32_t reach = kWallReach - (dy < 0 ? -dy : dy);
      for (int32_t dx = kWallReach - reach; dx <= kWallReach + reach; ++dx) {
        mask |= line << dx;
      }
    }
    const int32_t y = from.y + row;
    uint32_t cells = UINT32_MAX;  // beyond the box all is solid
    if (y >= 0 && y < config_.height) {
      cells = field_.window(from.x, y);
      for (int32_t column = 0; column < size; ++column) {
        if (from.x + column < 0 || from.x + column >= config_.width) {
          cells |= uint32_t{1} << column;
        }
      }
    }
    rows[row] = cells & mask;
  }
  const auto leave_out = [&](const DiscStamp& other, Vec2i at) {
    const int32_t right = at.x - from.x;
    if (right <= -32 || right >= 32) {
      return;
    }
    for (int32_t row = 0; row < size; ++row) {
      const int32_t other_row = from.y + row - at.y;
      if (other_row >= 0 && other_row < other.diameter) {
        rows[row] &= ~(right < 0 ? other.rows[other_row] >> -right : other.rows[other_row] << right);
      }
    }
  };
  leave_out(disc, own);
  const CellRange range = cells_around({from, {from.x + size, from.y + size}}, config_.most_diameter / 2);
  range.each_ball(*this, [&](uint32_t id) {
    if (id != self) {
      leave_out(small_disc(balls_[id].diameter), corner_of(balls_[id]));
    }
    return true;
  });
  Vec2i sum;
  for (int32_t row = 0; row < size; ++row) {
    for (uint32_t left = rows[row]; left != 0; left &= left - 1) {
      sum.x -= 2 * static_cast<int32_t>(bits::lowest_bit(left)) + 1 - size;
      sum.y -= 2 * row + 1 - size;
    }
  }
  return sum == Vec2i{} ? Vec2i{-offset.x, -offset.y} : sum;
}

// The way of ball `id` is `blocked`: everything in the way is met, first the sides of the box, then walls,
// then balls in order of number. `window` holds the places in the way; the ball's cells in the field are at
// `own`.
void ParticleWorld::collide(uint32_t id, const Blocked& blocked, const Window& window, Vec2i own) {
  Ball& ball = balls_[id];
  const DiscStamp disc = small_disc(ball.diameter);
  const Vec2i away{-blocked.sign.x, -blocked.sign.y};
  Contacts contacts;
  uint32_t rows[kMaxSmallDisc];
  if (blocked.axes == Blocked::kCorner) {
    const Vec2i place{blocked.corner.x + blocked.sign.x, blocked.corner.y + blocked.sign.y};
    const uint32_t rows_set = window.under(disc, place, rows);
    if (rows_set != 0) {
      contacts_at(id, disc, place, rows, rows_set, Blocked::kX | Blocked::kY, &contacts);
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    const uint32_t axis_bit = axis == 0 ? Blocked::kX : Blocked::kY;
    if ((blocked.axes & axis_bit) == 0) {
      continue;
    }
    Vec2i place = blocked.corner;
    place[axis] += blocked.sign[axis];
    if (!field_.holds(disc, place)) {
      Vec2i normal;
      normal[axis] = away[axis] * kAxisNormal;
      if (pulled_) {
        bounce(ball, kNoBall, normal, away, axis_bit);
        continue;
      }
      const int64_t along = int64_t{axis == 0 ? ball.vx : ball.vy} * normal[axis];
      if (along < 0) {
        ++counters_.wall_hits;
        push(ball, nullptr, normal, along, config_.restitution_q16);
      }
      continue;
    }
    const uint32_t rows_set = window.under(disc, place, rows);
    if (rows_set != 0) {
      contacts_at(id, disc, place, rows, rows_set, axis_bit, &contacts);
    }
  }
  if (contacts.wall) {
    bounce(ball, kNoBall, wall_normal(id, contacts.wall_offset, own), away, contacts.wall_axes);
  }
  for (int32_t i = 0; i < contacts.count; ++i) {
    const Ball& other = balls_[contacts.ids[i]];
    bounce(ball, contacts.ids[i], {ball.x - other.x, ball.y - other.y}, away, contacts.axes[i]);
  }
}

// `ball` met ball `other`, or a wall for kNoBall. `normal` points to the ball, in any length. Where the two
// do not approach along it, although the cells are in each other's way, the axes along which the step was
// blocked (`axes`, with the direction back, `away`) serve instead: at once where there is no gravity, so that
// nothing is lost; under gravity only when the ball does not get on, for what slides round another is in
// its way from time to time.
void ParticleWorld::bounce(Ball& ball, uint32_t other_id, Vec2i normal, Vec2i away, uint32_t axes) {
  Ball* other = other_id == kNoBall ? nullptr : &balls_[other_id];
  const int64_t wx = int64_t{ball.vx} - (other != nullptr ? other->vx : 0);
  const int64_t wy = int64_t{ball.vy} - (other != nullptr ? other->vy : 0);
  Vec2i n = short_normal(normal);
  int64_t along = wx * n.x + wy * n.y;
  if (along >= 0) {
    if (pulled_ && ball.still < 2) {
      return;
    }
    n = {(axes & Blocked::kX) != 0 ? away.x * kAxisNormal : 0,
         (axes & Blocked::kY) != 0 ? away.y * kAxisNormal : 0};
    along = wx * n.x + wy * n.y;
    if (along >= 0) {
      return;
    }
  }
  if (other != nullptr) {
    ++counters_.ball_hits;
  } else {
    ++counters_.wall_hits;
  }
  const bool slow = -along <= int64_t{rest_speed_} * rough_length(n);
  const bool lasts = ball.still >= kLastingSteps && (other == nullptr || other->still >= kLastingSteps);
  const bool gentle = pulled_ && !lossless() && (slow || lasts);
  if (gentle && other != nullptr && (other->flags & (kAsleep | kGrounded)) != 0) {
    other = nullptr;  // what lies on the ground is ground
  }
  if (other != nullptr) {
    wake(other_id);
  }
  const int64_t before = other != nullptr ? square_of(*other, gravity_part_) : 0;
  push(ball, other, n, along, gentle ? 0 : config_.restitution_q16);
  if (pulled_ && other != nullptr) {
    account(square_of(*other, gravity_part_) - before, uint32_t{other->diameter} * other->diameter);
  }
  if (gentle && other == nullptr) {
    const Vec2i g = config_.gravity_q16;
    if (((axes & Blocked::kX) != 0 && int64_t{away.x} * g.x < 0) ||
        ((axes & Blocked::kY) != 0 && int64_t{away.y} * g.y < 0)) {
      ball.flags |= kGrounded;
    }
    // What slides is slowed; where a step of gravity is worth more than half a cell, to half a cell a step,
    // so that it comes to lie in a hollow instead of being thrown from side to side of it.
    const int32_t limit = rest_speed_ > kStrongRestSpeed ? 32768 : kMaxSpeedQ16;
    int32_t* const speeds[2] = {&ball.vx, &ball.vy};
    for (int32_t* speed : speeds) {
      const int32_t size = *speed < 0 ? -*speed : *speed;
      const int32_t slowed = size - (size >> kFrictionShift);
      const int32_t kept = slowed < limit ? slowed : limit;
      *speed = *speed < 0 ? -kept : kept;
    }
  }
}

// Exchanges the impulse along `normal` (components of kNormalBits) at which the relative velocity times the
// normal is `along`, below 0. With restitution below 1 and no forces the energy never grows: where rounding
// would make it so the impulse is left out, which is so for speeds of a few 2^-16 cells a step.
void ParticleWorld::push(Ball& ball, Ball* other, Vec2i normal, int64_t along, uint32_t restitution_q16) {
  const uint32_t mass = uint32_t{ball.diameter} * ball.diameter;
  const uint32_t other_mass = other != nullptr ? uint32_t{other->diameter} * other->diameter : 1;
  const bool ball_is_heavier = other != nullptr && mass >= other_mass;
  const uint32_t heavier = other == nullptr ? 1 : ball_is_heavier ? mass : other_mass;
  const uint32_t lighter = other == nullptr ? 1 : ball_is_heavier ? other_mass : mass;
  const uint32_t nx = magnitude_32(normal.x);
  const uint32_t ny = magnitude_32(normal.y);

  uint64_t size[2];
  if (other == nullptr && (nx == 0 || ny == 0)) {
    // The sides of the box, level and upright walls: exact but for one rounding, which restitution 1 has not.
    const uint64_t change = ((magnitude(along) >> kAxisShift) * (65536U + restitution_q16) + 32768) >> 16;
    size[0] = nx != 0 ? change : 0;
    size[1] = ny != 0 ? change : 0;
  } else {
    // factor * 2^kFactorBits = |along| * (1 + e) * lighter / (|n|^2 * (mA + mB)), below 2^45.
    uint64_t approach = magnitude(along);  // below 2^44
    int shift = 0;
    if ((approach >> 36) != 0) {
      shift = width_of(approach) - 36;
      approach >>= shift;
    }
    const uint64_t numerator =
        approach * (lighter * (65536U + restitution_q16));  // below 2^(36 + 8 + 17 + 1)
    uint64_t denominator = uint64_t{nx * nx + ny * ny} * (other != nullptr ? heavier + lighter : 1);
    const int spread = width_of(denominator) - 32;  // -9 .. 2
    denominator = spread > 0 ? denominator >> spread : denominator << -spread;
    const uint64_t inverse = reciprocal(static_cast<uint32_t>(denominator));
    const uint64_t upper = (numerator >> 32) * inverse + (((numerator & UINT32_MAX) * inverse) >> 32);
    const int drop = 63 + spread + 16 - kFactorBits - shift - 32;  // 6 .. 25
    const uint64_t factor = (upper + (uint64_t{1} << (drop - 1))) >> drop;
    constexpr uint64_t kHalf = uint64_t{1} << (kFactorBits - 1);
    size[0] = (factor * nx + kHalf) >> kFactorBits;
    size[1] = (factor * ny + kHalf) >> kFactorBits;
  }
  int64_t first[2];   // change of `ball`
  int64_t second[2];  // change of `other`
  for (int axis = 0; axis < 2; ++axis) {
    const int64_t heavy = static_cast<int64_t>(size[axis]);
    const int64_t light =
        heavier == lighter ? heavy : static_cast<int64_t>(divide_by_small(size[axis] * heavier, lighter));
    const int64_t sign = normal[axis] < 0 ? -1 : 1;
    first[axis] = other == nullptr || ball_is_heavier ? sign * heavy : sign * light;
    second[axis] = ball_is_heavier ? -sign * light : -sign * heavy;
  }
  if (restitution_q16 < 65536 && !pulled_) {
    const int64_t gain =
        first[0] * (2 * int64_t{ball.vx} + first[0]) + first[1] * (2 * int64_t{ball.vy} + first[1]);
    const int64_t other_gain = other == nullptr ? 0
                                                : second[0] * (2 * int64_t{other->vx} + second[0]) +
                                                      second[1] * (2 * int64_t{other->vy} + second[1]);
    if (sum_is_positive(gain, mass, other_gain, other_mass)) {
      return;
    }
  }
  ball.vx = held_within_limit(ball.vx + first[0]);
  ball.vy = held_within_limit(ball.vy + first[1]);
  if (other != nullptr) {
    other->vx = held_within_limit(other->vx + second[0]);
    other->vy = held_within_limit(other->vy + second[1]);
  }
}

// Notes that a ball of `mass` gained so much of what square_of counts.
void ParticleWorld::account(int64_t gain, uint32_t mass) {
  constexpr int64_t kMost = int64_t{1} << 61;
  const uint32_t low = static_cast<uint32_t>(static_cast<uint64_t>(-gain) & 255U) * mass + owed_rest_;
  const int64_t owed = owed_ + (-gain >> 8) * mass + (low >> 8);
  owed_rest_ = low & 255U;
  owed_ = owed > kMost ? kMost : owed < -kMost ? -kMost : owed;
}

// After a way with collisions under gravity, in which `ball` gained `gain`: pays what is owed, along gravity
// and at most kMostKicks steps of it. Where restitution takes energy anyway, only gains are paid back.
void ParticleWorld::settle(Ball& ball, Vec2i kick, int64_t gain) {
  const uint32_t mass = uint32_t{ball.diameter} * ball.diameter;
  account(gain, mass);
  if (owed_ >= 0 && !lossless()) {
    return;
  }
  // What a whole kick more gives is four times this and as much as a kick alone gives, which must be less.
  const int64_t along = int64_t{2 * ball.vx + kick.x} * kick.x + int64_t{2 * ball.vy + kick.y} * kick.y;
  const uint64_t rate = magnitude(along);
  const uint64_t alone = magnitude(int64_t{kick.x} * kick.x + int64_t{kick.y} * kick.y);
  if (rate <= kMostKicks * alone) {
    return;
  }
  const uint64_t wanted = magnitude(owed_);
  const uint64_t whole = kMostKicks * (rate >> 6) * mass;
  uint32_t kicks_q16 = kMostKicks << 16;
  if (wanted < whole) {
    const int excess = greater(width_of(whole) - 16, 0);
    kicks_q16 = kMostKicks *
                ((static_cast<uint32_t>(wanted >> excess) << 16) / static_cast<uint32_t>(whole >> excess));
  }
  const bool against = (owed_ < 0) != (along < 0);
  const auto changed = [&](int32_t speed, int32_t by) {
    const int64_t size = static_cast<int64_t>((uint64_t{magnitude_32(by)} * kicks_q16 + 32768) >> 16);
    return held_within_limit(speed + ((by < 0) != against ? -size : size));
  };
  const int64_t before = square_of(ball, kick);
  ball.vx = changed(ball.vx, kick.x);
  ball.vy = changed(ball.vy, kick.y);
  account(square_of(ball, kick) - before, mass);
}

}  // namespace thimble
