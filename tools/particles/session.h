/// One run of `thimble particles`: a world, somebody watching or nobody, events from a script and from a
/// hand.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/screen.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "particles/player.h"

namespace thimble::tools {

struct PlayOptions {
  host::ScreenKind view = host::ScreenKind::kAuto;
  std::optional<std::uint64_t> steps;  ///< none: as long as it lasts; where nobody watches, kUnseenSteps
  std::int32_t rate = 60;              ///< steps a second that a watcher sees
  int frames_a_second = 0;             ///< of screen and recording; 0: 60 in a window, else 30
  bool figures_in_files = false;
  bool quiet = false;
  std::vector<InputEvent> script;
  OutputFile* recording = nullptr;        ///< moving pictures
  OutputFile* input_recording = nullptr;  ///< events, with an end
};

/// Steps where nobody watches and nobody said how many; a longer script is played to its end.
inline constexpr std::uint64_t kUnseenSteps = 2000;

struct PlayResult {
  PlayedCounts counts;
  double step_seconds = 0;
  std::string figures;       ///< Player::figures at the end
  std::string screen_fault;  ///< a sentence where the screen that somebody watched has gone
};

/// Plays until the end. Throws host::ScreenError and OutputError.
PlayResult play(PopulatedWorld* world, const PlayOptions& options);

}  // namespace thimble::tools
