/// Which particle world a board shows: the application's and that of the tests that know what it must say.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/plane/particles.h"

namespace thimble::apps {

/// The application tells its state at every multiple of this many steps.
inline constexpr uint32_t kToldSteps = 400;

/// A world of `width` x `height` cells in at most `bytes` bytes: the balls of Figure 1 at its density, or on
/// small displays (up to 32768 pixels) balls of 2 to 6 cells, one for each 51 cells. Where the bytes are too
/// few for all, there are fewer, in steps of 32; a capacity of 0 where there is not room for 32.
constexpr ParticleConfig particles_config(int32_t width, int32_t height, size_t bytes) {
  ParticleConfig config;
  config.width = width;
  config.height = height;
  const int32_t cells = width * height;
  const bool is_small = cells <= 32768;
  if (is_small) {
    config.most_diameter = 6;
  }
  uint32_t count = static_cast<uint32_t>(is_small ? cells / 51 : cells / 693);
  config.capacity = count;
  while (config.capacity > 0 && particles_bytes(config) > bytes) {
    count = count > 32 ? (count - 1) & ~31U : 0;
    config.capacity = count;
  }
  return config;
}

/// Makes the world and fills it with `config.capacity` balls of up to a cell a step; with fewer only where
/// there is no room. `world` is empty after anything but kOk.
inline Status begin_particles(Bytes bytes, const ParticleConfig& config, ParticleWorld* world) {
  const Status status = ParticleWorld::make(config, bytes, world);
  if (status != Status::kOk) {
    return status;
  }
  for (uint32_t i = 0; i < config.capacity; ++i) {
    if (world->spawn_random(65536) != Status::kOk) {
      break;
    }
  }
  return Status::kOk;
}

}  // namespace thimble::apps
