/// @file operation_errors.h
/// The largest error of each fixed-point operation of the core against exact arithmetic, found by sweeping
/// it, beside the bound that its public header names.
///
/// One entry an operation, in operation_errors.cpp; whoever adds an operation adds an entry. An error is that
/// of the operation on the very integers that it is given, not of what came before it.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_OPERATION_ERRORS_H
#define THIMBLE_TOOLS_INSTRUMENTS_OPERATION_ERRORS_H

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace thimble::tools {

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
                                             const std::function<void(double)>& progress);

}  // namespace thimble::tools

#endif
