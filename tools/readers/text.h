/// Lines, words and numbers of text formats: shared by the readers of `.ply`, `.obj`, `.off` and `.xyz`.
///
/// Conventions: lines count from 1 and end with LF, CRLF or a CR alone. Numbers are decimal and written with
/// a point whatever the locale says; a leading + is accepted. Nothing here allocates except to throw.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "output/progress.h"
#include "readers/input_error.h"

namespace thimble::tools {

/// Throws InputError "line LINE: SENTENCE", a sentence of these pieces.
template <class... Pieces>
[[noreturn]] void fail_at_line(std::uint64_t line, const Pieces&... pieces) {
  throw InputError("line ", line, ": ", pieces...);
}

/// Throws it where `is_wrong`.
template <class... Pieces>
void fail_at_line_if(bool is_wrong, std::uint64_t line, const Pieces&... pieces) {
  fail_if(is_wrong, "line ", line, ": ", pieces...);
}

/// `word` in single quotes for an error's sentence: cut to a length that fits on a line, bytes that do not
/// print replaced by '?'.
std::string quoted(std::string_view word);

/// Refuses a file's first bytes that are those of no text, such as an endless device's.
/// @param name  what the text would be read as
void refuse_zero_bytes(std::span<const std::uint8_t> first, const char* name);

/// What a word is when read as a number.
enum class NumberKind : std::uint8_t {
  kFinite,
  kNotFinite,  ///< "nan", "inf", or a decimal number beyond the range of double
  kGarbage,    ///< anything else, such as "1.5x", "1,5", "0x10" or nothing
};

/// Reads all of `word`. `value` is set when the result is kFinite: the double nearest to the decimal number,
/// 0 for one that is too small to be anything else.
NumberKind parse_number(std::string_view word, double& value);

/// The finite number that `word` is.
/// @param what  names the place within the line, for example "x of vertex 3"
/// @throws InputError naming the line for anything that is no finite number
double finite_number(std::string_view word, std::uint64_t line, const std::string& what);

/// The number that `word` is; NaN for one that is not finite.
/// @throws InputError naming the line for anything that is no number
double number_or_nan(std::string_view word, std::uint64_t line);

/// Reads all of `word` as an integer of 64 bits; false for anything else, and `value` is then unchanged.
bool parse_integer(std::string_view word, std::int64_t& value);

/// Blank, tab, line end, vertical tab and form feed.
inline constexpr std::string_view kSpaces = " \t\n\v\f\r";
constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// Bytes of the byte order mark that `text` begins with: 3, or none.
constexpr std::size_t mark_bytes(std::string_view text) {
  return text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
}

/// Takes the first word (a run without spaces) off the front of `line`; empty when there is none.
std::string_view take_word(std::string_view& line);

/// `text` without the spaces at its ends: a name that may hold some.
std::string_view trimmed(std::string_view text);

/// `line` up to a # that begins a comment: one at the front or after a space, comma or semicolon. (In
/// "1.#IND", which some programs write for NaN, it is part of the word.)
std::string_view without_comment(std::string_view line);

/// True when `word` equals `lower_case` but for the case of ASCII letters.
bool equals_ignoring_case(std::string_view word, std::string_view lower_case);

/// The columns of a line between commas, without the spaces around them.
std::vector<std::string_view> comma_columns(std::string_view line);
/// Whether they may be a header: none begins as a number does, which would be one gone wrong.
bool are_names(const std::vector<std::string_view>& columns);
/// Whether a header, with quotes or without, has one of `names` in the place of another. Other words say nothing.
bool misplaces(const std::vector<std::string_view>& header, std::span<const char* const> names);

/// Cuts text into lines.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  /// The next line without its end; false after the last. An empty last line is no line.
  bool next(std::string_view& line);
  /// Number of the line that `next` gave last; 0 before the first.
  std::uint64_t line_number() const { return line_number_; }
  /// Bytes consumed so far.
  std::size_t offset() const { return next_; }

 private:
  std::string_view text_;
  std::size_t next_ = 0;
  std::uint64_t line_number_ = 0;
};

/// Cuts text into words without regard to lines, but knows which line it is on.
class WordReader {
 public:
  /// @param comment     a character that hides the rest of its line where a word could start, or 0 for none
  /// @param first_line  number of the line that `text` starts with
  explicit WordReader(std::string_view text, char comment = 0, std::uint64_t first_line = 1)
      : text_(text), comment_(comment), line_(first_line) {}

  /// The next word; empty at the end of the text.
  std::string_view next();
  /// The next word if there is one on the current line; otherwise empty and nothing is consumed but spaces.
  std::string_view next_on_line();
  /// Passes over what is left of the current line.
  void skip_line();
  /// Whether so many lines with something on them follow this one.
  bool has_lines(std::uint64_t wanted) const;
  /// Line of the word that was read last, or of the line end reached by `skip_line`.
  std::uint64_t line() const { return line_; }
  std::size_t offset() const { return next_; }
  std::size_t remaining() const { return text_.size() - next_; }

 private:
  bool at_line_end() const { return text_[next_] == '\n' || text_[next_] == '\r'; }
  void pass_line_end();
  std::string_view word_here();

  std::string_view text_;
  std::size_t next_ = 0;
  char comment_;
  std::uint64_t line_;
};

/// Calls a `Progress` about once a quarter of a megabyte, or of a million voxels, so that asking costs nothing.
class ProgressMeter {
 public:
  /// Of what nobody waits for.
  ProgressMeter() = default;
  ProgressMeter(const Progress& progress, std::uint64_t total) : progress_(&progress), total_(total) {}

  void at(std::uint64_t offset) {
    if (offset >= due_) {
      due_ = offset + kStep;
      if (progress_ != nullptr && *progress_) {
        (*progress_)(std::min(1.0, static_cast<double>(offset) / static_cast<double>(total_ + 1)));
      }
    }
  }

 private:
  static constexpr std::uint64_t kStep = 1 << 18;
  const Progress* progress_ = nullptr;
  std::uint64_t total_ = 0;
  std::uint64_t due_ = kStep;
};

}  // namespace thimble::tools
