#include "scene/world_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

namespace thimble::tools {

void Bounds::add(const std::array<double, 3>& position) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = empty ? position[axis] : std::min(low[axis], position[axis]);
    high[axis] = empty ? position[axis] : std::max(high[axis], position[axis]);
  }
  empty = false;
}

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
    result[axis] += static_cast<std::int32_t>(std::lround(offset * half_units_));
    const std::int32_t largest = static_cast<std::int32_t>(half_units_) * 2 + 1;
    result[axis] = std::clamp(result[axis], 1, largest);
  }
  return result;
}

std::array<std::int32_t, 3> WorldFit::voxel(const std::array<double, 3>& position) const {
  std::array<std::int32_t, 3> result = units(position);
  for (std::int32_t& component : result) {
    component >>= kUnitBits;
  }
  return result;
}

namespace {

constexpr int kLargestLevel = 12;

/// The voxel of a point taken as it is, or nothing when it is outside 0 .. side - 1.
std::optional<std::array<std::int32_t, 3>> voxel_at(const CloudPoint& point, std::int32_t side) {
  const std::array<double, 3> position{point.x, point.y, point.z};
  std::array<std::int32_t, 3> voxel{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Written so that a NaN is outside too. -0.0 is 0.
    if (!(position[axis] >= 0 && position[axis] < side)) {
      return std::nullopt;
    }
    voxel[axis] = static_cast<std::int32_t>(std::floor(position[axis]));
  }
  return voxel;
}

[[noreturn]] void refuse(const char* counts_in, const CloudPoint& point, std::int32_t side) {
  char text[256];
  std::snprintf(text, sizeof text,
                "%s %llu: (%.10g, %.10g, %.10g) is outside the world's voxels 0..%d on an axis", counts_in,
                static_cast<unsigned long long>(point.line), point.x, point.y, point.z, side - 1);
  throw InputError(text);
}

}  // namespace

PointSurvey survey_points(const PointCloud& cloud) {
  PointSurvey survey;
  survey.counts_in = cloud.counts_in();
  const bool colored = cloud.has_color();
  cloud.for_each([&](const CloudPoint& point) {
    ++survey.points;
    survey.bounds.add({point.x, point.y, point.z});
    if (colored) {
      survey.colors.add(point.color);
    }
    if (!survey.unplaceable && !voxel_at(point, 1 << kLargestLevel)) {
      survey.unplaceable = point;
    }
  });
  if (survey.points == 0) {
    throw InputError("no points");
  }
  return survey;
}

int smallest_level(const PointSurvey& survey) {
  if (survey.unplaceable) {
    refuse(survey.counts_in, *survey.unplaceable, 1 << kLargestLevel);
  }
  const std::array<double, 3>& max = survey.bounds.high;
  int level = 1;
  while (level < kLargestLevel && (max[0] >= 1 << level || max[1] >= 1 << level || max[2] >= 1 << level)) {
    ++level;
  }
  return level;
}

void fit_points(const PointCloud& cloud, const PointSurvey& survey, int level, const PaletteMap* colors,
                const VoxelSink& sink) {
  const WorldFit fit(survey.bounds, level);
  const PaletteMap* const used = cloud.has_color() ? colors : nullptr;
  cloud.for_each([&](const CloudPoint& point) {
    const auto voxel = fit.voxel({point.x, point.y, point.z});
    sink(voxel[0], voxel[1], voxel[2], used != nullptr ? used->index(point.color) : std::uint8_t{0});
  });
}

void place_points(const PointCloud& cloud, int level, const PaletteMap* colors, const VoxelSink& sink) {
  const std::int32_t side = std::int32_t{1} << level;
  const PaletteMap* const used = cloud.has_color() ? colors : nullptr;
  cloud.for_each([&](const CloudPoint& point) {
    const auto voxel = voxel_at(point, side);
    if (!voxel) {
      refuse(cloud.counts_in(), point, side);
    }
    sink((*voxel)[0], (*voxel)[1], (*voxel)[2], used != nullptr ? used->index(point.color) : std::uint8_t{0});
  });
}

}  // namespace thimble::tools
