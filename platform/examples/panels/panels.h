/// What the examples, in C++ and in C, want of the board: bytes to panel 0, an SSD1306, and panel 1, an ST7789. Over SPI: chip select and
/// D/C low for commands, D/C high for data, out with the bytes. src/drivers/README.md has one in ten lines.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

bool panel_command(int panel, const uint8_t* bytes, size_t count);
bool panel_data(int panel, const uint8_t* bytes, size_t count);
void panel_wait(uint32_t milliseconds);
/// The pictures are complete.
void panel_done(void);

#ifdef __cplusplus
}
#endif
