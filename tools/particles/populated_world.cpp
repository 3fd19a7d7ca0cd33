#include "particles/populated_world.h"

#include <algorithm>
#include <cmath>

#include "apps/ball_color.h"
#include "output/units.h"
#include "particles/line_words.h"
#include "readers/source.h"

namespace thimble::tools {
namespace {

constexpr double kOneQ16 = 65536;
constexpr std::int32_t kSearchCells = 64;
constexpr std::uint32_t kSpareBalls = 1000;

ParticleConfig config_of(const WorldOptions& options) {
  ParticleConfig config = options;
  config.capacity = std::min(kMaxBalls, std::max(2 * options.count, kSpareBalls));
  config.most_diameter = kMaxBallDiameter;  // so that larger ones can come later
  config.restitution_q16 = restitution_q16(options.bounciness);
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

// The next line that has anything on it.
std::optional<LineWords> next_line(LineReader* lines) {
  std::string_view line;
  while (lines->next(line)) {
    if (!trimmed(line).empty()) {
      return LineWords(lines->line_number(), line);
    }
  }
  return std::nullopt;
}

}  // namespace

std::uint32_t restitution_q16(double bounciness) {
  return static_cast<std::uint32_t>(std::lround(bounciness * kOneQ16));
}

PopulatedWorld::PopulatedWorld(const WorldOptions& options, const std::optional<Bodies>& bodies)
    : options_(options), bodies_(bodies), bytes_(particles_bytes(config_of(options))) {
  const std::uint32_t came = fill();
  if (bodies_) {
    fail_if(came == 0 && options_.count != 0, "none of the ", grouped(options_.count),
            " bodies lies in a box of ", options_.width, " x ", options_.height, " cells");
    return;
  }
  fail_if(came != options_.count, grouped(options_.count), " balls of ", options_.least_diameter, " to ",
          options_.most_diameter, " cells do not fit into ", options_.width, " x ", options_.height,
          " cells; ", grouped(came), " did");
}

std::uint32_t PopulatedWorld::fill() {
  fail_if(ParticleWorld::make(config_of(options_), {bytes_.data(), bytes_.size()}, &world_) != Status::kOk ||
              world_.set_diameters(options_.least_diameter, options_.most_diameter) != Status::kOk,
          "a value of the world is beyond its limits");
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

Bodies read_bodies(std::string_view text) {
  constexpr std::int64_t kMostBodies = 1'000'000'000;
  const std::string too_many = " is one value too many";
  LineReader lines(text);
  auto words = next_line(&lines);
  fail_if(!words, "the file holds no bodies");
  const std::int64_t announced = words->whole("the number of bodies", 0, kMostBodies);
  words->end(too_many);
  words = next_line(&lines);
  fail_if(!words, "the radius of the world, on the second line, is missing");
  Bodies result;
  result.radius = words->number("the radius of the world", true);
  words->end(too_many);
  while ((words = next_line(&lines))) {
    words->fail_if(static_cast<std::int64_t>(result.bodies.size()) == announced, words->rest(),
                   "there are more bodies than the ", announced, " announced");
    Body body;
    body.x = words->number("x");
    body.y = words->number("y");
    body.vx = words->number("vx");
    body.vy = words->number("vy");
    body.mass = words->number("the mass", true);
    const auto channel = [&](const char* name) {
      return static_cast<std::uint8_t>(words->whole(name, 0, 255));
    };
    body.color.r = channel("red");
    body.color.g = channel("green");
    body.color.b = channel("blue");
    words->end(too_many);
    result.bodies.push_back(body);
  }
  fail_if(static_cast<std::int64_t>(result.bodies.size()) != announced, "the file ends after ",
          result.bodies.size(), " of the ", announced, " bodies announced");
  return result;
}

}  // namespace thimble::tools
