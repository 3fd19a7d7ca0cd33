/// The queues: boxes wait to be paired with their pixels, and pairs wait for their test.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#endif

#include <type_traits>

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/open_pixels-inl.h"
#include "wide/raster/kernels/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Pairs some boxes with each of their pixels. Leaves out covered pixels as long as nothing was written into the picture
// meanwhile (`written`).
template <bool kPerspective, bool kUnit>
HWY_INLINE void pair_vector(const WideFrame& frame, const Depths& depths, hn::Mask<F32> live,
                            hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place, hn::Vec<U32> wide_x,
                            hn::Vec<U32> wide_y, bool* written, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Pairs& waiting = batch->waiting;
  const auto x = hn::And(place, hn::Set(du, 0xFFFFU));
  const auto y = hn::ShiftRight<16>(place);
  auto in_row = live;
  for (uint32_t down = 0; !hn::AllFalse(d, in_row); ++down) {
    auto in_column = in_row;
    auto open = hn::Set(du, UINT32_MAX);
    const bool rejects = batch->all_behind && !*written;
    if (rejects) {
      open = open_at(depths, in_row, x, hn::Add(y, hn::Set(du, down)), frame.tile.y0);
    }
    for (uint32_t across = 0; !hn::AllFalse(d, in_column); ++across) {
      auto chosen = in_column;
      if (rejects) {
        chosen = hn::And(chosen, hn::RebindMask(d, hn::TestBit(open, hn::Set(du, 1U << across))));
      }
      append(chosen, entry, number, hn::Add(place, hn::Set(du, down << 16 | across)), &waiting);
      if (waiting.count + lanes > Pairs::kSize) {
        test_waiting<kPerspective, kUnit>(frame, depths, written, batch);
      }
      in_column = hn::And(in_column, hn::RebindMask(d, hn::Gt(wide_x, hn::Set(du, across))));
    }
    in_row = hn::And(in_row, hn::RebindMask(d, hn::Gt(wide_y, hn::Set(du, down))));
  }
}

// Masks the coordinates of a picked pixel.
constexpr uint32_t kPlacePixels = ((1U << kPlaceBits) - 1) * 0x10001U;

// Pairs the boxes that were picked with their pixels.
template <bool kPerspective, bool kGray>
HWY_NOINLINE void pair_picked_of(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Picked& picked = batch->picked;
  Pairs& waiting = batch->waiting;
  const auto pixels = hn::Set(du, kPlacePixels);
  for (size_t at = 0; at < picked.count; at += lanes) {
    if (waiting.count + 4 * lanes > Pairs::kSize) {
      test_waiting<kPerspective, true>(frame, depths, written, batch);
    }
    const auto live = hn::FirstN(d, picked.count - at < lanes ? picked.count - at : lanes);
    const auto entry = hn::Load(du, picked.entry + at);
    const auto number = kGray ? hn::Zero(du) : hn::Load(du, picked.number + at);
    const auto packed = hn::Load(du, picked.place + at);
    const auto first = hn::And(packed, pixels);
    for (uint32_t pixel = 0; pixel < 4; ++pixel) {
      const uint32_t below = pixel >> 1;
      const uint32_t beside = pixel & 1U;
      const auto is_meant =
          hn::TestBit(packed, hn::Set(du, uint32_t{1} << (kPlaceBits + 16 * below + beside)));
      append<kGray>(hn::And(live, hn::RebindMask(d, is_meant)), entry, number,
                    hn::And(hn::Add(first, hn::Set(du, below << 16 | beside)), pixels), &waiting);
    }
  }
  picked.count = 0;
}

template <bool kPerspective>
void pair_picked(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  depths.gray_scale != nullptr ? pair_picked_of<kPerspective, true>(frame, depths, written, batch)
                               : pair_picked_of<kPerspective, false>(frame, depths, written, batch);
}

// Pairs the boxes that wait with their pixels.
template <bool kPerspective, bool kUnit>
HWY_NOINLINE void pair_boxes(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  if (batch->picked.count != 0) {
    pair_picked<kPerspective>(frame, depths, written, batch);
  }
  Boxes& boxes = batch->boxes;
  for (size_t at = 0; at < boxes.count; at += lanes) {
    const auto live = hn::FirstN(d, boxes.count - at < lanes ? boxes.count - at : lanes);
    const auto wide = hn::Load(du, boxes.wide + at);
    pair_vector<kPerspective, kUnit>(frame, depths, live, hn::Load(du, boxes.entry + at),
                                     hn::Load(du, boxes.number + at), hn::Load(du, boxes.place + at),
                                     hn::And(wide, hn::Set(du, 0xFFFFU)), hn::ShiftRight<16>(wide), written,
                                     batch);
  }
  boxes.count = 0;
  batch->all_behind = true;
}

// Boxes of at most so many pixels a side are paired; larger ones are drawn row by row. In sorted runs smaller boxes are
// drawn so, too: it pays that they cover their pixels at once.
constexpr float kMostQueued = 8;
constexpr float kMostQueuedSorted = 3;
// When so many boxes wait, they are drawn before the next run looks up open pixels.
constexpr size_t kMostBoxesWaiting = 128;

// Places on the picture as fixed-point numbers: a float to which kBase is added ends in 10 bits of the whole number and
// 12 bits of fraction.
struct FixedPoint {
  static constexpr int kFraction = 12;
  static constexpr int32_t kOne = 1 << kFraction;
  static constexpr double kBase = 3072;
  static constexpr int32_t kFirst = 0x45400000 >> kFraction;  // the whole number of the float 3072
  // A sum is within this of its exact value, as long as it is below 4096.
  static constexpr float kRounding = 1.0F / (1 << (kFraction + 1));
};

// Calls `fill`, with `first` and `second` as constants, for boxes 0 .. count - 1 of a run. `fill` gets the number of
// the next box and returns the number at which it ran out of room; `make_room` then makes room.
template <class Fill, class MakeRoom>
HWY_INLINE void in_rooms(uint32_t count, bool first, bool second, const Fill& fill,
                         const MakeRoom& make_room) {
  using Yes = std::true_type;
  using No = std::false_type;
  for (uint32_t at = 0; at < count;) {
    if (first) {
      at = second ? fill(Yes(), Yes(), at) : fill(Yes(), No(), at);
    } else {
      at = second ? fill(No(), Yes(), at) : fill(No(), No(), at);
    }
    if (at < count) {
      make_room();
    }
  }
}

// Pairs and tests all that waits. Unclear pairs may be left.
template <bool kPerspective, bool kUnit>
HWY_INLINE void test_boxes(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  pair_boxes<kPerspective, kUnit>(frame, depths, written, batch);
  test_waiting<kPerspective, kUnit>(frame, depths, written, batch);
}

// Appends the boxes of the lanes in `mask`. `wide_x`, `wide_y`: pixels beyond the first.
HWY_INLINE void append_boxes(hn::Mask<U32> mask, hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place,
                             hn::Vec<U32> wide_x, hn::Vec<U32> wide_y, Boxes* boxes) {
  const U32 d;
  const auto wide = hn::Or(hn::ShiftLeft<16>(wide_y), wide_x);
  hn::StoreU(squeeze(entry, mask), d, boxes->entry + boxes->count);
  hn::StoreU(squeeze(number, mask), d, boxes->number + boxes->count);
  hn::StoreU(squeeze(place, mask), d, boxes->place + boxes->count);
  hn::StoreU(squeeze(wide, mask), d, boxes->wide + boxes->count);
  boxes->count += hn::CountTrue(d, mask);
}

// Readies the batch for the run's cube; first draws what waits of another cube.
template <bool kPerspective, bool kUnit>
void enter_cube(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  if (batch->corner[0] == run.corner[0] && batch->corner[1] == run.corner[1] &&
      batch->corner[2] == run.corner[2]) {
    return;
  }
  bool written = false;
  test_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
  test_unclear(frame, depths, &written, batch);
  write_hits(depths, batch);
  // The constants hold the cube's corner and, for single voxels, the centre of a voxel.
  const float* const rows[3] = {frame.u, frame.v, frame.w};
  for (int i = 0; i < 3; ++i) {
    double sum = static_cast<double>(rows[i][3]);
    for (int axis = 0; axis < 3; ++axis) {
      sum += static_cast<double>(rows[i][axis]) * (run.corner[axis] + (kUnit ? 0.5 : 0.0));
    }
    batch->constant[i] = static_cast<float>(sum);
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    batch->corner[axis] = run.corner[axis];
  }
  for (unsigned down = 0; down < 8; ++down) {
    batch->cube_value[down] = cube_value(run.corner, down);
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
