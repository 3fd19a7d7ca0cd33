// Rays and hits as values: limits, comparison, text.
#include <stdexcept>

#include "reference/reference.h"

namespace thimble::reference {

namespace {

__extension__ typedef __int128 Int128;

template <class Integer>
std::string triple(const std::array<Integer, 3>& values) {
  return "(" + std::to_string(values[0]) + ", " + std::to_string(values[1]) + ", " +
         std::to_string(values[2]) + ")";
}

}  // namespace

double Hit::t() const {
  return static_cast<double>(t_numerator) / static_cast<double>(t_denominator);
}

bool same_t(const Hit& a, const Hit& b) {
  return static_cast<Int128>(a.t_numerator) * b.t_denominator ==
         static_cast<Int128>(b.t_numerator) * a.t_denominator;
}

bool same_answer(const Hit& a, const Hit& b) {
  if (!a.hit || !b.hit) {
    return a.hit == b.hit;
  }
  return a.voxel == b.voxel && a.axis == b.axis && same_t(a, b);
}

std::string describe(const Ray& ray) {
  return "origin_q8 " + triple(ray.origin_q8) + " direction " + triple(ray.direction);
}

std::string describe(const Hit& hit) {
  if (!hit.hit) {
    return "miss";
  }
  return "voxel " + triple(hit.voxel) + " t " + std::to_string(hit.t_numerator) + "/" +
         std::to_string(hit.t_denominator) + " axis " + std::to_string(hit.axis);
}

void check_ray(const Ray& ray) {
  bool moves = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = ray.origin_q8[axis];
    const std::int64_t direction = ray.direction[axis];
    if (origin < -kMaxOriginQ8 || origin > kMaxOriginQ8) {
      throw std::invalid_argument("reference: origin out of range: " + describe(ray));
    }
    if (direction < -kMaxDirection || direction > kMaxDirection) {
      throw std::invalid_argument("reference: direction out of range: " + describe(ray));
    }
    moves = moves || direction != 0;
  }
  if (!moves) {
    throw std::invalid_argument("reference: zero direction: " + describe(ray));
  }
}

}  // namespace thimble::reference
