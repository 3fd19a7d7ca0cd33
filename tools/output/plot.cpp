#include "output/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "output/svg.h"

namespace thimble::tools {
namespace {

constexpr double kPlotWidth = 760;
constexpr double kHeight = 460;
constexpr double kPlotLeft = 84;
constexpr double kPlotRight = 20;
constexpr double kPlotTop = 44;
constexpr double kBottom = 112;

// A range of whole decades.
struct Decades {
  int low = 0;
  int high = 1;

  void hold(double value, bool first) {
    const int floor = static_cast<int>(std::floor(std::log10(value)));
    const int ceil = static_cast<int>(std::ceil(std::log10(value)));
    low = first ? floor : std::min(low, floor);
    high = first ? std::max(ceil, floor + 1) : std::max(high, ceil);
  }
  double part(double value) const { return (std::log10(value) - low) / (high - low); }
};

std::string decade_text(int decade) {
  if (decade >= 0 && decade <= 3) {
    return std::to_string(static_cast<int>(std::lround(std::pow(10, decade))));
  }
  if (decade == -1) {
    return "0.1";
  }
  // Characters of their own, so that a label stays plain words.
  constexpr std::array<const char*, 10> kRaised{"\u2070", "\u00B9", "\u00B2", "\u00B3", "\u2074",
                                                "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = decade < 0 ? "10\u207B" : "10";
  for (const char digit : std::to_string(std::abs(decade))) {
    text += kRaised[static_cast<std::size_t>(digit - '0')];
  }
  return text;
}

}  // namespace

std::string log_plot_text(const Plot& plot) {
  // Okabe and Ito's colours, which stay apart for most kinds of colour vision and on both grounds.
  constexpr std::array<const char*, 6> kColors{"#0072b2", "#d55e00", "#009e73",
                                               "#cc79a7", "#e69f00", "#56b4e9"};
  Decades x_range;
  Decades y_range;
  bool first = true;
  for (const Series& series : plot.series) {
    for (const auto& [x, y] : series.points) {
      x_range.hold(x, first);
      y_range.hold(y, first);
      first = false;
    }
  }
  for (const Mark& mark : plot.marks) {
    y_range.hold(mark.y, first);
    first = false;
  }
  // On a linear axis: the whole numbers from the least to the greatest.
  double least = 0;
  double greatest = 1;
  bool any = false;
  for (const Series& series : plot.series) {
    for (const auto& point : series.points) {
      least = any ? std::min(least, point.first) : point.first;
      greatest = any ? std::max(greatest, point.first) : point.first;
      any = true;
    }
  }
  greatest = std::max(greatest, least + 1);
  const auto x_part = [&](double x) {
    return plot.whole_x ? (x - least) / (greatest - least) : x_range.part(x);
  };
  const auto x_at = [&](double x) { return kPlotLeft + x_part(x) * (kPlotWidth - kPlotLeft - kPlotRight); };
  const auto y_at = [&](double y) {
    return kHeight - kBottom - y_range.part(y) * (kHeight - kPlotTop - kBottom);
  };

  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kPlotWidth) + " " +
      number(kHeight) +
      "\" font-family=\"sans-serif\" font-size=\"12\">\n<style>\n"
      ".ground { fill: #ffffff } text { fill: #222222 } .grid { stroke: #dddddd } .axis { stroke: "
      "#222222 } .mark { stroke: #888888; stroke-dasharray: 2 3 }\n@media (prefers-color-scheme: dark) { "
      ".ground { fill: #15181c } text { fill: #e6e6e6 "
      "} .grid { stroke: #3a3f45 } .axis { stroke: #e6e6e6 } }\n</style>\n<rect width=\"100%\" "
      "height=\"100%\" class=\"ground\"/>\n";
  svg += label(kPlotWidth / 2, 24, "middle", plot.title, " font-size=\"15\"");
  for (double whole = least; plot.whole_x && whole <= greatest; whole += 1) {
    svg += line(x_at(whole), kPlotTop, x_at(whole), kHeight - kBottom, "grid") +
           label(x_at(whole), kHeight - kBottom + 18, "middle", std::to_string(std::lround(whole)));
  }
  for (int decade = x_range.low; !plot.whole_x && decade <= x_range.high; ++decade) {
    const double x = x_at(std::pow(10, decade));
    svg += line(x, kPlotTop, x, kHeight - kBottom, "grid") +
           label(x, kHeight - kBottom + 18, "middle", decade_text(decade));
  }
  for (int decade = y_range.low; decade <= y_range.high; ++decade) {
    const double y = y_at(std::pow(10, decade));
    svg += line(kPlotLeft, y, kPlotWidth - kPlotRight, y, "grid") +
           label(kPlotLeft - 8, y + 4, "end", decade_text(decade));
  }
  svg += line(kPlotLeft, kPlotTop, kPlotLeft, kHeight - kBottom, "axis") +
         line(kPlotLeft, kHeight - kBottom, kPlotWidth - kPlotRight, kHeight - kBottom, "axis");
  svg += label((kPlotLeft + kPlotWidth - kPlotRight) / 2, kHeight - kBottom + 40, "middle", plot.x_label);
  const double middle = (kPlotTop + kHeight - kBottom) / 2;
  svg += label(20, middle, "middle", plot.y_label, " transform=\"rotate(-90 20 " + number(middle) + ")\"");

  for (const Mark& mark : plot.marks) {
    const double y = y_at(mark.y);
    svg += line(kPlotLeft, y, kPlotWidth - kPlotRight, y, "mark") +
           label(kPlotLeft + 6, y - 4, "start", mark.name, " font-size=\"11\"");
  }
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    const std::string color = kColors[i % kColors.size()];
    const std::string dash = series.dashed ? " stroke-dasharray=\"6 4\"" : "";
    svg += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + color + "\"" + dash + " points=\"";
    for (const auto& [x, y] : series.points) {
      svg += number(x_at(x)) + "," + number(y_at(y)) + " ";
    }
    svg += "\"/>\n";
    for (const auto& [x, y] : series.points) {
      svg += "<circle cx=\"" + number(x_at(x)) + "\" cy=\"" + number(y_at(y)) + "\" r=\"3\" fill=\"" + color +
             "\"/>\n";
    }
    const std::size_t legend_row = i / 2;
    const double column = kPlotLeft + static_cast<double>(i % 2) * (kPlotWidth - kPlotLeft - kPlotRight) / 2;
    const double row = kHeight - kBottom + 62 + 18 * static_cast<double>(legend_row);
    svg += "<line x1=\"" + number(column) + "\" y1=\"" + number(row - 4) + "\" x2=\"" + number(column + 28) +
           "\" y2=\"" + number(row - 4) + "\" stroke-width=\"2\" stroke=\"" + color + "\"" + dash + "/>\n";
    svg += label(column + 36, row, "start", series.name);
  }
  svg += "</svg>\n";
  return svg;
}

}  // namespace thimble::tools
