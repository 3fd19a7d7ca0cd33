/// Numbers and words as a person reads and writes them.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "output/concat.h"

namespace thimble::tools {

/// 48000000 as "48,000,000".
std::string grouped(std::uint64_t number);
/// "1 voxel", "48,000 voxels"; `many` where that is more than an s behind `one`.
std::string counted(std::uint64_t number, const std::string& one, const std::string& many = {});

/// "65536", "64K", "2M", "1G" (powers of 1024, either case, an optional B or iB after the letter) as bytes;
/// nothing for anything else and for what exceeds 2^63 - 1.
std::optional<std::uint64_t> parse_bytes(std::string_view text);

/// The number that is all of `text`, whatever the locale says; of whole ones to that base.
template <class Number, class... Base>
std::optional<Number> number_in(std::string_view text, Base... base) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number, base...);
  return error == std::errc{} && next == end ? std::optional(number) : std::nullopt;
}

/// A double with the fewest digits up to 17 significant ones that read back as the same double.
std::string shortest(double number);

/// A number with so many digits behind the point.
std::string fixed(double value, int digits);
/// How many per cent of `whole` a part is, with two digits behind the point; of nothing "0.00".
std::string percent(std::uint64_t part, std::uint64_t whole);

/// The words one after the other with `between` between them.
std::string joined(const std::vector<std::string>& words, std::string_view between);
/// Whether a name ends in `ending`, which is in small letters, in any case, with more before it.
bool ends_in(std::string_view name, std::string_view ending);
/// The kind whose place among `endings` that of the name's ending is, if any.
template <class Kind>
std::optional<Kind> kind_by_ending(std::string_view name, std::initializer_list<std::string_view> endings) {
  const auto* const found = std::find_if(endings.begin(), endings.end(),
                                         [&](std::string_view ending) { return ends_in(name, ending); });
  return found == endings.end() ? std::nullopt : std::optional(static_cast<Kind>(found - endings.begin()));
}

/// Writes `number` in so many bytes, the lowest first.
template <class Byte>
void put_little(Byte* to, std::uint64_t number, std::size_t count = 4) {
  for (std::size_t i = 0; i < count; ++i) {
    to[i] = static_cast<Byte>(number >> (8 * i));
  }
}
/// The same behind a text.
inline void append_little(std::string* to, std::uint64_t number, std::size_t count = 4) {
  to->resize(to->size() + count);
  put_little(to->data() + to->size() - count, number, count);
}

/// A number as so many hex digits.
std::string hex_text(std::uint32_t number, int digits);
/// A CRC-32 as 8 of them.
std::string crc_text(std::uint32_t crc);
/// r, g, b as "#0072b2".
inline std::string color_text(const std::uint8_t* rgb) {
  return '#' + hex_text(static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]), 6);
}

/// `text` for a sentence on a terminal: control characters, line feeds too, as \xNN, so that a file's name
/// can neither break the sentence nor steer the terminal. UTF-8 stays as it is.
std::string printable(std::string_view text);
/// Bytes of the character of UTF-8 that `text`, which is not empty, begins with, and which becomes `code`; 0 where it
/// begins with none.
std::size_t character_bytes(std::string_view text, unsigned* code);
/// `text` as UTF-8: a byte that is none, and with `for_xml` what is no character of XML, becomes U+FFFD.
std::string utf8_text(std::string_view text, bool for_xml = false);
/// A scene for the title of a plot: of a path the file's name alone, printable.
std::string scene_title(std::string_view scene);
/// The same in double quotes.
std::string in_quotes(std::string_view text);

/// " (did you mean render?)": the one of `words` that somebody who typed `word` most likely meant. At most a third of
/// its letters are missing, too many, wrong or swapped with their neighbour; where there is none, nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& words);

}  // namespace thimble::tools
