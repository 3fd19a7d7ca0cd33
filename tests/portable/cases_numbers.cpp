// Numbers and bytes that everything else stands on: fixed point, spans, the arena, CRC-32, Morton codes.
#include "portable/groups.h"
#include "thimble/base/memory.h"
#include "thimble/base/vec.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::portable {
namespace {

uint32_t crc_of(const char* text) {
  size_t length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  return crc32({reinterpret_cast<const uint8_t*>(text), length});
}

// The definition, bit by bit: the remainder of the message, reflected, by the polynomial of IEEE 802.3.
uint32_t bitwise_crc(ConstBytes bytes) {
  uint32_t remainder = 0xFFFFFFFFU;
  for (const uint8_t byte : bytes) {
    remainder ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0 ? remainder >> 1 ^ 0xEDB88320U : remainder >> 1;
    }
  }
  return remainder ^ 0xFFFFFFFFU;
}

Bytes random_bytes(Check& check, size_t count) {
  const Bytes bytes = check.arena.take(count, 1);
  Random random;
  for (uint8_t& byte : bytes) {
    byte = static_cast<uint8_t>(random.next() >> 24);
  }
  return bytes;
}

// The code of (x, y, z), a bit at a time.
uint64_t plain_code(uint32_t x, uint32_t y, uint32_t z) {
  uint64_t code = 0;
  for (unsigned bit = 0; bit < 21; ++bit) {
    code |= uint64_t{(x >> bit) & 1U} << (3 * bit) | uint64_t{(y >> bit) & 1U} << (3 * bit + 1) |
            uint64_t{(z >> bit) & 1U} << (3 * bit + 2);
  }
  return code;
}

template <class Key>
bool ascending(Span<Key> keys) {
  for (size_t i = 1; i < keys.size; ++i) {
    if (keys[i - 1] > keys[i]) {
      return false;
    }
  }
  return true;
}
// A sum that the order of the keys does not change: sorting must keep it.
template <class Key>
uint64_t sum_of(Span<Key> keys) {
  uint64_t sum = 0;
  for (const Key key : keys) {
    sum += key;
  }
  return sum;
}
template <class Key>
void check_sort(Check& check, size_t count, int key_bits, bool descending) {
  const Span<Key> keys = check.take<Key>(count);
  THIMBLE_REQUIRE(keys.size == count);
  Random random;
  for (size_t i = 0; i < count; ++i) {
    const uint64_t upper = random.next();
    const uint64_t value = descending ? count - i : upper << 32 | random.next();
    keys[i] = static_cast<Key>(value & (~uint64_t{0} >> (64 - key_bits)));
  }
  const uint64_t sum = sum_of(keys);
  sort_keys(keys, key_bits);
  THIMBLE_CHECK(ascending(keys));
  THIMBLE_EQUAL(sum_of(keys), sum);
  for (const Key key : keys) {
    check.note(static_cast<int64_t>(key));
  }
}

constexpr Case kCases[] = {
    {"fixed: saturate of a whole number in range -> that number", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(Q8::saturate(3).raw, 768);
       THIMBLE_EQUAL(Q8::saturate(-3).raw, -768);
       THIMBLE_EQUAL(Q16::saturate(120).raw, 7864320);
     }},
    {"fixed: saturate beyond the range -> the ends", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(Q8::saturate(Q8::kMaxWhole).raw, Q8::kMaxWhole * 256);
       THIMBLE_EQUAL(Q8::saturate(Q8::kMaxWhole + 1).raw, INT32_MAX);
       THIMBLE_EQUAL(Q8::saturate(INT32_MAX).raw, INT32_MAX);
       THIMBLE_EQUAL(Q8::saturate(-Q8::kMaxWhole - 1).raw, INT32_MIN);
       THIMBLE_EQUAL(Q8::saturate(INT32_MIN).raw, INT32_MIN);
     }},
    {"fixed: floor and fraction of negatives -> downwards, fraction at least 0", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(Q8::from_raw(-1).floor(), -1);
       THIMBLE_EQUAL(Q8::from_raw(-1).fraction(), 255);
       THIMBLE_EQUAL(Q8::from_raw(-256).floor(), -1);
       THIMBLE_EQUAL(Q8::from_raw(-256).fraction(), 0);
       THIMBLE_EQUAL(Q8::from_raw(511).floor(), 1);
       THIMBLE_EQUAL(Q8::from_raw(511).fraction(), 255);
     }},
    {"fixed: sums beyond 32 bits -> wrap", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL((Q8::from_raw(INT32_MAX) + Q8::from_raw(1)).raw, INT32_MIN);
       THIMBLE_EQUAL((Q8::from_raw(INT32_MIN) - Q8::from_raw(1)).raw, INT32_MAX);
       THIMBLE_EQUAL((-Q8::from_raw(INT32_MIN)).raw, INT32_MIN);
     }},
    {"fixed: comparisons -> those of the numbers", 0,
     [](Check& check, int) {
       const Q8 low = Q8::from_raw(-7);
       const Q8 high = Q8::from_raw(5);
       THIMBLE_CHECK(low < high && low <= high && high > low && high >= low && low != high);
       THIMBLE_CHECK(low == Q8::from_raw(-7) && low <= low && low >= low);
     }},
    {"vec: components by number -> x, y, z", 0,
     [](Check& check, int) {
       Vec3i v{1, 2, 3};
       v[1] = 9;
       THIMBLE_EQUAL(v, (Vec3i{1, 9, 3}));
       THIMBLE_EQUAL(v[0] * 100 + v[1] * 10 + v[2], 193);
     }},
    {"box: empty on one axis -> empty", 0,
     [](Check& check, int) {
       THIMBLE_CHECK((VoxelBox{{0, 0, 0}, {4, 0, 4}}.empty()));
       THIMBLE_CHECK((VoxelBox{{5, 0, 0}, {4, 9, 9}}.empty()));
       THIMBLE_CHECK(!(VoxelBox{{3, 3, 3}, {4, 4, 4}}.empty()));
     }},
    {"span: part of a span -> cut off at its end", 0,
     [](Check& check, int) {
       const uint8_t bytes[] = {1, 2, 3, 4, 5};
       const ConstBytes all(bytes);
       THIMBLE_EQUAL(all.subspan(2).size, 3U);
       THIMBLE_EQUAL(all.subspan(2)[0], 3);
       THIMBLE_EQUAL(all.subspan(1, 2).size, 2U);
       THIMBLE_EQUAL(all.subspan(4, 9).size, 1U);
       THIMBLE_EQUAL(all.subspan(5).size, 0U);
       THIMBLE_CHECK(all.subspan(99).empty());
     }},
    {"status: every one -> a phrase of its own", 0,
     [](Check& check, int) {
       for (int i = 0; i <= 6; ++i) {
         THIMBLE_EQUAL(crc_of(status_text(static_cast<Status>(i))) != crc_of("unknown status"), true);
       }
       THIMBLE_EQUAL(crc_of(status_text(Status::kDamaged)), crc_of("damaged tree"));
       THIMBLE_EQUAL(crc_of(status_text(static_cast<Status>(77))), crc_of("unknown status"));
     }},
    {"arena: pieces taken -> aligned, apart, counted", 64,
     [](Check& check, int) {
       const Bytes odd = check.arena.take(3, 1);
       const Bytes word = check.arena.take(8);
       THIMBLE_EQUAL(odd.size, 3U);
       THIMBLE_EQUAL(static_cast<int32_t>(word.data - odd.data), 8);
       THIMBLE_EQUAL(check.arena.used_bytes(), 16U);
       THIMBLE_EQUAL(check.arena.free_bytes(), 48U);
     }},
    {"arena: more than is left -> nothing, and no change", 64,
     [](Check& check, int) {
       THIMBLE_EQUAL(check.arena.take(60, 1).size, 60U);
       THIMBLE_CHECK(check.arena.take(5, 1).empty());
       THIMBLE_CHECK(check.arena.take(1, 8).empty());
       THIMBLE_CHECK(check.arena.take(SIZE_MAX, 1).empty());
       THIMBLE_EQUAL(check.arena.used_bytes(), 60U);
       THIMBLE_EQUAL(check.arena.take(4, 1).size, 4U);
       THIMBLE_EQUAL(check.arena.free_bytes(), 0U);
     }},
    {"arena: no bytes taken -> an empty span", 8,
     [](Check& check, int) {
       THIMBLE_CHECK(check.arena.take(0).empty());
       THIMBLE_EQUAL(check.arena.used_bytes(), 0U);
     }},
    {"arena: rewound -> the same bytes again, the high water stays", 64,
     [](Check& check, int) {
       static_cast<void>(check.arena.take(16));
       const size_t mark = check.arena.used_bytes();
       const Bytes first = check.arena.take(40);
       check.arena.rewind(mark);
       THIMBLE_EQUAL(check.arena.used_bytes(), 16U);
       THIMBLE_EQUAL(check.arena.high_water_bytes(), 56U);
       THIMBLE_CHECK(check.arena.take(8).data == first.data);
       check.arena.rewind(9999);
       THIMBLE_EQUAL(check.arena.used_bytes(), 24U);
     }},
    {"arena: scratch behind what is taken -> in the high water", 64,
     [](Check& check, int) {
       static_cast<void>(check.arena.take(8));
       check.arena.note_scratch(30);
       check.arena.note_scratch(10);
       THIMBLE_EQUAL(check.arena.high_water_bytes(), 38U);
       THIMBLE_EQUAL(check.arena.rest().size, 56U);
     }},

    {"crc32: 123456789 -> the published check value", 0,
     [](Check& check, int) { THIMBLE_EQUAL(crc_of("123456789"), 0xCBF43926U); }},
    {"crc32: random bytes -> the bitwise definition", 300,
     [](Check& check, int) {
       const Bytes bytes = random_bytes(check, 300);
       for (size_t size = 0; size <= bytes.size; size += 60) {
         THIMBLE_EQUAL(crc32(bytes.subspan(0, size)), bitwise_crc(bytes.subspan(0, size)));
       }
     }},
    {"crc32: cut in two anywhere -> the same", 64,
     [](Check& check, int) {
       const Bytes bytes = random_bytes(check, 64);
       const uint32_t whole = crc32(bytes);
       for (size_t cut = 0; cut <= bytes.size; ++cut) {
         THIMBLE_EQUAL(crc32(bytes.subspan(cut), crc32(bytes.subspan(0, cut))), whole);
       }
     }},
    {"crc32: bytes at odd addresses -> the same", 72,
     [](Check& check, int) {
       const Bytes bytes = random_bytes(check, 72);
       for (size_t offset = 1; offset < 8; ++offset) {
         THIMBLE_EQUAL(crc32(bytes.subspan(offset, 9)), bitwise_crc(bytes.subspan(offset, 9)));
       }
     }},

    {"morton: 21 bits an axis -> 63 bits", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(morton_code(0x1FFFFF, 0x1FFFFF, 0x1FFFFF), (uint64_t{1} << 63) - 1);
       THIMBLE_EQUAL(morton_voxel((uint64_t{1} << 63) - 1), (Vec3i{0x1FFFFF, 0x1FFFFF, 0x1FFFFF}));
     }},
    {"morton: random voxels -> bits interleaved one by one, and back", 0,
     [](Check& check, int) {
       Random random;
       for (int i = 0; i < 50; ++i) {
         const uint32_t x = random.next() >> 11;
         const uint32_t y = random.next() >> 11;
         const uint32_t z = random.next() >> 11;
         THIMBLE_EQUAL(morton_code(x, y, z), plain_code(x, y, z));
         THIMBLE_EQUAL(morton_voxel(plain_code(x, y, z)),
                       (Vec3i{static_cast<int32_t>(x), static_cast<int32_t>(y), static_cast<int32_t>(z)}));
       }
     }},
    {"sort_keys: 300 random keys of 30 bits -> ascending, none lost", 1200,
     [](Check& check, int) { check_sort<uint32_t>(check, 300, 30, false); }},
    {"sort_keys: 300 random keys of 44 bits -> ascending, none lost", 2400,
     [](Check& check, int) { check_sort<uint64_t>(check, 300, 44, false); }},
    {"sort_keys: keys of all 64 bits -> ascending", 1600,
     [](Check& check, int) { check_sort<uint64_t>(check, 200, 64, false); }},
    {"sort_keys: one key, no key -> left alone", 8,
     [](Check& check, int) {
       uint32_t one[] = {5};
       sort_keys(Span<uint32_t>(one), 30);
       THIMBLE_EQUAL(one[0], 5U);
       sort_keys(Span<uint32_t>(), 30);
       THIMBLE_EQUAL(unique_keys(Span<uint32_t>()), 0U);
     }},
    {"unique_keys: bare codes -> each once", 0,
     [](Check& check, int) {
       uint32_t keys[] = {1, 1, 1, 4, 7, 7, 9};
       THIMBLE_EQUAL(unique_keys(Span<uint32_t>(keys)), 4U);
       THIMBLE_EQUAL(keys[0] * 1000 + keys[1] * 100 + keys[2] * 10 + keys[3], 1479U);
     }},
    {"unique_keys: codes with materials -> one a voxel, the greatest material", 0,
     [](Check& check, int) {
       uint64_t keys[] = {0x101, 0x105, 0x203, 0x300, 0x301, 0x3FF};
       THIMBLE_EQUAL(unique_keys(Span<uint64_t>(keys)), 3U);
       THIMBLE_EQUAL(keys[0], 0x105U);
       THIMBLE_EQUAL(keys[1], 0x203U);
       THIMBLE_EQUAL(keys[2], 0x3FFU);
     }},
};

}  // namespace

const Group kNumberGroup = group_of<kCases>("numbers", "cases_numbers.cpp");

}  // namespace thimble::portable
