#include "readers/text_line.h"

#include <algorithm>

#include "output/units.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

}  // namespace

void check_characters(std::string_view text) {
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

TextPlace TextLine::place() const {
  const auto before = text_.substr(0, next_);
  const auto characters =
      std::count_if(before.begin(), before.end(), [](char c) { return !is_continuation(c); });
  return {number_, static_cast<std::uint32_t>(characters) + 1};
}

void TextLine::skip_blanks() {
  const std::size_t before = next_;
  while (next_ < text_.size() && is_space(text_[next_])) {
    ++next_;
  }
  if (next_ < text_.size() && text_[next_] == '#' &&
      (next_ == 0 || next_ != before || is_space(text_[next_ - 1]))) {
    text_ = text_.substr(0, next_);
  }
}

template <class Belongs>
std::string_view TextLine::run(const Belongs& belongs) {
  const std::size_t begin = next_;
  while (next_ < text_.size() && belongs(text_[next_])) {
    ++next_;
  }
  return text_.substr(begin, next_ - begin);
}

Word TextLine::word() {
  skip_blanks();
  Word result;
  result.place = place();
  if (next_ == text_.size() || text_[next_] != '"') {
    result.text = run([](char c) { return !is_space(c); });
    return result;
  }
  const std::size_t end = text_.find('"', next_ + 1);
  fail_if(end == std::string_view::npos, result.place, "the quotation mark is not closed on this line");
  result.text = text_.substr(next_ + 1, end - next_ - 1);
  result.is_quoted = true;
  next_ = end + 1;
  fail_if(next_ < text_.size() && !is_space(text_[next_]), place(), "a blank must follow the quotation mark");
  return result;
}

Word TextLine::number(bool is_first) {
  skip_blanks();
  if (!is_first && next_ < text_.size() && text_[next_] == ',') {
    ++next_;
    skip_blanks();
  }
  Word result;
  result.place = place();
  result.text = run([](char c) { return !is_space(c) && c != ','; });
  return result;
}

bool TextLine::at_end() {
  skip_blanks();
  return next_ == text_.size();
}

double TextLine::real(const std::string& what, double low, double high, bool is_first) {
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

std::int32_t TextLine::whole(const std::string& what, std::int32_t low, std::int32_t high, bool is_first) {
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

std::array<double, 3> TextLine::three_reals(const std::string& what, double low, double high) {
  return {real("x of " + what, low, high), real("y of " + what, low, high, false),
          real("z of " + what, low, high, false)};
}

Vec3i TextLine::three_wholes(const std::string& what, std::int32_t low, std::int32_t high) {
  return {whole("x of " + what, low, high), whole("y of " + what, low, high, false),
          whole("z of " + what, low, high, false)};
}

Rgb8 TextLine::color() {
  const auto channel = [this](const char* name, bool is_first) {
    return static_cast<std::uint8_t>(whole(name, 0, 255, is_first));
  };
  return {channel("red", true), channel("green", false), channel("blue", false)};
}

std::uint8_t TextLine::share(const char* what) {
  return static_cast<std::uint8_t>(to_fixed(real(what, 0, 1), 255));
}

std::uint16_t TextLine::fixed_q8(const char* what, double high) {
  const double value = real(what, 0, high);
  return static_cast<std::uint16_t>(std::clamp(to_fixed(value, 256), value > 0 ? 1 : 0, 65535));
}

std::size_t TextLine::axis(const char* what) {
  const Word name = word();
  const std::size_t found = std::string_view("xyz").find(name.text);
  fail_if(name.text.size() != 1 || found == std::string_view::npos, name.place, what,
          " needs an axis: x, y or z", name.empty() ? "" : ", not " + quoted(name.text));
  return found;
}

void Clauses::read(const std::vector<Clause>& known) {
  while (!line_->at_end()) {
    const Word word = line_->word();
    const auto clause =
        std::find_if(known.begin(), known.end(), [&](const Clause& each) { return each.word == word.text; });
    if (clause == known.end()) {
      std::string names(known.front().word);
      for (std::size_t i = 1; i < known.size(); ++i) {
        names += (i + 1 < known.size() ? ", " : " and ") + std::string(known[i].word);
      }
      fail_at(word.place, quoted(word.text), " is not known in ", statement_, "; there are ", names);
    }
    fail_if(!clause->repeats && has(word.text), word.place, word.text, " is said twice in this ", statement_);
    said_.push_back(word.text);
    clause->read(word);
  }
}

bool Clauses::has(std::string_view word) const {
  return std::find(said_.begin(), said_.end(), word) != said_.end();
}

void Clauses::need(std::string_view word) const {
  if (!has(word)) {
    line_->at_end();
    fail_at(line_->place(), statement_, " needs ", word);
  }
}

}  // namespace thimble::tools
