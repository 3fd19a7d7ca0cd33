// The bytes of a brick map: opening, checking, building. src/FORMAT.md is the specification.
#include "thimble/brick_map.h"

#include "bits.h"
#include "compact_header.h"
#include "thimble/crc32.h"

namespace thimble {
namespace {

constexpr uint32_t kMagic = 0x014D4254;  // "TBM", then the version, 1
constexpr uint32_t kLevelOffset = 4;
constexpr uint32_t kBoxMinOffset = 5;
constexpr uint32_t kSizeOffset = 8;
constexpr uint32_t kChecksumOffset = 12;
constexpr uint32_t kChecksumStart = 16;
constexpr uint32_t kTreeChecksumOffset = 16;
constexpr uint32_t kBoxSizeOffset = 20;
constexpr uint32_t kBricksOffset = 24;
constexpr uint32_t kFirstNodeOffset = 28;

// A source below this is a node of level 2, counted from the first of that level; from it on the low byte is
// the material of all that is seen of the brick.
constexpr uint32_t kUniform = 0xFF00;

struct Header {
  int level;
  Vec3i min;
  Vec3i size;
  uint32_t cells;
  uint32_t bricks;
};

size_t sources_at(uint32_t cells, uint32_t bricks) {
  return kBrickMapHeaderBytes + ((2 * size_t{cells} + 3) & ~size_t{3}) + 8 * size_t{bricks};
}
size_t bricks_at(uint32_t cells) {
  return sources_at(cells, 0);
}

const char* read_header(ConstBytes bytes, Header* header) {
  if (bytes.size < kBrickMapHeaderBytes || bits::load32(bytes.data) != kMagic) {
    return "not a brick map of this version";
  }
  const uint8_t* base = bytes.data;
  header->level = base[kLevelOffset];
  if (header->level < kMinBrickMapLevel || header->level > kMaxBrickMapLevel) {
    return "level out of range";
  }
  const int32_t side = int32_t{1} << (header->level - 2);
  header->cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    header->min[axis] = base[kBoxMinOffset + static_cast<uint32_t>(axis)];
    header->size[axis] = base[kBoxSizeOffset + static_cast<uint32_t>(axis)];
    if (header->min[axis] + header->size[axis] > side) {
      return "box outside the world";
    }
    header->cells *= static_cast<uint32_t>(header->size[axis]);
  }
  header->bricks = bits::load16(base + kBricksOffset);
  const uint32_t size = bits::load32(base + kSizeOffset);
  if (header->bricks == 0 || size != brick_map_bytes(header->cells, header->bricks)) {
    return "size does not match the counts";
  }
  return size > bytes.size ? "truncated" : nullptr;
}

bool aligned(const uint8_t* data) {
  return (reinterpret_cast<size_t>(data) & 3U) == 0;
}

// Bits of a brick whose octants (as bits) `octant` and voxels of it `mask` are solid.
uint64_t spread(unsigned octant, unsigned mask) {
  uint64_t brick = 0;
  const unsigned corner = (octant & 1U) * 2 + (octant >> 1 & 1U) * 8 + (octant >> 2) * 32;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((mask >> bit & 1U) != 0) {
      brick |= uint64_t{1} << (corner + (bit & 1U) + (bit >> 1 & 1U) * 4 + (bit >> 2) * 16);
    }
  }
  return brick;
}

uint64_t bits_of_node(const CompactTree& tree, uint32_t node) {
  const unsigned mask = tree.mask(node);
  if (mask == 0) {
    return ~uint64_t{0};
  }
  uint64_t brick = 0;
  uint32_t child = tree.first_child(node);
  for (unsigned octant = 0; octant < 8; ++octant) {
    if ((mask >> octant & 1U) != 0) {
      if (child < tree.node_count()) {
        const unsigned voxels = tree.mask(child);
        brick |= spread(octant, voxels == 0 ? 0xFFU : voxels);
      }
      ++child;
    }
  }
  return brick;
}

uint8_t material_in_node(const CompactTree& tree, uint32_t node, unsigned bit) {
  const unsigned octant = (bit >> 1 & 1U) | (bit >> 3 & 1U) << 1 | (bit >> 5 & 1U) << 2;
  const unsigned voxel = (bit & 1U) | (bit >> 2 & 1U) << 1 | (bit >> 4 & 1U) << 2;
  if (node >= tree.node_count()) {
    return 0;
  }
  const unsigned mask = tree.mask(node);
  if (mask == 0) {
    return tree.block_material(node);
  }
  const uint32_t child = tree.first_child(node) + bits::popcount8(mask & ((1U << octant) - 1));
  if (child >= tree.node_count()) {
    return 0;
  }
  const unsigned voxels = tree.mask(child);
  if (voxels == 0) {
    return tree.block_material(child);
  }
  return tree.voxel_material(tree.first_child(child) + bits::popcount8(voxels & ((1U << voxel) - 1)));
}

// A map in the making: directory and bricks as they will be, sources from the end of the bytes downwards.
class Builder {
 public:
  Builder(const CompactTree& tree, Bytes out) : tree_(tree), out_(out) {
    for (uint16_t& number : solid_) {
      number = 0;
    }
    const VoxelBox& bounds = tree.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      min_[axis] = bounds.min[axis] >> 2;
      size_[axis] = tree.empty() ? 0 : ((bounds.max[axis] + 3) >> 2) - min_[axis];
    }
    cells_ = static_cast<uint32_t>(size_.x * size_.y * size_.z);
  }

  Status run(size_t* written) {
    if (out_.size < brick_map_bytes(cells_, 1)) {
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
    if (out_.size < brick_map_bytes(cells_, bricks_ + 1)) {
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

  // Depth first over the nodes of level 2 and up.
  Status place_all() {
    struct Frame {
      uint32_t child;
      uint8_t mask;
      uint8_t next;
    } stack[kMaxBrickMapLevel + 1];
    const int top = tree_.level();
    int level = top;
    uint32_t node = 0;
    Vec3i corner;
    bool arrive = true;
    bool first = true;
    while (level <= top) {
      if (arrive) {
        arrive = false;
        const bool known = node < tree_.node_count();
        const unsigned mask = known ? tree_.mask(node) : 0;
        if (!known || mask == 0 || level == 2) {
          Status status = Status::kOk;
          uint32_t number = 0;
          if (known && mask == 0) {
            status = solid(tree_.block_material(node), &number);
          } else if (known) {
            if (first) {
              first_node_ = node;
              first = false;
            }
            const uint32_t where = node - first_node_;
            status = where < kUniform ? add(bits_of_node(tree_, node), where, &number) : Status::kOutOfRange;
          }
          if (status != Status::kOk) {
            return status;
          }
          enter(corner, level, number);
          ++level;
          continue;
        }
        stack[level] = {tree_.first_child(node), static_cast<uint8_t>(mask), 0};
      }
      Frame& frame = stack[level];
      while (frame.next < 8 && (frame.mask >> frame.next & 1) == 0) {
        ++frame.next;
      }
      if (frame.next == 8) {
        ++level;
        continue;
      }
      const unsigned octant = frame.next++;
      node = frame.child++;
      --level;
      const int32_t side = int32_t{1} << (level - 2);
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = (corner[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
      }
      arrive = true;
    }
    return Status::kOk;
  }

  bool is_solid(const Vec3i& voxel) const {
    const Vec3i at{voxel.x >> 2, voxel.y >> 2, voxel.z >> 2};
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) {
      return false;
    }
    const uint32_t number =
        bits::load16(cell(static_cast<uint32_t>((at.z * size_.y + at.y) * size_.x + at.x)));
    const int bit = (voxel.x & 3) + 4 * (voxel.y & 3) + 16 * (voxel.z & 3);
    return (brick(number)[bit >> 3] >> (bit & 7) & 1) != 0;
  }

  // Whether a ray can come to `voxel` from an empty neighbour: one of 26, since it may pass through an edge
  // or a corner between solid ones.
  bool is_seen(const Vec3i& voxel) const {
    for (int32_t z = -1; z <= 1; ++z) {
      for (int32_t y = -1; y <= 1; ++y) {
        for (int32_t x = -1; x <= 1; ++x) {
          if (!is_solid({voxel.x + x, voxel.y + y, voxel.z + z})) {
            return true;
          }
        }
      }
    }
    return false;
  }

  // Where all that can be seen of a brick has one material, its source says so; where such a brick is solid
  // through, it is the shared one of that material.
  void share_uniform() {
    Vec3i at;
    for (uint32_t index = 0; index < cells_; ++index) {
      const uint32_t number = bits::load16(cell(index));
      const uint32_t where = bits::load16(source(number));
      if (where < kUniform) {
        const uint64_t brick_bits = bits::load64(brick(number));
        int material = -1;
        bool uniform = true;
        for (int32_t bit = 0; bit < 64 && uniform; ++bit) {
          if ((brick_bits >> bit & 1U) != 0 &&
              is_seen({4 * at.x + (bit & 3), 4 * at.y + (bit >> 2 & 3), 4 * at.z + (bit >> 4)})) {
            const int own = material_in_node(tree_, first_node_ + where, static_cast<unsigned>(bit));
            uniform = material < 0 || material == own;
            material = own;
          }
        }
        if (uniform) {
          const uint8_t seen = static_cast<uint8_t>(material < 0 ? 0 : material);
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

  // Cell `index` takes the shared solid brick; the last brick moves into the place of `number`.
  void share(uint32_t index, uint32_t number, uint8_t material) {
    if (solid_[material] == 0) {
      solid_[material] = static_cast<uint16_t>(number);
      return;
    }
    bits::store16(cell(index), solid_[material]);
    const uint32_t last = --bricks_;
    if (number == last) {
      return;
    }
    for (int at = 0; at < 8; ++at) {
      brick(number)[at] = brick(last)[at];
    }
    bits::store16(source(number), bits::load16(source(last)));
    for (uint16_t& solid : solid_) {
      if (solid == last) {
        solid = static_cast<uint16_t>(number);
      }
    }
    for (uint32_t other = 0; other < cells_; ++other) {
      if (bits::load16(cell(other)) == last) {
        bits::store16(cell(other), number);
      }
    }
  }

  Status finish(size_t* written) {
    const size_t size = brick_map_bytes(cells_, bricks_);
    // The sources move behind the bricks, turned around; through the bytes between, from both ends inwards,
    // so that none is overwritten before it was read.
    uint8_t* front = out_.data + sources_at(cells_, bricks_);
    uint8_t* back = source(bricks_ - 1);
    for (uint32_t low = 0, high = bricks_ - 1; low < high; ++low, --high) {
      const uint32_t one = bits::load16(back + 2 * size_t{low});
      bits::store16(back + 2 * size_t{low}, bits::load16(back + 2 * size_t{high}));
      bits::store16(back + 2 * size_t{high}, one);
    }
    for (size_t at = 0; at < 2 * size_t{bricks_}; ++at) {
      front[at] = back[at];
    }
    for (size_t at = sources_at(cells_, bricks_) + 2 * size_t{bricks_}; at < size; ++at) {
      out_[at] = 0;
    }
    uint8_t* base = out_.data;
    bits::store32(base, kMagic);
    base[kLevelOffset] = static_cast<uint8_t>(tree_.level());
    for (int axis = 0; axis < 3; ++axis) {
      base[kBoxMinOffset + static_cast<uint32_t>(axis)] = static_cast<uint8_t>(min_[axis]);
      base[kBoxSizeOffset + static_cast<uint32_t>(axis)] = static_cast<uint8_t>(size_[axis]);
    }
    bits::store32(base + kSizeOffset, static_cast<uint32_t>(size));
    bits::store32(base + kTreeChecksumOffset, bits::load32(tree_.bytes() + compact_header::kChecksumOffset));
    bits::store32(base + kBricksOffset, bricks_);
    bits::store32(base + kFirstNodeOffset, first_node_);
    bits::store32(base + kChecksumOffset,
                  crc32({base + kChecksumStart, size - kChecksumStart}, crc32({base, kChecksumOffset})));
    *written = size;
    return Status::kOk;
  }

  const CompactTree& tree_;
  Bytes out_;
  Vec3i min_;
  Vec3i size_;
  uint32_t cells_ = 0;
  uint32_t bricks_ = 0;
  uint32_t first_node_ = 0;
  uint16_t solid_[256];
};

}  // namespace

Status BrickMap::open(ConstBytes bytes, BrickMap* map) {
  if (!aligned(bytes.data)) {
    return Status::kBadArgument;
  }
  Header header{};
  if (read_header(bytes, &header) != nullptr) {
    return Status::kDamaged;
  }
  BrickMap result;
  result.directory_ = bytes.data + kBrickMapHeaderBytes;
  for (uint32_t cell = 0; cell < header.cells; ++cell) {
    if (bits::load16(result.directory_ + 2 * size_t{cell}) >= header.bricks) {
      return Status::kDamaged;
    }
  }
  result.bricks_ = bytes.data + bricks_at(header.cells);
  result.sources_ = bytes.data + sources_at(header.cells, header.bricks);
  result.box_.min = header.min;
  for (int axis = 0; axis < 3; ++axis) {
    result.box_.max[axis] = header.min[axis] + header.size[axis];
  }
  result.size_bytes_ = bits::load32(bytes.data + kSizeOffset);
  result.cells_ = header.cells;
  result.brick_count_ = header.bricks;
  result.first_node_ = bits::load32(bytes.data + kFirstNodeOffset);
  result.tree_checksum_ = bits::load32(bytes.data + kTreeChecksumOffset);
  result.level_ = static_cast<uint8_t>(header.level);
  *map = result;
  return Status::kOk;
}

const char* BrickMap::validate(ConstBytes bytes) {
  Header header{};
  if (const char* text = read_header(bytes, &header)) {
    return text;
  }
  const uint8_t* base = bytes.data;
  const ConstBytes checked{base + kChecksumStart, bits::load32(base + kSizeOffset) - kChecksumStart};
  if (crc32(checked, crc32({base, kChecksumOffset})) != bits::load32(base + kChecksumOffset)) {
    return "checksum does not match";
  }
  for (uint32_t cell = 0; cell < header.cells; ++cell) {
    if (bits::load16(base + kBrickMapHeaderBytes + 2 * size_t{cell}) >= header.bricks) {
      return "a cell names a brick that is not there";
    }
  }
  return bits::load64(base + bricks_at(header.cells)) != 0 ? "brick 0 is not empty" : nullptr;
}

Status BrickMap::build(const CompactTree& tree, Bytes out, size_t* written) {
  if (tree.bytes() == nullptr || tree.level() < kMinBrickMapLevel || tree.level() > kMaxBrickMapLevel) {
    return Status::kOutOfRange;
  }
  if (!aligned(out.data)) {
    return Status::kBadArgument;
  }
  return Builder(tree, out).run(written);
}

bool BrickMap::belongs_to(const CompactTree& tree) const {
  return directory_ != nullptr && tree.bytes() != nullptr && tree.level() == level_ &&
         bits::load32(tree.bytes() + compact_header::kChecksumOffset) == tree_checksum_;
}

uint32_t BrickMap::node_of(uint32_t number) const {
  const uint32_t where = bits::load16(sources_ + 2 * size_t{number});
  return where < kUniform ? first_node_ + where : UINT32_MAX;
}

uint8_t BrickMap::material(const CompactTree& tree, uint32_t number, unsigned bit) const {
  const uint32_t where = bits::load16(sources_ + 2 * size_t{number});
  return where < kUniform ? material_in_node(tree, first_node_ + where, bit) : static_cast<uint8_t>(where);
}

}  // namespace thimble
