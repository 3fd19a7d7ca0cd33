/// The language that `.scene` statements are written in: words, numbers and clauses of one line, each with
/// the place where it stands. What the statements mean is in scene_text.cpp.
#pragma once

#include <algorithm>

#include "output/units.h"
#include "readers/real3.h"
#include "readers/scene_text.h"
#include "readers/text.h"

namespace thimble::tools {

/// A word or a number, and where it stands.
struct Word {
  std::string_view text;
  TextPlace place;
  bool is_quoted = false;
  bool empty() const { return text.empty() && !is_quoted; }
};

/// One line, read word by word. Its comment is no part of it.
class TextLine {
 public:
  TextLine(std::string_view text, std::uint32_t number) : text_(text), number_(number) {}

  /// Where reading continues.
  TextPlace place() const {
    const auto before = text_.substr(0, next_);
    const auto characters = std::count_if(before.begin(), before.end(), [](char c) {
      return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // all but continuations
    });
    return {number_, static_cast<std::uint32_t>(characters) + 1};
  }
  /// The next word, empty at the end of the line or before a comment.
  Word word() {
    skip_blanks();
    Word result;
    result.place = place();
    if (next_ == text_.size() || text_[next_] != '"') {
      result.text = run_until(kSpaces);
      return result;
    }
    const std::size_t end = text_.find('"', next_ + 1);
    fail_if(end == std::string_view::npos, result.place, "the quotation mark is not closed on this line");
    result.text = text_.substr(next_ + 1, end - next_ - 1);
    result.is_quoted = true;
    next_ = end + 1;
    fail_if(next_ < text_.size() && !is_space(text_[next_]), place(),
            "a blank must follow the quotation mark");
    return result;
  }
  /// The next number: a comma may stand before it unless it is the first of several.
  Word number(bool is_first) {
    skip_blanks();
    if (!is_first && next_ < text_.size() && text_[next_] == ',') {
      ++next_;
      skip_blanks();
    }
    Word result;
    result.place = place();
    result.text = run_until(kSpacesAndComma);
    return result;
  }
  /// Whether nothing but a comment is left.
  bool at_end() {
    skip_blanks();
    return next_ == text_.size();
  }

  // Values, each by its name in an error's sentence and with both ends of its range.

  double real(const std::string& what, double low, double high, bool is_first = true) {
    const Word word = number(is_first);
    const std::string range = shortest(low) + " to " + shortest(high);
    fail_if(word.text.empty(), word.place, what, " is missing: a number from ", range, " is expected here");
    double value = 0;
    const NumberKind kind = parse_number(word.text, value);
    fail_if(kind != NumberKind::kFinite || !(value >= low && value <= high), word.place, what, " is ",
            quoted(word.text),
            kind == NumberKind::kFinite      ? ", it must be " + range
            : kind == NumberKind::kNotFinite ? ", which is not finite"
                                             : ", which is not a number");
    return value;
  }
  std::int32_t whole(const std::string& what, std::int32_t low, std::int32_t high, bool is_first = true) {
    const Word word = number(is_first);
    const std::string range = concat(low, " to ", high);
    fail_if(word.text.empty(), word.place, what, " is missing: a whole number from ", range,
            " is expected here");
    std::int64_t value = 0;
    const bool is_whole = parse_integer(word.text, value);
    if (!is_whole || value < low || value > high) {
      double large = 0;  // beyond 64 bits
      const bool is_number =
          is_whole || (parse_number(word.text, large) == NumberKind::kFinite && std::abs(large) >= 9e18);
      fail_at(word.place, what, " is ", quoted(word.text),
              is_number ? ", it must be " + range : ", which is not a whole number");
    }
    return static_cast<std::int32_t>(value);
  }
  std::array<double, 3> three_reals(const std::string& what, double low, double high) {
    return {real("x of " + what, low, high), real("y of " + what, low, high, false),
            real("z of " + what, low, high, false)};
  }
  Vec3i three_wholes(const std::string& what, std::int32_t low, std::int32_t high) {
    return {whole("x of " + what, low, high), whole("y of " + what, low, high, false),
            whole("z of " + what, low, high, false)};
  }
  /// Red, green and blue, 0 to 255 each.
  Rgb8 color() {
    const auto channel = [this](const char* name, bool is_first) {
      return static_cast<std::uint8_t>(whole(name, 0, 255, is_first));
    };
    return {channel("red", true), channel("green", false), channel("blue", false)};
  }
  /// 0 to 1, as 0 to 255.
  std::uint8_t share(const char* what) { return static_cast<std::uint8_t>(to_fixed(real(what, 0, 1), 255)); }
  /// In 1/256; a number that is above 0 stays above 0.
  std::uint16_t fixed_q8(const char* what, double high) {
    const double value = real(what, 0, high);
    return static_cast<std::uint16_t>(std::clamp(to_fixed(value, 256), value > 0 ? 1 : 0, 65535));
  }
  /// x, y or z, as 0 to 2.
  std::size_t axis(const char* what) {
    const Word name = word();
    const std::size_t found = std::string_view("xyz").find(name.text);
    fail_if(name.text.size() != 1 || found == std::string_view::npos, name.place, what,
            " needs an axis: x, y or z", name.empty() ? "" : ", not " + quoted(name.text));
    return found;
  }

 private:
  void skip_blanks() {
    const std::size_t before = next_;
    while (next_ < text_.size() && is_space(text_[next_])) {
      ++next_;
    }
    if (next_ < text_.size() && text_[next_] == '#' &&
        (next_ == 0 || next_ != before || is_space(text_[next_ - 1]))) {
      text_ = text_.substr(0, next_);
    }
  }
  /// What stands before the next one of `ends`.
  std::string_view run_until(std::string_view ends) {
    const std::size_t begin = std::exchange(next_, std::min(text_.find_first_of(ends, next_), text_.size()));
    return text_.substr(begin, next_ - begin);
  }

  static constexpr std::string_view kSpacesAndComma = ", \t\n\v\f\r", kSpaces = kSpacesAndComma.substr(1);
  std::string_view text_;
  std::uint32_t number_;
  std::size_t next_ = 0;
};

/// A clause of a statement: its word, and what reads all that follows it.
struct Clause {
  std::string_view word;
  std::function<void(const Word&)> read;
  bool repeats = false;  ///< otherwise it stands once in a statement
};

/// The clauses of one statement, in any order.
class Clauses {
 public:
  Clauses(std::string_view statement, TextLine* line) : statement_(statement), line_(line) {}

  /// Reads to the end of the line.
  void read(const std::vector<Clause>& known) {
    while (!line_->at_end()) {
      const Word word = line_->word();
      const auto clause = std::find_if(known.begin(), known.end(), [&](const Clause& each) {
        return !word.is_quoted && each.word == word.text;
      });
      if (clause == known.end()) {
        std::string names(known.front().word);
        for (std::size_t i = 1; i < known.size(); ++i) {
          names += (i + 1 < known.size() ? ", " : " and ") + std::string(known[i].word);
        }
        fail_at(word.place, quoted(word.text), " is not known in ", statement_, "; there are ", names);
      }
      fail_if(!clause->repeats && has(word.text), word.place, word.text, " is said twice in this ",
              statement_);
      said_.push_back(word.text);
      clause->read(word);
    }
  }
  bool has(std::string_view word) const { return std::find(said_.begin(), said_.end(), word) != said_.end(); }
  /// Fails at the end of the line where `word` was not said.
  void need(std::string_view word) const {
    if (!has(word)) {
      line_->at_end();
      fail_at(line_->place(), statement_, " needs ", word);
    }
  }

 private:
  std::string_view statement_;
  TextLine* line_;
  std::vector<std::string_view> said_;
};

/// Fails where the bytes are not UTF-8 text, or hold control characters.
inline void check_characters(std::string_view text) {
  TextPlace place{1, 1};
  for (std::size_t at = 0; at < text.size();) {
    unsigned code = 0;
    const std::size_t length = character_bytes(text.substr(at), &code);
    const auto byte = static_cast<unsigned char>(text[at]);
    fail_if(length == 0, place, "the bytes here are not UTF-8 text");
    const bool ends_line = byte == '\n' || byte == '\r';
    fail_if((byte < ' ' && byte != '\t' && !ends_line) || byte == 0x7F, place, "byte ", byte,
            " is a control character, not text");
    at += text.substr(at).starts_with("\r\n") ? 2 : length;
    place = ends_line ? TextPlace{place.line + 1, 1} : TextPlace{place.line, place.column + 1};
  }
}

}  // namespace thimble::tools
