#include "particles/input_script.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "particles/bodies.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::array<const char*, 4> kButtons{"", "left", "middle", "right"};
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

// Reads one line.
class EventReader {
 public:
  EventReader(std::uint64_t number, std::string_view line) : number_(number), line_(line), rest_(line) {}

  InputEvent read() {
    InputEvent event;
    const std::size_t colon = line_.find(':');
    if (colon == std::string_view::npos) {
      fail(line_, "a line is TICK: key|move|press|release|wheel|end ...");
    }
    rest_ = line_.substr(0, colon);
    event.tick = static_cast<std::uint64_t>(whole("the tick", 0, kMostTicks));
    no_more("the tick");
    rest_ = line_.substr(colon + 1);
    const std::string_view verb = word("an event: key, move, press, release, wheel or end");
    if (verb == "key") {
      event.kind = InputKind::kKey;
      const std::string_view key = word("the key");
      if (!is_key(key)) {
        fail(key, quoted(key) +
                      " is not a key: one character, or space, up, down, left, right, enter, tab, " +
                      "escape or backspace");
      }
      event.key = key;
    } else if (verb == "move") {
      event.kind = InputKind::kMove;
      place(&event);
    } else if (verb == "press" || verb == "release") {
      event.kind = verb == "press" ? InputKind::kPress : InputKind::kRelease;
      const std::string_view button = word("the button: left, middle or right");
      const auto* const found = std::find(kButtons.begin() + 1, kButtons.end(), button);
      if (found == kButtons.end()) {
        fail(button, quoted(button) + " is not left, middle or right");
      }
      event.button = static_cast<std::uint8_t>(found - kButtons.begin());
      place(&event);
    } else if (verb == "wheel") {
      event.kind = InputKind::kWheel;
      event.steps =
          static_cast<std::int32_t>(whole("the number of steps", -kMostWheelSteps, kMostWheelSteps));
      place(&event);
    } else if (verb != "end") {
      fail(verb, quoted(verb) + " is not key, move, press, release, wheel or end");
    }
    no_more("the event");
    return event;
  }
  [[noreturn]] void fail(std::string_view where, const std::string& sentence) const {
    fail_at_word(number_, line_, where, sentence);
  }

 private:
  std::string_view word(const char* what) {
    const std::string_view taken = take_word(rest_);
    if (taken.empty()) {
      fail(rest_, std::string(what) + " is missing");
    }
    return taken;
  }
  std::int64_t whole(const char* what, std::int64_t low, std::int64_t high) {
    return whole(word(what), what, low, high);
  }
  std::int64_t whole(std::string_view text, const char* what, std::int64_t low, std::int64_t high) const {
    std::int64_t value = 0;
    if (!parse_integer(text, value) || value < low || value > high) {
      fail(text, std::string(what) + " is " + quoted(text) + ", which is not a whole number from " +
                     std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
  }
  void place(InputEvent* event) {
    const std::string_view both = word("the place X,Y");
    const std::size_t comma = both.find(',');
    if (comma == std::string_view::npos) {
      fail(both, "the place is " + quoted(both) + ", which is not X,Y");
    }
    event->x = static_cast<std::int32_t>(whole(both.substr(0, comma), "x", -kFarthest, kFarthest));
    event->y = static_cast<std::int32_t>(whole(both.substr(comma + 1), "y", -kFarthest, kFarthest));
  }
  void no_more(const char* after) {
    const std::string_view more = take_word(rest_);
    if (!more.empty()) {
      fail(more, quoted(more) + " is too much after " + after);
    }
  }

  std::uint64_t number_;
  std::string_view line_;
  std::string_view rest_;
};

}  // namespace

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
  const std::string front = std::to_string(event.tick) + ": ";
  const std::string place = std::to_string(event.x) + "," + std::to_string(event.y) + "\n";
  switch (event.kind) {
    case InputKind::kKey:
      return front + "key " + event.key + "\n";
    case InputKind::kMove:
      return front + "move " + place;
    case InputKind::kPress:
      return front + "press " + kButtons[event.button] + " " + place;
    case InputKind::kRelease:
      return front + "release " + kButtons[event.button] + " " + place;
    case InputKind::kWheel:
      return front + "wheel " + std::to_string(event.steps) + " " + place;
    case InputKind::kEnd:
      break;
  }
  return front + "end\n";
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
    EventReader reader(lines.line_number(), line);
    InputEvent event = reader.read();
    if (!events.empty() && event.tick < events.back().tick) {
      reader.fail(first, "tick " + std::to_string(event.tick) + " comes after tick " +
                             std::to_string(events.back().tick));
    }
    if (!events.empty() && events.back().kind == InputKind::kEnd) {
      reader.fail(first, "an event follows the end");
    }
    events.push_back(std::move(event));
  }
  return events;
}

}  // namespace thimble::tools
