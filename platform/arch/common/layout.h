/// Where the linker script (firmware.ld.in) put things. Only the addresses of these symbols mean anything.
#pragma once

#include <stdint.h>

extern "C" {
extern uint8_t thimble_stack_bottom[];  ///< also the start of the RAM
extern uint8_t thimble_stack_top[];
extern uint8_t thimble_stack_bytes[];  ///< its address is the size of the stack
extern uint32_t thimble_data_start[];  ///< initialised variables in RAM, whole words
extern uint32_t thimble_data_end[];
extern const uint32_t thimble_data_image[];  ///< and what they start with, in flash
extern uint32_t thimble_bss_start[];         ///< variables that start as 0
extern uint32_t thimble_bss_end[];
extern uint8_t thimble_arena_start[];  ///< the rest of the RAM
extern uint8_t thimble_arena_end[];    ///< also the end of the RAM
}
