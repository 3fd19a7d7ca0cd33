/// What the programs that measure share: clocks, the median of many times, a main() that names its errors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <exception>
#include <vector>

namespace thimble::benchmarks {

inline double seconds_on(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
/// Processor time of this thread: libraries keep idle ones.
inline constexpr clockid_t kThreadClock = CLOCK_THREAD_CPUTIME_ID;
/// Processor time of the whole program.
inline constexpr clockid_t kProgramClock = CLOCK_PROCESS_CPUTIME_ID;
/// The clock on the wall.
inline constexpr clockid_t kWallClock = CLOCK_MONOTONIC;

/// Seconds that `work` takes.
template <class Work>
double seconds_of(const Work& work, clockid_t clock = kThreadClock) {
  const double start = seconds_on(clock);
  work();
  return seconds_on(clock) - start;
}

/// The middle one, or the upper of two.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// main() of the program of that name: what `run` returns, or 1 and a sentence.
template <class Run>
int run_program(const char* name, const Run& run) {
  try {
    return run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace thimble::benchmarks
