/// @file scatter.h
/// Scatter plots as SVG files that stand on their own: error against cost, with the front of the best marked
/// and named. Readable on light and dark ground.
#ifndef THIMBLE_TOOLS_OUTPUT_SCATTER_H
#define THIMBLE_TOOLS_OUTPUT_SCATTER_H

#include <string>
#include <utility>
#include <vector>

namespace thimble::tools {

struct Cloud {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x above 0, y any; an infinite y lies on the upper edge
  bool joined = false;                            ///< by a line, in their order
};

struct FrontPoint {
  double x = 1;
  double y = 0;
  std::string name;  ///< stands in a list below the plot, under the number at the point
};

struct Scatter {
  std::string title;
  std::string x_label;  ///< with unit
  std::string y_label;  ///< with unit
  std::vector<Cloud> clouds;
  std::vector<FrontPoint> front;  ///< by x, joined by a line
  std::string front_name;         ///< the list's heading
  std::string infinite_name;      ///< what the upper edge means, where a point lies there
};

/// The plot as SVG text: x logarithmic, y linear. At most eight clouds keep colours of their own.
std::string scatter_text(const Scatter& scatter);

/// Such plots one below the other in one file.
std::string stacked(const std::vector<std::string>& plots);

}  // namespace thimble::tools

#endif
