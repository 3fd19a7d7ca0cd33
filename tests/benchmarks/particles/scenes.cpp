// The scenes, and what is measured of any engine.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>

#include "engine.h"
#include "thimble/plane/bitfield.h"

namespace thimble::benchmarks {
namespace {

// From the bits of the generator alone, so that every library makes the same scene.
double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

// Adds `count` balls at free places of `box`.
void scatter(Scene& scene, const CellBox& box, int count, int least, int most, std::mt19937& random) {
  std::vector<std::uint32_t> words(bitfield_bytes(scene.width, scene.height) / 4);
  BitField field;
  if (BitField::make(scene.width, scene.height,
                     {reinterpret_cast<std::uint8_t*>(words.data()), words.size() * 4},
                     &field) != Status::kOk) {
    throw std::runtime_error("the scene is too large for a bit field");
  }
  while (static_cast<int>(scene.balls.size()) < count) {
    const int diameter = static_cast<int>(uniform(random, least, most + 1));
    const DiscStamp disc = disc_stamp(diameter);
    // Twice the cell in which the disc's centre lies when it lies as it does, so nothing is rounded.
    const Vec2i corner{static_cast<int>(uniform(random, box.low.x, box.high.x - diameter + 1)),
                       static_cast<int>(uniform(random, box.low.y, box.high.y - diameter + 1))};
    // Circles with a pixel between them: those that overlap would gain energy where overlap is pushed out.
    if (field.any(disc_stamp(diameter + 2), {corner.x - 1, corner.y - 1})) {
      continue;
    }
    field.set(disc, corner);
    scene.balls.push_back({corner.x + diameter / 2.0, corner.y + diameter / 2.0, uniform(random, -3, 3),
                           uniform(random, -3, 3), static_cast<double>(diameter), false});
  }
}

// Pairs of balls whose squares come near each other, each once, by cells of 16 pixels.
template <class Visit>
void for_each_near_pair(const std::vector<BallState>& balls, Visit visit) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    cells[{static_cast<int>(std::floor(balls[i].x / 16)), static_cast<int>(std::floor(balls[i].y / 16))}]
        .push_back(i);
  }
  for (const auto& [place, members] : cells) {
    for (int dy = 0; dy <= 1; ++dy) {
      for (int dx = dy == 0 ? 0 : -1; dx <= 1; ++dx) {
        const auto other = cells.find({place.first + dx, place.second + dy});
        if (other == cells.end()) {
          continue;
        }
        for (const std::size_t i : members) {
          for (const std::size_t j : other->second) {
            if (&members != &other->second || i < j) {
              visit(i, j);
            }
          }
        }
      }
    }
  }
}

double distance(const BallState& a, const BallState& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

std::vector<std::string> engine_names() {
  return {"bit field", "uniform grid",
#ifdef THIMBLE_HAVE_BOX2D
          "Box2D 2.4"
#endif
  };
}

std::unique_ptr<Engine> make_engine(const std::string& name, const Scene& scene) {
  if (name == "bit field") {
    return make_bit_field_engine(scene);
  }
  if (name == "uniform grid") {
    return make_grid_engine(scene);
  }
#ifdef THIMBLE_HAVE_BOX2D
  if (name == "Box2D 2.4") {
    return make_box2d_engine(scene, false);
  }
  if (name == "Box2D 2.4, bullets") {
    return make_box2d_engine(scene, true);
  }
#endif
  throw std::invalid_argument("no engine of the name " + name);
}

Scene make_scene(const std::string& name, int balls, std::uint32_t seed) {
  Scene scene;
  scene.name = name;
  const double scale = std::sqrt(balls / 693.0);
  scene.width = std::max(32, static_cast<int>(std::lround(800 * scale)));
  scene.height = std::max(24, static_cast<int>(std::lround(600 * scale)));
  if (name == "falling") {
    scene.gravity = 0.1;
    scene.restitution = 0.8;
  } else if (name != "gas") {
    throw std::invalid_argument("no scene of the name " + name);
  }
  std::mt19937 random(seed);
  scatter(scene, {{0, 0}, {scene.width, scene.height}}, balls, 2, 12, random);
  return scene;
}

Scene make_wall_scene(double speed) {
  Scene scene;
  scene.name = "wall";
  scene.width = 800;
  scene.height = 600;
  scene.wall_columns = {400};
  std::mt19937 random(1);
  scatter(scene, {{20, 20}, {380, 580}}, 40, 4, 12, random);
  for (BallState& ball : scene.balls) {
    ball.vx = speed;
    ball.vy = 0;
  }
  return scene;
}

double kinetic_energy(const std::vector<BallState>& balls) {
  double sum = 0;
  for (const BallState& ball : balls) {
    sum += ball.diameter * ball.diameter * (ball.vx * ball.vx + ball.vy * ball.vy);
  }
  return sum;
}

double greatest_overlap(const Scene& scene, const std::vector<BallState>& balls) {
  double greatest = 0;
  for_each_near_pair(balls, [&](std::size_t i, std::size_t j) {
    greatest = std::max(greatest, (balls[i].diameter + balls[j].diameter) / 2 - distance(balls[i], balls[j]));
  });
  for (const BallState& ball : balls) {
    const double radius = ball.diameter / 2;
    greatest = std::max({greatest, radius - ball.x, radius - ball.y, ball.x + radius - scene.width,
                         ball.y + radius - scene.height});
  }
  return greatest;
}

std::size_t floating_sleepers(const Scene& scene, const std::vector<BallState>& balls, double slack) {
  std::vector<bool> supported(balls.size(), false);
  for_each_near_pair(balls, [&](std::size_t i, std::size_t j) {
    if (distance(balls[i], balls[j]) <= (balls[i].diameter + balls[j].diameter) / 2 + slack) {
      supported[balls[i].y < balls[j].y ? i : j] = true;
    }
  });
  std::size_t floating = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const bool on_floor = balls[i].y + balls[i].diameter / 2 + slack >= scene.height;
    floating += balls[i].asleep && !supported[i] && !on_floor ? 1U : 0U;
  }
  return floating;
}

std::size_t kinks(const Scene& scene, const std::vector<BallState>& before,
                  const std::vector<BallState>& after, double threshold) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double change = std::hypot(after[i].vx - before[i].vx, after[i].vy - before[i].vy - scene.gravity);
    count += change > threshold ? 1U : 0U;
  }
  return count;
}

}  // namespace thimble::benchmarks
