/// Tests pairs of a box and a pixel: does the ray hit the box? Writes hits into the picture where they are nearer than what
/// it holds.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_PAIRS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_PAIRS_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_PAIRS_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_PAIRS_INL_H_
#endif

#include "wide/raster/exact.h"
#include "wide/raster/hidden_voxels.h"
#include "wide/raster/kernels.h"
#include "wide/raster/kernels/judge-inl.h"
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

// Appends the pairs of the lanes in `mask`; with kGray, without the entries' numbers, which greys do not need.
template <bool kGray = false>
HWY_INLINE void append(hn::Mask<F32> mask, hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place,
                       Pairs* pairs) {
  const U32 d;
  const auto chosen = hn::RebindMask(d, mask);
  hn::StoreU(squeeze(entry, chosen), d, pairs->entry + pairs->count);
  if (!kGray) {
    hn::StoreU(squeeze(number, chosen), d, pairs->number + pairs->count);
  }
  hn::StoreU(squeeze(place, chosen), d, pairs->place + pairs->count);
  pairs->count += hn::CountTrue(d, chosen);
}

// Finds the corner of the batch's cube less the eye, in 1/512 voxel.
inline void origin_of(const WideFrame& frame, const Batch& batch, float (&origin)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis] = static_cast<float>(int64_t{512} * batch.corner[axis] - int64_t{2} * frame.eye[axis]);
  }
}

// Tests in integers the pairs that floats could not decide.
void test_unclear(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  Pairs& pairs = batch->unclear;
  batch->counts.exact += pairs.count;
  for (size_t i = 0; i < pairs.count; ++i) {
    const int32_t x = static_cast<int32_t>(pairs.place[i] & 0xFFFFU);
    const int32_t y = static_cast<int32_t>(pairs.place[i] >> 16);
    uint32_t key = 0;
    uint32_t down = 0;
    const Meeting meeting = meet_exactly(frame, x, y, pairs.entry[i], batch->corner, &key, &down);
    if (meeting == Meeting::kTouch && frame.hidden_in != nullptr) {
      ask_core_behind(frame, depths, x, y, pairs.entry[i], key, down, batch);
    }
    if (meeting != Meeting::kHit) {
      continue;
    }
    if (batch->hits >= Pairs::kSize) {
      write_hits(depths, batch);
      *written = true;
    }
    batch->key[batch->hits] = key;
    batch->down[batch->hits] = down;
    batch->number[batch->hits] = pairs.number[i];
    if (depths.gray_scale != nullptr) {
      batch->key[batch->hits] = mirrored_sum(pairs.entry[i], batch->corner, down);
      batch->number[batch->hits] = code_exactly(*frame.camera, *depths.shading, depths.gray_scale->code, x, y,
                                                pairs.entry[i], batch->corner);
    }
    batch->pixel[batch->hits] =
        static_cast<uint32_t>(32 * depths.word(x, y) + (static_cast<uint32_t>(x) & 31U));
    ++batch->hits;
  }
  pairs.count = 0;
}

// A vector of pairs, unpacked.
template <bool kUnit>
struct Unpacked {
  hn::Vec<U32> entry, x, y, level;
  hn::Vec<U32> low[3];
  hn::Vec<F32> half;

  Unpacked(const Pairs& pairs, size_t at) {
    const F32 d;
    const I32 di;
    const U32 du;
    const auto place = hn::Load(du, pairs.place + at);
    x = hn::And(place, hn::Set(du, 0xFFFFU));
    y = hn::ShiftRight<16>(place);
    entry = hn::Load(du, pairs.entry + at);
    unpack_side(du, entry, kUnit, &level, &low[0]);
    half = kUnit ? hn::Set(d, 256.0F) : hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 256U), level)));
    low[1] = hn::And(hn::ShiftRight<10>(entry), hn::Set(du, kWithin));
    low[2] = hn::And(hn::ShiftRight<20>(entry), hn::Set(du, kWithin));
  }

  template <bool kPerspective>
  HWY_INLINE Aims aims(const WideFrame& frame, const float (&origin)[3]) const {
    const auto real = [](hn::Vec<U32> v) { return hn::ConvertTo(F32(), hn::BitCast(I32(), v)); };
    const hn::Vec<F32> corner[3] = {real(low[0]), real(low[1]), real(low[2])};
    return aims_of<kPerspective>(frame, origin, real(x), real(y), corner, half);
  }
};

// Appends the pairs in `hit` to the batch's hits, with keys mirrored by the signs of the directions.
// `number`: the entries' numbers, or greys.
template <bool kUnit, bool kGray>
HWY_INLINE void append_hits(hn::Mask<F32> hit, const Unpacked<kUnit>& pairs, const Aims& aims,
                            hn::Vec<U32> number, const Depths& depths, bool* written, Batch* batch) {
  const F32 d;
  const I32 di;
  const U32 du;
  const auto within = hn::Set(du, kWithin);
  if (batch->hits + hn::Lanes(d) > Pairs::kSize) {
    write_hits(depths, batch);
    *written = true;
  }
  auto key = hn::Zero(du);
  [[maybe_unused]] auto down = hn::Zero(du);
#pragma GCC unroll 3
  for (int axis = 2; axis >= 0; --axis) {
    const auto is_down = hn::RebindMask(du, hn::Lt(aims.direction[axis], hn::Zero(d)));
    if (kGray) {
      const auto place = hn::Or(pairs.low[axis], hn::Set(du, batch->corner[axis]));
      key = hn::Add(key, hn::Xor(place, hn::IfThenElseZero(is_down, hn::Set(du, kMirror))));
      continue;
    }
    auto mirrored = hn::Xor(pairs.low[axis], hn::IfThenElseZero(is_down, within));
    if (!kUnit) {
      const auto side_mask = hn::Neg(hn::BitCast(di, hn::Shl(hn::Set(du, 1U), pairs.level)));
      mirrored = hn::And(mirrored, hn::BitCast(du, side_mask));
    }
    key = hn::Or(hn::ShiftLeft<1>(key), spread10(mirrored));
    down = hn::Or(hn::ShiftLeft<1>(down), hn::IfThenElseZero(is_down, hn::Set(du, 1U)));
  }
  const auto pixel =
      hn::Or(hn::ShiftLeft<5>(word_of(depths, pairs.x, pairs.y)), hn::And(pairs.x, hn::Set(du, 31U)));
  const auto chosen = hn::RebindMask(du, hit);
  hn::StoreU(squeeze(key, chosen), du, batch->key + batch->hits);
  if (!kGray) {
    hn::StoreU(squeeze(down, chosen), du, batch->down + batch->hits);
  }
  hn::StoreU(squeeze(number, chosen), du, batch->number + batch->hits);
  hn::StoreU(squeeze(pixel, chosen), du, batch->pixel + batch->hits);
  batch->hits += hn::CountTrue(du, chosen);
}

// Remembers which lanes of each vector of pairs floats could not decide. These pairs are put aside after all vectors
// have been tested: a branch in each vector would be mispredicted now and then, just where much waits for it.
class Unclear {
 public:
  HWY_INLINE void set(size_t vector, hn::Mask<F32> lanes) { lanes_[vector] = bits_of(F32(), lanes); }
  void put_aside(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) const {
    const size_t lanes = hn::Lanes(F32());
    const Pairs& pairs = batch->waiting;
    Pairs& unclear = batch->unclear;
    for (size_t at = 0; at < pairs.count; at += lanes) {
      for (uint32_t bits = lanes_[at / lanes]; bits != 0; bits &= bits - 1) {
        const size_t pair = at + static_cast<size_t>(__builtin_ctz(bits));
        unclear.entry[unclear.count] = pairs.entry[pair];
        unclear.number[unclear.count] = pairs.number[pair];
        unclear.place[unclear.count] = pairs.place[pair];
        if (++unclear.count == Pairs::kSize) {
          test_unclear(frame, depths, written, batch);
        }
      }
    }
  }

 private:
  uint32_t lanes_[Pairs::kSize];
};

// Tests the waiting pairs in floats, and puts aside those that floats do not decide. Sets `written` when something was
// written into the picture. Greys are found for pairs that are missed, too.
template <bool kPerspective, bool kUnit, Keep kKeep>
HWY_NOINLINE void test_waiting_of(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  constexpr bool kGray = kKeep != Keep::kNumbers;
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Pairs& pairs = batch->waiting;
  batch->counts.candidates += pairs.count;
  float origin[3];
  origin_of(frame, *batch, origin);
  Unclear all_unclear;
  for (size_t at = 0; at < pairs.count; at += lanes) {
    const auto live = hn::FirstN(d, pairs.count - at < lanes ? pairs.count - at : lanes);
    const Unpacked<kUnit> unpacked(pairs, at);
    const Aims aims = unpacked.template aims<kPerspective>(frame, origin);
    const Verdict verdict = judge<kPerspective>(frame, aims, unpacked.half);
    auto unclear = hn::Or(aims.unclear, verdict.unclear);
    const auto hit = hn::And(live, verdict.hit);
    hn::Vec<U32> number;
    if (kGray) {
      auto no_gray = hn::Lt(hn::Zero(d), hn::Zero(d));
      number = codes_of<kPerspective, kKeep>(frame, *depths.gray_scale, aims, &no_gray);
      unclear = hn::Or(unclear, hn::And(no_gray, hit));
    } else {
      number = hn::Load(du, pairs.number + at);
    }
    all_unclear.set(at / lanes, hn::And(unclear, live));
    append_hits<kUnit, kGray>(hn::AndNot(unclear, hit), unpacked, aims, number, depths, written, batch);
  }
  all_unclear.put_aside(frame, depths, written, batch);
  pairs.count = 0;
}

template <bool kPerspective, bool kUnit>
HWY_INLINE void test_waiting(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  if (depths.gray_scale == nullptr) {
    test_waiting_of<kPerspective, kUnit, Keep::kNumbers>(frame, depths, written, batch);
  } else if (depths.gray_scale->code == GrayScale::Code::kGray) {  // all boxes are single voxels
    test_waiting_of<kPerspective, true, Keep::kGrays>(frame, depths, written, batch);
  } else {
    test_waiting_of<kPerspective, true, Keep::kFaces>(frame, depths, written, batch);
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
