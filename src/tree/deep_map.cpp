// The bytes of brick maps of level 9 and 10: opening, checking, building. src/FORMAT.md is the specification.
#ifdef THIMBLE_DEEP_WORLDS
#include "deep_map.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "brick_parts.h"
#include "compact_header.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

constexpr uint32_t kDeepMagic = 0x024D4254;  // "TBM", then the version, 2
constexpr uint32_t kDeepLevelOffset = 4;
constexpr uint32_t kDeepSizeOffset = 8;
constexpr uint32_t kDeepChecksumOffset = 12;
constexpr uint32_t kDeepTreeOffset = 16;
constexpr uint32_t kDeepBoxLowOffset = 20;  // three halfwords, and three more of its size
constexpr uint32_t kDeepBoxSizeOffset = 26;
constexpr uint32_t kDeepPagesOffset = 32;
constexpr uint32_t kDeepBricksOffset = 36;
constexpr uint32_t kDeepMixedOffset = 40;
constexpr uint32_t kDeepHeaderBytes = 48;
constexpr uint32_t kDeepRankBytes = 8;  // for 32 bricks: which are mixed, and how many are before them

using brick_parts::kOriginBytes;
using deep_place::kPageEntries;
using deep_place::kPageLevel;
using deep_place::kPageSide;

// How many there are of what a map holds, and where each begins, in bytes from the map's first.
struct DeepLayout {
  uint32_t cells;  // entries of the table of pages
  uint32_t pages;
  uint32_t bricks;
  uint32_t mixed;

  size_t table_bytes() const { return (4 * size_t{cells} + 7) & ~size_t{7}; }
  size_t bricks_at() const {
    return kDeepHeaderBytes + table_bytes() + ((kPageBytes * size_t{pages} + 7) & ~size_t{7});
  }
  size_t ranks_at() const { return bricks_at() + 8 * size_t{bricks}; }
  uint32_t rank_count() const { return (bricks + 31) / 32; }
  size_t materials_at() const { return ranks_at() + kDeepRankBytes * size_t{rank_count()}; }
  size_t origins_at() const { return materials_at() + ((size_t{bricks} + 3) & ~size_t{3}); }
  size_t size() const { return origins_at() + kOriginBytes * size_t{mixed}; }
};

int32_t pages_along(int32_t bricks) {
  return (bricks + kPageSide - 1) / kPageSide;
}
// The corner of an entry's brick in a page that begins at `corner`, in voxels.
Vec3i corner_of_entry(const Vec3i& corner, uint32_t entry) {
  return {corner.x + static_cast<int32_t>(4 * (entry & 3U)),
          corner.y + static_cast<int32_t>(4 * (entry >> 2 & 3U)),
          corner.z + static_cast<int32_t>(4 * (entry >> 4))};
}
uint32_t deep_place_of(const Vec3i& brick) {
  return static_cast<uint32_t>(brick.x) | static_cast<uint32_t>(brick.y) << 8 |
         static_cast<uint32_t>(brick.z) << 16;
}
// Entries of the table up to that of the last brick of the box.
uint32_t table_cells_of(const Vec3i& size) {
  if (size.x == 0 || size.y == 0 || size.z == 0) {
    return 0;
  }
  return deep_place::page_of(deep_place_of({size.x - 1, size.y - 1, size.z - 1})) + 1;
}

struct DeepHeader {
  int level;
  VoxelBox box;
  DeepLayout layout;
};

const char* read_deep_header(ConstBytes bytes, DeepHeader* header) {
  if (bytes.size < kDeepHeaderBytes) {
    return "truncated";
  }
  const uint8_t* base = bytes.data;
  header->level = base[kDeepLevelOffset];
  if (!DeepMap::is_deep(header->level)) {
    return "level out of range";
  }
  const int32_t side = int32_t{1} << (header->level - 2);
  Vec3i size_of;
  for (int axis = 0; axis < 3; ++axis) {
    const uint8_t* const halves = base + 2 * axis;
    size_of[axis] = static_cast<int32_t>(bits::load16(halves + kDeepBoxSizeOffset));
    header->box.low[axis] = static_cast<int32_t>(bits::load16(halves + kDeepBoxLowOffset));
    header->box.high[axis] = header->box.low[axis] + size_of[axis];
    if (header->box.high[axis] > side) {
      return "box outside the world";
    }
  }
  DeepLayout& layout = header->layout;
  layout.cells = table_cells_of(size_of);
  layout.pages = bits::load32(base + kDeepPagesOffset);
  layout.bricks = bits::load32(base + kDeepBricksOffset);
  layout.mixed = bits::load32(base + kDeepMixedOffset);
  const uint32_t size = bits::load32(base + kDeepSizeOffset);
  // Each page, brick and mixed brick takes bytes, so that sums of damaged numbers do not go round.
  if (layout.pages == 0 || layout.pages > size / kPageBytes || layout.bricks == 0 ||
      layout.bricks > kMaxDeepBricks || layout.mixed >= layout.bricks || size != layout.size()) {
    return "size does not match the counts";
  }
  return size > bytes.size ? "truncated" : nullptr;
}

// Whether the table names pages, the pages bricks, and the ranks origins, all of which are there.
const char* check_deep_numbers(const uint8_t* base, const DeepLayout& layout) {
  const uint8_t* const table = base + kDeepHeaderBytes;
  const uint32_t first_page = static_cast<uint32_t>(layout.table_bytes());
  for (uint32_t cell = 0; cell < layout.cells; ++cell) {
    const uint32_t offset = bits::load32(table + 4 * size_t{cell}) - first_page;
    if (offset % kPageBytes != 0 || offset / kPageBytes >= layout.pages) {
      return "the table names a page that is not there";
    }
  }
  const uint8_t* page = table + first_page;
  for (uint32_t number = 0; number < layout.pages; ++number, page += kPageBytes) {
    const uint32_t before = bits::load32(page);
    for (uint32_t entry = 0; entry < kPageEntries; ++entry) {
      if (before >= layout.bricks || before + page[4 + entry] >= layout.bricks) {
        return "a page names a brick that is not there";
      }
      if (number == 0 && page[4 + entry] != 0) {
        return "page 0 is not empty";
      }
    }
  }
  if (bits::load64(base + layout.bricks_at()) != 0) {
    return "brick 0 is not empty";
  }
  uint32_t mixed = 0;
  const uint8_t* rank = base + layout.ranks_at();
  for (uint32_t i = 0; i < layout.rank_count(); ++i, rank += kDeepRankBytes) {
    if (bits::load32(rank + 4) != mixed) {
      return "origins are counted wrongly";
    }
    mixed += bits::popcount32(bits::load32(rank));
  }
  return mixed != layout.mixed ? "origins are counted wrongly" : nullptr;
}

// What a block of the world is: nothing, solid through, or a node with children.
enum class DeepKind : uint8_t { kEmpty, kSolid, kNode };
struct DeepBlock {
  DeepKind kind;
  uint32_t node;
};

// The block of `level` at `corner` (in voxels), from `from`, which is one of `from_level` around it.
DeepBlock find_deep_block(const CompactTree& tree, DeepBlock from, int from_level, const Vec3i& corner,
                          int level) {
  while (from.kind == DeepKind::kNode && from_level > level) {
    const unsigned octant = octant_of(corner, from_level--);
    const unsigned mask = tree.mask(from.node);
    const uint32_t child = tree.first_child(from.node) + bits::popcount8(mask & ((1U << octant) - 1));
    if ((mask >> octant & 1U) == 0 || child >= tree.node_count()) {
      return {DeepKind::kEmpty, 0};
    }
    from = {tree.mask(child) == 0 ? DeepKind::kSolid : DeepKind::kNode, child};
  }
  return from;
}

// A page of the tree: the number of each entry's brick, counted from 1 (0: empty), and what each of these is. Solid
// bricks of one material are one.
struct DeepPage {
  uint32_t bricks;
  uint8_t entry[kPageEntries];
  DeepBlock source[kPageEntries];
};

void read_deep_page(const CompactTree& tree, const DeepBlock& block, const Vec3i& corner, DeepPage* page) {
  page->bricks = 0;
  for (uint32_t i = 0; i < kPageEntries; ++i) {
    const DeepBlock brick = find_deep_block(tree, block, kPageLevel, corner_of_entry(corner, i), 2);
    uint32_t number = 0;
    if (brick.kind != DeepKind::kEmpty) {
      number = page->bricks + 1;
      for (uint32_t known = 0; known < page->bricks && brick.kind == DeepKind::kSolid; ++known) {
        if (page->source[known].kind == DeepKind::kSolid &&
            tree.block_material(page->source[known].node) == tree.block_material(brick.node)) {
          number = known + 1;
          break;
        }
      }
      if (number > page->bricks) {
        page->source[page->bricks++] = brick;
      }
    }
    page->entry[i] = static_cast<uint8_t>(number);
  }
}

class DeepBuilder {
 public:
  explicit DeepBuilder(const CompactTree& tree) : tree_(tree) {
    const VoxelBox& bounds = tree.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = bounds.low[axis] >> kPageLevel << (kPageLevel - 2);
      size_[axis] = tree.empty() ? 0 : ((bounds.high[axis] + 3) >> 2) - low_[axis];
    }
    layout_ = {table_cells_of(size_), 1, 1, 0};
  }

  // Counts pages and bricks. Returns those that may turn out to be mixed.
  uint32_t count() {
    uint32_t open = 0;
    each_page([&](uint32_t, const Vec3i&, const DeepBlock&, const DeepPage* page) {
      ++layout_.pages;
      layout_.bricks += page == nullptr ? 1 : page->bricks;
      for (uint32_t i = 0; page != nullptr && tree_.many_materials() && i < page->bricks; ++i) {
        open += page->source[i].kind == DeepKind::kNode ? 1U : 0U;
      }
    });
    return open;
  }
  const DeepLayout& layout() const { return layout_; }

  Status run(Bytes out, size_t* written) {
    count();
    if (layout_.bricks > kMaxDeepBricks) {
      return Status::kOutOfRange;
    }
    if (out.size < layout_.size()) {
      return Status::kOutOfMemory;
    }
    base_ = out.data;
    for (size_t at = 0; at < layout_.size(); ++at) {
      base_[at] = 0;
    }
    place();
    const Status status = tree_.many_materials() ? name_materials(out.size) : Status::kOk;
    if (status == Status::kOk) {
      finish();
      *written = layout_.size();
    }
    return status;
  }

 private:
  // Calls `use` for all pages that are not empty, in the order of the table: with the page's cell, its corner in voxels,
  // its block, and the page; without that for a page of a solid material whose page there is not yet.
  template <class Use>
  void each_page(const Use& use) {
    for (uint32_t& page : solid_page_) {
      page = 0;
    }
    uint32_t pages = 1;
    const DeepBlock root{tree_.empty()        ? DeepKind::kEmpty
                         : tree_.mask(0) == 0 ? DeepKind::kSolid
                                              : DeepKind::kNode,
                         0};
    for (int32_t z = 0; z < pages_along(size_.z); ++z) {
      for (int32_t y = 0; y < pages_along(size_.y); ++y) {
        for (int32_t x = 0; x < pages_along(size_.x); ++x) {
          const Vec3i brick{kPageSide * x, kPageSide * y, kPageSide * z};
          const Vec3i corner{4 * (low_.x + brick.x), 4 * (low_.y + brick.y), 4 * (low_.z + brick.z)};
          const DeepBlock block = find_deep_block(tree_, root, tree_.level(), corner, kPageLevel);
          const uint32_t cell = deep_place::page_of(deep_place_of(brick));
          if (block.kind == DeepKind::kSolid) {
            uint32_t& own = solid_page_[tree_.block_material(block.node)];
            if (own == 0) {
              own = pages++;
              use(cell, corner, block, nullptr);
            }
            if (base_ != nullptr) {
              set_cell(cell, own);
            }
          } else if (block.kind == DeepKind::kNode) {
            read_deep_page(tree_, block, corner, &page_);
            ++pages;
            use(cell, corner, block, &page_);
          }
        }
      }
    }
  }

  uint8_t* table() const { return base_ + kDeepHeaderBytes; }
  uint8_t* page_at(uint32_t number) const {
    return table() + layout_.table_bytes() + kPageBytes * size_t{number};
  }
  uint8_t* brick_at(uint32_t number) const { return base_ + layout_.bricks_at() + 8 * size_t{number}; }
  uint8_t* material_at(uint32_t number) const { return base_ + layout_.materials_at() + number; }
  void set_cell(uint32_t cell, uint32_t page) const {
    bits::store32(table() + 4 * size_t{cell},
                  static_cast<uint32_t>(layout_.table_bytes() + kPageBytes * size_t{page}));
  }

  // Writes table, pages and bricks.
  void place() {
    for (uint32_t cell = 0; cell < layout_.cells; ++cell) {
      set_cell(cell, 0);
    }
    uint32_t pages = 1;
    uint32_t bricks = 1;
    each_page([&](uint32_t cell, const Vec3i&, const DeepBlock& block, const DeepPage* page) {
      set_cell(cell, pages);
      uint8_t* const to = page_at(pages++);
      bits::store32(to, bricks - 1);
      for (uint32_t i = 0; i < kPageEntries; ++i) {
        to[4 + i] = page == nullptr ? uint8_t{1} : page->entry[i];
      }
      for (uint32_t i = 0; i < (page == nullptr ? 1 : page->bricks); ++i) {
        const DeepBlock& brick = page == nullptr ? block : page->source[i];
        const bool solid = brick.kind == DeepKind::kSolid;
        *material_at(bricks) = solid ? tree_.block_material(brick.node) : tree_.uniform_material();
        bits::store64(brick_at(bricks++),
                      solid ? ~uint64_t{0} : brick_parts::bits_of_node(tree_, brick.node));
      }
    });
  }

  uint32_t number_at(const Vec3i& brick) const {
    const uint32_t at = deep_place_of(brick);
    const uint8_t* const page = table() + bits::load32(table() + 4 * size_t{deep_place::page_of(at)});
    const uint32_t own = page[4 + deep_place::entry_of(at)];
    return own == 0 ? 0 : bits::load32(page) + own;
  }
  bool is_solid(const Vec3i& voxel) const {
    const Vec3i at{(voxel.x >> 2) - low_.x, (voxel.y >> 2) - low_.y, (voxel.z >> 2) - low_.z};
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) {
      return false;
    }
    return brick_parts::has_voxel(brick_at(number_at(at)), voxel);
  }
  // Finds for each brick the material of all of it that is seen, or writes its origin.
  Status name_materials(size_t room) {
    uint32_t bricks = 1;
    Status status = Status::kOk;
    each_page([&](uint32_t, const Vec3i& corner, const DeepBlock&, const DeepPage* page) {
      if (page == nullptr) {
        ++bricks;
        return;
      }
      uint32_t last = 0;
      for (uint32_t i = 0; i < kPageEntries; ++i) {
        if (page->entry[i] <= last) {
          continue;  // empty, or solid and met before
        }
        last = page->entry[i];
        const DeepBlock& brick = page->source[last - 1];
        if (status == Status::kOk && brick.kind == DeepKind::kNode) {
          status = name_material(bricks - 1 + last, brick.node, corner_of_entry(corner, i), room);
        }
      }
      bricks += page->bricks;
    });
    return status;
  }

  Status name_material(uint32_t number, uint32_t node, const Vec3i& at, size_t room) {
    const int material = brick_parts::material_seen(tree_, node, bits::load64(brick_at(number)), at,
                                                    [this](const Vec3i& voxel) { return is_solid(voxel); });
    if (material < 0) {
      return add_origin(number, node, room);
    }
    *material_at(number) = static_cast<uint8_t>(material);
    return Status::kOk;
  }

  Status add_origin(uint32_t number, uint32_t node, size_t room) {
    if (tree_.first_child(node) >= uint32_t{1} << brick_parts::kChildBits) {
      return Status::kOutOfRange;
    }
    uint8_t* const origin = base_ + layout_.size();
    ++layout_.mixed;
    if (layout_.size() > room) {
      return Status::kOutOfMemory;
    }
    brick_parts::store_origin(tree_, node, origin);
    *material_at(number) = 0;
    uint8_t* const rank = base_ + layout_.ranks_at() + kDeepRankBytes * size_t{number / 32};
    bits::store32(rank, bits::load32(rank) | uint32_t{1} << number % 32);
    return Status::kOk;
  }

  void finish() const {
    uint32_t mixed = 0;
    uint8_t* rank = base_ + layout_.ranks_at();
    for (uint32_t i = 0; i < layout_.rank_count(); ++i, rank += kDeepRankBytes) {
      bits::store32(rank + 4, mixed);
      mixed += bits::popcount32(bits::load32(rank));
    }
    bits::store32(base_, kDeepMagic);
    base_[kDeepLevelOffset] = static_cast<uint8_t>(tree_.level());
    for (int axis = 0; axis < 3; ++axis) {
      uint8_t* const halves = base_ + 2 * axis;
      bits::store16(halves + kDeepBoxLowOffset, static_cast<uint32_t>(low_[axis]));
      bits::store16(halves + kDeepBoxSizeOffset, static_cast<uint32_t>(size_[axis]));
    }
    const size_t size = layout_.size();
    bits::store32(base_ + kDeepSizeOffset, static_cast<uint32_t>(size));
    bits::store32(base_ + kDeepTreeOffset, bits::load32(tree_.bytes() + compact_header::kChecksumOffset));
    bits::store32(base_ + kDeepPagesOffset, layout_.pages);
    bits::store32(base_ + kDeepBricksOffset, layout_.bricks);
    bits::store32(base_ + kDeepMixedOffset, layout_.mixed);
    bits::store32(base_ + kDeepChecksumOffset, checksum_around(base_, size, kDeepChecksumOffset));
  }

  const CompactTree& tree_;
  uint8_t* base_ = nullptr;  // null while it counts
  Vec3i low_;                // of the box, in bricks: that of a page
  Vec3i size_;
  DeepLayout layout_;
  DeepPage page_;
  uint32_t solid_page_[256];  // by material; 0: none yet
};

}  // namespace

bool DeepMap::is_one(ConstBytes bytes) {
  return bytes.size >= 4 && bits::load32(bytes.data) == kDeepMagic;
}

Status DeepMap::open(ConstBytes bytes, BrickMap* map) {
  DeepHeader header{};
  if (read_deep_header(bytes, &header) != nullptr ||
      check_deep_numbers(bytes.data, header.layout) != nullptr) {
    return Status::kDamaged;
  }
  const DeepLayout& layout = header.layout;
  BrickMap result;
  result.directory_ = bytes.data + kDeepHeaderBytes;
  result.bricks_ = bytes.data + layout.bricks_at();
  result.materials_ = bytes.data + layout.materials_at();
  result.origins_ = bytes.data + layout.origins_at();
  result.box_ = header.box;
  result.size_bytes_ = bits::load32(bytes.data + kDeepSizeOffset);
  result.cells_ = layout.cells;
  result.brick_count_ = layout.bricks;
  result.mixed_count_ = layout.bricks - 1;
  result.tree_checksum_ = bits::load32(bytes.data + kDeepTreeOffset);
  result.level_ = static_cast<uint8_t>(header.level);
  *map = result;
  return Status::kOk;
}

const char* DeepMap::validate(ConstBytes bytes) {
  DeepHeader header{};
  if (const char* text = read_deep_header(bytes, &header)) {
    return text;
  }
  const uint8_t* base = bytes.data;
  const uint32_t size = bits::load32(base + kDeepSizeOffset);
  if (checksum_around(base, size, kDeepChecksumOffset) != bits::load32(base + kDeepChecksumOffset)) {
    return "checksum does not match";
  }
  return check_deep_numbers(base, header.layout);
}

Status DeepMap::make(const CompactTree& tree, Bytes out, size_t* size) {
  return DeepBuilder(tree).run(out, size);
}

size_t DeepMap::most_bytes(const CompactTree& tree) {
  DeepBuilder builder(tree);
  const uint32_t open = builder.count();
  DeepLayout layout = builder.layout();
  layout.mixed = open;
  return layout.size();
}

const uint8_t* DeepMap::origin(const BrickMap& map, uint32_t number) {
  const uint8_t* const rank =
      map.bricks_ + 8 * size_t{map.brick_count_} + kDeepRankBytes * size_t{number / 32};
  const uint32_t mixed = bits::load32(rank);
  const uint32_t own = uint32_t{1} << number % 32;
  if ((mixed & own) == 0) {
    return nullptr;
  }
  return map.origins_ + kOriginBytes * size_t{bits::load32(rank + 4) + bits::popcount32(mixed & (own - 1))};
}

}  // namespace thimble
#endif
