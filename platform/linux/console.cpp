#include "linux/console.h"

#include <fcntl.h>
#include <linux/kd.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <initializer_list>

namespace thimble::linux_port {
namespace {

// What was found, to be put back. Looked at by signal handlers: set before the change that it undoes.
struct Found {
  int console = -1;
  int mode = KD_TEXT;
  int keyboard = K_UNICODE;
  bool mode_known = false;
  bool keyboard_known = false;
  bool input_known = false;
  termios input{};
};
Found found;
volatile sig_atomic_t end_wanted = 0;

// A program that is killed by a fault dies of it after the console has been given back.
void on_fault(int signal_number) {
  restore_console();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

void on_end(int) {
  // The second time it is meant.
  if (end_wanted != 0) {
    restore_console();
    _exit(1);
  }
  end_wanted = 1;
}

void handle(int signal_number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigfillset(&action.sa_mask);
  sigaction(signal_number, &action, nullptr);
}

}  // namespace

void restore_console() {
  // Only calls that a signal handler may make.
  if (found.keyboard_known) {
    ioctl(found.console, KDSKBMODE, found.keyboard);
    found.keyboard_known = false;
  }
  if (found.mode_known) {
    ioctl(found.console, KDSETMODE, found.mode);
    found.mode_known = false;
  }
  if (found.input_known) {
    tcsetattr(STDIN_FILENO, TCSANOW, &found.input);
    found.input_known = false;
  }
}

void take_console() {
  atexit(restore_console);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    // Whoever started us with a signal ignored (nohup, a shell's background job) wants it ignored.
    struct sigaction before {};
    if (sigaction(signal_number, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {
      handle(signal_number, on_end);
    }
  }
  for (const int signal_number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    handle(signal_number, on_fault);
  }
  if (tcgetattr(STDIN_FILENO, &found.input) == 0) {
    found.input_known = true;
    termios raw = found.input;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  // The console that we run on, or else the one that is shown.
  for (const char* path : {"/dev/tty", "/dev/tty0"}) {
    found.console = open(path, O_RDWR | O_CLOEXEC | O_NOCTTY);
    if (found.console >= 0 && ioctl(found.console, KDGETMODE, &found.mode) == 0) {
      break;
    }
    if (found.console >= 0) {
      close(found.console);
      found.console = -1;
    }
  }
  if (found.console < 0) {
    return;
  }
  found.mode_known = true;
  ioctl(found.console, KDSETMODE, KD_GRAPHICS);
  if (ioctl(found.console, KDGKBMODE, &found.keyboard) == 0) {
    found.keyboard_known = true;
    ioctl(found.console, KDSKBMODE, K_OFF);
  }
}

bool asked_to_end() {
  return end_wanted != 0;
}

}  // namespace thimble::linux_port
