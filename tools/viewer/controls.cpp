#include "viewer/controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace thimble::tools::viewer {
namespace {

constexpr host::Key kS = host::key_of('s');
// A frame that took long does not throw the camera across the scene.
constexpr double kMostFlightSeconds = 0.1;

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

bool Motion::any() const {
  return turn_right != 0 || turn_up != 0 || move_right != 0 || move_up != 0 || factor != 1 ||
         fly_right != 0 || fly_up != 0 || fly_forward != 0;
}

bool Controls::flies(host::Key key, double seconds) const {
  return key != kS || (keys_end_ && (!s_may_save_ || seconds - s_pressed_at_ > kTapSeconds));
}

bool Controls::is_flying(double seconds) const {
  return std::any_of(held_.begin(), held_.end(), [&](host::Key key) { return flies(key, seconds); });
}

Action Controls::press(const host::Event& event, double seconds) {
  if (buttons_ == 0 || event.button == 1) {
    moves_ = event.button != 1 || event.shift;
  }
  buttons_ = event.buttons;
  const bool is_second = event.button == 1 && pressed_at_ >= 0 &&
                         seconds - pressed_at_ <= kDoubleClickSeconds &&
                         std::abs(event.x_px - pressed_x_px_) <= kDoubleClickPx &&
                         std::abs(event.y_px - pressed_y_px_) <= kDoubleClickPx;
  pressed_at_ = event.button == 1 && !is_second ? seconds : -1;
  pressed_x_px_ = event.x_px;
  pressed_y_px_ = event.y_px;
  return is_second ? Action::kLookThere : Action::kNone;
}

void Controls::drag(const host::Event& event, std::int32_t height_px) {
  const double right = static_cast<double>(event.x_px - x_px_) / std::max(height_px, 1);
  const double down = static_cast<double>(event.y_px - y_px_) / std::max(height_px, 1);
  if (moves_) {
    motion_.move_right -= right;
    motion_.move_up += down;
  } else {
    motion_.turn_right += right;
    motion_.turn_up -= down;
  }
}

Action Controls::take_key(const host::Event& event, double seconds) {
  const bool is_down = event.kind == host::EventKind::kKeyDown;
  if (is_down && event.key == host::Key::kEscape) {
    return Action::kEnd;
  }
  if (flight_of(event.key) == nullptr) {
    return Action::kNone;
  }
  Action action = Action::kNone;
  if (is_down && !event.repeated) {
    if (held_.empty()) {
      flown_until_ = seconds;
    }
    if (event.key == kS) {
      s_may_save_ = held_.empty();
      s_pressed_at_ = seconds;
      if (!keys_end_) {
        return Action::kSave;
      }
    } else {
      s_may_save_ = false;
    }
    held_.insert(event.key);
  } else if (!is_down) {
    if (event.key == kS && held_.contains(kS) && !flies(kS, seconds)) {
      action = Action::kSave;
    }
    held_.erase(event.key);
  }
  return action;
}

Action Controls::take(const host::Event& event, double seconds, std::int32_t height_px) {
  Action action = Action::kNone;
  switch (event.kind) {
    case host::EventKind::kClose:
      return Action::kEnd;
    case host::EventKind::kKeyDown:
    case host::EventKind::kKeyUp:
      return take_key(event, seconds);
    case host::EventKind::kText:
      action = action_of(event.character);
      return action == Action::kSave ? Action::kNone : action;  // that goes by the key
    case host::EventKind::kWheel:
      motion_.factor *= std::pow(kWheelFactor, event.steps);
      break;
    case host::EventKind::kMouseMove:
      if (event.buttons != 0 && has_pointer_ && buttons_ != 0) {
        drag(event, height_px);
      }
      buttons_ = event.buttons;
      break;
    case host::EventKind::kMouseUp:
      buttons_ = event.buttons;
      break;
    case host::EventKind::kMouseDown:
      action = press(event, seconds);
      break;
    default:
      return Action::kNone;
  }
  x_px_ = event.x_px;
  y_px_ = event.y_px;
  has_pointer_ = true;
  return action;
}

Motion Controls::take_motion(double seconds) {
  const double flown = std::clamp(seconds - flown_until_, 0.0, kMostFlightSeconds);
  flown_until_ = seconds;
  for (const host::Key key : held_) {
    const Flight* flight = flight_of(key);
    if (flight != nullptr && flies(key, seconds)) {
      motion_.fly_right += flown * flight->right;
      motion_.fly_up += flown * flight->up;
      motion_.fly_forward += flown * flight->forward;
    }
  }
  const Motion motion = motion_;
  motion_ = {};
  return motion;
}

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

}  // namespace thimble::tools::viewer
