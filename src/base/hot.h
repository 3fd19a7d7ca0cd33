// What a small RAM of the core's own holds (BOARD_FAST_RAM_BYTES): functions marked THIMBLE_HOT, each out of line. They
// save the most cycles a byte in pictures of the valley. Internal to src/.
#pragma once

#ifdef THIMBLE_FAST_RAM
#define THIMBLE_HOT gnu::noinline, gnu::hot
#else
#define THIMBLE_HOT
#endif
