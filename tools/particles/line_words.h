/// A line of words and numbers whose errors say where in it they are.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "readers/text.h"

namespace thimble::tools {

/// All errors are InputError "line LINE, column COLUMN: SENTENCE".
class LineWords {
 public:
  LineWords(std::uint64_t number, std::string_view line) : number_(number), line_(line), rest_(line) {}

  std::string_view rest() const { return rest_; }
  /// Goes on with `part` of the line.
  void enter(std::string_view part) { rest_ = part; }
  /// The column is where `word` begins.
  template <class... Pieces>
  void fail_if(bool is_wrong, std::string_view word, const Pieces&... pieces) const {
    tools::fail_if(is_wrong, "line ", number_, ", column ", word.data() - line_.data() + 1, ": ", pieces...);
  }
  /// The next word; `what` names it in the error that there is none.
  std::string_view word(const std::string& what) {
    const std::string_view word = take_word(rest_);
    fail_if(word.empty(), rest_, what, " is missing");
    return word;
  }
  std::int64_t whole(const std::string& what, std::int64_t low, std::int64_t high) {
    return whole_of(word(what), what, low, high);
  }
  /// A word, or a part of one, as a number.
  std::int64_t whole_of(std::string_view text, const std::string& what, std::int64_t low,
                        std::int64_t high) const {
    std::int64_t value = 0;
    if (!parse_integer(text, value) || value < low || value > high) {
      fail_if(true, text, what, " is ", quoted(text), ", which is not a whole number from ", low, " to ",
              high);
    }
    return value;
  }
  double number(const std::string& what, bool is_above_0 = false) {
    const std::string_view text = word(what);
    double value = 0;
    const NumberKind kind = parse_number(text, value);
    if (kind != NumberKind::kFinite || (is_above_0 && value <= 0)) {
      fail_if(true, text, what, " is ", quoted(text), ", which is not ",
              kind == NumberKind::kFinite      ? "above 0"
              : kind == NumberKind::kNotFinite ? "a finite number"
                                               : "a number");
    }
    return value;
  }
  /// Nothing may follow; `fault` says of a word that does what is wrong with it.
  void end(const std::string& fault) {
    const std::string_view more = take_word(rest_);
    fail_if(!more.empty(), more, quoted(more), fault);
  }

 private:
  std::uint64_t number_;
  std::string_view line_;
  std::string_view rest_;
};

}  // namespace thimble::tools
