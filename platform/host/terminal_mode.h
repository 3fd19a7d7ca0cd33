/// The terminal's state while a program has the whole of it, and the way back from there, whatever happens.
///
/// While one of these exists the terminal is in raw mode, shows its alternate screen without a cursor, and
/// reports the mouse. It goes back to what it was when the object is destroyed, on `exit`, on SIGINT,
/// SIGTERM, SIGHUP and SIGQUIT, on a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT), and while the program
/// is stopped (SIGTSTP) until it is continued in the foreground. After putting things right each signal takes
/// the course that it would have taken without this. A signal that was ignored stays ignored.
///
/// There is one at a time.
#pragma once

namespace thimble::host {

enum class Wakeup { kTime, kSignal, kInput, kHangUp };

class TerminalMode {
 public:
  /// `descriptor` is a terminal, open for reading and writing, and nobody else's. Throws ScreenError when
  /// this program may not open as many files as it takes.
  explicit TerminalMode(int descriptor);
  ~TerminalMode();
  TerminalMode(const TerminalMode&) = delete;
  TerminalMode& operator=(const TerminalMode&) = delete;

  /// Whether the terminal is ours now: not while the program runs in the background.
  bool is_entered() const;
  /// True once after each time that the window's size changed.
  bool take_resized();
  /// True once after each time that the terminal was entered again: all of it has to be drawn anew.
  bool take_reentered();
  /// Waits for what comes next. What `take_resized` and `take_reentered` have not yet told of ends the wait
  /// too, whenever it came and whichever thread the signal was given to: it is never slept through.
  Wakeup wait(int timeout_ms);
};

/// Puts the terminal back if one is entered. Safe to call from a signal handler.
void restore_terminal();

}  // namespace thimble::host
