/// A terminal's cells as they are and as they should be, and the bytes that lead from one to the other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/canvas.h"
#include "thimble/picture/pixel.h"

namespace thimble::host {

/// The nearest of xterm's 256 colours: the 6 x 6 x 6 cube (16 ..) or the 24 greys (232 ..).
std::uint8_t nearest_of_256(Rgb8 color);

class TerminalCells {
 public:
  /// `has_halves`: whether it shows U+2580 in UTF-8. Without it a cell has the mean light of its two pixels, and all that is
  /// sent is ASCII.
  TerminalCells(bool has_true_color, bool has_halves)
      : has_true_color_(has_true_color), has_halves_(has_halves) {}

  /// Another size, or a terminal that was cleared: nothing on it is known.
  void reset(std::int32_t columns, std::int32_t rows);
  std::int32_t columns() const { return columns_; }
  std::int32_t rows() const { return rows_; }

  /// Two of the canvas's pixels a cell, from the top left on.
  void put_canvas(Canvas* canvas);
  /// One line of text, cut off at the edge. Bytes that are not printable ASCII become `?`.
  void put_text(std::int32_t column, std::int32_t row, Rgb8 color, Rgb8 ground, std::string_view text);
  /// What to send so that the terminal shows what was put; empty when it does.
  std::string changes();

 private:
  struct Cell {
    char glyph = 0;  ///< a character, or kHalf
    std::uint32_t color = 0;
    std::uint32_t ground = 0;
    friend bool operator==(const Cell&, const Cell&) = default;
  };
  static constexpr char kHalf = 1;
  static constexpr char kUnknown = 0;

  std::uint32_t code(Rgb8 color) const;
  void append_color(std::string* text, int what, std::uint32_t code) const;
  Cell* cell(std::int32_t column, std::int32_t row);

  bool has_true_color_;
  bool has_halves_;
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  std::vector<Cell> shown_;
  std::vector<Cell> wanted_;
};

}  // namespace thimble::host
