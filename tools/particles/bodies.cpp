#include "particles/bodies.h"

#include <array>

#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::array<const char*, 8> kColumns{"x", "y", "vx", "vy", "the mass", "red", "green", "blue"};

class BodyReader {
 public:
  explicit BodyReader(std::string_view text) : lines_(text) {}

  // The next line that has anything on it.
  bool next_line() {
    while (lines_.next(line_)) {
      rest_ = line_;
      std::string_view ahead = line_;
      if (!take_word(ahead).empty()) {
        return true;
      }
    }
    return false;
  }
  [[noreturn]] void fail(std::string_view word, const std::string& sentence) const {
    fail_at_word(lines_.line_number(), line_, word.data() == nullptr ? rest_ : word, sentence);
  }
  double number(const char* what) {
    const std::string_view word = word_of(what);
    double value = 0;
    switch (parse_number(word, value)) {
      case NumberKind::kFinite:
        return value;
      case NumberKind::kNotFinite:
        fail(word, std::string(what) + " is " + quoted(word) + ", which is not a finite number");
      case NumberKind::kGarbage:
        break;
    }
    fail(word, std::string(what) + " is " + quoted(word) + ", which is not a number");
  }
  std::int64_t whole(const char* what, std::int64_t low, std::int64_t high) {
    const std::string_view word = word_of(what);
    std::int64_t value = 0;
    if (!parse_integer(word, value) || value < low || value > high) {
      fail(word, std::string(what) + " is " + quoted(word) + ", which is not a whole number from " +
                     std::to_string(low) + " to " + std::to_string(high));
    }
    return value;
  }
  double above_zero(const char* what) {
    const std::string_view before = rest_;
    const double value = number(what);
    if (value <= 0) {
      std::string_view again = before;
      const std::string_view word = take_word(again);
      fail(word, std::string(what) + " is " + quoted(word) + ", which is not above 0");
    }
    return value;
  }
  void end_line() {
    const std::string_view word = take_word(rest_);
    if (!word.empty()) {
      fail(word, quoted(word) + " is one value too many");
    }
  }

 private:
  std::string_view word_of(const char* what) {
    const std::string_view word = take_word(rest_);
    if (word.empty()) {
      fail(line_.substr(line_.size()), std::string(what) + " is missing");
    }
    return word;
  }

  LineReader lines_;
  std::string_view line_;
  std::string_view rest_;
};

}  // namespace

void fail_at_word(std::uint64_t line_number, std::string_view line, std::string_view word,
                  const std::string& sentence) {
  const auto column = static_cast<std::uint64_t>(word.data() - line.data()) + 1;
  throw InputError("line " + std::to_string(line_number) + ", column " + std::to_string(column) + ": " +
                   sentence);
}

Bodies read_bodies(std::string_view text) {
  constexpr std::int64_t kMostBodies = 1'000'000'000;
  BodyReader reader(text);
  Bodies result;
  if (!reader.next_line()) {
    throw InputError("the file holds no bodies");
  }
  const std::int64_t announced = reader.whole("the number of bodies", 0, kMostBodies);
  reader.end_line();
  if (!reader.next_line()) {
    throw InputError("the radius of the world, on the second line, is missing");
  }
  result.radius = reader.above_zero("the radius of the world");
  reader.end_line();
  while (reader.next_line()) {
    if (static_cast<std::int64_t>(result.bodies.size()) == announced) {
      reader.fail({}, "there are more bodies than the " + std::to_string(announced) + " announced");
    }
    Body body;
    body.x = reader.number(kColumns[0]);
    body.y = reader.number(kColumns[1]);
    body.vx = reader.number(kColumns[2]);
    body.vy = reader.number(kColumns[3]);
    body.mass = reader.above_zero(kColumns[4]);
    const auto channel = [&](std::size_t column) {
      return static_cast<std::uint8_t>(reader.whole(kColumns[column], 0, 255));
    };
    body.color.r = channel(5);
    body.color.g = channel(6);
    body.color.b = channel(7);
    reader.end_line();
    result.bodies.push_back(body);
  }
  if (static_cast<std::int64_t>(result.bodies.size()) != announced) {
    throw InputError("the file ends after " + std::to_string(result.bodies.size()) + " of the " +
                     std::to_string(announced) + " bodies announced");
  }
  return result;
}

}  // namespace thimble::tools
