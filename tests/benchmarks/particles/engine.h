/// One interface over what is compared: this project's particle world, a plain uniform grid and Box2D 2.4.
///
/// Lengths are pixels (cells of the field), times are steps, y points down. Every engine gets the same balls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace thimble::benchmarks {

/// A ball as every engine can say it.
struct BallState {
  double x = 0;
  double y = 0;
  double vx = 0;
  double vy = 0;
  double diameter = 0;
  bool asleep = false;
};

/// A box with balls in it, and one-pixel walls: columns of pixels from top to bottom.
struct Scene {
  std::string name;
  int width = 0;
  int height = 0;
  double restitution = 1;
  double gravity = 0;  ///< down, pixels a step a step
  std::vector<BallState> balls;
  std::vector<int> wall_columns;
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step() = 0;
  /// Collisions since the beginning, as the engine itself counts them.
  virtual std::uint64_t collisions() const = 0;
  virtual std::vector<BallState> balls() const = 0;
  /// Balls asleep.
  virtual std::size_t asleep() const = 0;
  /// Bytes that the world takes.
  virtual std::size_t memory_bytes() const = 0;
};

/// The names that `make_engine` knows, this project's first; Box2D only where it was compiled in.
std::vector<std::string> engine_names();
/// Throws `std::invalid_argument` for another name, `std::runtime_error` when the scene does not fit.
std::unique_ptr<Engine> make_engine(const std::string& name, const Scene& scene);

std::unique_ptr<Engine> make_bit_field_engine(const Scene& scene);
std::unique_ptr<Engine> make_grid_engine(const Scene& scene);
/// The uniform grid in double precision: with many substeps, round balls as exact as one likes.
std::unique_ptr<Engine> make_reference_engine(const Scene& scene, int substeps);
#ifdef THIMBLE_HAVE_BOX2D
/// `bullets`: balls are looked for along their way, not only where they end.
std::unique_ptr<Engine> make_box2d_engine(const Scene& scene, bool bullets);
#endif

/// Balls of 2 to 12 pixels at random places, none overlapping, speeds uniform to +-3 pixels a step on both
/// axes; 800 x 600 for 693 balls, the area in proportion. "gas": no gravity, restitution 1. "falling":
/// gravity 0.1, restitution 0.8.
Scene make_scene(const std::string& name, int balls, std::uint32_t seed = 1);
/// 40 balls of 4 to 12 pixels left of a one-pixel wall in the middle of 800 x 600, all moving right at
/// `speed`.
Scene make_wall_scene(double speed);

/// Sum of diameter^2 * v^2.
double kinetic_energy(const std::vector<BallState>& balls);
/// How deep the circles of two balls reach into each other at most, or into the box; 0 when nothing does.
double greatest_overlap(const Scene& scene, const std::vector<BallState>& balls);
/// Balls asleep with nothing under them: neither the floor nor a ball whose centre is lower within `slack`
/// pixels of touching.
std::size_t floating_sleepers(const Scene& scene, const std::vector<BallState>& balls, double slack = 1.5);
/// Balls whose velocity changed by more than `threshold` between two states besides what gravity did: a
/// count of collisions that asks no engine.
std::size_t kinks(const Scene& scene, const std::vector<BallState>& before,
                  const std::vector<BallState>& after, double threshold = 0.05);

}  // namespace thimble::benchmarks
