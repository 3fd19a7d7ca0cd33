/// The pieces that `.vox` chunks are made of: names, strings and dictionaries. Internal to the `.vox` reader.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "readers/file_bytes.h"

namespace thimble::tools {

/// "XYZI chunk at byte offset 44": the place that errors name. Bytes of an id that do not print become `?`.
inline std::string vox_place(std::string_view id, std::uint64_t offset) {
  std::string place;
  for (const char letter : id) {
    place += letter >= ' ' && letter <= '~' ? letter : '?';
  }
  return place + " chunk at byte offset " + std::to_string(offset);
}

/// A string: its length in bytes as 32 bits, then the bytes.
inline std::string_view vox_string(ByteReader& reader) {
  return reader.text(reader.u32());
}

/// A dictionary: the number of entries, then a key and a value each. Calls `entry(key, value)` for each; the
/// count is not trusted, each string must be there.
template <class Entry>
void vox_dictionary(ByteReader& reader, const Entry& entry) {
  const std::uint32_t count = reader.u32();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view key = vox_string(reader);
    const std::string_view value = vox_string(reader);
    entry(key, value);
  }
}

/// The number that is all of `text`, or nothing. Independent of the locale.
template <class Number>
std::optional<Number> vox_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return number;
}

}  // namespace thimble::tools
