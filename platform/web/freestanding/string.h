// What the table of boards asks of a C library, for a module that has none.
#pragma once

inline int strcmp(const char* one, const char* other) {
  for (; *one != '\0' && *one == *other; ++one, ++other) {
  }
  return static_cast<unsigned char>(*one) - static_cast<unsigned char>(*other);
}
