// A particle world together with a second picture of what must be in its field, kept cell by cell without the
// core's masks: walls as they were drawn, and who covers which cell.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "thimble/plane/particles.h"

namespace thimble::tools {

/// In 1/65536.
constexpr std::int32_t q16(double value) {
  return static_cast<std::int32_t>(value * 65536);
}

/// Whether cell (column, row) of a square of `diameter` cells belongs to the disc in it.
inline bool in_disc(int diameter, int column, int row) {
  const int u = 2 * column + 1 - diameter;
  const int v = 2 * row + 1 - diameter;
  return u * u + v * v < diameter * diameter;
}

/// A world in bytes of its own, which were used before.
struct OwnedParticles {
  explicit OwnedParticles(const ParticleConfig& config) : bytes(particles_bytes(config), 0xA5) {
    REQUIRE(ParticleWorld::make(config, {bytes.data(), bytes.size()}, &world) == Status::kOk);
  }
  Particle ball(std::uint32_t id) const {
    Particle one;
    REQUIRE(world.particle(id, &one));
    return one;
  }
  std::vector<std::uint8_t> bytes;
  ParticleWorld world;
};

/// A place without gravity for balls of any diameter.
inline ParticleConfig weightless(std::int32_t width, std::int32_t height, std::uint32_t capacity = 12) {
  ParticleConfig config;
  config.width = width;
  config.height = height;
  config.capacity = capacity;
  config.least_diameter = 1;
  config.gravity_q16 = {0, 0};
  return config;
}

class ShadowedWorld {
 public:
  explicit ShadowedWorld(const ParticleConfig& config)
      : bytes_(particles_bytes(config)),
        walls_(static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.height), 0) {
    status = ParticleWorld::make(config, {bytes_.data(), bytes_.size()}, &world);
  }

  ParticleWorld world;
  Status status = Status::kOk;

  /// Random balls until there are `count` or there is no room; how many there are then.
  std::uint32_t fill(std::uint32_t count, std::int32_t max_speed_q16) {
    // One diameter may not fit any more where a smaller one does.
    int refused = 0;
    while (world.count() < count && refused < 3) {
      if (world.spawn_random(max_speed_q16) != Status::kOk) {
        ++refused;
      }
    }
    return world.count();
  }
  void draw_box(const CellBox& box) {
    world.draw_box(box);
    note_walls();
  }
  void draw_wall(Vec2i from, Vec2i to, std::int32_t diameter) {
    world.draw_wall(from, to, diameter);
    note_walls();
  }
  void erase_box(const CellBox& box) {
    world.erase_box(box);
    for_cells([&](Vec2i at) {
      if (at.x >= box.low.x && at.x < box.high.x && at.y >= box.low.y && at.y < box.high.y) {
        walls_[index(at)] = 0;
      }
    });
  }
  /// Takes as walls all that is set and belongs to no ball.
  void note_walls() {
    const std::vector<std::uint32_t> owners = covered();
    for_cells([&](Vec2i at) {
      walls_[index(at)] = world.field().test(at) && owners[index(at)] == kNoBall ? 1 : 0;
    });
  }

  /// What is wrong with the world, or nothing.
  std::string fault() const {
    const ParticleConfig& config = world.config();
    std::vector<std::uint32_t> owners(walls_.size(), kNoBall);
    std::uint32_t balls = 0;
    std::uint32_t asleep = 0;
    for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
      Particle ball;
      if (!world.particle(id, &ball)) {
        continue;
      }
      ++balls;
      asleep += ball.asleep ? 1 : 0;
      const std::string name = "ball " + std::to_string(id);
      if (ball.corner.x < 0 || ball.corner.y < 0 || ball.corner.x + ball.diameter > config.width ||
          ball.corner.y + ball.diameter > config.height) {
        return name + " is outside";
      }
      // The centre says where the disc is: at the nearest corner, and never half way between two.
      const double x = ball.x_q16 / 65536.0 - ball.diameter / 2.0 - ball.corner.x;
      const double y = ball.y_q16 / 65536.0 - ball.diameter / 2.0 - ball.corner.y;
      if (!(x > -0.5 && x < 0.5 && y > -0.5 && y < 0.5)) {
        return name + " is not at its corner";
      }
      for (int row = 0; row < ball.diameter; ++row) {
        for (int column = 0; column < ball.diameter; ++column) {
          if (!in_disc(ball.diameter, column, row)) {
            continue;
          }
          const std::size_t cell = index({ball.corner.x + column, ball.corner.y + row});
          if (owners[cell] != kNoBall) {
            return name + " overlaps ball " + std::to_string(owners[cell]);
          }
          if (walls_[cell] != 0) {
            return name + " overlaps a wall";
          }
          owners[cell] = id;
        }
      }
    }
    if (balls != world.count() || asleep != world.asleep()) {
      return "the counts are wrong";
    }
    std::string found;
    for_cells([&](Vec2i at) {
      const bool wanted = walls_[index(at)] != 0 || owners[index(at)] != kNoBall;
      if (found.empty() && world.field().test(at) != wanted) {
        found = "cell " + std::to_string(at.x) + "," + std::to_string(at.y) +
                (wanted ? " is lost" : " is left behind");
      }
    });
    if (found.empty()) {
      found = floater(owners);
    }
    return found;
  }

  std::size_t index(Vec2i at) const {
    return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(world.config().width) +
           static_cast<std::size_t>(at.x);
  }

 private:
  std::vector<std::uint32_t> covered() const {
    std::vector<std::uint32_t> owners(walls_.size(), kNoBall);
    for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
      Particle ball;
      if (world.particle(id, &ball)) {
        for (int row = 0; row < ball.diameter; ++row) {
          for (int column = 0; column < ball.diameter; ++column) {
            if (in_disc(ball.diameter, column, row)) {
              owners[index({ball.corner.x + column, ball.corner.y + row})] = id;
            }
          }
        }
      }
    }
    return owners;
  }
  // A sleeper that gravity could move by a cell along the axis on which it pulls most.
  std::string floater(const std::vector<std::uint32_t>& owners) const {
    const ParticleConfig& config = world.config();
    const Vec2i pull = config.gravity_q16;
    for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
      Particle ball;
      if (!world.particle(id, &ball) || !ball.asleep) {
        continue;
      }
      if (ball.vx_q16 != 0 || ball.vy_q16 != 0) {
        return "sleeper " + std::to_string(id) + " has a speed";
      }
      bool held = pull == Vec2i{};
      for (int axis = 0; axis < 2; ++axis) {
        if (pull[axis] == 0 || std::abs(pull[axis]) < std::abs(pull[1 - axis])) {
          continue;
        }
        for (int row = 0; row < ball.diameter && !held; ++row) {
          for (int column = 0; column < ball.diameter && !held; ++column) {
            if (!in_disc(ball.diameter, column, row)) {
              continue;
            }
            Vec2i at{ball.corner.x + column, ball.corner.y + row};
            at[axis] += pull[axis] > 0 ? 1 : -1;
            held = at.x < 0 || at.y < 0 || at.x >= config.width || at.y >= config.height ||
                   walls_[index(at)] != 0 || (owners[index(at)] != kNoBall && owners[index(at)] != id);
          }
        }
      }
      if (!held || !world.is_held(id)) {
        return "sleeper " + std::to_string(id) + " hangs in the air";
      }
    }
    return {};
  }
  template <class Function>
  void for_cells(Function function) const {
    for (std::int32_t y = 0; y < world.config().height; ++y) {
      for (std::int32_t x = 0; x < world.config().width; ++x) {
        function(Vec2i{x, y});
      }
    }
  }

  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> walls_;
};

}  // namespace thimble::tools
