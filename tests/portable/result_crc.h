/// @file result_crc.h
/// What the portable cases compute, as CRC-32s (runner.h). Written by `thimble_golden_tests --crc`.
#ifndef THIMBLE_TESTS_PORTABLE_RESULT_CRC_H
#define THIMBLE_TESTS_PORTABLE_RESULT_CRC_H

#include <stdint.h>

namespace thimble::portable {

inline constexpr uint32_t kResultCrc32 = 0x00000000;        ///< of all cases
inline constexpr uint32_t kCommonResultCrc32 = 0x00000000;  ///< of those that every board runs

}  // namespace thimble::portable

#endif
