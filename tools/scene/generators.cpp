#include "scene/generators.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "output/units.h"
#include "scene/named_scenes.h"
#include "scene/palette.h"
#include "scene/random.h"

namespace thimble::tools {
namespace {

/// Scenes are laid out in 2^20 units a world side; a voxel of a world of 2^depth is 2^(20 - depth) units.
constexpr int kWorldBits = 20;
constexpr std::int32_t kWorld = std::int32_t{1} << kWorldBits;
/// A handy fraction of the world: one voxel at the default depth of the solid scenes.
constexpr std::int32_t kStep = kWorld / 64;

using Point = std::array<std::int32_t, 3>;

struct Name {
  const char* text;
  GeneratorKind kind;
};
constexpr std::array<Name, 6> kGenerators{{{"points", GeneratorKind::kPoints},
                                           {"cluster", GeneratorKind::kCluster},
                                           {"spheres", GeneratorKind::kSpheres},
                                           {"water", GeneratorKind::kWater},
                                           {"demo", GeneratorKind::kDemo},
                                           {"valley", GeneratorKind::kDemo}}};

/// A whole number: decimal digits, or as in 1e6 and 2.5e6. Nothing for anything else, or too much for 64
/// bits.
std::optional<std::uint64_t> parse_number(const std::string& text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::size_t point = std::min(text.find('.'), e);
  if (e == text.size() || point == 0) {
    return number_in<std::uint64_t>(text);
  }
  std::string digits =
      text.substr(0, point) + text.substr(std::min(point + 1, e), e - std::min(point + 1, e));
  const auto exponent =
      e + 3 < text.size() ? std::nullopt : number_in<std::uint64_t>(std::string_view(text).substr(e + 1));
  const std::size_t fraction = digits.size() - point;
  if (!exponent || *exponent < fraction) {
    return std::nullopt;
  }
  digits.append(*exponent - fraction, '0');
  return number_in<std::uint64_t>(digits);
}

std::uint64_t parse_in_range(const std::string& name, const std::string& text, std::uint64_t low,
                             std::uint64_t high) {
  const std::optional<std::uint64_t> value = parse_number(text);
  fail_if(!value || *value < low || *value > high, name, " must be a whole number ", low, "..", high,
          ", not \"", text, "\"");
  return *value;
}

/// Takes the `key=value` list behind the generator's name apart.
void parse_options(const std::string& options, GeneratorSpec& spec) {
  bool has_seed = false;
  bool has_depth = false;
  std::size_t from = 0;
  while (from <= options.size()) {
    const std::size_t to = std::min(options.find(',', from), options.size());
    const std::string option = options.substr(from, to - from);
    const std::size_t equals = std::min(option.find('='), option.size());
    const std::string key = option.substr(0, equals);
    const std::string value = option.substr(std::min(equals + 1, option.size()));
    bool* const seen = key == "seed" ? &has_seed : key == "depth" ? &has_depth : nullptr;
    fail_if(seen == nullptr || equals == option.size(), "unknown generator option \"", option,
            "\"; there are seed=S and depth=L");
    fail_if(*seen, "generator option ", key, " is given twice");
    *seen = true;
    if (seen == &has_seed) {
      spec.seed = parse_in_range(key, value, 0, std::numeric_limits<std::uint64_t>::max());
    } else {
      spec.depth = static_cast<int>(parse_in_range(key, value, 1, 12));
    }
    from = to + 1;
  }
}

std::int64_t square(std::int64_t value) {
  return value * value;
}

std::int64_t squared_distance(const Point& a, const Point& b) {
  return square(a[0] - b[0]) + square(a[1] - b[1]) + square(a[2] - b[2]);
}

void generate_points(const GeneratorSpec& spec, const VoxelSink& sink) {
  SplitMix64 random(spec.seed);
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kWorldBits) - 1;
  const int shift = kWorldBits - spec.depth;
  for (std::uint64_t i = 0; i < spec.count; ++i) {
    const std::uint64_t bits = random.next();
    sink(static_cast<std::int32_t>((bits & kMask) >> shift),
         static_cast<std::int32_t>((bits >> kWorldBits & kMask) >> shift),
         static_cast<std::int32_t>((bits >> 2 * kWorldBits & kMask) >> shift), 0);
  }
}

// ---- cluster

struct Plummer {
  Point center;
  std::int32_t radius;  ///< the Plummer radius a, in units
  std::uint32_t until;  ///< a number below this and not below the previous sphere's picks this one
};

constexpr std::size_t kClusters = 28;

std::array<Plummer, kClusters> place_clusters(SplitMix64& random) {
  std::array<Plummer, kClusters> clusters{};
  std::uint32_t until = 0;
  for (std::size_t i = 0; i < kClusters; ++i) {
    Plummer& cluster = clusters[i];
    // Radii fall from 1/12 to about 1/150 of the world, and the members with them: a few rich
    // clusters, many poor ones.
    cluster.radius = kWorld / static_cast<std::int32_t>(12 + i * 5);
    const std::int32_t margin = std::max(kWorld / 16, cluster.radius * 2);
    for (std::int32_t& component : cluster.center) {
      component = random.between(margin, kWorld - 1 - margin);
    }
    until += static_cast<std::uint32_t>(100000 / (3 + i));
    cluster.until = until;
  }
  return clusters;
}

/// One point of a Plummer sphere, in units, not limited to the world.
///
/// The radius: the mass within r is m = (1 + a^2 / r^2)^(-3/2), so r = a / sqrt(m^(-2/3) - 1) with m uniform
/// (Sverre Aarseth, Michel Henon and Roland Wielen, "A comparison of numerical methods for the study of star
/// cluster dynamics", 1974, appendix). The cube root w of a uniform number is distributed as the largest of
/// three, so with w drawn that way r = a * w / sqrt(1 - w^2): no power function. The direction d is a lattice
/// point drawn in a ball, divided by its length: position = a * w * d / sqrt((1 - w^2) * |d|^2).
///
/// Bits: w = W / 2^20, |d| <= 2^11: (2^40 - W^2) * |d|^2 <= 2^62; a * W * d < 2^17 * 2^20 * 2^11 = 2^48.
Point plummer_offset(SplitMix64& random, std::int32_t radius) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 20) - 1;
  const std::uint64_t bits = random.next();
  const auto largest =
      static_cast<std::int64_t>(std::max({bits & kMask, bits >> 20 & kMask, bits >> 40 & kMask}));
  constexpr std::int32_t kReach = 1 << 11;
  std::array<std::int64_t, 3> direction{kReach, 0, 0};
  std::int64_t length_squared = square(kReach);
  // Just over half of the draws are in the ball; 64 misses in a row do not happen.
  for (int draw = 0; draw < 64; ++draw) {
    const std::uint64_t sides = random.next();
    std::array<std::int64_t, 3> candidate{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      candidate[axis] = static_cast<std::int64_t>(sides >> 21 * axis & 0xFFF) - kReach;
    }
    const std::int64_t norm = square(candidate[0]) + square(candidate[1]) + square(candidate[2]);
    if (norm > 0 && norm <= square(kReach)) {
      direction = candidate;
      length_squared = norm;
      break;
    }
  }
  const auto below_one = static_cast<std::uint64_t>((std::int64_t{1} << 40) - square(largest)) *
                         static_cast<std::uint64_t>(length_squared);
  const auto divisor = static_cast<std::int64_t>(integer_sqrt(below_one));
  Point offset{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    offset[axis] = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(radius * largest * direction[axis] / divisor, -kWorld, kWorld));
  }
  return offset;
}

void generate_cluster(const GeneratorSpec& spec, const VoxelSink& sink) {
  SplitMix64 random(spec.seed);
  const std::array<Plummer, kClusters> clusters = place_clusters(random);
  const int shift = kWorldBits - spec.depth;
  for (std::uint64_t i = 0; i < spec.count; ++i) {
    const std::uint32_t pick = random.below(clusters.back().until);
    const Plummer& cluster =
        *std::find_if(clusters.begin(), clusters.end(),
                      [pick](const Plummer& candidate) { return pick < candidate.until; });
    // The halo of a Plummer sphere has no end: what falls outside the world is drawn again, and after
    // 64 draws (never seen) the point stays at the centre.
    Point point = cluster.center;
    for (int draw = 0; draw < 64; ++draw) {
      const Point offset = plummer_offset(random, cluster.radius);
      bool inside = true;
      Point moved{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        moved[axis] = cluster.center[axis] + offset[axis];
        inside = inside && moved[axis] >= 0 && moved[axis] < kWorld;
      }
      if (inside) {
        point = moved;
        break;
      }
    }
    sink(point[0] >> shift, point[1] >> shift, point[2] >> shift, 0);
  }
}

// ---- solid bodies

/// The centre of voxel `index` in units.
std::int32_t voxel_center(std::int32_t index, int depth) {
  return (2 * index + 1) << (kWorldBits - 1 - depth);
}

struct Ball {
  Point center;
  std::int32_t radius;
  std::uint8_t material;
};

/// The voxels whose centre is in the ball, and the one that holds the ball's centre, so that a ball smaller
/// than a voxel does not vanish.
void fill_ball(const Ball& ball, int depth, const VoxelSink& sink) {
  const int shift = kWorldBits - depth;
  const std::int32_t side = std::int32_t{1} << depth;
  Point first{};
  Point last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::max((ball.center[axis] - ball.radius) >> shift, 0);
    last[axis] = std::min((ball.center[axis] + ball.radius) >> shift, side - 1);
  }
  for (std::int32_t z = first[2]; z <= last[2]; ++z) {
    for (std::int32_t y = first[1]; y <= last[1]; ++y) {
      const std::int64_t left = square(ball.radius) - square(voxel_center(y, depth) - ball.center[1]) -
                                square(voxel_center(z, depth) - ball.center[2]);
      for (std::int32_t x = first[0]; x <= last[0]; ++x) {
        const bool holds_center =
            x == ball.center[0] >> shift && y == ball.center[1] >> shift && z == ball.center[2] >> shift;
        if (holds_center || square(voxel_center(x, depth) - ball.center[0]) <= left) {
          sink(x, y, z, ball.material);
        }
      }
    }
  }
}

/// Radii of the balls of Figure 2's scene, in 1/64 world.
constexpr std::array<std::int32_t, 14> kBallRadii{13, 11, 10, 8, 8, 7, 6, 6, 5, 5, 4, 4, 3, 3};

void generate_spheres(const GeneratorSpec& spec, const VoxelSink& sink) {
  SplitMix64 random(spec.seed);
  std::array<Ball, kBallRadii.size()> balls{};
  for (std::size_t i = 0; i < balls.size(); ++i) {
    Ball& ball = balls[i];
    ball.radius = kBallRadii[i] * kStep;
    ball.material = static_cast<std::uint8_t>(1 + i % 7);
    // The first of the draws that keeps clear of the balls before, or the last draw.
    for (int draw = 0; draw < 400; ++draw) {
      bool clear = true;
      for (std::int32_t& component : ball.center) {
        component = random.between(ball.radius, kWorld - ball.radius);
      }
      for (std::size_t other = 0; other < i; ++other) {
        const std::int64_t gap = ball.radius + balls[other].radius + kStep;
        clear = clear && squared_distance(ball.center, balls[other].center) >= square(gap);
      }
      if (clear) {
        break;
      }
    }
    fill_ball(ball, spec.depth, sink);
  }
}

// ---- water

// Palette indices of `water`.
constexpr std::uint8_t kLagoonAir = 0;    ///< nothing there, no voxel
constexpr std::uint8_t kLagoonWater = 1;  ///< no voxel either: the palette's entry for its colour
constexpr std::uint8_t kLagoonSand = 2;
constexpr std::uint8_t kLagoonRock = 3;
constexpr std::uint8_t kLagoonGlass = 4;
constexpr std::uint8_t kLagoonMetal = 5;

constexpr std::int32_t kWallThickness = 3 * kStep;
constexpr std::int32_t kWallTop = 20 * kStep;
constexpr std::int32_t kWaterLevel = 15 * kStep;
constexpr std::int32_t kBeach = 17 * kStep;  ///< sand below, rock above

/// A hill of the ground: height * (1 - d^2 / reach^2)^2 within its reach.
struct Hill {
  std::int32_t x, y, height, reach;
};

struct Lagoon {
  std::array<Hill, 5> hills{};
  std::array<Ball, 5> floats{};
  std::size_t float_count = 0;
};

/// Height of the ground at a point of the plan, in units.
std::int32_t ground(const Lagoon& lagoon, std::int32_t x, std::int32_t y) {
  std::int64_t height = 4 * kStep;
  for (const Hill& hill : lagoon.hills) {
    const std::int64_t reach = square(hill.reach);
    const std::int64_t distance = square(x - hill.x) + square(y - hill.y);
    if (distance < reach) {
      // 0 .. 2^12, so that the product stays below 2^20 * 2^24.
      const std::int64_t nearness = 4096 - distance / (reach >> 12);
      height += hill.height * square(std::max<std::int64_t>(nearness, 0)) >> 24;
    }
  }
  return static_cast<std::int32_t>(std::min<std::int64_t>(height, kWorld - 1));
}

Lagoon lay_out(std::uint64_t seed) {
  SplitMix64 random(seed);
  Lagoon lagoon;
  Hill& island = lagoon.hills[0];
  island = {random.between(34 * kStep, 42 * kStep), random.between(34 * kStep, 42 * kStep), 20 * kStep,
            21 * kStep};
  for (std::size_t i = 1; i < lagoon.hills.size(); ++i) {
    const std::int32_t away = 12 * kStep;
    lagoon.hills[i] = {island.x + random.between(-away, away), island.y + random.between(-away, away),
                       random.between(4 * kStep, 9 * kStep), random.between(6 * kStep, 12 * kStep)};
  }
  constexpr std::array<std::int32_t, 5> kRadii{6, 5, 4, 3, 3};
  for (std::size_t i = 0; i < kRadii.size(); ++i) {
    Ball ball{{}, kRadii[i] * kStep, i % 2 == 0 ? kLagoonGlass : kLagoonMetal};
    const std::int32_t edge = kWallThickness + kStep + ball.radius;
    for (int draw = 0; draw < 400; ++draw) {
      // Glass floats higher than metal.
      ball.center = {random.between(edge, kWorld - edge), random.between(edge, kWorld - edge),
                     kWaterLevel + (ball.material == kLagoonGlass ? ball.radius / 3 : ball.radius / 8)};
      bool clear = square(ball.center[0] - island.x) + square(ball.center[1] - island.y) >=
                   square(ball.radius + 15 * kStep);
      for (std::size_t other = 0; other < lagoon.float_count; ++other) {
        const Ball& neighbour = lagoon.floats[other];
        clear = clear && squared_distance(ball.center, neighbour.center) >=
                             square(ball.radius + neighbour.radius + 2 * kStep);
      }
      if (clear) {
        lagoon.floats[lagoon.float_count++] = ball;
        break;
      }
    }
  }
  return lagoon;
}

/// Material at a point whose ground is known, or kLagoonAir.
std::uint8_t water_material(const Lagoon& lagoon, const Point& point, std::int32_t ground_height) {
  const std::int32_t rim = std::min({point[0], point[1], kWorld - point[0], kWorld - point[1]});
  if (rim < kWallThickness) {
    return point[2] < kWallTop ? kLagoonRock : kLagoonAir;
  }
  if (point[2] < ground_height) {
    return point[2] < kBeach ? kLagoonSand : kLagoonRock;
  }
  for (std::size_t i = 0; i < lagoon.float_count; ++i) {
    const Ball& ball = lagoon.floats[i];
    if (squared_distance(point, ball.center) <= square(ball.radius)) {
      return ball.material;
    }
  }
  return kLagoonAir;
}

void generate_water(const GeneratorSpec& spec, const VoxelSink& sink) {
  const Lagoon lagoon = lay_out(spec.seed);
  const std::int32_t side = std::int32_t{1} << spec.depth;
  std::int32_t float_top = 0;
  for (std::size_t i = 0; i < lagoon.float_count; ++i) {
    float_top = std::max(float_top, lagoon.floats[i].center[2] + lagoon.floats[i].radius);
  }
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      Point point{voxel_center(x, spec.depth), voxel_center(y, spec.depth), 0};
      const std::int32_t height = ground(lagoon, point[0], point[1]);
      const std::int32_t top = std::max({height, float_top, kWallTop});
      for (std::int32_t z = 0; z < side; ++z) {
        point[2] = voxel_center(z, spec.depth);
        if (point[2] > top) {
          break;
        }
        const std::uint8_t material = water_material(lagoon, point, height);
        if (material != kLagoonAir) {
          sink(x, y, z, material);
        }
      }
    }
  }
}

}  // namespace

std::uint64_t integer_sqrt(std::uint64_t value) {
  // IEEE sqrt is rounded exactly, and the two corrections make the result independent of it.
  auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(value)));
  root = std::min<std::uint64_t>(root, 0xFFFFFFFFU);
  while (root * root > value) {
    --root;
  }
  while (root < 0xFFFFFFFFU && (root + 1) * (root + 1) <= value) {
    ++root;
  }
  return root;
}

std::optional<GeneratorSpec> parse_generator(const std::string& text) {
  const std::size_t name_end = std::min(text.find_first_of(":,"), text.size());
  const std::string name = text.substr(0, name_end);
  const auto found = std::find_if(kGenerators.begin(), kGenerators.end(),
                                  [&name](const Name& entry) { return name == entry.text; });
  if (found == kGenerators.end()) {
    return std::nullopt;
  }
  const bool counted = is_counted(found->kind);
  GeneratorSpec spec{.kind = found->kind, .depth = counted ? 10 : 6};
  const bool has_count = name_end < text.size() && text[name_end] == ':';
  fail_if(counted != has_count, counted ? name + " needs a number of points, as in " + name + ":1000000"
                                        : name + " takes no number, only ,seed=S and ,depth=L");
  std::size_t options = name_end;
  if (has_count) {
    options = std::min(text.find(',', name_end), text.size());
    spec.count = parse_in_range("the number of points", text.substr(name_end + 1, options - name_end - 1), 0,
                                kMaxGeneratorPoints);
  }
  if (options < text.size()) {
    parse_options(text.substr(options + 1), spec);
  }
  return spec;
}

bool is_generator(const std::string& word) {
  try {
    return parse_generator(word).has_value();
  } catch (const InputError&) {
    return true;
  }
}

std::vector<std::string> generator_examples() {
  std::vector<std::string> examples;
  examples.reserve(kGenerators.size());
  for (const Name& name : kGenerators) {
    examples.push_back(concat(name.text, is_counted(name.kind) ? ":1000000" : ""));
  }
  return examples;
}

void generate(const GeneratorSpec& spec, const VoxelSink& sink) {
  constexpr std::array<void (*)(const GeneratorSpec&, const VoxelSink&), 5> kByKind{
      generate_points, generate_cluster, generate_spheres, generate_water, generate_demo_world};
  kByKind[static_cast<std::size_t>(spec.kind)](spec, sink);
}

std::optional<SceneCamera> generator_camera(const GeneratorSpec& spec) {
  if (spec.kind == GeneratorKind::kDemo) {
    return demo_world_camera(spec.depth);
  }
  if (spec.kind == GeneratorKind::kWater) {
    // Over the near wall, down to the island.
    const auto at = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
      const auto steps = [&](std::int32_t count) {
        return Q8::from_raw(
            static_cast<std::int32_t>(std::int64_t{count} * kStep >> (kWorldBits - spec.depth - Q8::kBits)));
      };
      return Vec3Q8{steps(x), steps(y), steps(z)};
    };
    SceneCamera camera;
    camera.eye = at(6, -22, 46);
    camera.target = at(34, 33, 11);
    camera.fov_degrees = Q16::saturate(46);
    return camera;
  }
  return std::nullopt;
}

Palette generator_palette(GeneratorKind kind) {
  if (kind == GeneratorKind::kDemo) {
    return demo_world_palette();
  }
  Palette palette;
  palette.fill(default_material());
  if (kind == GeneratorKind::kSpheres) {
    constexpr std::array<Rgb, 7> kColors{{{214, 69, 65},
                                          {244, 179, 80},
                                          {65, 131, 196},
                                          {38, 166, 120},
                                          {155, 89, 182},
                                          {236, 240, 241},
                                          {230, 126, 34}}};
    for (std::size_t i = 0; i < kColors.size(); ++i) {
      palette[i + 1] = colored(kColors[i]);
    }
  }
  if (kind == GeneratorKind::kWater) {
    palette[kLagoonWater] = {
        .color = {70, 160, 172}, .alpha = 128, .kind = SurfaceKind::kGlass, .ior = 1.33, .transparency = 1};
    palette[kLagoonSand] = colored({226, 200, 144});
    palette[kLagoonRock] = colored({124, 116, 110});
    palette[kLagoonGlass] = {.color = {206, 238, 226},
                             .alpha = 64,
                             .kind = SurfaceKind::kGlass,
                             .ior = 1.5,
                             .attenuation = 0.1,
                             .transparency = 1};
    palette[kLagoonMetal] = {.color = {226, 178, 82}, .kind = SurfaceKind::kMetal, .metalness = 0.85};
  }
  return palette;
}

LitDescription generator_lighting(const GeneratorSpec& spec) {
  LitDescription lit = describe_palette(generator_palette(spec.kind));
  if (spec.kind == GeneratorKind::kDemo) {
    demo_world_light(&lit);
  }
  if (spec.kind != GeneratorKind::kWater) {
    return lit;
  }
  // From the left and over the viewer's shoulder: the island's shadow falls across the water.
  lit.lights.push_back({false, {-12, -7, 11}, {300, 282, 246}});
  lit.rest.has_shadows = true;
  lit.rest.has_sky = true;
  lit.rest.ambient_q8[0] = 92;
  lit.rest.ambient_q8[1] = 104;
  lit.rest.ambient_q8[2] = 120;
  // As clear at every depth: a finer world has more voxels on the same way.
  for (const std::uint8_t clear : {kLagoonWater, kLagoonGlass}) {
    PackedU16& density = lit.surfaces[clear].density_q8;
    density = static_cast<std::uint16_t>(std::max(1, (density << 6) >> spec.depth));
  }
  // The columns between the walls, from the ground of the world up to the level; sand and rock take
  // precedence.
  std::int32_t first = 0;
  while (voxel_center(first, spec.depth) < kWallThickness) {
    ++first;
  }
  const std::int32_t columns = (std::int32_t{1} << spec.depth) - 2 * first;
  lit.rest.has_water = true;
  lit.rest.water =
      still_water({first, first, 0}, columns, columns, kWaterLevel >> (kWorldBits - spec.depth - Q8::kBits));
  lit.rest.water_material = lit.surfaces[kLagoonWater];
  return lit;
}

}  // namespace thimble::tools
