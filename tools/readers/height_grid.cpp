// Landscapes of heights, and `.asc` files (ESRI ASCII grid), which hold such.
//
// The grid becomes 512 voxels along its longer side, or as many as it has points where these are
// more, up to 2048; heights between points lie on the surface through the four around them. What the units
// are, no file says reliably, so the range of heights is drawn as a sixth of the longer side, whatever it
// is. The first row is the farthest (the greatest y, north); colours go with height, from green over brown
// to white. Where there is no height (NaN, the file's NODATA_value) there is a hole. The landscape is a
// shell: its surface, and walls down to the lowest height around it.
//
// Of an `.asc`: the lines `ncols`, `nrows`, and in any order `xllcorner` or `xllcenter`, the same of y,
// `cellsize` (or `dx` and `dy`), `NODATA_value`; then as many numbers as these say, laid out in any way.
//
// Source of the format: Esri, "ASCII raster format".
#include "readers/formats.h"

#include <limits>

namespace thimble::tools {
namespace {

constexpr std::int32_t kLeastSide = 512;
constexpr std::int32_t kMostSide = 2048;
constexpr std::int32_t kHeightShare = 6;  ///< the longer side in heights

struct Stop {
  double share;
  std::array<double, 3> color;
};
constexpr std::array<Stop, 6> kTints{{{0, {64, 104, 58}},
                                      {0.25, {122, 146, 78}},
                                      {0.5, {186, 166, 104}},
                                      {0.7, {140, 106, 76}},
                                      {0.88, {136, 130, 126}},
                                      {1, {244, 246, 248}}}};

Rgb tint(double share) {
  std::size_t i = 1;
  while (i + 1 < kTints.size() && share > kTints[i].share) {
    ++i;
  }
  const Stop& low = kTints[i - 1];
  const Stop& high = kTints[i];
  const double part = std::clamp((share - low.share) / (high.share - low.share), 0.0, 1.0);
  const auto mix = [&](std::size_t channel) {
    return static_cast<std::uint8_t>(
        std::lround(low.color[channel] + part * (high.color[channel] - low.color[channel])));
  };
  return {mix(0), mix(1), mix(2)};
}

class Landscape final : public VoxelGrid {
 public:
  Landscape(std::uint64_t columns, std::uint64_t rows, const HeightAt& height) {
    const std::uint64_t longer = std::max(columns, rows);
    const auto side = static_cast<std::int32_t>(std::clamp<std::uint64_t>(longer, kLeastSide, kMostSide));
    const auto scaled = [&](std::uint64_t count) {
      return std::max<std::int32_t>(
          1, static_cast<std::int32_t>(std::lround(static_cast<double>(side) * static_cast<double>(count) /
                                                   static_cast<double>(longer))));
    };
    size_ = {scaled(columns), scaled(rows), side / kHeightShare + 1};
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for_each_sample(columns, rows, height, [&](std::size_t, double value) {
      low = std::min(low, value);
      high = std::max(high, value);
    });
    fail_if(low > high, "no point of the grid has a height");
    tops_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]), kHole);
    const double range = high > low ? high / 2 - low / 2 : 1;  // halves: the range may be infinite
    for_each_sample(columns, rows, height, [&](std::size_t at, double value) {
      const double share = (value / 2 - low / 2) / range;
      tops_[at] = static_cast<std::int16_t>(std::lround(share * (size_[2] - 1)));
    });
  }

  void for_each(const Visit& visit) const override {
    for (std::int32_t y = 0; y < size_[1]; ++y) {
      for (std::int32_t x = 0; x < size_[0]; ++x) {
        const std::int32_t top = top_at(x, y);
        if (top == kHole) {
          continue;
        }
        const std::int32_t around =
            std::min({top_at(x - 1, y), top_at(x + 1, y), top_at(x, y - 1), top_at(x, y + 1)});
        for (std::int32_t z = std::min(top, around + 1); z <= top; ++z) {
          visit(x, y, z, tint(static_cast<double>(z) / (size_[2] - 1)));
        }
      }
    }
  }
  bool is_landscape() const override { return true; }

 private:
  static constexpr std::int16_t kHole = -1;

  std::int32_t top_at(std::int32_t x, std::int32_t y) const {
    if (x < 0 || y < 0 || x >= size_[0] || y >= size_[1]) {
      return kHole;  // outside, walls go down to the ground
    }
    return tops_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_[0]) +
                 static_cast<std::size_t>(x)];
  }

  /// The height in the middle of each column of voxels that has one.
  template <class Take>
  void for_each_sample(std::uint64_t columns, std::uint64_t rows, const HeightAt& height,
                       const Take& take) const {
    std::size_t at = 0;
    for (std::int32_t y = 0; y < size_[1]; ++y) {
      // Row 0 is the farthest.
      const double row = place(size_[1] - 1 - y, size_[1], rows);
      for (std::int32_t x = 0; x < size_[0]; ++x, ++at) {
        const double column = place(x, size_[0], columns);
        const auto left = static_cast<std::uint64_t>(column);
        const auto back = static_cast<std::uint64_t>(row);
        const std::uint64_t right = std::min(left + 1, columns - 1);
        const std::uint64_t front = std::min(back + 1, rows - 1);
        const double u = column - static_cast<double>(left);
        const double v = row - static_cast<double>(back);
        const double value = (1 - v) * ((1 - u) * height(left, back) + u * height(right, back)) +
                             v * ((1 - u) * height(left, front) + u * height(right, front));
        if (std::isfinite(value)) {
          take(at, value);
        }
      }
    }
  }
  /// Where among `points` the voxel `i` of `count` lies: the ends of both meet.
  static double place(std::int32_t i, std::int32_t count, std::uint64_t points) {
    return count < 2 ? 0 : static_cast<double>(i) * static_cast<double>(points - 1) / (count - 1);
  }

  std::vector<std::int16_t> tops_;
};

}  // namespace

Source height_landscape(std::uint64_t columns, std::uint64_t rows, const HeightAt& height) {
  fail_if(columns < 2 || rows < 2, "a grid of ", columns, " x ", rows,
          " heights is no landscape; 2 x 2 is the least");
  return std::make_unique<Landscape>(columns, rows, height);
}

bool looks_like_height_grid(std::string_view text) {
  return equals_ignoring_case(WordReader(text).next(), "ncols");
}

/// Memory: 4 bytes a height.
/// @throws InputError  naming the line: a number that is none, too few or too many of them
Source read_height_grid(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  fail_if(!looks_like_height_grid(file.text()),
          "is no grid of heights: it does not begin with the word ncols");
  ProgressMeter meter(progress, file.bytes.size());
  WordReader words(file.text());
  std::array<std::int64_t, 2> counts{};
  double nothing = std::numeric_limits<double>::quiet_NaN();
  std::string_view word = words.next();
  for (double value = 0; parse_number(word, value) == NumberKind::kGarbage && !word.empty();
       word = words.next()) {
    const std::string_view number = words.next();
    for (std::size_t i = 0; i < 2; ++i) {
      const bool is_count = equals_ignoring_case(word, i == 0 ? "ncols" : "nrows");
      fail_at_line_if(is_count && (!parse_integer(number, counts[i]) || counts[i] < 2), words.line(),
                      quoted(word), " is ", quoted(number), ", not a whole number from 2 on");
    }
    if (equals_ignoring_case(word, "nodata_value")) {
      fail_at_line_if(parse_number(number, nothing) == NumberKind::kGarbage, words.line(), "NODATA_value is ",
                      quoted(number), ", which is not a number");
    }
  }
  const auto columns = static_cast<std::uint64_t>(counts[0]);
  const auto rows = static_cast<std::uint64_t>(counts[1]);
  // A digit and what separates it from the next; the last may stand at the very end.
  const std::uint64_t room = (std::uint64_t{words.remaining()} + word.size() + 1) / 2;
  fail_if(columns == 0 || rows == 0 || columns > room / rows, "the header announces ", rows, " rows of ",
          columns, " heights, but the file has room for ", room, " at most");
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(columns * rows));
  for (; !word.empty(); word = words.next()) {
    const double value = number_or_nan(word, words.line());
    if (heights.size() == columns * rows) {
      fail_at_line(words.line(), quoted(word), " comes after the last of ", columns * rows, " heights");
    }
    heights.push_back(value == nothing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value));
    meter.at(words.offset());
  }
  fail_if(heights.size() != columns * rows, "the header announces ", columns * rows,
          " heights, but the file holds ", heights.size());
  return height_landscape(columns, rows, [&](std::uint64_t column, std::uint64_t row) {
    return static_cast<double>(heights[static_cast<std::size_t>(row * columns + column)]);
  });
}

}  // namespace thimble::tools
