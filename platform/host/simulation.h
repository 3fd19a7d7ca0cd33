/// A board on the host: one application, run with the RAM, flash and display of that board.
///
/// What is as on the board: the arena has exactly the bytes that the RAM leaves beside the stack, and a byte
/// behind them faults; the scene is read-only; the display is a strict one (strict_display.h); buttons and
/// UART come through port.h. What is not: instructions are the host's and are not counted, and so are the
/// frames on the stack. The stack is therefore larger than the board's; how much of it was used is measured
/// by its paint, as on the board, but says nothing exact about the chip.
///
/// Frames may be drawn by something faster than the core (FramePainter), beside the board's memory and on the
/// other thread. The first one is drawn by the core as well, so that the stack is the core's (drawn_frame.h);
/// if the two differ in a bit, that stops the application.
///
/// The application has a thread and a stack of its own, on which nothing else runs. It waits whenever it asks
/// `running()`, until it is answered; then the thread that made the simulation may look at everything. There
/// is one simulation at a time, since it takes the signals of a fault.
///
///     host::Simulation simulation({.board = board, .application = apps::demo});
///     while (simulation.wait(10) != host::Moment::kEnded) {
///       if (simulation.asks()) { show(simulation.display().picture()); simulation.answer(true); }
///     }
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "boards/board_table.h"
#include "host/strict_display.h"
#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::host {

/// A simulation that cannot be: `what()` says why.
class SimulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What draws frames in the core's place: an application asks for them by port::draw.
class FramePainter {
 public:
  virtual ~FramePainter() = default;
  /// Draws the whole picture into `pixels`, row after row without gaps, with the bytes of `render_band`;
  /// false where the core is to draw this frame. Called by Simulation::wait, which lets pass what it throws;
  /// the application then waits for ever. Tree and palette lie in flash and stay what they are.
  virtual bool draw(const CompactTree& tree, const Camera& camera, const Shading& shading, PixelFormat format,
                    Bytes pixels) = 0;
};

struct SimulationOptions {
  const platform::BoardFacts* board = nullptr;
  /// What the application sees of the display (port::Display::connected).
  bool connected = true;
  /// The baked scene in flash; copied.
  ConstBytes scene;
  int (*application)() = nullptr;
  /// port::Facts::hold_fps.
  std::uint32_t hold_fps = 0;
  /// May be null: the core draws everything. It lives as long as the simulation is used.
  FramePainter* painter = nullptr;
};

enum class Moment : std::uint8_t {
  kNothing,  ///< the time is over, or there is UART output
  kAsks,     ///< the application waits in running()
  kEnded,    ///< it has returned, or was stopped by a fault
};

/// Bytes used so far, and those that there are.
struct MemoryUse {
  std::uint32_t ram_bytes = 0;  ///< of the arena, up to the last byte that was ever changed
  std::uint32_t ram_limit_bytes = 0;
  std::uint32_t flash_bytes = 0;  ///< the scene; code is not counted here
  std::uint32_t flash_limit_bytes = 0;
  std::uint32_t stack_bytes = 0;  ///< in this host's frames
  std::uint32_t stack_limit_bytes = 0;
};

class Simulation {
 public:
  /// Starts the application. Throws SimulationError (a scene larger than the flash, a board whose RAM is all
  /// stack).
  explicit Simulation(const SimulationOptions& options);
  /// An application that has not ended is left where it is, with its memory, until the process ends.
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Waits at most `timeout_ms`, and at once returns kAsks or kEnded while that is so.
  Moment wait(int timeout_ms);
  /// Answers a running(); the application resumes. Only after kAsks.
  void answer(bool go_on);

  // While it asks or has ended:
  /// What it gave to running(): frames drawn.
  std::uint32_t frames_asked() const;
  /// Whether it has read all that was typed.
  bool has_read_all() const;
  /// The pictures that it has flushed.
  const StrictDisplay& display() const;
  /// Looks at every byte that was never used: some tenths of a millisecond.
  MemoryUse use() const;
  /// Seconds from the last answer to this question: the frame's time on this host.
  double frame_seconds() const;
  /// After kEnded: what it returned, or port::kFaultStatus, and then what happened, as a sentence.
  int status() const;
  const std::string& fault() const;

  // At any time:
  void set_buttons(std::uint32_t buttons);
  /// A byte over the UART; false, and nothing done, while the application has left 4,096 of them unread.
  bool type(std::uint8_t byte);
  /// What came over the UART since the last call.
  std::string take_output();

  struct State;  ///< shared with port.cpp

 private:
  std::unique_ptr<State> state_;
};

}  // namespace thimble::host
