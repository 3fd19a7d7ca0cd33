#include "output/units.h"

#include <array>
#include <cstdio>

namespace thimble::tools {

std::size_t character_bytes(std::string_view text, unsigned* code) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned first = byte(0);
  *code = first;
  if (first < 0x80) {
    return 1;
  }
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || bytes > text.size()) {
    return 0;
  }
  *code = first & (0x7FU >> bytes);
  for (std::size_t at = 1; at < bytes; ++at) {
    if ((byte(at) & 0xC0U) != 0x80U) {
      return 0;
    }
    *code = *code << 6 | (byte(at) & 0x3FU);
  }
  // Characters have one spelling, surrogates are none, and the last is U+10FFFF.
  constexpr std::array<unsigned, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = *code >= 0xD800 && *code < 0xE000;
  return *code < kLeast[bytes] || *code > 0x10FFFF || is_surrogate ? 0 : bytes;
}

namespace {

bool is_of_xml(unsigned code) {
  return code < 0x20 ? code == '\t' || code == '\n' || code == '\r' : code != 0xFFFE && code != 0xFFFF;
}

// Letters to add, leave out, change or swap with their neighbour, to get from one word to the other (the
// optimal string alignment distance).
std::size_t typing_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before;
  std::vector<std::size_t> last;
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before = std::move(last);
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (from[i - 1] == to[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row[to.size()];
}

}  // namespace

std::string utf8_text(std::string_view text, bool for_xml) {
  std::string utf8;
  while (!text.empty()) {
    unsigned code = 0;
    const std::size_t bytes = character_bytes(text, &code);
    const bool is_kept = bytes != 0 && (!for_xml || is_of_xml(code));
    utf8 += is_kept ? text.substr(0, bytes) : std::string_view("\xEF\xBF\xBD");
    text.remove_prefix(is_kept ? bytes : 1);
  }
  return utf8;
}

std::string counted(std::uint64_t number, const std::string& one, const std::string& many) {
  return grouped(number) + " " + (number == 1 ? one : many.empty() ? one + "s" : many);
}

std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) {
    text.insert(at - 3, 1, ',');
  }
  return text;
}

std::optional<std::uint64_t> parse_bytes(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) {
    return std::nullopt;
  }
  std::string_view unit = text.substr(static_cast<std::size_t>(end - text.data()));
  int shift = 0;
  if (!unit.empty()) {
    constexpr std::string_view kLetters = "kKmMgG";
    const std::size_t letter = kLetters.find(unit.front());
    if (letter != std::string_view::npos) {
      shift = 10 * (static_cast<int>(letter) / 2 + 1);
      unit.remove_prefix(1);
    }
    if (!unit.empty() && unit != "B" && !(shift != 0 && unit == "iB")) {
      return std::nullopt;
    }
  }
  if (number > (std::uint64_t{INT64_MAX} >> shift)) {
    return std::nullopt;
  }
  return number << shift;
}

std::string shortest(double number) {
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} ? std::string(text.data(), end) : std::string();
}

std::string fixed(double value, int digits) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return fixed(whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole), 2);
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    text += text.empty() ? "" : between;
    text += word;
  }
  return text;
}

bool ends_in(std::string_view name, std::string_view ending) {
  return name.size() > ending.size() &&
         std::equal(ending.rbegin(), ending.rend(), name.rbegin(),
                    [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

std::string hex_text(std::uint32_t number, int digits) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%0*x", digits, static_cast<unsigned>(number));
  return text.data();
}

std::string crc_text(std::uint32_t crc) {
  return hex_text(crc, 8);
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    out += code < 0x20 || code == 0x7F ? "\\x" + hex_text(code, 2) : std::string(1, letter);
  }
  return out;
}

std::string scene_title(std::string_view scene) {
  const std::string_view name = scene.substr(scene.rfind('/') + 1);
  return printable(name.empty() ? scene : name);
}

std::string in_quotes(std::string_view text) {
  return '"' + printable(text) + '"';
}

std::string suggestion(std::string_view word, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance = typing_distance(word, candidate);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

}  // namespace thimble::tools
