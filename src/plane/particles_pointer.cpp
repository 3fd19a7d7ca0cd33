// What the pointer does to the world.
#include "particles_parts.h"

namespace thimble {
namespace {

constexpr int32_t kMostRadius = 1024;
// A ball that is drawn along makes up this part of its distance in a step, and no more than this speed.
constexpr int kDragShift = 2;
constexpr int32_t kDragSpeedQ16 = 32 << 16;

}  // namespace

void ParticleWorld::set_pointer(PointerMode mode, Vec2i at, int32_t radius, int32_t strength_q16) {
  const Vec2i place{clamped(at.x, -kMaxFieldSide, 2 * kMaxFieldSide),
                    clamped(at.y, -kMaxFieldSide, 2 * kMaxFieldSide)};
  if (mode != pointer_mode_) {
    pointer_before_ = place;
    dragged_ = mode == PointerMode::kDrag ? ball_at(place) : kNoBall;
  }
  pointer_mode_ = mode;
  pointer_ = place;
  pointer_radius_ = clamped(radius, 1, kMostRadius);
  pointer_strength_ = clamped(strength_q16, 0, kMaxAccelerationQ16);
}

void ParticleWorld::apply_pointer() {
  switch (pointer_mode_) {
    case PointerMode::kNone:
      break;
    case PointerMode::kDrag:
      if (dragged_ != kNoBall) {
        wake(dragged_);
        Ball& ball = balls_[dragged_];
        // The middle of the cell pointed at. Distances are below 2^31: both ends lie within 3 fields.
        const auto speed = [](int32_t cell, int32_t from) {
          const int64_t distance = int64_t{cell} * 65536 + 32768 - from;
          const int64_t part = distance < 0 ? -(-distance >> kDragShift) : distance >> kDragShift;
          return static_cast<int32_t>(part < -kDragSpeedQ16  ? -kDragSpeedQ16
                                      : part > kDragSpeedQ16 ? kDragSpeedQ16
                                                             : part);
        };
        ball.vx = speed(pointer_.x, ball.x);
        ball.vy = speed(pointer_.y, ball.y);
      }
      break;
    case PointerMode::kAttract:
      pull_balls(1);
      break;
    case PointerMode::kRepel:
      pull_balls(-1);
      break;
    case PointerMode::kSpawn: {
      if (!field_.contains(pointer_)) {
        break;
      }
      const uint32_t random_before = random_;
      const int32_t diameter =
          config_.least_diameter + static_cast<int32_t>(random_below(
                                       static_cast<uint32_t>(largest_spawned_ - config_.least_diameter + 1)));
      if (spawn(pointer_.x * 65536 + 32768, pointer_.y * 65536 + 32768, 0, 0, diameter, nullptr) !=
          Status::kOk) {
        random_ = random_before;
      }
      break;
    }
    case PointerMode::kErase: {
      // Every ball that the stroke covers a cell of.
      const int32_t brush_diameter = 2 * pointer_radius_ - 1;
      brush(pointer_before_, pointer_, brush_diameter, false);
      const CellRange range =
          cells_around({{pointer_.x, pointer_.y}, {pointer_.x + 1, pointer_.y + 1}}, pointer_radius_);
      range.each_ball(*this, [this](uint32_t id) {
        const int64_t dx = (balls_[id].x >> 16) - pointer_.x;
        const int64_t dy = (balls_[id].y >> 16) - pointer_.y;
        if (dx * dx + dy * dy < int64_t{pointer_radius_} * pointer_radius_) {
          static_cast<void>(remove(id));
        }
        return true;
      });
      break;
    }
    case PointerMode::kDraw:
      brush(pointer_before_, pointer_, 2 * pointer_radius_ - 1, true);
      break;
  }
  pointer_before_ = pointer_;
}

// Accelerates the balls within the radius towards the pointer, or away: strongest half way, nothing in the
// middle and at the rim. strength * distance * (radius - distance) * 4 / radius^2, with one 32-bit division a
// step.
void ParticleWorld::pull_balls(int32_t sign) {
  const int32_t radius = pointer_radius_;
  // 4 * strength / radius^2 in 2^-24, kept within 2^31.
  const uint32_t square = static_cast<uint32_t>(radius) * static_cast<uint32_t>(radius);
  const uint32_t strength = static_cast<uint32_t>(pointer_strength_);
  const int excess = strength == 0 ? 0 : 32 - bits::bit_length(strength);
  const uint64_t factor = strength == 0 ? 0 : ((strength << excess) / square);
  const CellRange range = cells_around({{pointer_.x, pointer_.y}, {pointer_.x + 1, pointer_.y + 1}}, radius);
  range.each_ball(*this, [&](uint32_t id) {
    Ball& ball = balls_[id];
    // In 1/16 cell, below 2^16 within the radius.
    const int64_t dx = (int64_t{pointer_.x} * 65536 + 32768 - ball.x) / 4096;
    const int64_t dy = (int64_t{pointer_.y} * 65536 + 32768 - ball.y) / 4096;
    const int64_t inward = int64_t{radius} * 16 - rough_length(dx, dy);
    if (inward <= 0) {
      return true;
    }
    wake(id);
    const auto change = [&](int64_t d) {
      const uint64_t size =
          static_cast<uint64_t>(d < 0 ? -d : d) * static_cast<uint64_t>(inward);  // below 2^30
      const int64_t part = static_cast<int64_t>((size * factor) >> excess >> 6);
      return (d < 0) == (sign < 0) ? part : -part;
    };
    ball.vx = held_within_limit(ball.vx + change(dx));
    ball.vy = held_within_limit(ball.vy + change(dy));
    return true;
  });
}

}  // namespace thimble
