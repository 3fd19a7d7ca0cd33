// Stands in for the displays' libraries: the calls that the examples make, with the parameters that those have. The
// picture goes to the UART as text, a line a row, when its first frame is whole; then the program ends.
#ifndef STUB_ADAFRUIT_GFX_H
#define STUB_ADAFRUIT_GFX_H

#include <Arduino.h>

class Adafruit_GFX {
 public:
  Adafruit_GFX(int16_t w, int16_t h) : width_(w), height_(h) {}
  void drawBitmap(int16_t x, int16_t y, uint8_t* bitmap, int16_t w, int16_t h, uint16_t color, uint16_t bg);
  void drawRGBBitmap(int16_t x, int16_t y, uint16_t* bitmap, int16_t w, int16_t h);

 protected:
  [[noreturn]] void end();
  int16_t width_, height_, next_row_ = 0;
};

#endif
