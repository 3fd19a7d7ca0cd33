/// Colours of a cloud or a mesh to a palette of 256 entries.
///
/// Index 0 is the default material (near white), the one of scenes without colours; colours get 1..255.
/// Colours are counted in 32,768 bins, 5 bits a channel (`rrrrrgggggbbbbb`), each with the sums that give its
/// exact average. With at most 255 bins in use every bin has an entry of its own, else the bins are divided
/// by median cut (Paul Heckbert, "Color Image Quantization for Frame Buffer Display", SIGGRAPH 1982), and the entries
/// moved to the averages of the bins nearest to them (Stuart Lloyd, "Least Squares Quantization in PCM", 1982). Integer
/// arithmetic with fixed tie rules: the same colours give the same palette on every machine, whatever the
/// order they came in.
///
/// Memory: fixed. A histogram is 3 MiB, a palette map 64 KiB, however many colours there are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "readers/source.h"

namespace thimble::tools {

inline constexpr std::size_t kColorBins = 32768;

/// The bin of a colour, 0 .. kColorBins - 1.
constexpr std::size_t color_bin(Rgb color) {
  return (std::size_t{color.r} >> 3) << 10 | (std::size_t{color.g} >> 3) << 5 | std::size_t{color.b} >> 3;
}

/// A plain one.
Material colored(Rgb color);
/// What palette index 0 looks like.
Material default_material();

/// Counts colours. Constant time a colour; room for 2^56 of them.
class ColorHistogram {
 public:
  struct Bin {
    std::uint64_t count = 0;
    std::array<std::uint64_t, 3> sum{};  ///< of red, green, blue
    std::uint64_t squares = 0;           ///< of all three
    std::uint64_t power_q8 = 0;          ///< of what glows
  };

  ColorHistogram() : bins_(2 * kColorBins) {}
  /// @param power_q8  of a colour that is given off as light, how many times as bright it is, in 1/256: it gets an
  /// entry of its own, a light's; 0: it is none
  void add(Rgb color, std::uint32_t power_q8 = 0) {
    Bin& bin = bins_[color_bin(color) + (power_q8 != 0 ? kColorBins : 0)];
    bin.power_q8 += power_q8;
    ++bin.count;
    bin.sum[0] += color.r;
    bin.sum[1] += color.g;
    bin.sum[2] += color.b;
    bin.squares += std::uint64_t{color.r} * color.r + std::uint64_t{color.g} * color.g +
                   std::uint64_t{color.b} * color.b;
  }
  const Bin& bin(std::size_t index) const { return bins_[index]; }

 private:
  std::vector<Bin> bins_;
};

/// A palette and the way to it: one table look-up a colour.
class PaletteMap {
 public:
  /// Chooses the colours; some milliseconds. An empty histogram gives a palette of default materials in which
  /// every colour maps to 0. A colour whose bin was not counted maps to the entry nearest to the bin's
  /// middle (squared distance, the lowest index on a tie).
  explicit PaletteMap(const ColorHistogram& histogram);

  /// Palette index of `color`: 1..255, or 0 when no colour was counted.
  std::uint8_t index(Rgb color, bool glows = false) const {
    return table_[color_bin(color) + (glows ? kColorBins : 0)];
  }
  /// Entries `colors() + 1` .. 255 are default materials.
  const Palette& palette() const { return palette_; }
  /// Entries in use besides index 0: 0..255.
  int colors() const { return colors_; }
  /// Root of the mean square by which a channel of the counted colours differs from its entry's, of 255.
  double error() const { return error_; }
  struct Swatch;

 private:
  /// Gives the entries the average of their bins.
  void average_entries(const ColorHistogram& histogram, const std::vector<Swatch>& swatches);
  /// 0 where no entry glows, or all do.
  std::uint8_t nearest_entry(const std::array<std::uint8_t, 3>& color, bool glows) const;

  Palette palette_;
  std::vector<std::uint8_t> table_;
  int colors_ = 0;
  double error_ = 0;
};

}  // namespace thimble::tools
