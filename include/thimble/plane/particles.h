/// @file particles.h
/// The paper's particle world: balls in a bit field, where a collision costs the same however many there are.
///
///     (0, 0) +--------------------> x     800 x 600 cells, one bit each; gravity is a vector, and the
///            |     o                      default pulls down the picture (+y). Nothing leaves the box.
///            |        ()   /   wall
///            v   o        /               one step = one unit of time; speeds are in cells a step
///            y  ()()o  O /o
///
/// A ball is a disc of cells (bitfield.h) around a centre in Q16.16. It moves by tracing its disc through the
/// field along the exact line of its displacement, cell by cell; what it would cover is all that it looks at.
/// Where something is in the way it bounces: off the box and drawn walls with the restitution, off another
/// ball by exchanging momentum by mass (the diameter squared). The other ball is found in constant time from
/// an index of square cells. At all times, after every call:
///
/// * the field is the union of the walls and of the discs of all balls, and no disc shares a cell with
///   another or with a wall;
/// * every disc lies inside the box;
/// * a ball asleep under gravity is held: its disc moved by one cell along the axis on which gravity pulls
///   most (either, where it pulls the same on both) meets the box, a wall or another ball; `is_held` is that
///   predicate, exactly. What holds it has its centre further along that axis, so support ends at a wall or
///   at the box.
///
/// Everything is integers, so the same calls give the same state (`state_crc32`) on every machine. A world
/// that is mirrored or turned by quarters, with the same balls by the same numbers, stays the exact image of
/// the other (give odd positions in Q16: see `spawn`). A single world that is its own mirror image does not
/// stay so once balls meet on the mirror line, because balls move one after the other; src/plane/PARTICLES.md
/// says more, and where the constants below come from.
#ifndef THIMBLE_PLANE_PARTICLES_H
#define THIMBLE_PLANE_PARTICLES_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "bitfield.h"

namespace thimble {

/// Diameters are 1 .. this many cells.
inline constexpr int32_t kMaxBallDiameter = kMaxSmallDisc;
/// Components of a velocity, in Q16 cells a step, are held within +-8192 cells.
inline constexpr int32_t kMaxSpeedQ16 = int32_t{1} << 29;
/// A component of gravity and of other accelerations, in Q16 cells a step a step: +-1024 cells.
inline constexpr int32_t kMaxAccelerationQ16 = int32_t{1} << 26;
/// Balls are numbered from 0 and there are at most this many.
inline constexpr uint32_t kMaxBalls = uint32_t{1} << 20;
/// No ball.
inline constexpr uint32_t kNoBall = UINT32_MAX;

/// How to set up a world. The defaults are the paper's Figure 1.
struct ParticleConfig {
  int32_t width = 800;         ///< cells, 0 .. kMaxFieldSide
  int32_t height = 600;        ///< cells, 0 .. kMaxFieldSide
  uint32_t capacity = 693;     ///< most balls at a time, 0 .. kMaxBalls
  int32_t least_diameter = 2;  ///< of a random ball, cells, 1 .. most_diameter
  int32_t most_diameter = 12;  ///< of any ball, cells, 1 .. kMaxBallDiameter
  /// 0 (no bounce) .. 65536 (no loss). At 65536 nothing falls asleep under gravity, and the energy of speed
  /// and height together keeps within 1 per cent of the start while gravity adds at most a quarter of a cell a
  /// step in each part of a step (measured, not proven; src/plane/PARTICLES.md). Below 65536 it does not grow but for
  /// gains that are still to be paid back: in the tests less than 0.1 per cent of the start, 1 from 65000 on.
  uint32_t restitution_q16 = 52429;
  Vec2i gravity_q16{0, 6554};  ///< cells a step a step, each +-kMaxAccelerationQ16
  uint32_t seed = 1;           ///< of random balls
  /// Each step is made in 2^substeps_log2 parts, 0 .. 4. More parts follow a curved path more closely and
  /// cost that many times as much.
  int32_t substeps_log2 = 0;
  /// Positions are kept to 2^-subpixel_bits cells, 1 .. 15. A displacement is rounded to that, so slower
  /// balls than half of it stand still: fewer bits are for measuring what they cost.
  int32_t subpixel_bits = 15;
};

namespace particle_detail {

/// One ball: 32 bytes. What is not here follows from it: its corner is disc_corner(x, diameter).
struct Ball {
  int32_t x, y;    // centre, Q16 cells: corner + diameter / 2 + an odd number of half units (never on a tie)
  int32_t vx, vy;  // Q16 cells a step
  uint32_t next, previous;  // in the list of its cell; `next` is the list of free numbers for a removed ball
  int8_t near_x, near_y;    // cells it has gone since `still` began
  int8_t far_x, far_y;      // and since `confined` did
  uint8_t diameter;         // 0: removed
  uint8_t flags;
  uint8_t still;     // steps within a cell of its place, under gravity; else steps at speed 0
  uint8_t confined;  // steps within a few cells
};
static_assert(sizeof(Ball) == 32);

/// 128 for rows that are read beyond the last of the field, 4 for bytes that do not begin at a multiple of 4.
inline constexpr size_t kSlackBytes = 132;
/// log2 of the side of a cell of the index: the least power of two that holds the largest ball, at least 8.
constexpr int32_t cell_shift(int32_t most_diameter) {
  return most_diameter <= 8 ? 3 : 4;
}
constexpr size_t cell_count(int32_t width, int32_t height, int32_t most_diameter) {
  const int32_t shift = cell_shift(most_diameter);
  const int32_t round = (int32_t{1} << shift) - 1;
  return static_cast<size_t>((width + round) >> shift) * static_cast<size_t>((height + round) >> shift);
}
/// Words of the set of balls awake: a bit a ball, and above it twice a bit for each word that is not empty.
constexpr size_t awake_words(uint32_t capacity) {
  const size_t leaves = (size_t{capacity} + 31) / 32;
  const size_t middle = (leaves + 31) / 32;
  return leaves + middle + (middle + 31) / 32;
}

}  // namespace particle_detail

/// Bytes of a world, all of it: field, balls, the index of cells (4 bytes for each square of 16 x 16 cells, 8
/// x 8 when no ball is larger than 8), and the set of those awake. 90,004 for the paper's world, 3,604 for 60
/// balls of up to 8 on 128 x 64 cells. 0 for an argument beyond its limits.
constexpr size_t particles_bytes(int32_t width, int32_t height, uint32_t capacity,
                                 int32_t most_diameter = 12) {
  if (width < 0 || height < 0 || width > kMaxFieldSide || height > kMaxFieldSide || capacity > kMaxBalls ||
      most_diameter < 1 || most_diameter > kMaxBallDiameter) {
    return 0;
  }
  return bitfield_bytes(width, height) + size_t{capacity} * sizeof(particle_detail::Ball) +
         4 * particle_detail::cell_count(width, height, most_diameter) +
         4 * particle_detail::awake_words(capacity) + particle_detail::kSlackBytes;
}
/// The same; 0 for each configuration that `ParticleWorld::make` refuses, too.
constexpr size_t particles_bytes(const ParticleConfig& config) {
  const auto is_weak = [](int32_t component) {
    return component >= -kMaxAccelerationQ16 && component <= kMaxAccelerationQ16;
  };
  if (config.least_diameter < 1 || config.least_diameter > config.most_diameter ||
      config.restitution_q16 > 65536 || !is_weak(config.gravity_q16.x) || !is_weak(config.gravity_q16.y) ||
      config.substeps_log2 < 0 || config.substeps_log2 > 4 || config.subpixel_bits < 1 ||
      config.subpixel_bits > 15) {
    return 0;
  }
  return particles_bytes(config.width, config.height, config.capacity, config.most_diameter);
}

/// What one ball is, as seen from outside.
struct Particle {
  uint32_t id = kNoBall;
  int32_t x_q16 = 0;  ///< centre, cells
  int32_t y_q16 = 0;
  int32_t vx_q16 = 0;  ///< cells a step
  int32_t vy_q16 = 0;
  int32_t radius_q16 = 0;  ///< half the diameter
  int32_t diameter = 0;    ///< cells
  Vec2i corner;            ///< of its disc in the field
  bool asleep = false;
};

/// What the last step did.
struct StepCounters {
  uint32_t moves = 0;  ///< displacements made (awake balls times substeps, those that stood still left out)
  uint32_t mask_tests = 0;  ///< looks at the field for a disc or for the box around a sweep
  uint32_t ball_hits = 0;   ///< balls met
  uint32_t wall_hits = 0;   ///< walls, drawn things and sides of the box met
  uint32_t woken = 0;       ///< sleepers woken
};

/// 128 bits: `high` * 2^64 + `low`.
struct UInt128 {
  uint64_t high = 0;
  uint64_t low = 0;
};

/// What the pointer does while it is pressed. Only the one that is on is computed.
enum class PointerMode : uint8_t {
  kNone,
  kDrag,     ///< draws the ball under it along (the one taken when the pointer went down)
  kAttract,  ///< accelerates balls within the radius towards it, by up to the strength
  kRepel,    ///< the same, away from it
  kSpawn,    ///< adds a random ball at its place, one a step, when there is room
  kErase,    ///< removes balls and walls within the radius
  kDraw,     ///< draws a wall as thick as the radius says, from where it was to where it is
};

/// The world, in the caller's bytes, which outlive it. Copies share the bytes.
class ParticleWorld {
 public:
  /// A world of no cells and no balls.
  ParticleWorld() = default;

  /// Makes `world` an empty world in the first particles_bytes(config) of `bytes`. `kOutOfRange` for a value
  /// of `config` beyond its limits, `kOutOfMemory` when `bytes` is too small; `world` and `bytes` are then
  /// untouched. A box of no cells is a world that stays empty. Cost: clears the bytes.
  static Status make(const ParticleConfig& config, Bytes bytes, ParticleWorld* world);
  /// The same in an arena, which gives just those bytes; after an error it is as it was.
  static Status make(const ParticleConfig& config, Arena& arena, ParticleWorld* world) {
    return make_in(arena, particles_bytes(config), sizeof(uint32_t),
                   [&](Bytes bytes) { return make(config, bytes, world); });
  }

  const ParticleConfig& config() const { return config_; }
  const BitField& field() const { return field_; }
  size_t used_bytes() const { return particles_bytes(config_); }

  // --- Balls

  /// Puts a ball of `diameter` with its centre at (x, y) and stores its number in `id` (may be null). The
  /// centre is moved to an odd number of 2^-16 cells (`x | 1` for the finest subpixel_bits). `kOutOfRange`
  /// when the diameter is not 1 .. most_diameter, a velocity exceeds its limit or the disc is not all inside
  /// the box; `kOutOfMemory` when there is no room: `capacity` balls, or a set cell under the disc. Nothing
  /// has changed then.
  Status spawn(int32_t x_q16, int32_t y_q16, int32_t vx_q16, int32_t vy_q16, int32_t diameter, uint32_t* id);
  /// A ball of random diameter, place and velocity (components uniform in +-max_speed_q16). Where 64 random
  /// places are taken, the first free one in reading order from a random one on is used. `kOutOfRange` when
  /// the diameter drawn is larger than the box, `kOutOfMemory` when there is no room for it anywhere; nothing
  /// has changed then, the random numbers to come included. Cost: up to one mask test a cell.
  Status spawn_random(int32_t max_speed_q16, uint32_t* id = nullptr);
  /// Removes a ball. `kOutOfRange` when there is none of that number.
  Status remove(uint32_t id);

  /// Balls there are.
  uint32_t count() const { return count_; }
  uint32_t asleep() const { return asleep_; }
  uint32_t awake() const { return count_ - asleep_; }
  /// Numbers are below this; not all need be in use.
  uint32_t id_limit() const { return id_limit_; }
  /// The ball of that number; false, and `particle` untouched, when there is none.
  bool particle(uint32_t id, Particle* particle) const;
  /// The ball that covers cell `at`, or kNoBall. Constant time.
  uint32_t ball_at(Vec2i at) const;
  /// Whether the disc of ball `id`, moved by one cell along gravity (on the axis on which it pulls most; on
  /// either, where it pulls the same on both), would meet something. True of every sleeper under gravity.
  bool is_held(uint32_t id) const;

  /// Gives a ball a new velocity and wakes it. `kOutOfRange` for no such ball or beyond +-kMaxSpeedQ16.
  Status set_velocity(uint32_t id, int32_t vx_q16, int32_t vy_q16);
  void wake_all();

  // --- Walls. Cells of balls are never changed: a wall drawn over a ball leaves out the ball's cells.

  /// Fills the cells of `box`, any box: what lies outside the field is passed over.
  void draw_box(const CellBox& box);
  /// A disc of `diameter` cells drawn along the line from cell to cell; 1 gives a line that is a wall.
  /// Coordinates within +-4 * kMaxFieldSide, others are cut to that. Cost: a disc for each cell of the line.
  void draw_wall(Vec2i from, Vec2i to, int32_t diameter);
  void draw_wall(Vec2i at, int32_t diameter) { draw_wall(at, at, diameter); }
  /// Clears walls (not balls) under the same brush, and wakes balls that rested on them.
  void erase_wall(Vec2i from, Vec2i to, int32_t diameter);
  void erase_wall(Vec2i at, int32_t diameter) { erase_wall(at, at, diameter); }
  /// Clears the walls in `box`, any box: what lies outside the field is passed over.
  void erase_box(const CellBox& box);

  // --- Forces

  /// `kOutOfRange` beyond +-kMaxAccelerationQ16. A change wakes every ball.
  Status set_gravity(Vec2i gravity_q16);
  /// 0 .. 65536, else `kOutOfRange`.
  Status set_restitution(uint32_t restitution_q16);
  /// Diameters of random balls from now on, 1 .. least .. most .. config().most_diameter, else `kOutOfRange`.
  Status set_diameters(int32_t least, int32_t most);
  /// What the pointer does from the next step on, and where, in cells; anywhere, outside the box too.
  /// `radius` 1 .. 1024 cells, `strength_q16` 0 .. kMaxAccelerationQ16 (attract, repel); others are cut to
  /// that. kDrag takes the ball under `at` when the mode was another before.
  void set_pointer(PointerMode mode, Vec2i at, int32_t radius = 32, int32_t strength_q16 = 32768);
  PointerMode pointer_mode() const { return pointer_mode_; }
  /// The ball being dragged, or kNoBall.
  uint32_t dragged() const { return dragged_; }

  // --- Time

  /// One step. Cost: nothing for sleepers. Each ball awake takes some 300 instructions with SSE2 and two
  /// dozen words of the field, whatever else there is; where something is in its way, about 1,500 more. Long
  /// ways add one look at a window of at most 32 x 32 cells for every 16 boundaries between cells that they
  /// cross. Stack: at most 1.4 KB. The order in which balls move is that of their numbers.
  void step();
  uint32_t steps() const { return steps_; }
  const StepCounters& counters() const { return counters_; }

  // --- Measures. Cost: a pass over all balls; the CRC over the field as well.

  /// Twice the kinetic energy: sum of diameter^2 * (vx^2 + vy^2), velocities in 2^-16 cells a step.
  UInt128 energy() const;
  /// Sum of diameter^2 * v, in 2^-16 cells a step.
  struct Momentum {
    int64_t x = 0;
    int64_t y = 0;
  };
  Momentum momentum() const;
  /// CRC-32 of the state: for each ball in order of number x, y, vx, vy (4 bytes each, little-endian),
  /// diameter and asleep (a byte each), its number before them; then the field, row by row, eight cells a
  /// byte, the lowest bit on the left.
  uint32_t state_crc32() const;

 private:
  using Ball = particle_detail::Ball;
  struct Blocked;
  struct Contacts;
  struct Line;
  struct Window;

  // particles.cpp: places and lists.
  Vec2i corner_of(const Ball& ball) const {
    return {disc_corner(ball.x, ball.diameter), disc_corner(ball.y, ball.diameter)};
  }
  uint32_t cell_of(int32_t x_q16, int32_t y_q16) const {
    return static_cast<uint32_t>((y_q16 >> (16 + cell_shift_)) * cells_across_ +
                                 (x_q16 >> (16 + cell_shift_)));
  }
  struct CellRange;
  CellRange cells_around(const CellBox& box, int32_t reach) const;
  void link(uint32_t id);
  void unlink(uint32_t id, uint32_t cell);
  void set_awake_bit(uint32_t id);
  void clear_awake_bit(uint32_t id);
  uint32_t next_awake(uint32_t from) const;
  uint32_t random();
  uint32_t random_below(uint32_t limit);
  void brush(Vec2i from, Vec2i to, int32_t diameter, bool solid);

  // particles_step.cpp: the way of one ball.
  template <bool kPulled>
  void advance_all(bool last);
  template <bool kPulled>
  void advance(uint32_t id);
  void trace(uint32_t id, Vec2i way, Vec2i own, bool looked);
  Blocked walk(Ball* ball, Vec2i way, Vec2i own, bool first_walk, bool looked, Window* window);
  void load_window(const CellBox& box, const DiscStamp& disc, Vec2i own, Window* window) const;
  int32_t displacement(int32_t velocity) const;

  // particles_contact.cpp: what is met, and what it does.
  void contacts_at(uint32_t self, const DiscStamp& disc, Vec2i place, uint32_t (&rows)[kMaxSmallDisc],
                   uint32_t rows_set, uint32_t axis_bits, Contacts* contacts) const;
  void collide(uint32_t id, const Blocked& blocked, const Window& window, Vec2i own);
  Vec2i wall_normal(uint32_t id, Vec2i offset, Vec2i own) const;
  void bounce(Ball& ball, uint32_t other_id, Vec2i normal, Vec2i away, uint32_t axes);
  void push(Ball& ball, Ball* other, Vec2i normal, int64_t along, uint32_t restitution_q16);
  bool lossless() const { return pulled_ && config_.restitution_q16 == 65536; }
  int64_t fall(Vec2i kick, Vec2i way) const {
    return (int64_t{kick.x} * way.x + int64_t{kick.y} * way.y) * (int32_t{1} << config_.substeps_log2);
  }
  void account(int64_t gain, uint32_t mass);
  void settle(Ball& ball, Vec2i kick, int64_t gain);

  // particles_rest.cpp: sleep.
  void wake(uint32_t id);
  static bool has_settled(Ball& ball);
  void rest(uint32_t id);
  bool lies_still(uint32_t id) const;
  bool pulls_most(int axis) const;
  bool held(const Ball& ball) const;
  void hold(uint32_t id);
  void support_left(const CellBox& box, bool for_good);
  void stamp_balls(const CellBox& box);

  // particles_pointer.cpp
  void apply_pointer();
  void pull_balls(int32_t sign);

  ParticleConfig config_{0, 0, 0, 1, 1, 65536, {0, 0}, 1, 0, 15};
  BitField field_;
  field_detail::Word* words_ = nullptr;  // of the field
  Ball* balls_ = nullptr;
  uint32_t* cells_ = nullptr;  // first ball of each cell
  uint32_t* awake_ = nullptr;
  uint32_t* awake_middle_ = nullptr;
  uint32_t* awake_top_ = nullptr;
  uint32_t top_words_ = 0;
  int32_t cells_across_ = 0;
  int32_t cells_down_ = 0;
  int32_t cell_shift_ = 4;
  uint32_t count_ = 0;
  uint32_t asleep_ = 0;
  uint32_t id_limit_ = 0;
  uint32_t free_ = kNoBall;
  uint32_t random_ = 1;
  int32_t largest_spawned_ = 1;
  uint32_t steps_ = 0;
  bool pulled_ = false;     // gravity is not zero
  int32_t rest_speed_ = 0;  // Q16; impacts below it do not bounce
  Vec2i gravity_part_;      // gravity a substep
  // What is due to the balls' energy under gravity (src/plane/PARTICLES.md): units of 256 of mass times
  // square_of, and what is left over of them.
  int64_t owed_ = 0;
  uint32_t owed_rest_ = 0;
  int32_t unit_ = 2;  // 2^-16 cells in a unit of position
  // As velocities, half a unit of position and what cuts to whole ones.
  int32_t round_ = 1;
  int32_t grid_ = -2;
  PointerMode pointer_mode_ = PointerMode::kNone;
  Vec2i pointer_;
  Vec2i pointer_before_;
  int32_t pointer_radius_ = 1;
  int32_t pointer_strength_ = 0;
  uint32_t dragged_ = kNoBall;
  StepCounters counters_;
};

}  // namespace thimble

#endif
