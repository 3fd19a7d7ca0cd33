#include "scene/world_fit.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdio>

namespace thimble::tools {
namespace {

// As std::lround, whose call takes longer than all of it.
std::int32_t rounded(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  const double rest = value - whole;
  return whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

bool holds(const Bounds& bounds, const std::array<double, 3>& position) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(position[axis] >= bounds.low[axis] && position[axis] <= bounds.high[axis])) {
      return false;
    }
  }
  return true;
}

// The longest side; infinite where a double does not hold it.
double longest(const Bounds& bounds) {
  const auto& [low, high, is_empty] = bounds;
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

[[noreturn]] void refuse(const char* counts_in, const CloudPoint& point, std::int32_t side) {
  char text[256];
  std::snprintf(text, sizeof text,
                "%s %llu: (%.10g, %.10g, %.10g) is outside the world's voxels 0..%d on an axis", counts_in,
                static_cast<unsigned long long>(point.line), point.x, point.y, point.z, side - 1);
  throw InputError(text);
}

}  // namespace

WorldFit::WorldFit(const Bounds& bounds, int level) : center_{}, center_units_{}, half_extent_(0) {
  const std::int32_t middle = std::int32_t{1} << (level + kUnitBits - 1);
  half_units_ = static_cast<double>(middle - 1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Halves before the difference: the extent of finite bounds may be infinite, its half is not.
    const double low = bounds.low[axis] / 2;
    const double high = bounds.high[axis] / 2;
    center_[axis] = low + high;
    center_units_[axis] = high > low ? middle : middle + kUnitsPerVoxel / 2;
    half_extent_ = std::max(half_extent_, high - low);
  }
}

std::array<std::int32_t, 3> WorldFit::units(const std::array<double, 3>& position) const {
  std::array<std::int32_t, 3> result = center_units_;
  if (half_extent_ == 0) {
    return result;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Divided first: 1 / half_extent may be infinite for tiny scenes. The clamp catches what rounding of
    // the centre adds (a scene a few ulps wide, or denormal numbers).
    const double offset = std::clamp((position[axis] - center_[axis]) / half_extent_, -1.0, 1.0);
    result[axis] += rounded(offset * half_units_);
    const std::int32_t largest = static_cast<std::int32_t>(half_units_) * 2 + 1;
    result[axis] = std::clamp(result[axis], 1, largest);
  }
  return result;
}

PointSurvey survey_points(const PointCloud& cloud) {
  constexpr std::size_t kMostSamples = std::size_t{1} << 16;
  PointSurvey survey;
  const bool colored = cloud.has_color();
  std::uint64_t every = 1;
  cloud.for_each([&](const CloudPoint& point) {
    if (survey.points % every == 0) {
      if (survey.sample.size() == kMostSamples) {
        for (std::size_t i = 0; i < kMostSamples / 2; ++i) {
          survey.sample[i] = survey.sample[2 * i];
        }
        survey.sample.resize(kMostSamples / 2);
        every *= 2;
      }
      survey.sample.push_back({point.x, point.y, point.z});
    }
    ++survey.points;
    survey.bounds.add({point.x, point.y, point.z});
    if (colored) {
      survey.colors.add(point.color);
    }
  });
  fail_if(survey.points == 0, "no points");
  survey.world = survey.bounds;
  return survey;
}

void choose_world(const PointCloud& cloud, const FitWishes& wishes, PointSurvey* survey) {
  if (!wishes.clip && wishes.percent >= 100) {
    return;
  }
  Bounds taken;
  if (wishes.clip) {
    taken = *wishes.clip;
  } else {
    // On each axis the shortest stretch that holds so many of the sample.
    const std::size_t count = survey->sample.size();
    const auto outer = static_cast<std::size_t>(static_cast<double>(count) * (100 - wishes.percent) / 100);
    const std::size_t last = count - 1 - outer;
    taken.empty = false;
    std::vector<double> numbers(count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::transform(survey->sample.begin(), survey->sample.end(), numbers.begin(),
                     [&](const std::array<double, 3>& position) { return position[axis]; });
      std::sort(numbers.begin(), numbers.end());
      std::size_t first = 0;
      for (std::size_t i = 1; i <= outer; ++i) {
        first = numbers[i + last] - numbers[i] < numbers[first + last] - numbers[first] ? i : first;
      }
      taken.low[axis] = numbers[first];
      taken.high[axis] = numbers[first + last];
    }
    const double inner = longest(taken);
    if (!(inner > 0 && inner < longest(survey->bounds) / 8)) {
      return;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      taken.low[axis] -= inner;
      taken.high[axis] += inner;
    }
  }
  survey->world = {};
  std::uint64_t inside = 0;
  cloud.for_each([&](const CloudPoint& point) {
    const std::array<double, 3> position{point.x, point.y, point.z};
    if (holds(taken, position)) {
      survey->world.add(position);
      ++inside;
    }
  });
  fail_if(inside == 0, "no point is in the box of --clip");
  survey->left_out = survey->points - inside;
}

int smallest_level(const PointCloud& cloud, const PointSurvey& survey) {
  const auto& [low, high, is_empty] = survey.bounds;
  const double most = *std::max_element(high.begin(), high.end());
  if (*std::min_element(low.begin(), low.end()) < 0 || most >= 1 << kMaxLevel) {
    place_points(cloud, kMaxLevel, nullptr,
                 [](auto, auto, auto, auto) {});  // refuses the first that lies outside
  }
  return std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(most))));
}

void fit_points(const PointCloud& cloud, const PointSurvey& survey, int level, const PaletteMap* colors,
                const VoxelSink& sink) {
  const WorldFit fit(survey.world, level);
  const PaletteMap* const used = cloud.has_color() ? colors : nullptr;
  cloud.for_each([&](const CloudPoint& point) {
    const std::array<double, 3> position{point.x, point.y, point.z};
    if (survey.left_out != 0 && !holds(survey.world, position)) {
      return;
    }
    const auto [x, y, z] = fit.units(position);
    sink(x >> kUnitBits, y >> kUnitBits, z >> kUnitBits,
         used != nullptr ? used->index(point.color) : std::uint8_t{0});
  });
}

void place_points(const PointCloud& cloud, int level, const PaletteMap* colors, const VoxelSink& sink) {
  const std::int32_t side = std::int32_t{1} << level;
  const PaletteMap* const used = cloud.has_color() ? colors : nullptr;
  cloud.for_each([&](const CloudPoint& point) {
    // Written so that a NaN is outside too. -0.0 is 0. Of what is not negative the whole part is the floor.
    const auto lies_within = [side](double at) { return at >= 0 && at < side; };
    if (!(lies_within(point.x) && lies_within(point.y) && lies_within(point.z))) {
      refuse(cloud.counts_in(), point, side);
    }
    sink(static_cast<std::int32_t>(point.x), static_cast<std::int32_t>(point.y),
         static_cast<std::int32_t>(point.z), used != nullptr ? used->index(point.color) : std::uint8_t{0});
  });
}

}  // namespace thimble::tools
