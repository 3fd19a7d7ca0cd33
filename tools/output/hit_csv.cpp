#include "output/hit_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace thimble::tools {
namespace {

// A line is shorter: thirteen whole numbers of up to 11 characters, two of up to 24, commas.
constexpr std::size_t kMostCharacters = 256;
constexpr int kDigits = 17;

// The squares' sum is exact: below 2^42.
double length(const Vec3i& direction) {
  std::int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += std::int64_t{direction[axis]} * direction[axis];
  }
  return std::sqrt(static_cast<double>(sum));
}

}  // namespace

void append_hit(std::string* text, const Ray& ray, const Hit& hit, bool has_material) {
  const std::size_t before = text->size();
  text->resize(before + kMostCharacters);
  char* at = text->data() + before;
  char* const end = at + kMostCharacters;
  const auto put_letters = [&](std::string_view letters) {
    at = std::copy(letters.begin(), letters.end(), at);
  };
  const auto put = [&](auto number) { at = std::to_chars(at, end, number).ptr; };
  const auto put_next = [&](auto number) {
    put_letters(",");
    put(number);
  };
  if (hit.kind == HitKind::kHit) {
    put_letters("1");
    for (int axis = 0; axis < 3; ++axis) {
      put_next(hit.voxel[axis]);
    }
    put_letters(",");
    at = std::to_chars(at, end, hit_t(hit), std::chars_format::general, kDigits).ptr;
    put_next(int{hit.axis});
  } else {
    put_letters("0,,,,,");
  }
  put_next(hit.visits);
  for (int axis = 0; axis < 3; ++axis) {
    put_next(ray.origin[axis].raw);
  }
  for (int axis = 0; axis < 3; ++axis) {
    put_next(ray.direction[axis]);
  }
  if (hit.kind == HitKind::kHit) {
    put_letters(",");
    if (has_material) {
      put(int{hit.material});
    }
    put_next(hit_t(hit) * length(ray.direction));
  } else {
    put_letters(",,");
  }
  put_letters("\n");
  text->resize(static_cast<std::size_t>(at - text->data()));
}

}  // namespace thimble::tools
