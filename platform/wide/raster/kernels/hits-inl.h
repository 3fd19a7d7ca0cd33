/// Writes hits into the picture where they are nearer than what it holds.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_HITS_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_HITS_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_HITS_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// The value in Depths::nearest of an entry of the batch's cube.
inline uint64_t value_of(const Batch& batch, uint32_t key, uint32_t down, uint32_t number) {
  return batch.cube_value[down] | uint64_t{key} << kEntryBits | number;
}

// Clears the codes of a piece of the picture that is written for the first time.
HWY_INLINE void touch(const Depths& depths, size_t piece) {
  if (depths.is_touched[piece] == 0) {
    depths.is_touched[piece] = 1;
    depths.touched[++depths.touched[0]] = static_cast<uint32_t>(piece);
    __builtin_memset(depths.gray + 32 * kPieceWords * piece, 0, 32 * kPieceWords);
  }
}

// Clears the pieces that hold any of these pixels.
inline void touch_all(const Depths& depths, const Rectangle& where) {
  for (int32_t left = where.x0 & -32; left < where.x1; left += 32) {
    const size_t last = depths.word(left, where.y1 - 1) / kPieceWords;
    for (size_t piece = depths.word(left, where.y0) / kPieceWords; piece <= last; ++piece) {
      touch(depths, piece);
    }
  }
}

// Writes the hits of the batch into the picture.
template <bool kGray, bool kMarks>
HWY_INLINE void write_hits_of(const Depths& depths, Batch* batch) {
  // Pointers are copied to locals: the compiler must assume that a byte that is written changes the members.
  const size_t hits = batch->hits;
  uint32_t* const all_covered = depths.covered;
  uint64_t* const all_nearest = depths.nearest;
  uint16_t* const all_sums = depths.nearest_sum;
  uint8_t* const all_grays = depths.gray;
  // Behind the last hit there is room to read on.
  constexpr size_t kAhead = 32;
  static_assert(kAhead <= Pairs::kRoom - Pairs::kSize);
  for (size_t i = hits; i < hits + kAhead; ++i) {
    batch->pixel[i] = 0;
  }
  for (size_t i = 0; i < hits; ++i) {
    const uint32_t pixel = batch->pixel[i];
    const uint32_t ahead = batch->pixel[i + kAhead];
    const uint32_t bit = uint32_t{1} << (pixel & 31U);
    // No branch: where the picture holds nothing yet, what is read is made the greatest number.
    if (kGray) {
      __builtin_prefetch(all_sums + ahead, 1);
      __builtin_prefetch(all_grays + ahead, 1);
      const uint32_t gray = all_grays[pixel];
      const uint32_t sum = batch->key[i];
      const uint32_t before = all_sums[pixel] | (gray - 1) >> 16;
      const uint32_t is_less = 0 - ((sum - before) >> 31);
      all_grays[pixel] = static_cast<uint8_t>(gray ^ ((batch->number[i] ^ gray) & is_less));
      all_sums[pixel] = static_cast<uint16_t>(before ^ ((sum ^ before) & is_less));
    } else {
      __builtin_prefetch(all_nearest + ahead, 1);
      const uint64_t value = value_of(*batch, batch->key[i], batch->down[i], batch->number[i]);
      const uint64_t nothing = uint64_t{all_covered[pixel >> 5] >> (pixel & 31U) & 1U} - 1;
      const uint64_t before = all_nearest[pixel] | nothing;
      all_nearest[pixel] = value < before ? value : before;
    }
    if (kMarks) {
      all_covered[pixel >> 5] |= bit;
    }
  }
  batch->counts.hits += hits;
  batch->hits = 0;
}

HWY_NOINLINE void write_hits(const Depths& depths, Batch* batch) {
  if (batch->hits == 0) {
    return;
  }
  if (depths.gray_scale == nullptr) {
    write_hits_of<false, true>(depths, batch);
  } else if (depths.marks) {
    write_hits_of<true, true>(depths, batch);
  } else {
    for (size_t i = 0; depths.is_touched != nullptr && i < batch->hits; ++i) {
      touch(depths, batch->pixel[i] / (32 * kPieceWords));
    }
    write_hits_of<true, false>(depths, batch);
  }
}

// Depths::word, one pixel a lane.
HWY_INLINE hn::Vec<U32> word_of(const Depths& depths, hn::Vec<U32> x, hn::Vec<U32> y) {
  const U32 d;
  const auto row = hn::Sub(y, hn::Set(d, static_cast<uint32_t>(depths.first_row)));
  return hn::Add(hn::Mul(hn::ShiftRight<5>(x), hn::Set(d, static_cast<uint32_t>(depths.rows))), row);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
