// The particle world's invariants.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "thimble/particles.h"

namespace thimble {
namespace {

TEST_CASE("particles: the paper's world -> 693 balls in less than 150,000 bytes") {
  ParticleConfig config;
  CHECK(particles_bytes(config) <= 150000);
  std::vector<std::uint8_t> bytes(particles_bytes(config));
  ParticleWorld world;
  REQUIRE(ParticleWorld::init({bytes.data(), bytes.size()}, config, &world) == Status::kOk);
  for (int i = 0; i < 693; ++i) {
    REQUIRE(world.spawn_random(3 << 16) == Status::kOk);
  }
  CHECK(world.spawn_random(0) == Status::kOutOfMemory);
  for (int i = 0; i < 100; ++i) {
    world.step();
  }
  CHECK(world.steps() == 100);
}

}  // namespace
}  // namespace thimble
