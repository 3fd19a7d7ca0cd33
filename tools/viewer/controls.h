/// From keys and mouse to wishes: how the camera is to move, and what else is wished. It knows neither
/// screen nor scene, so that tests can play every gesture.
///
/// `s` has two meanings, since W, A, S and D fly: tapped it saves, held (or beside another key that flies) it
/// flies backwards. A terminal does not tell when a key is let go; there `s` always saves.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>

#include "host/screen.h"

namespace thimble::tools::viewer {

// What keys and mouse do in the viewer: one table, from which the viewer hears, `?` shows and --help tells.

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

Action action_of(char32_t character);
/// What a key flies, or null.
const Flight* flight_of(host::Key key);

/// The table as lines, inputs in a column of their own.
std::string keys_text();

/// How the camera is to move. Lengths on the picture are in picture heights.
struct Motion {
  double turn_right = 0;  ///< of a drag: what is dragged follows the pointer
  double turn_up = 0;
  double move_right = 0;
  double move_up = 0;
  double factor = 1;     ///< of the distance
  double fly_right = 0;  ///< seconds of flight
  double fly_up = 0;
  double fly_forward = 0;

  bool any() const;
};

class Controls {
 public:
  /// A second press within so many seconds and pixels is a double click.
  static constexpr double kDoubleClickSeconds = 0.4;
  static constexpr std::int32_t kDoubleClickPx = 4;
  /// `s` held for longer flies.
  static constexpr double kTapSeconds = 0.3;
  /// The distance is multiplied by this for a step of the wheel towards the model.
  static constexpr double kWheelFactor = 0.88;

  /// `keys_end`: whether the screen tells when a key is let go.
  explicit Controls(bool keys_end) : keys_end_(keys_end) {}

  /// Takes an event that came at `seconds` of any steady clock, on a picture of `height_px`.
  Action take(const host::Event& event, double seconds, std::int32_t height_px);
  /// How the camera is to move, all that gathered since the last call.
  Motion take_motion(double seconds);
  /// Whether a key that flies is held: the camera moves without any event.
  bool is_flying(double seconds) const;

  std::int32_t pointer_x_px() const { return x_px_; }
  std::int32_t pointer_y_px() const { return y_px_; }
  bool has_pointer() const { return has_pointer_; }

 private:
  Action press(const host::Event& event, double seconds);
  void drag(const host::Event& event, std::int32_t height_px);
  Action take_key(const host::Event& event, double seconds);
  bool flies(host::Key key, double seconds) const;

  bool keys_end_;
  Motion motion_;
  std::set<host::Key> held_;
  double flown_until_ = 0;
  double s_pressed_at_ = 0;
  bool s_may_save_ = false;
  bool has_pointer_ = false;
  std::int32_t x_px_ = 0;
  std::int32_t y_px_ = 0;
  std::uint8_t buttons_ = 0;
  bool moves_ = false;  // this drag moves, others turn
  double pressed_at_ = -1;
  std::int32_t pressed_x_px_ = 0;
  std::int32_t pressed_y_px_ = 0;
};

}  // namespace thimble::tools::viewer
