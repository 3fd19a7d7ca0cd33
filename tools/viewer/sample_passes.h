/// @file sample_passes.h
/// A picture from coarse to fine of which no sample is drawn twice: the samples of a coarse pass are among those of the
/// finer ones.
#ifndef THIMBLE_TOOLS_VIEWER_SAMPLE_PASSES_H
#define THIMBLE_TOOLS_VIEWER_SAMPLE_PASSES_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/look_picture.h"

namespace thimble::tools::viewer {

/// The first samples of a picture's pixels, as far as passes have drawn them.
struct KeptSamples {
  int step = 0;                                    ///< every how-many-th pixel has it, each way; 0: none
  std::vector<std::array<std::uint8_t, 4>> drawn;  ///< a place for each pixel
};

/// One pass: every `step`-th pixel with its first sample, or with step 0 all samples of all pixels.
class SamplePass {
 public:
  /// `fine` has `across` x `across` pixels for each of the picture's. What is in `kept` is of the same picture; a
  /// pass with a step leaves its own samples there.
  SamplePass(const LookRows& look, const Camera& fine, int across, int step, KeptSamples* kept);

  /// Some rows of the pass's picture into `image`, which holds all of it.
  Status draw(std::int32_t first, std::int32_t rows, Image* image);
  /// After the last row.
  void end();

 private:
  template <class Visit>
  void each_pixel(std::int32_t first, std::int32_t rows, std::int32_t columns, const Visit& visit) const;

  const LookRows& look_;
  const Camera& fine_;
  int across_;
  int step_;
  std::int32_t width_px_;  // of the picture
  KeptSamples* kept_;
  // Of the rows that are drawn together:
  std::vector<SamplePlace> places_;
  std::vector<std::uint8_t> colors_;
  std::vector<std::uint8_t> samples_;
};

}  // namespace thimble::tools::viewer

#endif
