// Writing compact trees. Octrees and parts are walked level by level, twice: once into a counter that finds
// the shape, once into a writer. Sorted keys are read twice in all: all levels are written side by side.
#include "../base/bits.h"
#include "../base/fault.h"
#include "compact_header.h"
#include "thimble/base/memory.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace thimble {
namespace {

// Finds the shape, volume, bounds and materials of what a walk shows it.
struct Counter {
  CompactShape shape;
  uint64_t volume = 0;
  VoxelBox bounds;
  int first_material = -1;
  bool overflow = false;

  void see_material(uint8_t material) {
    if (first_material < 0) {
      first_material = material;
    }
    if (material != first_material) {
      shape.many_materials = true;
    }
  }
  void inner(unsigned) { count_node(); }
  void solid(const Vec3i& corner, int level, uint8_t material, bool merged) {
    count_node();
    ++shape.solid_blocks;
    shape.merged = shape.merged || merged;
    volume += uint64_t{1} << (3 * level);
    grow_box(&bounds, corner, level, 0);
    see_material(material);
  }
  void voxels(const Vec3i& corner, unsigned mask, const uint8_t (&materials)[8]) {
    count_node();
    const unsigned count = bits::popcount8(mask);
    if (shape.voxel_bits > UINT32_MAX - count) {
      overflow = true;
    }
    shape.voxel_bits += count;
    volume += count;
    grow_box(&bounds, corner, 1, mask);
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (((mask >> octant) & 1U) != 0) {
        see_material(materials[octant]);
      }
    }
  }
  void count_node() {
    if (++shape.nodes == 0) {
      overflow = true;
    }
  }
};

// Writes masks, merged bits and materials in the order of the walk.
struct Writer {
  uint8_t* masks;
  uint8_t* merged_bits;      // null when nothing is merged
  uint8_t* block_materials;  // null when there is one material
  uint8_t* voxel_materials;
  uint32_t index = 0;

  void inner(unsigned mask) { masks[index++] = static_cast<uint8_t>(mask); }
  void solid(const Vec3i&, int, uint8_t material, bool merged) {
    if (merged) {
      merged_bits[index >> 3] = static_cast<uint8_t>(merged_bits[index >> 3] | 1U << (index & 7U));
    }
    masks[index++] = 0;
    if (block_materials != nullptr) {
      *block_materials++ = material;
    }
  }
  void voxels(const Vec3i&, unsigned mask, const uint8_t (&materials)[8]) {
    masks[index++] = static_cast<uint8_t>(mask);
    if (voxel_materials == nullptr) {
      return;
    }
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (((mask >> octant) & 1U) != 0) {
        *voxel_materials++ = materials[octant];
      }
    }
  }
};

// Sorted keys as a source. `Key` is a bare code (32 bits) or a code above an 8-bit material (64 bits).
//
// How far two neighbouring keys are apart says where nodes begin: keys that first differ in the octant at
// level g (0: both in one node of level 1) begin a new node on each of the levels 1 to g. So all levels can
// be counted and written in one pass, each at a place of its own, and no key is compared with any but its
// neighbour. A block that is full is found when its last voxel comes: unique keys fill a block of level n
// just when the key 8^n - 1 places before is its first voxel. Its eight children are then taken back.
template <class Key>
struct KeySource {
  static constexpr int kCodeShift = sizeof(Key) == 4 ? 0 : 8;
  Span<const Key> keys;
  int world_level;
  uint8_t material_of_all;
  // Found by `count`.
  // Where the nodes and solid blocks of each level end, levels one after another from the highest down; while
  // they are counted, how many there are.
  uint32_t node_ends[kMaxLevel + 1] = {};
  uint32_t block_ends[kMaxLevel + 1] = {};
  uint32_t voxels = 0;

  int level() const { return world_level; }
  uint64_t solid_added() const { return 0; }
  Key code(size_t i) const { return keys[i] >> kCodeShift; }
  uint8_t material(size_t i) const {
    return kCodeShift == 0 ? material_of_all : static_cast<uint8_t>(keys[i] & 0xFFU);
  }
  // The highest level whose octant differs between two codes, less one; 0 also for equal ones.
  static unsigned level_apart(Key a, Key b) {
    const Key differing = a ^ b;
    if constexpr (kCodeShift != 0) {
      const uint32_t upper = static_cast<uint32_t>(differing >> 18);
      if (upper != 0) {
        return 6 + group(upper);
      }
      return group(static_cast<uint32_t>(differing));
    } else {
      return group(differing);
    }
  }
  // The group of three bits that holds the highest set bit.
  static unsigned group(uint32_t word) {
    return static_cast<unsigned>(bits::highest_bit(word | 1U)) * 11U >> 5;  // a third, for 0..31
  }
  // Level of the largest block, of one material and less than the world's parent, that key i is the last
  // voxel of; 0 when there is none. Keys from `run` on to i have one material.
  int block_filled(size_t i, size_t run) const {
    int filled = 0;
    while (filled < world_level) {
      const Key inside = static_cast<Key>((uint64_t{1} << (3 * (filled + 1))) - 1);
      if ((code(i) & inside) != inside || i - run < inside ||
          code(i - static_cast<size_t>(inside)) != code(i) - inside) {
        break;
      }
      ++filled;
    }
    return filled;
  }

  Counter count();
  void write_nodes(Writer* writer) const;
};

// Apart from its caller, so that its tables do not lie on the stack beside those of `write_nodes`.
template <class Key>
[[gnu::noinline]] Counter KeySource<Key>::count() {
  Counter counter;
  counter.shape.level = world_level;
  if (keys.size == 0) {
    return counter;
  }
  // Bits of one axis order voxels as that axis does.
  constexpr Key kAxis = static_cast<Key>(0x1249249249249249ULL);
  Key low[3];
  Key high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = high[axis] = code(0) & static_cast<Key>(kAxis << axis);
  }
  uint32_t apart[16] = {};  // pairs of neighbours by where they differ
  uint32_t blocks = 0;
  size_t run = 0;
  counter.see_material(material(0));
  for (size_t i = 1; i < keys.size; ++i) {
    const Key here = code(i);
    ++apart[level_apart(here, code(i - 1)) & 15U];
    for (int axis = 0; axis < 3; ++axis) {
      const Key along = here & static_cast<Key>(kAxis << axis);
      low[axis] = along < low[axis] ? along : low[axis];
      high[axis] = along > high[axis] ? along : high[axis];
    }
    if (kCodeShift != 0 && material(i) != material(i - 1)) {
      counter.see_material(material(i));
      run = i;
    }
    if ((here & 7U) != 7U) {
      continue;
    }
    const int filled = block_filled(i, run);
    for (int level = 1; level <= filled; ++level) {
      ++block_ends[level];
    }
  }
  uint64_t nodes = 0;
  uint64_t begun = 1;
  uint64_t left = keys.size;
  for (int level = world_level; level >= 1; --level) {
    begun += apart[level];
    nodes += begun;
    node_ends[level] = static_cast<uint32_t>(begun);
  }
  // Blocks within larger ones are taken back.
  for (int level = 1; level <= world_level; ++level) {
    const uint32_t within = level < world_level ? 8 * block_ends[level + 1] : 0;
    if (level == 1) {
      left -= uint64_t{8} * block_ends[1];
    }
    block_ends[level] -= within;
    node_ends[level] -= within;
    nodes -= within;
    blocks += block_ends[level];
  }
  for (int level = world_level - 1; level >= 1; --level) {
    node_ends[level] += node_ends[level + 1];
    block_ends[level] += block_ends[level + 1];
  }
  counter.overflow = nodes > UINT32_MAX || left > UINT32_MAX;
  voxels = static_cast<uint32_t>(left);
  counter.shape.nodes = static_cast<uint32_t>(nodes);
  counter.shape.voxel_bits = voxels;
  counter.shape.solid_blocks = blocks;
  counter.volume = keys.size;
  for (int axis = 0; axis < 3; ++axis) {
    counter.bounds.low[axis] = morton_voxel(low[axis])[axis];
    counter.bounds.high[axis] = morton_voxel(high[axis])[axis] + 1;
  }
  return counter;
}

template <class Key>
[[gnu::noinline]] void KeySource<Key>::write_nodes(Writer* writer) const {
  if (keys.size == 0) {
    return;
  }
  // Of each level: the node being written, its mask so far, and where the next solid block's material goes.
  // What is going to be taken back may lie beyond a level's end, where another level begins: it is left out.
  struct Place {
    uint32_t node;
    uint32_t block;
    unsigned mask;
  } places[kMaxLevel + 1] = {};
  for (int level = world_level - 1; level >= 1; --level) {
    places[level] = {node_ends[level + 1], block_ends[level + 1], 0};
  }
  uint32_t voxel = 0;  // number of the next one's material
  size_t run = 0;
  for (size_t i = 0; i < keys.size; ++i) {
    const Key here = code(i);
    // The first key finds all nodes begun.
    const int apart = i == 0 ? 0 : static_cast<int>(level_apart(here, code(i - 1)));
    const auto add = [&](int level) {
      Place& place = places[level];
      const bool is_new = level <= apart;
      place.node += is_new ? 1 : 0;
      place.mask = (is_new ? 0U : place.mask) | 1U << ((here >> (3 * (level - 1))) & 7U);
      if (place.node < node_ends[level]) {
        writer->masks[place.node] = static_cast<uint8_t>(place.mask);
      }
    };
    // Neighbours in random order differ on any of the lowest levels: to write those always costs less than to
    // guess. A level above the highest new one gets the bit of a child that it may have already.
    const int last = i == 0 || apart >= world_level ? world_level : apart + 1;
    int level = 1;
    if (world_level >= 3) {
      add(1);
      add(2);
      add(3);
      level = 4;
    }
    for (; level <= last; ++level) {
      add(level);
    }
    if (kCodeShift != 0 && writer->voxel_materials != nullptr) {
      if (voxel < voxels) {
        writer->voxel_materials[voxel] = material(i);
      }
      ++voxel;
      run = i != 0 && material(i) != material(i - 1) ? i : run;
    }
    if ((here & 7U) != 7U) {
      continue;
    }
    const int filled = block_filled(i, run);
    for (int full = 1; full <= filled; ++full) {
      Place& place = places[full];
      if (place.node < node_ends[full]) {
        writer->masks[place.node] = 0;
      }
      if (full > 1) {
        places[full - 1].node -= 8;
        places[full - 1].block -= 8;
      } else {
        voxel -= 8;
      }
      if (writer->block_materials != nullptr && place.block < block_ends[full]) {
        writer->block_materials[place.block] = material(i);
      }
      ++place.block;
    }
  }
}

// A source shows a sink the nodes of a level, in Morton order, which is that level's breadth-first order.
struct OctreeSource {
  const Octree& octree;

  int level() const { return octree.level(); }
  uint64_t solid_added() const { return octree.solid_added(); }
  template <class Sink>
  void walk_level(int level, Sink* sink) const {
    // stack[k]: of the node of level k on the path, the children not yet visited.
    struct OpenNode {
      uint32_t next_child;
      uint8_t octants;
    } stack[kMaxLevel + 1];
    uint32_t index = octree.root();
    int at = octree.level();
    Vec3i corner;
    while (index != Octree::kNone) {
      const Octree::NodeView node = octree.node(index);
      if (at == level) {
        show(node, corner, level, sink);
      }
      stack[at] = {Octree::kNone, 0};
      if (at > level && node.mask != 0) {
        stack[at] = {node.first_child, node.mask};
      }
      // The next node in order: the first child not yet visited of the lowest node on the path that has one.
      while (at <= octree.level() && stack[at].octants == 0) {
        ++at;
      }
      if (at > octree.level()) {
        return;
      }
      OpenNode& frame = stack[at];
      const unsigned octant = bits::lowest_bit(frame.octants);
      frame.octants = static_cast<uint8_t>(frame.octants & (frame.octants - 1U));
      index = frame.next_child;
      frame.next_child =
          index == Octree::kNone || frame.octants == 0 ? Octree::kNone : octree.node(index).next;
      move_to_octant(octant, --at, &corner);
    }
  }
  template <class Sink>
  void show(const Octree::NodeView& node, const Vec3i& corner, int level, Sink* sink) const {
    if (node.mask == 0) {
      sink->solid(corner, level, node.material, node.merged);
      return;
    }
    if (level > 1) {
      sink->inner(node.mask);
      return;
    }
    uint8_t materials[8] = {};
    uint32_t voxel = node.first_child;
    for (unsigned left = node.mask; left != 0; left &= left - 1) {
      uint8_t& material = materials[bits::lowest_bit(left)];
      material = node.material;
      if (node.has_children && voxel != Octree::kNone) {
        const Octree::NodeView view = octree.node(voxel);
        material = view.material;
        voxel = view.next;
      }
    }
    sink->voxels(corner, node.mask, materials);
  }
};

// The parts of a world, in Morton order, as a source. Nodes above the parts are made of ranges of them: a
// node of level `part_level` + k of 8^k parts.
struct PartsSource {
  Span<const CompactTree> parts;
  int part_level;
  int world_level;

  int level() const { return world_level; }
  uint64_t solid_added() const {
    uint64_t sum = 0;
    for (const CompactTree& part : parts) {
      sum += part.solid_added();
    }
    return sum;
  }
  bool empty(size_t first, size_t count) const {
    for (size_t i = first; i < first + count; ++i) {
      if (!parts[i].empty()) {
        return false;
      }
    }
    return true;
  }
  // Whether the range is one solid block: all parts solid through, of one material, all merged or all truly
  // full.
  bool uniform(size_t first, size_t count) const {
    const CompactTree& one = parts[first];
    for (size_t i = first; i < first + count; ++i) {
      const CompactTree& part = parts[i];
      if (part.empty() || part.mask(0) != 0 || part.is_merged(0) != one.is_merged(0) ||
          part.block_material(0) != one.block_material(0)) {
        return false;
      }
    }
    return true;
  }

  // `origin` is where the part's lowest corner lies.
  template <class Sink>
  static void walk_part(const CompactTree& part, const Vec3i& origin, int level, Sink* sink) {
    walk_leaves(part, level, [&](uint32_t node, const Vec3i& corner, int at) {
      if (at != level) {
        return true;  // a block of another level
      }
      const bool is_there = node < part.node_count();  // else it is a damaged tree
      const unsigned mask = is_there ? part.mask(node) : 0;
      const Vec3i place{origin.x + corner.x, origin.y + corner.y, origin.z + corner.z};
      if (mask == 0) {
        sink->solid(place, level, is_there ? part.block_material(node) : uint8_t{0},
                    is_there && part.is_merged(node));
      } else if (level > 1) {
        sink->inner(mask);
      } else {
        uint8_t materials[8] = {};
        uint32_t number = part.first_child(node);
        for (unsigned left = mask; left != 0; left &= left - 1) {
          materials[bits::lowest_bit(left)] = part.voxel_material(number++);
        }
        sink->voxels(place, mask, materials);
      }
      return true;
    });
  }
  template <class Sink>
  void walk_level(int level, Sink* sink) const {
    const int above = level > part_level ? level - part_level : 0;
    const size_t count = size_t{1} << (3 * above);
    for (size_t first = 0; first < parts.size; first += count) {
      const size_t parent = first & ~(8 * count - 1);
      if (empty(first, count) || (8 * count <= parts.size && uniform(parent, 8 * count))) {
        continue;
      }
      Vec3i origin = morton_voxel(first);
      for (int axis = 0; axis < 3; ++axis) {
        origin[axis] *= int32_t{1} << part_level;
      }
      if (above == 0) {
        walk_part(parts[first], origin, level, sink);
      } else if (uniform(first, count)) {
        sink->solid(origin, level, parts[first].block_material(0), parts[first].is_merged(0));
      } else {
        unsigned mask = 0;
        for (unsigned octant = 0; octant < 8; ++octant) {
          if (!empty(first + octant * (count / 8), count / 8)) {
            mask |= 1U << octant;
          }
        }
        sink->inner(mask);
      }
    }
  }
};

template <class Source>
Counter count(Source& source) {
  Counter counter;
  counter.shape.level = source.level();
  for (int level = source.level(); level >= 1; --level) {
    source.walk_level(level, &counter);
  }
  return counter;
}

template <class Key>
Counter count(KeySource<Key>& source) {
  return source.count();
}

template <class Source>
void write_nodes(const Source& source, Writer* writer) {
  for (int level = source.level(); level >= 1; --level) {
    source.walk_level(level, writer);
  }
}

template <class Key>
void write_nodes(const KeySource<Key>& source, Writer* writer) {
  source.write_nodes(writer);
}

void write_directory(const CompactShape& shape, uint8_t* base, const CompactSections& at) {
  const bool block_ranks = shape.many_materials && shape.solid_blocks != 0;
  uint32_t children = 0;
  uint32_t solid_blocks = 0;
  for (uint32_t index = 0; index < shape.nodes; ++index) {
    if ((index & ((1U << shape.rank_shift) - 1)) == 0) {
      const size_t block = index >> shape.rank_shift;
      bits::store32(base + at.ranks + 4 * block, children);
      if (block_ranks) {
        bits::store32(base + at.block_ranks + 4 * block, solid_blocks);
      }
    }
    const uint8_t mask = base[at.masks + index];
    children += bits::popcount8(mask);
    solid_blocks += mask == 0 ? 1U : 0U;
  }
}

template <class Source>
Status write(Source source, Bytes out, size_t* size, int rank_shift) {
  using namespace compact_header;
  if (rank_shift < kMinRankShift || rank_shift > kMaxRankShift) {
    return Status::kOutOfRange;
  }
  Counter counter = count(source);
  CompactShape& shape = counter.shape;
  shape.rank_shift = rank_shift;
  const size_t bytes = counter.overflow ? 0 : compact_bytes(shape);
  if (size != nullptr) {
    *size = bytes;
  }
  if (bytes == 0) {
    return Status::kOutOfRange;
  }
  if (bytes > out.size) {
    return Status::kOutOfMemory;
  }

  uint8_t* base = out.data;
  const CompactSections at = sections_of(shape);
  // Everything behind the masks starts as 0: padding, and bits that are set one by one.
  for (size_t i = at.masks + shape.nodes; i < bytes; ++i) {
    base[i] = 0;
  }
  Writer writer{base + at.masks, base + at.merged, nullptr, nullptr};
  if (shape.many_materials) {
    writer.block_materials = base + at.materials;
    writer.voxel_materials = base + at.materials + shape.solid_blocks;
  }
  write_nodes(source, &writer);
  write_directory(shape, base, at);

  bits::store32(base, kMagic);
  base[kLevelOffset] = static_cast<uint8_t>(shape.level);
  base[kRankShiftOffset] = static_cast<uint8_t>(shape.rank_shift);
  base[kFlagsOffset] = static_cast<uint8_t>((shape.many_materials ? kManyMaterialsFlag : 0U) |
                                            (shape.merged ? kMergedFlag : 0U));
  base[kMaterialOffset] =
      static_cast<uint8_t>(shape.many_materials || counter.first_material < 0 ? 0 : counter.first_material);
  bits::store32(base + kSizeOffset, static_cast<uint32_t>(bytes));
  bits::store32(base + kNodesOffset, shape.nodes);
  bits::store32(base + kSolidBlocksOffset, shape.solid_blocks);
  bits::store32(base + kVoxelBitsOffset, shape.voxel_bits);
  store_bounds(counter.bounds, base);
  bits::store64(base + kVoxelCountOffset, counter.volume);
  bits::store64(base + kSolidAddedOffset, source.solid_added());
  bits::store32(base + kChecksumOffset, checksum_around(base, bytes, kChecksumOffset));
  return Status::kOk;
}

template <class Source>
Status make_from(const Source& source, Bytes out, CompactTree* tree, size_t* size, int rank_shift) {
  const Status status = write(source, out, size, rank_shift);
  return status != Status::kOk || tree == nullptr ? status : CompactTree::open(out, tree);
}

}  // namespace

CompactShape compact_shape(const Octree& octree, int rank_shift) {
  const OctreeSource source{octree};
  CompactShape shape = count(source).shape;
  shape.rank_shift = rank_shift;
  return shape;
}

Status CompactTree::make(const Octree& octree, Bytes out, CompactTree* tree, size_t* size, int rank_shift) {
  return make_from(OctreeSource{octree}, out, tree, size, rank_shift);
}

Status CompactTree::make(const Octree& octree, Arena& arena, CompactTree* tree, int rank_shift) {
  if (rank_shift < kMinRankShift || rank_shift > kMaxRankShift) {
    return Status::kOutOfRange;
  }
  return make_in(arena, compact_bytes(compact_shape(octree, rank_shift)), sizeof(uint64_t),
                 [&](Bytes bytes) { return make(octree, bytes, tree, nullptr, rank_shift); });
}

Status CompactTree::make(Span<const CompactTree> parts, Bytes out, CompactTree* tree, size_t* size,
                         int rank_shift) {
  int split = 0;
  while (split < kMaxLevel && (size_t{1} << (3 * split)) < parts.size) {
    ++split;
  }
  if (parts.size == 0 || parts.size != size_t{1} << (3 * split)) {
    return Status::kBadArgument;
  }
  const int part_level = parts[0].level();
  for (const CompactTree& part : parts) {
    if (part.level() != part_level || part.bytes() == nullptr) {
      return Status::kBadArgument;
    }
  }
  if (part_level + split > kMaxLevel) {
    return Status::kOutOfRange;
  }
  return make_from(PartsSource{parts, part_level, part_level + split}, out, tree, size, rank_shift);
}

Status CompactTree::make(Span<const uint32_t> keys, int level, uint8_t material, Bytes out, CompactTree* tree,
                         size_t* size, int rank_shift) {
  if (level < kMinLevel || level > 10) {
    return Status::kOutOfRange;
  }
  return make_from(KeySource<uint32_t>{keys, level, material}, out, tree, size, rank_shift);
}

Status CompactTree::make(Span<const uint64_t> keys, int level, Bytes out, CompactTree* tree, size_t* size,
                         int rank_shift) {
  if (level < kMinLevel || level > kMaxLevel) {
    return Status::kOutOfRange;
  }
  return make_from(KeySource<uint64_t>{keys, level, 0}, out, tree, size, rank_shift);
}

}  // namespace thimble
