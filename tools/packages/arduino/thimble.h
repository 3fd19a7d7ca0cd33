// What a sketch includes; the tour begins in thimble/thimble.h. Thimble @VERSION@
#ifndef THIMBLE_ARDUINO_H
#define THIMBLE_ARDUINO_H

#if defined(__AVR__)
#error "AVR is not supported: int has 16 bits. Thimble needs a chip of 32 bits."
#elif !defined(__cplusplus) || __cplusplus < 201703L
#error "Thimble needs C++17: take a core that compiles with -std=gnu++17 or later (README.md names some)"
#endif

#include "thimble/thimble.h"

#endif
