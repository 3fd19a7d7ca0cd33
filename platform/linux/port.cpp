// port.h on a Linux framebuffer.
#include "port.h"

#include <pthread.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "linux/console.h"
#include "linux/session.h"

namespace thimble::linux_port {
namespace {

Session session;
Bytes stack;

struct Call {
  int (*application)();
  int status;
};

void* call(void* argument) {
  Call* made = static_cast<Call*>(argument);
  made->status = made->application();
  return nullptr;
}

// A stack with a page below it that nobody may touch.
bool map_stack(size_t bytes) {
  const size_t page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
  void* at = mmap(nullptr, bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED || mprotect(at, page, PROT_NONE) != 0) {
    return false;
  }
  stack = Bytes(static_cast<uint8_t*>(at) + page, bytes);
  memset(stack.data, port::kStackPaint, stack.size);
  return true;
}

}  // namespace

int run(const Session& given, int (*application)(), const char** fault) {
  session = given;
  Call made{application, 1};
  pthread_attr_t attributes;
  pthread_t thread;
  if (!map_stack(session.facts.stack_bytes) || pthread_attr_init(&attributes) != 0 ||
      pthread_attr_setstack(&attributes, stack.data, stack.size) != 0 ||
      pthread_create(&thread, &attributes, call, &made) != 0) {
    *fault = "there is no memory for the application's stack";
    return 1;
  }
  pthread_join(thread, nullptr);
  return made.status;
}

}  // namespace thimble::linux_port

namespace thimble::port {

using linux_port::session;

const Facts& facts() {
  return session.facts;
}
Bytes arena() {
  return session.arena;
}
ConstBytes scene() {
  return session.scene;
}

void flush(const Band& band) {
  if (band.pixels.empty()) {
    return;  // the framebuffer holds what it was sent
  }
  linux_port::put_band(band, session.facts.display.width_px, session.framebuffer->layout(), session.placement,
                       session.framebuffer->bytes());
}

uint32_t buttons() {
  session.keys->poll();
  return session.keys->buttons();
}

int read() {
  session.keys->poll();
  return session.keys->read();
}

void write(ConstBytes bytes) {
  while (bytes.size > 0) {
    const ssize_t taken = ::write(STDOUT_FILENO, bytes.data, bytes.size);
    if (taken <= 0) {
      return;  // nobody listens any more
    }
    bytes = bytes.subspan(static_cast<size_t>(taken));
  }
}

bool running(uint32_t frames) {
  return !linux_port::asked_to_end() && (session.most_frames == 0 || frames < session.most_frames);
}

uint32_t instructions() {
  return 0;
}

uint32_t microseconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<uint32_t>(static_cast<uint64_t>(now.tv_sec) * 1000000 +
                               static_cast<uint64_t>(now.tv_nsec) / 1000);
}

uint32_t stack_high_water() {
  size_t untouched = 0;
  while (untouched < linux_port::stack.size && linux_port::stack[untouched] == kStackPaint) {
    ++untouched;
  }
  return static_cast<uint32_t>(linux_port::stack.size - untouched);
}

}  // namespace thimble::port
