/// What a simulation's two threads share: the application's, which runs through port.cpp, and the host's.
#pragma once

#include <pthread.h>
#include <semaphore.h>
#include <cstddef>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "host/drawn_frame.h"
#include "host/guarded_bytes.h"
#include "host/simulation.h"
#include "host/strict_display.h"
#include "port.h"

namespace thimble::host {

/// Bytes from one thread to one other, without locks; up to `kBytes`, a power of two.
template <std::size_t kBytes>
class ByteQueue {
 public:
  static_assert((kBytes & (kBytes - 1)) == 0);

  /// False when it is full. For the one thread that writes.
  bool put(std::uint8_t byte) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kBytes) {
      return false;
    }
    bytes_[end % kBytes] = byte;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  /// The oldest byte, or -1. For the one thread that reads.
  int take() {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) {
      return -1;
    }
    const int byte = bytes_[begin % kBytes];
    begin_.store(begin + 1, std::memory_order_release);
    return byte;
  }
  /// For the one thread that writes, while the other one waits.
  bool is_empty() const { return begin_.load() == end_.load(); }

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
  std::atomic<std::size_t> begin_{0};
  std::atomic<std::size_t> end_{0};
};

class Semaphore {
 public:
  Semaphore() { sem_init(&semaphore_, 0, 0); }
  ~Semaphore() { sem_destroy(&semaphore_); }
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;
  void post() { sem_post(&semaphore_); }
  void wait() {
    while (sem_wait(&semaphore_) != 0) {
      // A signal's handler ran.
    }
  }
  bool wait_until(std::chrono::steady_clock::time_point end);

 private:
  sem_t semaphore_{};
};

struct Simulation::State {
  explicit State(const SimulationOptions& options);

  int (*application)();
  port::Facts facts;
  std::int32_t band_buffers;
  std::int32_t cores;
  GuardedBytes arena;
  GuardedBytes flash;
  ConstBytes scene;  ///< in it; aligned as on the board, so up to 7 bytes lie behind it
  DrawnFrame frame;  ///< drawn by the other thread while the application waits
  GuardedBytes stack;
  GuardedBytes signal_stack;
  StrictDisplay display;
  ConstBytes sending;              ///< what begin_flush was given, until it is sent
  std::vector<std::uint8_t> sent;  ///< as it was then
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  pthread_t thread{};
  /// Where the application's frames begin; the stack grows down from here.
  const std::uint8_t* stack_top = nullptr;

  // Each side says what it has to say and posts; the application waits for the answer.
  Semaphore to_host;
  Semaphore answered;
  Semaphore room;
  Semaphore frame_is_there;
  std::atomic<bool> asks{false};
  std::atomic<bool> ended{false};
  std::atomic<bool> stopped{false};  ///< by a fault or by the display: the thread waits for ever
  std::atomic<bool> wants_room{false};
  std::atomic<bool> wants_frame{false};
  bool go_on = true;
  std::uint32_t frames_asked = 0;
  std::chrono::steady_clock::time_point answered_at = start;
  std::chrono::steady_clock::time_point asked_at = start;
  int status = 0;

  std::atomic<std::uint32_t> buttons{0};
  ByteQueue<4096> input;
  ByteQueue<65536> output;

  // What stopped it. From the signal's handler:
  int signal = 0;
  std::uintptr_t address = 0;
  bool is_write = false;
  // In words, where they are known.
  std::string fault;

  /// Ends the application where it stands.
  [[noreturn]] void stop(const std::string& why);
};

/// The simulation whose application runs on this thread; null on others.
extern thread_local Simulation::State* running_here;

/// Bytes from the first one that is not paint to `end`; the stack grows down to `begin`.
std::uint32_t used_stack(const std::uint8_t* begin, const std::uint8_t* end);

}  // namespace thimble::host
