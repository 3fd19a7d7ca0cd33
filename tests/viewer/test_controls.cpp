// The viewer's gestures: what keys and mouse ask for.
#include <doctest/doctest.h>

#include <string>

#include "viewer/controls.h"

namespace {

using namespace thimble::host;
using namespace thimble::tools::viewer;

Event mouse(EventKind kind, std::int32_t x, std::int32_t y, int button, int buttons, bool shift = false) {
  Event event;
  event.kind = kind;
  event.x_px = x;
  event.y_px = y;
  event.button = static_cast<std::uint8_t>(button);
  event.buttons = static_cast<std::uint8_t>(buttons);
  event.shift = shift;
  return event;
}

Event key(EventKind kind, Key which, bool repeated = false) {
  Event event;
  event.kind = kind;
  event.key = which;
  event.repeated = repeated;
  return event;
}

Event typed(char32_t character) {
  Event event;
  event.kind = EventKind::kText;
  event.character = character;
  return event;
}

constexpr std::int32_t kHeight = 100;

Motion drag(int button, int bit, bool shift) {
  Controls controls(true);
  controls.take(mouse(EventKind::kMouseMove, 10, 10, 0, 0), 0, kHeight);
  controls.take(mouse(EventKind::kMouseDown, 10, 10, button, bit, shift), 0, kHeight);
  controls.take(mouse(EventKind::kMouseMove, 30, 15, 0, bit, shift), 0.1, kHeight);
  controls.take(mouse(EventKind::kMouseUp, 30, 15, button, 0, shift), 0.2, kHeight);
  controls.take(mouse(EventKind::kMouseMove, 60, 60, 0, 0), 0.3, kHeight);
  return controls.take_motion(0.4);
}

}  // namespace

TEST_CASE("viewer: left drag turns, right drag and shift drag move, no button does nothing") {
  const Motion turned = drag(1, 1, false);
  CHECK(turned.turn_right == doctest::Approx(0.2));
  CHECK(turned.turn_up == doctest::Approx(-0.05));
  CHECK(turned.move_right == 0);
  for (const Motion& moved : {drag(3, 4, false), drag(1, 1, true), drag(2, 2, false)}) {
    CHECK(moved.move_right == doctest::Approx(-0.2));
    CHECK(moved.move_up == doctest::Approx(0.05));
    CHECK(moved.turn_right == 0);
  }
}

TEST_CASE("viewer: a drag that begins outside or whose press was not seen does nothing") {
  Controls controls(true);
  controls.take(mouse(EventKind::kMouseMove, 10, 10, 0, 1), 0, kHeight);
  CHECK_FALSE(controls.take_motion(0.1).any());
}

TEST_CASE("viewer: wheel -> nearer and farther, as far back as forth") {
  Controls controls(true);
  Event wheel = mouse(EventKind::kWheel, 1, 1, 0, 0);
  wheel.steps = 2;
  controls.take(wheel, 0, kHeight);
  CHECK(controls.take_motion(0).factor == doctest::Approx(Controls::kWheelFactor * Controls::kWheelFactor));
  controls.take(wheel, 0, kHeight);
  wheel.steps = -2;
  controls.take(wheel, 0, kHeight);
  CHECK(controls.take_motion(0).factor == doctest::Approx(1));
}

TEST_CASE("viewer: two presses -> a double click where they are near in time and place, and only once") {
  const auto second = [](double later, std::int32_t x) {
    Controls controls(true);
    CHECK(controls.take(mouse(EventKind::kMouseDown, 50, 50, 1, 1), 1, kHeight) == Action::kNone);
    controls.take(mouse(EventKind::kMouseUp, 50, 50, 1, 0), 1.05, kHeight);
    return controls.take(mouse(EventKind::kMouseDown, x, 50, 1, 1), 1 + later, kHeight);
  };
  CHECK(second(0.2, 50) == Action::kLookThere);
  CHECK(second(0.2, 54) == Action::kLookThere);
  CHECK(second(0.2, 55) == Action::kNone);
  CHECK(second(0.5, 50) == Action::kNone);
  Controls controls(true);
  int clicks = 0;
  for (int i = 0; i < 3; ++i) {
    clicks += controls.take(mouse(EventKind::kMouseDown, 5, 5, 1, 1), 0.1 * i, kHeight) == Action::kLookThere;
  }
  CHECK(clicks == 1);
}

TEST_CASE("viewer: keys held -> flight for as long, opposite ones cancel, a slow frame does not throw") {
  Controls controls(true);
  controls.take(key(EventKind::kKeyDown, key_of('w')), 1, kHeight);
  CHECK(controls.is_flying(1));
  CHECK(controls.take_motion(1.05).fly_forward == doctest::Approx(0.05));
  controls.take(key(EventKind::kKeyDown, Key::kRight), 1.05, kHeight);
  const Motion both = controls.take_motion(1.08);
  CHECK(both.fly_forward == doctest::Approx(0.03));
  CHECK(both.fly_right == doctest::Approx(0.03));
  controls.take(key(EventKind::kKeyDown, key_of('a')), 1.08, kHeight);
  CHECK(controls.take_motion(1.1).fly_right == doctest::Approx(0));
  CHECK(controls.take_motion(60).fly_forward == doctest::Approx(0.1));
  for (const Key held : {key_of('w'), Key::kRight, key_of('a')}) {
    controls.take(key(EventKind::kKeyUp, held), 60, kHeight);
  }
  CHECK_FALSE(controls.is_flying(60));
  CHECK_FALSE(controls.take_motion(61).any());
}

TEST_CASE("viewer: s tapped saves; held, or beside another key, it flies; in a terminal it saves") {
  Controls window(true);
  CHECK(window.take(key(EventKind::kKeyDown, key_of('s')), 1, kHeight) == Action::kNone);
  CHECK(window.take(typed(U's'), 1, kHeight) == Action::kNone);
  CHECK_FALSE(window.take_motion(1.1).any());
  CHECK(window.take(key(EventKind::kKeyUp, key_of('s')), 1.1, kHeight) == Action::kSave);

  window.take(key(EventKind::kKeyDown, key_of('s')), 2, kHeight);
  window.take_motion(2.3);
  CHECK(window.take_motion(2.35).fly_forward == doctest::Approx(-0.05));
  CHECK(window.take(key(EventKind::kKeyUp, key_of('s')), 2.5, kHeight) == Action::kNone);

  window.take(key(EventKind::kKeyDown, key_of('d')), 3, kHeight);
  window.take(key(EventKind::kKeyDown, key_of('s')), 3, kHeight);
  CHECK(window.take_motion(3.02).fly_forward == doctest::Approx(-0.02));
  CHECK(window.take(key(EventKind::kKeyUp, key_of('s')), 3.02, kHeight) == Action::kNone);

  Controls terminal(false);
  CHECK(terminal.take(key(EventKind::kKeyDown, key_of('s')), 1, kHeight) == Action::kSave);
  CHECK(terminal.take(key(EventKind::kKeyDown, key_of('s'), true), 1.1, kHeight) == Action::kNone);
  CHECK_FALSE(terminal.take_motion(1.1).any());
  CHECK(terminal.take(key(EventKind::kKeyUp, key_of('s')), 1.2, kHeight) == Action::kNone);
}

TEST_CASE("viewer: Escape, q and the close button end; each key of the table does what it says") {
  Controls controls(true);
  CHECK(controls.take(key(EventKind::kKeyDown, Key::kEscape), 0, kHeight) == Action::kEnd);
  CHECK(controls.take(typed(U'q'), 0, kHeight) == Action::kEnd);
  CHECK(controls.take({.kind = EventKind::kClose}, 0, kHeight) == Action::kEnd);
  CHECK(controls.take(typed(U'?'), 0, kHeight) == Action::kHelp);
  CHECK(controls.take(typed(U' '), 0, kHeight) == Action::kPlay);
  CHECK(controls.take(typed(U'0'), 0, kHeight) == Action::kFirstView);
  CHECK(controls.take(typed(U'5'), 0, kHeight) == Action::kTop);
  CHECK(controls.take(typed(U'x'), 0, kHeight) == Action::kNone);
  const std::string text = keys_text();
  for (const KeyRow& row : key_rows()) {
    CAPTURE(row.input);
    CHECK(text.find(row.input) != std::string::npos);
    CHECK(text.find(row.does) != std::string::npos);
    for (const Typed& each : row.typed) {
      CHECK(action_of(static_cast<unsigned char>(each.character)) == each.action);
    }
    for (const Flight& each : row.flights) {
      CHECK(flight_of(each.key) == &each);
    }
  }
}
