// The particle world: bytes, lists, balls, walls and measures.
#include "thimble/plane/particles.h"

#include "particles_parts.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

constexpr int32_t kFarthest = 4 * kMaxFieldSide;
constexpr int kRandomPlaces = 64;

// Gravity a substep, to the nearest, halves away from zero.
constexpr int32_t part_of(int32_t value, int32_t parts_log2) {
  const int32_t size = value < 0 ? -value : value;
  const int32_t part = (size + ((int32_t{1} << parts_log2) >> 1)) >> parts_log2;
  return value < 0 ? -part : part;
}

}  // namespace

Status ParticleWorld::make(const ParticleConfig& config, Bytes bytes, ParticleWorld* world) {
  const size_t needed = particles_bytes(config);
  if (needed == 0) {
    return Status::kOutOfRange;
  }
  if (bytes.size < needed) {
    return Status::kOutOfMemory;
  }
  uint8_t* at = bytes.data + ((0U - reinterpret_cast<uintptr_t>(bytes.data)) & 3U);
  // Every size is a multiple of 4, and so is every address.
  const auto take = [&at](size_t size) -> void* {
    uint8_t* const taken = at;
    at += size;
    return taken;
  };
  ParticleWorld made;
  const size_t field_bytes = bitfield_bytes(config.width, config.height);
  void* const field = take(field_bytes);
  take(particle_detail::kSlackBytes - 4);
  const Status status =
      BitField::make(config.width, config.height, {static_cast<uint8_t*>(field), field_bytes}, &made.field_);
  if (status != Status::kOk) {
    return status;
  }
  made.config_ = config;
  made.largest_spawned_ = config.most_diameter;
  made.words_ = static_cast<field_detail::Word*>(field);
  made.balls_ = static_cast<Ball*>(take(size_t{config.capacity} * sizeof(Ball)));
  made.cell_shift_ = particle_detail::cell_shift(config.most_diameter);
  const int32_t round = (int32_t{1} << made.cell_shift_) - 1;
  made.cells_across_ = (config.width + round) >> made.cell_shift_;
  made.cells_down_ = (config.height + round) >> made.cell_shift_;
  const size_t cells = particle_detail::cell_count(config.width, config.height, config.most_diameter);
  made.cells_ = static_cast<uint32_t*>(take(4 * cells));
  for (size_t cell = 0; cell < cells; ++cell) {
    made.cells_[cell] = kNoBall;
  }
  const size_t awake_words = particle_detail::awake_words(config.capacity);
  made.awake_ = static_cast<uint32_t*>(take(4 * awake_words));
  for (size_t word = 0; word < awake_words; ++word) {
    made.awake_[word] = 0;
  }
  const size_t leaves = (size_t{config.capacity} + 31) / 32;
  made.awake_middle_ = made.awake_ + leaves;
  made.awake_top_ = made.awake_middle_ + (leaves + 31) / 32;
  made.top_words_ = static_cast<uint32_t>(((leaves + 31) / 32 + 31) / 32);
  made.unit_ = int32_t{1} << (16 - config.subpixel_bits);
  made.round_ = (made.unit_ << config.substeps_log2) >> 1;
  made.grid_ = -(made.unit_ << config.substeps_log2);
  made.random_ = config.seed * 2654435761U ^ 0x9E3779B9U;
  if (made.random_ == 0) {
    made.random_ = 1;
  }
  const Vec2i gravity = config.gravity_q16;
  made.config_.gravity_q16 = {0, 0};
  if (made.set_gravity(gravity) != Status::kOk) {
    return Status::kOutOfRange;
  }
  *world = made;
  return Status::kOk;
}

// --- Lists

void ParticleWorld::link(uint32_t id) {
  Ball& ball = balls_[id];
  uint32_t& head = cells_[cell_of(ball.x, ball.y)];
  ball.previous = kNoBall;
  ball.next = head;
  if (head != kNoBall) {
    balls_[head].previous = id;
  }
  head = id;
}

void ParticleWorld::unlink(uint32_t id, uint32_t cell) {
  const Ball& ball = balls_[id];
  if (ball.previous != kNoBall) {
    balls_[ball.previous].next = ball.next;
  } else {
    cells_[cell] = ball.next;
  }
  if (ball.next != kNoBall) {
    balls_[ball.next].previous = ball.previous;
  }
}

uint32_t ParticleWorld::random() {
  random_ ^= random_ << 13;
  random_ ^= random_ >> 17;
  random_ ^= random_ << 5;
  return random_;
}

uint32_t ParticleWorld::random_below(uint32_t limit) {
  return static_cast<uint32_t>((uint64_t{random()} * limit) >> 32);
}

// --- Balls

Status ParticleWorld::spawn(int32_t x_q16, int32_t y_q16, int32_t vx_q16, int32_t vy_q16, int32_t diameter,
                            uint32_t* id) {
  if (diameter < 1 || diameter > config_.most_diameter || !is_within(vx_q16, kMaxSpeedQ16) ||
      !is_within(vy_q16, kMaxSpeedQ16) || !is_within(x_q16, (kMaxFieldSide + 1) << 16) ||
      !is_within(y_q16, (kMaxFieldSide + 1) << 16)) {
    return Status::kOutOfRange;
  }
  const DiscStamp disc = small_disc(diameter);
  const Vec2i corner{disc_corner(x_q16, diameter), disc_corner(y_q16, diameter)};
  if (!field_.holds(disc, corner)) {
    return Status::kOutOfRange;
  }
  const uint32_t number = free_ != kNoBall ? free_ : id_limit_;
  if (number >= config_.capacity || field_.any_inside(disc, corner)) {
    return Status::kOutOfMemory;
  }
  if (number == id_limit_) {
    ++id_limit_;
  } else {
    free_ = balls_[number].next;
  }
  // An odd number of half units from the middle of the corner's cell: never half way between two corners.
  const auto snapped = [this, diameter](int32_t centre, int32_t from) {
    const int32_t origin = from * 65536 + diameter * 32768;
    return origin + ((centre - origin) & ~(unit_ - 1)) + (unit_ >> 1);
  };
  Ball& ball = balls_[number];
  ball = Ball{};
  ball.x = snapped(x_q16, corner.x);
  ball.y = snapped(y_q16, corner.y);
  ball.vx = vx_q16;
  ball.vy = vy_q16;
  ball.diameter = static_cast<uint8_t>(diameter);
  field_.set_inside(disc, corner);
  link(number);
  set_awake_bit(number);
  ++count_;
  if (id != nullptr) {
    *id = number;
  }
  return Status::kOk;
}

Status ParticleWorld::spawn_random(int32_t max_speed_q16, uint32_t* id) {
  if (max_speed_q16 < 0 || max_speed_q16 > kMaxSpeedQ16) {
    return Status::kOutOfRange;
  }
  if (count_ == config_.capacity) {
    return Status::kOutOfMemory;
  }
  const uint32_t random_before = random_;
  const int32_t diameter = config_.least_diameter + static_cast<int32_t>(random_below(static_cast<uint32_t>(
                                                        largest_spawned_ - config_.least_diameter + 1)));
  const int32_t across = config_.width - diameter + 1;
  const int32_t down = config_.height - diameter + 1;
  if (across < 1 || down < 1) {
    random_ = random_before;
    return Status::kOutOfRange;
  }
  const auto speed = [this, max_speed_q16] {
    return static_cast<int32_t>(random_below(2 * static_cast<uint32_t>(max_speed_q16) + 1)) - max_speed_q16;
  };
  const int32_t vx = speed();
  const int32_t vy = speed();
  const DiscStamp disc = small_disc(diameter);
  Vec2i corner;
  bool found = false;
  for (int attempt = 0; attempt < kRandomPlaces && !found; ++attempt) {
    corner = {static_cast<int32_t>(random_below(static_cast<uint32_t>(across))),
              static_cast<int32_t>(random_below(static_cast<uint32_t>(down)))};
    found = !field_.any_inside(disc, corner);
  }
  for (int64_t left = int64_t{across} * down; left > 0 && !found; --left) {
    if (++corner.x == across) {
      corner.x = 0;
      if (++corner.y == down) {
        corner.y = 0;
      }
    }
    found = !field_.any_inside(disc, corner);
  }
  if (!found) {
    random_ = random_before;
    return Status::kOutOfMemory;
  }
  const int32_t half = diameter * 32768;
  return spawn(corner.x * 65536 + half, corner.y * 65536 + half, vx, vy, diameter, id);
}

Status ParticleWorld::remove(uint32_t id) {
  if (id >= id_limit_ || balls_[id].diameter == 0) {
    return Status::kOutOfRange;
  }
  Ball& ball = balls_[id];
  const Vec2i corner = corner_of(ball);
  const int32_t diameter = ball.diameter;
  field_.clear_inside(small_disc(diameter), corner);
  unlink(id, cell_of(ball.x, ball.y));
  if ((ball.flags & kAsleep) != 0) {
    --asleep_;
  } else {
    clear_awake_bit(id);
  }
  ball = Ball{};
  ball.next = free_;
  free_ = id;
  --count_;
  if (id == dragged_) {
    dragged_ = kNoBall;
  }
  support_left({corner, {corner.x + diameter, corner.y + diameter}}, true);
  return Status::kOk;
}

bool ParticleWorld::particle(uint32_t id, Particle* particle) const {
  if (id >= id_limit_ || balls_[id].diameter == 0) {
    return false;
  }
  const Ball& ball = balls_[id];
  particle->id = id;
  particle->x_q16 = ball.x;
  particle->y_q16 = ball.y;
  particle->vx_q16 = ball.vx;
  particle->vy_q16 = ball.vy;
  particle->diameter = ball.diameter;
  particle->radius_q16 = ball.diameter * 32768;
  particle->corner = corner_of(ball);
  particle->asleep = (ball.flags & kAsleep) != 0;
  return true;
}

uint32_t ParticleWorld::ball_at(Vec2i at) const {
  if (!field_.test(at)) {
    return kNoBall;
  }
  uint32_t found = kNoBall;
  const CellRange range = cells_around({at, {at.x + 1, at.y + 1}}, config_.most_diameter / 2);
  range.each_ball(*this, [&](uint32_t id) {
    const Vec2i corner = corner_of(balls_[id]);
    const int32_t row = at.y - corner.y;
    const int32_t column = at.x - corner.x;
    const int32_t diameter = balls_[id].diameter;
    if (row >= 0 && row < diameter && column >= 0 && column < diameter &&
        (small_disc(diameter).rows[row] >> column & 1U) != 0) {
      found = id;
    }
    return found == kNoBall;
  });
  return found;
}

Status ParticleWorld::set_velocity(uint32_t id, int32_t vx_q16, int32_t vy_q16) {
  if (id >= id_limit_ || balls_[id].diameter == 0 || !is_within(vx_q16, kMaxSpeedQ16) ||
      !is_within(vy_q16, kMaxSpeedQ16)) {
    return Status::kOutOfRange;
  }
  wake(id);
  balls_[id].vx = vx_q16;
  balls_[id].vy = vy_q16;
  return Status::kOk;
}

// --- Walls

void ParticleWorld::draw_box(const CellBox& box) {
  field_.set(box);
}

void ParticleWorld::erase_box(const CellBox& box) {
  // What lies in the field: the sums of its corners and the balls' reach then stay far below 2^31.
  const CellBox inside{{box.low.x < 0 ? 0 : box.low.x, box.low.y < 0 ? 0 : box.low.y},
                       {box.high.x > config_.width ? config_.width : box.high.x,
                        box.high.y > config_.height ? config_.height : box.high.y}};
  if (inside.low.x >= inside.high.x || inside.low.y >= inside.high.y) {
    return;
  }
  field_.clear(inside);
  stamp_balls(inside);
  support_left(inside, true);
}

void ParticleWorld::draw_wall(Vec2i from, Vec2i to, int32_t diameter) {
  brush(from, to, diameter, true);
}

void ParticleWorld::erase_wall(Vec2i from, Vec2i to, int32_t diameter) {
  brush(from, to, diameter, false);
}

// A disc at each cell of the line: as many steps as the longer component, the other rounded.
void ParticleWorld::brush(Vec2i from, Vec2i to, int32_t diameter, bool solid) {
  if (diameter < 1 || config_.width == 0 || config_.height == 0) {
    return;
  }
  const DiscStamp disc = disc_stamp(diameter);
  const int32_t half = (disc.diameter - 1) / 2;
  const Vec2i a{clamped(from.x, -kFarthest, kFarthest), clamped(from.y, -kFarthest, kFarthest)};
  const Vec2i b{clamped(to.x, -kFarthest, kFarthest), clamped(to.y, -kFarthest, kFarthest)};
  const Vec2i step{b.x < a.x ? -1 : 1, b.y < a.y ? -1 : 1};
  const Vec2i run{(b.x - a.x) * step.x, (b.y - a.y) * step.y};
  const int32_t longer = run.x > run.y ? run.x : run.y;
  Vec2i at = a;
  Vec2i error{longer >> 1, longer >> 1};
  for (int32_t i = 0; i <= longer; ++i) {
    const Vec2i corner{at.x - half, at.y - half};
    if (corner.x < config_.width && corner.y < config_.height && corner.x > -disc.diameter &&
        corner.y > -disc.diameter) {
      if (solid) {
        field_.set(disc, corner);
      } else {
        field_.clear(disc, corner);
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      error[axis] -= run[axis];
      if (error[axis] < 0) {
        error[axis] += longer;
        at[axis] += step[axis];
      }
    }
  }
  if (!solid) {
    const Vec2i least{(a.x < b.x ? a.x : b.x) - half, (a.y < b.y ? a.y : b.y) - half};
    const CellBox touched{least, {least.x + run.x + disc.diameter, least.y + run.y + disc.diameter}};
    stamp_balls(touched);
    support_left(touched, true);
  }
}

// --- Forces

Status ParticleWorld::set_gravity(Vec2i gravity_q16) {
  if (!is_within(gravity_q16.x, kMaxAccelerationQ16) || !is_within(gravity_q16.y, kMaxAccelerationQ16)) {
    return Status::kOutOfRange;
  }
  if (gravity_q16 == config_.gravity_q16) {
    return Status::kOk;
  }
  config_.gravity_q16 = gravity_q16;
  pulled_ = gravity_q16 != Vec2i{};
  const int32_t strength = rough_length(gravity_q16);
  rest_speed_ = 2 * strength + (strength >> 1);
  gravity_part_ = {part_of(gravity_q16.x, config_.substeps_log2),
                   part_of(gravity_q16.y, config_.substeps_log2)};
  owed_ = 0;
  wake_all();
  return Status::kOk;
}

Status ParticleWorld::set_restitution(uint32_t restitution_q16) {
  if (restitution_q16 > 65536) {
    return Status::kOutOfRange;
  }
  if (restitution_q16 != config_.restitution_q16) {
    config_.restitution_q16 = restitution_q16;
    owed_ = 0;
  }
  return Status::kOk;
}

Status ParticleWorld::set_diameters(int32_t least, int32_t most) {
  // The index was laid out for the largest ball at init; the balls that are there may be that large.
  if (least < 1 || least > most || most > config_.most_diameter) {
    return Status::kOutOfRange;
  }
  config_.least_diameter = least;
  largest_spawned_ = most;
  return Status::kOk;
}

// --- Measures

UInt128 ParticleWorld::energy() const {
  UInt128 sum;
  for (uint32_t id = 0; id < id_limit_; ++id) {
    const Ball& ball = balls_[id];
    // Below 2^59; times the mass below 2^67, so in two halves.
    const uint64_t square =
        static_cast<uint64_t>(int64_t{ball.vx} * ball.vx) + static_cast<uint64_t>(int64_t{ball.vy} * ball.vy);
    const uint32_t mass = uint32_t{ball.diameter} * ball.diameter;
    const uint64_t low = (square & UINT32_MAX) * mass;
    const uint64_t high = (square >> 32) * mass + (low >> 32);
    const uint64_t add = high << 32 | (low & UINT32_MAX);
    sum.low += add;
    sum.high += (high >> 32) + (sum.low < add ? 1 : 0);
  }
  return sum;
}

ParticleWorld::Momentum ParticleWorld::momentum() const {
  Momentum sum;
  for (uint32_t id = 0; id < id_limit_; ++id) {
    const Ball& ball = balls_[id];
    const int32_t mass = int32_t{ball.diameter} * ball.diameter;
    sum.x += int64_t{ball.vx} * mass;
    sum.y += int64_t{ball.vy} * mass;
  }
  return sum;
}

uint32_t ParticleWorld::state_crc32() const {
  uint32_t crc = 0;
  for (uint32_t id = 0; id < id_limit_; ++id) {
    const Ball& ball = balls_[id];
    if (ball.diameter == 0) {
      continue;
    }
    uint8_t bytes[22];
    bits::store32(bytes, id);
    bits::store32(bytes + 4, static_cast<uint32_t>(ball.x));
    bits::store32(bytes + 8, static_cast<uint32_t>(ball.y));
    bits::store32(bytes + 12, static_cast<uint32_t>(ball.vx));
    bits::store32(bytes + 16, static_cast<uint32_t>(ball.vy));
    bytes[20] = ball.diameter;
    bytes[21] = (ball.flags & kAsleep) != 0 ? 1 : 0;
    crc = crc32({bytes, sizeof(bytes)}, crc);
  }
  for (int32_t y = 0; y < config_.height; ++y) {
    for (int32_t column = 0; column < field_.columns(); ++column) {
      uint8_t bytes[4];
      bits::store32(bytes, field_.cells_32(column, y));
      const int32_t cells = config_.width - 32 * column;
      crc = crc32({bytes, static_cast<size_t>(cells >= 32 ? 4 : (cells + 7) / 8)}, crc);
    }
  }
  return crc;
}

}  // namespace thimble
