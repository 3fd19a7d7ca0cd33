/// The largest error of each fixed-point operation of the core against exact arithmetic, found by sweeping
/// it, beside the bound that its public header names.
///
/// One entry an operation, in operation_errors.cpp; whoever adds an operation adds an entry. An error is that
/// of the operation on the very integers that it is given, not of what came before it.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "readers/progress.h"

namespace thimble::tools {

/// Random integers that are the same in every library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  /// low .. high, both included.
  std::int64_t from(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random_() % (static_cast<std::uint64_t>(high - low) + 1));
  }
  std::int32_t from32(std::int64_t low, std::int64_t high) {
    return static_cast<std::int32_t>(from(low, high));
  }
  std::int64_t sign() { return from(0, 1) == 0 ? -1 : 1; }
  /// With as many large as small ones: 1 .. 2^bits - 1.
  std::int32_t any_size(int bits) { return from32(1, (std::int64_t{1} << from(1, bits)) - 1); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }

 private:
  std::mt19937_64 random_;
};

struct OperationError {
  std::string operation;   ///< "camera, perspective ray"
  std::string bound_name;  ///< "kRayErrorPxQ16"
  std::string unit;        ///< of both numbers
  double error = 0;        ///< the largest seen
  double bound = 0;
  std::uint64_t cases = 0;
};

/// Sweeps all of them with about `cases` random cases each, or all there are where those are few. The same
/// seed gives the same figures everywhere but for the last digits of long double. `progress` (may be empty)
/// gets 0..1.
std::vector<OperationError> sweep_operations(std::uint64_t cases, std::uint64_t seed,
                                             const Progress& progress);

}  // namespace thimble::tools
