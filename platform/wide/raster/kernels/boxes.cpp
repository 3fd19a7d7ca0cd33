// Draws runs of boxes into a picture of the nearest box of each pixel: in no order, from front to back, or only culls them.
#include "wide/raster/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/raster/kernels/boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/raster/kernels/large-inl.h"
#include "wide/raster/kernels/pick-inl.h"
#include "wide/raster/kernels/short-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Draws a run in no order. Boxes wait in the batch until there are enough to fill vectors.
//
// As long as only whole runs wait, all that is in the picture when they are paired lies before them, so covered pixels
// can be left out. Where part of a run was drawn already, `all_behind` is cleared.
template <bool kPerspective, bool kUnit>
void draw_run_of(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const F32 d;
  const U32 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  if (kUnit && run.behind && pick_boxes<kPerspective>(frame, run, depths, batch)) {
    return;
  }
  Boxes& queue = batch->boxes;
  bool written = false;
  if (run.behind) {
    // Draws what waits first, so that its pixels are known to be covered.
    if (queue.count >= kMostBoxesWaiting || batch->picked.count != 0) {
      test_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
    }
    write_hits(depths, batch);
    written = false;
  }
  batch->counts.boxes += run.count;
  const Rectangle clip = run.behind ? open_bounds(depths, run.place.where) : run.place.where;
  if (clip.x0 >= clip.x1) {
    return;
  }
  const Reach reach(frame, clip);
  const auto most = hn::Set(d, kMostQueued - 1);
  bool cut = false;
  for (uint32_t at = 0; at < run.count; at += lanes) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    auto seen = boxes.seen;
    const auto widest = hn::Max(boxes.wide_x, boxes.wide_y);
    auto large = hn::And(seen, hn::Gt(widest, most));
    if (kPerspective) {
      large = hn::Or(large, boxes.crossing);
    }
    if (!hn::AllFalse(d, large)) {
      pair_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
      draw_large_of<kPerspective>(frame, run, at, boxes, large, false, &written, depths, batch);
      cut = true;
      seen = hn::AndNot(large, seen);
    }
    const auto x = small_number(boxes.low_x);
    const auto y = small_number(boxes.low_y);
    const auto place = hn::Or(hn::ShiftLeft<16>(y), x);
    if (kUnit && !run.behind) {
      // A box of one pixel is already a pair.
      Pairs& waiting = batch->waiting;
      append(hn::And(seen, hn::Lt(widest, hn::Set(d, 1.0F))), boxes.entry, hn::Iota(du, run.first + at),
             place, &waiting);
      if (waiting.count + lanes > Pairs::kSize) {
        test_waiting<kPerspective, kUnit>(frame, depths, &written, batch);
      }
      seen = hn::And(seen, hn::Ge(widest, hn::Set(d, 1.0F)));
      if (hn::AllFalse(d, seen)) {
        continue;
      }
    }
    // No branch on whether any box is left: it would be mispredicted in every third vector.
    append_boxes(hn::RebindMask(du, seen), boxes.entry, hn::Iota(du, run.first + at), place,
                 small_number(boxes.wide_x), small_number(boxes.wide_y), &queue);
    batch->all_behind = batch->all_behind && run.behind && !cut;
    if (queue.count + lanes > Boxes::kSize) {
      pair_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
      cut = true;
    }
  }
}

// Draws a run from front to back: all that is in the picture lies in front of what follows. So no pair waits, and each box
// covers its pixels at once.
template <bool kPerspective, bool kUnit>
void draw_sorted_of(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const F32 d;
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  bool written = false;
  test_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
  write_hits(depths, batch);
  batch->counts.boxes += run.count;
  const Rectangle clip = open_bounds(depths, run.place.where);
  const Reach reach(frame, clip);
  for (uint32_t at = 0; at < run.count; at += static_cast<uint32_t>(hn::Lanes(d))) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    const auto seen = kPerspective ? hn::Or(boxes.crossing, boxes.seen) : boxes.seen;
    draw_large_of<kPerspective>(frame, run, at, boxes, seen, true, &written, depths, batch);
  }
}

// Finds which boxes of the run may be seen at open pixels, in the order of the run: their entries and numbers.
template <bool kPerspective, bool kUnit>
uint32_t cull_run_of(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch,
                     uint32_t* entries, uint32_t* numbers) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  bool written = false;
  test_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
  write_hits(depths, batch);
  batch->counts.boxes += run.count;
  const Rectangle clip = open_bounds(depths, run.place.where);
  const Reach reach(frame, clip);
  uint32_t count = 0;
  for (uint32_t at = 0; at < run.count; at += static_cast<uint32_t>(lanes)) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    // Keeps wider or taller boxes without looking at pixels.
    const auto most = hn::Set(d, 24.0F);
    auto chosen = hn::And(boxes.seen, hn::Or(hn::Gt(boxes.wide_x, most), hn::Gt(boxes.wide_y, most)));
    if (kPerspective) {
      chosen = hn::Or(chosen, boxes.crossing);
    }
    auto in_row = hn::AndNot(chosen, boxes.seen);
    const auto int_x = hn::BitCast(du, hn::ConvertTo(di, boxes.low_x));
    const auto int_y = hn::BitCast(du, hn::ConvertTo(di, boxes.low_y));
    for (uint32_t down = 0; !hn::AllFalse(d, in_row); ++down) {
      const auto open = open_at(depths, in_row, int_x, hn::Add(int_y, hn::Set(du, down)), frame.tile.y0);
      const auto found = hn::And(in_row, any_open(open, boxes.wide_x));
      chosen = hn::Or(chosen, found);
      in_row = hn::AndNot(found, hn::And(in_row, hn::Gt(boxes.wide_y, hn::Set(d, static_cast<float>(down)))));
    }
    const auto chosen_u = hn::RebindMask(du, chosen);
    hn::StoreU(squeeze(boxes.entry, chosen_u), du, entries + count);
    hn::StoreU(squeeze(hn::Iota(du, run.first + at), chosen_u), du, numbers + count);
    count += static_cast<uint32_t>(hn::CountTrue(du, chosen_u));
  }
  return count;
}

uint32_t cull_run(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch,
                  uint32_t* entries, uint32_t* numbers) {
  return with_constants(frame.perspective, run.unit, [&](auto perspective, auto unit) {
    return cull_run_of<perspective.value, unit.value>(frame, run, depths, batch, entries, numbers);
  });
}

void draw_run(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  with_constants(frame.perspective, run.unit, [&](auto perspective, auto unit) {
    run.sorted ? draw_sorted_of<perspective.value, unit.value>(frame, run, depths, batch)
               : draw_run_of<perspective.value, unit.value>(frame, run, depths, batch);
  });
}

void finish(const WideFrame& frame, const Depths& depths, Batch* batch) {
  bool written = false;
  if (frame.perspective) {
    test_boxes<true, false>(frame, depths, &written, batch);
  } else {
    test_boxes<false, false>(frame, depths, &written, batch);
  }
  test_unclear(frame, depths, &written, batch);
  write_hits(depths, batch);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

THIMBLE_KERNEL(draw_run);
THIMBLE_KERNEL(draw_short_run);
THIMBLE_KERNEL(widen);
THIMBLE_KERNEL(finish);
THIMBLE_KERNEL(cull_run);

}  // namespace thimble::wide
#endif
