#include "host/terminal_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace thimble::host {
namespace {

constexpr std::array<int, 6> kCube{0, 95, 135, 175, 215, 255};
constexpr int kFirstGray = 232;
constexpr int kGrays = 24;

int nearest_level(int value) {
  const auto is_nearer = [value](int one, int other) {
    return std::abs(one - value) < std::abs(other - value);
  };
  return static_cast<int>(std::min_element(kCube.begin(), kCube.end(), is_nearer) - kCube.begin());
}

int distance(Rgb8 color, int r, int g, int b) {
  return (color.r - r) * (color.r - r) + (color.g - g) * (color.g - g) + (color.b - b) * (color.b - b);
}

// A channel's value stands for about its square in light (canvas.cpp).
Rgb8 mean_of(Rgb8 one, Rgb8 other) {
  const auto mean = [](int a, int b) {
    return static_cast<std::uint8_t>(std::lround(std::sqrt((a * a + b * b) / 2.0)));
  };
  return {mean(one.r, other.r), mean(one.g, other.g), mean(one.b, other.b)};
}

}  // namespace

std::uint8_t nearest_of_256(Rgb8 color) {
  const int r = nearest_level(color.r);
  const int g = nearest_level(color.g);
  const int b = nearest_level(color.b);
  const auto level = [](int index) { return kCube[static_cast<std::size_t>(index)]; };
  const int step = std::clamp(((color.r + color.g + color.b) / 3 - 8 + 5) / 10, 0, kGrays - 1);
  const int gray = 8 + 10 * step;
  const bool use_gray = distance(color, gray, gray, gray) < distance(color, level(r), level(g), level(b));
  return static_cast<std::uint8_t>(use_gray ? kFirstGray + step : 16 + 36 * r + 6 * g + b);
}

void TerminalCells::reset(std::int32_t columns, std::int32_t rows) {
  columns_ = columns;
  rows_ = rows;
  const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  shown_.assign(count, Cell{kUnknown, 0, 0});
  wanted_.assign(count, Cell{' ', 0, 0});
}

TerminalCells::Cell* TerminalCells::cell(std::int32_t column, std::int32_t row) {
  return wanted_.data() + static_cast<std::ptrdiff_t>(row) * columns_ + column;
}

std::uint32_t TerminalCells::code(Rgb8 color) const {
  if (!has_true_color_) {
    return nearest_of_256(color);
  }
  return static_cast<std::uint32_t>(color.r) << 16 | static_cast<std::uint32_t>(color.g) << 8 | color.b;
}

void TerminalCells::put_canvas(Canvas* canvas) {
  const std::int32_t rows = std::min(rows_, canvas->height_px / 2);
  const std::int32_t columns = std::min(columns_, canvas->width_px);
  for (std::int32_t row = 0; row < rows; ++row) {
    const Rgb8* upper = canvas->row(2 * row);
    const Rgb8* lower = canvas->row(2 * row + 1);
    Cell* to = cell(0, row);
    for (std::int32_t column = 0; column < columns; ++column) {
      if (!has_halves_) {
        const std::uint32_t whole = code(mean_of(upper[column], lower[column]));
        to[column] = Cell{' ', whole, whole};
        continue;
      }
      const std::uint32_t top = code(upper[column]);
      const std::uint32_t bottom = code(lower[column]);
      to[column] = top == bottom ? Cell{' ', top, top} : Cell{kHalf, top, bottom};
    }
  }
}

void TerminalCells::put_text(std::int32_t column, std::int32_t row, Rgb8 color, Rgb8 ground,
                             std::string_view text) {
  if (row < 0 || row >= rows_) {
    return;
  }
  for (const char character : text) {
    if (column >= 0 && column < columns_) {
      const char glyph = character >= 0x20 && character < 0x7F ? character : '?';
      const std::uint32_t back = code(ground);
      *cell(column, row) = glyph == ' ' ? Cell{' ', back, back} : Cell{glyph, code(color), back};
    }
    ++column;
  }
}

void TerminalCells::append_color(std::string* text, int what, std::uint32_t code) const {
  *text += std::to_string(what);
  if (!has_true_color_) {
    *text += ";5;" + std::to_string(code);
    return;
  }
  *text += ";2;" + std::to_string(code >> 16) + ';' + std::to_string(code >> 8 & 0xFF) + ';' +
           std::to_string(code & 0xFF);
}

std::string TerminalCells::changes() {
  constexpr int kForeground = 38;
  constexpr int kBackground = 48;
  std::string text;
  std::optional<std::uint32_t> color;
  std::optional<std::uint32_t> ground;
  std::size_t cursor = SIZE_MAX;  // the cell that would be written next
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const Cell& cell = wanted_[i];
    if (cell == shown_[i]) {
      continue;
    }
    const std::size_t column = i % static_cast<std::size_t>(columns_);
    if (i != cursor || column == 0) {
      text += "\x1b[" + std::to_string(i / static_cast<std::size_t>(columns_) + 1) + ';' +
              std::to_string(column + 1) + 'H';
    }
    const bool new_color = cell.glyph != ' ' && color != cell.color;  // a blank has no foreground
    const bool new_ground = ground != cell.ground;
    if (new_color || new_ground) {
      text += "\x1b[";
      if (new_color) {
        append_color(&text, kForeground, cell.color);
        color = cell.color;
      }
      if (new_ground) {
        text += new_color ? ";" : "";
        append_color(&text, kBackground, cell.ground);
        ground = cell.ground;
      }
      text += 'm';
    }
    if (cell.glyph == kHalf) {
      text += "\u2580";
    } else {
      text += cell.glyph;
    }
    cursor = i + 1;
  }
  shown_ = wanted_;
  if (text.empty()) {
    return text;
  }
  return "\x1b[?2026h" + text + "\x1b[0m\x1b[?2026l";
}

}  // namespace thimble::host
