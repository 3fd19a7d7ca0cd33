// The slope of a surface in steps, for a host that keeps what the points of a face share (slope_window.h). Apart
// from slope.cpp, so that what a chip links keeps every instruction; the short ones are there in other words.
#include "slope_parts.h"

namespace thimble::lit {
namespace {

bool is_along(const Vec3i& normal, int axis) {
  return normal[axis == 0 ? 1 : 0] == 0 && normal[axis == 2 ? 1 : 2] == 0;
}

}  // namespace

void read_slope_window(const CompactTree& tree, const Body& body, SlopeWindow* window, uint32_t* visits) {
  *visits += read_window(tree, body, window);
}

int slope_axis(const Vec3i& normal, const Face& face) {
  if (is_along(normal, face.axis)) {
    return -1;
  }
  int along = face.axis;
  for (int axis = 0; axis < 3; ++axis) {
    along = magnitude_32(normal[axis]) > magnitude_32(normal[along]) ? axis : along;
  }
  return along;
}

Vec3i unit_of_slope(const Vec3i& normal, const Face& face) {
  Vec3i left = normal;
  if (face.negative ? left[face.axis] > 0 : left[face.axis] < 0) {
    left[face.axis] = 0;
  }
  if (is_along(left, face.axis)) {
    left = {};
    left[face.axis] = face.negative ? -kUnitQ14 : kUnitQ14;
    return left;
  }
  // `unit_q14` takes 20 bits.
  const int excess =
      bits::bit_length(magnitude_32(left.x) | magnitude_32(left.y) | magnitude_32(left.z)) - 20;
  for (int axis = 0; axis < 3 && excess > 0; ++axis) {
    const auto shifted = static_cast<int32_t>(magnitude_32(left[axis]) >> excess);
    left[axis] = left[axis] < 0 ? -shifted : shifted;
  }
  return unit_q14(left);
}

}  // namespace thimble::lit
