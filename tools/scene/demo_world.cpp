#include "scene/generators.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "scene/palette.h"
#include "scene/random.h"

namespace thimble::tools {
namespace {

// Lengths are in 1/256 of a unit, a unit is 1/64 of the world: the world is 2^14 a side, a voxel of a world
// of 2^depth is 2^(14 - depth).
constexpr int kDemoBits = 14;
constexpr std::int32_t kUnit = 256;
constexpr std::int32_t kMiddle = 32 * kUnit;

enum Tone : std::uint8_t {
  kAir = 0,
  kWater,
  kSand,
  kGrass,
  kMeadow,
  kRock,
  kCliff,
  kSnow,
  kWall,
  kRoof,
  kLeaves,
  kWood,
  kRoad,
  kGroundOnly = 255,  ///< an opening in what was built, not in the ground
};

// ---- ground

/// A number 0..255 for a point of a square lattice.
std::int32_t lattice_noise(std::uint64_t seed, std::int32_t x, std::int32_t y) {
  return static_cast<std::int32_t>(
      SplitMix64(seed ^ (static_cast<std::uint64_t>(x) << 32 | static_cast<std::uint32_t>(y))).next() >> 56);
}

/// Smooth noise, -256..256: lattice points `cell` apart, blended by 3t^2 - 2t^3.
std::int32_t noise(std::uint64_t seed, std::int32_t x, std::int32_t y, std::int32_t cell) {
  const auto blend = [cell](std::int32_t along) {
    const std::int32_t t = along * 256 / cell;
    return t * t * (768 - 2 * t) >> 16;
  };
  const std::int32_t column = x / cell;
  const std::int32_t row = y / cell;
  const std::int32_t right = blend(x % cell);
  const std::int32_t up = blend(y % cell);
  const auto mix = [right](std::int32_t a, std::int32_t b) { return a * (256 - right) + b * right; };
  const std::int32_t low = mix(lattice_noise(seed, column, row), lattice_noise(seed, column + 1, row));
  const std::int32_t high =
      mix(lattice_noise(seed, column, row + 1), lattice_noise(seed, column + 1, row + 1));
  return (low * (256 - up) + high * up) / 32768 - 255;
}

struct ProfilePoint {
  std::int32_t distance, height;  ///< in units
};

template <std::size_t kCount>
std::int32_t profile(const std::array<ProfilePoint, kCount>& points, std::int32_t distance) {
  if (distance <= points.front().distance * kUnit) {
    return points.front().height * kUnit;
  }
  for (std::size_t i = 1; i < kCount; ++i) {
    const ProfilePoint& from = points[i - 1];
    const ProfilePoint& to = points[i];
    if (distance < to.distance * kUnit) {
      return from.height * kUnit +
             (distance - from.distance * kUnit) * (to.height - from.height) / (to.distance - from.distance);
    }
  }
  return points.back().height * kUnit;
}

constexpr std::int32_t kLakeTop = 6 * kUnit;
/// Below it the ground lies in terraces, above it in layers of cliff.
constexpr std::int32_t kTerraceTop = 16 * kUnit;
constexpr std::int32_t kSnowLine = 34 * kUnit;

/// Height of the ground by the distance from the castle: lake, shore, terraces, mountains.
constexpr std::array<ProfilePoint, 7> kValley{
    {{16, 3}, {19, 7}, {27, 12}, {28, 18}, {32, 32}, {38, 40}, {45, 44}}};
constexpr std::array<ProfilePoint, 4> kCrag{{{8, 14}, {10, 10}, {12, 7}, {14, 2}}};

/// The middle of the square of `units` units a side that holds a place.
std::int32_t snapped(std::int32_t place, std::int32_t units) {
  const std::int32_t side = units * kUnit;
  return place - place % side + side / 2;
}

std::int32_t distance_of(std::int32_t dx, std::int32_t dy) {
  return static_cast<std::int32_t>(
      integer_sqrt(static_cast<std::uint64_t>(std::int64_t{dx} * dx + std::int64_t{dy} * dy)));
}

std::int32_t valley(std::uint64_t seed, std::int32_t x, std::int32_t y) {
  const std::int32_t dx = x - kMiddle;
  const std::int32_t dy = y - kMiddle;
  const std::int32_t coarse = noise(seed, x, y, 12 * kUnit);
  const std::int32_t fine = noise(seed + 1, x, y, 5 * kUnit);
  std::int32_t height = profile(kValley, distance_of(dx, dy) + coarse * 2 + fine / 2);
  if (height > kTerraceTop) {
    height += (height - kTerraceTop) / 256 * (coarse * 3 + fine) / 8;
  }
  // The river leaves by a gorge.
  if (dy < -14 * kUnit) {
    const std::int32_t beside = std::max(dx, -dx) + coarse;
    height = std::min(height, std::max(beside - 2 * kUnit, 0) * 5 + 3 * kUnit);
  }
  return height;
}

std::int32_t ground_height(std::uint64_t seed, std::int32_t x, std::int32_t y) {
  // Mountains are blocks of rock, so that small pictures show planes and not a thicket of edges.
  std::int32_t height = valley(seed, snapped(x, 4), snapped(y, 4));
  if (height > kTerraceTop) {
    height -= height % (4 * kUnit);
  } else {
    const std::int32_t distance = distance_of(x - kMiddle, y - kMiddle);
    height = std::min(valley(seed, x, y), kTerraceTop);
    height = std::max(height, profile(kCrag, distance + noise(seed + 1, x, y, 5 * kUnit) / 2));
    height -= height % (2 * kUnit) - kUnit;
  }
  return std::clamp(height, kUnit, 63 * kUnit);
}

Tone ground_tone(std::int32_t height, std::int32_t z) {
  if (height > kTerraceTop) {
    if (height > kSnowLine && z >= height - kUnit) {
      return kSnow;
    }
    return z / (4 * kUnit) % 2 == 0 ? kRock : kCliff;
  }
  if (z < height - 2 * kUnit) {
    return kRock;
  }
  return height <= kLakeTop + kUnit ? kSand : height / (2 * kUnit) % 2 == 0 ? kGrass : kMeadow;
}

// ---- what stands on it

enum class Shape : std::uint8_t {
  kBox,
  kDrum,  ///< an upright cylinder that fills the box
  kCone,  ///< upright, its tip in the middle of the box's top
  kBall,  ///< an ellipsoid that fills the box
  kGableX,  ///< a roof whose ridge runs along x; these and the following by pairs, the second of which runs along y
  kGableY,
  kTunnelX,  ///< has a round top
  kTunnelY,
  kMerlonsX,  ///< a box with a gap at every other unit
  kMerlonsY,
};

using Corner = std::array<std::int32_t, 3>;

/// A body in the box [low, high), lengths as everywhere. Of several that hold a point the last one counts;
/// tone kAir digs a hole.
struct Part {
  Shape shape;
  Tone tone;
  Corner low, high;
};

/// Whether a point inside the part's box is inside the part.
bool inside_shape(const Part& part, const Corner& at) {
  // Across the box on each axis, -1024 .. 1024; up from its bottom, 0 .. 1024.
  Corner across{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    across[axis] =
        (2 * at[axis] - part.low[axis] - part.high[axis]) * 1024 / (part.high[axis] - part.low[axis]);
  }
  const std::int32_t down = (1024 - across[2]) / 2;
  const std::int32_t from_middle = across[0] * across[0] + across[1] * across[1];
  // Of the shapes that run along an axis.
  const std::size_t along =
      (static_cast<std::size_t>(part.shape) - static_cast<std::size_t>(Shape::kGableX)) % 2;
  const std::size_t side = 1 - along;
  switch (part.shape) {
    case Shape::kBox:
      return true;
    case Shape::kDrum:
      return from_middle <= 1024 * 1024;
    case Shape::kCone:
      return from_middle <= down * down;
    case Shape::kBall:
      return from_middle + across[2] * across[2] <= 1024 * 1024;
    case Shape::kGableX:
    case Shape::kGableY:
      return across[side] <= down && -across[side] <= down;
    case Shape::kTunnelX:
    case Shape::kTunnelY: {
      const std::int64_t width = part.high[side] - part.low[side];
      const std::int64_t above = std::max<std::int64_t>(2 * (at[2] - part.high[2]) + width, 0);
      const std::int64_t beside = 2 * at[side] - part.low[side] - part.high[side];
      return above * above + beside * beside <= width * width;
    }
    case Shape::kMerlonsX:
    case Shape::kMerlonsY:
      return (at[along] - part.low[along]) / kUnit % 2 == 0;
  }
  return false;
}

class DemoWorld {
 public:
  explicit DemoWorld(std::uint64_t seed) : seed_(seed) {
    build_castle();
    build_bridge();
    build_aqueduct();
    build_village();
    build_circle();
    build_windmill();
    build_boat();
    plant_trees();
  }

  /// The parts whose boxes stand on a point of the plan, as indices in their order.
  struct Column {
    std::array<std::uint8_t, 255> parts;
    std::size_t count = 0;
    std::int32_t ground = 0;
    std::int32_t top = 0;  ///< nothing at or above
  };
  Column column(std::int32_t x, std::int32_t y) const {
    Column result;
    result.ground = ground_height(seed_, x, y);
    result.top = std::max(result.ground, kLakeTop);
    for (std::size_t i = 0; i < count_; ++i) {
      const Part& part = parts_[i];
      if (x >= part.low[0] && x < part.high[0] && y >= part.low[1] && y < part.high[1]) {
        result.parts[result.count++] = static_cast<std::uint8_t>(i);
        result.top = std::max(result.top, part.high[2]);
      }
    }
    return result;
  }

  Tone tone(const Column& column, const Corner& at) const {
    for (std::size_t i = column.count; i-- != 0;) {
      const Part& part = parts_[column.parts[i]];
      if (at[2] >= part.low[2] && at[2] < part.high[2] && inside_shape(part, at)) {
        if (part.tone != kGroundOnly) {
          return part.tone;
        }
        break;
      }
    }
    if (at[2] < column.ground) {
      return ground_tone(column.ground, at[2]);
    }
    return at[2] < kLakeTop ? kWater : kAir;
  }

 private:
  /// Corners in units.
  void add(Shape shape, Tone tone, Corner low, Corner high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] *= kUnit;
      high[axis] *= kUnit;
    }
    if (count_ < parts_.size()) {
      parts_[count_++] = {shape, tone, low, high};
    }
  }
  /// The whole units that the ground reaches at the middle of a unit square.
  std::int32_t floor_at(std::int32_t x, std::int32_t y) const {
    return (ground_height(seed_, x * kUnit + kUnit / 2, y * kUnit + kUnit / 2) + kUnit / 2) / kUnit;
  }

  /// Battlements along the edges of the rectangle, one unit high on top of `z`.
  void crown(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1, std::int32_t z) {
    add(Shape::kMerlonsX, kWall, {x0, y0, z}, {x1, y0 + 1, z + 1});
    add(Shape::kMerlonsX, kWall, {x0, y1 - 1, z}, {x1, y1, z + 1});
    add(Shape::kMerlonsY, kWall, {x0, y0, z}, {x0 + 1, y1, z + 1});
    add(Shape::kMerlonsY, kWall, {x1 - 1, y0, z}, {x1, y1, z + 1});
  }
  void window(std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t height) {
    add(Shape::kBox, kWood, {x, y, z}, {x + 1, y + 1, z + height});
  }

  void build_castle() {
    add(Shape::kBox, kRock, {26, 26, 7}, {38, 38, 13});
    add(Shape::kBox, kWall, {26, 26, 13}, {38, 38, 17});
    crown(26, 26, 38, 38, 17);
    add(Shape::kBox, kRoad, {27, 27, 13}, {37, 37, 14});
    add(Shape::kBox, kAir, {27, 27, 14}, {37, 37, 18});
    for (const std::int32_t x : {24, 36}) {
      for (const std::int32_t y : {24, 36}) {
        add(Shape::kDrum, kWall, {x, y, 5}, {x + 4, y + 4, 20});
        add(Shape::kCone, kRoof, {x - 1, y - 1, 20}, {x + 5, y + 5, 26});
      }
    }
    // Gatehouse.
    add(Shape::kBox, kWall, {29, 37, 8}, {35, 40, 20});
    crown(29, 37, 35, 40, 20);
    add(Shape::kTunnelY, kAir, {31, 36, 13}, {33, 41, 17});
    window(30, 39, 18, 1);
    window(33, 39, 18, 1);
    // Keep with windows.
    add(Shape::kBox, kWall, {27, 27, 14}, {33, 33, 22});
    crown(27, 27, 33, 33, 22);
    for (const std::int32_t along : {28, 31}) {
      window(along, 27, 19, 2);
      window(along, 32, 19, 2);
      window(27, along, 19, 2);
    }
    // Great tower with its flag.
    add(Shape::kDrum, kWall, {32, 27, 14}, {37, 32, 26});
    add(Shape::kCone, kRoof, {31, 26, 26}, {38, 33, 35});
    add(Shape::kBox, kWood, {34, 29, 34}, {35, 30, 39});
    add(Shape::kBox, kRoof, {35, 29, 36}, {38, 30, 39});
    for (const auto& [x, y] : {std::array{32, 29}, {36, 29}, {34, 27}, {34, 31}}) {
      window(x, y, 22, 2);
    }
    // Hall.
    add(Shape::kBox, kWall, {28, 34, 14}, {37, 37, 17});
    add(Shape::kGableX, kRoof, {28, 33, 17}, {37, 38, 20});
    add(Shape::kTunnelY, kAir, {31, 33, 13}, {33, 37, 16});
  }

  void build_bridge() {
    add(Shape::kBox, kWall, {30, 40, 1}, {34, 60, 13});
    for (const std::int32_t y : {42, 47, 52}) {
      add(Shape::kTunnelX, kGroundOnly, {30, y, 1}, {34, y + 4, 11});
    }
    add(Shape::kBox, kRoad, {31, 37, 12}, {33, 61, 13});
    add(Shape::kBox, kWall, {30, 40, 13}, {31, 58, 14});
    add(Shape::kBox, kWall, {33, 40, 13}, {34, 58, 14});
    // The road goes into the mountain.
    add(Shape::kBox, kAir, {31, 54, 13}, {33, 58, 24});
    add(Shape::kBox, kWall, {28, 57, 13}, {36, 59, 20});
    crown(28, 57, 36, 59, 20);
    add(Shape::kTunnelY, kAir, {31, 56, 13}, {33, 62, 17});
  }

  void build_aqueduct() {
    constexpr std::int32_t kTop = 17;
    add(Shape::kBox, kWall, {1, 30, 1}, {26, 33, kTop});
    for (std::int32_t x = 4; x < 24; x += 4) {
      add(Shape::kTunnelY, kGroundOnly, {x, 30, 1}, {x + 3, 33, kTop - 2});
    }
    add(Shape::kBox, kWater, {1, 31, kTop - 1}, {26, 32, kTop});
  }

  void house(std::int32_t x, std::int32_t y, bool along_x) {
    const std::int32_t wide = along_x ? 5 : 4;
    const std::int32_t deep = along_x ? 4 : 5;
    const std::int32_t base = floor_at(x + 2, y + 2);
    add(Shape::kBox, kWall, {x, y, base - 4}, {x + wide, y + deep, base + 3});
    add(Shape::kBox, kWood, {x + 1, y, base}, {x + 2, y + 1, base + 2});
    add(Shape::kBox, kWood, {x, y + 1, base}, {x + 1, y + 2, base + 2});
    add(along_x ? Shape::kGableX : Shape::kGableY, kRoof, {x - 1, y - 1, base + 3},
        {x + wide + 1, y + deep + 1, base + 6});
  }
  void build_village() {
    house(40, 52, true);
    house(47, 47, false);
    house(51, 41, false);
    house(39, 58, false);
    house(53, 34, true);
    house(21, 54, true);
    house(14, 22, false);
  }

  void build_circle() {
    const std::int32_t base = floor_at(15, 46);
    add(Shape::kDrum, kMeadow, {9, 40, base - 6}, {22, 53, base});
    constexpr std::array<std::array<std::int32_t, 2>, 10> kStones{
        {{10, 45}, {10, 48}, {13, 51}, {16, 51}, {20, 48}, {20, 45}, {17, 41}, {13, 41}, {14, 46}, {16, 46}}};
    for (const auto& [x, y] : kStones) {
      add(Shape::kBox, kRock, {x, y, base}, {x + 1, y + 1, base + 4});
    }
    add(Shape::kBox, kRock, {10, 45, base + 4}, {11, 49, base + 5});
    add(Shape::kBox, kRock, {20, 45, base + 4}, {21, 49, base + 5});
    add(Shape::kBox, kRock, {13, 41, base + 4}, {18, 42, base + 5});
    add(Shape::kBox, kRock, {14, 46, base + 3}, {17, 47, base + 4});
  }

  void build_windmill() {
    const std::int32_t base = floor_at(48, 16);
    add(Shape::kDrum, kWall, {46, 14, base - 4}, {51, 19, base + 7});
    add(Shape::kCone, kRoof, {45, 13, base + 7}, {52, 20, base + 11});
    add(Shape::kBox, kWood, {48, 19, base + 6}, {49, 21, base + 7});
    add(Shape::kBox, kSand, {44, 20, base + 6}, {53, 21, base + 7});
    add(Shape::kBox, kSand, {48, 20, base + 2}, {49, 21, base + 11});
  }

  void build_boat() {
    add(Shape::kBall, kWood, {44, 27, 4}, {51, 30, 8});
    add(Shape::kBox, kWood, {45, 28, 7}, {50, 29, 8});
    add(Shape::kBox, kWood, {47, 28, 7}, {48, 29, 14});
    add(Shape::kBox, kSnow, {48, 28, 9}, {50, 29, 13});
    add(Shape::kBox, kSnow, {45, 28, 9}, {47, 29, 12});
  }

  bool is_free(const Corner& low, const Corner& high) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const Part& part = parts_[i];
      if (low[0] * kUnit < part.high[0] && high[0] * kUnit > part.low[0] && low[1] * kUnit < part.high[1] &&
          high[1] * kUnit > part.low[1]) {
        return false;
      }
    }
    return true;
  }
  void plant_trees() {
    SplitMix64 random(seed_);
    for (int draw = 0; draw < 90; ++draw) {
      const std::int32_t x = random.between(4, 59);
      const std::int32_t y = random.between(4, 59);
      const std::int32_t size = random.between(0, 2);
      const std::int32_t base = floor_at(x, y);
      const bool on_crag =
          x > 16 && x < 48 && y > 16 && y < 48 && (x - 32) * (x - 32) + (y - 32) * (y - 32) < 196;
      if (on_crag || base < 8 || base > 18 || !is_free({x - 1, y - 1, 0}, {x + 2, y + 2, 1}) ||
          count_ + 2 > parts_.size()) {
        continue;
      }
      add(Shape::kBox, kWood, {x, y, base - 1}, {x + 1, y + 1, base + 3});
      if (random.below(3) != 0) {
        add(Shape::kCone, kLeaves, {x - 2, y - 2, base + 1}, {x + 3, y + 3, base + 7 + size});
      } else {
        add(Shape::kBall, kLeaves, {x - 2, y - 2, base + 2}, {x + 3, y + 3, base + 6});
      }
    }
  }

  std::uint64_t seed_;
  std::array<Part, 255> parts_{};
  std::size_t count_ = 0;
};

}  // namespace

void generate_demo_world(const GeneratorSpec& spec, const VoxelSink& sink) {
  const DemoWorld world(spec.seed);
  const std::int32_t side = std::int32_t{1} << spec.depth;
  const auto center = [&spec](std::int32_t index) { return (2 * index + 1) << (kDemoBits - 1 - spec.depth); };
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const DemoWorld::Column column = world.column(center(x), center(y));
      for (std::int32_t z = 0; z < side && center(z) < column.top; ++z) {
        const Tone tone = world.tone(column, {center(x), center(y), center(z)});
        if (tone != kAir) {
          sink(x, y, z, tone);
        }
      }
    }
  }
}

Palette demo_world_palette() {
  Palette palette;
  palette.fill(default_material());
  palette[kWater] = colored({38, 84, 128});
  palette[kSand] = colored({214, 190, 138});
  palette[kGrass] = colored({104, 150, 62});
  palette[kMeadow] = colored({136, 176, 76});
  palette[kRock] = colored({128, 122, 118});
  palette[kCliff] = colored({150, 138, 124});
  palette[kSnow] = colored({244, 246, 250});
  palette[kWall] = colored({236, 222, 192});
  palette[kRoof] = colored({192, 68, 46});
  palette[kLeaves] = colored({44, 102, 54});
  palette[kWood] = colored({74, 52, 40});
  palette[kRoad] = colored({186, 160, 120});
  return palette;
}

SceneCamera demo_world_camera(int depth) {
  SceneCamera camera;
  const auto place = [depth](std::int32_t units) { return Q8::from_raw(units * kUnit << depth >> 6); };
  camera.target = {place(32), place(32), place(16)};
  camera.eye = {place(58), place(34), place(36)};
  camera.fov_degrees = Q16::saturate(52);
  return camera;
}

void demo_world_light(LitDescription* lit) {
  // Over the viewer's left shoulder: the castle is bright, and the mountains' shadows lie on the lake. Bright
  // shadows, since half of a valley lies in them and a display has 16 greys.
  lit->lights.push_back({false, {8, -6, 17}, {316, 304, 282}});
  lit->rest.ambient_q8[0] = 114;
  lit->rest.ambient_q8[1] = 122;
  lit->rest.ambient_q8[2] = 132;
  // For those who ask for light: the scene's own look is that of its faces.
  lit->off = Effect::kDirectLight;
}

}  // namespace thimble::tools
