/// @file anytime.h
/// A frame that is refined from coarse to fine, and is a whole picture whenever it stops.
///
///     AnytimeFrame frame;  // works in `memory`: anytime_bytes(width, height, format)
///     AnytimeFrame::make(tree, camera, shading, format, memory, &frame);
///     while (!frame.done() && time_is_left()) {
///       frame.refine(tree, 2000);  // 2,000 node visits more
///     }
///     flush(frame.band(0, height));
///
/// What the picture is. After `make` it is all background. Every pixel is traced once, with the very ray of
/// `render_band`, and is exact from then on; none is traced twice, and none is left out: when `done()` the
/// picture is that of `render_band` byte for byte. Until then a pixel not yet traced shows what the samples
/// around it make likely.
///
/// The order. Samples lie on grids that get finer by 2 in two steps each: first the middles of the squares,
/// then the middles of the edges, from every 32nd pixel to every fourth. Then pixels whose neighbours differ
/// come first, down to single ones, and the rest after them. A sample colours the pixels around it in those
/// of the four directions in which at least half of the samples that are there are like it, and only while
/// what was seen so far says that neighbours are more often alike than one of them is background: strewn
/// points are not blown up to blocks that are not there.
///
/// Work is counted in node visits (Hit::visits); a ray that reads no node counts as one. Not counted:
/// clearing the picture, looking for the next pixel (at most some ten looks a pixel in a whole frame), and
/// blocks of 8 x 8 pixels all of whose rays pass by the box of what is solid: those are exact from the start.
///
/// Never more than was given. A ray is begun only when what is left suffices for any ray of that structure
/// (`reserve_visits()`: at most 3 * (2^level - 1) - 2 * level, which is 177 in a world of 64, and no more
/// than the tree has nodes). So no ray is cut short and no visit is wasted; what is left over, less than
/// that, is kept for the next call. The picture therefore depends on the sum of what was given and on nothing
/// else: refine(a) and refine(b) give the picture of refine(a + b).
///
/// Two bounds hold while it is not done, and never grow with more work:
///   - only `inexact()` pixels may differ from the exact picture;
///   - each of them differs by at most `gray_range()` greys (gray_of what a display shows, 0..255): what lies
///   between
///     the darkest and the brightest that this shading, palette, format and the faces that can be seen allow.
///     The background counts. So the mean absolute error of the picture is at most inexact * gray_range /
///     pixels greys (`mean_error_bound_q8`), the mean squared error at most inexact * gray_range^2 / pixels.
/// The true error mostly falls from each doubling of work to the next. That is no theorem (a sample can be
/// misleading), but a test for every golden scene.
///
/// Reentrant: an object writes to itself and its memory only. The tree must not change between `make` and
/// the last `refine`; one that does is drawn partly as it was.
#ifndef THIMBLE_PICTURE_ANYTIME_H
#define THIMBLE_PICTURE_ANYTIME_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../trace/ray.h"
#include "camera.h"
#include "pixel.h"
#include "render.h"
#include "shading.h"

namespace thimble {

/// Bytes that a frame works in: the picture, rows without gaps, and a bit a pixel (rows in whole bytes).
/// 128 x 64 in 16 greys: 4,096 + 1,024. SIZE_MAX when size_t cannot say it.
constexpr size_t anytime_bytes(int32_t width_px, int32_t height_px, PixelFormat format) {
  const size_t picture = band_bytes(format, width_px, height_px);
  const size_t bits = band_bytes(PixelFormat::kMono1, width_px, height_px);
  return picture > SIZE_MAX - bits ? SIZE_MAX : picture + bits;
}

class AnytimeFrame {
 public:
  /// Begins a frame: the picture is background, nothing is traced, what was left of a frame before is
  /// forgotten. `memory` (any alignment) and the palette outlive the frame's use; the camera is copied.
  /// Cost: the bytes of the picture, and two rays' set-up for each 8 x 8 pixels; for kColor six products a
  /// palette colour. No node is visited.
  /// Errors, with nothing changed: kBadArgument (camera without pixels or for another level), kOutOfMemory.
  static Status make(const CompactTree& tree, const Camera& camera, const Shading& shading,
                     PixelFormat format, Bytes memory, AnytimeFrame* frame);
  static Status make(const Octree& tree, const Camera& camera, const Shading& shading, PixelFormat format,
                     Bytes memory, AnytimeFrame* frame);
  static Status make(const DenseGrid& grid, const Camera& camera, const Shading& shading, PixelFormat format,
                     Bytes memory, AnytimeFrame* frame);

  /// Goes on with what was left over and `max_visits` more. kOk, whether that sufficed or not; also when
  /// there is nothing left to do. The structure is that of `make`.
  /// Errors, with nothing changed: kBadArgument (no frame made, a tree of another level, Width::k32 for rays
  /// that it does not take).
  /// Stack: that of a ray and 500 bytes (tests/budgets/stack.csv).
  Status refine(const CompactTree& tree, uint32_t max_visits, Width width = Width::kAuto);
  Status refine(const Octree& tree, uint32_t max_visits, Width width = Width::kAuto);
  /// In a dense grid a visit is a cell looked at.
  Status refine(const DenseGrid& grid, uint32_t max_visits, Width width = Width::kAuto);

  /// Whether every pixel is exact.
  bool done() const { return inexact_ == 0; }
  uint32_t pixels() const {
    return static_cast<uint32_t>(camera_.width_px()) * static_cast<uint32_t>(camera_.height_px());
  }
  /// Pixels that may differ from the exact picture's.
  uint32_t inexact() const { return inexact_; }
  /// How far, in greys, any pixel may be from its exact value; 0 when all that can be seen looks alike.
  int gray_range() const { return gray_range_; }
  /// The bound of the picture's mean absolute error in 1/256 grey, rounded up; 0 when done.
  uint32_t mean_error_bound_q8() const;

  /// Visits given so far, and those counted as spent: at most those given; what is left is below
  /// `reserve_visits()` unless the frame is done.
  uint64_t given_visits() const { return spent_ + left_; }
  uint64_t spent_visits() const { return spent_; }
  uint32_t reserve_visits() const { return reserve_; }
  /// Rays traced, hits, and nodes that were read. `step_limited` counts rays with more steps than a
  /// sound tree lets them: the tree is damaged. Their pixels look like misses.
  const RenderCounts& counts() const { return counts_; }

  const Camera& camera() const { return camera_; }
  PixelFormat format() const { return format_; }
  /// The picture's rows from `first_row` on, a multiple of `band_row_multiple`, for a flush; cut off at the end
  /// of the picture.
  Band band(int32_t first_row, int32_t rows) const;
  /// Whether the pixel was traced or proved to be background, 0 <= x < width, 0 <= y < height.
  bool exact(int32_t x, int32_t y) const {
    return (exact_[static_cast<size_t>(y) * bit_row_bytes_ + (static_cast<size_t>(x) >> 3)] << (x & 7) &
            0x80) != 0;
  }

 private:
  template <class Structure>
  Status make_any(const Structure& structure, uint32_t reserve, const Camera& camera, const Shading& shading,
                  PixelFormat format, Bytes memory);
  template <class Structure>
  Status refine_any(const Structure& structure, uint32_t max_visits, Width width);
  void clear();
  void find_range(uint32_t materials_low, uint32_t materials_high);
  void mark_misses(const VoxelBox& bounds);
  bool next_sample();
  void take_sample(Rgb8 color);
  bool neighbours_differ() const;

  Camera camera_;
  Shading shading_;
  uint8_t* picture_ = nullptr;
  uint8_t* exact_ = nullptr;  // a bit a pixel, the leftmost highest
  size_t row_bytes_ = 0;
  size_t bit_row_bytes_ = 0;
  RenderCounts counts_;
  uint64_t spent_ = 0;
  uint64_t left_ = 0;
  uint32_t inexact_ = 0;
  uint32_t reserve_ = 0;
  int32_t x_ = 0;  // the pixel that is looked at next
  int32_t y_ = 0;
  int32_t solid_score_ = 0;       // above 0: samples like a neighbour that is not background are the rule
  int32_t background_score_ = 0;  // the same for neighbours that are
  Rgb8 background_;
  PixelFormat format_ = PixelFormat::kGray8;
  uint8_t gray_range_ = 0;
  uint8_t pass_ = 0;
};

}  // namespace thimble

#endif
