/// @file chip_cost.h
/// What a frame would cost on the flagship board, from what was counted here: an estimate, and how good it
/// is.
///
/// The figures are a least-squares fit (of relative errors) to instructions counted on an emulated
/// lm3s6965evb (Cortex-M3, QEMU with -icount, gcc 12 -O2 as platform/firmware.cmake sets it): pictures of 128
/// x 64 pixels of the demonstration (`thimble bake demo`, 72,295 voxels) from 36 cameras, at three distances
/// and three fields of view, in bands of 8 rows of 16 greys, depth and normal shading; 72 pictures without a
/// cut-off, 216 with one of 2, 4 and 8 pixels. The fit is off by 5 per cent on average and by 19 at most.
/// Rays there take the 32-bit path; those of larger worlds or finer pictures do not, and cost about 1.3 times
/// as much (`bench` on that board: 6,040 a ray in 64 bits, 4,587 in 32). Runs of pixels that miss all that is
/// solid are cheap and in the average.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_CHIP_COST_H
#define THIMBLE_TOOLS_INSTRUMENTS_CHIP_COST_H

#include <cstdint>

#include "thimble/picture/render.h"

namespace thimble::tools {

/// Instructions on a Cortex-M3.
struct ChipCost {
  double a_ray;
  double a_hit;  ///< shading and storing it included
  double a_visit;
};
inline constexpr ChipCost kChipCost{147, 1749, 222};
inline constexpr ChipCost kChipCostCut{152, 1486, 273};
/// Of `average_samples`: a pixel, and each of its samples.
inline constexpr double kChipCostPixel = 70;
inline constexpr double kChipCostSample = 10;
/// The fit's largest relative error on the frames that it was made from.
inline constexpr double kChipCostError = 0.19;

/// Instructions of a frame with those counts, of `samples` a pixel.
inline double chip_instructions(const RenderCounts& counts, bool cuts, int samples) {
  const ChipCost& cost = cuts ? kChipCostCut : kChipCost;
  const auto rays = static_cast<double>(counts.rays);
  const double averaging = samples == 1 ? 0 : rays * kChipCostSample + rays / samples * kChipCostPixel;
  return rays * cost.a_ray + static_cast<double>(counts.hits) * cost.a_hit +
         static_cast<double>(counts.node_visits) * cost.a_visit + averaging;
}

}  // namespace thimble::tools

#endif
