#include "host/simulation.h"

#include <signal.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "host/simulation_state.h"

namespace thimble::host {

thread_local Simulation::State* running_here = nullptr;

namespace {

constexpr std::array kFaults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr std::uint8_t kRamPaint = port::kStackPaint;
constexpr std::size_t kFlashAlignment = 8;  // without it a baked brick map is not taken
constexpr std::size_t kSignalStackBytes = 65536;

// The actions of kFaults before the simulation; one at a time has them.
std::array<struct sigaction, 65> previous_actions{};

// Frames of a 64-bit host are about twice a chip's, and those of instrumented code many times as large. The
// thread's own bookkeeping lies on its stack too.
std::size_t host_stack_bytes(std::uint32_t board_bytes) {
#ifdef __SANITIZE_ADDRESS__
  constexpr std::size_t kTimes = 64;
#else
  constexpr std::size_t kTimes = 8;
#endif
  constexpr std::size_t kOwn = std::size_t{256} << 10;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return (kTimes * board_bytes + kOwn + page - 1) / page * page;
}

bool is_write(void* context) {
#if defined(__x86_64__)
  constexpr greg_t kWrite = 2;  // in the page fault's error code
  return (static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_ERR] & kWrite) != 0;
#else
  static_cast<void>(context);
  return true;
#endif
}

[[noreturn]] void wait_for_ever() {
  while (true) {
    ::pause();
  }
}

extern "C" void on_fault(int number, siginfo_t* info, void* context) {
  Simulation::State* const state = running_here;
  if (state != nullptr) {
    state->signal = number;
    state->address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    state->is_write = is_write(context);
    state->stopped = true;
    state->to_host.post();
    wait_for_ever();  // there is nothing to go back to
  }
  // Not the application's: it takes the course that it would have taken.
  ::sigaction(number, &previous_actions[static_cast<std::size_t>(number)], nullptr);
  if (info->si_code <= 0) {
    ::raise(number);
  }
}

void take_faults() {
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  for (const int number : kFaults) {
    ::sigaction(number, &action, &previous_actions[static_cast<std::size_t>(number)]);
  }
}

void give_faults_back() {
  for (const int number : kFaults) {
    ::sigaction(number, &previous_actions[static_cast<std::size_t>(number)], nullptr);
  }
}

// Calls what the port calls, so that the dynamic linker has bound it: its own frames on this stack are large
// and would be taken for the application's.
void bind_functions(Simulation::State* state) {
  Semaphore nothing;
  nothing.post();
  nothing.wait();
  state->asked_at = std::chrono::steady_clock::now();
  const Bytes bytes = state->arena.bytes();
  std::memmove(bytes.data, bytes.data, bytes.size);
  std::memset(bytes.data, kRamPaint, bytes.size);
}

// Paints the stack below this function's caller, where the application's frames will be.
__attribute__((noinline, no_sanitize("address"))) void paint_stack(Simulation::State* state) {
  constexpr std::ptrdiff_t kOwnFrame = 192;
  auto* const top = static_cast<std::uint8_t*>(__builtin_frame_address(0));
  state->stack_top = top;
  for (volatile std::uint8_t* byte = state->stack.bytes().begin(); byte < top - kOwnFrame; ++byte) {
    *byte = port::kStackPaint;
  }
}

void* run_application(void* argument) {
  auto* const state = static_cast<Simulation::State*>(argument);
  running_here = state;
  stack_t own{};
  own.ss_sp = state->signal_stack.bytes().data;
  own.ss_size = state->signal_stack.bytes().size;
  stack_t before{};
  ::sigaltstack(&own, &before);
  bind_functions(state);
  paint_stack(state);
  state->status = state->application();
  // Who gave the thread another, a sanitizer, takes back what it finds when the thread ends, wherever that
  // lies.
  ::sigaltstack(&before, nullptr);
  state->ended = true;
  state->to_host.post();
  return nullptr;
}

std::string count_text(std::ptrdiff_t bytes) {
  return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes");
}

// What happened, from the signal and the address.
std::string fault_text(const Simulation::State& state) {
  if (state.signal == SIGFPE) {
    return "a division by zero, or another arithmetic fault";
  }
  if (state.signal == SIGILL) {
    return "an instruction that there is not";
  }
  if (state.signal == SIGABRT) {
    return "it gave up (abort)";
  }
  const char* const did = state.is_write ? "wrote" : "read";
  if (const auto offset = state.arena.offset_of(state.address)) {
    const auto size = static_cast<std::ptrdiff_t>(state.arena.bytes().size);
    if (*offset >= size) {
      return std::string("it ") + did + " past its RAM: byte " + std::to_string(*offset) +
             " of an arena of " + count_text(size);
    }
    return std::string("it ") + did + " " + count_text(-*offset) + " in front of its RAM";
  }
  if (const auto offset = state.flash.offset_of(state.address)) {
    const auto size = static_cast<std::ptrdiff_t>(state.flash.bytes().size);
    if (*offset >= 0 && *offset < size) {
      return "it wrote to flash: byte " + std::to_string(*offset) + " of the scene";
    }
    return std::string("it ") + did + " outside the scene: byte " + std::to_string(*offset) + " of " +
           std::to_string(size);
  }
  if (state.stack.offset_of(state.address)) {
    return "its stack overflowed: it took more than " + std::to_string(state.stack.bytes().size) +
           " bytes here";
  }
  std::array<char, 32> address{};
  std::snprintf(address.data(), address.size(), "0x%llx", static_cast<unsigned long long>(state.address));
  return std::string("it ") + did + " at the address " + address.data() + ", which is not its own";
}

}  // namespace

__attribute__((no_sanitize("address"))) std::uint32_t used_stack(const std::uint8_t* begin,
                                                                 const std::uint8_t* end) {
  const std::uint8_t* byte = begin;
  while (byte < end && *byte == port::kStackPaint) {
    ++byte;
  }
  return static_cast<std::uint32_t>(end - byte);
}

bool Semaphore::wait_until(std::chrono::steady_clock::time_point end) {
  const auto nanoseconds =
      std::chrono::duration_cast<std::chrono::nanoseconds>(end.time_since_epoch()).count();
  timespec time{};
  time.tv_sec = static_cast<time_t>(nanoseconds / 1'000'000'000);
  time.tv_nsec = static_cast<long>(nanoseconds % 1'000'000'000);
  int result = 0;
  do {
    result = sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &time);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

Simulation::State::State(const SimulationOptions& options)
    : application(options.application),
      facts{options.board->name,
            options.board->ram_bytes,
            options.board->flash_bytes,
            options.board->stack_bytes,
            {options.board->width_px, options.board->height_px, options.board->format, options.connected},
            options.board->visits_a_second,
            options.board->map_rays_a_second,
            options.hold_fps},
      band_buffers(options.board->band_buffers),
      cores(options.board->cores),
      arena(options.board->ram_bytes - options.board->stack_bytes, kRamPaint),
      flash((options.scene.size + kFlashAlignment - 1) / kFlashAlignment * kFlashAlignment, 0),
      scene(flash.bytes().subspan(0, options.scene.size)),
      frame(options.painter, scene),
      stack(host_stack_bytes(options.board->stack_bytes), port::kStackPaint),
      signal_stack(kSignalStackBytes, 0),
      display(options.board->width_px, options.board->height_px, options.board->format) {
  std::copy(options.scene.begin(), options.scene.end(), flash.bytes().begin());
  flash.make_read_only();
}

void Simulation::State::stop(const std::string& why) {
  fault = why;
  stopped = true;
  to_host.post();
  wait_for_ever();
}

Simulation::Simulation(const SimulationOptions& options) {
  const platform::BoardFacts& board = *options.board;
  if (board.stack_bytes >= board.ram_bytes) {
    throw SimulationError(std::string(board.name) + " has no RAM beside its stack");
  }
  if (options.scene.size > board.flash_bytes) {
    throw SimulationError("the scene takes " + std::to_string(options.scene.size) + " bytes, " +
                          std::to_string(options.scene.size - board.flash_bytes) +
                          " more than the flash of " + board.name);
  }
  state_ = std::make_unique<State>(options);
  take_faults();
  // Signals that are not faults are for the thread that made this.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  for (const int number : kFaults) {
    sigdelset(&all, number);
  }
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, state_->stack.bytes().data, state_->stack.bytes().size);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const int error = pthread_create(&state_->thread, &attributes, run_application, state_.get());
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    give_faults_back();
    throw SimulationError(std::string("there is no thread for the application: ") + std::strerror(error));
  }
}

Simulation::~Simulation() {
  give_faults_back();
  if (state_->ended) {
    pthread_join(state_->thread, nullptr);
    return;
  }
  // Its thread cannot be ended from outside; so it keeps what it uses.
  pthread_detach(state_->thread);
  static_cast<void>(state_.release());
}

Moment Simulation::wait(int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  while (true) {
    if (state_->wants_frame) {
      state_->frame.draw();
      state_->wants_frame = false;
      state_->frame_is_there.post();
    }
    const bool fell = state_->stopped;
    if (fell || state_->ended || state_->asks) {
      if (fell && state_->fault.empty()) {
        state_->fault = fault_text(*state_);
      } else if (!fell && !state_->arena.front_is_whole()) {
        state_->fault = "it wrote in front of its RAM";
      } else if (state_->ended && state_->status == 0) {
        state_->fault = state_->display.end_frame().value_or(state_->fault);
      }
      return state_->ended || !state_->fault.empty() ? Moment::kEnded : Moment::kAsks;
    }
    if (!state_->to_host.wait_until(end) || state_->wants_room) {
      return Moment::kNothing;
    }
  }
}

void Simulation::answer(bool go_on) {
  state_->go_on = go_on;
  state_->answered_at = std::chrono::steady_clock::now();
  state_->asks = false;
  state_->answered.post();
}

std::uint32_t Simulation::frames_asked() const {
  return state_->frames_asked;
}

bool Simulation::has_read_all() const {
  return state_->input.is_empty();
}
const StrictDisplay& Simulation::display() const {
  return state_->display;
}
int Simulation::status() const {
  return state_->fault.empty() ? state_->status : port::kFaultStatus;
}
const std::string& Simulation::fault() const {
  return state_->fault;
}
void Simulation::set_buttons(std::uint32_t buttons) {
  state_->buttons = buttons;
}
bool Simulation::type(std::uint8_t byte) {
  return state_->input.put(byte);
}

double Simulation::frame_seconds() const {
  return std::chrono::duration<double>(state_->asked_at - state_->answered_at).count();
}

MemoryUse Simulation::use() const {
  const Bytes arena = state_->arena.bytes();
  const std::uint8_t* last = arena.end();
  while (last > arena.begin() && last[-1] == kRamPaint) {
    --last;
  }
  MemoryUse use;
  use.ram_bytes = static_cast<std::uint32_t>(last - arena.begin());
  use.ram_limit_bytes = static_cast<std::uint32_t>(arena.size);
  use.flash_bytes = static_cast<std::uint32_t>(state_->scene.size);
  use.flash_limit_bytes = state_->facts.flash_bytes;
  use.stack_bytes = used_stack(state_->stack.bytes().begin(), state_->stack_top);
  use.stack_limit_bytes = state_->facts.stack_bytes;
  return use;
}

std::string Simulation::take_output() {
  std::string text;
  for (int byte = state_->output.take(); byte >= 0; byte = state_->output.take()) {
    text += static_cast<char>(byte);
  }
  if (state_->wants_room.exchange(false)) {
    state_->room.post();
  }
  return text;
}

}  // namespace thimble::host
