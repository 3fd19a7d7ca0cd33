// This project's particle world as an engine of the comparison.
#include <cmath>
#include <stdexcept>

#include "engine.h"
#include "thimble/plane/particles.h"

namespace thimble::benchmarks {
namespace {

std::int32_t to_q16(double value) {
  return static_cast<std::int32_t>(std::lround(value * 65536));
}

class BitFieldEngine : public Engine {
 public:
  explicit BitFieldEngine(const Scene& scene) {
    ParticleConfig config;
    config.width = scene.width;
    config.height = scene.height;
    config.capacity = static_cast<std::uint32_t>(scene.balls.size());
    config.restitution_q16 = static_cast<std::uint32_t>(to_q16(scene.restitution));
    config.gravity_q16 = {0, to_q16(scene.gravity)};
    words_.resize(particles_bytes(config) / 4 + 1);
    check(ParticleWorld::make(config, {reinterpret_cast<std::uint8_t*>(words_.data()), words_.size() * 4},
                              &world_));
    for (const int x : scene.wall_columns) {
      world_.draw_box({{x, 0}, {x + 1, scene.height}});
    }
    for (const BallState& ball : scene.balls) {
      check(world_.spawn(to_q16(ball.x), to_q16(ball.y), to_q16(ball.vx), to_q16(ball.vy),
                         static_cast<std::int32_t>(ball.diameter), nullptr));
    }
  }

  void step() override {
    world_.step();
    collisions_ += world_.counters().ball_hits + world_.counters().wall_hits;
  }
  std::uint64_t collisions() const override { return collisions_; }
  std::vector<BallState> balls() const override {
    std::vector<BallState> result;
    for (std::uint32_t id = 0; id < world_.id_limit(); ++id) {
      Particle particle;
      if (world_.particle(id, &particle)) {
        result.push_back({particle.x_q16 / 65536.0, particle.y_q16 / 65536.0, particle.vx_q16 / 65536.0,
                          particle.vy_q16 / 65536.0, static_cast<double>(particle.diameter),
                          particle.asleep});
      }
    }
    return result;
  }
  std::size_t asleep() const override { return world_.asleep(); }
  std::size_t memory_bytes() const override { return world_.used_bytes(); }

 private:
  static void check(Status status) {
    if (status != Status::kOk) {
      throw std::runtime_error(std::string("bit field: ") + status_text(status));
    }
  }

  std::vector<std::uint32_t> words_;
  ParticleWorld world_;
  std::uint64_t collisions_ = 0;
};

}  // namespace

std::unique_ptr<Engine> make_bit_field_engine(const Scene& scene) {
  return std::make_unique<BitFieldEngine>(scene);
}

}  // namespace thimble::benchmarks
