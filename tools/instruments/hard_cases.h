/// Near-degenerate rays through this tracer and through textbook traversals in floating point, all judged by
/// the exact reference: how many does each get wrong?
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "output/progress.h"
#include "output/tables.h"

namespace thimble::tools {

// The largest error of each fixed-point operation of the core against exact arithmetic, found by sweeping it, beside the
// bound that its public header names. One entry an operation, in operation_errors.cpp; whoever adds an operation adds an
// entry. An error is that of the operation on the very integers that it is given, not of what came before it.

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

/// The usual epsilons, in voxels.
inline constexpr double kFloatEpsilon = 1e-4;
inline constexpr double kDoubleEpsilon = 1e-6;

/// What is compared, in the columns' order. The first two are this tracer's.
inline constexpr std::size_t kTracers = 14;
struct TracerName {
  const char* key;         ///< for CSV and JSON: "walk_float_epsilon"
  const char* traversal;   ///< "grid walk"
  const char* arithmetic;  ///< "float"
  double epsilon;          ///< in voxels; 0: none
};
inline constexpr std::array<TracerName, kTracers> kTracerNames{{
    {"thimble_64", "thimble", "64 bits", 0},
    {"thimble_32", "thimble", "32 bits", 0},
    {"walk_float", "grid walk", "float", 0},
    {"walk_float_epsilon", "grid walk", "float", kFloatEpsilon},
    {"walk_double", "grid walk", "double", 0},
    {"walk_double_epsilon", "grid walk", "double", kDoubleEpsilon},
    {"points_float", "point steps", "float", 0},
    {"points_float_epsilon", "point steps", "float", kFloatEpsilon},
    {"points_double", "point steps", "double", 0},
    {"points_double_epsilon", "point steps", "double", kDoubleEpsilon},
    {"octree_float", "octree", "float", 0},
    {"octree_float_epsilon", "octree", "float", kFloatEpsilon},
    {"octree_double", "octree", "double", 0},
    {"octree_double_epsilon", "octree", "double", kDoubleEpsilon},
}};

struct HardCaseRow {
  std::string name;  ///< "through an edge"
  int level = 0;     ///< world of 2^level voxels a side
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;  ///< by the reference
  /// Rays for which the tracer gives another voxel, misses what is hit, or hits where nothing is.
  std::array<std::uint64_t, kTracers> wrong{};
  /// Of the others, those with another face; a ray that starts inside has none, whatever a tracer says.
  std::array<std::uint64_t, kTracers> wrong_face{};
};

/// Traces about `rays` rays, shared evenly among the named cases, in worlds of random voxels. The same seed
/// gives the same rays everywhere. 32-bit rays are those that the core's 32-bit path accepts; the others are
/// not counted against it. Takes about 15 microseconds a ray. `progress` (may be empty) gets 0..1.
std::vector<HardCaseRow> run_hard_cases(std::uint64_t rays, std::uint64_t seed, const Progress& progress);

// What `thimble accuracy --hard-cases` found, for people and for machines.

struct HardCaseStudy {
  std::vector<HardCaseRow> cases;
  std::vector<OperationError> operations;
};

/// A row a case and tracer, one a tracer over all cases, then one an operation; all with the same names.
JsonRow hard_case_objects(const HardCaseStudy& study);
/// Tables of at most 100 columns.
std::string hard_case_tables(const HardCaseStudy& study);
/// A sentence about what must not be, or nothing: a ray or a face that this tracer got wrong, an operation
/// beyond its bound.
std::string hard_case_fault(const HardCaseStudy& study);

}  // namespace thimble::tools
