/// @file crc32.h
/// CRC-32 as zlib, PNG and Ethernet compute it (polynomial 0xEDB88320, reflected, inverted in and out).
#ifndef THIMBLE_BASE_CRC32_H
#define THIMBLE_BASE_CRC32_H

#include <stdint.h>

#include "memory.h"

namespace thimble {

/// CRC-32 of `bytes` following `previous` (0 to begin): `crc32(b, crc32(a))` is that of a followed by b.
/// A 16-entry table of 64 bytes in flash; about 15 instructions a byte.
uint32_t crc32(ConstBytes bytes, uint32_t previous = 0);

}  // namespace thimble

#endif
