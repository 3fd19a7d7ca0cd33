#include "host/terminal_input.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace thimble::host {
namespace {

constexpr char kEscapeByte = 0x1B;
constexpr std::size_t kLongestSequence = 64;  // what is longer without an end is noise

Event pressed(Key key) {
  return {.kind = EventKind::kKeyDown, .key = key};
}

Event typed(char32_t character) {
  return {.kind = EventKind::kText, .character = character};
}

Key key_of_final(char final) {
  constexpr std::string_view kFinals = "ABCDHFM";
  constexpr std::array kKeys{Key::kUp,   Key::kDown, Key::kRight, Key::kLeft,
                             Key::kHome, Key::kEnd,  Key::kEnter};  // the last is of the keypad, in SS3 form
  const std::size_t at = kFinals.find(final);
  return at < kKeys.size() ? kKeys[at] : Key::kNone;
}

Key key_of_number(std::int32_t number) {
  constexpr std::array kKeys{Key::kHome,   Key::kInsert,   Key::kDelete, Key::kEnd,
                             Key::kPageUp, Key::kPageDown, Key::kHome,   Key::kEnd};  // from 1 on
  const auto at = static_cast<std::size_t>(number) - 1;
  return at < kKeys.size() ? kKeys[at] : Key::kNone;
}

// The numbers between semicolons; one that is missing or none at all is -1.
std::array<std::int32_t, 3> numbers_of(std::string_view text) {
  std::array<std::int32_t, 3> numbers{-1, -1, -1};
  for (std::int32_t& number : numbers) {
    const std::string_view word = text.substr(0, text.find(';'));
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc{} && end == word.data() + word.size()) {
      number = value;
    }
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return numbers;
}

// Bytes of the UTF-8 character that starts with `first`; 0 when none does.
std::size_t utf8_bytes(unsigned char first) {
  if (first < 0x80) {
    return 1;
  }
  if (first >= 0xC2 && first < 0xE0) {
    return 2;
  }
  if (first >= 0xE0 && first < 0xF0) {
    return 3;
  }
  return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

std::optional<char32_t> utf8_character(std::string_view bytes) {
  const auto first = static_cast<unsigned char>(bytes[0]);
  char32_t character = bytes.size() == 1 ? first : first & (0xFFU >> (bytes.size() + 1));
  for (const char byte : bytes.substr(1)) {
    const auto value = static_cast<unsigned char>(byte);
    if ((value & 0xC0U) != 0x80U) {
      return std::nullopt;
    }
    character = character << 6 | (value & 0x3FU);
  }
  return character;
}

}  // namespace

void TerminalInput::take_mouse(std::string_view parameters, bool is_release, std::vector<Event>* events) {
  constexpr int kShift = 4;
  constexpr int kMotion = 32;
  constexpr int kWheel = 64;
  const auto [code, column, row] = numbers_of(parameters);
  if (code < 0 || column < 1 || row < 1) {
    return;
  }
  Event event;
  event.x_px = column - 1;
  event.y_px = row - 1;
  event.shift = (code & kShift) != 0;
  const int button = code & 3;
  if ((code & kWheel) != 0) {
    if (button > 1) {
      return;  // sideways
    }
    event.kind = EventKind::kWheel;
    event.steps = button == 0 ? 1 : -1;
  } else if ((code & kMotion) != 0) {
    event.kind = EventKind::kMouseMove;
    if (button == 3) {
      buttons_ = 0;  // a release that was not seen, outside the window
    }
  } else if (button == 3) {
    return;
  } else {
    event.kind = is_release ? EventKind::kMouseUp : EventKind::kMouseDown;
    event.button = static_cast<std::uint8_t>(button + 1);
    const unsigned bit = 1U << button;
    buttons_ = static_cast<std::uint8_t>(is_release ? buttons_ & ~bit : buttons_ | bit);
  }
  event.buttons = buttons_;
  events->push_back(event);
}

void TerminalInput::take_csi(std::string_view parameters, char final, std::vector<Event>* events) {
  if (!parameters.empty() && parameters.front() == '<' && (final == 'M' || final == 'm')) {
    take_mouse(parameters.substr(1), final == 'm', events);
    return;
  }
  Key key = key_of_final(final);
  if (final == '~') {
    key = key_of_number(numbers_of(parameters)[0]);
  } else if (final == 'Z') {
    key = Key::kTab;
  } else if (final == 'M') {
    key = Key::kNone;
  }
  if (key != Key::kNone) {
    events->push_back(pressed(key));
  }
}

// `bytes` starts with an escape. The bytes that were used; 0 when the end is missing.
std::size_t TerminalInput::take_escape(std::string_view bytes, std::vector<Event>* events) {
  if (bytes.size() < 2) {
    return 0;
  }
  if (bytes[1] == 'O') {
    if (bytes.size() < 3) {
      return 0;
    }
    if (const Key key = key_of_final(bytes[2]); key != Key::kNone) {
      events->push_back(pressed(key));
    }
    return 3;
  }
  if (bytes[1] != '[') {
    // The escape key, or a key with Alt; the second byte is looked at for itself.
    events->push_back(pressed(Key::kEscape));
    return 1;
  }
  for (std::size_t i = 2; i < bytes.size(); ++i) {
    const char byte = bytes[i];
    if (byte >= 0x40 && byte <= 0x7E) {
      take_csi(bytes.substr(2, i - 2), byte, events);
      return i + 1;
    }
    if (byte < 0x20 || i >= kLongestSequence) {
      return i;  // broken off
    }
  }
  return 0;
}

std::size_t TerminalInput::take_one(std::string_view bytes, std::vector<Event>* events) {
  const char first = bytes[0];
  if (first == kEscapeByte) {
    return take_escape(bytes, events);
  }
  if (first == '\r' || first == '\n') {
    events->push_back(pressed(Key::kEnter));
    events->push_back(typed('\r'));
    return 1;
  }
  if (first == 0x7F || first == '\b') {
    events->push_back(pressed(Key::kBackspace));
    events->push_back(typed('\b'));
    return 1;
  }
  const std::size_t length = utf8_bytes(static_cast<unsigned char>(first));
  if (length == 0) {
    return 1;
  }
  if (bytes.size() < length) {
    return 0;
  }
  const auto character = utf8_character(bytes.substr(0, length));
  if (!character) {
    return 1;
  }
  if (first == '\t') {
    events->push_back(pressed(Key::kTab));
  } else if (*character >= 0x20 && *character < 0x7F) {
    events->push_back(pressed(key_of(first)));
  }
  events->push_back(typed(*character));
  return length;
}

void TerminalInput::take(std::string_view bytes, std::vector<Event>* events) {
  pending_ += bytes;
  std::string_view left = pending_;
  while (!left.empty()) {
    const std::size_t used = take_one(left, events);
    if (used == 0) {
      break;
    }
    left.remove_prefix(used);
  }
  pending_ = std::string(left);
}

void TerminalInput::settle(std::vector<Event>* events) {
  if (pending_ == std::string_view(&kEscapeByte, 1)) {
    events->push_back(pressed(Key::kEscape));
  }
  pending_.clear();
}

}  // namespace thimble::host
