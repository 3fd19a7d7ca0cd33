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
using host::EventKind;
using host::Key;
// The first of a kind is its word.
constexpr std::array<std::pair<const char*, EventKind>, 7> kVerbs{{{"key", EventKind::kText},
                                                                   {"key", EventKind::kKeyDown},
                                                                   {"move", EventKind::kMouseMove},
                                                                   {"press", EventKind::kMouseDown},
                                                                   {"release", EventKind::kMouseUp},
                                                                   {"wheel", EventKind::kWheel},
                                                                   {"end", EventKind::kClose}}};
constexpr std::array<std::pair<const char*, Key>, 9> kNamedKeys{{{"space", Key::kSpace},
                                                                 {"up", Key::kUp},
                                                                 {"down", Key::kDown},
                                                                 {"left", Key::kLeft},
                                                                 {"right", Key::kRight},
                                                                 {"enter", Key::kEnter},
                                                                 {"tab", Key::kTab},
                                                                 {"escape", Key::kEscape},
                                                                 {"backspace", Key::kBackspace}}};
constexpr std::int64_t kMostTicks = std::numeric_limits<std::int64_t>::max() - 1;
constexpr std::int64_t kFarthest = 1'000'000;
constexpr std::int64_t kMostWheelSteps = 1000;

// What stands beside a word of such a table, or the word beside it; null where it is not there.
template <class Pairs>
const auto* named(const Pairs& pairs, std::string_view word) {
  const auto* const found =
      std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return word == pair.first; });
  return found == pairs.end() ? nullptr : &found->second;
}
template <class Pairs, class Value>
const char* name_of(const Pairs& pairs, Value value) {
  const auto* const found =
      std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return value == pair.second; });
  return found == pairs.end() ? nullptr : found->first;
}

constexpr bool is_letter(char32_t character) {
  return character > U' ' && character <= U'~';
}

bool has_place(const InputEvent& event) {
  return event.kind != EventKind::kText && event.kind != EventKind::kKeyDown &&
         event.kind != EventKind::kClose;
}

void read_place(LineWords* words, InputEvent* event) {
  const std::string_view both = words->word("the place X,Y");
  const std::size_t comma = both.find(',');
  words->fail_if(comma == std::string_view::npos, both, "the place is ", quoted(both), ", which is not X,Y");
  const auto cell = [&](std::string_view text, const char* what) {
    return static_cast<std::int32_t>(words->whole_of(text, what, -kFarthest, kFarthest));
  };
  event->x_px = cell(both.substr(0, comma), "x");
  event->y_px = cell(both.substr(comma + 1), "y");
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
  const auto* const kind = named(kVerbs, verb);
  words->fail_if(kind == nullptr, verb, quoted(verb), " is not key, move, press, release, wheel or end");
  event.kind = *kind;
  if (event.kind == EventKind::kText) {
    const std::string_view key = words->word("the key");
    if (const Key* const found = named(kNamedKeys, key)) {
      event.kind = EventKind::kKeyDown;
      event.key = *found;
    } else {
      event.character = static_cast<unsigned char>(key[0]);
    }
    words->fail_if(
        event.kind == EventKind::kText && (key.size() != 1 || !is_letter(event.character)), key, quoted(key),
        " is not a key: one character, or space, up, down, left, right, enter, tab, escape or backspace");
  } else if (event.kind == EventKind::kMouseDown || event.kind == EventKind::kMouseUp) {
    const std::string_view button = words->word("the button: left, middle or right");
    const auto* const pressed = std::find(kButtons.begin() + 1, kButtons.end(), button);
    words->fail_if(pressed == kButtons.end(), button, quoted(button), " is not left, middle or right");
    event.button = static_cast<std::uint8_t>(pressed - kButtons.begin());
  } else if (event.kind == EventKind::kWheel) {
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
    case EventKind::kKeyDown:
      take_key(event.key);
      return;
    case EventKind::kText:
      take_character(static_cast<char>(event.character));
      return;
    case EventKind::kClose:
      has_ended_ = true;
      return;
    case EventKind::kWheel:
      change_reach(is_held() ? held_tool() : tool_, event.steps);
      return;
    default:
      break;
  }
  place_ = {event.x_px, event.y_px};
  if (event.kind == EventKind::kMouseDown) {
    press(event);
  } else if (is_held() && !is_released_ && held_tool() == Tool::kWall) {
    world_->world().draw_wall(before, place_, 2 * reach_[index_of(Tool::kWall)] - 1);
  }
  if (event.kind == EventKind::kMouseUp && event.button == held_button_) {
    is_released_ = true;
  }
}

void Player::press(const InputEvent& event) {
  held_button_ = event.button;
  is_released_ = false;
  ParticleWorld& world = world_->world();
  world.set_pointer(PointerMode::kNone, place_);
  if (held_tool() == Tool::kDrag) {
    world.set_pointer(PointerMode::kDrag, nearest_ball(world, place_, reach_[index_of(Tool::kDrag)]));
  } else if (held_tool() == Tool::kWall) {
    world.draw_wall(place_, 2 * reach_[index_of(Tool::kWall)] - 1);
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

// By an eighth each.
void Player::change_reach(Tool tool, std::int32_t steps) {
  std::int32_t& reach = reach_[index_of(tool)];
  for (; steps != 0; steps += steps < 0 ? 1 : -1) {
    const std::int32_t part = std::max(1, reach / 8);
    reach = std::clamp(steps < 0 ? reach - part : reach + part, 1, kMostReach);
  }
}

void Player::take_key(Key key) {
  const std::int32_t strength = std::max(std::abs(strong_gravity_.x), std::abs(strong_gravity_.y));
  if (key == Key::kLeft || key == Key::kRight) {
    set_gravity({key == Key::kLeft ? -strength : strength, 0});
  } else if (key == Key::kUp || key == Key::kDown) {
    set_gravity({0, key == Key::kUp ? -strength : strength});
  } else if (key == Key::kSpace) {
    is_paused_ = !is_paused_;
  } else if (key == Key::kEscape) {
    has_ended_ = true;
  }
}

void Player::take_character(char key) {
  if (key >= '1' && key <= '6') {
    tool_ = static_cast<Tool>(key - '1');
  } else {
    change_setting(key);
    command(key);
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
      world_->begin_again(settings_);
      held_button_ = 0;
      is_released_ = false;
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
  const bool is_press = event.kind == EventKind::kMouseDown || event.kind == EventKind::kMouseUp;
  if (name_of(kVerbs, event.kind) == nullptr ||
      (event.kind == EventKind::kKeyDown && name_of(kNamedKeys, event.key) == nullptr) ||
      (event.kind == EventKind::kText && !is_letter(event.character)) ||
      (is_press && (event.button < 1 || event.button > 3))) {
    return std::nullopt;  // of other keys a kText says which character they give
  }
  InputEvent input{event, tick};
  for (std::int32_t* const cell : {&input.x_px, &input.y_px}) {
    *cell = static_cast<std::int32_t>(std::clamp<std::int64_t>(*cell, -kFarthest, kFarthest));
  }
  return input;
}

std::string to_text(const InputEvent& event) {
  std::string text = concat(event.tick, ": ", name_of(kVerbs, event.kind));
  if (event.kind == EventKind::kKeyDown) {
    text += concat(" ", name_of(kNamedKeys, event.key));
  } else if (event.kind == EventKind::kText) {
    text += concat(" ", static_cast<char>(event.character));
  } else if (event.kind == EventKind::kMouseDown || event.kind == EventKind::kMouseUp) {
    text += concat(" ", kButtons[event.button]);
  } else if (event.kind == EventKind::kWheel) {
    text += concat(" ", event.steps);
  }
  return text + (has_place(event) ? concat(" ", event.x_px, ",", event.y_px) : "") + "\n";
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
      words.fail_if(last.kind == EventKind::kClose, first, "an event follows the end");
    }
    events.push_back(std::move(event));
  }
  return events;
}

}  // namespace thimble::tools
