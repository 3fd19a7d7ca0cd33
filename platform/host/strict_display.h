/// A display that is stricter than any hardware: what a board would show somehow is an error here.
///
/// Every row of a frame comes once, in any order of bands, in the display's format, without gaps, and no
/// frame is left half sent. A row that stays as it was is said to (a band without bytes), which the first
/// frame cannot.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"

namespace thimble::host {

/// What a display holds: rows (or pages) from the top, without gaps, row_bytes(format, width_px) each.
struct PackedPicture {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  PixelFormat format = PixelFormat::kRgb888;
  std::vector<std::uint8_t> bytes;
};

class StrictDisplay {
 public:
  StrictDisplay(std::int32_t width_px, std::int32_t height_px, PixelFormat format);

  /// Takes a band. What is wrong with it, if anything; the display is as it was then.
  std::optional<std::string> flush(const Band& band);
  /// The application is done with the frame, or with all: what is wrong if some rows came and some did not.
  std::optional<std::string> end_frame();

  /// Whole pictures so far, and the last of them (all 0 before the first).
  std::uint32_t pictures() const { return pictures_; }
  const PackedPicture& picture() const { return shown_; }
  /// Rows that were sent so far, and rows that were kept.
  std::uint64_t rows_sent() const { return rows_sent_; }
  std::uint64_t rows_kept() const { return rows_kept_; }

 private:
  PackedPicture shown_;
  PackedPicture coming_;
  std::vector<std::uint8_t> has_row_;
  std::int32_t rows_ = 0;
  std::uint64_t rows_sent_ = 0;
  std::uint64_t rows_kept_ = 0;
  std::uint32_t pictures_ = 0;
};

}  // namespace thimble::host
