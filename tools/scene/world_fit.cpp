#include "scene/world_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

}  // namespace thimble::tools
