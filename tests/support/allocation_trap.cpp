// The global allocator of the test binary, counted while the trap is set. In a file of its own: where the
// compiler sees these bodies beside their calls it takes `free` for the wrong partner of `new`.
#include "support/allocation_trap.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<bool> trapped = false;
std::atomic<int> calls = 0;

void count_call() {
  if (trapped) {
    ++calls;
  }
}

}  // namespace

// The array and nothrow forms end in these.
void* operator new(std::size_t size) {
  count_call();
  if (void* memory = std::malloc(size == 0 ? 1 : size)) {
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  count_call();
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  count_call();
  std::free(memory);
}

namespace thimble::tests {

void set_allocation_trap() {
  calls = 0;
  trapped = true;
}

int clear_allocation_trap() {
  trapped = false;
  return calls;
}

}  // namespace thimble::tests
