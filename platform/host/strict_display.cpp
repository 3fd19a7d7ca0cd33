#include "host/strict_display.h"

#include <algorithm>
#include <cstddef>

namespace thimble::host {
namespace {

std::string rows_text(std::int32_t first, std::int32_t rows) {
  if (rows == 1) {
    return "row " + std::to_string(first);
  }
  return "rows " + std::to_string(first) + " to " +
         std::to_string(static_cast<std::int64_t>(first) + rows - 1);
}

}  // namespace

StrictDisplay::StrictDisplay(std::int32_t width_px, std::int32_t height_px, PixelFormat format)
    : shown_{width_px, height_px, format, std::vector<std::uint8_t>(band_bytes(format, width_px, height_px))},
      coming_(shown_),
      has_row_(static_cast<std::size_t>(height_px)) {}

std::optional<std::string> StrictDisplay::flush(const Band& band) {
  const std::int32_t height = shown_.height_px;
  if (band.format != shown_.format) {
    return "a band in another pixel format than the display's was flushed";
  }
  if (band.stride_bytes != 0) {
    return "a band with a stride of " + std::to_string(band.stride_bytes) +
           " bytes was flushed; bands have no gaps (stride 0)";
  }
  if (band.rows <= 0) {
    return "a band of " + std::to_string(band.rows) + " rows was flushed";
  }
  if (band.first_row < 0 || band.rows > height || band.first_row > height - band.rows) {
    return rows_text(band.first_row, band.rows) + " reached beyond the display's " + std::to_string(height) +
           " rows";
  }
  if (has_pages(shown_.format) &&
      (band.first_row % 8 != 0 || (band.rows % 8 != 0 && band.first_row + band.rows != height))) {
    return rows_text(band.first_row, band.rows) + " were flushed, which are no whole pages of 8 rows";
  }
  const std::size_t stride = row_bytes(shown_.format, shown_.width_px);
  const std::size_t bytes = band_bytes(shown_.format, shown_.width_px, band.rows);
  const bool is_kept = band.pixels.empty();
  if (is_kept && pictures_ == 0) {
    return rows_text(band.first_row, band.rows) + " were kept before there was a whole picture";
  }
  if (!is_kept && band.pixels.size < bytes) {
    return "a band of " + std::to_string(band.pixels.size) + " bytes was flushed; " +
           rows_text(band.first_row, band.rows) + " take " + std::to_string(bytes);
  }
  const auto first = has_row_.begin() + band.first_row;
  if (const auto twice = std::find(first, first + band.rows, 1); twice != first + band.rows) {
    return "row " + std::to_string(twice - has_row_.begin()) + " was flushed twice in one frame";
  }
  std::fill(first, first + band.rows, std::uint8_t{1});
  const std::size_t place = stride * row_place(shown_.format, band.first_row);
  std::copy_n(is_kept ? shown_.bytes.data() + place : band.pixels.data, bytes, coming_.bytes.data() + place);
  (is_kept ? rows_kept_ : rows_sent_) += static_cast<std::uint64_t>(band.rows);
  rows_ += band.rows;
  if (rows_ == height) {
    shown_.bytes.swap(coming_.bytes);
    std::fill(has_row_.begin(), has_row_.end(), std::uint8_t{0});
    rows_ = 0;
    ++pictures_;
  }
  return std::nullopt;
}

std::optional<std::string> StrictDisplay::end_frame() {
  if (rows_ == 0) {
    return std::nullopt;
  }
  const auto missing = std::find(has_row_.begin(), has_row_.end(), 0);
  return "a frame ended with " + std::to_string(rows_) + " of " + std::to_string(shown_.height_px) +
         " rows flushed; row " + std::to_string(missing - has_row_.begin()) + " is the first that is missing";
}

}  // namespace thimble::host
