/// The memory of a module while an application runs in it, as on a board:
///
///     stack | constants and variables | scene ("flash") | guard | arena, to the last byte of the memory
///
/// The arena has exactly the bytes that the board's RAM leaves beside its stack. A byte behind it is none of
/// the memory: whoever touches it is stopped by the browser. The guard in front of it is looked at after each
/// frame. The stack is larger than the board's, since frames of WebAssembly are not the chip's.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "port.h"

namespace thimble::web {

struct Layout {
  port::Facts facts;
  int32_t band_buffers;
  int32_t cores;
  Bytes scene;
  Bytes guard;
  Bytes arena;
};
extern Layout layout;

/// Bytes of the stack that are not paint any more.
uint32_t used_stack();

}  // namespace thimble::web
