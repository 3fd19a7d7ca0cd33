#ifndef STUB_SPI_H
#define STUB_SPI_H

#include <Arduino.h>

enum { SPI_MODE0 = 0 };
struct SPISettings {
  SPISettings(uint32_t hz, uint8_t order, uint8_t mode);
};
struct SPIClass {
  void begin();
  void beginTransaction(SPISettings settings);
  uint8_t transfer(uint8_t byte);
};
extern SPIClass SPI;

#endif
