#include "Arduino.h"
#include "wires.h"

HardwareSerial Serial;

void HardwareSerial::println(const char* text) {
  while (*text != 0) {
    putchar(*text++);
  }
  putchar('\n');
}

// An example waits a second only when it has given up.
void delay(unsigned long ms) {
  wires::wait(static_cast<uint32_t>(ms));
}

int main() {
  setup();
  for (;;) {
    loop();
  }
}
