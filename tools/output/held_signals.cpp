#include "output/held_signals.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <string_view>

namespace thimble::tools {
namespace {

// More than any subcommand has outputs. A handler may not allocate.
constexpr std::size_t kMostUnfinished = 64;
std::array<std::atomic<const char*>, kMostUnfinished> unfinished{};
std::atomic<int> holders{0};
std::atomic<int> arrived{0};  // the signal that ends the program, as soon as nobody holds it

void remove_unfinished() {
  for (const std::atomic<const char*>& name : unfinished) {
    if (name != nullptr) {
      ::unlink(name);
    }
  }
}

void put_in_place_of(const char* kept, const char* name) {
  for (std::atomic<const char*>& place : unfinished) {
    const char* expected = kept;
    if (place.compare_exchange_strong(expected, name)) {
      return;
    }
  }
}

void end_by(int number) {
  remove_unfinished();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

// It may run in any thread. It looks for holders after it says that it came, and a holder the other way round, so
// that at least one of them sees the other.
extern "C" void end_unless_held(int number) {
  arrived = number;
  if (holders == 0) {
    end_by(number);
  }
}

// Reading on in a mapped file (file_bytes.h) that another program cut off would bring the signal again.
extern "C" void end_cut_off(int) {
  constexpr std::string_view kSentence = "thimble: an input was cut off, or failed, while it was read\n";
  remove_unfinished();
  static_cast<void>(::write(STDERR_FILENO, kSentence.data(), kSentence.size()) > 0);
  ::_exit(1);
}

}  // namespace

void clean_up_on_signals() {
  std::signal(SIGBUS, end_cut_off);
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGABRT, SIGALRM, SIGTERM, SIGUSR1, SIGUSR2, SIGPOLL,
                           SIGPROF, SIGVTALRM, SIGXCPU, SIGPWR, SIGSTKFLT}) {
    if (std::signal(number, end_unless_held) == SIG_IGN) {
      std::signal(number, SIG_IGN);
    }
  }
}

HeldSignals::HeldSignals() {
  if (++holders == 1 && arrived != 0) {
    end_by(arrived);
  }
}

HeldSignals::~HeldSignals() {
  if (--holders == 0 && arrived != 0) {
    end_by(arrived);
  }
}

void remember_unfinished(const std::string& name) {
  put_in_place_of(nullptr, name.c_str());
}

void forget_unfinished(const std::string& name) {
  put_in_place_of(name.c_str(), nullptr);
}

}  // namespace thimble::tools
