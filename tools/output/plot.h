/// Line plots, bar charts and scatter plots as SVG files that stand on their own: axes with units, legend,
/// readable on light and dark ground.
#pragma once

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

// Bar charts: a bar a line.

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

// Scatter plots: error against cost, with the front of the best marked and named.

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

// What the plots are written with: numbers, lines and words of an SVG document.

/// A coordinate, to a tenth of a pixel.
std::string number(double value);

/// Words as XML takes them: what would be markup is written otherwise, and what is no UTF-8 or no character
/// of XML (a file's name may hold any bytes) as U+FFFD.
std::string xml_text(const std::string& plain);

/// A line of the style class `kind`.
std::string line(double x1, double y1, double x2, double y2, const char* kind);

/// Words at a place; `anchor` is start, middle or end, `more` attributes with a blank before each.
std::string label(double x, double y, const char* anchor, const std::string& text,
                  const std::string& more = {});

}  // namespace thimble::tools
