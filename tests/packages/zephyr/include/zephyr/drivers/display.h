// Stands in for Zephyr's display API, as far as the sample calls it. Prints the first frame, a line a row, and ends.
#ifndef STUB_ZEPHYR_DISPLAY_H
#define STUB_ZEPHYR_DISPLAY_H

#include <stddef.h>
#include <stdint.h>
#include <zephyr/device.h>

extern "C" int putchar(int character);
extern "C" [[noreturn]] void exit(int status);

enum display_pixel_format {
  PIXEL_FORMAT_RGB_888 = 1,
  PIXEL_FORMAT_MONO01 = 2,
  PIXEL_FORMAT_RGB_565 = 16,
  PIXEL_FORMAT_BGR_565 = 32,
};
struct display_capabilities {
  uint16_t x_resolution;
  uint16_t y_resolution;
  uint32_t supported_pixel_formats;
  uint32_t screen_info;
  display_pixel_format current_pixel_format;
};
struct display_buffer_descriptor {
  uint32_t buf_size;
  uint16_t width;
  uint16_t height;
  uint16_t pitch;
};

/// 100 rows are no multiple of a band.
inline void display_get_capabilities(const device*, display_capabilities* is) {
  *is = {160, 100, STUB_FORMAT, 0, STUB_FORMAT};
}
inline int display_blanking_off(const device*) {
  return 0;
}
inline int display_write(const device*, uint16_t x, uint16_t y, const display_buffer_descriptor* rows,
                         const void* bytes) {
  static uint16_t next_row = 0;
  const uint32_t row_bytes = 160U * (STUB_FORMAT == PIXEL_FORMAT_RGB_888 ? 3 : 2);
  if (x != 0 || y != next_row || rows->width != 160 || rows->pitch != 160 ||
      rows->buf_size != rows->height * row_bytes) {
    exit(3);
  }
  for (uint32_t i = 0; i < rows->buf_size; ++i) {
    const unsigned value = static_cast<const uint8_t*>(bytes)[i];
    putchar("0123456789abcdef"[value >> 4]);
    putchar("0123456789abcdef"[value & 15U]);
    if ((i + 1) % row_bytes == 0) {
      putchar('\n');
    }
  }
  next_row = static_cast<uint16_t>(next_row + rows->height);
  if (next_row == 100) {
    exit(0);
  }
  return 0;
}

#endif
