// The contract of port.h, for an application in a simulation. All of this runs on the application's thread,
// and on its stack, so it does little and leaves the rest to the other thread.
#include "port.h"

#include <algorithm>
#include <chrono>

#include "host/simulation_state.h"

namespace thimble::port {
namespace {

host::Simulation::State& here() {
  return *host::running_here;
}

}  // namespace

const Facts& facts() {
  return here().facts;
}

Bytes arena() {
  return here().arena.bytes();
}

ConstBytes scene() {
  return here().scene;
}

void flush(const Band& band) {
  await_flush();
  if (const auto fault = here().display.flush(band)) {
    here().stop(*fault);
  }
  if (here().frame.contradicts(band)) {
    here().stop("what drew in the core's place gave another picture than the core: row " +
                std::to_string(band.first_row));
  }
}

// The display has the bytes already; what is left to do is to see that nobody touches them.
void begin_flush(const Band& band) {
  flush(band);
  if (band_buffers() > 1) {
    here().sending = band.pixels;
    here().sent.assign(band.pixels.begin(), band.pixels.end());
  }
}

void await_flush() {
  host::Simulation::State& state = here();
  const ConstBytes sending = state.sending;
  state.sending = {};
  if (!std::equal(sending.begin(), sending.end(), state.sent.begin())) {
    state.stop(
        "a band was written while it was being sent: another one's memory, or port::await_flush, first");
  }
}

int32_t band_buffers() {
  return here().band_buffers;
}

int32_t cores() {
  return here().cores;
}

bool draw(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band) {
  host::Simulation::State& state = here();
  if (state.frame.begins_with(tree, camera, shading, band,
                              reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)))) {
    state.wants_frame = true;
    state.to_host.post();
    state.frame_is_there.wait();
  }
  return state.frame.hand_out(band);
}

uint32_t buttons() {
  return here().buttons;
}

int read() {
  return here().input.take();
}

void write(ConstBytes bytes) {
  host::Simulation::State& state = here();
  for (const uint8_t byte : bytes) {
    while (!state.output.put(byte)) {
      state.wants_room = true;
      state.to_host.post();
      state.room.wait();
    }
  }
}

bool running(uint32_t frames) {
  host::Simulation::State& state = here();
  if (const auto fault = state.display.end_frame()) {
    state.stop(*fault);
  }
  state.frames_asked = frames;
  state.asked_at = std::chrono::steady_clock::now();
  state.asks = true;
  state.to_host.post();
  state.answered.wait();
  return state.go_on;
}

uint32_t instructions() {
  return 0;  // the host's are not the chip's
}

uint32_t microseconds() {
  const auto elapsed = std::chrono::steady_clock::now() - here().start;
  return static_cast<uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(elapsed).count());
}

uint32_t stack_high_water() {
  const host::Simulation::State& state = here();
  return host::used_stack(state.stack.bytes().begin(), state.stack_top);
}

}  // namespace thimble::port
