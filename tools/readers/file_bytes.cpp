#include "readers/file_bytes.h"

#include <algorithm>
#include <cmath>

namespace thimble::tools {
namespace {

/// IEEE 754's binary16: a sign, five bits of exponent, ten of fraction.
double half(unsigned bits) {
  const auto exponent = static_cast<int>(bits >> 10 & 31U);
  const double fraction = bits & 1023U;
  const double size = exponent == 31  ? (fraction == 0 ? HUGE_VAL : std::nan(""))
                      : exponent == 0 ? std::ldexp(fraction, -24)
                                      : std::ldexp(1024 + fraction, exponent - 25);
  return (bits & 0x8000U) != 0 ? -size : size;
}

}  // namespace

double load_any_number(const std::uint8_t* first, const NumberType& type, bool is_big_endian) {
  const std::uint64_t bits = load_bits(first, type.size_bytes, is_big_endian);
  if (type.kind == 'f') {
    return type.size_bytes == 2 ? half(static_cast<unsigned>(bits))
           : type.size_bytes == 4
               ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
               : std::bit_cast<double>(bits);
  }
  const std::size_t unused = 64 - 8 * type.size_bytes;
  return type.kind == 'i' ? static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused)
                          : static_cast<double>(bits);
}

std::span<const std::uint8_t> ByteReader::take(std::uint64_t count) {
  if (count > remaining()) {
    fail("truncated at byte offset ", offset(), ": ", count, " bytes are needed and ", remaining(),
         " are there");
  }
  const std::span<const std::uint8_t> taken = bytes_.subspan(next_, static_cast<std::size_t>(count));
  next_ += static_cast<std::size_t>(count);
  return taken;
}

void ByteReader::expect(std::string_view magic, const char* what) {
  tools::fail_if(remaining() < magic.size() || text(magic.size()) != magic, "is no ", what,
                 ": it does not begin with \"", magic, "\"");
}

ByteReader ByteReader::sub(std::uint64_t count, std::string_view place) {
  const std::uint64_t first_offset = offset();
  return ByteReader(take(count), place, first_offset);
}

std::string load_named(const std::string& path, std::string& name, std::uint64_t limit_bytes,
                       SharedBytes& file) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  std::string fault = load_beside(name.starts_with('/') ? name : folder + name, limit_bytes, file);
  if (const std::size_t last = name.rfind('/') + 1; !fault.empty() && last != 0) {
    name.erase(0, last);
    fault = load_beside(folder + name, limit_bytes, file).empty() ? "" : fault;
  }
  return fault;
}

}  // namespace thimble::tools
