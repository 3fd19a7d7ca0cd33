#include "viewer/keys.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace thimble::tools::viewer {
namespace {

using host::Key;
using host::key_of;

constexpr std::array kFlights{
    Flight{key_of('w'), 0, 0, 1}, Flight{key_of('a'), -1, 0, 0}, Flight{key_of('s'), 0, 0, -1},
    Flight{key_of('d'), 1, 0, 0}, Flight{Key::kUp, 0, 0, 1},     Flight{Key::kLeft, -1, 0, 0},
    Flight{Key::kDown, 0, 0, -1}, Flight{Key::kRight, 1, 0, 0},
};
constexpr std::array kLifts{Flight{Key::kPageUp, 0, 1, 0}, Flight{Key::kPageDown, 0, -1, 0}};
constexpr std::array kViews{Typed{'1', Action::kFront}, Typed{'2', Action::kBack}, Typed{'3', Action::kLeft},
                            Typed{'4', Action::kRight}, Typed{'5', Action::kTop},  Typed{'6', Action::kIso}};
constexpr std::array kFirst{Typed{'0', Action::kFirstView}};
constexpr std::array kSave{Typed{'s', Action::kSave}};
constexpr std::array kPick{Typed{'p', Action::kPick}};
constexpr std::array kPlay{Typed{' ', Action::kPlay}};
constexpr std::array kHelp{Typed{'?', Action::kHelp}};
constexpr std::array kEnd{Typed{'q', Action::kEnd}, Typed{'\x1b', Action::kEnd}};

const std::array kRows{
    KeyRow{"drag", "turns around the model", {}, {}},
    KeyRow{"right or shift drag", "moves", {}, {}},
    KeyRow{"wheel", "nearer, farther", {}, {}},
    KeyRow{"double click", "looks at what is there", {}, {}},
    KeyRow{"W A S D, arrows", "fly while held", {}, kFlights},
    KeyRow{"Page Up, Page Down", "fly up, down", {}, kLifts},
    KeyRow{"1 2 3 4 5 6", "front, back, left, right, top, iso", kViews, {}},
    KeyRow{"0", "the view at first", kFirst, {}},
    KeyRow{"s (tapped)", "saves the picture, prints its render command", kSave, {}},
    KeyRow{"p", "names what is under the pointer", kPick, {}},
    KeyRow{"space", "plays frames or water, or stops", kPlay, {}},
    KeyRow{"?", "shows these keys, or hides them", kHelp, {}},
    KeyRow{"Esc, q", "end", kEnd, {}},
};

}  // namespace

std::span<const KeyRow> key_rows() {
  return kRows;
}

Action action_of(char32_t character) {
  for (const KeyRow& row : kRows) {
    for (const Typed& typed : row.typed) {
      if (static_cast<unsigned char>(typed.character) == character) {
        return typed.action;
      }
    }
  }
  return Action::kNone;
}

const Flight* flight_of(Key key) {
  for (const KeyRow& row : kRows) {
    for (const Flight& flight : row.flights) {
      if (flight.key == key) {
        return &flight;
      }
    }
  }
  return nullptr;
}

std::string keys_text() {
  std::size_t width = 0;
  for (const KeyRow& row : kRows) {
    width = std::max(width, std::string_view(row.input).size());
  }
  std::string text;
  for (const KeyRow& row : kRows) {
    std::string input = row.input;
    input.resize(width + 2, ' ');
    text += (text.empty() ? "" : "\n") + input + row.does;
  }
  return text;
}

std::string keys_sentence() {
  std::string text;
  for (const KeyRow& row : kRows) {
    text += std::string(text.empty() ? "" : "; ") + row.input + ": " + row.does;
  }
  return text;
}

}  // namespace thimble::tools::viewer
