#include "support/solid_worlds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "readers/oct.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

std::vector<std::uint8_t> compact_of(const Octree& octree) {
  std::vector<std::uint8_t> compact(compact_bytes(compact_shape(octree)));
  if (CompactTree::make(octree, Bytes(compact.data(), compact.size()), nullptr) != Status::kOk) {
    throw std::logic_error("the octree does not become compact");
  }
  return compact;
}

// A bit a voxel, rows along x. Rows are of whole words, so levels are at least 6.
class Grid {
 public:
  explicit Grid(int level)
      : level_(level), words_(std::size_t{1} << (level - 6)), bits_((words_ << level) << level) {}

  std::int32_t side() const { return std::int32_t{1} << level_; }
  std::size_t row_words() const { return words_; }
  std::uint64_t* row(std::int32_t y, std::int32_t z) {
    return bits_.data() + words_ * ((static_cast<std::size_t>(z) << level_) + static_cast<std::size_t>(y));
  }
  void set(std::int32_t x, std::int32_t y, std::int32_t z) {
    row(y, z)[x >> 6] |= std::uint64_t{1} << (x & 63);
  }

  std::vector<std::uint8_t> compact() {
    for (std::size_t bytes = std::size_t{1} << 24; bytes <= std::size_t{1} << 30; bytes *= 2) {
      std::vector<std::uint8_t> pool(bytes);
      Octree octree;
      if (Octree::make(level_, Bytes(pool.data(), pool.size()), &octree) == Status::kOk &&
          insert(&octree, {0, 0, 0}, level_)) {
        return compact_of(octree);
      }
    }
    throw std::logic_error("a solid world is too large");
  }

 private:
  // How many of the block's voxels are set: none, all or some.
  enum class Fill { kNone, kAll, kSome };
  Fill fill_of(const Vec3i& corner, int level) {
    const std::int32_t size = std::int32_t{1} << level;
    const std::uint64_t wanted =
        size >= 64 ? ~std::uint64_t{0} : ((std::uint64_t{1} << size) - 1) << (corner.x & 63);
    bool any = false;
    bool all = true;
    for (std::int32_t z = corner.z; z < corner.z + size; ++z) {
      for (std::int32_t y = corner.y; y < corner.y + size; ++y) {
        const std::uint64_t* const words = row(y, z);
        for (std::int32_t x = corner.x; x < corner.x + size; x += 64) {
          any = any || (words[x >> 6] & wanted) != 0;
          all = all && (words[x >> 6] & wanted) == wanted;
        }
        if (any && !all) {
          return Fill::kSome;
        }
      }
    }
    return any ? Fill::kAll : Fill::kNone;
  }

  bool insert(Octree* octree, const Vec3i& corner, int level) {
    const Fill fill = fill_of(corner, level);
    if (fill != Fill::kSome) {
      return fill == Fill::kNone || octree->insert_block(corner, level, 1) == Status::kOk;
    }
    const std::int32_t half = std::int32_t{1} << (level - 1);
    for (int octant = 0; octant < 8; ++octant) {
      if (!insert(octree,
                  {corner.x + (octant & 1) * half, corner.y + (octant >> 1 & 1) * half,
                   corner.z + (octant >> 2) * half},
                  level - 1)) {
        return false;
      }
    }
    return true;
  }

  int level_;
  std::size_t words_;  // of a row
  std::vector<std::uint64_t> bits_;
};

// Fills every column up to its height, not included.
template <class HeightAt>
std::vector<std::uint8_t> columns_of(int level, const HeightAt& height_at) {
  Grid grid(level);
  const std::int32_t side = grid.side();
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      const std::int32_t height = std::clamp(height_at(x, y), 0, side);
      for (std::int32_t z = 0; z < height; ++z) {
        grid.set(x, y, z);
      }
    }
  }
  return grid.compact();
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

// Spreads the set bits of `out` along x through what is not in `solid`, within a row. Returns whether any was
// set.
bool spread_row(const std::uint64_t* solid, std::uint64_t* out, std::size_t words) {
  bool changed = false;
  const auto grow = [&](std::size_t word, std::uint64_t carry) {
    const std::uint64_t open = ~solid[word];
    std::uint64_t now = out[word] | (carry & open);
    for (std::uint64_t before = 0; before != now;) {
      before = now;
      now |= (now << 1 | now >> 1) & open;
    }
    changed = changed || now != out[word];
    out[word] = now;
    return now;
  };
  for (std::size_t word = 0; word < words; ++word) {
    grow(word, word == 0 ? 0 : out[word - 1] >> 63);
  }
  for (std::size_t word = words; word-- > 0;) {
    grow(word, word + 1 == words ? 0 : out[word + 1] << 63);
  }
  return changed;
}

// Everything that can be reached from the faces of the world.
void flood(Grid* solid, Grid* out) {
  const std::int32_t side = solid->side();
  const std::size_t words = solid->row_words();
  for (bool changed = true; changed;) {
    changed = false;
    const auto visit = [&](std::int32_t y, std::int32_t z) {
      std::uint64_t* const to = out->row(y, z);
      const std::uint64_t* const closed = solid->row(y, z);
      const bool is_edge = y == 0 || z == 0 || y == side - 1 || z == side - 1;
      bool any = false;
      for (std::size_t word = 0; word < words; ++word) {
        std::uint64_t from = is_edge ? ~std::uint64_t{0} : 0;
        from |= word == 0 ? 1 : 0;
        from |= word + 1 == words ? std::uint64_t{1} << 63 : 0;
        if (!is_edge) {
          from |= out->row(y - 1, z)[word] | out->row(y + 1, z)[word] | out->row(y, z - 1)[word] |
                  out->row(y, z + 1)[word];
        }
        const std::uint64_t now = to[word] | (from & ~closed[word]);
        any = any || now != to[word];
        to[word] = now;
      }
      if (any) {
        changed = true;
        spread_row(closed, to, words);
      }
    };
    for (std::int32_t i = 0; i < side * side; ++i) {
      visit(i % side, i / side);
    }
    for (std::int32_t i = side * side; i-- > 0;) {
      visit(i % side, i / side);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> full_ball(int level) {
  Grid grid(level);
  const std::int32_t side = grid.side();
  const std::int64_t radius = side / 2;
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      for (std::int32_t x = 0; x < side; ++x) {
        // Middles of voxels, in halves.
        const auto square = [&](std::int32_t at) {
          const std::int64_t from = 2 * std::int64_t{at} + 1 - 2 * radius;
          return from * from;
        };
        if (square(x) + square(y) + square(z) < 4 * radius * radius) {
          grid.set(x, y, z);
        }
      }
    }
  }
  return grid.compact();
}

std::vector<std::uint8_t> thick_terrain(int level) {
  const double unit = std::ldexp(1.0, level) / 1024;
  return columns_of(level, [&](std::int32_t x, std::int32_t y) {
    double height = 200;
    double part = 160;
    double step = 1.0 / (256 * unit);
    for (int octave = 0; octave < 6; ++octave, part /= 2.1, step *= 2) {
      height += part * smooth_noise(x * step + 17 * octave, y * step);
    }
    return static_cast<std::int32_t>(height * unit);
  });
}

std::vector<std::uint8_t> city(int level) {
  Grid grid(level);
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
          grid.set(x, y, z);
        } else if (z >= roof) {
          break;
        }
      }
    }
  }
  return grid.compact();
}

std::vector<std::uint8_t> filled(const CompactTree& tree) {
  Grid solid(tree.level());
  Grid out(tree.level());
  tools::for_each_block(tree, [&](const Vec3i& at, int level, std::uint8_t) {
    const std::int32_t size = std::int32_t{1} << level;
    for (std::int32_t z = at.z; z < at.z + size; ++z) {
      for (std::int32_t y = at.y; y < at.y + size; ++y) {
        for (std::int32_t x = at.x; x < at.x + size; ++x) {
          solid.set(x, y, z);
        }
      }
    }
  });
  flood(&solid, &out);
  const std::int32_t side = solid.side();
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      for (std::size_t word = 0; word < solid.row_words(); ++word) {
        solid.row(y, z)[word] = ~out.row(y, z)[word];
      }
    }
  }
  return solid.compact();
}

std::vector<std::uint8_t> plummer_spheres(std::uint64_t points) {
  constexpr int kLevel = 10;
  constexpr double kSide = 1024;
  constexpr std::size_t kSpheres = 48;
  std::mt19937_64 random(7);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
  struct Sphere {
    std::array<double, 3> middle;
    double radius;
    double share;
  };
  std::array<Sphere, kSpheres> spheres{};
  double shares = 0;
  for (Sphere& sphere : spheres) {
    sphere.middle = {kSide * uniform(), kSide * uniform(), kSide * uniform()};
    sphere.radius = 8 + 40 * uniform();
    sphere.share = uniform();
    shares += sphere.share;
  }
  std::vector<std::uint32_t> keys;
  keys.reserve(points);
  const auto add = [&](double x, double y, double z) {
    if (x >= 0 && y >= 0 && z >= 0 && x < kSide && y < kSide && z < kSide) {
      keys.push_back(static_cast<std::uint32_t>(morton_code(
          static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z))));
    }
  };
  for (const Sphere& sphere : spheres) {
    const auto count = static_cast<std::uint64_t>(0.9 * static_cast<double>(points) * sphere.share / shares);
    for (std::uint64_t i = 0; i < count; ++i) {
      // The radius within which a part of the mass lies, turned round.
      const double part = std::max(uniform(), 1e-9);
      const double r = sphere.radius / std::sqrt(std::pow(part, -2.0 / 3) - 1 + 1e-9);
      const double z = 2 * uniform() - 1;
      const double turn = 6.283185307179586 * uniform();
      const double flat = std::sqrt(1 - z * z);
      add(sphere.middle[0] + r * flat * std::cos(turn), sphere.middle[1] + r * flat * std::sin(turn),
          sphere.middle[2] + r * z);
    }
  }
  for (std::uint64_t i = 0; i < points / 10; ++i) {
    const double x = kSide * uniform();
    const double y = kSide * uniform();
    add(x, y, kSide * uniform());
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  const Span<const std::uint32_t> all(keys.data(), keys.size());
  std::size_t bytes = 0;
  (void)CompactTree::make(all, kLevel, 1, Bytes(), nullptr, &bytes);
  std::vector<std::uint8_t> compact(bytes);
  if (CompactTree::make(all, kLevel, 1, Bytes(compact.data(), compact.size()), nullptr) != Status::kOk) {
    throw std::logic_error("the keys do not become a tree");
  }
  return compact;
}

}  // namespace thimble::tests
