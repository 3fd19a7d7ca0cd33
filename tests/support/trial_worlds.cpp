#include "support/trial_worlds.h"

#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "readers/oct.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "support/solid_worlds.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

using tools::Real3;

// Fills worlds of any size; grows its pool by doubling when it is full.
class Builder {
 public:
  using Fill = std::function<bool(Builder&)>;

  static std::vector<std::uint8_t> build(int level, const Fill& fill) {
    for (std::size_t bytes = std::size_t{1} << 20; bytes <= std::size_t{1} << 30; bytes *= 4) {
      Builder builder(level, bytes);
      if (fill(builder)) {
        std::vector<std::uint8_t> compact(compact_bytes(compact_shape(builder.octree_)));
        std::size_t written = 0;
        if (CompactTree::make(builder.octree_, Bytes(compact.data(), compact.size()), nullptr, &written) !=
            Status::kOk) {
          throw std::logic_error("the octree does not become compact");
        }
        return compact;
      }
    }
    throw std::logic_error("a trial world is too large");
  }

  std::int32_t side() const { return std::int32_t{1} << level_; }
  int level() const { return level_; }
  // The same numbers in every turn.
  std::mt19937_64& random() { return random_; }

  // False when the pool is full.
  bool add(std::int32_t x, std::int32_t y, std::int32_t z) {
    return octree_.insert({x, y, z}, 1) == Status::kOk;
  }

  // The voxels low .. high - 1 within a block, as the largest blocks.
  bool add_box(const Vec3i& low, const Vec3i& high) {
    return octree_.insert_box({low, high}, 1) == Status::kOk;
  }

 private:
  Builder(int level, std::size_t bytes) : level_(level), pool_(bytes), random_(1) {
    if (Octree::make(level, Bytes(pool_.data(), pool_.size()), &octree_) != Status::kOk) {
      throw std::logic_error("no such level");
    }
  }

  int level_;
  std::vector<std::uint8_t> pool_;
  Octree octree_;
  std::mt19937_64 random_;
};

// The voxels of the box for which `is_solid(x, y, z)`.
template <class IsSolid>
bool add_some(Builder& builder, const Vec3i& low, const Vec3i& high, const IsSolid& is_solid) {
  for (std::int32_t z = low.z; z < high.z; ++z) {
    for (std::int32_t y = low.y; y < high.y; ++y) {
      for (std::int32_t x = low.x; x < high.x; ++x) {
        if (is_solid(x, y, z) && !builder.add(x, y, z)) {
          return false;
        }
      }
    }
  }
  return true;
}

bool add_dust(Builder& builder, std::int32_t count, const Vec3i& low, const Vec3i& high) {
  for (std::int32_t i = 0; i < count; ++i) {
    Vec3i at{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto room = static_cast<std::uint64_t>(high[axis] - low[axis]);
      at[axis] = low[axis] + static_cast<std::int32_t>(builder.random()() % room);
    }
    if (!builder.add(at.x, at.y, at.z)) {
      return false;
    }
  }
  return true;
}

bool fill_solid(Builder& builder) {
  const std::int32_t side = builder.side();
  return builder.add_box({0, 0, 0}, {side, side, side});
}

bool fill_inset(Builder& builder) {
  const std::int32_t end = builder.side() - 1;
  return builder.add_box({1, 1, 1}, {end, end, end});
}

bool fill_noise(Builder& builder) {
  const std::int32_t side = builder.side();
  return add_some(builder, {0, 0, 0}, {side, side, side},
                  [&](auto, auto, auto) { return (builder.random()() & 1U) != 0; });
}

bool fill_checker(Builder& builder) {
  const std::int32_t side = builder.side();
  return add_some(builder, {0, 0, 0}, {side, side, side},
                  [](auto x, auto y, auto z) { return ((x + y + z) & 1) != 0; });
}

bool fill_sponge(Builder& builder) {
  std::int32_t side = 1;
  while (side * 3 <= builder.side()) {
    side *= 3;
  }
  return add_some(builder, {0, 0, 0}, {side, side, side}, [](std::int32_t x, std::int32_t y, std::int32_t z) {
    for (; x != 0 || y != 0 || z != 0; x /= 3, y /= 3, z /= 3) {
      const int middles = (x % 3 == 1 ? 1 : 0) + (y % 3 == 1 ? 1 : 0) + (z % 3 == 1 ? 1 : 0);
      if (middles >= 2) {
        return false;
      }
    }
    return true;
  });
}

bool fill_voxel(Builder& builder) {
  const std::int32_t middle = builder.side() / 2;
  return builder.add(middle, middle, middle);
}

bool fill_wall(Builder& builder) {
  const std::int32_t side = builder.side();
  return builder.add_box({0, side / 3, 0}, {side, side / 3 + 1, side});
}

bool fill_slant(Builder& builder) {
  const std::int32_t side = builder.side();
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      const std::int32_t x = 3 * side / 2 - y - z;
      if ((x >= 0 && x < side && !builder.add(x, y, z)) ||
          (x >= 1 && x <= side && !builder.add(x - 1, y, z))) {
        return false;
      }
    }
  }
  return true;
}

bool fill_columns(Builder& builder) {
  const std::int32_t side = builder.side();
  for (std::int32_t y = 3; y < side; y += 8) {
    for (std::int32_t x = 5; x < side; x += 8) {
      if (!builder.add_box({x, y, 0}, {x + 1, y + 1, side})) {
        return false;
      }
    }
  }
  return true;
}

bool fill_islands(Builder& builder) {
  const std::int32_t side = builder.side();
  const std::int32_t part = side / 16;
  const auto is_solid = [&](auto, auto, auto) { return (builder.random()() & 1U) != 0; };
  return add_some(builder, {0, 0, 0}, {part, part, part}, is_solid) &&
         add_some(builder, {side - part, side - part, side - part}, {side, side, side}, is_solid) &&
         add_dust(builder, side * 8, {0, 0, 0}, {side, side, side});
}

bool fill_screen(Builder& builder) {
  const std::int32_t side = builder.side();
  return builder.add_box({0, 0, 0}, {side, side / 16, side}) &&
         add_dust(builder, side * side, {0, side / 4, 0}, {side, side, side});
}

bool fill_ball(Builder& builder) {
  const std::int32_t side = builder.side();
  const std::int32_t radius = side / 2 - 1;
  const auto square = [&](std::int32_t a) { return (a - side / 2) * (a - side / 2); };
  for (std::int32_t z = 0; z < side; ++z) {
    for (std::int32_t y = 0; y < side; ++y) {
      const double left = static_cast<double>(radius) * radius - square(y) - square(z);
      if (left < 0) {
        continue;
      }
      const auto reach = static_cast<std::int32_t>(std::sqrt(left));
      if (!builder.add(side / 2 - reach, y, z) || !builder.add(side / 2 + reach, y, z)) {
        return false;
      }
    }
  }
  return true;
}

struct Kind {
  const char* name;
  bool (*fill)(Builder&);
};
constexpr std::array<Kind, 12> kKinds{{{"solid", fill_solid},
                                       {"inset", fill_inset},
                                       {"noise", fill_noise},
                                       {"checker", fill_checker},
                                       {"sponge", fill_sponge},
                                       {"voxel", fill_voxel},
                                       {"wall", fill_wall},
                                       {"slant", fill_slant},
                                       {"columns", fill_columns},
                                       {"islands", fill_islands},
                                       {"screen", fill_screen},
                                       {"ball", fill_ball}}};

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
  tools::for_each_block(tree, [&](const Vec3i& at, int, std::uint8_t) {
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

}  // namespace

// Makes one of solid_worlds.h, if it is one.
void TrialWorld::make_solid(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string what = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (kind == "globe") {
    bytes_ = full_ball(std::stoi(what));
  } else if (kind == "terrain") {
    bytes_ = thick_terrain(std::stoi(what));
  } else if (kind == "city") {
    bytes_ = city(std::stoi(what));
  } else if (kind == "plummer") {
    bytes_ = plummer_spheres(std::stoull(what));
  } else if (kind == "filled") {
    const tools::BuiltScene hollow(*tools::open_scene(arguments_of(what)), tools::BuildOptions{});
    bytes_ = filled(hollow.compact());
  } else {
    return;
  }
  if (CompactTree::open(ConstBytes(bytes_.data(), bytes_.size()), &tree_) != Status::kOk) {
    throw std::logic_error("a solid world does not open");
  }
}

TrialWorld::TrialWorld(const std::string& name) : name_(name) {
  for (const Kind& kind : kKinds) {
    const std::string prefix = std::string(kind.name) + ":";
    if (name.rfind(prefix, 0) == 0) {
      bytes_ = Builder::build(std::stoi(name.substr(prefix.size())), kind.fill);
      if (CompactTree::open(ConstBytes(bytes_.data(), bytes_.size()), &tree_) != Status::kOk) {
        throw std::logic_error("a trial world does not open");
      }
    }
  }
  make_solid(name);
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
