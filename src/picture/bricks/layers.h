// Takes a ray through empty bricks a layer at a time. Internal to src/.
#pragma once

#include "layout.h"

namespace thimble::bricks {
namespace {

// Where a ray has entered a layer of bricks along its fastest axis c, in the numbers that BrickRay keeps.
struct LayerPlace {
  uint32_t rest[2];  // on a and b, to the planes of the voxel
  uint32_t left;
  int32_t cell;
  uint32_t planes;  // planes of c that the ray may still cross
  uint32_t place;   // of the voxel: two bits an axis
  uint32_t number;  // of the brick
};

// The way of a ray in a world of level 9 or 10, as skip_layers wants it.
struct DeepWay {
  [[maybe_unused]] static constexpr bool kDeep = true;
  const uint8_t* directory;
  const int32_t* next_brick;
  uint32_t d[3];
  uint32_t last[3];
};

// number_at, inlined even where code is compiled for size.
template <bool kDeep>
[[gnu::always_inline]] inline uint32_t brick_number(const uint8_t* directory, int32_t place) {
  if constexpr (kDeep) {
    return number_at<true>(directory, place);
  } else {
    return bits::little(*static_cast<const Half*>(static_cast<const void*>(directory + place)));
  }
}

// At -O2 gcc unrolls the loops, which doubles the code and saves no time but in worlds of level 9 and 10: 3 per cent of a
// lit frame.
#if defined(__GNUC__) && !defined(__clang__) && !defined(THIMBLE_DEEP_WORLDS)
#pragma GCC push_options
#pragma GCC optimize("Os")
#endif

// Takes a ray on from an empty brick, layer by layer, while all bricks are empty that it can enter before the next
// layer: its own and, where it leaves that on a or b (or both, in either order), the ones beside. Returns false when
// the ray ends or leaves the box before it reaches a brick that is not empty.
//
// Meanwhile the rests refer to the planes of bricks, not of voxels: they stay below 2^26, with what is added. The
// function is not inlined, since three kinds of rays would each have a copy.
template <class OneCourse>
[[gnu::noinline]] bool skip_layers(const OneCourse& course, int c, LayerPlace* at) {
  const int axis[2] = {c == 0 ? 1 : 0, c == 2 ? 1 : 2};
  const uint32_t den = course.d[c] << 8;
  const uint32_t go_a = course.d[axis[0]] << 10;
  const uint32_t go_b = course.d[axis[1]] << 10;
  const auto last = [&course](int i) { return course.last[i] >> kPlaceShift[i]; };
  uint32_t rest[2];
  for (int k = 0; k < 2; ++k) {
    const uint32_t ahead = (at->place >> 2 * axis[k] & 3U) ^ last(axis[k]);
    rest[k] = at->rest[k] - ahead * den;
  }
  const int32_t beside_a = course.next_brick[axis[0]];
  const int32_t beside_b = course.next_brick[axis[1]];
  const int32_t onward = course.next_brick[c];
  const uint32_t one_a = uint32_t{1} << 10 * axis[0];
  const uint32_t one_b = uint32_t{1} << 10 * axis[1];
  const uint32_t one_c = uint32_t{1} << 10 * c;
  uint32_t left = at->left;
  int32_t cell = at->cell;
  uint32_t planes = at->planes;
  uint32_t number = 0;
  const auto is_solid = [&course](uint32_t counts, int32_t place) {
    return (counts & kLeft) == 0 && brick_number<OneCourse::kDeep>(course.directory, place) != 0;
  };
  do {
    const uint32_t next_a = rest[0] + go_a;
    const uint32_t next_b = rest[1] + go_b;
    const bool leaves_a = static_cast<int32_t>(next_a) >= 0;
    const bool leaves_b = static_cast<int32_t>(next_b) >= 0;
    uint32_t next_left = left + one_c;
    int32_t next_cell = cell + onward;
    if (leaves_a) {
      if (is_solid(left + one_a, cell + beside_a)) {
        break;
      }
      next_left += one_a;
      next_cell += beside_a;
    }
    if (leaves_b) {
      if (is_solid(left + one_b, cell + beside_b) ||
          (leaves_a && is_solid(left + one_a + one_b, cell + beside_a + beside_b))) {
        break;
      }
      next_left += one_b;
      next_cell += beside_b;
    }
    if (planes < 4 || (next_left & kLeft) != 0) {
      return false;
    }
    planes -= 4;
    left = next_left;
    cell = next_cell;
    rest[0] = next_a - (leaves_a ? den << 2 : 0);
    rest[1] = next_b - (leaves_b ? den << 2 : 0);
    number = brick_number<OneCourse::kDeep>(course.directory, cell);
  } while (number == 0);
  // Back to planes of voxels: finds the voxel on the layer's first plane.
  uint32_t place = (last(c) ^ 3U) << 2 * c;
  for (int k = 0; k < 2; ++k) {
    uint32_t ahead = 0;
    while (ahead < 3 && static_cast<int32_t>(rest[k] + den) < 0) {
      rest[k] += den;
      ++ahead;
    }
    place |= (last(axis[k]) ^ ahead) << 2 * axis[k];
  }
  *at = {{rest[0], rest[1]}, left, cell, planes, place, number};
  return true;
}

#if defined(__GNUC__) && !defined(__clang__) && !defined(THIMBLE_DEEP_WORLDS)
#pragma GCC pop_options
#endif

}  // namespace
}  // namespace thimble::bricks
