#include "output/bars.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "output/svg.h"

namespace thimble::tools {
namespace {

constexpr double kBarsWidth = 760;
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
  std::array<char, 32> text{};
  const int digits = tick < 1 ? static_cast<int>(std::ceil(-std::log10(tick) - 1e-9)) : 0;
  std::snprintf(text.data(), text.size(), "%.*f", std::clamp(digits, 0, 9), value);
  return text.data();
}

}  // namespace

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
    return kBarsLeft +
           (value - first * tick) / ((last - first) * tick) * (kBarsWidth - kBarsLeft - kBarsRight);
  };
  const double bottom = kBarsTop + kStep * static_cast<double>(chart.bars.size());
  const double height = bottom + 52;
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kBarsWidth) + " " + number(height) +
      "\" font-family=\"sans-serif\" font-size=\"12\">\n<style>\n"
      ".ground { fill: #ffffff } text { fill: #222222 } .grid { stroke: #dddddd } .axis { stroke: #222222 } "
      ".bar { fill: #0072b2 }\n@media (prefers-color-scheme: dark) { .ground { fill: #15181c } text { fill: "
      "#e6e6e6 } .grid { stroke: #3a3f45 } .axis { stroke: #e6e6e6 } .bar { fill: #56b4e9 } }\n</style>\n"
      "<rect width=\"100%\" height=\"100%\" class=\"ground\"/>\n";
  svg += label(kBarsWidth / 2, 24, "middle", chart.title, " font-size=\"15\"");
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
  svg += label((kBarsLeft + kBarsWidth - kBarsRight) / 2, bottom + 38, "middle", chart.x_label);
  return svg + "</svg>\n";
}

}  // namespace thimble::tools
