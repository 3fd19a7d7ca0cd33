/// Words over the UART, for messages of the port itself. Uses little stack and no variables.
#pragma once

#include <stdint.h>

namespace thimble {

void say(const char* text);
void say_decimal(uint32_t value);
/// 0x and 8 digits.
void say_hex(uint32_t value);

}  // namespace thimble
