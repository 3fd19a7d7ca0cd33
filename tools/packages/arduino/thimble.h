// What a sketch includes; the tour begins in thimble/thimble.h. Thimble @VERSION@
#ifndef THIMBLE_ARDUINO_H
#define THIMBLE_ARDUINO_H

#if !defined(__cplusplus) || __cplusplus < 201703L
#error "Thimble needs C++17: take a core that compiles with -std=gnu++17 or later (README.md names some)"
#elif defined(__AVR__)
#error "Thimble needs a chip of 32 bits; this one has 8"
#endif

#include "thimble/thimble.h"

#endif
