/// @file input_script.h
/// What a hand did with mouse and keys, as text: recorded, written by hand, and played again.
///
///     # a line that begins with # is a comment
///     0: key 5
///     10: press left 400,300
///     11: move 420,310
///     30: release left 420,310
///     40: wheel -2 420,310
///     60: key space
///     90: end
///
/// The number is the time in ticks from the start, 0 the first: in a tick one step is made, unless the world
/// is paused. Events of a tick come before its step, in their order; times never go back. A key is one ASCII
/// character, with the case that shift gives it, or space, up, down, left, right, enter, tab, escape or
/// backspace. Buttons are left, middle and right; places are cells of the world, also beyond it; steps of the
/// wheel away from the user are above 0. After `end` comes nothing.
#ifndef THIMBLE_TOOLS_PARTICLES_INPUT_SCRIPT_H
#define THIMBLE_TOOLS_PARTICLES_INPUT_SCRIPT_H

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/screen.h"

namespace thimble::tools {

enum class InputKind : std::uint8_t { kKey, kMove, kPress, kRelease, kWheel, kEnd };

struct InputEvent {
  std::uint64_t tick = 0;
  InputKind kind = InputKind::kEnd;
  std::string key;
  std::uint8_t button = 0;  ///< 1 left, 2 middle, 3 right
  std::int32_t steps = 0;   ///< of the wheel, away from the user above 0
  std::int32_t x = 0;       ///< cell
  std::int32_t y = 0;
};

/// What a screen's event means here; nothing for those that mean nothing.
std::optional<InputEvent> input_event(const host::Event& event, std::uint64_t tick);

/// The event's line, with its line feed.
std::string to_text(const InputEvent& event);

/// Throws InputError "line L, column C: ...".
std::vector<InputEvent> read_input(std::string_view text);

}  // namespace thimble::tools

#endif
