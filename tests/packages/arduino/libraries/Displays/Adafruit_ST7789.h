#ifndef STUB_ADAFRUIT_ST7789_H
#define STUB_ADAFRUIT_ST7789_H

#include <Adafruit_GFX.h>
#include <SPI.h>

class Adafruit_ST7789 : public Adafruit_GFX {
 public:
  Adafruit_ST7789(int8_t cs, int8_t dc, int8_t rst) : Adafruit_GFX(0, 0) {
    (void)cs;
    (void)dc;
    (void)rst;
  }
  void init(uint16_t width, uint16_t height) {
    width_ = static_cast<int16_t>(width);
    height_ = static_cast<int16_t>(height);
  }
};

#endif
