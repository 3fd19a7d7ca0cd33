#include "commands/key_script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <utility>

#include "output/units.h"
#include "port.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::array<std::pair<std::string_view, std::uint32_t>, 5> kButtons{{{"up", port::kUp},
                                                                              {"down", port::kDown},
                                                                              {"left", port::kLeft},
                                                                              {"right", port::kRight},
                                                                              {"select", port::kSelect}}};
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
    if (const std::size_t plain = kEscapes.find(kind); plain != std::string_view::npos) {
      bytes += kEscaped[plain];
      continue;
    }
    fail_if(kind != 'x', "a backslash is not followed by n, r, t, x or another one");
    const std::string_view digits = text.substr(i + 1, 2);
    const auto value = number_in<unsigned>(digits, 16);
    fail_if(!value || digits.size() != 2, "\\x is not followed by two hexadecimal digits");
    bytes += static_cast<char>(*value);
    i += 2;
  }
  return bytes;
}

std::uint32_t buttons_of(std::string_view text) {
  std::uint32_t buttons = 0;
  while (!trimmed(text).empty()) {
    const std::string_view word = take_word(text);
    const auto* const found = std::find_if(kButtons.begin(), kButtons.end(),
                                           [&](const auto& button) { return button.first == word; });
    fail_if(found == kButtons.end(), in_quotes(word), " is not up, down, left, right or select");
    buttons |= found->second;
  }
  fail_if(buttons == 0, "a button is missing: up, down, left, right or select");
  return buttons;
}

KeyScript::Step step_of(std::string_view line) {
  const std::size_t colon = line.find(':');
  const std::string_view number = trimmed(line.substr(0, colon));
  KeyScript::Step step;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), step.frame);
  fail_if(error == std::errc::result_out_of_range, "frame ", number, " is beyond ",
          std::numeric_limits<std::uint32_t>::max(), ", the last");
  fail_if(colon == std::string_view::npos || error != std::errc{} || end != number.data() + number.size(),
          "a line is FRAME: down|up BUTTON... or FRAME: type TEXT");
  std::string_view rest = line.substr(colon + 1);
  const std::string_view verb = take_word(rest);
  if (verb == "down") {
    step.press = buttons_of(rest);
  } else if (verb == "up") {
    step.release = buttons_of(rest);
  } else if (verb == "type") {
    step.typed = unescaped(trimmed(rest));
  } else {
    fail_if(true, in_quotes(verb), " is not down, up or type");
  }
  return step;
}

}  // namespace

KeyScript::KeyScript(std::string_view text) {
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || trimmed(line).front() == '#') {
      continue;
    }
    try {
      steps_.push_back(step_of(line));
    } catch (const InputError& error) {
      throw InputError("line ", lines.line_number(), ": ", error.what());
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

}  // namespace thimble::tools
