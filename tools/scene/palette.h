/// Colours of a cloud or a mesh to a palette of 256 entries.
///
/// Index 0 is the default material (near white), the one of scenes without colours; colours get 1..255.
/// Colours are counted one by one while there are at most 32,768 different ones, else in the finest bins of 7, 6, 5 or
/// 4 bits a channel that are no more, each with the sums that give its exact average. With at most 255 bins in use every
/// bin has an entry of its own, else the bins are divided
/// by median cut (Paul Heckbert, "Color Image Quantization for Frame Buffer Display", SIGGRAPH 1982), and the entries
/// moved to the averages of the bins nearest to them (Stuart Lloyd, "Least Squares Quantization in PCM", 1982). Integer
/// arithmetic with fixed tie rules: the same colours give the same palette on every machine, whatever the
/// order they came in.
///
/// Memory: bounded. A histogram is at most 3 MiB, a palette map 0.4 MiB, however many colours there are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "readers/source.h"

namespace thimble::tools {

Material colored(Rgb color);
/// What palette index 0 looks like.
Material default_material();

/// Bins of colours, and of the same colours where they glow, numbered as they come.
class ColorBins {
 public:
  static constexpr std::size_t kMost = 32768;
  static constexpr std::uint32_t kGlows = 1U << 24;  ///< in a key, above its red, green and blue

  explicit ColorBins(int bits) : bits_(bits), slots_(2 * kMost) {}
  std::uint32_t key(Rgb color, bool glows) const {
    const std::uint32_t channel = 0xFF00U >> bits_ & 0xFF;
    return ((std::uint32_t{color.r} << 16 | std::uint32_t{color.g} << 8 | color.b) & channel * 0x010101U) |
           (glows ? kGlows : 0);
  }
  /// The number of a bin, or how many there are where it is none of them.
  std::size_t find(std::uint32_t key) const;
  void add(std::uint32_t key);
  const std::vector<std::uint32_t>& keys() const { return keys_; }
  int bits() const { return bits_; }

 private:
  std::size_t slot(std::uint32_t key) const;

  int bits_;  ///< a channel
  std::vector<std::uint16_t> slots_;
  std::vector<std::uint32_t> keys_;
};

/// Counts colours. Constant time a colour; room for 2^56 of them.
class ColorHistogram {
 public:
  struct Bin {
    std::uint64_t count = 0;
    std::array<std::uint64_t, 3> sum{};  ///< of red, green, blue
    std::uint64_t squares = 0;           ///< of all three
    std::uint64_t power_q8 = 0;          ///< of what glows
    Bin& operator+=(const Bin& other);
  };

  /// @param bits  that are told apart a channel, while there is room
  explicit ColorHistogram(int bits = 8) : index_(bits) {}
  /// @param power_q8  of a colour that is given off as light, how many times as bright it is, in 1/256: it gets an
  /// entry of its own, a light's; 0: it is none
  void add(Rgb color, std::uint32_t power_q8 = 0, std::uint64_t times = 1) {
    if (times == 0) {
      return;
    }
    const bool glows = power_q8 != 0;
    if (last_ == bins_.size() || index_.keys()[last_] != index_.key(color, glows)) {
      last_ = bin_of(color, glows);
    }
    const std::uint64_t r = color.r, g = color.g, b = color.b;
    bins_[last_] +=
        {times, {r * times, g * times, b * times}, (r * r + g * g + b * b) * times, power_q8 * times};
  }
  const ColorBins& index() const { return index_; }
  /// By the numbers of `index`.
  const std::vector<Bin>& bins() const { return bins_; }

 private:
  std::size_t bin_of(Rgb color, bool glows);

  ColorBins index_;
  std::vector<Bin> bins_;
  std::size_t last_ = 0;  ///< the bin of the last colour, which often comes again
};

/// A palette and the way to it: a table look-up a colour that was counted.
class PaletteMap {
 public:
  /// Chooses the colours; some milliseconds. An empty histogram gives a palette of default materials in which
  /// every colour maps to 0. A colour whose bin was not counted maps to the entry nearest to it (squared distance, the
  /// lowest index on a tie), for which all are looked at.
  explicit PaletteMap(const ColorHistogram& histogram);

  /// Palette index of `color`: 1..255, or 0 when no colour was counted.
  std::uint8_t index(Rgb color, bool glows = false) const {
    const std::size_t bin = bins_.find(bins_.key(color, glows));
    return bin < entries_.size() ? entries_[bin] : nearest_entry({color.r, color.g, color.b}, glows);
  }
  /// Entries `colors() + 1` .. 255 are default materials.
  const Palette& palette() const { return palette_; }
  /// Entries in use besides index 0: 0..255.
  int colors() const { return colors_; }
  /// Root of the mean square by which a channel of the counted colours differs from its entry's, of 255.
  double error() const { return error_; }
  struct Swatch;

 private:
  void average_entries(const ColorHistogram& histogram);
  /// 0 where no entry glows, or all do.
  std::uint8_t nearest_entry(const std::array<std::uint8_t, 3>& color, bool glows) const;

  Palette palette_;
  ColorBins bins_;
  std::vector<std::uint8_t> entries_;  ///< of the bins
  int colors_ = 0;
  double error_ = 0;
};

}  // namespace thimble::tools
