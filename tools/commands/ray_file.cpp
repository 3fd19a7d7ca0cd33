// Lines of text as rays: numbers by std::from_chars, a chunk at a time.
#include "commands/ray_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "output/units.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// The six numbers of a line, or nothing when it does not hold just six numbers.
std::optional<std::array<double, 6>> parse_line(std::string_view line) {
  std::array<double, 6> numbers{};
  const char* at = line.data();
  const char* end = at + line.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t')) {
      ++at;
    }
  };
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    skip_blanks();
    if (end - at > 1 && *at == '+' && at[1] != '-') {
      ++at;
    }
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    if (error == std::errc::result_out_of_range) {
      // Too large or too small for a double: infinite or zero, which the caller judges.
      numbers[i] = std::strtod(std::string(at, next).c_str(), nullptr);
    } else if (error != std::errc{}) {
      return std::nullopt;
    }
    at = next;
    skip_blanks();
    if (i + 1 < numbers.size() && (at == end || *at++ != ',')) {
      return std::nullopt;
    }
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

// The ray as it is traced: origin to the nearest 1/256 voxel; a direction of integers within the limit as it
// is, any other scaled so that its largest component is the limit. A zero component stays zero.
// Otherwise the answer is what is wrong.
std::string quantise(const std::array<double, 6>& numbers, const RayRules& rules, Ray* to) {
  const double low = static_cast<double>(kMinOriginWorlds) * (1 << rules.level);
  const double high = static_cast<double>(kMaxOriginWorlds) * (1 << rules.level);
  for (const double number : numbers) {
    if (!std::isfinite(number)) {
      return "a ray has a coordinate that is not a finite number";
    }
  }
  Ray& ray = *to;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis)];
    if (value < low || value > high) {
      return "the origin's " + shortest(value) + " is outside the accepted " + shortest(low) + " to " +
             shortest(high) + " (-4 to 5 world sizes)";
    }
    ray.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(std::lround(value * Q8::kOne)));
  }
  double largest = 0;
  bool whole = true;
  for (std::size_t i = 3; i < 6; ++i) {
    largest = std::max(largest, std::abs(numbers[i]));
    whole = whole && numbers[i] == std::trunc(numbers[i]);
  }
  if (largest == 0) {
    return "the direction is zero";
  }
  const double limit = rules.direction_bits == 0 ? kMaxDirection : (1 << rules.direction_bits) - 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis) + 3];
    const double scaled = whole && largest <= limit ? value : value / largest * limit;
    ray.direction[axis] = static_cast<std::int32_t>(std::lround(scaled));
  }
  if (rules.only_32 && !accepts_32(ray, rules.level)) {
    return "--engine ray32 does not take this ray; auto does";
  }
  return {};
}

// Whether a line holds names only: a header. A line with a number among its columns is a ray gone wrong.
bool is_header(std::string_view line) {
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view column = line.substr(0, comma);
    column.remove_prefix(std::min(column.find_first_not_of(" \t+"), column.size()));
    double number = 0;
    if (std::from_chars(column.data(), column.data() + column.size(), number).ec !=
        std::errc::invalid_argument) {
      return false;
    }
    if (comma == std::string_view::npos) {
      return true;
    }
    line.remove_prefix(comma + 1);
  }
}

// Takes the next line off `text`.
std::string_view next_line(std::string_view* text) {
  const std::size_t end = std::min(text->find('\n'), text->size());
  std::string_view line = text->substr(0, end);
  text->remove_prefix(std::min(end + 1, text->size()));
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  return line;
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t") == std::string_view::npos;
}

// About so many bytes a chunk, some thousand rays.
constexpr std::size_t kChunkBytes = 256 << 10;

}  // namespace

RayFile::RayFile(std::string_view text, const RayRules& rules) : text_(text), rules_(rules) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string_view rest = text;
  rest.remove_prefix(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  // Up to the first ray.
  bool header = false;
  while (!rest.empty()) {
    std::string_view after = rest;
    const std::string_view line = next_line(&after);
    if (!is_blank(line)) {
      if (header || parse_line(line) || !is_header(line)) {
        break;
      }
      header = true;
    }
    rest = after;
    ++first_line_;
  }
  begin_ = text.size() - rest.size();
  for (std::size_t at = begin_; at < text.size();) {
    const std::size_t end = text.find('\n', std::min(at + kChunkBytes, text.size()));
    at = end == std::string_view::npos ? text.size() : end + 1;
    ends_.push_back(at);
  }
}

std::optional<RayFault> RayFile::read(std::size_t chunk, std::vector<Ray>* rays, std::size_t* lines) const {
  const std::size_t begin = chunk == 0 ? begin_ : ends_[chunk - 1];
  std::string_view text = text_.substr(begin, ends_[chunk] - begin);
  rays->clear();
  for (*lines = 0; !text.empty(); ++*lines) {
    const std::string_view line = next_line(&text);
    if (is_blank(line)) {
      continue;
    }
    const auto numbers = parse_line(line);
    if (!numbers) {
      return RayFault{*lines, "these are not the six numbers ox,oy,oz,dx,dy,dz"};
    }
    std::string fault = quantise(*numbers, rules_, &rays->emplace_back());
    if (!fault.empty()) {
      return RayFault{*lines, std::move(fault)};
    }
  }
  return std::nullopt;
}

}  // namespace thimble::tools
