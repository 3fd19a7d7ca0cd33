#ifndef STUB_ZEPHYR_PRINTK_H
#define STUB_ZEPHYR_PRINTK_H

extern "C" int putchar(int character);
/// Without its numbers.
[[gnu::format(printf, 1, 2)]] inline void printk(const char* text, ...) {
  while (*text != 0) {
    putchar(*text++);
  }
}

#endif
