/// What a board's folder supplies (platform/boards/NAME/*.cpp), and what the rest of the port makes of it.
///
/// platform/arch/common turns these functions and the numbers of board.cmake into the contract that
/// applications see (port.h). A board without a display or without buttons leaves `flush` or `buttons` out:
/// the library of the port holds empty ones. The same holds for the clock: a Cortex-M board gets SysTick
/// unless it brings its own.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "port.h"

namespace thimble::board {

/// Clocks, pins and the UART; then the display, on and black. Runs once, after .data and .bss are there.
/// Waits in it are bounded: an emulator need not have the bit that a chip sets.
void start();

/// Sends a byte over the UART; waits (bounded) until it is taken.
void put(uint8_t byte);
/// The next byte that came over the UART, or -1; does not wait.
int get();
/// Where board.cmake sets BOARD_UART, its driver (platform/drivers) brings `put`, `get` and this, which `start` calls
/// when pins and the module's clock are set: 8 bits, no parity, one stop bit.
void start_uart(uint32_t clock_hz);
inline constexpr uint32_t kBaud = 115200;

/// port::flush and port::buttons.
void flush(const Band& band);
uint32_t buttons();
/// port::flush_again, where board.cmake sets BOARD_FLUSHES_AGAIN.
void flush_again(const Band& band);
/// In place of `flush`, where board.cmake sets BOARD_BAND_BUFFERS to 2: begins to send a band, after what was
/// on its way has arrived; and waits until it is sent. The band has bytes.
void begin_flush(const Band& band);
void await_flush();

/// Starts what port::instructions() and port::microseconds() count by.
void start_clock();

/// How often a wait for a flag of the hardware polls it before it gives up.
inline constexpr uint32_t kPatience = 1000000;

}  // namespace thimble::board
