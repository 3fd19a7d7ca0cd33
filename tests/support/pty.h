/// A program on a terminal that the test holds the other end of.
#pragma once

#include <sys/types.h>
#include <termios.h>

#include <functional>
#include <string>
#include <string_view>

namespace thimble::tests {

class Pty {
 public:
  /// Runs `child` in a process of its own whose terminal has `columns` x `rows` cells; it ends with what
  /// `child` returns.
  Pty(int columns, int rows, const std::function<int()>& child);
  /// Kills what still runs.
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  /// Reads until `text` has come since the last call that found something, or `seconds` are over.
  bool wait_for(std::string_view text, double seconds = 10);
  /// Reads until the program has ended; false when that takes too long.
  bool wait_for_end(double seconds = 10);
  void type(std::string_view bytes) const;
  void resize(int columns, int rows) const;
  void send_signal(int number) const;
  /// The terminal's modes now.
  termios modes() const;

  /// All that came so far.
  const std::string& output() const { return output_; }
  bool exited() const;
  int exit_status() const;  ///< -1 when a signal ended it
  int end_signal() const;   ///< 0 for none

 private:
  void read_some(int timeout_ms);

  int master_ = -1;
  int slave_ = -1;  // held open, so that the modes can be read when the program has ended
  pid_t child_ = -1;
  bool ended_ = false;
  int status_ = 0;
  std::string output_;
  std::size_t seen_ = 0;
};

}  // namespace thimble::tests
