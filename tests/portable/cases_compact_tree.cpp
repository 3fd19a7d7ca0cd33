// The tree in flash: its size, its bytes, what is refused, and that damage cannot do harm.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::portable {
namespace {

constexpr size_t kChecksumOffset = 12;

// Voxels and two blocks in a world of 16; of several materials or one, coarsened or not.
enum Kind : int { kPlain = 0, kMaterials = 1, kMerged = 2, kMergedMaterials = 3 };
constexpr uint32_t kSmallNodes = 220;
constexpr uint32_t kSmallBytes = 1768 + 800;

bool make_small(Check& check, int kind, int rank_shift = kMinRankShift) {
  if (!make_pool(check, kSmallNodes, 4)) {
    return false;
  }
  Octree& pool = check.world.pool;
  const int32_t materials = (kind & 1) != 0 ? 4 : 1;
  Random random{7};
  Status status = pool.insert_block({8, 8, 0}, 2, static_cast<uint8_t>(materials - 1));
  for (int i = 0; i < 40 && status == Status::kOk; ++i) {
    const Vec3i at = random.vector(16);
    status = pool.insert(at, static_cast<uint8_t>(random.below(materials)));
  }
  if (status == Status::kOk && (kind & 2) != 0) {
    status = pool.coarsen_to(pool.nodes_used() * 2 / 3);
  }
  return check.equal(status, Status::kOk, THIMBLE_WHAT("the small world")) && make_compact(check, rank_shift);
}

// The small tree's bytes, to be damaged.
Bytes bytes_of(Check& check) {
  const CompactTree& tree = check.world.compact;
  const Bytes last = {const_cast<uint8_t*>(tree.bytes()), tree.size_bytes()};  // they lie in the case's arena
  return last;
}

void repair_checksum(Bytes bytes) {
  const uint32_t front = crc32(bytes.subspan(0, kChecksumOffset));
  const uint32_t checksum = crc32(bytes.subspan(kChecksumOffset + 4), front);
  for (size_t i = 0; i < 4; ++i) {
    bytes[kChecksumOffset + i] = static_cast<uint8_t>(checksum >> (8 * i));
  }
}

// A tree that may be anything: rays end, within the bound, with a hit that makes sense.
bool trace_is_safe(Check& check, const Ray& ray) {
  const CompactTree& tree = check.world.compact;
  if (check_ray(ray, tree.level()) != Status::kOk) {
    return true;
  }
  const int32_t side = int32_t{1} << tree.level();
  // Between two lattice planes, of which it crosses at most 3 a voxel of the side, it goes down `level`
  // nodes.
  const uint32_t most = (3 * static_cast<uint32_t>(side) + 1) * static_cast<uint32_t>(tree.level());
  if (closest_hit(tree, ray, &check.hit) != Status::kOk || check.hit.visits > most) {
    return false;
  }
  if (check.hit.kind == HitKind::kHit) {
    for (int axis = 0; axis < 3; ++axis) {
      if (check.hit.voxel[axis] < 0 || check.hit.voxel[axis] >= side) {
        return false;
      }
    }
    return check.hit.axis >= -1 && check.hit.axis <= 2 && check.hit.block_level <= tree.level() &&
           check.hit.t_denominator > 0 && check.hit.t_numerator >= 0;
  }
  return true;
}

void header_of(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const CompactTree& tree = check.world.compact;
  const Octree& pool = check.world.pool;
  const CompactShape shape = compact_shape(pool, kMinRankShift);
  THIMBLE_EQUAL(tree.level(), 4);
  THIMBLE_EQUAL(tree.rank_shift(), kMinRankShift);
  THIMBLE_EQUAL(tree.node_count(), shape.nodes);
  THIMBLE_EQUAL(tree.size_bytes(), compact_bytes(shape));
  THIMBLE_EQUAL(tree.voxel_count(), pool.voxels());
  THIMBLE_EQUAL(tree.solid_added(), pool.solid_added());
  THIMBLE_EQUAL(tree.many_materials(), (kind & 1) != 0);
  THIMBLE_EQUAL(tree.merged(), (kind & 2) != 0);
  THIMBLE_CHECK(CompactTree::validate({tree.bytes(), tree.size_bytes()}) == nullptr);
  check.note_bytes({tree.bytes(), tree.size_bytes()});
}

void every_truncation(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  for (size_t size = 0; size < bytes.size; size += size < 64 ? 1 : 13) {
    const ConstBytes cut = bytes.subspan(0, size);
    CompactTree tree;
    THIMBLE_EQUAL(CompactTree::open(cut, &tree), Status::kDamaged);
    THIMBLE_CHECK(tree.bytes() == nullptr);
    THIMBLE_CHECK(CompactTree::validate(cut) != nullptr);
  }
}

void every_header_bit(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  for (size_t bit = 0; bit < 8 * kCompactHeaderBytes; ++bit) {
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1U << (bit % 8));
    THIMBLE_CHECK(CompactTree::validate(bytes) != nullptr);
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1U << (bit % 8));
  }
  THIMBLE_CHECK(CompactTree::validate(bytes) == nullptr);
}

void some_body_bits(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  for (size_t bit = 8 * kCompactHeaderBytes; bit < 8 * bytes.size; bit += 37) {
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1U << (bit % 8));
    uint32_t place = 0;
    THIMBLE_CHECK(CompactTree::validate(bytes, &place) != nullptr);
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1U << (bit % 8));
  }
}

// Random damage under a checksum that hides it: whatever opens can be traced.
void hidden_damage(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  Random random{static_cast<uint32_t>(95 + kind)};
  int opened = 0;
  for (int round = 0; round < 60; ++round) {
    size_t written = 0;
    THIMBLE_REQUIRE_OK(CompactTree::make(check.world.pool, bytes, nullptr, &written, kMinRankShift));
    const size_t first = round % 4 == 0 ? 28 : kCompactHeaderBytes;
    for (int i = 0; i < 3; ++i) {
      const size_t at = first + static_cast<size_t>(random.below(static_cast<int32_t>(bytes.size - first)));
      bytes[at] = static_cast<uint8_t>(random.next());
    }
    repair_checksum(bytes);
    if (CompactTree::open(bytes, &check.world.compact) != Status::kOk) {
      continue;
    }
    ++opened;
    for (int i = 0; i < 8; ++i) {
      const Vec3i origin = random.vector(6144);
      const Ray ray =
          ray_q8(origin, {random.below(2001) - 1000, random.below(2001) - 1000, 1 + random.below(999)});
      THIMBLE_REQUIRE(trace_is_safe(check, ray));
      check.note(check.hit);
    }
  }
  THIMBLE_CHECK(opened > 30);
}

void too_small(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  const size_t exact = bytes.size;
  for (size_t size = 0; size < exact; size += size + 9 < exact ? 9 : 1) {
    for (uint8_t& byte : bytes) {
      byte = 0xA5;
    }
    size_t needed = 0;
    THIMBLE_EQUAL(
        CompactTree::make(check.world.pool, bytes.subspan(0, size), nullptr, &needed, kMinRankShift),
        Status::kOutOfMemory);
    THIMBLE_EQUAL(needed, exact);
    bool untouched = true;
    for (const uint8_t byte : bytes) {
      untouched = untouched && byte == 0xA5;
    }
    THIMBLE_CHECK(untouched);
  }
}

// The tree again from its voxels' sorted keys: the same bytes.
void from_keys(Check& check, int materials) {
  THIMBLE_REQUIRE(make_pool(check, 200, 4));
  const Span<uint64_t> keys = check.take<uint64_t>(40);
  Random random{12};
  for (uint64_t& key : keys) {
    const Vec3i at = random.vector(16);
    const uint8_t material = static_cast<uint8_t>(random.below(materials));
    const bool fresh = !check.world.pool.test(at);
    if (fresh) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert(at, material));
    }
    key = morton_code(static_cast<uint32_t>(at.x), static_cast<uint32_t>(at.y), static_cast<uint32_t>(at.z))
              << 8 |
          static_cast<uint32_t>(check.world.pool.material(at));
  }
  sort_keys(keys, 20);
  const size_t count = unique_keys(keys);
  THIMBLE_EQUAL(count, check.world.pool.voxels());
  THIMBLE_REQUIRE(make_compact(check));
  const CompactTree& tree = check.world.compact;
  const Bytes again = check.arena.take(tree.size_bytes());
  size_t needed = 0;
  THIMBLE_REQUIRE_OK(CompactTree::make(Span<const uint64_t>(keys.data, count), 4, again, nullptr, &needed));
  THIMBLE_EQUAL(needed, tree.size_bytes());
  THIMBLE_CHECK(
      check.equal(ConstBytes(again), ConstBytes(tree.bytes(), tree.size_bytes()), THIMBLE_WHAT("bytes")));
}

void any_address(Check& check, int kind) {
  THIMBLE_REQUIRE(make_small(check, kind));
  const Bytes bytes = bytes_of(check);
  const Bytes moved = check.arena.take(bytes.size + 4, 1);
  THIMBLE_REQUIRE(!moved.empty());
  const Ray ray = ray_q8({-700, 2300, 1900}, {301, -17, 5});
  THIMBLE_REQUIRE_OK(closest(check, 2, ray, check.options));
  const Hit wanted = check.hit;
  for (size_t offset = 0; offset < 4; ++offset) {
    for (size_t i = 0; i < bytes.size; ++i) {
      moved[offset + i] = bytes[i];
    }
    THIMBLE_REQUIRE_OK(CompactTree::open(moved.subspan(offset), &check.world.compact));
    THIMBLE_CHECK(CompactTree::validate(moved.subspan(offset)) == nullptr);
    THIMBLE_REQUIRE_OK(closest(check, 2, ray, check.options));
    THIMBLE_CHECK(same_hit(check.hit, wanted));
    check.note(check.hit);
  }
}

// Every rank shift: other bytes, the same hits.
void rank_shift(Check& check, int shift) {
  THIMBLE_REQUIRE(make_small(check, kMaterials, shift));
  THIMBLE_EQUAL(check.world.compact.rank_shift(), shift);
  Random random{4};
  for (int i = 0; i < 20; ++i) {
    const Vec3i origin{random.below(8192) - 2048, random.below(8192) - 2048, -500};
    const Ray ray = ray_q8(origin, {random.below(501) - 250, random.below(501) - 250, 1 + random.below(250)});
    THIMBLE_REQUIRE_OK(closest(check, 1, ray, check.options));
    const Hit wanted = check.hit;
    THIMBLE_REQUIRE_OK(closest(check, 2, ray, check.options));
    THIMBLE_CHECK(same_hit(check.hit, wanted));
    check.note(check.hit);
  }
}

// A world of 8 joined from eight of 4, each with one voxel, one full, one empty: the whole world's bytes.
void joined(Check& check, int) {
  THIMBLE_REQUIRE(make_pool(check, 40, 3));
  const Span<CompactTree> parts = check.take<CompactTree>(8);
  THIMBLE_REQUIRE(parts.size == 8);
  for (uint32_t part = 0; part < 8; ++part) {
    check.world.pool.clear();
    THIMBLE_REQUIRE_OK(Octree::make(2, check.arena.take(3 * 8 + 3), &check.world.pool));
    if (part == 2) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert_block({0, 0, 0}, 2, 0));
    } else if (part != 5) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert({static_cast<int32_t>(part) % 4, 1, 3}, 0));
    }
    THIMBLE_REQUIRE(make_compact(check));
    parts[part] = check.world.compact;
  }
  const Bytes out = check.arena.take(160);
  size_t written = 0;
  THIMBLE_REQUIRE_OK(CompactTree::make(Span<const CompactTree>(parts), out, nullptr, &written));
  THIMBLE_REQUIRE(make_pool(check, 40, 3));
  for (uint32_t part = 0; part < 8; ++part) {
    const Vec3i corner{static_cast<int32_t>(part & 1U) * 4, static_cast<int32_t>(part >> 1 & 1U) * 4,
                       static_cast<int32_t>(part >> 2) * 4};
    if (part == 2) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert_block(corner, 2, 0));
    } else if (part != 5) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert(
          {corner.x + static_cast<int32_t>(part) % 4, corner.y + 1, corner.z + 3}, 0));
    }
  }
  THIMBLE_REQUIRE(make_compact(check));
  const CompactTree& tree = check.world.compact;
  THIMBLE_CHECK(check.equal(ConstBytes(out.subspan(0, written)), ConstBytes(tree.bytes(), tree.size_bytes()),
                            THIMBLE_WHAT("bytes of the whole")));
}

constexpr Case kCases[] = {
    {"size: shapes -> header, masks, directory, merged bits, materials", 0,
     [](Check& check, int) {
       CompactShape shape;
       shape.level = 5;
       THIMBLE_EQUAL(compact_bytes(shape), 56U);
       shape.nodes = 1;
       THIMBLE_EQUAL(compact_bytes(shape), 64U);
       shape.nodes = 65;
       THIMBLE_EQUAL(compact_bytes(shape), 56U + 68 + 8);
       shape.merged = true;
       THIMBLE_EQUAL(compact_bytes(shape), 56U + 68 + 8 + 12);
       shape.many_materials = true;
       shape.voxel_bits = 101;
       THIMBLE_EQUAL(compact_bytes(shape), 56U + 68 + 8 + 12 + 104);
       shape.solid_blocks = 3;
       THIMBLE_EQUAL(compact_bytes(shape), 56U + 68 + 8 + 12 + 8 + 104);
     }},
    {"size: beyond 2^32 - 1 bytes -> 0", 0,
     [](Check& check, int) {
       CompactShape shape;
       shape.nodes = UINT32_MAX;
       THIMBLE_EQUAL(compact_bytes(shape), 0U);
     }},
    {"an empty world -> the header alone", 128,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 0, 7));
       THIMBLE_REQUIRE(make_compact(check));
       const CompactTree& tree = check.world.compact;
       THIMBLE_EQUAL(tree.size_bytes(), kCompactHeaderBytes);
       THIMBLE_CHECK(tree.empty());
       THIMBLE_EQUAL(tree.level(), 7);
       THIMBLE_CHECK(tree.bounds().empty());
       THIMBLE_EQUAL(tree.voxel_count(), 0U);
     }},
    {"a full world of 2^10 -> one node in 64 bytes", 128,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 1, 10));
       THIMBLE_REQUIRE_OK(check.world.pool.insert_block({0, 0, 0}, 10, 3));
       THIMBLE_REQUIRE(make_compact(check));
       const CompactTree& tree = check.world.compact;
       THIMBLE_EQUAL(tree.size_bytes(), 64U);
       THIMBLE_EQUAL(tree.node_count(), 1U);
       THIMBLE_EQUAL(tree.mask(0), 0);
       THIMBLE_EQUAL(tree.uniform_material(), 3);
       THIMBLE_EQUAL(tree.voxel_count(), uint64_t{1} << 30);
     }},
    {"the header's bytes -> magic, level, size, counts where the format says", 256,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 3, 3));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({5, 2, 7}, 9));
       THIMBLE_REQUIRE(make_compact(check));
       const uint8_t* bytes = check.world.compact.bytes();
       THIMBLE_EQUAL(bytes[0], 0x54);
       THIMBLE_EQUAL(bytes[1], 0x4D);
       THIMBLE_EQUAL(bytes[2], 0x42);
       THIMBLE_EQUAL(bytes[3], 1);
       THIMBLE_EQUAL(bytes[4], 3);
       THIMBLE_EQUAL(bytes[5], kDefaultRankShift);
       THIMBLE_EQUAL(bytes[6], 0);
       THIMBLE_EQUAL(bytes[7], 9);
       THIMBLE_EQUAL(bytes[8], 64);
       THIMBLE_EQUAL(bytes[16], 3);
       THIMBLE_EQUAL(bytes[24], 1);
       THIMBLE_EQUAL(bytes[28], 5);
       THIMBLE_EQUAL(bytes[34], 6);
     }},
    {"what the header says -> what the octree holds", kSmallBytes, header_of, kPlain, "kind", 4},
    {"an output that is too small -> out of memory, the need, not a byte written", kSmallBytes, too_small,
     kPlain, "kind", 4},
    {"rank shifts beyond the limits -> out of range", 128,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 0, 3));
       const Bytes bytes = check.arena.take(64);
       size_t needed = 0;
       constexpr int kShifts[] = {kMinRankShift - 1, kMaxRankShift + 1, -1, 64};
       for (const int shift : kShifts) {
         THIMBLE_EQUAL(CompactTree::make(check.world.pool, bytes, nullptr, &needed, shift),
                       Status::kOutOfRange);
         THIMBLE_EQUAL(CompactTree::make(Span<const uint64_t>(), 3, bytes, nullptr, &needed, shift),
                       Status::kOutOfRange);
       }
     }},
    {"levels beyond the limits -> out of range", 128,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(64);
       size_t needed = 0;
       constexpr int kLevels[] = {-1, 0, 13};
       for (const int level : kLevels) {
         THIMBLE_EQUAL(CompactTree::make(Span<const uint64_t>(), level, bytes, nullptr, &needed),
                       Status::kOutOfRange);
       }
       THIMBLE_EQUAL(CompactTree::make(Span<const uint32_t>(), 11, 0, bytes, nullptr, &needed),
                     Status::kOutOfRange);
       THIMBLE_EQUAL(CompactTree::make(Span<const uint64_t>(), 12, bytes, nullptr, &needed), Status::kOk);
       THIMBLE_EQUAL(needed, kCompactHeaderBytes);
     }},
    {"from sorted keys -> the octree's bytes", 1608 + 320 + 1200, from_keys, 1, "one material"},
    {"from sorted keys -> the octree's bytes", 1608 + 320 + 1200, from_keys, 5, "five materials"},
    {"from 32-bit keys -> the octree's bytes", 400,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 12, 4));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({1, 2, 3}, 6));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({9, 9, 9}, 6));
       THIMBLE_REQUIRE(make_compact(check));
       const uint32_t keys[] = {static_cast<uint32_t>(morton_code(1, 2, 3)),
                                static_cast<uint32_t>(morton_code(9, 9, 9))};
       const CompactTree& tree = check.world.compact;
       const Bytes again = check.arena.take(tree.size_bytes());
       size_t needed = 0;
       THIMBLE_REQUIRE_OK(CompactTree::make(Span<const uint32_t>(keys), 4, 6, again, nullptr, &needed));
       THIMBLE_CHECK(check.equal(ConstBytes(again), ConstBytes(tree.bytes(), tree.size_bytes()),
                                 THIMBLE_WHAT("bytes")));
     }},
    {"joined from eight parts -> the bytes of the whole", 3600, joined},
    {"parts: a number that is no power of eight -> bad argument", 256,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 0, 3));
       THIMBLE_REQUIRE(make_compact(check));
       const Span<const CompactTree> one(&check.world.compact, 1);
       const Bytes out = check.arena.take(64);
       THIMBLE_EQUAL(CompactTree::make(Span<const CompactTree>(), out, nullptr, nullptr),
                     Status::kBadArgument);
       THIMBLE_EQUAL(CompactTree::make(one, out, nullptr, nullptr), Status::kOk);
     }},
    {"every truncation -> refused, the tree handed in as it was", kSmallBytes, every_truncation, kPlain,
     "kind", 4},
    {"every bit of the header flipped -> found out", kSmallBytes, every_header_bit, kMergedMaterials},
    {"bits behind the header flipped -> found out", kSmallBytes, some_body_bits, kPlain, "kind", 4},
    {"damage under a sound checksum -> rays end within the bound", kSmallBytes, hidden_damage, kPlain, "kind",
     4},
    {"counts beyond 2^32 bytes and a size of 0 -> refused", kSmallBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_small(check, kMaterials));
       const Bytes bytes = bytes_of(check);
       for (size_t i = 0; i < 4; ++i) {
         bytes[8 + i] = 0;
         bytes[16 + i] = 0xFF;
       }
       CompactTree tree;
       THIMBLE_EQUAL(CompactTree::open(bytes, &tree), Status::kDamaged);
       uint32_t place = 0;
       THIMBLE_CHECK(CompactTree::validate(bytes, &place) != nullptr);
       THIMBLE_EQUAL(place, 8U);
     }},
    {"bytes that are something else -> refused", 64,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(64);
       CompactTree tree;
       constexpr int kFills[] = {0, 0xFF, 0x54};
       for (const int fill : kFills) {
         for (uint8_t& byte : bytes) {
           byte = static_cast<uint8_t>(fill);
         }
         THIMBLE_EQUAL(CompactTree::open(bytes, &tree), Status::kDamaged);
       }
       THIMBLE_EQUAL(CompactTree::open({}, &tree), Status::kDamaged);
       THIMBLE_CHECK(tree.bytes() == nullptr);
     }},
    {"more bytes behind the tree -> not looked at", 400,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 3, 3));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({5, 2, 7}, 9));
       const Bytes bytes = check.arena.take(200);
       size_t written = 0;
       THIMBLE_REQUIRE_OK(CompactTree::make(check.world.pool, bytes, nullptr, &written));
       THIMBLE_REQUIRE_OK(CompactTree::open(bytes, &check.world.compact));
       THIMBLE_EQUAL(check.world.compact.size_bytes(), written);
       THIMBLE_CHECK(CompactTree::validate(bytes) == nullptr);
     }},
    {"bytes at any address -> the same answers", kSmallBytes + 804, any_address, kPlain, "kind", 4},
    {"rank shifts -> the pool's hits", kSmallBytes, rank_shift, kMinRankShift, "shift", 8},
};

}  // namespace

const Group kCompactTreeGroup = group_of<kCases>("compact tree", "cases_compact_tree.cpp");

}  // namespace thimble::portable
