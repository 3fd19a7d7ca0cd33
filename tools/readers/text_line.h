/// The language that `.scene` statements are written in: words, numbers and clauses of one line, each with
/// the place where it stands. What the statements mean is in scene_text.cpp.
#pragma once

#include "readers/real3.h"
#include "readers/scene_text.h"

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
  TextPlace place() const;
  /// The next word, empty at the end of the line or before a comment.
  Word word();
  /// The next number: a comma may stand before it unless it is the first of several.
  Word number(bool is_first);
  /// Whether nothing but a comment is left.
  bool at_end();

  // Values, each by its name in an error's sentence and with both ends of its range.

  double real(const std::string& what, double low, double high, bool is_first = true);
  std::int32_t whole(const std::string& what, std::int32_t low, std::int32_t high, bool is_first = true);
  std::array<double, 3> three_reals(const std::string& what, double low, double high);
  Vec3i three_wholes(const std::string& what, std::int32_t low, std::int32_t high);
  /// Red, green and blue, 0 to 255 each.
  Rgb8 color();
  /// 0 to 1, as 0 to 255.
  std::uint8_t share(const char* what);
  /// In 1/256; a number that is above 0 stays above 0.
  std::uint16_t fixed_q8(const char* what, double high);
  /// x, y or z, as 0 to 2.
  std::size_t axis(const char* what);

 private:
  void skip_blanks();
  template <class Belongs>
  std::string_view run(const Belongs& belongs);

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
  void read(const std::vector<Clause>& known);
  bool has(std::string_view word) const;
  /// Fails at the end of the line where `word` was not said.
  void need(std::string_view word) const;

 private:
  std::string_view statement_;
  TextLine* line_;
  std::vector<std::string_view> said_;
};

/// Fails where the bytes are not UTF-8 text, or hold control characters.
void check_characters(std::string_view text);

}  // namespace thimble::tools
