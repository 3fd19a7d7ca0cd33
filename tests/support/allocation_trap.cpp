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

// The array forms end in these. The nothrow form has to be here as well: a sanitizer's own would not end in
// this one, and its memory would then be freed by the wrong partner.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  count_call();
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) {
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
