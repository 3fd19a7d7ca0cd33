/// An application on a simulated board from its start to its end, under a hand that is written down.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "host/simulation.h"
#include "output/image.h"

namespace thimble::tests {

/// A board's facts; without them the test ends.
inline const platform::BoardFacts& board_of(const char* name) {
  const platform::BoardFacts* board = platform::find_board(name);
  REQUIRE(board != nullptr);
  return *board;
}
/// The board that most cases are of.
inline const platform::BoardFacts& flagship() {
  return board_of("lm3s6965evb");
}

/// r, g, b of every pixel, or what it is in another format.
inline auto pixels_of(const host::PackedPicture& of, PixelFormat format = PixelFormat::kRgb888) {
  return tools::converted({of.width_px, of.height_px, of.format, of.bytes}, format).pixels;
}

struct Hand {
  std::map<std::uint32_t, std::string> keys;       ///< by the frame before which they come over the UART
  std::map<std::uint32_t, std::uint32_t> buttons;  ///< from that frame on
};

struct SimulatedRun {
  int status = -1;
  std::string out;
  std::string fault;
  std::vector<host::PackedPicture> pictures;  ///< after each frame
  host::PackedPicture last;                   ///< what the display shows in the end
  std::uint64_t rows_sent = 0;
  std::uint64_t rows_kept = 0;
  host::MemoryUse use;
};

/// Lets it draw that many frames, unless it ends by itself. What a painter throws comes through.
inline SimulatedRun run_simulated(const host::SimulationOptions& options, std::uint32_t frames,
                                  const Hand& hand = {}) {
  SimulatedRun run;
  host::Simulation simulation(options);
  for (host::Moment moment = host::Moment::kNothing; moment != host::Moment::kEnded;) {
    moment = simulation.wait(60000);
    run.out += simulation.take_output();
    if (moment != host::Moment::kAsks) {
      continue;
    }
    const std::uint32_t asked = simulation.frames_asked();
    if (asked != 0) {
      run.pictures.push_back(simulation.display().picture());
    }
    if (const auto typed = hand.keys.find(asked); typed != hand.keys.end()) {
      for (const char key : typed->second) {
        simulation.type(static_cast<std::uint8_t>(key));
      }
    }
    if (const auto held = hand.buttons.find(asked); held != hand.buttons.end()) {
      simulation.set_buttons(held->second);
    }
    simulation.answer(asked < frames);
  }
  run.status = simulation.status();
  run.fault = simulation.fault();
  run.last = simulation.display().picture();
  run.rows_sent = simulation.display().rows_sent();
  run.rows_kept = simulation.display().rows_kept();
  run.use = simulation.use();
  return run;
}

}  // namespace thimble::tests
