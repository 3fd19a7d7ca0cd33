// Counting bits, spreading them, and reading little-endian words: the few machine-near operations of the
// core, in one place. Internal to src/.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace thimble::bits {

// Set bits of one byte. Without an instruction for it: four copies of the byte, 9 bits apart, bring each of
// its bits to the lowest place of a nibble of its own; the second product adds the nibbles up in the highest.
constexpr unsigned popcount8(unsigned byte) {
#if defined(__POPCNT__)
  return static_cast<unsigned>(__builtin_popcount(byte));
#else
  return ((byte * 0x08040201U >> 3 & 0x11111111U) * 0x11111111U) >> 28;
#endif
}

constexpr unsigned popcount32(uint32_t word) {
#if defined(__POPCNT__)
  return static_cast<unsigned>(__builtin_popcount(word));
#else
  word = word - ((word >> 1) & 0x55555555U);
  word = (word & 0x33333333U) + ((word >> 2) & 0x33333333U);
  return (((word + (word >> 4)) & 0x0F0F0F0FU) * 0x01010101U) >> 24;
#endif
}

// Index of the highest set bit of `word`, which is not 0.
constexpr int highest_bit(uint32_t word) {
  return 31 - __builtin_clz(word);
}

// Whether an instruction counts leading zeros.
#if (defined(__arm__) && !defined(__ARM_FEATURE_CLZ)) || (defined(__riscv) && !defined(__riscv_zbb))
constexpr bool kCountsZeros = false;
#else
constexpr bool kCountsZeros = true;
#endif

// A number of 32 bits whose runs of five bits all differ, and where each run lies in it.
constexpr uint32_t kRuns = 0x077CB531U;
constexpr uint8_t kPlaceOfRun[32] = {0,  1,  28, 2,  29, 14, 24, 3, 30, 22, 20, 15, 25, 17, 4,  8,
                                     31, 27, 13, 23, 21, 19, 16, 7, 26, 12, 18, 6,  11, 5,  10, 9};

// Index of the lowest set bit of `word`, which is not 0.
constexpr unsigned lowest_bit(uint32_t word) {
#if defined(__ARM_ARCH_4T__) && !defined(__thumb__)
  // In place of a call; no step has a branch.
  unsigned bit = 0;
#pragma GCC unroll 5
  for (unsigned step = 16; step != 0; step >>= 1) {
    if ((word & ((1U << step) - 1)) == 0) {
      word >>= step;
      bit += step;
    }
  }
  return bit;
#else
  return kCountsZeros ? static_cast<unsigned>(__builtin_ctz(word))
                      : kPlaceOfRun[((word & (0U - word)) * kRuns) >> 27];
#endif
}

// Number of bits needed to write `value`: 0 for 0.
constexpr int bit_length(uint32_t value) {
  return value == 0 ? 0 : highest_bit(value) + 1;
}

// Little-endian words at any address; the compiler turns these into single loads where the machine is little-endian and
// allows unaligned ones.
inline uint32_t load32(const uint8_t* bytes) {
  return static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8 |
         static_cast<uint32_t>(bytes[2]) << 16 | static_cast<uint32_t>(bytes[3]) << 24;
}
inline uint64_t load64(const uint8_t* bytes) {
  return static_cast<uint64_t>(load32(bytes)) | static_cast<uint64_t>(load32(bytes + 4)) << 32;
}
inline uint32_t load16(const uint8_t* bytes) {
  return static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8;
}
inline void store16(uint8_t* bytes, uint32_t value) {
  bytes[0] = static_cast<uint8_t>(value);
  bytes[1] = static_cast<uint8_t>(value >> 8);
}
inline void store32(uint8_t* bytes, uint32_t value) {
  store16(bytes, value & 0xFFFFU);
  store16(bytes + 2, value >> 16);
}
inline void store64(uint8_t* bytes, uint64_t value) {
  store32(bytes, static_cast<uint32_t>(value));
  store32(bytes + 4, static_cast<uint32_t>(value >> 32));
}

// Little-endian words at multiples of their size, which one instruction loads or stores: those of a brick map, pixels of
// two bytes. `little` turns a word from memory round on a big-endian machine, or one for memory; on others it is nothing.
constexpr bool kBigEndian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
using Half [[gnu::may_alias]] = uint16_t;
using Word [[gnu::may_alias]] = uint32_t;

constexpr uint8_t little(uint8_t byte) {
  return byte;
}
constexpr uint16_t little(uint16_t half) {
  return kBigEndian ? __builtin_bswap16(half) : half;
}
constexpr uint32_t little(uint32_t word) {
  return kBigEndian ? __builtin_bswap32(word) : word;
}

}  // namespace thimble::bits
