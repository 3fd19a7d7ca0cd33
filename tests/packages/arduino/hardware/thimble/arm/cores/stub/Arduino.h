// What a sketch finds before its first line: a core's macros (arduino_macros.h of tests/checks lies beside this), and the
// few functions that the examples call.
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stddef.h>
#include <stdint.h>

#include "arduino_macros.h"
#include "binary.h"

void setup();
void loop();
void delay(unsigned long ms);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
extern "C" int putchar(int character);
extern "C" [[noreturn]] void exit(int status);

struct HardwareSerial {
  void begin(unsigned long) {}
  void println(const char* text);
};
extern HardwareSerial Serial;

#endif
