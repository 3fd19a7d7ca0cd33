// The particle world beside a uniform grid and Box2D 2.4: cost, agreement, quality, energy, as tables.
//
//   thimble_particle_table                     all tables, some minutes
//   thimble_particle_table speed quality       some of: speed quality energy
//
// Times are processor time of the stepping alone. Engines that stand in one table are run by turns, a few
// steps each, so that the load of the machine falls on all.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/measure.h"
#include "benchmarks/particles/engine.h"

namespace thimble::benchmarks {
namespace {

double seconds_of_steps(Engine& engine, int steps) {
  const auto work = [&] {
    for (int i = 0; i < steps; ++i) {
      engine.step();
    }
  };
  return seconds_of(work, kProgramClock);
}

std::string number(double value, int digits = 3) {
  std::ostringstream text;
  if (std::abs(value) >= 1000) {
    text << static_cast<long long>(std::llround(value));
  } else {
    text.precision(digits);
    text << value;
  }
  return text.str();
}

// Rows of text under a heading, printed aligned.
class Table {
 public:
  Table(const std::string& title, std::vector<std::string> columns) : rows_{std::move(columns)} {
    std::cout << '\n' << title << "\n\n";
  }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  void print() const {
    std::vector<std::size_t> widths(rows_.front().size(), 0);
    for (const auto& row : rows_) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        widths[i] = std::max(widths[i], row[i].size());
      }
    }
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      for (std::size_t i = 0; i < rows_[r].size(); ++i) {
        std::cout << (i == 0 ? "| " : " | ") << rows_[r][i]
                  << std::string(widths[i] - rows_[r][i].size(), ' ');
      }
      std::cout << " |\n";
      if (r == 0) {
        for (const std::size_t width : widths) {
          std::cout << "|" << std::string(width + 2, '-');
        }
        std::cout << "|\n";
      }
    }
    std::cout.flush();
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

// --- Speed

struct Timed {
  std::string name;
  std::unique_ptr<Engine> engine;
  double seconds = 0;
};

// The same scene in all engines, `steps` steps in turns of `turn`.
std::vector<Timed> race(const Scene& scene, const std::vector<std::string>& names, int steps, int turn) {
  std::vector<Timed> engines;
  for (const std::string& name : names) {
    engines.push_back({name, make_engine(name, scene)});
  }
  for (int done = 0; done < steps; done += turn) {
    for (Timed& timed : engines) {
      timed.seconds += seconds_of_steps(*timed.engine, turn);
    }
  }
  return engines;
}

// Collisions by the balls' velocities alone.
std::uint64_t count_kinks(const Scene& scene, Engine& engine, int steps) {
  std::uint64_t count = 0;
  auto before = engine.balls();
  for (int i = 0; i < steps; ++i) {
    engine.step();
    auto after = engine.balls();
    count += kinks(scene, before, after);
    before = std::move(after);
  }
  return count;
}

void speed() {
  Table table(
      "Step time side by side (the same balls, by turns). Collisions: as the engine counts them, and as "
      "changes of "
      "balls' velocities; the last row of each scene is round balls in double precision with 64 substeps",
      {"scene", "balls", "steps", "engine", "us a step", "ns a ball and step", "time against bit field",
       "collisions", "against reference", "velocity changes", "against reference"});
  for (const std::string name : {"gas", "falling"}) {
    for (const int balls : {693, 10000}) {
      const Scene scene = make_scene(name, balls);
      const int steps = 60;
      auto names = engine_names();
      if (names.size() == 3) {
        names.push_back("Box2D 2.4, bullets");
      }
      const auto engines = race(scene, names, steps, 4);
      const auto reference = make_reference_engine(scene, 64);
      const double true_changes = static_cast<double>(count_kinks(scene, *reference, steps));
      const double true_collisions = static_cast<double>(reference->collisions());
      for (const Timed& timed : engines) {
        const double changes =
            static_cast<double>(count_kinks(scene, *make_engine(timed.name, scene), steps));
        const double collisions = static_cast<double>(timed.engine->collisions());
        table.add({name, std::to_string(balls), std::to_string(steps), timed.name,
                   number(1e6 * timed.seconds / steps), number(1e9 * timed.seconds / steps / balls),
                   number(timed.seconds / engines.front().seconds), number(collisions),
                   number(collisions / true_collisions), number(changes), number(changes / true_changes)});
      }
      table.add({name, std::to_string(balls), std::to_string(steps), "reference", "", "", "",
                 number(true_collisions), "1", number(true_changes), "1"});
    }
  }
  table.print();
}

// --- Quality

// Balls that were on the other side of the wall, or outside the box, after any of 60 steps.
std::size_t through_the_wall(const std::string& engine, double speed) {
  const Scene scene = make_wall_scene(speed);
  const auto world = make_engine(engine, scene);
  std::vector<bool> through(scene.balls.size(), false);
  for (int i = 0; i < 60; ++i) {
    world->step();
    const auto balls = world->balls();
    for (std::size_t ball = 0; ball < balls.size(); ++ball) {
      const BallState& b = balls[ball];
      const bool inside = b.x > 0 && b.x < 401 && b.y > 0 && b.y < scene.height;
      through[ball] = through[ball] || !inside;
    }
  }
  return static_cast<std::size_t>(std::count(through.begin(), through.end(), true));
}

void quality() {
  Table table(
      "Quality. Gas: 693 balls, restitution 1, 10,000 steps. Wall: one pixel, 40 balls. Heap: 693 and 10,000 "
      "balls fall (gravity 0.1, restitution 0.8)",
      {"engine", "balls", "gas energy end / start", "greatest overlap px",
       "through wall at 50, 500, 5000 px a step", "heap: steps until asleep", "asleep", "floating",
       "overlap in heap px", "heap us a step", "bytes"});
  for (const std::string& name : engine_names()) {
    const Scene gas = make_scene("gas", 693);
    const auto world = make_engine(name, gas);
    const double start = kinetic_energy(world->balls());
    double overlap = 0;
    for (int i = 0; i < 10000; ++i) {
      world->step();
      if (i % 100 == 0) {
        overlap = std::max(overlap, greatest_overlap(gas, world->balls()));
      }
    }
    const double energy = kinetic_energy(world->balls()) / start;
    std::string through;
    for (const double pace : {50.0, 500.0, 5000.0}) {
      through += (through.empty() ? "" : " ") + std::to_string(through_the_wall(name, pace));
    }
    for (const int balls : {693, 10000}) {
      if (balls > 693 && name != "bit field") {
        continue;  // hours
      }
      const Scene falling = make_scene("falling", balls);
      const auto heap = make_engine(name, falling);
      const std::size_t bytes = heap->memory_bytes();
      const int limit = balls == 693 ? 6000 : 10000;
      int steps = 0;
      while (steps < limit && heap->asleep() < static_cast<std::size_t>(balls)) {
        heap->step();
        ++steps;
      }
      const bool sleeps = heap->asleep() == static_cast<std::size_t>(balls);
      const int rest_steps = sleeps ? 100000 : 300;
      const double us = 1e6 * seconds_of_steps(*heap, rest_steps) / rest_steps;
      const auto state = heap->balls();
      const bool first = balls == 693;
      table.add({name, std::to_string(balls), first ? number(energy, 7) : "", first ? number(overlap) : "",
                 first ? through : "",
                 sleeps ? std::to_string(steps) : "never (" + std::to_string(limit) + ")",
                 std::to_string(heap->asleep()), std::to_string(floating_sleepers(falling, state)),
                 number(greatest_overlap(falling, state)), number(us), std::to_string(bytes)});
    }
  }
  table.print();
}

// --- Energy

// Sum of diameter^2 * (speed^2 + 2 * gravity * height over the floor). Both engines add a step's gravity
// before they move a ball, so what they give is the speed half a step before the time of the place.
double energy_under_gravity(const Scene& scene, std::vector<BallState> balls) {
  double heights = 0;
  for (BallState& ball : balls) {
    ball.vy += scene.gravity / 2;
    heights += ball.diameter * ball.diameter * (scene.height - ball.diameter / 2 - ball.y);
  }
  return kinetic_energy(balls) + 2 * scene.gravity * heights;
}

void energy() {
  constexpr std::array<int, 4> kMarks{0, 1000, 10000, 100000};
  constexpr int kEvery = 10;
  Table table(
      "Energy of speed and height, against the start, after so many steps: 100 balls, gravity 0.1. "
      "Greatest: of every tenth step",
      {"bounciness", "engine", "0", "1000", "10000", "100000", "greatest"});
  for (const double bounciness : {0.5, 0.8, 0.95, 1.0}) {
    Scene scene = make_scene("falling", 100);
    scene.restitution = bounciness;
    for (const std::string& name : engine_names()) {
      if (name == "uniform grid") {
        continue;
      }
      const auto world = make_engine(name, scene);
      const double start = energy_under_gravity(scene, world->balls());
      double greatest = 0;
      std::vector<std::string> row{number(bounciness), name};
      for (int step = 0; step <= kMarks.back(); ++step) {
        if (step > 0) {
          world->step();
        }
        if (step % kEvery == 0) {
          const double now = energy_under_gravity(scene, world->balls()) / start;
          greatest = std::max(greatest, now);
          if (std::find(kMarks.begin(), kMarks.end(), step) != kMarks.end()) {
            row.push_back(number(now, 5));
          }
        }
      }
      row.push_back(number(greatest, 5));
      table.add(row);
    }
  }
  table.print();
}

int main_of(const std::vector<std::string>& arguments) {
  const std::vector<std::string> wanted(arguments.begin() + 1, arguments.end());
  constexpr std::array<std::pair<const char*, void (*)()>, 3> kTables{
      {{"speed", speed}, {"quality", quality}, {"energy", energy}}};
  for (const std::string& name : wanted) {
    if (std::none_of(kTables.begin(), kTables.end(),
                     [&](const auto& table) { return name == table.first; })) {
      std::cerr << "thimble_particle_table: no table " << name << "; there are speed, quality, energy\n";
      return 2;
    }
  }
  for (const auto& [name, table] : kTables) {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) {
      table();
    }
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int argument_count, char** arguments) {
  return thimble::benchmarks::run_program("thimble_particle_table", [&] {
    return thimble::benchmarks::main_of({arguments, arguments + argument_count});
  });
}
