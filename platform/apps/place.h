/// An application's state in the arena, so that it weighs on neither .bss nor the stack.
#pragma once

#include <stddef.h>

#include "thimble/base/memory.h"

namespace thimble::apps {

/// A base of what is placed in an arena: `new (bytes) State`, without the header <new>, which the RISC-V
/// toolchain lacks.
struct Placed {
  static void* operator new(size_t, void* where) noexcept { return where; }
};

/// A T in the arena, or null when it does not fit. It is never destroyed.
template <class T>
T* place(Arena* arena) {
  const Bytes bytes = arena->take(sizeof(T), alignof(T));
  return bytes.empty() ? nullptr : new (static_cast<void*>(bytes.data)) T;
}

}  // namespace thimble::apps
