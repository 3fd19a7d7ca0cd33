#include "readers/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "output/units.h"

namespace thimble::tools {

namespace {

/// Decides a number that is out of range: too small (it reads as 0) or too large. Only the magnitude of the
/// text matters, so no arithmetic is needed: a written exponent has the sign of the answer unless the
/// mantissa has hundreds of digits, and without one it is a matter of digits before the point.
bool is_too_small(std::string_view word) {
  const std::size_t e = word.find_first_of("eE");
  if (e != std::string_view::npos) {
    return e + 1 < word.size() && word[e + 1] == '-';
  }
  std::size_t first = word.find_first_not_of("-0");
  return first != std::string_view::npos && word[first] == '.';
}

}  // namespace

std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 32;
  std::string out = "'";
  for (const char c : word.substr(0, kLongest)) {
    out += (c >= ' ' && c <= '~') ? c : '?';
  }
  out += word.size() > kLongest ? "...'" : "'";
  return out;
}

void refuse_zero_bytes(std::span<const std::uint8_t> first, const char* name) {
  const auto zero = std::find(first.begin(), first.end(), std::uint8_t{0});
  fail_if(zero != first.end(), "holds a zero byte at byte offset ", zero - first.begin(),
          ", and text, as which it would be read (", name, "), holds none");
}

NumberKind parse_number(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
    word.remove_prefix(1);
  }
  double parsed = 0;
  const char* end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, parsed);
  if (result.ec == std::errc::invalid_argument || result.ptr != end) {
    return NumberKind::kGarbage;
  }
  if (result.ec == std::errc::result_out_of_range) {
    if (!is_too_small(word)) {
      return NumberKind::kNotFinite;
    }
    parsed = 0;
  }
  if (!std::isfinite(parsed)) {
    return NumberKind::kNotFinite;
  }
  value = parsed;
  return NumberKind::kFinite;
}

double finite_number(std::string_view word, std::uint64_t line, const std::string& what) {
  double value = 0;
  switch (parse_number(word, value)) {
    case NumberKind::kFinite:
      return value;
    case NumberKind::kNotFinite:
      fail_at_line(line, what, " is ", quoted(word), ", which is not finite");
    case NumberKind::kGarbage:
      break;
  }
  fail_at_line_if(word.empty(), line, what, " is missing");
  fail_at_line(line, what, " is ", quoted(word), ", which is not a number");
}

double number_or_nan(std::string_view word, std::uint64_t line) {
  double value = std::nan("");
  if (parse_number(word, value) == NumberKind::kGarbage) {
    fail_at_line(line, quoted(word), " is not a number");
  }
  return value;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
    word.remove_prefix(1);
  }
  const auto parsed = number_in<std::int64_t>(word);
  value = parsed.value_or(value);
  return parsed.has_value();
}

std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_space(line[begin])) {
    ++begin;
  }
  std::size_t end = begin;
  while (end < line.size() && !is_space(line[end])) {
    ++end;
  }
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
  return text.substr(0, text.find_last_not_of(kSpaces) + 1);
}

std::string_view without_comment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
    if (at == 0 || is_space(line[at - 1]) || line[at - 1] == ',' || line[at - 1] == ';') {
      return line.substr(0, at);
    }
  }
  return line;
}

bool equals_ignoring_case(std::string_view word, std::string_view lower_case) {
  if (word.size() != lower_case.size()) {
    return false;
  }
  for (std::size_t i = 0; i < word.size(); ++i) {
    const char c = word[i];
    if ((c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) != lower_case[i]) {
      return false;
    }
  }
  return true;
}

std::vector<std::string_view> comma_columns(std::string_view line) {
  std::vector<std::string_view> columns;
  for (;;) {
    const std::size_t comma = line.find(',');
    columns.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) {
      return columns;
    }
    line.remove_prefix(comma + 1);
  }
}

bool are_names(const std::vector<std::string_view>& columns) {
  return std::all_of(columns.begin(), columns.end(), [](std::string_view column) {
    column.remove_prefix(column.starts_with('+') ? 1 : 0);
    double number = 0;
    return std::from_chars(column.data(), column.data() + column.size(), number).ec ==
           std::errc::invalid_argument;
  });
}

bool misplaces(const std::vector<std::string_view>& header, std::span<const char* const> names) {
  for (std::size_t i = 0; i < header.size(); ++i) {
    std::string_view name = header[i];
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') {
      name = name.substr(1, name.size() - 2);
    }
    for (std::size_t place = 0; place < names.size(); ++place) {
      if (place != i && equals_ignoring_case(name, names[place])) {
        return true;
      }
    }
  }
  return false;
}

bool LineReader::next(std::string_view& line) {
  if (next_ >= text_.size()) {
    return false;
  }
  const std::size_t begin = next_;
  std::size_t end = begin;
  while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') {
    ++end;
  }
  line = text_.substr(begin, end - begin);
  next_ = end;
  if (next_ < text_.size()) {
    next_ += text_.substr(next_, 2) == "\r\n" ? std::size_t{2} : std::size_t{1};
  }
  ++line_number_;
  return true;
}

void WordReader::pass_line_end() {
  next_ += text_.substr(next_, 2) == "\r\n" ? std::size_t{2} : std::size_t{1};
  ++line_;
}

bool WordReader::has_lines(std::uint64_t wanted) const {
  WordReader rest = *this;
  rest.skip_line();
  while (wanted > 0 && !rest.next().empty()) {
    rest.skip_line();
    --wanted;
  }
  return wanted == 0;
}

void WordReader::skip_line() {
  while (next_ < text_.size() && !at_line_end()) {
    ++next_;
  }
}

std::string_view WordReader::word_here() {
  const std::size_t begin = next_;
  while (next_ < text_.size() && !is_space(text_[next_])) {
    ++next_;
  }
  return text_.substr(begin, next_ - begin);
}

std::string_view WordReader::next_on_line() {
  while (next_ < text_.size() && !at_line_end() && is_space(text_[next_])) {
    ++next_;
  }
  if (next_ < text_.size() && comment_ != 0 && text_[next_] == comment_) {
    skip_line();
  }
  return word_here();
}

std::string_view WordReader::next() {
  for (;;) {
    const std::string_view word = next_on_line();
    if (!word.empty() || next_ >= text_.size()) {
      return word;
    }
    pass_line_end();
  }
}

}  // namespace thimble::tools
