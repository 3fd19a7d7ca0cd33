#include "output/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "output/svg.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

constexpr double kScatterWidth = 760;
constexpr double kScatterLeft = 72;
constexpr double kScatterRight = 24;
constexpr double kScatterTop = 52;
constexpr double kPlotHeight = 330;
constexpr double kLineHeight = 18;
constexpr double kPlotBottom = kScatterTop + kPlotHeight;
// Names in two columns where there are many.
constexpr std::size_t kManyNames = 8;

// A tick's value without what powers of ten leave behind.
std::string rounded(double value) {
  return shortest(std::round(value * 1e6) / 1e6);
}

std::string dot(double x, double y, double radius, const std::string& style) {
  return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"" + number(radius) + "\" " + style +
         "/>\n";
}

// Where the axes begin and end: x at a 1, 2 or 5 of a decade, y at multiples of `step`.
struct Scales {
  std::vector<double> x_ticks;
  double low = 0;
  double high = 1;
  double step = 1;

  explicit Scales(const std::vector<std::pair<double, double>>& points) {
    double x_low = 1;
    double x_high = 1;
    double y_low = 0;
    double y_high = 1;
    bool first_x = true;
    bool first_y = true;
    for (const auto& [x, y] : points) {
      x_low = first_x ? x : std::min(x_low, x);
      x_high = first_x ? x : std::max(x_high, x);
      first_x = false;
      if (std::isfinite(y)) {
        y_low = first_y ? y : std::min(y_low, y);
        y_high = first_y ? y : std::max(y_high, y);
        first_y = false;
      }
    }
    std::vector<double> marks;
    const int decade = static_cast<int>(std::floor(std::log10(x_low)));
    for (int power = decade; power <= decade + 12; ++power) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        marks.push_back(digit * std::pow(10.0, power));
      }
    }
    std::size_t begin = 0;
    while (begin + 2 < marks.size() && marks[begin + 1] <= x_low) {
      ++begin;
    }
    std::size_t end = begin + 1;
    while (end + 1 < marks.size() && marks[end] < x_high) {
      ++end;
    }
    x_ticks.assign(marks.begin() + static_cast<std::ptrdiff_t>(begin),
                   marks.begin() + static_cast<std::ptrdiff_t>(end) + 1);
    const double range = std::max(y_high - y_low, 1e-9);
    step = std::pow(10.0, std::floor(std::log10(range)));
    while (range / step < 4) {
      step /= 2;
    }
    low = std::floor(y_low / step) * step;
    high = (std::floor(y_high / step) + 1) * step;
  }
  double x_at(double x) const {
    return kScatterLeft + std::log(x / x_ticks.front()) / std::log(x_ticks.back() / x_ticks.front()) *
                              (kScatterWidth - kScatterLeft - kScatterRight);
  }
  double y_at(double y) const { return kPlotBottom - (std::min(y, high) - low) / (high - low) * kPlotHeight; }
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

std::string scatter_text(const Scatter& scatter) {
  // Okabe and Ito's colours, which stay apart for most kinds of colour vision and on both grounds, and a
  // grey.
  constexpr std::array<const char*, 8> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                               "#e69f00", "#56b4e9", "#8a8a8a", "#a0522d"};
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
  const double legend = kPlotBottom + 64;
  const double names = legend + kLineHeight * static_cast<double>(legend_rows) + 8;
  const double height =
      names + kLineHeight * static_cast<double>(scatter.front.empty() ? 0 : name_rows + 1) + 8;

  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kScatterWidth) + " " +
      number(height) +
      "\" font-family=\"sans-serif\" font-size=\"12\">\n<style>\n"
      ".ground { fill: #ffffff } text { fill: #222222 } .grid { stroke: #dddddd } .axis { stroke: #222222 } "
      ".front { fill: none; stroke: #222222; stroke-width: 1.5 } .ring { fill: none; stroke: #222222 }\n"
      "@media (prefers-color-scheme: dark) { .ground { fill: #15181c } text { fill: #e6e6e6 } .grid { "
      "stroke: "
      "#3a3f45 } .axis, .front, .ring { stroke: #e6e6e6 } }\n</style>\n<rect width=\"100%\" height=\"100%\" "
      "class=\"ground\"/>\n";
  svg += label(kScatterWidth / 2, 26, "middle", scatter.title, " font-size=\"15\"");
  for (const double tick : scales.x_ticks) {
    const double x = scales.x_at(tick);
    svg += line(x, kScatterTop, x, kPlotBottom, "grid") + label(x, kPlotBottom + 18, "middle", rounded(tick));
  }
  for (int i = 0; scales.low + i * scales.step <= scales.high + scales.step / 2; ++i) {
    const double value = scales.low + i * scales.step;
    const double y = scales.y_at(value);
    svg += line(kScatterLeft, y, kScatterWidth - kScatterRight, y, "grid") +
           label(kScatterLeft - 8, y + 4, "end", rounded(value));
  }
  svg += line(kScatterLeft, kScatterTop, kScatterLeft, kPlotBottom, "axis") +
         line(kScatterLeft, kPlotBottom, kScatterWidth - kScatterRight, kPlotBottom, "axis");
  if (infinite) {
    svg += label(kScatterLeft + 6, kScatterTop - 6, "start", scatter.infinite_name, " font-size=\"11\"");
  }
  svg +=
      label((kScatterLeft + kScatterWidth - kScatterRight) / 2, kPlotBottom + 40, "middle", scatter.x_label);
  const double middle = kScatterTop + kPlotHeight / 2;
  svg += label(20, middle, "middle", scatter.y_label, " transform=\"rotate(-90 20 " + number(middle) + ")\"");

  if (!scatter.front.empty()) {
    svg += "<polyline class=\"front\" points=\"";
    for (const FrontPoint& point : scatter.front) {
      svg += number(scales.x_at(point.x)) + "," + number(scales.y_at(point.y)) + " ";
    }
    svg += "\"/>\n";
  }
  for (std::size_t i = 0; i < scatter.clouds.size(); ++i) {
    const std::string fill = std::string("fill=\"") + kColors[i % kColors.size()] + "\"";
    if (scatter.clouds[i].joined) {
      svg += "<polyline fill=\"none\" stroke=\"" + std::string(kColors[i % kColors.size()]) + "\" points=\"";
      for (const auto& [x, y] : scatter.clouds[i].points) {
        svg += number(scales.x_at(x)) + "," + number(scales.y_at(y)) + " ";
      }
      svg += "\"/>\n";
    }
    for (const auto& [x, y] : scatter.clouds[i].points) {
      svg += dot(scales.x_at(x), scales.y_at(y), 4, fill);
    }
    const double column =
        kScatterLeft + static_cast<double>(i % 4) * (kScatterWidth - kScatterLeft - kScatterRight) / 4;
    const std::size_t legend_row = i / 4;
    const double row = legend + kLineHeight * static_cast<double>(legend_row);
    svg += dot(column + 5, row - 4, 4, fill) + label(column + 16, row, "start", scatter.clouds[i].name);
  }
  if (!scatter.front.empty()) {
    svg += label(kScatterLeft, names + kLineHeight / 2, "start", scatter.front_name, " font-weight=\"bold\"");
  }
  std::vector<std::pair<double, double>> rings;
  for (const FrontPoint& point : scatter.front) {
    rings.emplace_back(scales.x_at(point.x), scales.y_at(point.y));
  }
  Numbers numbers(rings);
  for (std::size_t i = 0; i < scatter.front.size(); ++i) {
    const FrontPoint& point = scatter.front[i];
    const double x = scales.x_at(point.x);
    const double y = scales.y_at(point.y);
    svg += dot(x, y, 6, "class=\"ring\"");
    svg += numbers.label_at(x, y, std::to_string(i + 1));
    const std::size_t name_column = i / name_rows;
    const double column =
        kScatterLeft + static_cast<double>(name_column) * (kScatterWidth - kScatterLeft - kScatterRight) / 2;
    svg += label(column, names + kLineHeight * (static_cast<double>(i % name_rows) + 1.5), "start",
                 std::to_string(i + 1) + "  " + point.name, " font-size=\"11\"");
  }
  return svg + "</svg>\n";
}

std::string stacked(const std::vector<std::string>& plots) {
  std::string inner;
  double height = 0;
  for (const std::string& plot : plots) {
    const std::string box = "viewBox=\"0 0 " + number(kScatterWidth) + " ";
    const std::size_t at = plot.find(box);
    const double own = std::strtod(plot.c_str() + at + box.size(), nullptr);
    inner += "<svg y=\"" + number(height) + "\" width=\"" + number(kScatterWidth) + "\" height=\"" +
             number(own) + "\" " + plot.substr(at);
    height += own;
  }
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kScatterWidth) + " " +
         number(height) + "\">\n" + inner + "</svg>\n";
}

}  // namespace thimble::tools
