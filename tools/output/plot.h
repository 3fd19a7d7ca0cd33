/// @file plot.h
/// Line plots as SVG files that stand on their own: axes with units, legend, readable on light and dark
/// ground.
#ifndef THIMBLE_TOOLS_OUTPUT_PLOT_H
#define THIMBLE_TOOLS_OUTPUT_PLOT_H

#include <string>
#include <utility>
#include <vector>

namespace thimble::tools {

struct Series {
  std::string name;
  bool dashed = false;
  std::vector<std::pair<double, double>> points;  ///< x, y, both above 0
};

/// A level that the series are compared with: a thin line right across.
struct Mark {
  double y = 1;  ///< above 0
  std::string name;
};

struct Plot {
  std::string title;
  std::string x_label;  ///< with unit
  std::string y_label;  ///< with unit
  std::vector<Series> series;
  bool whole_x = false;  ///< x are whole numbers on a linear axis, a grid line each
  std::vector<Mark> marks;
};

/// The plot as SVG text, with logarithmic axes but for `whole_x`. At most six series keep colours of their
/// own.
std::string log_plot_text(const Plot& plot);

}  // namespace thimble::tools

#endif
