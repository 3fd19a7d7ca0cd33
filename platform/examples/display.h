/// What the examples want of a display, in C and in C++: two functions that your firmware supplies.
/// display_host.cpp has them for a desktop.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// 128 x 64 pixels of 16 greys, two a byte, the left one in the high half; sent eight rows at a time.
enum { kDisplayWidth = 128, kDisplayHeight = 64, kDisplayBandRows = 8 };

#ifdef __cplusplus
extern "C" {
#endif

/// Sends rows first_row .. first_row + rows - 1. The bytes are free again when it returns.
void display_send(int32_t first_row, int32_t rows, const uint8_t* bytes, size_t size);
/// Waits until it is time for frame `number`, counted from 0. False ends the program.
bool display_wait(uint32_t number);

#ifdef __cplusplus
}
#endif
