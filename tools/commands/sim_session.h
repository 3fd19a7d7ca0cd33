/// One run of an application on a simulated board, with somebody watching or nobody.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/app_table.h"
#include "boards/board_table.h"
#include "commands/key_script.h"
#include "host/look.h"
#include "host/screen.h"
#include "host/simulation.h"
#include "output/image.h"
#include "output/output_file.h"

namespace thimble::tools {

struct SessionOptions {
  const platform::BoardFacts* board = nullptr;
  const apps::Application* application = nullptr;
  ConstBytes scene;  ///< in flash
  host::ScreenKind display = host::ScreenKind::kAuto;
  std::optional<host::Theme> theme;  ///< nothing: the board's own
  std::int32_t scale = 0;
  std::uint32_t frames = 0;    ///< 0: as long as it lasts
  int frames_a_second = 30;    ///< of the screen and of the recording
  std::uint32_t hold_fps = 0;  ///< the rate that the application holds (port::Facts)
  KeyScript keys;
  OutputFile* recording = nullptr;
  host::FramePainter* painter = nullptr;  ///< what draws in the core's place; may be null
};

struct SessionResult {
  int status = 0;
  std::string fault;         ///< a sentence where the application was stopped
  std::string screen_fault;  ///< a sentence where the screen that somebody watched has gone
  std::uint32_t pictures = 0;
  std::uint64_t rows_sent = 0;  ///< to the display
  std::uint64_t rows_kept = 0;  ///< left there, unchanged
  Image picture;                ///< the last one, in the display's format
  host::MemoryUse use;
  double mean_frame_seconds = 0;  ///< of the application on this machine
};

/// Runs until the application ends. UART: standard input and output, and with a screen also what is typed
/// there; a terminal that is the screen shows the last line, and the rest when it is given back. Throws
/// host::ScreenError, host::SimulationError and OutputError.
SessionResult run_session(const SessionOptions& options);

/// "RAM 12,288 of 61,440 bytes (20%)" and the like, one a line.
std::string memory_text(const host::MemoryUse& use, const char* separator);

}  // namespace thimble::tools
