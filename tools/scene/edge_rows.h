/// Pictures whose samples go where edges are (thimble/picture/render.h), row by row, by whatever draws
/// samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

// One sample of a picture.

/// A pixel of the camera that samples, and the one of the picture that it is for.
struct SamplePlace {
  std::int32_t x, y;
  std::int32_t px, py;
};

/// One sample each of the pixels (px .. px + count - 1, py) of the picture: row `row` of `camera`.
struct SampleRun {
  const Camera& camera;
  std::int32_t row;
  std::int32_t px, py, count;
  bool is_fine;  ///< whether the camera's pixels are the places of edge samples, else those of the picture
};

/// Draws single pixels of a camera, `channels` bytes each, by threads of its own.
using DrawPlaces = std::function<Status(const Camera& camera, Span<const SamplePlace> places, Bytes samples)>;

/// What draws, and where finished pixels go. Both are called by several threads at a time, `worker` telling
/// them apart; a row is one worker's.
struct EdgeRowsHooks {
  /// Fills `samples`, `channels` bytes each.
  std::function<Status(const SampleRun& run, Bytes samples, std::size_t worker)> draw;
  /// Takes a pixel: the sum of each channel over `count` samples. Left to right in a row.
  std::function<void(std::int32_t px, std::int32_t py, const std::uint32_t* sums, std::uint32_t count)>
      finish;
  /// In place of `draw`, where it is set: many samples at a time.
  DrawPlaces draw_places = nullptr;
};

class EdgeRows {
 public:
  static constexpr int kMostChannels = 4;

  /// Bytes to draw `rows` rows at a time.
  static constexpr std::size_t work_bytes(int channels, std::int32_t width_px, std::int32_t rows,
                                          int threads) {
    const auto width = static_cast<std::size_t>(width_px);
    return (static_cast<std::size_t>(rows) + 2) * static_cast<std::size_t>(channels) * width +
           static_cast<std::size_t>(threads) * width;
  }
  /// The most rows for which `bytes` suffice, each with `more` bytes beside.
  static std::int32_t rows_within(std::size_t bytes, int channels, std::int32_t width_px, int threads,
                                  std::size_t more);

  /// `fine` is the view of `camera` with kEdgeGrid times its pixels each way.
  EdgeRows(const Camera& camera, const Camera& fine, int channels, int threads, EdgeRowsHooks hooks);

  /// Draws rows of the picture in `work`, which is as large as `work_bytes` says and, for rows that follow the
  /// last ones, as the last call left it: what both need is drawn once.
  Status draw(std::int32_t first_row, std::int32_t rows, Bytes work);

 private:
  Status draw_centres(std::int32_t first, std::int32_t end, Bytes centres);
  Status draw_all_centres(std::int32_t first, std::int32_t end, Bytes centres);
  Status draw_together(std::int32_t first_row, std::int32_t rows, ConstBytes centres);
  void list_places(std::int32_t first_row, std::int32_t rows);
  void finish_row(std::int32_t y, const std::uint8_t* wanted, ConstBytes row,
                  const std::uint8_t* drawn) const;
  ConstBytes centre_row(std::int32_t y, ConstBytes centres) const;
  Status find_wanted(std::int32_t y, ConstBytes centres, Bytes samples) const;
  Status draw_segment(std::int32_t y, std::int32_t first, std::int32_t count, ConstBytes row,
                      ConstBytes samples, std::size_t worker) const;

  Camera camera_;
  Camera fine_;
  std::size_t channels_;
  int threads_;
  EdgeRowsHooks hooks_;
  std::size_t line_;
  std::int32_t kept_first_ = 0;  // rows of centres at the front of the work
  std::int32_t kept_end_ = 0;
  // For samples that are drawn together: of some rows.
  std::vector<std::uint8_t> wanted_;
  std::vector<SamplePlace> places_;
  std::vector<std::size_t> row_places_;  // where each row's begin
  std::vector<std::uint8_t> drawn_;
};

}  // namespace thimble::tools
