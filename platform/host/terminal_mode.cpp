#include "host/terminal_mode.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <string_view>

#include "host/screen.h"

namespace thimble::host {
namespace {

// Title kept (22), alternate screen (1049), no cursor (25), lines that do not wrap (7), every movement of the
// mouse (1003) as SGR numbers (1006), cleared.
constexpr std::string_view kEnter = "\x1b[22;0t\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[?1003h\x1b[?1006h\x1b[2J";
// The other way round. A signal may come in the middle of a sequence, so CAN breaks off what was begun, and
// the end of a synchronised update (2026) lets the terminal draw.
constexpr std::string_view kLeave =
    "\x18\x1b[?2026l\x1b[?1006l\x1b[?1003l\x1b[?7h\x1b[0m\x1b[?25h\x1b[?1049l\x1b[23;0t";

// The last five are crashes.
constexpr std::array kEnding{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr int kPatienceMs = 200;  // for a terminal that takes no bytes, while a signal is handled

struct {
  int descriptor = -1;
  termios before{};
  termios raw{};
  std::array<struct sigaction, 65> previous{};
  std::atomic<bool> entered{false};
  std::atomic<bool> resized{false};
  std::atomic<bool> reentered{false};
  // Handlers write to it and `wait` polls it, so that a signal between a look at the flags and the wait
  // ends the wait. The same pipe for the whole program: a handler may run late.
  std::array<int, 2> wakeup{-1, -1};
} in_use;
static_assert(std::atomic<bool>::is_always_lock_free);

bool in_foreground(int descriptor) {
  return ::tcgetpgrp(descriptor) == ::getpgrp();
}

// Waits a little for a terminal that is busy, and gives up on one that is stuck.
void send(int descriptor, std::string_view text) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  ::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count > 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    pollfd room{descriptor, POLLOUT, 0};
    if ((errno != EAGAIN && errno != EINTR) || ::poll(&room, 1, kPatienceMs) <= 0) {
      break;
    }
  }
  ::fcntl(descriptor, F_SETFL, flags);
}

void wake() {
  const char byte = 0;
  // A full pipe wakes just as well.
  [[maybe_unused]] const ssize_t count = ::write(in_use.wakeup[1], &byte, 1);
}

void drain() {
  std::array<char, 64> bytes{};
  while (::read(in_use.wakeup[0], bytes.data(), bytes.size()) > 0) {
  }
}

void enter() {
  ::tcsetattr(in_use.descriptor, TCSANOW, &in_use.raw);
  send(in_use.descriptor, kEnter);
  in_use.entered = true;
}

void leave() {
  if (!in_use.entered.exchange(false)) {
    return;
  }
  send(in_use.descriptor, kLeave);
  ::tcflush(in_use.descriptor, TCIFLUSH);  // what the mouse still sent is not for the shell
  ::tcsetattr(in_use.descriptor, TCSANOW, &in_use.before);
}

extern "C" void on_end(int number, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  leave();
  ::sigaction(number, &in_use.previous[static_cast<std::size_t>(number)], nullptr);
  // A fault happens again when this returns; anything else has to be sent again, and comes when it returns.
  if (info->si_code <= 0 || number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGQUIT) {
    ::raise(number);
  }
  errno = error;
}

extern "C" void on_stop(int number) {
  const int error = errno;
  leave();
  struct sigaction mine {};
  struct sigaction plain {};
  plain.sa_handler = SIG_DFL;
  ::sigaction(number, &plain, &mine);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  sigset_t before;
  ::raise(number);
  ::pthread_sigmask(SIG_UNBLOCK, &only, &before);  // stops here
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::sigaction(number, &mine, nullptr);
  errno = error;
}

extern "C" void on_continue(int /*number*/) {
  const int error = errno;
  // In the background the terminal belongs to somebody else; reading from it will stop us until it is ours.
  if (in_foreground(in_use.descriptor)) {
    enter();
    in_use.reentered = true;
    in_use.resized = true;
    wake();
  }
  errno = error;
}

extern "C" void on_resize(int /*number*/) {
  const int error = errno;
  in_use.resized = true;
  wake();
  errno = error;
}

void install(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaddset(&action.sa_mask, SIGCONT);
  ::sigaction(number, &action, &in_use.previous[static_cast<std::size_t>(number)]);
}

void install_end(int number) {
  struct sigaction& previous = in_use.previous[static_cast<std::size_t>(number)];
  ::sigaction(number, nullptr, &previous);
  if (previous.sa_handler == SIG_IGN) {
    return;
  }
  struct sigaction action {};
  action.sa_sigaction = on_end;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  ::sigaction(number, &action, nullptr);
}

// Crashes may come from a full stack, so their handler has one of its own.
void give_signals_a_stack() {
  constexpr std::size_t kBytes = 65536;
  alignas(16) static std::array<char, kBytes> bytes;
  stack_t current{};
  if (::sigaltstack(nullptr, &current) == 0 && (current.ss_flags & SS_DISABLE) != 0) {
    stack_t stack{};
    stack.ss_sp = bytes.data();
    stack.ss_size = bytes.size();
    ::sigaltstack(&stack, nullptr);
  }
}

}  // namespace

TerminalMode::TerminalMode(int descriptor) {
  if (in_use.wakeup[0] < 0 && ::pipe2(in_use.wakeup.data(), O_NONBLOCK | O_CLOEXEC) != 0) {
    throw ScreenError("the terminal cannot be used: this program may not open more files");
  }
  in_use.descriptor = descriptor;
  ::tcgetattr(descriptor, &in_use.before);
  in_use.raw = in_use.before;
  // Raw, except that Ctrl-C, Ctrl-Z and Ctrl-\ stay what they are.
  in_use.raw.c_iflag &= ~static_cast<tcflag_t>(BRKINT | ICRNL | INLCR | IGNCR | INPCK | ISTRIP | IXON);
  in_use.raw.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  in_use.raw.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | IEXTEN);
  in_use.raw.c_cc[VMIN] = 0;
  in_use.raw.c_cc[VTIME] = 0;
  give_signals_a_stack();
  static const bool at_exit = std::atexit(restore_terminal) == 0;
  static_cast<void>(at_exit);
  for (const int number : kEnding) {
    install_end(number);
  }
  struct sigaction& stop = in_use.previous[SIGTSTP];
  ::sigaction(SIGTSTP, nullptr, &stop);
  if (stop.sa_handler != SIG_IGN) {
    install(SIGTSTP, on_stop);
  }
  install(SIGCONT, on_continue);
  install(SIGWINCH, on_resize);
  enter();
}

TerminalMode::~TerminalMode() {
  leave();
  for (const int number : kEnding) {
    ::sigaction(number, &in_use.previous[static_cast<std::size_t>(number)], nullptr);
  }
  for (const int number : {SIGTSTP, SIGCONT, SIGWINCH}) {
    ::sigaction(number, &in_use.previous[static_cast<std::size_t>(number)], nullptr);
  }
}

bool TerminalMode::is_entered() const {
  return in_use.entered;
}
bool TerminalMode::take_resized() {
  return in_use.resized.exchange(false);
}
bool TerminalMode::take_reentered() {
  return in_use.reentered.exchange(false);
}

Wakeup TerminalMode::wait(int timeout_ms) {
  std::array<pollfd, 2> sources{{{in_use.descriptor, POLLIN, 0}, {in_use.wakeup[0], POLLIN, 0}}};
  const int ready = ::poll(sources.data(), sources.size(), timeout_ms);
  if (ready == 0) {
    return Wakeup::kTime;
  }
  if (ready < 0 || sources[1].revents != 0) {
    drain();  // before the flags are looked at: what comes later is found by the next wait
    return Wakeup::kSignal;
  }
  return (sources[0].revents & POLLIN) != 0 && (sources[0].revents & POLLHUP) == 0 ? Wakeup::kInput
                                                                                   : Wakeup::kHangUp;
}

void restore_terminal() {
  leave();
}

}  // namespace thimble::host
