// The board's pins and buses tell what is sent (wires.h). What is not set up ends the program with status 3.
#include <SPI.h>
#include <Wire.h>

#include "wires.h"

TwoWire Wire;
SPIClass SPI;

namespace {

constexpr uint8_t kData = 9;  // D/C and chip select of `thimble new`
constexpr uint8_t kSelect = 10;
bool is_output[32];
bool is_high[32];
bool is_begun = false;
uint8_t transfer_bytes[32];
size_t transfer_count = 0;

void want(bool holds) {
  if (!holds) {
    exit(3);
  }
}

}  // namespace

void pinMode(uint8_t pin, uint8_t mode) {
  is_output[pin] = mode == OUTPUT;
}
void digitalWrite(uint8_t pin, uint8_t level) {
  want(is_output[pin]);
  is_high[pin] = level == HIGH;
}

void TwoWire::begin() {
  is_begun = true;
}
void TwoWire::setClock(uint32_t hz) {
  want(is_begun && hz <= 400000);
}
void TwoWire::beginTransmission(uint8_t address) {
  want(is_begun && address == 0x3C);
  transfer_count = 0;
}
size_t TwoWire::write(const uint8_t* bytes, size_t count) {
  want(transfer_count + count <= sizeof transfer_bytes);
  for (size_t i = 0; i < count; ++i) {
    transfer_bytes[transfer_count++] = bytes[i];
  }
  return count;
}
uint8_t TwoWire::endTransmission() {
  wires::tell('i', transfer_bytes, transfer_count);
  return 0;
}

SPISettings::SPISettings(uint32_t hz, uint8_t order, uint8_t mode) {
  want(hz <= 20000000 && order == MSBFIRST && mode == SPI_MODE0);
}
void SPIClass::begin() {
  is_begun = true;
}
void SPIClass::beginTransaction(SPISettings) {}
uint8_t SPIClass::transfer(uint8_t byte) {
  want(is_begun && !is_high[kSelect]);
  wires::tell(is_high[kData] ? 'd' : 'c', &byte, 1);
  return 0;
}
