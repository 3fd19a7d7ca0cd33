/// @file result_crc.h
/// What the portable cases compute, as CRC-32s (runner.h). Written by `thimble_golden_tests --crc`.
#ifndef THIMBLE_TESTS_PORTABLE_RESULT_CRC_H
#define THIMBLE_TESTS_PORTABLE_RESULT_CRC_H

#include <stdint.h>

namespace thimble::portable {

/// Of all cases, and of those that every board runs.
inline constexpr uint32_t kResultCrc32 = 0xAA048EF7;
inline constexpr uint32_t kCommonResultCrc32 = 0x87269F0A;

}  // namespace thimble::portable

#endif
