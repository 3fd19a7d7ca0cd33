#include "scene/palette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thimble::tools {

/// A bin in use: its rounded average and how many colours it stands for.
struct PaletteMap::Swatch {
  std::array<std::uint8_t, 3> average{};
  std::uint32_t key = 0;
  std::size_t bin = 0;
  std::uint64_t count = 0;
};

namespace {

using Swatch = PaletteMap::Swatch;
constexpr std::size_t kMaxColors = 255;

using Channels = std::array<std::uint8_t, 3>;

/// A box of the median cut: swatches [first, last) of the list, and its longest side.
struct Box {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t axis = 0;
  std::uint64_t extent = 0;
  std::uint64_t count = 0;
};

std::uint8_t rounded_average(std::uint64_t sum, std::uint64_t count) {
  return static_cast<std::uint8_t>((sum + count / 2) / count);
}

std::vector<Swatch> used_bins(const ColorHistogram& histogram) {
  std::vector<Swatch> swatches;
  for (std::size_t i = 0; i < histogram.bins().size(); ++i) {
    const auto& [count, sum, squares, power_q8] = histogram.bins()[i];
    swatches.push_back({.average = {rounded_average(sum[0], count), rounded_average(sum[1], count),
                                    rounded_average(sum[2], count)},
                        .key = histogram.index().keys()[i],
                        .bin = i,
                        .count = count});
  }
  std::sort(swatches.begin(), swatches.end(), [](const Swatch& a, const Swatch& b) { return a.key < b.key; });
  return swatches;
}

Box measure(const std::vector<Swatch>& swatches, std::size_t first, std::size_t last) {
  Box box{.first = first, .last = last};
  Channels low{255, 255, 255};
  Channels high{};
  for (std::size_t i = first; i < last; ++i) {
    box.count += swatches[i].count;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      low[channel] = std::min(low[channel], swatches[i].average[channel]);
      high[channel] = std::max(high[channel], swatches[i].average[channel]);
    }
  }
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto extent = static_cast<std::uint64_t>(high[channel] - low[channel]);
    if (extent > box.extent) {
      box.extent = extent;
      box.axis = channel;
    }
  }
  return box;
}

/// Where to cut `box` (two swatches at least) after sorting it along its longest side: both parts get about
/// half the colours and at least one swatch.
std::size_t cut(std::vector<Swatch>& swatches, const Box& box) {
  const auto begin = swatches.begin() + static_cast<std::ptrdiff_t>(box.first);
  const auto end = swatches.begin() + static_cast<std::ptrdiff_t>(box.last);
  std::sort(begin, end, [axis = box.axis](const Swatch& a, const Swatch& b) {
    return a.average[axis] != b.average[axis] ? a.average[axis] < b.average[axis] : a.key < b.key;
  });
  std::uint64_t below = swatches[box.first].count;
  std::size_t middle = box.first + 1;
  while (middle + 1 < box.last && below < box.count / 2) {
    below += swatches[middle].count;
    ++middle;
  }
  return middle;
}

/// Boxes of swatches, at most kMaxColors. The box cut next is the one with the most colours times extent;
/// the earliest on a tie.
std::vector<Box> median_cut(std::vector<Swatch>& swatches) {
  // What glows, the bins behind all others, shares no box with what does not.
  const auto glowing = static_cast<std::size_t>(
      std::find_if(swatches.begin(), swatches.end(),
                   [](const Swatch& swatch) { return swatch.key >= ColorBins::kGlows; }) -
      swatches.begin());
  std::vector<Box> boxes;
  for (const auto& [first, last] :
       {std::pair(std::size_t{0}, glowing), std::pair(glowing, swatches.size())}) {
    if (first < last) {
      boxes.push_back(measure(swatches, first, last));
    }
  }
  while (boxes.size() < kMaxColors) {
    const auto best = std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
      return a.extent * a.count < b.extent * b.count;
    });
    if (best == boxes.end() || best->extent == 0) {
      break;
    }
    const Box whole = *best;
    const std::size_t middle = cut(swatches, whole);
    *best = measure(swatches, whole.first, middle);
    boxes.push_back(measure(swatches, middle, whole.last));
  }
  return boxes;
}

int square(int value) {
  return value * value;
}

}  // namespace

Material colored(Rgb color) {
  Material material;
  material.color = color;
  return material;
}

Material default_material() {
  return colored({236, 236, 232});
}

std::size_t ColorBins::slot(std::uint32_t key) const {
  std::size_t at = key * 0x9E3779B1U >> 16;
  while (slots_[at] != 0 && keys_[slots_[at] - std::size_t{1}] != key) {
    at = (at + 1) % slots_.size();
  }
  return at;
}

std::size_t ColorBins::find(std::uint32_t key) const {
  const std::size_t number = slots_[slot(key)];
  return number == 0 ? keys_.size() : number - 1;
}

void ColorBins::add(std::uint32_t key) {
  const std::size_t at = slot(key);
  keys_.push_back(key);
  slots_[at] = static_cast<std::uint16_t>(keys_.size());
}

ColorHistogram::Bin& ColorHistogram::Bin::operator+=(const Bin& other) {
  count += other.count;
  squares += other.squares;
  power_q8 += other.power_q8;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    sum[channel] += other.sum[channel];
  }
  return *this;
}

std::size_t ColorHistogram::bin_of(Rgb color, bool glows) {
  while (true) {
    const std::uint32_t key = index_.key(color, glows);
    const std::size_t bin = index_.find(key);
    if (bin < bins_.size()) {
      return bin;
    }
    if (bins_.size() < ColorBins::kMost) {
      index_.add(key);
      bins_.emplace_back();
      return bin;
    }
    ColorHistogram coarser(index_.bits() - 1);
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      const std::uint32_t was = index_.keys()[i];
      const Rgb at{static_cast<std::uint8_t>(was >> 16), static_cast<std::uint8_t>(was >> 8),
                   static_cast<std::uint8_t>(was)};
      coarser.bins_[coarser.bin_of(at, was >= ColorBins::kGlows)] += bins_[i];
    }
    *this = std::move(coarser);
  }
}

PaletteMap::PaletteMap(const ColorHistogram& histogram)
    : bins_(histogram.index()), entries_(histogram.bins().size()) {
  palette_.fill(default_material());
  std::vector<Swatch> swatches = used_bins(histogram);
  if (swatches.empty()) {
    return;
  }
  std::vector<Box> boxes;
  if (swatches.size() <= kMaxColors) {
    for (std::size_t i = 0; i < swatches.size(); ++i) {
      boxes.push_back(measure(swatches, i, i + 1));
    }
  } else {
    boxes = median_cut(swatches);
  }
  colors_ = static_cast<int>(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (swatches[boxes[i].first].key >= ColorBins::kGlows) {
      palette_[i + 1].kind = SurfaceKind::kEmit;
      palette_[i + 1].emission = 1;
    }
    for (std::size_t j = boxes[i].first; j < boxes[i].last; ++j) {
      entries_[swatches[j].bin] = static_cast<std::uint8_t>(i + 1);
    }
  }
  constexpr int kRounds = 4;
  average_entries(histogram);
  for (int round = 0; swatches.size() > kMaxColors && round < kRounds; ++round) {
    for (const Swatch& swatch : swatches) {
      entries_[swatch.bin] = nearest_entry(swatch.average, swatch.key >= ColorBins::kGlows);
    }
    average_entries(histogram);
  }
}

void PaletteMap::average_entries(const ColorHistogram& histogram) {
  std::array<ColorHistogram::Bin, kMaxColors + 1> entries{};
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    entries[entries_[i]] += histogram.bins()[i];
  }
  double squares = 0;
  double count = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    const auto& [colors, sum, all_squares, power_q8] = entries[i];
    if (colors == 0) {
      continue;
    }
    const Channels average{rounded_average(sum[0], colors), rounded_average(sum[1], colors),
                           rounded_average(sum[2], colors)};
    palette_[i].color = {average[0], average[1], average[2]};
    const auto all = static_cast<double>(colors);
    palette_[i].flux = power_q8 == 0 ? 0 : std::log2(static_cast<double>(power_q8) / (256 * all));
    count += all;
    squares += static_cast<double>(all_squares);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double value = average[channel];
      squares += value * (value * all - 2 * static_cast<double>(sum[channel]));
    }
  }
  error_ = std::sqrt(std::fmax(0, squares) / (3 * count));
}

std::uint8_t PaletteMap::nearest_entry(const Channels& color, bool glows) const {
  std::uint8_t found = 0;
  int nearest = std::numeric_limits<int>::max();
  for (int entry = 1; entry <= colors_; ++entry) {
    const Material& to = palette_[static_cast<std::size_t>(entry)];
    const int distance =
        square(color[0] - to.color.r) + square(color[1] - to.color.g) + square(color[2] - to.color.b);
    if (distance < nearest && (to.kind == SurfaceKind::kEmit) == glows) {
      nearest = distance;
      found = static_cast<std::uint8_t>(entry);
    }
  }
  return found;
}

}  // namespace thimble::tools
