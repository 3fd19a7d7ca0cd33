#include "readers/file_bytes.h"

#include <bit>

namespace thimble::tools {

std::span<const std::uint8_t> ByteReader::take(std::uint64_t count) {
  if (count > remaining()) {
    fail("truncated at byte offset " + std::to_string(offset()) + ": " + std::to_string(count) +
         " bytes are needed and " + std::to_string(remaining()) + " are there");
  }
  const std::span<const std::uint8_t> taken = bytes_.subspan(next_, static_cast<std::size_t>(count));
  next_ += static_cast<std::size_t>(count);
  return taken;
}

ByteReader ByteReader::sub(std::uint64_t count, std::string_view place) {
  const std::uint64_t first_offset = offset();
  return ByteReader(take(count), place, first_offset);
}

void ByteReader::fail(const std::string& sentence) const {
  throw InputError(place_ + ": " + sentence);
}

std::uint64_t ByteReader::little(std::size_t count) {
  std::uint64_t value = 0;
  int shift = 0;
  for (const std::uint8_t byte : take(count)) {
    value |= std::uint64_t{byte} << shift;
    shift += 8;
  }
  return value;
}

std::uint64_t ByteReader::big(std::size_t count) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : take(count)) {
    value = (value << 8) | byte;
  }
  return value;
}

float ByteReader::f32() {
  return std::bit_cast<float>(u32());
}
double ByteReader::f64() {
  return std::bit_cast<double>(u64());
}
float ByteReader::f32_be() {
  return std::bit_cast<float>(u32_be());
}
double ByteReader::f64_be() {
  return std::bit_cast<double>(u64_be());
}

}  // namespace thimble::tools
