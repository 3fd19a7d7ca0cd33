// Proves at once that a distant light reaches all of a face or none of it; where neither holds, lists the voxels that
// shadow its points. Internal to src/.
//
// In each slab of voxels along the light's fastest axis c all rays from the face lie in a window: between two planes
// of a and two of b. If the windows of all slabs are empty, the face is lit all over. If the window of a slab that
// all rays cross from plane to plane is all solid, the face is dark all over. Else a point is dark where its ray
// meets one of the solid voxels in the windows; three products tell for each voxel.
#pragma once

#include "../../base/bits.h"
#include "beam.h"
#include "exposed.h"
#include "shadow.h"
#include "sweep.h"

namespace thimble::bricks {
namespace {

enum class FaceLight : uint8_t { kMixed, kLit, kDark };

// The voxels that may hide a light from points of a face, by a, b and c, mirrored. Where there are more than kMost, or
// a component of the light's direction is 0, each point traces its own ray.
template <bool kDeep>
struct Blockers {
  static constexpr uint32_t kMost = kSlots == 0 ? 1 : 12;  // none are looked for where tiles are not swept
  using Cell = Choose<kDeep, uint16_t, uint8_t>;
  uint32_t count;
  uint32_t corner[3];  // of the face, from which its points lie, in 1/256 voxel
  Cell cell[kMost][3];
};

// The rays of a face, mirrored so that they go up on all axes. In a slab they pass the voxels of a window on a and b.
// The rays of a face across c start on a plane of c; those of other faces start within a slab, the last of them at
// its far plane.
template <bool kDeep>
class FaceBeam {
 public:
  FaceBeam(const ShadowCourse<kDeep>& course, const FacePoint& face, Blockers<kDeep>* blockers)
      : course_(course), blockers_(blockers) {
    blockers->count = course.d[0] != 0 && course.d[1] != 0 && course.d[2] != 0 ? 0 : kMost + 1;
    for (int k = 0; k < 3; ++k) {
      const int axis = course.axes[k];
      const int32_t own = face.voxel[axis];
      const int32_t cell = course.goes_down(axis) ? course.cells[axis] - 1 - own : own;
      const int32_t on = axis == face.axis ? 1 : 0;
      blockers->corner[k] = static_cast<uint32_t>(cell + (on != 0 || course.goes_down(axis) ? 1 : 0)) << 8;
      if (k == 2) {
        slab_ = cell + on;
        begins_ = on == 0;
      } else {
        low_[k] = (cell + on) * kOne;
        high_[k] = (cell + 1) * kOne + course.high_slope[axis];
        low_slope_[k] = course.low_slope[axis];
        high_slope_[k] = course.high_slope[axis];
      }
      last_[k] = course.cells[axis] - 1;
      stride_[k] = course.next_brick[axis];
    }
    if constexpr (kDeep) {
      const int32_t low[3] = {low_[0] >> 8, low_[1] >> 8, 256 * slab_};
      const int32_t high[3] = {(high_[0] - course.high_slope[course.axes[0]]) >> 8,
                               (high_[1] - course.high_slope[course.axes[1]]) >> 8,
                               256 * (slab_ + (begins_ ? 1 : 0))};
      last_[2] = course.end_of(low, high) - 1;
    }
  }

  FaceLight find() {
    while (slab_ <= last_[2]) {
      // The bricks of this layer that the rays pass.
      const int32_t more = 3 - (slab_ & 3);
      int32_t to[2];
      for (int k = 0; k < 2; ++k) {
        from_[k] = low_[k] >> 18;
        const int32_t end = last_[k] >> 2;
        if (from_[k] > end) {
          return result();
        }
        to[k] = (high_[k] + more * high_slope_[k]) >> 18;
        to[k] = to[k] > end ? end : to[k];
      }
      uint32_t any = 0;
      bool clear = true;
      int32_t row =
          course_.near_place + (slab_ >> 2) * stride_[2] + from_[1] * stride_[1] + from_[0] * stride_[0];
      const int32_t first = row;
      for (int32_t b = from_[1]; b <= to[1]; ++b, row += stride_[1]) {
        int32_t place = row;
        for (int32_t a = from_[0]; a <= to[0]; ++a, place += stride_[0]) {
          any |= number_at<kDeep>(course_.directory, place);
          clear = clear && course_.is_free(place);
        }
      }
      if (any != 0) {
        if (look(first, to)) {
          return FaceLight::kDark;
        }
      } else if (!clear) {
        const int32_t low_more = more + (begins_ ? 0 : 1);
        begins_ = false;
        for (int k = 0; k < 2; ++k) {
          low_[k] += low_more * low_slope_[k];
          high_[k] += (more + 1) * high_slope_[k];
        }
        slab_ += more + 1;
      }
      if (clear) {
        break;
      }
    }
    return result();
  }

 private:
  static constexpr int32_t kOne = 1 << 16;
  static constexpr uint32_t kMost = Blockers<kDeep>::kMost;
  using Cell = typename Blockers<kDeep>::Cell;

  FaceLight result() const { return some_ ? FaceLight::kMixed : FaceLight::kLit; }

  // Looks at the slabs of a layer whose bricks are not all empty; the first brick is at `row` in the directory.
  // Returns whether all rays end in this layer.
  bool look(int32_t row, const int32_t (&to)[2]) {
    // The windows, counted from the first brick: bits of a, and rows of b.
    uint32_t across[4];
    uint32_t down[4];
    // Voxels of each window that are not known to be solid; some more where rays may pass beside it.
    uint32_t open[4];
    const int32_t first = slab_ & 3;
    const int32_t base[2] = {from_[0] * (4 * kOne), from_[1] * (4 * kOne)};
    const int32_t last_a = last_[0] - 4 * from_[0];
    const int32_t last_b = last_[1] - 4 * from_[1];
    int32_t low_a = low_[0] - base[0];
    int32_t low_b = low_[1] - base[1];
    int32_t high_a = high_[0] - base[0];
    int32_t high_b = high_[1] - base[1];
    for (int32_t i = first; i < 4; ++i) {
      const int32_t end_a = high_a >> 16;
      const int32_t end_b = high_b >> 16;
      const int32_t from_a = low_a >> 16;
      const int32_t from_b = low_b >> 16;
      across[i] = (2U << end_a) - (1U << from_a);
      down[i] = (2U << end_b) - (1U << from_b);
      open[i] = begins_ || end_a > last_a || end_b > last_b
                    ? 1U << 16
                    : static_cast<uint32_t>((end_a - from_a + 1) * (end_b - from_b + 1));
      high_a += high_slope_[0];
      high_b += high_slope_[1];
      if (!begins_) {  // rays that begin within the slab do not cross all of it
        low_a += low_slope_[0];
        low_b += low_slope_[1];
      }
      begins_ = false;
    }
    low_[0] = low_a + base[0];
    low_[1] = low_b + base[1];
    high_[0] = high_a + base[0];
    high_[1] = high_b + base[1];
    const int32_t layer = slab_ & ~3;
    slab_ = layer + 4;
    for (int32_t b = from_[1]; b <= to[1]; ++b, row += stride_[1]) {
      int32_t place = row;
      for (int32_t a = from_[0]; a <= to[0]; ++a, place += stride_[0]) {
        const auto number = static_cast<int32_t>(number_at<kDeep>(course_.directory, place));
        if (number == 0) {
          continue;
        }
        alignas(4) Half slabs[4];
        put_slabs(turned({word_at(course_.bricks, 8 * number), word_at(course_.bricks, 8 * number + 4)},
                         course_.mirrored, course_.c),
                  slabs);
        for (int32_t i = first; i < 4; ++i) {
          if (slabs[i] == 0) {
            continue;
          }
          const uint32_t window = (across[i] >> 4 * (a - from_[0]) & 15U) *  // NOLINT: set from `first` on
                                  kRows[down[i] >> 4 * (b - from_[1]) & 15U];
          const uint32_t solid = slabs[i] & window;
          if (solid != 0) {
            some_ = true;
            open[i] -= bits::popcount32(solid);  // NOLINT
            if (open[i] == 0) {
              return true;
            }
            note(solid, 4 * a, 4 * b, layer + i);
          }
        }
      }
    }
    return false;
  }

  void note(uint32_t solid, int32_t a, int32_t b, int32_t c) {
    for (; solid != 0 && blockers_->count <= kMost; solid &= solid - 1) {
      if (blockers_->count < kMost) {
        const auto bit = static_cast<int32_t>(bits::lowest_bit(solid));
        Cell* const cell = blockers_->cell[blockers_->count];
        cell[0] = static_cast<Cell>(a + (bit & 3));
        cell[1] = static_cast<Cell>(b + (bit >> 2));
        cell[2] = static_cast<Cell>(c);
      }
      ++blockers_->count;
    }
  }

  const ShadowCourse<kDeep>& course_;
  Blockers<kDeep>* blockers_;
  bool some_ = false;
  bool begins_ = false;  // rays start within this slab
  int32_t slab_ = 0;
  // The window there, in 1/2^16 voxel.
  int32_t low_[2];
  int32_t high_[2];
  int32_t low_slope_[2];
  int32_t high_slope_[2];
  int32_t last_[3];
  int32_t stride_[3];
  int32_t from_[2];  // bricks
};

// `face` is given by one of its points; the light is in front of it. `blockers` counts only where the answer is kMixed.
template <bool kDeep>
[[gnu::noinline]] FaceLight light_of_face(const ShadowCourse<kDeep>& course, const FacePoint& face,
                                          Blockers<kDeep>* blockers) {
  return FaceBeam<kDeep>(course, face, blockers).find();
}

// Whether one of the blockers hides the light from a point. A ray spends a length in a voxel if it enters it on each
// axis i before it leaves it on each other axis j: (low_i - p_i) / d_i < (high_j - p_j) / d_j.
template <bool kDeep>
bool is_blocked(const ShadowCourse<kDeep>& course, const Blockers<kDeep>& blockers, const FacePoint& point) {
  uint32_t at[3];
  uint32_t d[3];
  for (int k = 0; k < 3; ++k) {
    const int axis = course.axes[k];
    const auto within = static_cast<uint32_t>(point.within[axis]);
    at[k] = blockers.corner[k] + (course.goes_down(axis) ? 0 - within : within);
    d[k] = course.d[axis];
  }
  // The windows keep `ahead` below 2^27, so the bits that its products lose above bit 31 do not matter.
  const auto overlap = [](uint32_t x_i, uint32_t d_i, uint32_t x_j, uint32_t d_j) {
    const auto ahead = static_cast<int32_t>(x_i * d_j - x_j * d_i);
    return ahead < static_cast<int32_t>(d_i << 8) && -ahead < static_cast<int32_t>(d_j << 8);
  };
  for (uint32_t i = 0; i < blockers.count; ++i) {
    const uint32_t a = (uint32_t{blockers.cell[i][0]} << 8) - at[0];
    const uint32_t b = (uint32_t{blockers.cell[i][1]} << 8) - at[1];
    const uint32_t c = (uint32_t{blockers.cell[i][2]} << 8) - at[2];
    if (overlap(a, d[0], c, d[2]) && overlap(b, d[1], c, d[2]) && overlap(a, d[0], b, d[1])) {
      return true;
    }
  }
  return false;
}

}  // namespace
}  // namespace thimble::bricks
