/// Reads the finished picture: which pixels are covered, and what they hold. Merges two pictures.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_COVERED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_COVERED_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_COVERED_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_COVERED_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Stores the numbers of a word's set bits, each plus `first`, in `to`, which has room for 48. Returns how many bits are
// set.
HWY_INLINE uint32_t store_bits(uint32_t word, uint32_t first, uint32_t* to) {
  const U32 d;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  uint32_t count = 0;
  if (lanes < 8) {
    for (uint32_t bits = word; bits != 0; bits &= bits - 1) {
      to[count++] = first + static_cast<uint32_t>(__builtin_ctz(bits));
    }
    return count;
  }
  // No branch for each bit: how many are set cannot be predicted.
  uint8_t bytes[8] = {};
  __builtin_memcpy(bytes, &word, sizeof(word));
  for (uint32_t part = 0; part < 32; part += lanes) {
    const auto mask = hn::LoadMaskBits(d, bytes + part / 8);
    hn::StoreU(squeeze(hn::Iota(d, first + part), mask), d, to + count);
    count += static_cast<uint32_t>(hn::CountTrue(d, mask));
  }
  return count;
}

int32_t find_covered(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels) {
  const U32 d;
  const I32 di;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const uint32_t before = pixels->count;
  uint32_t count = before;
  const uint32_t first_word = static_cast<uint32_t>(depths.word(left, depths.first_row));
  while (row < end && count <= kMostPixels - 32) {
    const uint32_t word = static_cast<uint32_t>(depths.word(left, row));
    const int32_t rows = end - row < lanes ? end - row : lanes;
    const auto some = load_some(depths.covered + word, rows);
    int32_t next = row + rows;
    for (uint32_t bits = bits_of(d, hn::Ne(some, hn::Zero(d))); bits != 0; bits &= bits - 1) {
      const uint32_t r = static_cast<uint32_t>(__builtin_ctz(bits));
      if (count > kMostPixels - 32) {
        next = row + static_cast<int32_t>(r);
        break;
      }
      count += store_bits(depths.covered[word + r], 32 * (word + r), pixels->at + count);
    }
    row = next;
  }
  for (uint32_t i = before; i < count; i += static_cast<uint32_t>(lanes)) {
    const auto at = hn::LoadU(d, pixels->at + i);
    const auto x = hn::Add(hn::And(at, hn::Set(d, 31U)), hn::Set(d, static_cast<uint32_t>(left)));
    const auto y =
        hn::Sub(hn::ShiftRight<5>(at), hn::Set(d, first_word - static_cast<uint32_t>(depths.first_row)));
    hn::StoreU(hn::BitCast(di, x), di, pixels->x + i);
    hn::StoreU(hn::BitCast(di, y), di, pixels->y + i);
  }
  pixels->count = count;
  return row;
}

void unpack(const Depths& depths, Pixels* pixels) {
  const U64 d;
  const HalfU32 d32;
  const uint32_t count = pixels->count;
  for (uint32_t i = count; i < count + hn::Lanes(U32()); ++i) {
    pixels->at[i] = pixels->at[0];
    pixels->x[i] = 0;
    pixels->y[i] = 0;
  }
  for (uint32_t i = 0; i < count + hn::Lanes(U32()); ++i) {
    pixels->value[i] = depths.nearest[pixels->at[i]];
  }
  for (uint32_t at = 0; at < count; at += static_cast<uint32_t>(hn::Lanes(d))) {
    const auto value = hn::LoadU(d, pixels->value + at);
    hn::StoreU(hn::TruncateTo(d32, hn::And(value, hn::Set(d, (uint64_t{1} << kEntryBits) - 1))), d32,
               pixels->number + at);
    const auto key = hn::And(hn::ShiftRight<kEntryBits>(value), hn::Set(d, 0x3FFFFFFFU));
    hn::StoreU(hn::TruncateTo(d32, key), d32, pixels->key + at);
    hn::StoreU(hn::TruncateTo(d32, hn::ShiftRight<kEntryBits + 30>(value)), d32, pixels->cube + at);
  }
}

// Merges the pixels of one word of coverage.
void merge_word(const Depths& from, size_t word, const Depths& to) {
  for (uint32_t bits = from.covered[word]; bits != 0; bits &= bits - 1) {
    const uint32_t bit = bits & (0 - bits);
    const size_t pixel = 32 * word + static_cast<size_t>(__builtin_ctz(bits));
    if ((to.covered[word] & bit) == 0 || from.nearest[pixel] < to.nearest[pixel]) {
      to.nearest[pixel] = from.nearest[pixel];
    }
  }
  to.covered[word] |= from.covered[word];
}

void merge_rows(const Depths& from, int32_t width_px, int32_t y0, int32_t y1, const Depths& to) {
  const U32 d;
  const hn::Rebind<uint8_t, U32> bytes;
  const hn::Rebind<uint16_t, U32> shorts;
  const size_t lanes = hn::Lanes(d);
  for (int32_t left = 0; left < width_px; left += 32) {
    const size_t first = to.word(left, y0);
    const size_t end = to.word(left, y1);
    for (size_t word = first; to.gray_scale == nullptr && word < end; ++word) {
      merge_word(from, word, to);
    }
    for (size_t at = 32 * first; to.gray_scale != nullptr && at < 32 * end; at += lanes) {
      const auto theirs = hn::PromoteTo(d, hn::LoadU(bytes, from.gray + at));
      const auto ours = hn::PromoteTo(d, hn::LoadU(bytes, to.gray + at));
      const auto their_sum = hn::PromoteTo(d, hn::LoadU(shorts, from.nearest_sum + at));
      const auto our_sum = hn::PromoteTo(d, hn::LoadU(shorts, to.nearest_sum + at));
      const auto is_nearer = hn::Or(hn::Eq(ours, hn::Zero(d)), hn::Lt(their_sum, our_sum));
      const auto taken = hn::And(hn::Ne(theirs, hn::Zero(d)), is_nearer);
      const auto gray = hn::BitCast(I32(), hn::IfThenElse(taken, theirs, ours));
      const auto sum = hn::BitCast(I32(), hn::IfThenElse(taken, their_sum, our_sum));
      hn::StoreU(hn::DemoteTo(shorts, sum), shorts, to.nearest_sum + at);
      hn::StoreU(hn::DemoteTo(bytes, gray), bytes, to.gray + at);
    }
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
