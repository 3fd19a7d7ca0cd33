// Draws runs of boxes into a picture of the nearest box of each pixel.
#include "wide/raster/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/raster/kernels/boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/raster/kernels/runs-inl.h"

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(draw_run);
HWY_EXPORT(finish);
HWY_EXPORT(cull_run);

void draw_run(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  HWY_DYNAMIC_DISPATCH(draw_run)(frame, run, depths, batch);
}
void finish(const WideFrame& frame, const Depths& depths, Batch* batch) {
  HWY_DYNAMIC_DISPATCH(finish)(frame, depths, batch);
}
uint32_t cull_run(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch,
                  uint32_t* entries, uint32_t* numbers) {
  return HWY_DYNAMIC_DISPATCH(cull_run)(frame, run, depths, batch, entries, numbers);
}

}  // namespace thimble::wide
#endif
