// Stopping at nodes that cover less than a part of a pixel: held to the definition (cutoff.h), worked out
// from the voxels alone; and the mean colours of what was left out.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "reference/reference.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/picture/cutoff.h"

namespace thimble::tests {
namespace {

const int kScenes = thimble::tests::many_or_few(24, 6);
const int kRaysAScene = thimble::tests::many_or_few(1500, 150);
constexpr std::uint64_t kSeed = 20240611;

using reference::Voxel;

Camera pinhole(int level, int width_px, int fov) {
  PerspectiveView view;
  const std::int32_t world = 1 << level;
  view.eye = {Q8::saturate(-2 * world), Q8::saturate(-3 * world), Q8::saturate(2 * world)};
  view.forward = {5, 9, -2};
  view.fov_degrees = Q16::saturate(fov);
  view.width_px = width_px;
  view.height_px = width_px * 3 / 4;
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

Camera parallel(int level, int width_px, std::int32_t span) {
  OrthographicView view;
  view.eye = {Q8::saturate(0), Q8::saturate(-2), Q8::saturate(8)};
  view.forward = {1, 8, -1};
  view.span = Q14::saturate(span);
  view.width_px = width_px;
  view.height_px = width_px * 3 / 4;
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

// The boxes that count for one ray, from the voxels: the definition's words.
class Boxes {
 public:
  Boxes(const reference::BitGrid& grid, int level, const reference::Ray& ray, const Cutoff& cutoff)
      : grid_(grid), ray_(ray), cut_level_(cutoff.level()) {
    for (std::size_t axis = 1; axis < 3; ++axis) {
      if (std::abs(ray.direction[axis]) > std::abs(ray.direction[axis_])) {
        axis_ = axis;
      }
    }
    reach_q8_ = cutoff.reach_q8(static_cast<std::int32_t>(std::abs(ray.direction[axis_])));
    add({0, 0, 0}, level);
  }
  const std::vector<reference::Block>& boxes() const { return boxes_; }
  // Whether the box is a node that was cut.
  bool is_cut(const Voxel& lowest, int level) const {
    return std::any_of(cut_.begin(), cut_.end(), [&](const reference::Block& box) {
      return box.lowest == lowest && box.log2_side == level;
    });
  }

 private:
  int count(const Voxel& lowest, int level) const {
    int result = 0;
    const int side = 1 << level;
    for (int z = 0; z < side; ++z) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          result += grid_.test({lowest[0] + x, lowest[1] + y, lowest[2] + z}) ? 1 : 0;
        }
      }
    }
    return result;
  }
  bool cuts(const Voxel& lowest, int level) const {
    if (level <= cut_level_) {
      return true;
    }
    const bool up = ray_.direction[axis_] > 0;
    const std::int64_t plane = 256 * (lowest[axis_] + (up ? 0 : 1 << level));
    const std::int64_t distance = up ? plane - ray_.origin_q8[axis_] : ray_.origin_q8[axis_] - plane;
    return distance >= (std::int64_t{reach_q8_} << level);
  }
  void add(const Voxel& lowest, int level) {
    const int voxels = count(lowest, level);
    if (voxels == 0) {
      return;
    }
    if (level == 0) {
      boxes_.push_back({lowest, 0});
      return;
    }
    if (cuts(lowest, level)) {
      boxes_.push_back({lowest, level});
      cut_.push_back({lowest, level});
      return;
    }
    // A node that is solid through has none below it.
    const bool full = voxels == 1 << 3 * level;
    const int step = full ? 1 : 1 << (level - 1);
    for (int z = 0; z < 1 << level; z += step) {
      for (int y = 0; y < 1 << level; y += step) {
        for (int x = 0; x < 1 << level; x += step) {
          const Voxel corner{lowest[0] + x, lowest[1] + y, lowest[2] + z};
          if (full) {
            boxes_.push_back({corner, 0});
          } else {
            add(corner, level - 1);
          }
        }
      }
    }
  }

  const reference::BitGrid& grid_;
  const reference::Ray& ray_;
  std::size_t axis_ = 0;
  int cut_level_;
  std::int32_t reach_q8_ = 0;
  std::vector<reference::Block> boxes_;
  std::vector<reference::Block> cut_;
};

// Whether the ray meets the least box around all voxels.
bool meets(const VoxelBox& box, const reference::Ray& ray) {
  std::vector<Voxel> shell;
  for (int z = box.low.z; z < box.high.z; ++z) {
    for (int y = box.low.y; y < box.high.y; ++y) {
      for (int x = box.low.x; x < box.high.x; ++x) {
        const bool outer = x == box.low.x || x == box.high.x - 1 || y == box.low.y || y == box.high.y - 1 ||
                           z == box.low.z || z == box.high.z - 1;
        if (outer) {
          shell.push_back({x, y, z});
        }
      }
    }
  }
  return reference::brute_force(shell, ray).hit;
}

std::vector<Voxel> random_voxels(std::mt19937_64& random, int side) {
  std::vector<Voxel> voxels;
  const std::int64_t strewn = pick(random, 1, 40);
  for (std::int64_t i = 0; i < strewn; ++i) {
    voxels.push_back(
        {pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)});
  }
  // Aligned cubes, so that some nodes are solid through.
  for (std::int64_t i = pick(random, 0, 3); i > 0; --i) {
    const int size = 1 << pick(random, 1, side == 2 ? 1 : 2);
    Voxel corner{};
    for (int& coordinate : corner) {
      coordinate = pick_int(random, 0, side / size - 1) * size;
    }
    add_box(corner, {corner[0] + size, corner[1] + size, corner[2] + size}, &voxels);
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

TEST_CASE("cutoff: any ray and any cut-off, both widths -> the first box of the definition") {
  INFO("seed ", kSeed);
  std::mt19937_64 random(kSeed);
  int cut_hits = 0;
  int other_hits = 0;
  int narrow = 0;
  for (int scene = 0; scene < kScenes; ++scene) {
    const int level = pick_int(random, 2, 4);
    const int side = 1 << level;
    const SceneUnderTest world({side, side, side}, random_voxels(random, side));
    const CompactTree& tree = world.compact();
    const Q16 pixels = Q16::from_raw(pick_int(random, 1, 1 << pick(random, 8, 22)));
    Cutoff cutoff;
    const Camera camera = scene % 3 == 0 ? parallel(level, 32, pick_int(random, side / 2, 4 * side))
                                         : pinhole(level, pick_int(random, 4, 200), 60);
    REQUIRE(cutoff.set(camera, pixels) == Status::kOk);
    if (scene % 4 == 1) {
      REQUIRE(cutoff.set_level(pick_int(random, 0, level)) == Status::kOk);
    }
    RayCases rays(random(), {side, side, side}, full_limits({side, side, side}));
    for (int i = 0; i < kRaysAScene; ++i) {
      const reference::Ray judged = rays.next().ray;
      const Ray ray = to_core(judged);
      const Boxes boxes(world.reference(), level, judged, cutoff);
      reference::Hit expected = reference::judge_blocks(boxes.boxes(), judged);
      expected.hit = expected.hit && meets(tree.bounds(), judged);
      for (const Width width : {Width::k64, Width::k32}) {
        if (width == Width::k32 && !accepts_32(ray, level)) {
          continue;
        }
        narrow += width == Width::k32 ? 1 : 0;
        CutHit hit;
        REQUIRE(closest_hit_cut(tree, ray, cutoff, &hit, {UINT32_MAX, width}) == Status::kOk);
        INFO(reference::describe(judged), " -> ", describe(hit.hit), ", expected ",
             reference::describe(expected));
        REQUIRE(same_answer(hit.hit, expected));
        if (expected.hit) {
          REQUIRE(hit.cut == boxes.is_cut(expected.voxel, hit.hit.block_level));
          cut_hits += hit.cut ? 1 : 0;
          other_hits += hit.cut ? 0 : 1;
        }
        Hit plain;
        REQUIRE(closest_hit(tree, ray, &plain, {UINT32_MAX, width}) == Status::kOk);
        REQUIRE(hit.hit.visits <= plain.visits);
        if (plain.kind == HitKind::kHit) {  // nothing vanishes, nothing moves away
          REQUIRE(hit.hit.kind == HitKind::kHit);
          REQUIRE(std::int64_t{hit.hit.t_numerator} * plain.t_denominator <=
                  std::int64_t{plain.t_numerator} * hit.hit.t_denominator);
        }
      }
    }
  }
  CHECK(cut_hits > kScenes * kRaysAScene / 20);
  CHECK(other_hits > kScenes * kRaysAScene / 20);
  CHECK(narrow > kScenes * kRaysAScene / 20);
}

TEST_CASE("cutoff: a pixel of half a voxel -> the level whose nodes are smaller, and no reach") {
  // A pixel of exactly half a voxel: nodes of 2 are less than 4.001 pixels, and not less than 4.
  const Camera half = parallel(6, 64, 32);
  for (const auto& [raw, expected] : std::array<std::array<std::int32_t, 2>, 5>{{{4 * 65536 - 100, 0},
                                                                                 {4 * 65536 + 100, 1},
                                                                                 {8 * 65536 - 100, 1},
                                                                                 {8 * 65536 + 100, 2},
                                                                                 {64 * 65536, 4}}}) {
    Cutoff cutoff;
    REQUIRE(cutoff.set(half, Q16::from_raw(raw)) == Status::kOk);
    CHECK(cutoff.level() == expected);
    CHECK(cutoff.reach_q8(1000) == INT32_MAX);
  }
}

TEST_CASE("cutoff: limits -> kOutOfRange or kBadArgument, and nothing changed") {
  const Camera camera = pinhole(5, 100, 60);
  Cutoff cutoff;
  REQUIRE(cutoff.set(camera, Q16::saturate(2)) == Status::kOk);
  const std::int32_t before = cutoff.reach_q8(1000);
  CHECK(cutoff.set(camera, Q16::from_raw(-1)) == Status::kOutOfRange);
  CHECK(cutoff.set(camera, Q16::from_raw(kMaxCutoff.raw + 1)) == Status::kOutOfRange);
  CHECK(cutoff.set(Camera(), Q16::saturate(1)) == Status::kBadArgument);
  CHECK(cutoff.set_level(-1) == Status::kOutOfRange);
  CHECK(cutoff.set_level(kMaxLevel + 1) == Status::kOutOfRange);
  CHECK(cutoff.reach_q8(1000) == before);
  CHECK(cutoff.level() == 0);
  CHECK(!cutoff.cuts_nothing());
  CHECK(cutoff.set(camera, Q16()) == Status::kOk);
  CHECK(cutoff.cuts_nothing());
}

TEST_CASE("cutoff: a band that cannot be drawn -> an error and nothing drawn") {
  const SceneUnderTest world({16, 16, 16}, {{1, 2, 3}, {9, 9, 9}, {4, 5, 6}, {7, 7, 8}, {1, 1, 1}}, 5);
  const Camera camera = pinhole(4, 20, 60);
  Shading shading;
  shading.mode = ShadeMode::kColor;
  Cutoff cutoff;
  REQUIRE(cutoff.set(camera, Q16::saturate(1)) == Status::kOk);
  REQUIRE(world.compact().many_materials());
  std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kRgb888, 20, 15), 0xA5);
  const auto untouched = pixels;
  const auto attempt = [&](const CompactTree& tree, const Camera& view, std::int32_t first, std::int32_t rows,
                           std::size_t size, std::size_t stride) {
    Band band{Bytes(pixels.data(), size), PixelFormat::kRgb888, stride, first, rows};
    return render_band_cut(tree, view, shading, cutoff, NodeColors(), band);
  };
  const CompactTree& tree = world.compact();
  CHECK(attempt(tree, camera, 0, 15, pixels.size(), 0) == Status::kBadArgument);  // no colours
  shading.mode = ShadeMode::kDepth;
  CHECK(attempt(tree, Camera(), 0, 15, pixels.size(), 0) == Status::kBadArgument);
  CHECK(attempt(tree, pinhole(5, 20, 60), 0, 15, pixels.size(), 0) == Status::kBadArgument);
  CHECK(attempt(tree, camera, -1, 2, pixels.size(), 0) == Status::kBadArgument);
  CHECK(attempt(tree, camera, 1, 15, pixels.size(), 0) == Status::kBadArgument);
  CHECK(attempt(tree, camera, 0, 15, pixels.size(), 59) == Status::kBadArgument);
  CHECK(attempt(tree, camera, 0, 15, pixels.size() - 1, 0) == Status::kOutOfMemory);
  CHECK(attempt(tree, camera, 0, 0, 0, 0) == Status::kOk);
  CHECK(pixels == untouched);
  CHECK(attempt(tree, camera, 0, 15, pixels.size(), 0) == Status::kOk);
}

// --- Mean colours.

TEST_CASE("node colours: every node -> the mean of its voxels' colours, once rounded") {
  INFO("seed ", kSeed);
  std::mt19937_64 random(kSeed);
  std::vector<Rgb8> palette(7);
  for (Rgb8& color : palette) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  const Rgb8 other{10, 20, 30};
  for (int scene = 0; scene < kScenes; ++scene) {
    const int level = pick_int(random, 1, 5);
    const int side = 1 << level;
    // Materials beyond the palette too; cubes of one material come from a salt that gives few materials.
    const unsigned materials = scene % 2 == 0 ? 9 : 2;
    const std::uint64_t salt = random();
    const SceneUnderTest world({side, side, side}, random_voxels(random, side), materials, salt);
    const CompactTree& tree = world.compact();
    if (!tree.many_materials()) {
      CHECK(node_colors_bytes(tree) == 0);
      continue;
    }
    const HeapBytes table(node_colors_bytes(tree), 1);
    NodeColors colors;
    REQUIRE(NodeColors::make(tree, {palette.data(), palette.size()}, other, table.span(), &colors) ==
            Status::kOk);
    REQUIRE(colors.nodes() == tree.node_count());
    // Nodes in the tree's order, by their corners.
    struct Node {
      std::uint32_t index;
      Voxel corner;
      int level;
    };
    std::vector<Node> nodes{{0, {0, 0, 0}, level}};
    for (std::size_t at = 0; at < nodes.size(); ++at) {
      const Node node = nodes[at];
      std::array<double, 3> sum{};
      double count = 0;
      for (const Voxel& voxel : world.voxels()) {
        bool within = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          within = within && voxel[axis] >> node.level == node.corner[axis] >> node.level;
        }
        if (within) {
          const std::size_t material = material_at(voxel, materials, salt);
          const Rgb8 color = material < palette.size() ? palette[material] : other;
          sum = {sum[0] + color.r, sum[1] + color.g, sum[2] + color.b};
          ++count;
        }
      }
      REQUIRE(count > 0);
      const Rgb8 mean = colors.color(node.index);
      const std::array<double, 3> channels{double(mean.r), double(mean.g), double(mean.b)};
      const std::array<double, 3> steps{31, 63, 31};
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double exact = sum[channel] / count;
        CHECK(std::abs(channels[channel] - exact) <= kNodeColorError);
        CHECK(std::abs(channels[channel] - exact) <= 127.5 / steps[channel] + 0.5001);
      }
      std::uint32_t child = tree.mask(node.index) != 0 && node.level > 1 ? tree.first_child(node.index) : 0;
      for (int octant = 0; child != 0 && octant < 8; ++octant) {
        if ((tree.mask(node.index) >> octant & 1) != 0) {
          const int half = 1 << (node.level - 1);
          nodes.push_back({child++,
                           {node.corner[0] + (octant & 1) * half, node.corner[1] + (octant >> 1 & 1) * half,
                            node.corner[2] + (octant >> 2) * half},
                           node.level - 1});
        }
      }
    }
    CHECK(nodes.size() == tree.node_count());
    NodeColors unchanged;
    CHECK(NodeColors::make(tree, {palette.data(), palette.size()}, other,
                           table.span().subspan(0, node_colors_bytes(tree) - 1),
                           &unchanged) == Status::kOutOfMemory);
    CHECK(unchanged.nodes() == 0);
  }
}

}  // namespace
}  // namespace thimble::tests
