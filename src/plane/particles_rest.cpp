// Sleep: who may, what it costs (nothing), and what ends it.
//
// A sleeper under gravity counts on what holds it. The balls among that carry the flag kSupports; when one of
// them leaves cells, or a ball or a wall is taken away, the sleepers beside those cells are looked at again
// and either wake or mark what holds them now. So nobody hangs in the air, and a ball that nobody counts on
// pays one test of a flag.
#include "particles_parts.h"

namespace thimble {
namespace {

uint32_t rows_set_of(const uint32_t (&rows)[kMaxSmallDisc], int32_t count) {
  uint32_t set = 0;
  for (int32_t row = 0; row < count; ++row) {
    if (rows[row] != 0) {
      set |= uint32_t{1} << row;
    }
  }
  return set;
}

constexpr int32_t sign_of(int32_t value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

// The corner of a ball's disc one cell along gravity on `axis`.
Vec2i along_gravity(Vec2i corner, Vec2i gravity, int axis) {
  corner[axis] += sign_of(gravity[axis]);
  return corner;
}

}  // namespace

// Whether gravity pulls no less along `axis` than along the other.
bool ParticleWorld::pulls_most(int axis) const {
  const int32_t here = config_.gravity_q16[axis];
  const int32_t there = config_.gravity_q16[1 - axis];
  return here != 0 && (here < 0 ? -here : here) >= (there < 0 ? -there : there);
}

bool ParticleWorld::held(const Ball& ball) const {
  const DiscStamp disc = small_disc(ball.diameter);
  const Vec2i corner = corner_of(ball);
  for (int axis = 0; axis < 2; ++axis) {
    if (pulls_most(axis)) {
      const Vec2i place = along_gravity(corner, config_.gravity_q16, axis);
      if (!field_.holds(disc, place) || field_.any_besides_inside(disc, place, corner)) {
        return true;
      }
    }
  }
  return !pulled_;
}

bool ParticleWorld::is_held(uint32_t id) const {
  return id < id_limit_ && balls_[id].diameter != 0 && held(balls_[id]);
}

// Whether ball `id` is held by something that lies still itself: so a heap falls asleep from the ground up.
bool ParticleWorld::lies_still(uint32_t id) const {
  const Ball& ball = balls_[id];
  const DiscStamp disc = small_disc(ball.diameter);
  const Vec2i corner = corner_of(ball);
  for (int axis = 0; axis < 2; ++axis) {
    if (!pulls_most(axis)) {
      continue;
    }
    const Vec2i place = along_gravity(corner, config_.gravity_q16, axis);
    if (!field_.holds(disc, place)) {
      return true;
    }
    Contacts contacts;
    uint32_t rows[kMaxSmallDisc];
    if (!field_.overlap_inside(disc, place, corner, rows)) {
      continue;
    }
    contacts_at(id, disc, place, rows, rows_set_of(rows, disc.diameter), 1, &contacts);
    if (contacts.wall) {
      return true;
    }
    for (int32_t i = 0; i < contacts.count; ++i) {
      const Ball& other = balls_[contacts.ids[i]];
      if ((other.flags & kAsleep) != 0 || other.still >= kStillSteps || other.confined >= kConfinedSteps) {
        return true;
      }
    }
  }
  return !pulled_;
}

// Marks the balls that hold sleeper `id`.
void ParticleWorld::hold(uint32_t id) {
  const Ball& ball = balls_[id];
  const DiscStamp disc = small_disc(ball.diameter);
  const Vec2i corner = corner_of(ball);
  for (int axis = 0; axis < 2; ++axis) {
    const Vec2i place = along_gravity(corner, config_.gravity_q16, axis);
    if (config_.gravity_q16[axis] == 0 || !field_.holds(disc, place)) {
      continue;
    }
    Contacts contacts;
    uint32_t rows[kMaxSmallDisc];
    if (field_.overlap_inside(disc, place, corner, rows)) {
      contacts_at(id, disc, place, rows, rows_set_of(rows, disc.diameter), 1, &contacts);
    }
    for (int32_t i = 0; i < contacts.count; ++i) {
      balls_[contacts.ids[i]].flags |= kSupports;
    }
  }
}

void ParticleWorld::wake(uint32_t id) {
  Ball& ball = balls_[id];
  if ((ball.flags & kAsleep) == 0) {
    return;
  }
  ball.still = 0;
  ball.confined = 0;
  ball.near_x = ball.near_y = ball.far_x = ball.far_y = 0;
  ball.flags = static_cast<uint8_t>(ball.flags & ~kAsleep);
  set_awake_bit(id);
  --asleep_;
  ++counters_.woken;
}

void ParticleWorld::wake_all() {
  if (asleep_ == 0) {
    return;
  }
  for (uint32_t id = 0; id < id_limit_; ++id) {
    if (balls_[id].diameter != 0) {
      wake(id);
    }
  }
}

// After a step: puts ball `id` to sleep where it may. Under gravity the caller has counted how long it has
// kept to its place, and found it long enough. What is thrown to and fro in a hollow of a few cells may sleep
// as well, after longer. Without gravity, only what stands perfectly still may, since everything else moves
// for ever.
void ParticleWorld::rest(uint32_t id) {
  Ball& ball = balls_[id];
  if (!pulled_) {
    ball.still = (ball.vx | ball.vy) != 0 ? 0 : static_cast<uint8_t>(ball.still + 1);
    if (ball.still < kStillSteps) {  // `confined` is of the time when there was gravity
      return;
    }
  }
  if (id == dragged_ || lossless() || !lies_still(id)) {
    return;
  }
  ball.vx = 0;
  ball.vy = 0;
  ball.flags |= kAsleep;
  clear_awake_bit(id);
  ++asleep_;
  hold(id);
}

// Something left cells of `box`: the sleepers beside it are looked at again. Where gravity pulls aslant, what
// held a sleeper on the other axis may be gone, so it wakes to find out; but not for what only stirs in its
// hollow (not `for_good`).
void ParticleWorld::support_left(const CellBox& box, bool for_good) {
  if (!pulled_ || asleep_ == 0) {
    return;
  }
  const bool aslant = for_good && config_.gravity_q16.x != 0 && config_.gravity_q16.y != 0;
  const CellRange range = cells_around(box, config_.most_diameter / 2 + 2);
  range.each_ball(*this, [&](uint32_t id) {
    const Ball& ball = balls_[id];
    const Vec2i corner = corner_of(ball);
    if ((ball.flags & kAsleep) == 0 || corner.x > box.high.x || corner.y > box.high.y ||
        corner.x + ball.diameter < box.low.x || corner.y + ball.diameter < box.low.y) {
      return true;
    }
    if (!aslant && held(ball)) {
      hold(id);
    } else {
      wake(id);
    }
    return true;
  });
}

// Sets the cells of all balls near `box`, where walls have been cleared.
void ParticleWorld::stamp_balls(const CellBox& box) {
  cells_around(box, config_.most_diameter / 2 + 1).each_ball(*this, [this](uint32_t id) {
    field_.set_inside(small_disc(balls_[id].diameter), corner_of(balls_[id]));
    return true;
  });
}

}  // namespace thimble
