/// @file keys.h
/// What keys and mouse do in the viewer: one table, from which the viewer hears, `?` shows and --help tells.
#ifndef THIMBLE_TOOLS_VIEWER_KEYS_H
#define THIMBLE_TOOLS_VIEWER_KEYS_H

#include <cstdint>
#include <span>
#include <string>

#include "host/screen.h"

namespace thimble::tools::viewer {

enum class Action : std::uint8_t {
  kNone,
  kEnd,
  kHelp,
  kPlay,  ///< or no longer
  kSave,
  kPick,
  kLookThere,
  kFirstView,  ///< as the picture was framed at first
  kFront,
  kBack,
  kLeft,
  kRight,
  kTop,
  kIso,
};

/// Where a key flies while it is held; along the picture's axes.
struct Flight {
  host::Key key;
  std::int8_t right;
  std::int8_t up;
  std::int8_t forward;
};

/// A typed character and what it asks for.
struct Typed {
  char character;
  Action action;
};

/// A line of the table: what it is called, and what it does.
struct KeyRow {
  const char* input;
  const char* does;
  std::span<const Typed> typed;
  std::span<const Flight> flights;
};
std::span<const KeyRow> key_rows();

/// What a typed character asks for.
Action action_of(char32_t character);
/// What a key flies, or null.
const Flight* flight_of(host::Key key);

/// The table as lines, inputs in a column of their own.
std::string keys_text();
/// The table as a sentence for --help.
std::string keys_sentence();

}  // namespace thimble::tools::viewer

#endif
