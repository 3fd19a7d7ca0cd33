#include "thimble/crc32.h"

namespace thimble {
namespace {

struct NibbleTable {
  uint32_t entry[16];
};

constexpr NibbleTable make_table() {
  NibbleTable table{};
  for (uint32_t nibble = 0; nibble < 16; ++nibble) {
    uint32_t value = nibble;
    for (int bit = 0; bit < 4; ++bit) {
      value = (value >> 1) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    table.entry[nibble] = value;
  }
  return table;
}
constexpr NibbleTable kTable = make_table();

}  // namespace

uint32_t crc32(ConstBytes bytes, uint32_t previous) {
  uint32_t crc = ~previous;
  for (const uint8_t byte : bytes) {
    crc ^= byte;
    crc = (crc >> 4) ^ kTable.entry[crc & 15U];
    crc = (crc >> 4) ^ kTable.entry[crc & 15U];
  }
  return ~crc;
}

}  // namespace thimble
