#include "Arduino.h"

HardwareSerial Serial;

void HardwareSerial::println(const char* text) {
  while (*text != 0) {
    putchar(*text++);
  }
  putchar('\n');
}

// An example waits only when it has given up.
void delay(unsigned long) {
  exit(1);
}

int main() {
  setup();
  for (;;) {
    loop();
  }
}
