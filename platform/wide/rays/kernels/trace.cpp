// Traces rays through the map, one in each lane. ../README.md derives why doubles find every cell.
#include "wide/rays/job.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/rays/kernels/trace.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/rays/kernels/walk-inl.h"

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(trace_job);

void trace_in_vectors(Job* job) {
  HWY_DYNAMIC_DISPATCH(trace_job)(job);
}

}  // namespace thimble::wide
#endif
