/// A particle world with its bytes, its balls and their colours, as `thimble particles` begins it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "thimble/picture/pixel.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {

// Bodies in the plane, as programs that simulate gravity between them exchange them.
//
// Text: the number of bodies, the radius of the world, then a line each: `x y vx vy m r g b`, with the
// colour in whole numbers of 0 .. 255. y goes up. Empty lines are passed over.

struct Body {
  double x = 0;
  double y = 0;
  double vx = 0;
  double vy = 0;
  double mass = 0;  ///< above 0
  Rgb8 color;
};

struct Bodies {
  double radius = 0;  ///< above 0; some bodies may lie beyond it
  std::vector<Body> bodies;
};

/// Throws InputError "line L, column C: ..." for anything else, also for numbers that are not finite, a mass
/// of 0 or less, and fewer or more lines than announced.
Bodies read_bodies(std::string_view text);

/// How a world begins: capacity and restitution follow from what is said here.
struct WorldOptions : ParticleConfig {
  std::uint32_t count = 693;
  double bounciness = 0.8;
  double speed = 3;  ///< of random balls on each axis, of the fastest body; cells a step
};

/// What became of the bodies of a file.
struct Placing {
  std::uint32_t placed = 0;
  std::uint32_t moved = 0;    ///< of those, to the nearest free place
  std::uint32_t outside = 0;  ///< left out: beyond the box
  std::uint32_t crowded = 0;  ///< left out: no free place near
};

/// Balls are numbered as they come. There is room for twice as many as it begins with, and 1,000 at least,
/// for a hand that adds some.
///
/// Bodies: the circle of the file's radius touches the nearer sides of the box, in its middle; y is turned. A
/// ball's area goes with the mass, from the largest diameter down to the least; speeds so that the fastest
/// body has `speed`. Where the place is taken, the nearest free one within 64 cells is.
class PopulatedWorld {
 public:
  /// Throws InputError when not all random balls fit, saying how many did, or no body does.
  PopulatedWorld(const WorldOptions& options, const std::optional<Bodies>& bodies);
  PopulatedWorld(const PopulatedWorld&) = delete;
  PopulatedWorld& operator=(const PopulatedWorld&) = delete;

  ParticleWorld& world() { return world_; }
  const ParticleWorld& world() const { return world_; }
  const WorldOptions& options() const { return options_; }
  const Placing& placing() const { return placing_; }

  /// The colour of ball `id` (apps/ball_color.h, or the file's), at rest darker.
  Rgb8 color_of(const Particle& ball) const;

  /// Begins again with other sizes, bounciness, gravity or count; as many balls as fit.
  void begin_again(const WorldOptions& options);

 private:
  std::uint32_t fill();
  void place_bodies();

  WorldOptions options_;
  std::optional<Bodies> bodies_;
  std::vector<std::uint8_t> bytes_;
  std::vector<Rgb8> colors_;  // of bodies, by number; a ball that came later has none
  Placing placing_;
  ParticleWorld world_;
};

/// Calls `visit` with each ball in order of number.
template <class Visit>
void for_each_ball(const ParticleWorld& world, const Visit& visit) {
  for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
    Particle ball;
    if (world.particle(id, &ball)) {
      visit(ball);
    }
  }
}

/// What restitution a bounciness of 0 .. 1 is.
std::uint32_t restitution_q16(double bounciness);

}  // namespace thimble::tools
