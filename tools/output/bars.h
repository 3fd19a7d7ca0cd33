/// @file bars.h
/// Bar charts as SVG files that stand on their own: a bar a line, axis with unit, readable on light and dark
/// ground.
#ifndef THIMBLE_TOOLS_OUTPUT_BARS_H
#define THIMBLE_TOOLS_OUTPUT_BARS_H

#include <string>
#include <vector>

namespace thimble::tools {

struct Bar {
  std::string name;
  double value = 0;  ///< any sign
  double low = 0;    ///< ends of the thin line across its end; both equal: none
  double high = 0;
  std::string text;  ///< beside it
};

struct BarChart {
  std::string title;
  std::string x_label;  ///< with unit
  std::vector<Bar> bars;
};

std::string bar_chart_text(const BarChart& chart);

}  // namespace thimble::tools

#endif
