#include "support/pty.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <stdexcept>

namespace thimble::tests {
namespace {

winsize size_of(int columns, int rows) {
  winsize size{};
  size.ws_col = static_cast<unsigned short>(columns);
  size.ws_row = static_cast<unsigned short>(rows);
  return size;
}

using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Pty::Pty(int columns, int rows, const std::function<int()>& child) {
  const winsize size = size_of(columns, rows);
  std::array<char, 256> name{};
  child_ = ::forkpty(&master_, name.data(), nullptr, &size);
  if (child_ < 0) {
    throw std::runtime_error("no terminal");
  }
  if (child_ == 0) {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::setenv("TERM", "xterm-256color", 1);
    ::_exit(child());
  }
  slave_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
}

Pty::~Pty() {
  if (!ended_) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, &status_, 0);
  }
  ::close(slave_);
  ::close(master_);
}

void Pty::read_some(int timeout_ms) {
  pollfd source{master_, POLLIN, 0};
  if (::poll(&source, 1, timeout_ms) > 0) {
    std::array<char, 65536> bytes{};
    const ssize_t count = ::read(master_, bytes.data(), bytes.size());
    if (count > 0) {
      output_.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }
}

bool Pty::wait_for(std::string_view text, double seconds) {
  const Clock::time_point end = after(seconds);
  while (true) {
    const std::size_t at = output_.find(text, seen_);
    if (at != std::string::npos) {
      seen_ = at + text.size();
      return true;
    }
    if (Clock::now() >= end) {
      return false;
    }
    read_some(20);
  }
}

bool Pty::wait_for_end(double seconds) {
  const Clock::time_point end = after(seconds);
  while (!ended_ && Clock::now() < end) {
    read_some(20);
    ended_ = ::waitpid(child_, &status_, WNOHANG) == child_;
  }
  // What it said last.
  for (std::size_t before = output_.size() + 1; before != output_.size();) {
    before = output_.size();
    read_some(20);
  }
  return ended_;
}

void Pty::type(std::string_view bytes) const {
  if (::write(master_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the terminal takes no bytes");
  }
}

void Pty::resize(int columns, int rows) const {
  const winsize size = size_of(columns, rows);
  ::ioctl(master_, TIOCSWINSZ, &size);
}

void Pty::send_signal(int number) const {
  ::kill(child_, number);
}

termios Pty::modes() const {
  termios modes{};
  if (::tcgetattr(slave_, &modes) != 0) {
    throw std::runtime_error("the terminal's modes cannot be read");
  }
  return modes;
}

bool Pty::exited() const {
  return ended_ && WIFEXITED(status_);
}
int Pty::exit_status() const {
  return exited() ? WEXITSTATUS(status_) : -1;
}
int Pty::end_signal() const {
  return ended_ && WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
}

}  // namespace thimble::tests
