// Finds the grey or face of each pixel from its nearest box; and holds what is done once for a block or a picture.
#include "wide/raster/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/raster/kernels/pixels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/raster/kernels/blocks-inl.h"
#include "wide/raster/kernels/colors-inl.h"
#include "wide/raster/kernels/covered-inl.h"
#include "wide/raster/kernels/finish-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

const char* instruction_set() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(find_children);
HWY_EXPORT(find_covered);
HWY_EXPORT(unpack);
HWY_EXPORT(find_grays);
HWY_EXPORT(put_colors);
HWY_EXPORT(put_touched);
HWY_EXPORT(merge_rows);
HWY_EXPORT(find_faces);
HWY_EXPORT(instruction_set);

int find_children(const WideFrame& frame, const Block& block, unsigned mask, uint32_t first_child,
                  unsigned nearest, Block* children) {
  return HWY_DYNAMIC_DISPATCH(find_children)(frame, block, mask, first_child, nearest, children);
}
int32_t find_covered(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels) {
  return HWY_DYNAMIC_DISPATCH(find_covered)(depths, left, row, end, pixels);
}
void unpack(const Depths& depths, Pixels* pixels) {
  HWY_DYNAMIC_DISPATCH(unpack)(depths, pixels);
}
void find_grays(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  HWY_DYNAMIC_DISPATCH(find_grays)(frame, pixels, scale, gray);
}
uint32_t put_colors(const Depths& depths, int32_t y, int32_t width_px, const CodeBytes& bytes, uint8_t* to) {
  return HWY_DYNAMIC_DISPATCH(put_colors)(depths, y, width_px, bytes, to);
}
uint32_t put_touched(const Depths& depths, int32_t width_px, const CodeBytes& bytes, uint8_t* to,
                     size_t stride) {
  return HWY_DYNAMIC_DISPATCH(put_touched)(depths, width_px, bytes, to, stride);
}
void merge_rows(const Depths& from, int32_t width_px, int32_t y0, int32_t y1, const Depths& to) {
  HWY_DYNAMIC_DISPATCH(merge_rows)(from, width_px, y0, y1, to);
}
void find_faces(const WideFrame& frame, const Pixels& pixels, uint8_t* face) {
  HWY_DYNAMIC_DISPATCH(find_faces)(frame, pixels, face);
}
const char* instruction_set() {
  return HWY_DYNAMIC_DISPATCH(instruction_set)();
}

int instruction_set_count() {
  hwy::SetSupportedTargetsForTest(0);
  return __builtin_popcountll(static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS));
}
void use_instruction_set(int number) {
  hwy::SetSupportedTargetsForTest(0);
  if (number >= 0) {
    uint64_t targets = static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS);
    for (; number > 0; --number) {
      targets &= targets - 1;
    }
    hwy::SetSupportedTargetsForTest(static_cast<int64_t>(targets & (0 - targets)));
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace thimble::wide
#endif
