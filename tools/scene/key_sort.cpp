#include <algorithm>
#include <array>

#include "scene/point_tree.h"
#include "scene/workers.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

constexpr int kDealBits = 8;
constexpr std::size_t kBuckets = std::size_t{1} << kDealBits;
constexpr int kPassBits = 11;
constexpr std::size_t kPassDigits = std::size_t{1} << kPassBits;
// Below this the core's sort is as good.
constexpr std::size_t kShortList = std::size_t{1} << 16;
// Bytes of scratch a thread: with the bucket itself half of a usual second-level cache.
constexpr std::size_t kMostScratch = std::size_t{512} << 10;

using BucketBounds = std::array<std::size_t, kBuckets + 1>;

// Brings `keys` into the order of the 8 bits at `shift`, in place: keys are swapped into the bucket that they
// belong to. Going through what is left of each bucket, rather than along cycles, leaves swaps independent.
template <class Key>
BucketBounds deal(Span<Key> keys, int shift) {
  const auto bucket_of = [shift](Key key) { return static_cast<std::size_t>(key >> shift) % kBuckets; };
  BucketBounds bounds{};
  for (std::size_t i = 0; i < keys.size; ++i) {
    ++bounds[bucket_of(keys[i]) + 1];
  }
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    bounds[bucket + 1] += bounds[bucket];
  }
  BucketBounds next = bounds;
  bool moved = true;
  while (moved) {
    moved = false;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
      for (std::size_t i = next[bucket]; i < bounds[bucket + 1]; ++i) {
        const Key key = keys[i];
        const std::size_t home = next[bucket_of(key)]++;
        keys[i] = keys[home];
        keys[home] = key;
        moved = true;
      }
    }
  }
  return bounds;
}

// Sorts by the lowest `bits` bits, at most 44, by way of `scratch`, which holds as many keys.
template <class Key>
void sort_in_passes(Span<Key> keys, int bits, Key* scratch) {
  Key* from = keys.data;
  Key* to = scratch;
  for (int shift = 0; shift < bits; shift += kPassBits) {
    std::array<std::uint32_t, kPassDigits> place{};
    const auto digit_of = [shift](Key key) { return static_cast<std::size_t>(key >> shift) % kPassDigits; };
    for (std::size_t i = 0; i < keys.size; ++i) {
      ++place[digit_of(from[i])];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& entry : place) {
      const std::uint32_t count = entry;
      entry = sum;
      sum += count;
    }
    for (std::size_t i = 0; i < keys.size; ++i) {
      to[place[digit_of(from[i])]++] = from[i];
    }
    std::swap(from, to);
  }
  if (from != keys.data) {
    std::copy(from, from + keys.size, keys.data);
  }
}

// Sorts a bucket whose keys agree above their lowest `bits` bits.
template <class Key>
void sort_bucket(Span<Key> keys, int bits, Span<Key> scratch) {
  constexpr std::size_t kFewForPasses = 2048;  // fewer, and clearing the counters is the greater part
  if (keys.size < 2 || bits <= 0) {
    return;
  }
  // A digit reaches above `bits`, which is no harm: those bits are equal.
  if (keys.size <= scratch.size && keys.size >= kFewForPasses) {
    sort_in_passes(keys, bits, scratch.data);
    return;
  }
  if (keys.size < kFewForPasses || bits <= kDealBits) {
    sort_keys(keys, bits);
    return;
  }
  const BucketBounds bounds = deal(keys, bits - kDealBits);
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    sort_bucket(keys.subspan(bounds[bucket], bounds[bucket + 1] - bounds[bucket]), bits - kDealBits, scratch);
  }
}

}  // namespace

template <class Key>
void sort_keys_fast(Span<Key> keys, int key_bits, Bytes scratch, int threads) {
  const Span<Key> room(reinterpret_cast<Key*>(scratch.data), scratch.size / sizeof(Key));
  if (keys.size < kShortList || key_bits <= kDealBits || room.size == 0) {
    sort_keys(keys, key_bits);
    return;
  }
  const int bits = key_bits - kDealBits;
  const BucketBounds bounds = deal(keys, bits);
  const std::size_t share = room.size / static_cast<std::size_t>(threads);
  each_task(kBuckets, threads, [&](std::size_t bucket, std::size_t worker) {
    sort_bucket(keys.subspan(bounds[bucket], bounds[bucket + 1] - bounds[bucket]), bits,
                room.subspan(worker * share, share));
  });
}
template void sort_keys_fast(Span<std::uint32_t> keys, int key_bits, Bytes scratch, int threads);
template void sort_keys_fast(Span<std::uint64_t> keys, int key_bits, Bytes scratch, int threads);

std::size_t key_sort_scratch_bytes(std::size_t keys, int threads) {
  if (keys < kShortList) {
    return 0;
  }
  return std::min(keys, kMostScratch * static_cast<std::size_t>(threads)) / sizeof(std::uint64_t) *
         sizeof(std::uint64_t);
}

}  // namespace thimble::tools
