#include "particles/player.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "output/units.h"
#include "particles/line_words.h"

namespace thimble::tools {
namespace {

struct ToolFacts {
  const char* name;
  PointerMode mode;
  std::int32_t
      reach;  // cells: how near a ball must be to be taken, how far forces reach, how thick what is drawn is
};
constexpr std::array<ToolFacts, 6> kTools{{{"drag", PointerMode::kDrag, 12},
                                           {"attract", PointerMode::kAttract, 120},
                                           {"repel", PointerMode::kRepel, 120},
                                           {"spawn", PointerMode::kSpawn, 1},
                                           {"erase", PointerMode::kErase, 12},
                                           // Drawn at every event, so that a quick stroke keeps its corners.
                                           {"draw wall", PointerMode::kNone, 3}}};
constexpr std::int32_t kMostReach = 1024;
constexpr std::int32_t kStrengthQ16 = 32768;
constexpr std::int32_t kGravityStepQ16 = 1311;  // 0.02
constexpr std::int64_t kCountStep = 10;
constexpr std::int32_t kMostRate = 1'000'000;

std::size_t index_of(Tool tool) {
  return static_cast<std::size_t>(tool);
}

// The cell of the nearest ball's centre within `reach`, or `at`.
Vec2i nearest_ball(const ParticleWorld& world, Vec2i at, std::int32_t reach) {
  Vec2i best = at;
  std::int64_t least = std::int64_t{reach} * reach + 1;
  for_each_ball(world, [&](const Particle& ball) {
    const Vec2i cell{ball.x_q16 >> 16, ball.y_q16 >> 16};
    const std::int64_t dx = cell.x - at.x;
    const std::int64_t dy = cell.y - at.y;
    if (dx * dx + dy * dy < least) {
      least = dx * dx + dy * dy;
      best = cell;
    }
  });
  return best;
}

constexpr std::array<const char*, 4> kButtons{"", "left", "middle", "right"};
// In the order of `InputKind`.
constexpr std::array<const char*, 6> kVerbs{"key", "move", "press", "release", "wheel", "end"};
constexpr std::array<std::pair<const char*, host::Key>, 9> kNamedKeys{{{"space", host::Key::kSpace},
                                                                       {"up", host::Key::kUp},
                                                                       {"down", host::Key::kDown},
                                                                       {"left", host::Key::kLeft},
                                                                       {"right", host::Key::kRight},
                                                                       {"enter", host::Key::kEnter},
                                                                       {"tab", host::Key::kTab},
                                                                       {"escape", host::Key::kEscape},
                                                                       {"backspace", host::Key::kBackspace}}};
constexpr std::int64_t kMostTicks = std::numeric_limits<std::int64_t>::max() - 1;
constexpr std::int64_t kFarthest = 1'000'000;
constexpr std::int64_t kMostWheelSteps = 1000;

bool is_key(std::string_view word) {
  return (word.size() == 1 && word[0] > ' ' && word[0] <= '~') ||
         std::any_of(kNamedKeys.begin(), kNamedKeys.end(),
                     [&](const auto& named) { return word == named.first; });
}

bool has_place(const InputEvent& event) {
  return event.kind != InputKind::kKey && event.kind != InputKind::kEnd;
}

void read_place(LineWords* words, InputEvent* event) {
  const std::string_view both = words->word("the place X,Y");
  const std::size_t comma = both.find(',');
  words->fail_if(comma == std::string_view::npos, both, "the place is ", quoted(both), ", which is not X,Y");
  const auto cell = [&](std::string_view text, const char* what) {
    return static_cast<std::int32_t>(words->whole_of(text, what, -kFarthest, kFarthest));
  };
  event->x = cell(both.substr(0, comma), "x");
  event->y = cell(both.substr(comma + 1), "y");
}

InputEvent read_event(std::string_view line, LineWords* words) {
  InputEvent event;
  const std::size_t colon = line.find(':');
  words->fail_if(colon == std::string_view::npos, line,
                 "a line is TICK: key|move|press|release|wheel|end ...");
  words->enter(line.substr(0, colon));
  event.tick = static_cast<std::uint64_t>(words->whole("the tick", 0, kMostTicks));
  words->end(" is too much after the tick");
  words->enter(line.substr(colon + 1));
  const std::string_view verb = words->word("an event: key, move, press, release, wheel or end");
  const auto* const found = std::find(kVerbs.begin(), kVerbs.end(), verb);
  words->fail_if(found == kVerbs.end(), verb, quoted(verb),
                 " is not key, move, press, release, wheel or end");
  event.kind = static_cast<InputKind>(found - kVerbs.begin());
  if (event.kind == InputKind::kKey) {
    const std::string_view key = words->word("the key");
    words->fail_if(
        !is_key(key), key, quoted(key),
        " is not a key: one character, or space, up, down, left, right, enter, tab, escape or backspace");
    event.key = key;
  } else if (event.kind == InputKind::kPress || event.kind == InputKind::kRelease) {
    const std::string_view button = words->word("the button: left, middle or right");
    const auto* const pressed = std::find(kButtons.begin() + 1, kButtons.end(), button);
    words->fail_if(pressed == kButtons.end(), button, quoted(button), " is not left, middle or right");
    event.button = static_cast<std::uint8_t>(pressed - kButtons.begin());
  } else if (event.kind == InputKind::kWheel) {
    event.steps =
        static_cast<std::int32_t>(words->whole("the number of steps", -kMostWheelSteps, kMostWheelSteps));
  }
  if (has_place(event)) {
    read_place(words, &event);
  }
  words->end(" is too much after the event");
  return event;
}

}  // namespace

Player::Player(PopulatedWorld* world, std::int32_t rate)
    : world_(world), settings_(world->options()), rate_(rate) {
  std::transform(kTools.begin(), kTools.end(), reach_.begin(),
                 [](const ToolFacts& tool) { return tool.reach; });
  strong_gravity_ = settings_.gravity_q16 == Vec2i{} ? WorldOptions{}.gravity_q16 : settings_.gravity_q16;
}

// The left button has the tool that was chosen; the others have one each.
Tool Player::held_tool() const {
  return held_button_ == 3 ? Tool::kAttract : held_button_ == 2 ? Tool::kWall : tool_;
}

void Player::take(const InputEvent& event) {
  const Vec2i before = place_;
  switch (event.kind) {
    case InputKind::kKey:
      take_key(event.key);
      return;
    case InputKind::kEnd:
      has_ended_ = true;
      return;
    case InputKind::kWheel:
      change_reach(is_held() ? held_tool() : tool_, event.steps);
      return;
    case InputKind::kMove:
    case InputKind::kPress:
    case InputKind::kRelease:
      break;
  }
  place_ = {event.x, event.y};
  if (event.kind == InputKind::kPress) {
    press(event);
  } else if (is_held() && !is_released_ && held_tool() == Tool::kWall) {
    world_->world().draw_wall(before, place_, 2 * reach_[index_of(Tool::kWall)] - 1);
  }
  if (event.kind == InputKind::kRelease && event.button == held_button_) {
    is_released_ = true;
  }
}

void Player::press(const InputEvent& event) {
  held_button_ = event.button;
  is_released_ = false;
  ParticleWorld& world = world_->world();
  world.set_pointer(PointerMode::kNone, place_);
  switch (held_tool()) {
    case Tool::kDrag:
      world.set_pointer(PointerMode::kDrag, nearest_ball(world, place_, reach_[index_of(Tool::kDrag)]));
      break;
    case Tool::kWall:
      world.draw_wall(place_, 2 * reach_[index_of(Tool::kWall)] - 1);
      break;
    default:
      break;
  }
}

void Player::tick() {
  ParticleWorld& world = world_->world();
  if (!stands()) {
    const Tool tool = held_tool();
    world.set_pointer(is_held() ? kTools[index_of(tool)].mode : PointerMode::kNone, place_,
                      reach_[index_of(tool)], kStrengthQ16);
    world.step();
    const StepCounters& step = world.counters();
    ++counts_.steps;
    counts_.moves += step.moves;
    counts_.mask_tests += step.mask_tests;
    counts_.ball_hits += step.ball_hits;
    counts_.wall_hits += step.wall_hits;
    counts_.woken += step.woken;
  }
  // Only now, so that a click between two steps works in one; in a world that stands it is gone.
  if (is_released_) {
    held_button_ = 0;
    is_released_ = false;
    world.set_pointer(PointerMode::kNone, place_);
  }
  makes_one_ = false;
  ++ticks_;
}

void Player::set_gravity(Vec2i gravity_q16) {
  if (world_->world().set_gravity(gravity_q16) == Status::kOk) {
    settings_.gravity_q16 = gravity_q16;
    if (gravity_q16 != Vec2i{}) {
      strong_gravity_ = gravity_q16;
    }
  }
}

// Adds balls at random places, as far as there is room, or takes those of the highest numbers away.
void Player::set_count(std::int64_t count) {
  ParticleWorld& world = world_->world();
  const std::int64_t wanted = std::clamp<std::int64_t>(count, 0, world.config().capacity);
  while (world.count() < wanted &&
         world.spawn_random(static_cast<std::int32_t>(std::lround(settings_.speed * 65536))) == Status::kOk) {
  }
  for (std::uint32_t id = world.id_limit(); id > 0 && world.count() > wanted; --id) {
    static_cast<void>(world.remove(id - 1));
  }
  settings_.count = world.count();
}

void Player::begin_again() {
  world_->begin_again(settings_);
  held_button_ = 0;
  is_released_ = false;
}

// By an eighth each.
void Player::change_reach(Tool tool, std::int32_t steps) {
  std::int32_t& reach = reach_[index_of(tool)];
  for (; steps != 0; steps += steps < 0 ? 1 : -1) {
    const std::int32_t part = std::max(1, reach / 8);
    reach = std::clamp(steps < 0 ? reach - part : reach + part, 1, kMostReach);
  }
}

void Player::take_key(const std::string& key) {
  const std::int32_t strength = std::max(std::abs(strong_gravity_.x), std::abs(strong_gravity_.y));
  if (key == "left" || key == "right") {
    set_gravity({key == "left" ? -strength : strength, 0});
  } else if (key == "up" || key == "down") {
    set_gravity({0, key == "up" ? -strength : strength});
  } else if (key == "space") {
    is_paused_ = !is_paused_;
  } else if (key == "escape") {
    has_ended_ = true;
  } else if (key.size() == 1 && key[0] >= '1' && key[0] <= '6') {
    tool_ = static_cast<Tool>(key[0] - '1');
  } else if (key.size() == 1) {
    change_setting(key[0]);
    command(key[0]);
  }
}

void Player::set_sizes(std::int32_t least, std::int32_t most) {
  if (world_->world().set_diameters(least, most) == Status::kOk) {
    settings_.least_diameter = least;
    settings_.most_diameter = most;
  }
}

void Player::add_bounciness(int hundredths) {
  const long bounciness = std::clamp(std::lround(100 * settings_.bounciness) + hundredths, 0L, 100L);
  settings_.bounciness = static_cast<double>(bounciness) / 100;
  static_cast<void>(world_->world().set_restitution(restitution_q16(settings_.bounciness)));
}

void Player::add_gravity(std::int32_t more) {
  const std::int32_t strength = std::max(std::abs(strong_gravity_.x), std::abs(strong_gravity_.y));
  const std::int32_t size = std::clamp(strength + more, kGravityStepQ16, kMaxAccelerationQ16);
  const auto sign = [](std::int32_t value) { return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0); };
  set_gravity({sign(strong_gravity_.x) * size, sign(strong_gravity_.y) * size});
}

// A small letter is less, a capital more.
void Player::change_setting(char key) {
  const int sign = key >= 'A' && key <= 'Z' ? 1 : -1;
  switch (sign > 0 && key != 'E' ? key - 'A' + 'a' : key) {
    case '[':
    case ']':
      change_reach(tool_, key == '[' ? -1 : 1);
      break;
    case 'n':
      set_sizes(settings_.least_diameter + sign, settings_.most_diameter);
      break;
    case 'm':
      set_sizes(settings_.least_diameter, settings_.most_diameter + sign);
      break;
    case 'b':
      add_bounciness(5 * sign);
      break;
    case 'c':
      set_count(std::int64_t{world_->world().count()} + sign * kCountStep);
      break;
    case 'e':
      rate_ = std::max(rate_ - std::max(1, rate_ / 5), 1);
      break;
    case 'E':
      rate_ = std::min(rate_ + std::max(1, rate_ / 4), kMostRate);
      break;
    case 'g':
      add_gravity(sign * kGravityStepQ16);
      break;
    case '0':
      set_gravity(settings_.gravity_q16 == Vec2i{} ? strong_gravity_ : Vec2i{});
      break;
    default:
      break;
  }
}

void Player::command(char key) {
  ParticleWorld& world = world_->world();
  switch (key) {
    case '.':
      is_paused_ = true;
      makes_one_ = true;
      break;
    case 'x':
      world.erase_box(world.field().bounds());
      break;
    case 'r':
      begin_again();
      break;
    case 'o':
      shows_figures_ = !shows_figures_;
      break;
    case '?':
    case 'h':
      shows_help_ = !shows_help_;
      break;
    case 'q':
      has_ended_ = true;
      break;
    default:
      break;
  }
}

std::string Player::figures(double eps, const char* between, bool is_brief) const {
  return concat("Min Size: ", settings_.least_diameter, between, "Max Size: ", settings_.most_diameter,
                between, "Bounciness: ", fixed(settings_.bounciness, is_brief ? 2 : 6), is_brief ? "" : "\n",
                between, "Total Colliders: ", world_->world().count(), between,
                "Eps: ", fixed(eps, is_brief ? 1 : 6));
}

std::string Player::tool_text() const {
  const Tool tool = is_held() ? held_tool() : tool_;
  const std::string reach = tool == Tool::kSpawn ? "" : " within " + std::to_string(reach_[index_of(tool)]);
  return "mouse: " + std::string(kTools[index_of(tool)].name) + reach + (is_held() ? " *" : "");
}

std::string Player::world_text() const {
  return "asleep " + grouped(world_->world().asleep()) + "   step " + grouped(counts_.steps) +
         (is_paused_ ? "   PAUSED" : "");
}

std::string Player::help() {
  return "Mouse  left button: the tool chosen\n"
         "       middle: draws a wall    right: attracts\n"
         "       wheel, [ ]: reach of the tool\n"
         " 1 drag   2 attract  3 repel\n"
         " 4 spawn  5 erase    6 draw wall\n"
         " x erases all walls\n"
         "\n"
         "Keys   small letter less, capital more\n"
         " n N  Min Size  } of balls\n"
         " m M  Max Size  } that come\n"
         " b B  Bounciness\n"
         " c C  Total Colliders, by 10\n"
         " e E  Eps: steps a second\n"
         " g G  gravity    arrows: where it pulls\n"
         " 0    gravity off and on\n"
         " space pause   . one step   r reset\n"
         " o figures on and off\n"
         " ? this help   q ends";
}

std::optional<InputEvent> input_event(const host::Event& event, std::uint64_t tick) {
  InputEvent input;
  input.tick = tick;
  const auto limited = [](std::int32_t cell) {
    return std::clamp(cell, -static_cast<std::int32_t>(kFarthest), static_cast<std::int32_t>(kFarthest));
  };
  input.x = limited(event.x_px);
  input.y = limited(event.y_px);
  switch (event.kind) {
    case host::EventKind::kKeyDown: {
      const auto* const named = std::find_if(kNamedKeys.begin(), kNamedKeys.end(),
                                             [&](const auto& pair) { return pair.second == event.key; });
      if (named == kNamedKeys.end()) {
        return std::nullopt;  // kText says which character it gives
      }
      input.kind = InputKind::kKey;
      input.key = named->first;
      return input;
    }
    case host::EventKind::kText:
      if (event.character <= U' ' || event.character > U'~') {
        return std::nullopt;
      }
      input.kind = InputKind::kKey;
      input.key = static_cast<char>(event.character);
      return input;
    case host::EventKind::kMouseMove:
      input.kind = InputKind::kMove;
      return input;
    case host::EventKind::kMouseDown:
    case host::EventKind::kMouseUp:
      if (event.button < 1 || event.button > 3) {
        return std::nullopt;
      }
      input.kind = event.kind == host::EventKind::kMouseDown ? InputKind::kPress : InputKind::kRelease;
      input.button = event.button;
      return input;
    case host::EventKind::kWheel:
      input.kind = InputKind::kWheel;
      input.steps = event.steps;
      return input;
    case host::EventKind::kClose:
      return input;  // the end
    case host::EventKind::kKeyUp:
    case host::EventKind::kResize:
    case host::EventKind::kDrop:
      break;
  }
  return std::nullopt;
}

std::string to_text(const InputEvent& event) {
  const std::string what = event.kind == InputKind::kKey       ? " " + event.key
                           : event.kind == InputKind::kPress   ? concat(" ", kButtons[event.button])
                           : event.kind == InputKind::kRelease ? concat(" ", kButtons[event.button])
                           : event.kind == InputKind::kWheel   ? concat(" ", event.steps)
                                                               : "";
  return concat(event.tick, ": ", kVerbs[static_cast<std::size_t>(event.kind)], what,
                has_place(event) ? concat(" ", event.x, ",", event.y) : "", "\n");
}

std::vector<InputEvent> read_input(std::string_view text) {
  std::vector<InputEvent> events;
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    std::string_view ahead = line;
    const std::string_view first = take_word(ahead);
    if (first.empty() || first.front() == '#') {
      continue;
    }
    LineWords words(lines.line_number(), line);
    InputEvent event = read_event(line, &words);
    if (!events.empty()) {
      const InputEvent& last = events.back();
      words.fail_if(event.tick < last.tick, first, "tick ", event.tick, " comes after tick ", last.tick);
      words.fail_if(last.kind == InputKind::kEnd, first, "an event follows the end");
    }
    events.push_back(std::move(event));
  }
  return events;
}

}  // namespace thimble::tools
