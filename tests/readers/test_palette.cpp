#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "scene/palette.h"
#include "scene/random.h"

namespace {

using namespace thimble::tools;

Rgb grey(int level) {
  const auto byte = static_cast<std::uint8_t>(level);
  return {byte, byte, byte};
}

ColorHistogram histogram_of(const std::vector<Rgb>& colors) {
  ColorHistogram histogram;
  for (const Rgb& color : colors) {
    histogram.add(color);
  }
  return histogram;
}

constexpr std::uint32_t kColorBins = 32768;  // of 5 bits a channel

/// The colour of bin number `bin`'s lowest corner.
Rgb bin_color(std::uint32_t bin) {
  return {static_cast<std::uint8_t>(bin >> 10 << 3), static_cast<std::uint8_t>((bin >> 5 & 31) << 3),
          static_cast<std::uint8_t>((bin & 31) << 3)};
}

int largest_difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

}  // namespace

TEST_CASE("palette: no colours -> everything is the default material") {
  const PaletteMap map{ColorHistogram{}};
  CHECK(map.colors() == 0);
  CHECK(map.index({0, 0, 0}) == 0);
  CHECK(map.index({255, 255, 255}) == 0);
  CHECK(map.error() == 0);
  CHECK(map.palette()[0].color == default_material().color);
  CHECK(map.palette()[255].color == default_material().color);
}

TEST_CASE("palette: one colour -> kept exactly, index 0 stays the default") {
  const PaletteMap map(histogram_of({{17, 201, 93}}));
  CHECK(map.colors() == 1);
  CHECK(map.index({17, 201, 93}) == 1);
  CHECK(map.palette()[1].color == Rgb{17, 201, 93});
  CHECK(map.palette()[0].color == default_material().color);
  // A colour that was not counted still gets the nearest entry, never 0.
  CHECK(map.index({255, 0, 0}) == 1);
}

TEST_CASE("palette: colours that glow -> entries of their own, however many others there are") {
  ColorHistogram histogram;
  for (std::uint32_t bin = 0; bin < kColorBins; ++bin) {
    histogram.add(bin_color(bin));
  }
  histogram.add({248, 0, 0}, 8 * 256);
  const PaletteMap map(histogram);
  CHECK(map.colors() == 255);
  const Material& entry = map.palette()[map.index({248, 0, 0}, true)];
  CHECK(entry.kind == thimble::SurfaceKind::kEmit);
  CHECK(entry.color == Rgb{248, 0, 0});
  CHECK(entry.flux == 3);
  CHECK(map.palette()[map.index({248, 0, 0})].kind == thimble::SurfaceKind::kDiffuse);
}

TEST_CASE("palette: lights of several powers -> each its own; of one entry the mean") {
  ColorHistogram histogram;
  histogram.add({255, 0, 0}, 1000 * 256);
  histogram.add({0, 255, 0}, 2 * 256);
  histogram.add({0, 255, 0}, 6 * 256);
  const PaletteMap map(histogram);
  CHECK(map.palette()[map.index({255, 0, 0}, true)].flux == doctest::Approx(std::log2(1000)));
  CHECK(map.palette()[map.index({0, 255, 0}, true)].flux == 2);
}

TEST_CASE("palette: colours that differ by one -> each exactly; 256 greys -> one pair shares an entry") {
  const std::vector<Rgb> close{{16, 16, 16}, {16, 16, 17}, {16, 17, 17}};
  const PaletteMap map(histogram_of(close));
  CHECK(map.colors() == 3);
  CHECK(map.error() == 0);
  for (const Rgb& color : close) {
    CHECK(map.palette()[map.index(color)].color == color);
  }
  std::vector<Rgb> greys;
  for (int i = 0; i < 256; ++i) {
    greys.push_back(grey(i));
  }
  const PaletteMap ramp(histogram_of(greys));
  CHECK(ramp.colors() == 255);
  CHECK(ramp.error() == doctest::Approx(std::sqrt(1.0 / 256)));
}

TEST_CASE("palette: more colours than are counted one by one -> bins, whatever the order; no entry far off") {
  // All colours of 6 bits a channel: 262,144, which are counted in bins of 5.
  ColorHistogram forward;
  ColorHistogram backward;
  for (std::uint32_t i = 0; i < 1U << 18; ++i) {
    const auto add = [](ColorHistogram& to, std::uint32_t number) {
      to.add({static_cast<std::uint8_t>(number >> 12 << 2),
              static_cast<std::uint8_t>((number >> 6 & 63) << 2),
              static_cast<std::uint8_t>((number & 63) << 2)});
    };
    add(forward, i);
    add(backward, (1U << 18) - 1 - i);
  }
  CHECK(forward.index().bits() == 5);
  CHECK(forward.bins().size() == kColorBins);
  const PaletteMap map(forward);
  const PaletteMap other(backward);
  for (std::size_t i = 0; i < 256; ++i) {
    CHECK(map.palette()[i].color == other.palette()[i].color);
  }
  CHECK(map.error() < 15);
  // A light beside them leaves room for bins of 4 only.
  forward.add({255, 0, 0}, 512);
  CHECK(forward.index().bits() == 4);
  CHECK(PaletteMap(forward).palette()[PaletteMap(forward).index({255, 0, 0}, true)].color == Rgb{255, 0, 0});
  ColorHistogram pair(5);
  pair.add({0, 0, 0});
  pair.add({4, 4, 4});
  CHECK(PaletteMap(pair).colors() == 1);
  CHECK(PaletteMap(pair).error() == 2);
}

TEST_CASE("palette: 255 bins -> exact; 256 -> median cut within a bin's distance") {
  for (const std::uint32_t count : {255U, 256U}) {
    std::vector<Rgb> colors;
    for (std::uint32_t i = 0; i < count; ++i) {
      colors.push_back(bin_color(i * 127));
    }
    const PaletteMap map(histogram_of(colors));
    CHECK(map.colors() == 255);
    int wrong = 0;
    for (const Rgb& color : colors) {
      const std::uint8_t index = map.index(color);
      CHECK(index != 0);
      wrong += !(map.palette()[index].color == color);
    }
    CHECK(wrong == (count == 255 ? 0 : 2));  // two bins share the entry between them
  }
}

TEST_CASE("palette: more colours than entries -> the same on every machine, ties included") {
  // Colours on a coarse lattice: most cuts sort many equal values. The hash is FNV-1a, 32 bits.
  ColorHistogram histogram;
  for (std::uint32_t bin = 0; bin < kColorBins; bin += 3) {
    histogram.add(bin_color(bin));
  }
  const PaletteMap map(histogram);
  std::uint32_t hash = 2166136261U;
  for (const Material& material : map.palette()) {
    for (const std::uint8_t channel : {material.color.r, material.color.g, material.color.b}) {
      hash = (hash ^ channel) * 16777619U;
    }
  }
  CHECK(hash == 0x30E71F5CU);
}

TEST_CASE("palette: a rare colour among many shades -> the frequent ones get the entries") {
  // A wide noise of single colours and a narrow, frequent gradient: the gradient must stay smooth.
  constexpr std::uint64_t kSeed = 3;
  SplitMix64 random(kSeed);
  ColorHistogram histogram;
  for (int i = 0; i < 2000; ++i) {
    histogram.add(bin_color(random.below(kColorBins)));
  }
  for (int shade = 0; shade < 256; shade += 8) {
    for (int i = 0; i < 100000; ++i) {
      histogram.add(grey(shade));
    }
  }
  const PaletteMap map(histogram);
  CAPTURE(kSeed);
  for (int shade = 0; shade < 256; shade += 8) {
    CAPTURE(shade);
    CHECK(largest_difference(grey(shade), map.palette()[map.index(grey(shade))].color) <= 1);
  }
}
