// The bytes of a brick map: opening, checking, building. src/FORMAT.md is the specification.
#include "thimble/tree/brick_map.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "../base/hot.h"
#include "brick_parts.h"
#include "compact_header.h"
#include "deep_map.h"
#include "thimble/base/memory.h"

namespace thimble {

namespace {

constexpr uint32_t kMapMagic = 0x014D4254;      // "TBM", then the version, 1
constexpr uint32_t kMapMagicMask = 0x00FFFFFF;  // all but the version
constexpr uint32_t kMapLevelOffset = 4;
constexpr uint32_t kBoxMinOffset = 5;
constexpr uint32_t kMapSizeOffset = 8;
constexpr uint32_t kMapChecksumOffset = 12;
constexpr uint32_t kTreeChecksumOffset = 16;
constexpr uint32_t kBoxSizeOffset = 20;
constexpr uint32_t kBricksOffset = 24;
constexpr uint32_t kMixedOffset = 28;

// While a map is made, where a brick comes from: below this a node of level 2, counted from the first of that
// level; from it on the low byte is the material of all that is seen of the brick.
constexpr uint32_t kUniform = 0xFF00;

using brick_parts::kChildBits;
using brick_parts::kOriginBytes;

struct MapHeader {
  int level;
  VoxelBox box;
  uint32_t cells;
  uint32_t bricks;
  uint32_t mixed;
};

size_t bricks_at(uint32_t cells) {
  return kBrickMapHeaderBytes + ((2 * size_t{cells} + 7) & ~size_t{7});
}
size_t origins_at(uint32_t cells, uint32_t bricks) {
  return bricks_at(cells) + 8 * size_t{bricks};
}
size_t materials_at(uint32_t cells, uint32_t bricks, uint32_t mixed) {
  return origins_at(cells, bricks) + kOriginBytes * size_t{mixed};
}

const char* read_map_header(ConstBytes bytes, MapHeader* header) {
  const uint32_t differ =
      bytes.size < kBrickMapHeaderBytes ? kMapMagicMask : bits::load32(bytes.data) ^ kMapMagic;
  if (differ != 0) {
    return (differ & kMapMagicMask) == 0 ? kAnotherVersion : "not a brick map";
  }
  const uint8_t* base = bytes.data;
  header->level = base[kMapLevelOffset];
  if (header->level < kMinBrickMapLevel || header->level > kMaxBrickMapLevel) {
    return "level out of range";
  }
  const int32_t side = int32_t{1} << (header->level - 2);
  header->cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t size = base[kBoxSizeOffset + static_cast<uint32_t>(axis)];
    header->box.low[axis] = base[kBoxMinOffset + static_cast<uint32_t>(axis)];
    header->box.high[axis] = header->box.low[axis] + static_cast<int32_t>(size);
    if (header->box.high[axis] > side) {
      return "box outside the world";
    }
    header->cells *= size;
  }
  header->bricks = bits::load16(base + kBricksOffset);
  const uint32_t size = bits::load32(base + kMapSizeOffset);
  header->mixed = bits::load16(base + kMixedOffset);
  if (header->bricks == 0 || header->mixed >= header->bricks ||
      size != brick_map_bytes(header->cells, header->bricks, header->mixed)) {
    return "size does not match the counts";
  }
  return size > bytes.size ? "truncated" : nullptr;
}

// Whether cells name bricks that are there. Number 0 is met in space only, and has no origin.
[[gnu::always_inline]] inline const char* check_numbers(const uint8_t* base, const MapHeader& header) {
  for (uint32_t cell = 0; cell < header.cells; ++cell) {
    if (bits::load16(base + kBrickMapHeaderBytes + 2 * size_t{cell}) >= header.bricks) {
      return "a cell names a brick that is not there";
    }
  }
  return bits::load64(base + bricks_at(header.cells)) != 0 ? "brick 0 is not empty" : nullptr;
}

bool is_aligned(const uint8_t* data) {
  return (reinterpret_cast<size_t>(data) & 7U) == 0;
}

using brick_parts::bits_of_node;

// A map in the making: directory and bricks as they will be, sources from the end of the bytes downwards.
class MapBuilder {
 public:
  MapBuilder(const CompactTree& tree, Bytes out) : tree_(tree), out_(out) {
    for (uint16_t& number : solid_) {
      number = 0;
    }
    const VoxelBox& bounds = tree.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      min_[axis] = bounds.low[axis] >> 2;
      size_[axis] = tree.empty() ? 0 : ((bounds.high[axis] + 3) >> 2) - min_[axis];
    }
    cells_ = static_cast<uint32_t>(size_.x * size_.y * size_.z);
  }

  Status run(size_t* written) {
    if (out_.size < brick_map_bytes(cells_, 1, 0) + 2) {
      return Status::kOutOfMemory;
    }
    for (size_t at = 0; at < bricks_at(cells_); ++at) {
      out_[at] = 0;
    }
    uint32_t empty = 0;
    Status status = add(0, kUniform, &empty);
    if (status == Status::kOk && !tree_.empty()) {
      status = place_all();
    }
    if (status != Status::kOk) {
      return status;
    }
    share_uniform();
    mixed_first();
    return finish(written);
  }

 private:
  uint8_t* cell(uint32_t index) const { return out_.data + kBrickMapHeaderBytes + 2 * size_t{index}; }
  uint8_t* brick(uint32_t number) const { return out_.data + bricks_at(cells_) + 8 * size_t{number}; }
  uint8_t* source(uint32_t number) const {
    return out_.data + (out_.size & ~size_t{1}) - 2 * (size_t{number} + 1);
  }

  Status add(uint64_t brick_bits, uint32_t where, uint32_t* number) {
    if (bricks_ == kMaxBricks) {
      return Status::kOutOfRange;
    }
    if (out_.size < brick_map_bytes(cells_, bricks_ + 1, 0) + 2 * (size_t{bricks_} + 1)) {
      return Status::kOutOfMemory;
    }
    *number = bricks_++;
    bits::store64(brick(*number), brick_bits);
    bits::store16(source(*number), where);
    return Status::kOk;
  }

  // The one brick that is solid through with `material`.
  Status solid(uint8_t material, uint32_t* number) {
    if (solid_[material] == 0) {
      const Status status = add(~uint64_t{0}, kUniform | material, number);
      if (status != Status::kOk) {
        return status;
      }
      solid_[material] = static_cast<uint16_t>(*number);
    }
    *number = solid_[material];
    return Status::kOk;
  }

  // Enters `number` for all cells of the block of `level` at `corner` (in bricks) that lie in the box.
  void enter(const Vec3i& corner, int level, uint32_t number) {
    const int32_t side = int32_t{1} << (level - 2);
    Vec3i low;
    Vec3i high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = corner[axis] - min_[axis];
      high[axis] = low[axis] + side < size_[axis] ? low[axis] + side : size_[axis];
      low[axis] = low[axis] > 0 ? low[axis] : 0;
    }
    for (int32_t z = low.z; z < high.z; ++z) {
      for (int32_t y = low.y; y < high.y; ++y) {
        for (int32_t x = low.x; x < high.x; ++x) {
          bits::store16(cell(static_cast<uint32_t>((z * size_.y + y) * size_.x + x)), number);
        }
      }
    }
  }

  // Not inlined, nor is `share_uniform`: their frames would lie below that of whatever opens the finished map.
  [[gnu::noinline]] Status place_all() {
    Status status = Status::kOk;
    bool first = true;
    walk_leaves(tree_, 2, [&](uint32_t node, const Vec3i& corner, int level) {
      uint32_t number = 0;
      if (node < tree_.node_count()) {
        if (tree_.mask(node) == 0) {
          status = solid(tree_.block_material(node), &number);
        } else {
          first_node_ = first ? node : first_node_;
          first = false;
          const uint32_t where = node - first_node_;
          status = where < kUniform ? add(bits_of_node(tree_, node), where, &number) : Status::kOutOfRange;
        }
      }
      if (status == Status::kOk) {
        enter({corner.x >> 2, corner.y >> 2, corner.z >> 2}, level, number);
      }
      return status == Status::kOk;
    });
    return status;
  }

  bool is_solid(const Vec3i& voxel) const {
    const Vec3i at{voxel.x >> 2, voxel.y >> 2, voxel.z >> 2};
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) {
      return false;
    }
    const uint32_t number =
        bits::load16(cell(static_cast<uint32_t>((at.z * size_.y + at.y) * size_.x + at.x)));
    return brick_parts::has_voxel(brick(number), voxel);
  }

  // Where all that can be seen of a brick has one material, its source says so; where such a brick is solid
  // through, it is the shared one of that material.
  [[gnu::noinline]] void share_uniform() {
    Vec3i at;
    for (uint32_t index = 0; index < cells_; ++index) {
      const uint32_t number = bits::load16(cell(index));
      const uint32_t where = bits::load16(source(number));
      if (where < kUniform) {
        const uint64_t brick_bits = bits::load64(brick(number));
        const int material =
            brick_parts::material_seen(tree_, first_node_ + where, brick_bits, {4 * at.x, 4 * at.y, 4 * at.z},
                                       [this](const Vec3i& voxel) { return is_solid(voxel); });
        if (material >= 0) {
          const auto seen = static_cast<uint8_t>(material);
          bits::store16(source(number), kUniform | seen);
          if (brick_bits == ~uint64_t{0}) {
            share(index, number, seen);
          }
        }
      }
      if (++at.x == size_.x) {
        at.x = 0;
        if (++at.y == size_.y) {
          at.y = 0;
          ++at.z;
        }
      }
    }
  }

  void rename(uint32_t from, uint32_t to) {
    for (uint32_t index = 0; index < cells_; ++index) {
      if (bits::load16(cell(index)) == from) {
        bits::store16(cell(index), to);
      }
    }
    for (uint16_t& solid : solid_) {
      if (solid == from) {
        solid = static_cast<uint16_t>(to);
      }
    }
  }

  // Cell `index` takes the shared solid brick; the last brick moves into the place of `number`.
  void share(uint32_t index, uint32_t number, uint8_t material) {
    if (solid_[material] == 0) {
      solid_[material] = static_cast<uint16_t>(number);
      return;
    }
    bits::store16(cell(index), solid_[material]);
    const uint32_t last = --bricks_;
    if (number != last) {
      bits::store64(brick(number), bits::load64(brick(last)));
      bits::store16(source(number), bits::load16(source(last)));
      rename(last, number);
    }
  }

  bool is_mixed(uint32_t number) const { return bits::load16(source(number)) < kUniform; }

  // Bricks that need the tree get the numbers from 1 on.
  void mixed_first() {
    uint32_t low = 1;
    uint32_t high = bricks_ - 1;
    for (;;) {
      while (low <= high && is_mixed(low)) {
        ++low;
      }
      while (high >= low && !is_mixed(high)) {
        --high;
      }
      if (low > high) {
        break;
      }
      const uint64_t brick_bits = bits::load64(brick(low));
      const uint32_t where = bits::load16(source(low));
      bits::store64(brick(low), bits::load64(brick(high)));
      bits::store16(source(low), bits::load16(source(high)));
      bits::store64(brick(high), brick_bits);
      bits::store16(source(high), where);
      // No cell has this number, so that the two do not mix.
      rename(low, kMaxBricks);
      rename(high, low);
      rename(kMaxBricks, high);
    }
    mixed_ = low - 1;
  }

  Status finish(size_t* written) {
    const size_t size = brick_map_bytes(cells_, bricks_, mixed_);
    if (out_.size < size + 2 * size_t{bricks_}) {
      return Status::kOutOfMemory;
    }
    for (uint32_t number = 1; number <= mixed_; ++number) {
      uint8_t* origin = out_.data + origins_at(cells_, bricks_) + kOriginBytes * (size_t{number} - 1);
      const uint32_t node = first_node_ + bits::load16(source(number));
      if (tree_.first_child(node) >= uint32_t{1} << kChildBits) {
        return Status::kOutOfRange;
      }
      brick_parts::store_origin(tree_, node, origin);
    }
    uint8_t* material = out_.data + materials_at(cells_, bricks_, mixed_);
    for (uint32_t number = mixed_ + 1; number < bricks_; ++number) {
      *material++ = source(number)[0];
    }
    while (material < out_.data + size) {
      *material++ = 0;
    }
    uint8_t* base = out_.data;
    bits::store32(base, kMapMagic);
    base[kMapLevelOffset] = static_cast<uint8_t>(tree_.level());
    for (int axis = 0; axis < 3; ++axis) {
      base[kBoxMinOffset + static_cast<uint32_t>(axis)] = static_cast<uint8_t>(min_[axis]);
      base[kBoxSizeOffset + static_cast<uint32_t>(axis)] = static_cast<uint8_t>(size_[axis]);
    }
    bits::store32(base + kMapSizeOffset, static_cast<uint32_t>(size));
    bits::store32(base + kTreeChecksumOffset, bits::load32(tree_.bytes() + compact_header::kChecksumOffset));
    bits::store32(base + kBricksOffset, bricks_);
    bits::store32(base + kMixedOffset, mixed_);
    bits::store32(base + kMapChecksumOffset, checksum_around(base, size, kMapChecksumOffset));
    *written = size;
    return Status::kOk;
  }

  const CompactTree& tree_;
  Bytes out_;
  Vec3i min_;
  Vec3i size_;
  uint32_t cells_ = 0;
  uint32_t bricks_ = 0;
  uint32_t mixed_ = 0;
  uint32_t first_node_ = 0;
  uint16_t solid_[256];
};

}  // namespace

Status BrickMap::open(ConstBytes bytes, BrickMap* map) {
  if (!is_aligned(bytes.data)) {
    return Status::kBadArgument;
  }
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_one(bytes)) {
      return DeepMap::open(bytes, map);
    }
  }
  MapHeader header{};
  if (read_map_header(bytes, &header) != nullptr || check_numbers(bytes.data, header) != nullptr) {
    return Status::kDamaged;
  }
  BrickMap result;
  result.directory_ = bytes.data + kBrickMapHeaderBytes;
  result.bricks_ = bytes.data + bricks_at(header.cells);
  result.origins_ = bytes.data + origins_at(header.cells, header.bricks);
  result.materials_ = bytes.data + materials_at(header.cells, header.bricks, header.mixed);
  result.box_ = header.box;
  result.size_bytes_ = bits::load32(bytes.data + kMapSizeOffset);
  result.cells_ = header.cells;
  result.brick_count_ = header.bricks;
  result.mixed_count_ = header.mixed;
  result.tree_checksum_ = bits::load32(bytes.data + kTreeChecksumOffset);
  result.level_ = static_cast<uint8_t>(header.level);
  *map = result;
  return Status::kOk;
}

const char* BrickMap::validate(ConstBytes bytes) {
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_one(bytes)) {
      return DeepMap::validate(bytes);
    }
  }
  MapHeader header{};
  if (const char* text = read_map_header(bytes, &header)) {
    return text;
  }
  const uint8_t* base = bytes.data;
  const uint32_t size = bits::load32(base + kMapSizeOffset);
  if (checksum_around(base, size, kMapChecksumOffset) != bits::load32(base + kMapChecksumOffset)) {
    return "checksum does not match";
  }
  return check_numbers(base, header);
}

Status BrickMap::make(const CompactTree& tree, Bytes out, BrickMap* map, size_t* size) {
  if (tree.bytes() == nullptr || tree.level() < kMinBrickMapLevel || tree.level() > kMostMapLevel) {
    return Status::kOutOfRange;
  }
  if (!is_aligned(out.data)) {
    return Status::kBadArgument;
  }
  size_t written = 0;
  Status status = Status::kOk;
  if (!DeepMap::is_deep(tree.level())) {
    status = MapBuilder(tree, out).run(&written);
  } else if constexpr (kDeepWorlds) {
    status = DeepMap::make(tree, out, &written);
  }
  if (status != Status::kOk) {
    return status;
  }
  if (size != nullptr) {
    *size = written;
  }
  return map == nullptr ? Status::kOk : open(out.subspan(0, written), map);
}

size_t most_brick_map_bytes(const CompactTree& tree) {
  if (tree.bytes() == nullptr || tree.level() < kMinBrickMapLevel || tree.level() > kMostMapLevel) {
    return 0;
  }
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_deep(tree.level())) {
      return DeepMap::most_bytes(tree);
    }
  }
  return most_brick_map_bytes(tree.level());
}

bool BrickMap::belongs_to(const CompactTree& tree) const {
  return directory_ != nullptr && tree.bytes() != nullptr && tree.level() == level_ &&
         bits::load32(tree.bytes() + compact_header::kChecksumOffset) == tree_checksum_;
}

[[THIMBLE_HOT]] uint8_t BrickMap::mixed_material(const CompactTree& tree, uint32_t number,
                                                 unsigned bit) const {
  const uint8_t* origin = origins_ + kOriginBytes * (number - 1);
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_deep(level_)) {
      origin = DeepMap::origin(*this, number);
      if (origin == nullptr) {
        return materials_[number];
      }
    }
  }
  origin = static_cast<const uint8_t*>(__builtin_assume_aligned(origin, 4));
  const uint32_t children = bits::load32(origin);
  const unsigned octant = (bit >> 1 & 1U) | (bit >> 2 & 2U) | (bit >> 3 & 4U);
  const unsigned voxel = (bit & 1U) | (bit >> 1 & 2U) | (bit >> 2 & 4U);
  // The masks of the brick's nodes of level 1 up to the one in question stand side by side.
  const uint32_t before = bits::popcount8(children >> kChildBits & ((1U << octant) - 1));
  const uint32_t first = children & ((uint32_t{1} << kChildBits) - 1);
  if (first + before >= tree.node_count()) {
    return 0;
  }
  const uint8_t* masks = tree.masks() + first;
  const unsigned shift = 8 * (before & 3U);
  const uint32_t last = bits::load32(masks + (before & 4U));
  if ((last >> shift & 255U) == 0) {
    uint32_t block = bits::load32(origin + 8);
    for (uint32_t child = 0; child < before; ++child) {
      block += masks[child] == 0 ? 1U : 0U;
    }
    return tree.material_of_block(block);
  }
  uint32_t count = bits::load32(origin + 4) + bits::popcount32(last & ((1U << (shift + voxel)) - 1));
  if (before >= 4) {
    count += bits::popcount32(bits::load32(masks));
  }
  return tree.voxel_material(tree.node_count() + count);
}

}  // namespace thimble
