#include "output/units.h"

#include <array>
#include <charconv>
#include <cstdio>

namespace thimble::tools {

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

std::string crc_text(std::uint32_t crc) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", static_cast<unsigned>(crc));
  return text.data();
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x20 || code == 0x7F) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\x%02x", static_cast<unsigned>(code));
      out += escape.data();
    } else {
      out += letter;
    }
  }
  return out;
}

std::string scene_title(std::string_view scene) {
  const std::size_t slash = scene.rfind('/');
  return printable(slash == std::string_view::npos || slash + 1 == scene.size() ? scene
                                                                                : scene.substr(slash + 1));
}

std::string in_quotes(std::string_view text) {
  return '"' + printable(text) + '"';
}

}  // namespace thimble::tools
