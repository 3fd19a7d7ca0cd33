#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "scene/random.h"
#include "scene/world_fit.h"

namespace {

using namespace thimble::tools;

class ListCloud : public PointCloud {
 public:
  explicit ListCloud(std::vector<std::array<double, 3>> positions, std::vector<Rgb> colors = {})
      : positions_(std::move(positions)), colors_(std::move(colors)) {}
  void for_each(const Visit& visit) const override {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const auto& [x, y, z] = positions_[i];
      visit({x, y, z, colors_.empty() ? Rgb{} : colors_[i], i + 1});
    }
  }
  bool has_color() const override { return !colors_.empty(); }

 private:
  std::vector<std::array<double, 3>> positions_;
  std::vector<Rgb> colors_;
};

using Voxels = std::vector<std::array<int, 4>>;

Voxels fitted(const PointCloud& cloud, int level, const PaletteMap* colors = nullptr) {
  Voxels voxels;
  fit_points(cloud, survey_points(cloud), level, colors, [&](int x, int y, int z, std::uint8_t material) {
    voxels.push_back({x, y, z, material});
  });
  return voxels;
}

Voxels placed(const PointCloud& cloud, int level) {
  Voxels voxels;
  place_points(cloud, level, nullptr, [&](int x, int y, int z, std::uint8_t material) {
    voxels.push_back({x, y, z, material});
  });
  return voxels;
}

}  // namespace

TEST_CASE("fit_points: no points -> an error") {
  CHECK_THROWS_WITH_AS(survey_points(ListCloud({})), "no points", InputError);
}

TEST_CASE("fit_points: one point, or all equal -> the voxel in the middle") {
  CHECK(fitted(ListCloud({{-3, 7e5, 2}}), 4) == Voxels{{8, 8, 8, 0}});
  CHECK(fitted(ListCloud({{1, 1, 1}, {1, 1, 1}}), 1) == Voxels{{1, 1, 1, 0}, {1, 1, 1, 0}});
}

TEST_CASE("fit_points: no extent on an axis -> that axis goes to the middle, the others fill") {
  CHECK(fitted(ListCloud({{0, 5, 0}, {2, 5, 0.9}}), 4) == Voxels{{0, 8, 4, 0}, {15, 8, 11, 0}});
}

TEST_CASE("fit_points: any level -> one scale, longest axis fills, others centred, points not turned") {
  const ListCloud cloud({{0, 0, 0}, {10, 20, 40}});
  for (int level = 3; level <= 12; ++level) {
    const int side = 1 << level;
    const Voxels voxels = fitted(cloud, level);
    CHECK(voxels[0][2] == 0);
    CHECK(voxels[1][2] == side - 1);
    for (const auto& [axis, extent] : {std::pair<std::size_t, int>{0, side / 4}, {1, side / 2}}) {
      CHECK(std::abs(voxels[1][axis] - voxels[0][axis] - extent) <= 1);
      CHECK(std::abs(voxels[1][axis] + voxels[0][axis] - side) <= 1);
    }
  }
}

TEST_CASE("fit_points: a lattice as wide as the world -> each point its own voxel") {
  std::vector<std::array<double, 3>> line;
  for (int i = 0; i < 1024; ++i) {
    line.push_back({6.0e5 + i * 0.25, 4.0e6, 0});
  }
  const Voxels voxels = fitted(ListCloud(line), 10);
  for (int i = 0; i < 1024; ++i) {
    CHECK(voxels[static_cast<std::size_t>(i)][0] == i);
  }
}

TEST_CASE("fit_points: random clouds of any magnitude -> always inside the world") {
  constexpr std::uint64_t kSeed = 5;
  SplitMix64 random(kSeed);
  for (const double scale : {4.9e-324, 1e-310, 1e-9, 1.0, 1e9, 8.9e307}) {
    for (int round = 0; round < 50; ++round) {
      std::vector<std::array<double, 3>> positions;
      for (int i = 0; i < 20; ++i) {
        std::array<double, 3> p{};
        for (double& component : p) {
          component = scale * (random.between(-100000, 100000) / 50000.0);
        }
        positions.push_back(p);
      }
      const int level = 1 + static_cast<int>(random.below(12));
      CAPTURE(kSeed);
      CAPTURE(scale);
      int low = 1 << 12;
      int high = 0;
      for (const auto& [x, y, z, material] : fitted(ListCloud(positions), level)) {
        low = std::min({low, x, y, z});
        high = std::max({high, x, y, z});
      }
      CHECK(low >= 0);
      CHECK(high < 1 << level);
      if (scale > 1e-300) {
        CHECK(low == 0);
        CHECK(high == (1 << level) - 1);
      }
    }
  }
}

TEST_CASE(
    "choose_world: points far out -> left out, and no other; --fit 100 and clouds without such -> all") {
  SplitMix64 random(9);
  std::vector<std::array<double, 3>> near;
  for (int i = 0; i < 3000; ++i) {
    near.push_back(
        {random.between(0, 1000) / 10.0, random.between(0, 300) / 10.0, random.between(0, 50) / 10.0});
  }
  const auto surveyed = [](const std::vector<std::array<double, 3>>& positions,
                           const FitWishes& wishes = {}) {
    const ListCloud cloud(positions);
    PointSurvey survey = survey_points(cloud);
    choose_world(cloud, wishes, &survey);
    std::size_t drawn = 0;
    fit_points(cloud, survey, 6, nullptr, [&](int, int, int, std::uint8_t) { ++drawn; });
    CHECK(drawn == positions.size() - survey.left_out);
    return survey;
  };
  const Bounds whole = surveyed(near).world;
  CHECK(surveyed(near).left_out == 0);
  for (const double far : {900.0, -1e6, 1e300, -8.9e307}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CAPTURE(far);
      std::vector<std::array<double, 3>> positions = near;
      for (std::size_t i = 0; i < 20; ++i) {
        positions.insert(positions.begin() + static_cast<std::ptrdiff_t>(100 * i), near[i]);
        positions[100 * i][axis] = far * (1 + static_cast<double>(i) / 100);
      }
      const PointSurvey survey = surveyed(positions);
      CHECK(survey.left_out == 20);
      CHECK(survey.world.low == whole.low);
      CHECK(survey.world.high == whole.high);
      CHECK(surveyed(positions, {100, std::nullopt}).left_out == 0);
      CHECK(surveyed(positions, {99.9, std::nullopt}).left_out == 0);  // 20 are more than that
    }
  }
  // Seven times as long: no reason. Most at one place: none, either. Many points: by a sample.
  std::vector<std::array<double, 3>> positions = near;
  positions.push_back({700, 0, 0});
  CHECK(surveyed(positions).left_out == 0);
  positions.assign(1000, {1, 2, 3});
  positions.push_back({1000, 0, 0});
  CHECK(surveyed(positions).left_out == 0);
  positions.clear();
  for (int i = 0; i < 100; ++i) {
    positions.insert(positions.end(), near.begin(), near.end());
  }
  positions.push_back(near[0]);
  positions.push_back({0, 0, 5000});  // an odd one, which no sample holds
  CHECK(surveyed(positions).left_out == 1);
  CHECK(surveyed(positions, {100, std::nullopt}).left_out == 0);
  const Bounds clip{{0, 0, 0}, {50, 10, 5}, false};
  const PointSurvey clipped = surveyed(near, {99, clip});
  CHECK(clipped.left_out > 2000);
  CHECK((clipped.world.high[0] <= 50 && clipped.world.high[1] <= 10));
  CHECK_THROWS_WITH_AS(surveyed(near, {99, Bounds{{200, 0, 0}, {300, 1, 1}, false}}),
                       "no point is in the box of --clip", InputError);
}

TEST_CASE("fit_points: colours -> palette indices; without a palette or colours material 0") {
  const ListCloud cloud({{0, 0, 0}, {1, 1, 1}}, {{200, 10, 10}, {10, 200, 10}});
  const PaletteMap colors(survey_points(cloud).colors);
  const Voxels voxels = fitted(cloud, 2, &colors);
  CHECK(colors.palette()[static_cast<std::size_t>(voxels[0][3])].color == Rgb{200, 10, 10});
  CHECK(colors.palette()[static_cast<std::size_t>(voxels[1][3])].color == Rgb{10, 200, 10});
  CHECK(fitted(cloud, 2)[0][3] == 0);
  CHECK(fitted(ListCloud({{0, 0, 0}}), 2, &colors)[0][3] == 0);
}

TEST_CASE("place_points: coordinates are voxels -> rounded down, not moved") {
  CHECK(placed(ListCloud({{0, 3.999, 7}, {-0.0, 0.5, 7.999}}), 3) == Voxels{{0, 3, 7, 0}, {0, 0, 7, 0}});
}

TEST_CASE("place_points: outside the world -> an error that names the point") {
  for (const double bad : {-1e-9, 8.0, 1e300, -1e300}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<double, 3> p{1, 1, 1};
      p[axis] = bad;
      for (const char* const part : {"point 3: (", "0..7"}) {
        CHECK_THROWS_WITH_AS(placed(ListCloud({{0, 0, 0}, {7, 7, 7}, p}), 3), doctest::Contains(part),
                             InputError);
      }
    }
  }
}

TEST_CASE("smallest_level: every border of a world -> the smallest that holds the cloud") {
  const auto level_of = [](std::array<double, 3> p) {
    const ListCloud cloud({{0, 0, 0}, p});
    return smallest_level(cloud, survey_points(cloud));
  };
  CHECK(level_of({0, 0, 0}) == 1);
  CHECK(level_of({0, 1.9, 0}) == 1);
  for (int level = 1; level < 12; ++level) {
    CHECK(level_of({0, 0, (1 << level) - 0.25}) == level);
    CHECK(level_of({static_cast<double>(1 << level), 0, 0}) == level + 1);
  }
  CHECK(level_of({4095.999, 0, 0}) == 12);
  const ListCloud outside({{1, 1, 1}, {5, -1, 4096}, {-1, -1, -1}});
  CHECK_THROWS_WITH_AS(smallest_level(outside, survey_points(outside)),
                       "point 2: (5, -1, 4096) is outside the world's voxels 0..4095 on an axis", InputError);
  // Fitted, the same cloud is fine.
  CHECK(fitted(outside, 3).size() == 3);
}
