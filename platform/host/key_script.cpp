#include "host/key_script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <utility>

#include "port.h"

namespace thimble::host {
namespace {

constexpr std::array<std::pair<std::string_view, std::uint32_t>, 5> kButtons{{{"up", port::kUp},
                                                                              {"down", port::kDown},
                                                                              {"left", port::kLeft},
                                                                              {"right", port::kRight},
                                                                              {"select", port::kSelect}}};
constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Cuts the first word off.
std::string_view take_word(std::string_view* text) {
  *text = trimmed(*text);
  const std::string_view word = text->substr(0, text->find_first_of(kBlank));
  *text = trimmed(text->substr(word.size()));
  return word;
}

std::string in_quotes(std::string_view text) {
  return "\"" + std::string(text) + "\"";
}

std::string unescaped(std::string_view text) {
  constexpr std::string_view kEscapes = "nrt\\";
  constexpr std::string_view kEscaped = "\n\r\t\\";
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
      continue;
    }
    const char kind = ++i < text.size() ? text[i] : '\0';
    unsigned value = 0;
    if (const std::size_t plain = kEscapes.find(kind); plain != std::string_view::npos) {
      bytes += kEscaped[plain];
    } else if (kind != 'x') {
      throw KeyScriptError("a backslash is not followed by n, r, t, x or another one");
    } else if (i + 2 < text.size() &&
               std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16).ptr ==
                   text.data() + i + 3) {
      bytes += static_cast<char>(value);
      i += 2;
    } else {
      throw KeyScriptError("\\x is not followed by two hexadecimal digits");
    }
  }
  return bytes;
}

std::uint32_t buttons_of(std::string_view text) {
  std::uint32_t buttons = 0;
  while (!text.empty()) {
    const std::string_view word = take_word(&text);
    const auto* const found = std::find_if(kButtons.begin(), kButtons.end(),
                                           [&](const auto& button) { return button.first == word; });
    if (found == kButtons.end()) {
      throw KeyScriptError(in_quotes(word) + " is not up, down, left, right or select");
    }
    buttons |= found->second;
  }
  if (buttons == 0) {
    throw KeyScriptError("a button is missing: up, down, left, right or select");
  }
  return buttons;
}

KeyScript::Step step_of(std::string_view line) {
  const std::size_t colon = line.find(':');
  const std::string_view number = trimmed(line.substr(0, colon));
  KeyScript::Step step;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), step.frame);
  if (error == std::errc::result_out_of_range) {
    throw KeyScriptError("frame " + std::string(number) + " is beyond " +
                         std::to_string(std::numeric_limits<std::uint32_t>::max()) + ", the last");
  }
  if (colon == std::string_view::npos || error != std::errc{} || end != number.data() + number.size()) {
    throw KeyScriptError("a line is FRAME: down|up BUTTON... or FRAME: type TEXT");
  }
  std::string_view rest = line.substr(colon + 1);
  const std::string_view verb = take_word(&rest);
  if (verb == "down") {
    step.press = buttons_of(rest);
  } else if (verb == "up") {
    step.release = buttons_of(rest);
  } else if (verb == "type") {
    step.typed = unescaped(rest);
  } else {
    throw KeyScriptError(in_quotes(verb) + " is not down, up or type");
  }
  return step;
}

}  // namespace

KeyScript::KeyScript(std::string_view text) {
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (trimmed(line).empty() || trimmed(line).front() == '#') {
      continue;
    }
    try {
      steps_.push_back(step_of(line));
    } catch (const KeyScriptError& error) {
      throw KeyScriptError("line " + std::to_string(number) + ": " + error.what());
    }
  }
  std::stable_sort(steps_.begin(), steps_.end(),
                   [](const Step& one, const Step& other) { return one.frame < other.frame; });
}

std::vector<KeyScript::Step> KeyScript::take(std::uint32_t frame) {
  std::vector<Step> taken;
  while (next_ < steps_.size() && steps_[next_].frame <= frame) {
    taken.push_back(steps_[next_++]);
  }
  return taken;
}

}  // namespace thimble::host
