#include "support/trial_worlds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "readers/oct.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

using tools::Real3;

// A bit a voxel, in Morton order: so each block of a tree is a run of bits.
class Grid {
 public:
  explicit Grid(int level)
      : level_(level), words_(std::max<std::size_t>(1, (std::size_t{1} << 3 * level) / 64)) {}

  std::int32_t side() const { return std::int32_t{1} << level_; }
  Vec3i end() const { return {side(), side(), side()}; }
  // The same numbers for every grid.
  std::mt19937_64& random() { return random_; }

  void add(std::int32_t x, std::int32_t y, std::int32_t z) {
    const std::uint64_t at = morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                         static_cast<std::uint32_t>(z));
    words_[at / 64] |= std::uint64_t{1} << at % 64;
  }
  // The voxels of the box for which `is_solid(x, y, z)`.
  template <class IsSolid>
  void add_some(const Vec3i& low, const Vec3i& high, const IsSolid& is_solid) {
    for (std::int32_t z = low.z; z < high.z; ++z) {
      for (std::int32_t y = low.y; y < high.y; ++y) {
        for (std::int32_t x = low.x; x < high.x; ++x) {
          if (is_solid(x, y, z)) {
            add(x, y, z);
          }
        }
      }
    }
  }
  template <class IsSolid>
  void add_where(const IsSolid& is_solid) {
    add_some({0, 0, 0}, end(), is_solid);
  }
  void add_box(const Vec3i& low, const Vec3i& high) {
    add_some(low, high, [](auto, auto, auto) { return true; });
  }
  void add_dust(std::int32_t count, const Vec3i& low, const Vec3i& high) {
    for (std::int32_t i = 0; i < count; ++i) {
      Vec3i at{};
      for (int axis = 0; axis < 3; ++axis) {
        const auto room = static_cast<std::uint64_t>(high[axis] - low[axis]);
        at[axis] = low[axis] + static_cast<std::int32_t>(random_() % room);
      }
      add(at.x, at.y, at.z);
    }
  }

  std::vector<std::uint8_t> compact() const {
    for (std::size_t bytes = std::size_t{1} << 20; bytes <= std::size_t{1} << 30; bytes *= 4) {
      std::vector<std::uint8_t> pool(bytes);
      Octree octree;
      if (Octree::make(level_, Bytes(pool.data(), pool.size()), &octree) == Status::kOk &&
          insert(&octree, {0, 0, 0}, level_)) {
        std::vector<std::uint8_t> compact(compact_bytes(compact_shape(octree)));
        if (CompactTree::make(octree, Bytes(compact.data(), compact.size()), nullptr) != Status::kOk) {
          break;
        }
        return compact;
      }
    }
    throw std::logic_error("a trial world is too large");
  }

 private:
  bool insert(Octree* octree, const Vec3i& corner, int level) const {
    const std::uint64_t first =
        morton_code(static_cast<std::uint32_t>(corner.x), static_cast<std::uint32_t>(corner.y),
                    static_cast<std::uint32_t>(corner.z));
    const std::uint64_t count = std::uint64_t{1} << 3 * level;
    const std::uint64_t wanted = count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    bool any = false;
    bool all = true;
    for (std::uint64_t at = first; at < first + count && (all || !any); at += 64) {
      const std::uint64_t bits = words_[at / 64] >> at % 64 & wanted;
      any = any || bits != 0;
      all = all && bits == wanted;
    }
    if (all || !any) {
      return !any || octree->insert_block(corner, level, 1) == Status::kOk;
    }
    const std::int32_t half = std::int32_t{1} << (level - 1);
    for (int octant = 0; octant < 8; ++octant) {
      const Vec3i part{octant & 1, octant >> 1 & 1, octant >> 2};
      if (!insert(octree, {corner.x + part.x * half, corner.y + part.y * half, corner.z + part.z * half},
                  level - 1)) {
        return false;
      }
    }
    return true;
  }

  int level_;
  std::vector<std::uint64_t> words_;
  std::mt19937_64 random_{1};
};

void fill_sponge(Grid& grid) {
  std::int32_t side = 1;
  while (side * 3 <= grid.side()) {
    side *= 3;
  }
  grid.add_some({0, 0, 0}, {side, side, side}, [](std::int32_t x, std::int32_t y, std::int32_t z) {
    for (; x != 0 || y != 0 || z != 0; x /= 3, y /= 3, z /= 3) {
      const int middles = (x % 3 == 1 ? 1 : 0) + (y % 3 == 1 ? 1 : 0) + (z % 3 == 1 ? 1 : 0);
      if (middles >= 2) {
        return false;
      }
    }
    return true;
  });
}

void fill_islands(Grid& grid) {
  const std::int32_t part = grid.side() / 16;
  const std::int32_t last = grid.side() - part;
  const auto is_solid = [&](auto, auto, auto) { return (grid.random()() & 1U) != 0; };
  grid.add_some({0, 0, 0}, {part, part, part}, is_solid);
  grid.add_some({last, last, last}, grid.end(), is_solid);
  grid.add_dust(grid.side() * 8, {0, 0, 0}, grid.end());
}

void fill_ball(Grid& grid) {
  const std::int32_t side = grid.side();
  const std::int32_t radius = side / 2 - 1;
  const auto square = [&](std::int32_t a) { return (a - side / 2) * (a - side / 2); };
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      const std::int32_t left = radius * radius - square(y) - square(z);
      if (left >= 0) {
        const auto reach = static_cast<std::int32_t>(std::sqrt(left));
        grid.add(side / 2 - reach, y, z);
        grid.add(side / 2 + reach, y, z);
      }
    }
  }
}

void fill_globe(Grid& grid) {
  const std::int32_t side = grid.side();
  const auto square = [&](std::int32_t at) {  // of the voxel's middle, in halves
    const std::int64_t from = 2 * std::int64_t{at} + 1 - side;
    return from * from;
  };
  grid.add_where(
      [&](auto x, auto y, auto z) { return square(x) + square(y) + square(z) < std::int64_t{side} * side; });
}

// A number of 0 .. 1 for a lattice point.
double noise_at(std::int32_t x, std::int32_t y) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h = (h ^ h >> 15) * 0x2C1B3C6DU;
  h = (h ^ h >> 12) * 0x297A2D39U;
  return static_cast<double>(h ^ h >> 15) / 4294967296.0;
}
double smooth_noise(double x, double y) {
  const auto left = static_cast<std::int32_t>(std::floor(x));
  const auto top = static_cast<std::int32_t>(std::floor(y));
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - left);
  const double v = ease(y - top);
  const double above = noise_at(left, top) * (1 - u) + noise_at(left + 1, top) * u;
  const double below = noise_at(left, top + 1) * (1 - u) + noise_at(left + 1, top + 1) * u;
  return above * (1 - v) + below * v;
}

// Hills on ground: 200 voxels of it in a world of 1024, less in smaller ones.
void fill_terrain(Grid& grid) {
  const std::int32_t side = grid.side();
  const double unit = side / 1024.0;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      double height = 200;
      double part = 160;
      double step = 1.0 / (256 * unit);
      for (int octave = 0; octave < 6; ++octave, part /= 2.1, step *= 2) {
        height += part * smooth_noise(x * step + 17 * octave, y * step);
      }
      grid.add_box({x, y, 0}, {x + 1, y + 1, std::clamp(static_cast<std::int32_t>(height * unit), 0, side)});
    }
  }
}

// Blocks of houses along streets, with ledges and recessed windows, on thin ground.
void fill_city(Grid& grid) {
  const std::int32_t side = grid.side();
  const std::int32_t ground = side / 128;
  constexpr std::int32_t kPlot = 48;
  constexpr std::int32_t kStreet = 10;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const std::int32_t in_x = x % kPlot;
      const std::int32_t in_y = y % kPlot;
      const double chance = noise_at(x / kPlot, y / kPlot);
      const bool is_house = in_x >= kStreet && in_y >= kStreet && chance > 0.12;
      const auto roof = static_cast<std::int32_t>((0.06 + 0.4 * chance * chance * chance) * side);
      // Walls are a voxel behind the plot's edge, but for ledges at every storey; windows lie two voxels deep.
      const std::int32_t edge =
          std::min({in_x - kStreet, in_y - kStreet, kPlot - 1 - in_x, kPlot - 1 - in_y});
      const std::int32_t along = in_x - kStreet == edge || kPlot - 1 - in_x == edge ? in_y : in_x;
      for (std::int32_t z = 0; z < side; ++z) {
        const std::int32_t storey = z % 12;
        const bool is_window = edge < 3 && storey >= 4 && storey < 9 && along % 6 >= 2 && along % 6 < 5;
        const bool is_wall = is_house && z < roof && (edge >= 1 || storey == 0) && !is_window;
        if (z < ground || is_wall) {
          grid.add(x, y, z);
        } else if (z >= roof) {
          break;
        }
      }
    }
  }
}

struct Kind {
  const char* name;
  void (*fill)(Grid&);
};
constexpr Kind kKinds[] = {
    {"solid",
     [](Grid& grid) {
       grid.add_box({0, 0, 0}, grid.end());
     }},
    {"inset",
     [](Grid& grid) {
       const std::int32_t last = grid.side() - 1;
       grid.add_box({1, 1, 1}, {last, last, last});
     }},
    {"noise",
     [](Grid& grid) { grid.add_where([&](auto, auto, auto) { return (grid.random()() & 1U) != 0; }); }},
    {"checker",
     [](Grid& grid) { grid.add_where([](auto x, auto y, auto z) { return ((x + y + z) & 1) != 0; }); }},
    {"sponge", fill_sponge},
    {"voxel", [](Grid& grid) { grid.add(grid.side() / 2, grid.side() / 2, grid.side() / 2); }},
    {"wall",
     [](Grid& grid) {
       const std::int32_t side = grid.side();
       grid.add_box({0, side / 3, 0}, {side, side / 3 + 1, side});
     }},
    {"slant",
     [](Grid& grid) {
       const std::int32_t middle = 3 * grid.side() / 2;
       grid.add_where(
           [=](auto x, auto y, auto z) { return middle - x - y - z == 0 || middle - x - y - z == 1; });
     }},
    {"columns",
     [](Grid& grid) { grid.add_where([](auto x, auto y, auto) { return x % 8 == 5 && y % 8 == 3; }); }},
    {"islands", fill_islands},
    {"screen",
     [](Grid& grid) {
       const std::int32_t side = grid.side();
       grid.add_box({0, 0, 0}, {side, side / 16, side});
       grid.add_dust(side * side, {0, side / 4, 0}, grid.end());
     }},
    {"ball", fill_ball},
    {"globe", fill_globe},
    {"terrain", fill_terrain},
    {"city", fill_city}};

tools::SceneArguments arguments_of(const std::string& name) {
  tools::SceneArguments arguments;
  const std::size_t at = name.rfind('@');
  arguments.scene = name.substr(0, at);
  if (at != std::string::npos) {
    arguments.depth = std::stoi(name.substr(at + 1));
  }
  return arguments;
}

Real3 plus(const Real3& a, const Real3& b, double times = 1) {
  return {a[0] + b[0] * times, a[1] + b[1] * times, a[2] + b[2] * times};
}

// The middle of a voxel that is seen in the middle of the picture, or of any at all.
Real3 some_voxel(const CompactTree& tree, const Camera& camera) {
  Hit hit;
  if (closest_hit(tree, camera.ray(camera.width_px() / 2, camera.height_px() / 2), &hit) == Status::kOk &&
      hit.kind == HitKind::kHit) {
    return {hit.voxel.x + 0.5, hit.voxel.y + 0.5, hit.voxel.z + 0.5};
  }
  std::optional<Real3> found;
  tools::walk_blocks(tree, [&](const Vec3i& at, int, std::uint8_t) {
    if (!found) {
      found = Real3{at.x + 0.5, at.y + 0.5, at.z + 0.5};
    }
  });
  return found.value_or(Real3{0, 0, 0});
}

// Returns the seconds of processor time that it takes, without those for fresh memory.
double make_lists(const CompactTree& tree, wide::ListKind kind, std::vector<std::uint8_t>* bytes,
                  wide::VoxelLists* lists) {
  const auto now = [] { return std::clock(); };
  const auto begin = now();
  const std::size_t size = wide::VoxelLists::bytes(tree, kind);
  const auto counted = now();
  bytes->resize(size);
  Arena arena(Bytes(bytes->data(), bytes->size()));
  const auto ready = now();
  if (wide::VoxelLists::make(tree, &arena, lists, kind) != Status::kOk) {
    throw std::logic_error("no lists of a trial world");
  }
  return static_cast<double>((counted - begin) + (now() - ready)) / CLOCKS_PER_SEC;
}

// The bytes of a tree of one of the kinds above; none for another name.
std::vector<std::uint8_t> filled_world(const std::string& name) {
  const std::size_t colon = name.find(':');
  for (const Kind& kind : kKinds) {
    if (colon != std::string::npos && name.substr(0, colon) == kind.name) {
      Grid grid(std::stoi(name.substr(colon + 1)));
      kind.fill(grid);
      return grid.compact();
    }
  }
  return {};
}

}  // namespace

TrialWorld::TrialWorld(const std::string& name) : name_(name), bytes_(filled_world(name)) {
  if (!bytes_.empty() && CompactTree::open(ConstBytes(bytes_.data(), bytes_.size()), &tree_) != Status::kOk) {
    throw std::logic_error("a trial world does not open");
  }
  if (bytes_.empty()) {
    built_ =
        std::make_unique<tools::BuiltScene>(*tools::open_scene(arguments_of(name)), tools::BuildOptions{});
    tree_ = built_->compact();
  }
  list_seconds_ = make_lists(tree_, wide::ListKind::kFastest, &list_bytes_, &lists_);
  box_list_seconds_ = make_lists(tree_, wide::ListKind::kBoxes, &box_list_bytes_, &box_lists_);
}

std::vector<TrialView> trial_views(const CompactTree& tree, std::int32_t width_px, std::int32_t height_px) {
  std::vector<TrialView> views;
  const VoxelBox& box = tree.bounds();
  const double side = std::ldexp(1.0, tree.level());
  Real3 low{};
  Real3 extent{};
  double size = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = box.low[static_cast<int>(axis)];
    extent[axis] = box.high[static_cast<int>(axis)] - low[axis];
    size = std::max(size, extent[axis]);
  }
  const auto at = [&](double x, double y, double z) {
    return Real3{low[0] + x * extent[0], low[1] + y * extent[1], low[2] + z * extent[2]};
  };
  const auto add = [&](const char* name, std::optional<Real3> eye, std::optional<Real3> target, double fov,
                       std::optional<double> span = std::nullopt) {
    tools::ViewWishes view;
    view.width_px = width_px;
    view.height_px = height_px;
    view.eye = eye;
    view.target = target;
    view.fov_degrees = fov;
    view.orthographic = span.has_value();
    if (span.value_or(0) > 0) {
      // No finer than the core takes.
      const Q14 least = least_orthographic_span(width_px, tree.level());
      view.span = std::max(*span, static_cast<double>(least.raw) / Q14::kOne);
    }
    try {
      views.push_back({name, tools::frame_box(view, tree.level(), box).camera});
    } catch (const tools::InputError&) {
      // The core does not take it: too fine, or from too far off.
    }
  };
  const Real3 middle = at(0.5, 0.5, 0.5);
  const Real3 from{-0.42, -0.83, 0.37};
  add("outside", std::nullopt, std::nullopt, 60);
  if (views.empty()) {
    return views;
  }
  const Real3 voxel = some_voxel(tree, views.front().camera);
  add("behind", plus(middle, {0.9 * size, 1.1 * size, -0.7 * size}), middle, 60);
  add("far", Real3{-3.9 * side, -3.8 * side, -3.7 * side}, middle, 120);
  add("near", plus(middle, from, 0.62 * size), middle, 60);
  add("close", plus(voxel, from, 8), voxel, 60);
  add("closest", plus(voxel, from, 2.5), voxel, 60);
  add("inside", plus(middle, {0.3, 0.2, 0.4}), at(1, 0.9, 0.4), 60);
  add("wide", at(0.28, 0.31, 0.3), at(1, 1, 0.8), 120);
  add("grazing", plus(at(-0.02, 0.37, 1), {0, 0, 0.6}), plus(at(1, 0.62, 1), {0, 0, 0.6}), 60);
  add("along", at(0.5, -1, 0.5), middle, 60);
  add("tele 5", plus(middle, {1.3 * side, -3.2 * side, 1.1 * side}), middle, 5);
  add("tele 2", plus(middle, {1.3 * side, -3.2 * side, 1.1 * side}), voxel, 2);
  const double whole = 1.02 * std::max(extent[0], extent[2] * width_px / height_px);
  add("parallel", plus(middle, {0, -size, 0}), middle, 60, whole);
  add("parallel oblique", plus(middle, from, 1.6 * size), middle, 60, 0);
  add("parallel far", plus(middle, from, 1.6 * size), middle, 60, 6 * side);
  add("parallel part", plus(voxel, from, 1.6 * size), voxel, 60, 0.06 * size);
  add("parallel close", plus(voxel, from, 1.6 * size), voxel, 60, 12);
  return views;
}

}  // namespace thimble::tests
