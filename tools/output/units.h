/// Numbers as a person reads and writes them.
#pragma once

#include <cstdint>
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

/// Writes `number` in 4 bytes, the lowest first.
template <class Byte>
void put_little(Byte* to, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) {
    to[i] = static_cast<Byte>(number >> (8 * i));
  }
}

/// A CRC-32 as 8 hex digits.
std::string crc_text(std::uint32_t crc);

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

}  // namespace thimble::tools
