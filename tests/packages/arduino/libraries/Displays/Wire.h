#ifndef STUB_WIRE_H
#define STUB_WIRE_H

#include <Arduino.h>

struct TwoWire {
  void begin();
  void setClock(uint32_t hz);
  void beginTransmission(uint8_t address);
  size_t write(const uint8_t* bytes, size_t count);
  uint8_t endTransmission();
};
extern TwoWire Wire;

#endif
