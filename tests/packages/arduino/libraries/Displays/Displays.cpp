#include "Adafruit_GFX.h"

namespace {

void print_hex(unsigned value, int digits) {
  while (digits > 0) {
    --digits;
    putchar("0123456789abcdef"[value >> 4 * digits & 15U]);
  }
}

}  // namespace

// Only whole rows that follow one another make a picture.
void Adafruit_GFX::drawBitmap(int16_t x, int16_t y, uint8_t* bitmap, int16_t w, int16_t h, uint16_t color,
                              uint16_t bg) {
  if (x != 0 || y != next_row_ || w != width_ || y + h > height_ || color != 1 || bg != 0) {
    exit(3);
  }
  for (int row = 0; row < h; ++row, ++next_row_) {
    for (int i = 0; i < w / 8; ++i) {
      print_hex(bitmap[row * (w / 8) + i], 2);
    }
    putchar('\n');
  }
}

void Adafruit_GFX::drawRGBBitmap(int16_t x, int16_t y, uint16_t* bitmap, int16_t w, int16_t h) {
  if (x != 0 || y != next_row_ || w != width_ || y + h > height_) {
    exit(3);
  }
  for (int row = 0; row < h; ++row, ++next_row_) {
    for (int i = 0; i < w; ++i) {
      print_hex(bitmap[row * w + i], 4);
    }
    putchar('\n');
  }
  if (next_row_ == height_) {
    end();
  }
}

void Adafruit_GFX::end() {
  exit(next_row_ == height_ ? 0 : 3);
}
