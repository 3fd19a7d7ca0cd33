/// What keys and mouse do to a particle world, and how its time passes.
///
/// Everything that happens is decided by the events and the ticks between them, so the same
/// events give the same world, watched or not.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/screen.h"
#include "particles/populated_world.h"

namespace thimble::tools {

// What a hand did with mouse and keys, as text: recorded, written by hand, and played again.
//
//     # a line that begins with # is a comment
//     0: key 5
//     10: press left 400,300
//     11: move 420,310
//     30: release left 420,310
//     40: wheel -2 420,310
//     60: key space
//     90: end
//
// The number is the time in ticks from the start, 0 the first: in a tick one step is made, unless the world
// is paused. Events of a tick come before its step, in their order; times never go back. A key is one ASCII
// character, with the case that shift gives it, or space, up, down, left, right, enter, tab, escape or
// backspace. Buttons are left, middle and right; places are cells of the world, also beyond it; steps of the
// wheel away from the user are above 0. After `end` comes nothing.

/// A key that is a character is a kText, the others are a kKeyDown; `end` is a kClose.
struct InputEvent : host::Event {
  std::uint64_t tick = 0;
};

/// A screen's event; nothing for those that mean nothing here.
std::optional<InputEvent> input_event(const host::Event& event, std::uint64_t tick);

/// The event's line, with its line feed.
std::string to_text(const InputEvent& event);

/// Throws InputError "line L, column C: ...".
std::vector<InputEvent> read_input(std::string_view text);

enum class Tool : std::uint8_t { kDrag, kAttract, kRepel, kSpawn, kErase, kWall };

/// Sums over all steps.
struct PlayedCounts {
  std::uint64_t steps = 0;
  std::uint64_t moves = 0;
  std::uint64_t mask_tests = 0;
  std::uint64_t ball_hits = 0;
  std::uint64_t wall_hits = 0;
  std::uint64_t woken = 0;
};

class Player {
 public:
  /// `world` outlives it. `rate`: ticks a second that somebody who watches sees, 1 .. 1,000,000.
  Player(PopulatedWorld* world, std::int32_t rate);

  /// An event of this tick.
  void take(const InputEvent& event);
  /// Lets a tick pass.
  void tick();

  std::uint64_t ticks() const { return ticks_; }
  const PlayedCounts& counts() const { return counts_; }
  /// Whether ticks pass without steps until the next event.
  bool stands() const { return is_paused_ && !makes_one_; }
  bool has_ended() const { return has_ended_; }
  bool shows_help() const { return shows_help_; }
  bool shows_figures() const { return shows_figures_; }
  std::int32_t rate() const { return rate_; }
  /// Whether the next tick may change what is seen.
  bool is_moving() const { return !stands() && (world_->world().awake() > 0 || is_held()); }

  /// The five figures of the paper's Figure 1 with `between` between them; `eps` is the rate of steps.
  std::string figures(double eps, const char* between = "\n", bool is_brief = false) const;
  /// What the mouse does, and how the world fares; up to 32 characters each.
  std::string tool_text() const;
  std::string world_text() const;
  static std::string help();

 private:
  bool is_held() const { return held_button_ != 0; }
  Tool held_tool() const;
  void take_key(host::Key key);
  void take_character(char key);
  void change_setting(char key);
  void command(char key);
  void set_sizes(std::int32_t least, std::int32_t most);
  void add_bounciness(int hundredths);
  void add_gravity(std::int32_t more);
  void change_reach(Tool tool, std::int32_t steps);
  void press(const InputEvent& event);
  void set_count(std::int64_t count);
  void set_gravity(Vec2i gravity_q16);

  PopulatedWorld* world_;
  WorldOptions settings_;  // as the keys have changed them
  std::int32_t rate_;
  Tool tool_ = Tool::kDrag;
  std::array<std::int32_t, 6> reach_;
  Vec2i place_;
  std::uint8_t held_button_ = 0;
  bool is_released_ = false;
  Vec2i strong_gravity_;  // what 0 turns on again
  bool is_paused_ = false;
  bool makes_one_ = false;
  bool has_ended_ = false;
  bool shows_help_ = false;
  bool shows_figures_ = true;
  std::uint64_t ticks_ = 0;
  PlayedCounts counts_;
};

}  // namespace thimble::tools
