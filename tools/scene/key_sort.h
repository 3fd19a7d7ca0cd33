/// Morton keys sorted with what a desktop has: caches, some spare bytes and threads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "thimble/base/memory.h"

namespace thimble::tools {

/// Most bytes of scratch that sorting so many keys on so many threads makes use of: a byte a key at most.
std::size_t key_sort_scratch_bytes(std::size_t keys, int threads);

/// What `sort_keys` (thimble/tree/compact_tree.h) does, two to three times as fast: keys are dealt in place into
/// buckets by their highest 8 bits, and a bucket that fits the scratch (or is dealt again until it does) goes
/// there and back in passes of 11 bits, lowest first. Buckets are shared out among `threads`, 1 or more.
/// `scratch` is aligned for keys and overwritten; with none, or for short lists, it is `sort_keys`.
/// Key: std::uint32_t or std::uint64_t.
template <class Key>
void sort_keys_fast(Span<Key> keys, int key_bits, Bytes scratch, int threads);

}  // namespace thimble::tools
