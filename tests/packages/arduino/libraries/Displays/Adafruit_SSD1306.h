#ifndef STUB_ADAFRUIT_SSD1306_H
#define STUB_ADAFRUIT_SSD1306_H

#include <Adafruit_GFX.h>
#include <Wire.h>

#define SSD1306_BLACK 0
#define SSD1306_WHITE 1
#define SSD1306_SWITCHCAPVCC 0x02

class Adafruit_SSD1306 : public Adafruit_GFX {
 public:
  Adafruit_SSD1306(uint8_t w, uint8_t h, TwoWire* twi = &Wire, int8_t rst_pin = -1) : Adafruit_GFX(w, h) {
    (void)twi;
    (void)rst_pin;
  }
  bool begin(uint8_t switchvcc = SSD1306_SWITCHCAPVCC, uint8_t i2caddr = 0) {
    return switchvcc == SSD1306_SWITCHCAPVCC && i2caddr == 0x3C;
  }
  void display() { end(); }
};

#endif
