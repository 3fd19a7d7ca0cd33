// The application `particles` on simulated boards: its states are those of the core, run directly, and
// golden.
#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/particles_world.h"
#include "boards/board_table.h"
#include "golden/particles_table.h"
#include "port.h"
#include "support/simulated_run.h"

namespace {

using namespace thimble;

using tests::Hand;
using Run = tests::SimulatedRun;

Run run_app(const char* board, std::uint32_t frames, const Hand& hand = {}) {
  const platform::BoardFacts facts = platform::board_for(*platform::find_board(board), "particles");
  return tests::run_simulated({&facts, true, {}, apps::particles}, frames, hand);
}

/// Every `steps N crc X` in order.
std::vector<std::pair<std::uint32_t, std::uint32_t>> states_of(const std::string& out) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> states;
  for (std::size_t at = out.find("steps "); at != std::string::npos; at = out.find("steps ", at + 1)) {
    unsigned steps = 0;
    unsigned crc = 0;
    if (std::sscanf(out.c_str() + at, "steps %u crc %8x\n", &steps, &crc) == 2) {
      states.emplace_back(steps, crc);
    }
  }
  return states;
}

/// A world of the application's, stepped here.
struct Direct {
  explicit Direct(const golden::ParticlesState& state)
      : config(apps::particles_config(state.width, state.height, std::size_t{1} << 20)) {
    config.capacity = state.count;
    bytes.resize(particles_bytes(config));
    REQUIRE(apps::begin_particles({bytes.data(), bytes.size()}, config, &world) == Status::kOk);
    CHECK(world.count() == state.count);
  }
  std::uint32_t crc_after(std::uint32_t steps) {
    while (world.steps() < steps) {
      world.step();
    }
    return world.state_crc32();
  }
  ParticleConfig config;
  std::vector<std::uint8_t> bytes;
  ParticleWorld world;
};

}  // namespace

TEST_CASE("particles app: golden states -> those of the core, run directly") {
  for (const golden::ParticlesState& state : golden::kParticlesStates) {
    Direct direct(state);
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "{%d, %d, %u, 0x%08X}", state.width, state.height,
                  static_cast<unsigned>(state.count),
                  static_cast<unsigned>(direct.crc_after(apps::kToldSteps)));
    const std::string found(text.data());
    CAPTURE(found);
    CHECK(direct.world.state_crc32() == state.crc32);
  }
}

TEST_CASE("particles app: every board -> its golden state first, then the steps shown, status 0") {
  constexpr std::array<std::pair<const char*, std::size_t>, 11> kBoards{{{"lm3s6965evb", 0},
                                                                         {"microbit", 0},
                                                                         {"netduinoplus2", 0},
                                                                         {"sifive_e", 0},
                                                                         {"stm32vldiscovery", 1},
                                                                         {"mps2-an500", 2},
                                                                         {"raspi0", 3},
                                                                         {"pico", 4},
                                                                         {"pico-lcd-2", 2},
                                                                         {"pico-oled", 0},
                                                                         {"gba", 5}}};
  for (const auto& [each_board, index] : kBoards) {
    const auto& board = each_board;
    CAPTURE(std::string(board));
    const golden::ParticlesState& state = golden::kParticlesStates[index];
    const Run run = run_app(board, 3);
    CHECK(run.status == 0);
    CHECK(run.fault == "");
    CHECK(run.out.find("particles " + std::to_string(state.count) + " in " + std::to_string(state.width) +
                       " x " + std::to_string(state.height)) == 0);
    const auto states = states_of(run.out);
    REQUIRE(states.size() == 2);
    CHECK(states[0] == std::pair(apps::kToldSteps, state.crc32));
    CHECK(states[1] == std::pair(std::uint32_t{3}, Direct(state).crc_after(3)));
  }
}

TEST_CASE(
    "particles app: played for 810 frames -> the same states as the core at every 400th step and the end") {
  const Run run = run_app("lm3s6965evb", 810);
  const auto states = states_of(run.out);
  REQUIRE(states.size() == 4);
  Direct direct(golden::kParticlesStates[0]);
  for (std::size_t i = 1; i < states.size(); ++i) {
    CHECK(states[i].first == (i == 3 ? 810 : 400 * i));
    CHECK(states[i].second == direct.crc_after(states[i].first));
  }
}

TEST_CASE("particles app: the picture -> lit where the field is set, brighter awake than asleep") {
  const Run run = run_app("lm3s6965evb", 810);
  REQUIRE(run.pictures.size() == 810);
  for (const std::uint32_t frame : {1U, 100U, 810U}) {
    Direct direct(golden::kParticlesStates[0]);
    direct.crc_after(frame);
    const std::vector<std::uint8_t> grays = tests::pixels_of(run.pictures[frame - 1], PixelFormat::kGray8);
    for (std::int32_t y = 0; y < 64; ++y) {
      for (std::int32_t x = 0; x < 128; ++x) {
        const std::uint8_t gray = grays[static_cast<std::size_t>(y * 128 + x)];
        REQUIRE((gray != 0) == direct.world.field().test({x, y}));
        const std::uint32_t id = direct.world.ball_at({x, y});
        Particle ball;
        if (direct.world.particle(id, &ball)) {
          REQUIRE((gray < 150) == ball.asleep);
        }
      }
    }
  }
}

TEST_CASE("particles app: buttons and keys -> gravity turns, a blast, a new beginning, the end") {
  // Gravity to the left from frame 200 on.
  Direct direct(golden::kParticlesStates[0]);
  direct.crc_after(200);
  REQUIRE(direct.world.set_gravity({-6554, 0}) == Status::kOk);
  const std::uint32_t left = direct.crc_after(300);
  for (const Hand& hand : {Hand{{}, {{200, port::kLeft}, {210, 0}}}, Hand{{{200, "a"}}, {}}}) {
    const auto states = states_of(run_app("lm3s6965evb", 300, hand).out);
    REQUIRE(states.size() == 2);
    CHECK(states[1] == std::pair(std::uint32_t{300}, left));
  }
  Hand diagonal;
  diagonal.buttons[10] = port::kRight | port::kUp;
  CHECK(states_of(run_app("lm3s6965evb", 300, diagonal).out)[1].second != left);
  Hand blast;
  blast.buttons[250] = port::kSelect;
  blast.buttons[260] = 0;
  const auto blown = states_of(run_app("lm3s6965evb", 300, blast).out);
  Direct undisturbed(golden::kParticlesStates[0]);
  CHECK(blown[1].second != undisturbed.crc_after(300));

  Hand again;
  again.keys[150] = "r";
  Direct fresh(golden::kParticlesStates[0]);
  CHECK(states_of(run_app("lm3s6965evb", 200, again).out)[1] ==
        std::pair(std::uint32_t{50}, fresh.crc_after(50)));
  Hand ends;
  ends.keys[20] = "cq";
  const Run ended = run_app("microbit", 1000, ends);
  CHECK(ended.status == 0);
  const auto states = states_of(ended.out);
  REQUIRE(states.size() == 3);
  CHECK(states[1] == states[2]);
  CHECK(states[2].first == 20);
}
