/// @file stopwatch.h
/// Times of a program on a machine that does other things too, and what many of them say.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_STOPWATCH_H
#define THIMBLE_TOOLS_INSTRUMENTS_STOPWATCH_H

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace thimble::tools {

/// Time of the processor that this program got since it was made: what else runs stays out of it.
class Stopwatch {
 public:
  double ms() const {
    return static_cast<double>(std::clock() - start_) * 1000 / static_cast<double>(CLOCKS_PER_SEC);
  }

 private:
  std::clock_t start_ = std::clock();
};

/// The value below which `part` (0..1) of them lie, between neighbours in proportion; at least one value.
inline double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  const double at = part * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (values[high] - values[low]) * (at - static_cast<double>(low));
}

}  // namespace thimble::tools

#endif
