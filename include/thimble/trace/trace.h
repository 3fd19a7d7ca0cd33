/// @file trace.h
/// The first solid voxel along a ray: exact, in integers, for each of the four structures.
///
/// Every function here gives the answer that ray.h defines, whatever structure and arithmetic width it uses.
/// There is no epsilon, no division and no rounding in it.
///
/// Stack: one entry a level, see tests/budgets/stack.csv for the bytes computed by the compiler. Reentrant:
/// nothing is written but the result, so any number of rays may be traced at once, in interrupts too, as long
/// as nobody changes the structure.
#ifndef THIMBLE_TRACE_TRACE_H
#define THIMBLE_TRACE_TRACE_H

#include <stdint.h>

#include "../base/status.h"
#include "../tree/compact_tree.h"
#include "../tree/dense_grid.h"
#include "../tree/octree.h"
#include "../tree/shared_tree.h"
#include "ray.h"

namespace thimble {

/// The arithmetic a ray is traced with. It never changes an answer.
enum class Width : uint8_t {
  kAuto,  ///< 32 bits where the target's registers have 32 and the ray allows it, else 64
  k32,    ///< 32-bit products only; rays for which `accepts_32` is false are refused
  k64,    ///< all that `check_ray` accepts; largest intermediate below 2^44
};

struct TraceOptions {
  /// The ray is stopped with HitKind::kStepLimit instead of visiting one more node than this.
  uint32_t max_visits = UINT32_MAX;
  Width width = Width::kAuto;
};

/// Whether the 32-bit path may trace `ray` in a world of 2^level: with R the largest distance on any axis
/// from the origin to a plane of the world (in 1/256 voxel) and D the largest direction component, the bits
/// of R and of D are at most 31 together, so that every product of the two stays below 2^31. A world of 64
/// seen from within two world sizes takes directions of 16 bits, one of 512 takes 13. For rays that pass
/// `check_ray` in that world, and levels 1 .. kMaxLevel; it asks neither.
bool accepts_32(const Ray& ray, int level);

/// The solid voxel entered first. `hit` is always written on `kOk`; `kOutOfRange` and `kBadArgument` are
/// those of `check_ray` (and of `accepts_32` for Width::k32), `hit` then being untouched. A ray that misses
/// the box of what is occupied visits no node. Cost: a few hundred to some thousand instructions,
/// `hit->visits` nodes.
Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
/// The visits are those in the compact tree that it was made from. Materials, where there are several, take
/// another way down to the voxel.
Status closest_hit(const SharedTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
/// In a dense grid a visit is a cell looked at.
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options = {});

/// The same with Width::k32 and nothing of the 64-bit path behind it: a firmware that traces only so has
/// neither its code nor its stack.
Status closest_hit_32(const CompactTree& tree, const Ray& ray, Hit* hit, uint32_t max_visits = UINT32_MAX);

/// Whether there is a hit at all: `kind` gets what `closest_hit` would find, `visits` (may be null) the nodes
/// read, without the work of naming the voxel, its face and its t.
Status any_hit(const CompactTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const Octree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const SharedTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const DenseGrid& grid, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});

}  // namespace thimble

#endif
