#include "particles/world_files.h"

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "output/units.h"

namespace thimble::tools {

std::string state_csv(const ParticleWorld& world) {
  std::string text(kStateColumns);
  text += '\n';
  for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
    Particle ball;
    if (!world.particle(id, &ball)) {
      continue;
    }
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "%u,%d,%d,%d,%d,%d,%d\n", static_cast<unsigned>(id), ball.x_q16,
                  ball.y_q16, ball.vx_q16, ball.vy_q16, ball.radius_q16, ball.asleep ? 1 : 0);
    text += line.data();
  }
  return text;
}

std::string particle_stats(const PopulatedWorld& populated, const PlayedCounts& counts, double step_seconds) {
  const ParticleWorld& world = populated.world();
  nlohmann::ordered_json json;
  json["width"] = world.config().width;
  json["height"] = world.config().height;
  json["seed"] = populated.options().seed;
  json["steps"] = counts.steps;
  json["particles"] = world.count();
  json["asleep"] = world.asleep();
  json["collisions"] = counts.ball_hits + counts.wall_hits;
  json["ball_hits"] = counts.ball_hits;
  json["wall_hits"] = counts.wall_hits;
  json["moves"] = counts.moves;
  json["mask_tests"] = counts.mask_tests;
  json["woken"] = counts.woken;
  json["bytes"] = world.used_bytes();
  json["field_bytes"] = world.field().used_bytes();
  json["capacity"] = world.config().capacity;
  json["step_seconds"] = step_seconds;
  json["state_crc32"] = crc_text(world.state_crc32());
  return json.dump(2) + "\n";
}

std::string particle_summary(const PopulatedWorld& populated, const PlayedCounts& counts,
                             double step_seconds) {
  const ParticleWorld& world = populated.world();
  std::string time;
  if (counts.steps != 0) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), ", %.2f us a step",
                  1e6 * step_seconds / static_cast<double>(counts.steps));
    time = text.data();
  }
  return grouped(world.count()) + (world.count() == 1 ? " ball, " : " balls, ") + grouped(counts.steps) +
         (counts.steps == 1 ? " step" : " steps") + time + "; asleep " + grouped(world.asleep()) +
         ", collisions " + grouped(counts.ball_hits + counts.wall_hits) + "; " + grouped(world.used_bytes()) +
         " bytes; state " + crc_text(world.state_crc32()) + "\n";
}

}  // namespace thimble::tools
