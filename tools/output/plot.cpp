#include "output/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "output/units.h"

namespace thimble::tools {
namespace {

// The beginning of an SVG document; `more`: styles besides those of ground, words, grid and axes; `dark`: that of the
// axes and of those on a dark ground.
std::string svg_begin(double width, double height, const std::string& more, const std::string& dark) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " + number(height) +
         "\" font-family=\"sans-serif\" font-size=\"12\">\n<style>\n"
         ".ground { fill: #ffffff } text { fill: #222222 } .grid { stroke: #dddddd } .axis { stroke: #222222 "
         "} " +
         more +
         "\n@media (prefers-color-scheme: dark) { .ground { fill: #15181c } text { fill: #e6e6e6 } .grid { "
         "stroke: #3a3f45 } " +
         dark + " }\n</style>\n<rect width=\"100%\" height=\"100%\" class=\"ground\"/>\n";
}

// Okabe and Ito's colours, which stay apart for most kinds of colour vision and on both grounds; a grey, and a brown.
constexpr std::array<const char*, 8> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#e69f00", "#56b4e9", "#8a8a8a", "#a0522d"};
constexpr std::size_t kLineColors = 6;

// A line from point to point, each where `place` says.
template <class Points, class Place>
std::string polyline(const std::string& style, const Points& points, const Place& place) {
  std::string svg = "<polyline " + style + " points=\"";
  for (const auto& point : points) {
    const auto [x, y] = place(point);
    svg += number(x) + "," + number(y) + " ";
  }
  return svg + "\"/>\n";
}

std::string circle(double x, double y, double radius, const std::string& style) {
  return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"" + number(radius) + "\" " + style +
         "/>\n";
}

constexpr double kWidth = 760;

// Where the axes of a plot lie, and what is written along them.
struct Axes {
  double left;
  double right;
  double top;
  double bottom;

  double width() const { return right - left; }
  double height() const { return bottom - top; }
  std::string x_mark(double x, const std::string& text) const {
    return line(x, top, x, bottom, "grid") + label(x, bottom + 18, "middle", text);
  }
  std::string y_mark(double y, const std::string& text) const {
    return line(left, y, right, y, "grid") + label(left - 8, y + 4, "end", text);
  }
  std::string lines() const {
    return line(left, top, left, bottom, "axis") + line(left, bottom, right, bottom, "axis");
  }
  std::string names(const std::string& x_name, const std::string& y_name) const {
    const double middle = (top + bottom) / 2;
    return label((left + right) / 2, bottom + 40, "middle", x_name) +
           label(20, middle, "middle", y_name, " transform=\"rotate(-90 20 " + number(middle) + ")\"");
  }
};

constexpr double kHeight = 460;
constexpr Axes kLogAxes{84, kWidth - 20, 44, kHeight - 112};

// From the least to the greatest of some numbers; of none as it was made.
struct Range {
  double low = 0;
  double high = 1;
  bool is_empty = true;

  void hold(double value) {
    low = is_empty ? value : std::min(low, value);
    high = is_empty ? value : std::max(high, value);
    is_empty = false;
  }
};

// A range of whole decades.
struct Decades {
  int low = 0;
  int high = 1;
  bool is_empty = true;

  void hold(double value) {
    const int floor = static_cast<int>(std::floor(std::log10(value)));
    const int ceil = static_cast<int>(std::ceil(std::log10(value)));
    low = is_empty ? floor : std::min(low, floor);
    high = is_empty ? std::max(ceil, floor + 1) : std::max(high, ceil);
    is_empty = false;
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

constexpr double kBarsLeft = 150;
constexpr double kBarsRight = 190;
constexpr double kBarsTop = 48;
constexpr double kStep = 26;
constexpr double kThickness = 16;

// 1, 2 or 5 times a power of ten, so that a range has four to ten of them.
double tick_of(double range) {
  const double power = std::pow(10, std::floor(std::log10(range)));
  const double lead = range / power;
  return power * (lead < 2 ? 0.2 : lead < 5 ? 0.5 : 1);
}

std::string tick_text(double value, double tick) {
  const int digits = tick < 1 ? static_cast<int>(std::ceil(-std::log10(tick) - 1e-9)) : 0;
  return fixed(value, std::clamp(digits, 0, 9));
}

constexpr Axes kScatterAxes{72, kWidth - 24, 52, 52 + 330};
constexpr double kLineHeight = 18;
// Names in two columns where there are many.
constexpr std::size_t kManyNames = 8;

// A tick's value without what powers of ten leave behind.
std::string rounded(double value) {
  return shortest(std::round(value * 1e6) / 1e6);
}

// Where the axes begin and end: x at a 1, 2 or 5 of a decade, y at multiples of `step`.
struct Scales {
  std::vector<double> x_ticks;
  double low = 0;
  double high = 1;
  double step = 1;

  explicit Scales(const std::vector<std::pair<double, double>>& points) {
    Range all_x{1, 1};
    Range all_y;
    for (const auto& [x, y] : points) {
      all_x.hold(x);
      if (std::isfinite(y)) {
        all_y.hold(y);
      }
    }
    std::vector<double> marks;
    const int decade = static_cast<int>(std::floor(std::log10(all_x.low)));
    for (int power = decade; power <= decade + 12; ++power) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        marks.push_back(digit * std::pow(10.0, power));
      }
    }
    std::size_t begin = 0;
    while (begin + 2 < marks.size() && marks[begin + 1] <= all_x.low) {
      ++begin;
    }
    std::size_t end = begin + 1;
    while (end + 1 < marks.size() && marks[end] < all_x.high) {
      ++end;
    }
    x_ticks.assign(marks.begin() + static_cast<std::ptrdiff_t>(begin),
                   marks.begin() + static_cast<std::ptrdiff_t>(end) + 1);
    const double range = std::max(all_y.high - all_y.low, 1e-9);
    step = std::pow(10.0, std::floor(std::log10(range)));
    while (range / step < 4) {
      step /= 2;
    }
    low = std::floor(all_y.low / step) * step;
    high = (std::floor(all_y.high / step) + 1) * step;
  }
  double x_at(double x) const {
    return kScatterAxes.left +
           std::log(x / x_ticks.front()) / std::log(x_ticks.back() / x_ticks.front()) * kScatterAxes.width();
  }
  double y_at(double y) const {
    return kScatterAxes.bottom - (std::min(y, high) - low) / (high - low) * kScatterAxes.height();
  }
};

// Numbers at points, each in the nearest place round its point that neither another number nor another point
// has.
class Numbers {
 public:
  explicit Numbers(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {}

  std::string label_at(double x, double y, const std::string& text) {
    const double half = 3.5 * static_cast<double>(text.size());
    constexpr double kHalfLine = 4;  // of the height of digits of 11 px
    std::pair<double, double> middle{x, y};
    bool found = false;
    for (double away = 12; !found && away <= 48; away += 6) {
      // From above left round the point.
      for (int turn = 0; !found && turn < 12; ++turn) {
        const double angle = (225 + 30 * turn) * kDegree;
        middle = {x + (away + half - 3.5) * std::cos(angle), y + away * std::sin(angle)};
        const bool is_apart = std::none_of(numbers_.begin(), numbers_.end(), [&](const Number& other) {
          return std::abs(other.x - middle.first) < half + other.half + 2 &&
                 std::abs(other.y - middle.second) < 2 * kHalfLine + 2;
        });
        const bool is_beside = std::none_of(points_.begin(), points_.end(), [&](const auto& point) {
          return std::abs(point.first - middle.first) < half + 6 &&
                 std::abs(point.second - middle.second) < kHalfLine + 6;
        });
        found = is_apart && is_beside;
      }
    }
    numbers_.push_back({middle.first, middle.second, half});
    return label(middle.first, middle.second + kHalfLine, "middle", text, " font-size=\"11\"");
  }

 private:
  struct Number {
    double x, y, half;
  };
  static constexpr double kDegree = 3.14159265358979 / 180;
  std::vector<std::pair<double, double>> points_;
  std::vector<Number> numbers_;
};

}  // namespace

std::string log_plot_text(const Plot& plot) {
  Decades x_range;
  Decades y_range;
  Range whole_x;  // on a linear axis
  for (const Series& series : plot.series) {
    for (const auto& [x, y] : series.points) {
      x_range.hold(x);
      y_range.hold(y);
      whole_x.hold(x);
    }
  }
  for (const Mark& mark : plot.marks) {
    y_range.hold(mark.y);
  }
  const double least = whole_x.low;
  const double greatest = std::max(whole_x.high, least + 1);
  const auto x_part = [&](double x) {
    return plot.whole_x ? (x - least) / (greatest - least) : x_range.part(x);
  };
  const Axes& axes = kLogAxes;
  const auto x_at = [&](double x) { return axes.left + x_part(x) * axes.width(); };
  const auto y_at = [&](double y) { return axes.bottom - y_range.part(y) * axes.height(); };

  std::string svg = svg_begin(kWidth, kHeight, ".mark { stroke: #888888; stroke-dasharray: 2 3 }",
                              ".axis { stroke: #e6e6e6 }");
  svg += label(kWidth / 2, 24, "middle", plot.title, " font-size=\"15\"");
  for (double whole = least; plot.whole_x && whole <= greatest; whole += 1) {
    svg += axes.x_mark(x_at(whole), std::to_string(std::lround(whole)));
  }
  for (int decade = x_range.low; !plot.whole_x && decade <= x_range.high; ++decade) {
    svg += axes.x_mark(x_at(std::pow(10, decade)), decade_text(decade));
  }
  for (int decade = y_range.low; decade <= y_range.high; ++decade) {
    svg += axes.y_mark(y_at(std::pow(10, decade)), decade_text(decade));
  }
  svg += axes.lines() + axes.names(plot.x_label, plot.y_label);
  for (const Mark& mark : plot.marks) {
    const double y = y_at(mark.y);
    svg += line(axes.left, y, axes.right, y, "mark") +
           label(axes.left + 6, y - 4, "start", mark.name, " font-size=\"11\"");
  }
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    const std::string color = kColors[i % kLineColors];
    const std::string dash = series.dashed ? " stroke-dasharray=\"6 4\"" : "";
    svg += polyline("fill=\"none\" stroke-width=\"2\" stroke=\"" + color + "\"" + dash, series.points,
                    [&](const auto& point) {
                      return std::pair{x_at(point.first), y_at(point.second)};
                    });
    for (const auto& [x, y] : series.points) {
      svg += circle(x_at(x), y_at(y), 3, "fill=\"" + color + "\"");
    }
    const std::size_t legend_row = i / 2;
    const double column = axes.left + static_cast<double>(i % 2) * axes.width() / 2;
    const double row = axes.bottom + 62 + 18 * static_cast<double>(legend_row);
    svg += "<line x1=\"" + number(column) + "\" y1=\"" + number(row - 4) + "\" x2=\"" + number(column + 28) +
           "\" y2=\"" + number(row - 4) + "\" stroke-width=\"2\" stroke=\"" + color + "\"" + dash + "/>\n";
    svg += label(column + 36, row, "start", series.name);
  }
  svg += "</svg>\n";
  return svg;
}

std::string bar_chart_text(const BarChart& chart) {
  double least = 0;
  double most = 0;
  for (const Bar& bar : chart.bars) {
    least = std::min({least, bar.value, bar.low});
    most = std::max({most, bar.value, bar.high});
  }
  if (most - least <= 0) {
    most = least + 1;
  }
  const double tick = tick_of(most - least);
  const auto first = static_cast<int>(std::floor(least / tick));
  const auto last = static_cast<int>(std::ceil(most / tick));
  const auto x_at = [&](double value) {
    return kBarsLeft + (value - first * tick) / ((last - first) * tick) * (kWidth - kBarsLeft - kBarsRight);
  };
  const double bottom = kBarsTop + kStep * static_cast<double>(chart.bars.size());
  const double height = bottom + 52;
  std::string svg =
      svg_begin(kWidth, height, ".bar { fill: #0072b2 }", ".axis { stroke: #e6e6e6 } .bar { fill: #56b4e9 }");
  svg += label(kWidth / 2, 24, "middle", chart.title, " font-size=\"15\"");
  for (int step = first; step <= last; ++step) {
    const double x = x_at(step * tick);
    svg +=
        line(x, kBarsTop, x, bottom, "grid") + label(x, bottom + 16, "middle", tick_text(step * tick, tick));
  }
  double y = kBarsTop;
  for (const Bar& bar : chart.bars) {
    const double middle = y + kStep / 2;
    const double from = std::min(x_at(0), x_at(bar.value));
    const double to = std::max(x_at(0), x_at(bar.value));
    svg += label(kBarsLeft - 8, middle + 4, "end", bar.name);
    svg += "<rect x=\"" + number(from) + "\" y=\"" + number(middle - kThickness / 2) + "\" width=\"" +
           number(to - from) + "\" height=\"" + number(kThickness) + "\" class=\"bar\"/>\n";
    if (bar.low != bar.high) {
      svg += line(x_at(bar.low), middle, x_at(bar.high), middle, "axis");
    }
    svg += label(std::max(to, x_at(bar.high)) + 8, middle + 4, "start", bar.text);
    y += kStep;
  }
  svg += line(x_at(0), kBarsTop, x_at(0), bottom, "axis");
  svg += label((kBarsLeft + kWidth - kBarsRight) / 2, bottom + 38, "middle", chart.x_label);
  return svg + "</svg>\n";
}

std::string scatter_text(const Scatter& scatter) {
  std::vector<std::pair<double, double>> points;
  for (const Cloud& cloud : scatter.clouds) {
    points.insert(points.end(), cloud.points.begin(), cloud.points.end());
  }
  const Scales scales(points);
  const bool infinite = std::any_of(points.begin(), points.end(),
                                    [](const auto& point) { return !std::isfinite(point.second); });
  const std::size_t legend_rows = (scatter.clouds.size() + 3) / 4;
  const std::size_t columns = scatter.front.size() > kManyNames ? 2 : 1;
  const std::size_t name_rows = (scatter.front.size() + columns - 1) / columns;
  const Axes& axes = kScatterAxes;
  const double legend = axes.bottom + 64;
  const double names = legend + kLineHeight * static_cast<double>(legend_rows) + 8;
  const double height =
      names + kLineHeight * static_cast<double>(scatter.front.empty() ? 0 : name_rows + 1) + 8;

  std::string svg = svg_begin(kWidth, height,
                              ".front { fill: none; stroke: #222222; stroke-width: 1.5 } .ring { fill: none; "
                              "stroke: #222222 }",
                              ".axis, .front, .ring { stroke: #e6e6e6 }");
  svg += label(kWidth / 2, 26, "middle", scatter.title, " font-size=\"15\"");
  for (const double tick : scales.x_ticks) {
    svg += axes.x_mark(scales.x_at(tick), rounded(tick));
  }
  for (int i = 0; scales.low + i * scales.step <= scales.high + scales.step / 2; ++i) {
    const double value = scales.low + i * scales.step;
    svg += axes.y_mark(scales.y_at(value), rounded(value));
  }
  svg += axes.lines();
  if (infinite) {
    svg += label(axes.left + 6, axes.top - 6, "start", scatter.infinite_name, " font-size=\"11\"");
  }
  svg += axes.names(scatter.x_label, scatter.y_label);
  const auto place = [&](const auto& point) {
    const auto [x, y] = point;
    return std::pair{scales.x_at(x), scales.y_at(y)};
  };
  std::vector<std::pair<double, double>> rings;
  for (const FrontPoint& point : scatter.front) {
    rings.push_back(place(std::pair{point.x, point.y}));
  }
  if (!scatter.front.empty()) {
    svg += polyline("class=\"front\"", rings, [](const auto& ring) { return ring; });
  }
  for (std::size_t i = 0; i < scatter.clouds.size(); ++i) {
    const std::string fill = std::string("fill=\"") + kColors[i % kColors.size()] + "\"";
    if (scatter.clouds[i].joined) {
      svg += polyline("fill=\"none\" stroke=\"" + std::string(kColors[i % kColors.size()]) + "\"",
                      scatter.clouds[i].points, place);
    }
    for (const auto& [x, y] : scatter.clouds[i].points) {
      svg += circle(scales.x_at(x), scales.y_at(y), 4, fill);
    }
    const double column = axes.left + static_cast<double>(i % 4) * axes.width() / 4;
    const std::size_t legend_row = i / 4;
    const double row = legend + kLineHeight * static_cast<double>(legend_row);
    svg += circle(column + 5, row - 4, 4, fill) + label(column + 16, row, "start", scatter.clouds[i].name);
  }
  if (!scatter.front.empty()) {
    svg += label(axes.left, names + kLineHeight / 2, "start", scatter.front_name, " font-weight=\"bold\"");
  }
  Numbers numbers(rings);
  for (std::size_t i = 0; i < scatter.front.size(); ++i) {
    const auto& [x, y] = rings[i];
    svg += circle(x, y, 6, "class=\"ring\"");
    svg += numbers.label_at(x, y, std::to_string(i + 1));
    const std::size_t name_column = i / name_rows;
    const double column = axes.left + static_cast<double>(name_column) * axes.width() / 2;
    svg += label(column, names + kLineHeight * (static_cast<double>(i % name_rows) + 1.5), "start",
                 std::to_string(i + 1) + "  " + scatter.front[i].name, " font-size=\"11\"");
  }
  return svg + "</svg>\n";
}

std::string stacked(const std::vector<std::string>& plots) {
  std::string inner;
  double height = 0;
  for (const std::string& plot : plots) {
    const std::string box = "viewBox=\"0 0 " + number(kWidth) + " ";
    const std::size_t at = plot.find(box);
    const double own = std::strtod(plot.c_str() + at + box.size(), nullptr);
    inner += "<svg y=\"" + number(height) + "\" width=\"" + number(kWidth) + "\" height=\"" + number(own) +
             "\" " + plot.substr(at);
    height += own;
  }
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kWidth) + " " + number(height) +
         "\">\n" + inner + "</svg>\n";
}

std::string number(double value) {
  return fixed(value, 1);
}

std::string xml_text(const std::string& plain) {
  std::string text;
  for (const char c : utf8_text(plain, true)) {
    text += c == '&'   ? "&amp;"
            : c == '<' ? "&lt;"
            : c == '>' ? "&gt;"
            : c == '"' ? "&quot;"
                       : std::string(1, c);
  }
  return text;
}

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" +
         number(y2) + "\" class=\"" + kind + "\"/>\n";
}

std::string label(double x, double y, const char* anchor, const std::string& text, const std::string& more) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
         xml_text(text) + "</text>\n";
}

}  // namespace thimble::tools
