#include "thimble/tree/compact_tree.h"

namespace thimble {
namespace {

// 64 buckets: their counters take 512 bytes of stack, which a small chip can spare.
constexpr int kDigitBits = 6;
constexpr uint32_t kDigits = 1U << kDigitBits;
// Runs up to this length are finished by insertion: cheaper than clearing the counters.
constexpr size_t kShortRun = 24;

template <class Key>
void insertion_sort(Key* keys, size_t count) {
  for (size_t i = 1; i < count; ++i) {
    const Key key = keys[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] > key; --j) {
      keys[j] = keys[j - 1];
    }
    keys[j] = key;
  }
}

// Brings keys[0..count) into the order of the digit at `shift`: counts, then moves every key along the cycle
// of the permutation that puts it into its bucket.
template <class Key>
void permute_by_digit(Key* keys, size_t count, int shift) {
  uint32_t next[kDigits] = {};
  uint32_t end[kDigits];
  for (size_t i = 0; i < count; ++i) {
    ++next[(keys[i] >> shift) & (kDigits - 1)];
  }
  uint32_t start = 0;
  for (uint32_t digit = 0; digit < kDigits; ++digit) {
    const uint32_t size = next[digit];
    next[digit] = start;
    start += size;
    end[digit] = start;
  }
  for (uint32_t digit = 0; digit < kDigits; ++digit) {
    while (next[digit] < end[digit]) {
      Key key = keys[next[digit]];
      uint32_t home = static_cast<uint32_t>((key >> shift) & (kDigits - 1));
      while (home != digit) {
        const uint32_t place = next[home]++;
        const Key evicted = keys[place];
        keys[place] = key;
        key = evicted;
        home = static_cast<uint32_t>((key >> shift) & (kDigits - 1));
      }
      keys[next[digit]++] = key;
    }
  }
}

template <class Key>
void sort_in_place(Span<Key> keys, int key_bits) {
  // Digits are taken from the top of the key down; the last one may overlap the one before it.
  int shift = key_bits > kDigitBits ? key_bits - kDigitBits : 0;
  bool first_pass = true;
  for (;;) {
    const int prefix_shift = shift + kDigitBits;
    size_t begin = 0;
    while (begin < keys.size) {
      // A run: keys that agree in all digits already sorted by.
      size_t end = keys.size;
      if (!first_pass) {
        const Key prefix = keys[begin] >> prefix_shift;
        end = begin + 1;
        while (end < keys.size && (keys[end] >> prefix_shift) == prefix) {
          ++end;
        }
      }
      if (end - begin <= kShortRun) {
        insertion_sort(keys.data + begin, end - begin);
      } else {
        permute_by_digit(keys.data + begin, end - begin, shift);
      }
      begin = end;
    }
    if (shift == 0) {
      return;
    }
    shift = shift > kDigitBits ? shift - kDigitBits : 0;
    first_pass = false;
  }
}

}  // namespace

void sort_keys(Span<uint32_t> keys, int key_bits) {
  sort_in_place(keys, key_bits);
}
void sort_keys(Span<uint64_t> keys, int key_bits) {
  sort_in_place(keys, key_bits);
}

size_t unique_keys(Span<uint32_t> keys) {
  size_t kept = 0;
  for (size_t i = 0; i < keys.size; ++i) {
    if (kept == 0 || keys[i] != keys[kept - 1]) {
      keys[kept++] = keys[i];
    }
  }
  return kept;
}

size_t unique_keys(Span<uint64_t> keys) {
  size_t kept = 0;
  for (size_t i = 0; i < keys.size; ++i) {
    if (kept != 0 && (keys[i] >> 8) == (keys[kept - 1] >> 8)) {
      --kept;
    }
    keys[kept++] = keys[i];
  }
  return kept;
}

}  // namespace thimble
