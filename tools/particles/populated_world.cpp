#include "particles/populated_world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/ball_color.h"
#include "output/units.h"
#include "readers/source.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr double kOneQ16 = 65536;
constexpr std::int32_t kSearchCells = 64;
constexpr std::uint32_t kSpareBalls = 1000;

ParticleConfig config_of(const WorldOptions& options) {
  ParticleConfig config;
  config.width = options.width;
  config.height = options.height;
  config.capacity = std::min(kMaxBalls, std::max(2 * options.count, kSpareBalls));
  config.least_diameter = options.least_diameter;
  config.most_diameter = kMaxBallDiameter;  // so that larger ones can come later
  config.restitution_q16 = restitution_q16(options.bounciness);
  config.gravity_q16 = options.gravity_q16;
  config.seed = options.seed;
  config.substeps_log2 = options.substeps_log2;
  config.subpixel_bits = options.subpixel_bits;
  return config;
}

// The cells within kSearchCells, the nearest first; those of one distance in reading order.
std::vector<Vec2i> places_around() {
  const auto square = [](const Vec2i& place) { return place.x * place.x + place.y * place.y; };
  std::vector<Vec2i> places;
  for (std::int32_t y = -kSearchCells; y <= kSearchCells; ++y) {
    for (std::int32_t x = -kSearchCells; x <= kSearchCells; ++x) {
      if (square({x, y}) <= kSearchCells * kSearchCells) {
        places.push_back({x, y});
      }
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [&](const Vec2i& one, const Vec2i& other) { return square(one) < square(other); });
  return places;
}

std::int32_t to_q16(double cells) {
  return static_cast<std::int32_t>(std::lround(cells * kOneQ16));
}

}  // namespace

std::uint32_t restitution_q16(double bounciness) {
  return static_cast<std::uint32_t>(std::lround(bounciness * kOneQ16));
}

PopulatedWorld::PopulatedWorld(const WorldOptions& options, const std::optional<Bodies>& bodies)
    : options_(options), bodies_(bodies), bytes_(particles_bytes(config_of(options))) {
  const std::uint32_t came = fill();
  if (bodies_) {
    if (came == 0 && options_.count != 0) {
      throw InputError("none of the " + grouped(options_.count) + " bodies lies in a box of " +
                       std::to_string(options_.width) + " x " + std::to_string(options_.height) + " cells");
    }
    return;
  }
  if (came != options_.count) {
    throw InputError(grouped(options_.count) + " balls of " + std::to_string(options_.least_diameter) +
                     " to " + std::to_string(options_.most_diameter) + " cells do not fit into " +
                     std::to_string(options_.width) + " x " + std::to_string(options_.height) + " cells; " +
                     grouped(came) + " did");
  }
}

std::uint32_t PopulatedWorld::fill() {
  if (ParticleWorld::make(config_of(options_), {bytes_.data(), bytes_.size()}, &world_) != Status::kOk ||
      world_.set_diameters(options_.least_diameter, options_.most_diameter) != Status::kOk) {
    throw InputError("a value of the world is beyond its limits");
  }
  if (bodies_) {
    place_bodies();
    return world_.count();
  }
  const std::int32_t speed = to_q16(options_.speed);
  while (world_.count() < options_.count && world_.spawn_random(speed) == Status::kOk) {
  }
  return world_.count();
}

void PopulatedWorld::place_bodies() {
  placing_ = {};
  colors_.clear();
  const std::vector<Body>& bodies = bodies_->bodies;
  const std::size_t count = std::min<std::size_t>(bodies.size(), options_.count);
  const double scale = std::min(options_.width, options_.height) / (2 * bodies_->radius);
  const auto column_of = [&](const Body& body) { return options_.width / 2.0 + body.x * scale; };
  const auto row_of = [&](const Body& body) { return options_.height / 2.0 - body.y * scale; };
  const auto is_inside = [&](const Body& body) {
    const double x = column_of(body);
    const double y = row_of(body);
    return x >= 0 && y >= 0 && x < options_.width && y < options_.height;
  };
  double heaviest = 0;
  double fastest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_inside(bodies[i])) {
      heaviest = std::max(heaviest, bodies[i].mass);
      fastest = std::max({fastest, std::abs(bodies[i].vx), std::abs(bodies[i].vy)});
    }
  }
  const std::vector<Vec2i> places = places_around();
  const double speed_scale = fastest > 0 ? options_.speed / fastest : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Body& body = bodies[i];
    if (!is_inside(body)) {
      ++placing_.outside;
      continue;
    }
    const auto diameter = std::clamp(
        static_cast<std::int32_t>(std::lround(options_.most_diameter * std::sqrt(body.mass / heaviest))),
        options_.least_diameter, options_.most_diameter);
    const std::int32_t x = to_q16(column_of(body));
    const std::int32_t y = to_q16(row_of(body));
    const std::int32_t vx = to_q16(body.vx * speed_scale);
    const std::int32_t vy = to_q16(-body.vy * speed_scale);
    const auto* const free_place =
        std::find_if(places.data(), places.data() + places.size(), [&](const Vec2i& place) {
          return world_.spawn(x + place.x * 65536, y + place.y * 65536, vx, vy, diameter, nullptr) ==
                 Status::kOk;
        });
    const bool is_placed = free_place != places.data() + places.size();
    placing_.moved += is_placed && free_place != places.data() ? 1U : 0U;
    if (!is_placed) {
      ++placing_.crowded;
      continue;
    }
    ++placing_.placed;
    colors_.push_back(body.color);
  }
}

Rgb8 PopulatedWorld::color_of(const Particle& ball) const {
  if (ball.id < colors_.size()) {
    return ball.asleep ? apps::resting(colors_[ball.id]) : colors_[ball.id];
  }
  return apps::ball_color(ball.diameter, ball.asleep);
}

void PopulatedWorld::begin_again(const WorldOptions& options) {
  const std::uint32_t count = std::min(options.count, world_.config().capacity);
  options_ = options;
  options_.count = count;
  const std::size_t needed = particles_bytes(config_of(options_));
  if (needed > bytes_.size()) {
    bytes_.resize(needed);
  }
  fill();
}

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
