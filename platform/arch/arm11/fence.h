/// What a board adds to the memory that an ARM1176 may touch.
#pragma once

#include <stdint.h>

namespace thimble::arm11 {

enum class Window : uint8_t { kDevice, kMemory };

/// Lets the board's devices or a framebuffer be read and written, in whole MiB around the bytes given. At
/// most four; before the fence is raised, so from board::start().
void open_window(Window kind, uint32_t address, uint32_t bytes);

}  // namespace thimble::arm11
