#include "wide/raster/voxel_lists.h"

#include "thimble/tree/compact_tree.h"
#include "wide/raster/surface.h"

namespace thimble::wide {
namespace {

// Where each level of the tree begins (its nodes stand one after the other), and how many boxes there are.
struct Census {
  uint32_t level_begin[kMaxLevel + 2];  // by level; [0] is the number of nodes
  uint64_t boxes = 0;
  uint64_t added = 0;      // boxes that splitting blocks into voxels would add
  uint64_t volume = 0;     // in voxels
  uint64_t removable = 0;  // at most so many voxels are hidden
  bool has_blocks = false;
  bool splits = false;  // whether blocks are split into voxels; then `boxes` counts these
};

// Lists of single voxels are drawn faster, so blocks are split into voxels where that adds at most one box to so many.
constexpr uint64_t kBoxesPerAdded = 8;
// A surface is listed where more than one voxel in so many may be hidden.
constexpr uint64_t kVoxelsPerHidden = 4;

// Entries are short where there are at least so many in a cube of theirs.
constexpr uint64_t kVoxelsPerShortCube = 64;

// Solid blocks larger than a cube of entries are listed as such cubes.
uint32_t pieces_of(int level) {
  return level > kCubeLevel ? uint32_t{1} << (3 * (level - kCubeLevel)) : 1;
}

bool count(const CompactTree& tree, Census* census) {
  uint32_t begin = 0;
  uint32_t end = tree.empty() ? 0 : 1;
  for (int level = tree.level(); level >= 1; --level) {
    census->level_begin[level] = begin;
    uint64_t children = 0;
    for (uint32_t node = begin; node < end; ++node) {
      const unsigned mask = tree.mask(node);
      children += static_cast<unsigned>(__builtin_popcount(mask));
      if (mask == 0) {
        census->boxes += pieces_of(level);
        census->has_blocks = true;
        census->volume += uint64_t{1} << (3 * level);
        census->removable += uint64_t{1} << (3 * level);
        census->added += (uint64_t{1} << (3 * level)) - pieces_of(level);
      } else if (level == 1) {
        census->removable += most_hidden(mask);
      }
    }
    if (level == 1) {
      census->boxes += children;
      census->volume += children;
    } else if (children > tree.node_count() - end) {
      return false;
    }
    begin = end;
    end += level == 1 ? 0 : static_cast<uint32_t>(children);
  }
  census->level_begin[0] = begin;
  return tree.nodes_in_order() && begin == tree.node_count() && census->boxes <= UINT32_MAX;
}

// Chooses to split blocks into voxels, where that adds few boxes or where voxels are wanted.
void split_blocks(const CompactTree& tree, bool wants_voxels, Census* census) {
  const uint64_t voxels = census->boxes + census->added;
  const bool are_few = census->added <= census->boxes / kBoxesPerAdded && voxels <= UINT32_MAX;
  census->splits =
      census->has_blocks && !tree.merged() && (are_few || (wants_voxels && voxels <= kMostSurface));
  if (census->splits) {
    census->boxes = voxels;
    census->has_blocks = false;
  }
}

// So many nodes cost little however many boxes there are: a megabyte.
constexpr uint64_t kFreeNodes = 65536;

// Chooses the lowest level, `least` or above, whose nodes, with all nodes above them, are few, or at most a sixteenth
// of the boxes. `level_begin[level - 1]` is the number of nodes of that level and above.
int choose_block_level(int world_level, const uint32_t* level_begin, uint64_t boxes, int least) {
  // A sixteenth suits most trees; a tree that is crowded in a corner wants more nodes.
  const uint64_t quarter = boxes / 4 < kFreeNodes ? boxes / 4 : kFreeNodes;
  const uint64_t most = boxes / 16 > quarter ? boxes / 16 : quarter > 4096 ? quarter : 4096;
  int level = world_level < kCubeLevel ? world_level : kCubeLevel;
  while (level > least && level_begin[level - 2] <= most) {
    --level;
  }
  return level;
}

// Walks the tree down and across, in Morton order, and writes entries and block nodes.
class ListWriter {
 public:
  ListWriter(const CompactTree& tree, const Census& census, int block_level, const ListTo& to)
      : tree_(tree), census_(census), block_level_(block_level), to_(to), voxel_(tree.node_count()) {
    for (int level = 1; level <= tree.level(); ++level) {
      next_node_[level] = census.level_begin[level];
    }
  }

  // Writes the lists of a tree that is not empty.
  void write() { write(tree_.level(), {0, 0, 0}); }

 private:
  // Writes the next node of this level, and what it holds. Nodes of one level are visited in the order in which they
  // stand, so counting up finds them.
  void write(int level, const uint32_t (&corner)[3]) {
    const uint32_t node = next_node_[level]++;
    const unsigned mask = tree_.mask(node);
    const uint32_t first = written_;
    const uint64_t area = face_area_;
    const uint32_t first_child = level > 1 && mask != 0 ? next_node_[level - 1] : 0;
    if (mask == 0) {
      add_block(level, corner, node);
    }
    for (unsigned left = mask; left != 0; left &= left - 1) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(left));
      const uint32_t side = uint32_t{1} << (level - 1);
      const uint32_t at[3] = {corner[0] + side * (octant & 1U), corner[1] + side * (octant >> 1 & 1U),
                              corner[2] + side * (octant >> 2)};
      if (level == 1) {
        add(at, 0, to_.materials == nullptr ? 0 : tree_.voxel_material(voxel_++), node);
      } else {
        write(level - 1, at);
      }
    }
    if (level >= block_level_) {
      to_.nodes[node] = {first, written_ - first, first_child,
                         census_.has_blocks ? static_cast<uint32_t>(face_area_ - area) : 0xFF00U | mask};
    }
  }

  void add_block(int level, const uint32_t (&corner)[3], uint32_t node) {
    const uint8_t material = to_.materials == nullptr ? 0 : tree_.block_material(node);
    if (!census_.splits) {
      for (uint32_t piece = 0; piece < pieces_of(level); ++piece) {
        add(corner, level < kCubeLevel ? level : kCubeLevel, material, node);
      }
      return;
    }
    for (uint32_t code = 0; code >> (3 * level) == 0; ++code) {
      const Vec3i place = morton_voxel(code);
      const uint32_t at[3] = {corner[0] + static_cast<uint32_t>(place.x),
                              corner[1] + static_cast<uint32_t>(place.y),
                              corner[2] + static_cast<uint32_t>(place.z)};
      add(at, 0, material, node);
    }
  }

  void add(const uint32_t (&at)[3], int box_level, uint8_t material, uint32_t node) {
    if (to_.materials != nullptr) {
      to_.materials[written_] = material;
    }
    if (to_.merged != nullptr) {
      to_.merged[written_] = tree_.is_merged(node) ? 1 : 0;
    }
    face_area_ += uint64_t{1} << (2 * box_level);
    if (to_.short_entries != nullptr) {
      to_.short_entries[written_++] = packed_short(at);
    } else {
      to_.entries[written_++] = packed(at, box_level);
    }
  }

  const CompactTree& tree_;
  const Census& census_;
  int block_level_;
  ListTo to_;
  uint32_t next_node_[kMaxLevel + 1];
  uint32_t written_ = 0;
  uint32_t voxel_;  // the number of the next single voxel
  uint64_t face_area_ = 0;
};

// Which list a tree gets.
struct Plan {
  Census census;  // of the boxes
  SurfaceCount surface;
  bool has_surface = false;  // else boxes
  bool is_short = false;     // whether the entries of the boxes are short
  int block_level = 0;

  uint64_t entries() const { return has_surface ? surface.entries : census.boxes; }
  const uint32_t* level_begin() const { return has_surface ? surface.level_begin : census.level_begin; }
  uint64_t nodes() const { return entries() == 0 ? 0 : level_begin()[block_level - 1]; }
  // Materials that follow those of the entries, so that a hidden voxel has a number too.
  size_t materials_behind() const { return has_surface ? 256 : 0; }
};

bool make_plan(const CompactTree& tree, ListKind kind, Plan* plan) {
  Census& census = plan->census;
  if (!count(tree, &census)) {
    return false;
  }
  const bool may_be_surface = kind == ListKind::kFastest && !tree.merged() && tree.level() >= 2;
  const bool is_solid = census.removable > census.volume / kVoxelsPerHidden;
  if (may_be_surface && is_solid && !tree.empty()) {
    plan->surface = count_surface(tree, census.level_begin);
    plan->has_surface = plan->surface.entries < kMostSurface;
  }
  if (!plan->has_surface) {
    split_blocks(tree, may_be_surface && !is_solid, &census);
  }
  plan->block_level =
      choose_block_level(tree.level(), plan->level_begin(), plan->entries(), plan->has_surface ? 2 : 1);
  plan->is_short = tree.level() > kCubeLevel && !plan->has_surface && !census.has_blocks &&
                   !tree.many_materials() && plan->block_level < kShortLevel &&
                   census.boxes / kVoxelsPerShortCube >=
                       census.level_begin[kShortLevel - 1] - census.level_begin[kShortLevel];
  return true;
}

template <class T>
T* array(Arena* arena, uint64_t count) {
  return reinterpret_cast<T*>(arena->take(static_cast<size_t>(count) * sizeof(T), 64).data);
}

// Takes room for the entries, with zeros behind them.
template <class T>
T* take_entries(uint64_t entries, Arena* arena) {
  T* const to = array<T>(arena, entries + kEntriesAhead);
  for (uint32_t i = 0; to != nullptr && i < kEntriesAhead; ++i) {
    to[entries + i] = 0;
  }
  return to;
}

// Takes room for a list. Returns whether there was enough.
bool take_list(const CompactTree& tree, const Plan& plan, Arena* arena, ListTo* to) {
  const uint64_t entries = plan.entries();
  to->entries = plan.is_short ? nullptr : take_entries<uint32_t>(entries, arena);
  to->short_entries = plan.is_short ? take_entries<uint16_t>(entries, arena) : nullptr;
  to->nodes = array<BlockNode>(arena, plan.nodes());
  to->materials = tree.many_materials() ? array<uint8_t>(arena, entries + plan.materials_behind()) : nullptr;
  to->merged = tree.merged() ? array<uint8_t>(arena, entries) : nullptr;
  return (to->entries != nullptr || to->short_entries != nullptr) &&
         (to->nodes != nullptr || plan.nodes() == 0) &&
         (to->materials != nullptr || !tree.many_materials() || entries == 0) &&
         (to->merged != nullptr || !tree.merged() || entries == 0);
}

void write_list(const CompactTree& tree, const Plan& plan, const ListTo& to) {
  if (plan.has_surface) {
    write_surface(tree, plan.census.level_begin, plan.surface, plan.block_level, to);
    for (size_t material = 0; to.materials != nullptr && material < plan.materials_behind(); ++material) {
      to.materials[plan.entries() + material] = static_cast<uint8_t>(material);
    }
  } else if (!tree.empty()) {
    ListWriter(tree, plan.census, plan.block_level, to).write();
  }
}

template <class T>
Span<const T> span_of(const T* data, uint64_t size) {
  return {data, data == nullptr ? 0 : static_cast<size_t>(size)};
}

}  // namespace

size_t VoxelLists::bytes(const CompactTree& tree, ListKind kind) {
  Plan plan;
  if (!make_plan(tree, kind, &plan)) {
    return 0;
  }
  const size_t entry_bytes = (plan.is_short ? sizeof(uint16_t) : sizeof(uint32_t)) +
                             (tree.many_materials() ? 1 : 0) + (tree.merged() ? 1 : 0);
  return static_cast<size_t>(plan.entries() * entry_bytes + kEntriesAhead * sizeof(uint32_t) +
                             plan.nodes() * sizeof(BlockNode) + 4 * 64) +
         plan.materials_behind();
}

Status VoxelLists::make(const CompactTree& tree, Arena* arena, VoxelLists* lists, ListKind kind) {
  Plan plan;
  if (!make_plan(tree, kind, &plan)) {
    return Status::kDamaged;
  }
  Arena taken = *arena;
  ListTo to{};
  if (!take_list(tree, plan, &taken, &to)) {
    return Status::kOutOfMemory;
  }
  write_list(tree, plan, to);
  const uint64_t entries = plan.entries();
  lists->tree_ = tree;
  lists->entries_ = span_of(to.entries, entries);
  lists->short_entries_ = span_of(to.short_entries, entries);
  lists->materials_ = span_of(to.materials, entries + plan.materials_behind());
  lists->merged_ = span_of(to.merged, entries);
  lists->nodes_ = span_of(to.nodes, plan.nodes());
  lists->block_level_ = plan.block_level;
  lists->has_blocks_ = !plan.has_surface && plan.census.has_blocks;
  lists->is_surface_ = plan.has_surface;
  *arena = taken;
  return Status::kOk;
}

}  // namespace thimble::wide
