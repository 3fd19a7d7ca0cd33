#include "wide/raster/sorted_run.h"

#include "wide/raster/exact.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::wide {
namespace {

// Entries begin .. end - 1 of a cube of 2^level voxels a side.
struct Part {
  uint32_t begin, end;
  int32_t level;
  uint32_t corner[3];
};

// The octant of a cube of 2^(level + 1) voxels a side that holds the entry.
unsigned octant_of(uint32_t entry, int32_t level) {
  return (x_of(entry) >> level & 1U) | (entry >> (10 + level) & 1U) << 1 | (entry >> (20 + level) & 1U) << 2;
}

// The octant of the part that is nearest to the eye.
unsigned nearest_octant(const Part& part, const int32_t (&eye_cell)[3]) {
  unsigned octant = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int32_t middle = static_cast<int32_t>(part.corner[axis] + (uint32_t{1} << (part.level - 1)));
    octant |= eye_cell[axis] >= middle ? 1U << axis : 0U;
  }
  return octant;
}

}  // namespace

bool SortedRun::cull_and_sort(const WideFrame& frame, const Block& block, const int32_t (&eye_cell)[3],
                              const Depths& depths, Batch* batch, Run* run) {
  run->count = cull_run(frame, *run, depths, batch, entries_, numbers_);
  if (run->count == 0) {
    return false;
  }
  sort(block, eye_cell, run->count);
  run->entries = sorted_entries_;
  run->numbers = sorted_numbers_;
  run->sorted = true;
  return true;
}

// In every block of the tree the entries of an octant stand together. So this takes the octants in the order of their
// distance from the eye, down to single entries.
void SortedRun::sort(const Block& block, const int32_t (&eye_cell)[3], uint32_t count) {
  Part stack[7 * kCubeLevel + 8];
  int depth = 0;
  uint32_t written = 0;
  stack[depth++] = {0, count, block.level, {block.corner[0], block.corner[1], block.corner[2]}};
  while (depth > 0) {
    const Part part = stack[--depth];
    if (part.end - part.begin == 1 || part.level == 0) {
      for (uint32_t i = part.begin; i < part.end; ++i) {
        sorted_entries_[written] = entries_[i];
        sorted_numbers_[written] = numbers_[i];
        ++written;
      }
      continue;
    }
    const int32_t level = part.level - 1;
    const unsigned nearest = nearest_octant(part, eye_cell);
    uint32_t begin[9] = {};
    uint32_t at = part.begin;
    for (unsigned octant = 0; octant < 8; ++octant) {
      begin[octant] = at;
      while (at < part.end && octant_of(entries_[at], level) == octant) {
        ++at;
      }
    }
    begin[8] = at;
    for (unsigned turn = 8; turn-- > 0;) {
      const unsigned octant = turn ^ nearest;
      if (begin[octant] == begin[octant + 1]) {
        continue;
      }
      Part child{begin[octant], begin[octant + 1], level, {0, 0, 0}};
      for (unsigned axis = 0; axis < 3; ++axis) {
        child.corner[axis] = part.corner[axis] + ((octant >> axis & 1U) << level);
      }
      stack[depth++] = child;
    }
  }
}

}  // namespace thimble::wide
