#include "wide/raster/tile_drawer.h"

#include <algorithm>

#include "wide/raster/cost_model.h"
#include "wide/raster/exact.h"
#include "wide/raster/surface.h"
#include "wide/raster/workspace.h"

namespace thimble::wide {
namespace {

// Blocks of more boxes than this are cut up (in flat order and in blocks), so that boxes out of sight are not
// projected.
constexpr uint32_t kFlatBoxes = 4096;
static_assert(kFlatBoxes <= kMostShortEntries);
constexpr uint32_t kBlockBoxes = 320;
// Blocks of at most so many pixels a side are drawn whole: too little of them is hidden for a cut to pay.
constexpr int32_t kTinyPx = 16;
constexpr uint32_t kTinyBoxes = 1024;
// The limits of blocks that are drawn by tables.
constexpr uint32_t kTableBoxes = 1900;
constexpr int32_t kTablePx = 56;
constexpr float kMostBend = 0.24F;
// Boxes whose faces are on average so many pixels wide are sorted from front to back before they are drawn.
constexpr float kSortedPx = 6.0F;
constexpr float kSortedVoxelPx = 8.0F;  // where all are single voxels
// And smaller voxels where their faces would cover the block so many times: a hull of one layer gains nothing.
constexpr float kSortedDeepPx = 5.0F;
constexpr float kDeepInPerspective = 3.0F;
constexpr float kDeepInParallel = 1.0F;
constexpr uint32_t kMostLines = 64;
constexpr uint32_t kCubeSide = uint32_t{1} << kCubeLevel;
constexpr uint32_t kShortSide = uint32_t{1} << kShortLevel;

int32_t width_of(const Rectangle& where) {
  return std::max(where.x1 - where.x0, where.y1 - where.y0);
}

bool touches_edge(const Rectangle& where, const Rectangle& tile) {
  return where.x0 == tile.x0 || where.y0 == tile.y0 || where.x1 == tile.x1 || where.y1 == tile.y1;
}

// Entries begin .. end - 1 of a cube of 2^level voxels a side.
struct Part {
  uint32_t begin, end;
  int32_t level;
  uint32_t corner[3];
};

// The octant of a cube of 2^(level + 1) voxels a side that holds the entry.
unsigned octant_of(uint32_t entry, int32_t level) {
  return (x_of(entry) >> level & 1U) | (entry >> (10 + level) & 1U) << 1 | (entry >> (20 + level) & 1U) << 2;
}

}  // namespace

bool SortedRun::cull_and_sort(const WideFrame& frame, const Block& block, const Depths& depths, Batch* batch,
                              Run* run) {
  run->count = cull_run(frame, *run, depths, batch, entries_, numbers_);
  if (run->count == 0) {
    return false;
  }
  sort(frame, block, run->count);
  run->entries = sorted_entries_;
  run->numbers = sorted_numbers_;
  run->sorted = true;
  return true;
}

// In every block of the tree the entries of an octant stand together. So this takes the octants in the order of their
// distance from the eye, down to single entries.
void SortedRun::sort(const WideFrame& frame, const Block& block, uint32_t count) {
  Part stack[7 * kCubeLevel + 8];
  int depth = 0;
  uint32_t written = 0;
  stack[depth++] = {0, count, block.level, {block.corner[0], block.corner[1], block.corner[2]}};
  while (depth > 0) {
    const Part part = stack[--depth];
    if (part.end - part.begin == 1 || part.level == 0) {
      for (uint32_t i = part.begin; i < part.end; ++i) {
        sorted_entries_[written] = entries_[i];
        sorted_numbers_[written] = numbers_[i];
        ++written;
      }
      continue;
    }
    const int32_t level = part.level - 1;
    const unsigned nearest = frame.nearest_octant(part.corner, part.level);
    uint32_t begin[9] = {};
    uint32_t at = part.begin;
    for (unsigned octant = 0; octant < 8; ++octant) {
      begin[octant] = at;
      while (at < part.end && octant_of(entries_[at], level) == octant) {
        ++at;
      }
    }
    begin[8] = at;
    for (unsigned turn = 8; turn-- > 0;) {
      const unsigned octant = turn ^ nearest;
      if (begin[octant] == begin[octant + 1]) {
        continue;
      }
      Part child{begin[octant], begin[octant + 1], level, {0, 0, 0}};
      for (unsigned axis = 0; axis < 3; ++axis) {
        child.corner[axis] = part.corner[axis] + ((octant >> axis & 1U) << level);
      }
      stack[depth++] = child;
    }
  }
}

TileDrawer::TileDrawer(const Task& task, const Depths& depths, uint8_t* full, Batch* batch)
    : lists_(task.lists),
      frame_(task.frame),
      starts_(task.starts),
      depths_(depths),
      full_(full),
      by_blocks_(task.by_blocks),
      batch_(batch) {}

void TileDrawer::start() {
  const CompactTree& tree = lists_.tree();
  if (!tree.empty()) {
    // The root, as the first child of a world twice as large.
    Block world{};
    world.level = static_cast<uint16_t>(tree.level() + 1);
    depth_ = find_children(frame_, world, 1, 0, 0, stack_);
  }
  if (starts_ != nullptr) {
    draw_starts();
  }
}

// Draws the voxels in which rays begin, before all others. Only lists that may leave out these voxels need it.
void TileDrawer::draw_starts() {
  if (starts_->on_plane) {
    draw_plane_starts(frame_, depths_, frame_.tile.y0, frame_.tile.y1, batch_);
  }
  for (uint32_t i = 0; i < starts_->count; ++i) {
    const SolidStarts::Voxel& voxel = starts_->voxels[i];
    ++batch_->counts.nodes;
    Block parent{};
    parent.level = 1;
    unsigned octant = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      parent.corner[axis] = static_cast<uint16_t>(voxel.at[axis] & ~1U);
      octant |= (voxel.at[axis] & 1U) << axis;
    }
    Block block[8];
    if (find_children(frame_, parent, 1U << octant, 0, 0, block) == 0) {
      continue;
    }
    uint32_t entries[1 + kReadAhead] = {};
    Run run = run_of(block[0]);
    entries[0] = packed({voxel.at[0], voxel.at[1], voxel.at[2]}, 0);
    run.entries = entries;
    run.count = 1;
    run.first = frame_.first_hidden + voxel.material;
    draw_run(frame_, run, depths_, batch_);
  }
  depth_ = starts_->are_all ? 0 : depth_;
}

void TileDrawer::draw(int32_t y0, int32_t y1) {
  frame_.tile.y0 = y0;
  frame_.tile.y1 = y1;
  start();
  while (depth_ > 0) {
    const Block block = stack_[--depth_];
    ++batch_->counts.nodes;
    const bool is_tabled = has_table(block);
    const BlockNode& node = lists_.nodes()[block.node];
    if (is_hidden(block) || !faces_eye(block, node)) {
      continue;
    }
    const unsigned mask = lists_.children(block.node);
    if (!is_leaf(block, node, mask, is_tabled)) {
      push_children(block, node, mask);
    } else {
      enqueue(block, node);
    }
  }
  while (ahead_count_ != 0) {
    batch_->ahead_end = batch_->ahead;
    draw_oldest();
  }
  finish(frame_, depths_, batch_);
}

// Whether the eye may see any voxel of the block.
bool TileDrawer::faces_eye(const Block& block, const BlockNode& node) const {
  const uint32_t corner[3] = {block.corner[0], block.corner[1], block.corner[2]};
  return (lists_.facing(node) & ways_to(frame_.eye_cell, corner, uint32_t{1} << block.level)) != 0;
}

// Whether all pixels of the block are known to be covered. Then neither its node nor its boxes are read: half of the
// blocks of a large cloud.
bool TileDrawer::is_hidden(const Block& block) const {
  return by_blocks_ && all_covered(depths_, block.place.where, full_);
}

bool TileDrawer::has_table(const Block& block) const {
  return by_blocks_ && !lists_.has_blocks() && voxel_px(block) < kTableVoxelPx;
}

// Whether the block is drawn as one run.
bool TileDrawer::is_leaf(const Block& block, const BlockNode& node, unsigned mask, bool is_tabled) const {
  if (mask == 0 || block.level <= lists_.block_level()) {
    return true;
  }
  const int32_t widest = width_of(block.place.where);
  uint32_t most = by_blocks_ || touches_edge(block.place.where, frame_.tile) ? kBlockBoxes : kFlatBoxes;
  if (is_tabled) {
    if (widest > kTablePx || !is_flat(block)) {
      return false;
    }
    most = kTableBoxes;
  }
  if (widest <= kTinyPx) {
    most = std::max(most, kTinyBoxes);
  }
  return node.entries <= most && block.level <= kCubeLevel;
}

// Whether perspective bends the block so little that a table serves. It moves a voxel by about `bend` times the block's
// size, and the centre by the square of that.
bool TileDrawer::is_flat(const Block& block) const {
  const float bend = frame_.norm_w * static_cast<float>(1 << block.level) * 0.5F * block.place.per_depth;
  return !frame_.perspective ||
         (bend <= kMostBend &&
          0.5F * static_cast<float>(width_of(block.place.where)) * bend * bend <= kMostBentPx);
}

// Roughly how many pixels wide a voxel of the block is on the picture.
float TileDrawer::voxel_px(const Block& block) const {
  return block.place.per_depth == 0 ? 1e9F : 2 * frame_.reach_x * block.place.per_depth;
}

// Pushes the children that may be seen; the last one pushed is the first one drawn.
void TileDrawer::push_children(const Block& block, const BlockNode& node, unsigned mask) {
  Block* const children = stack_ + depth_;
  const int count = find_children(frame_, block, mask, node.first_child,
                                  frame_.nearest_octant(block.corner, block.level), children);
  for (int child = 0; child < count; ++child) {
    __builtin_prefetch(&lists_.nodes()[children[child].node]);
  }
  depth_ += count;
}

// Puts a block into the ring. Its boxes are fetched while those of the blocks before it are drawn.
void TileDrawer::enqueue(const Block& block, const BlockNode& node) {
  ahead_[(ahead_first_ + ahead_count_++) % kAhead] = block;
  if (ahead_count_ < kAhead) {
    fetch(node, 0);
    return;
  }
  const uint32_t* const first = lines_of(node);
  batch_->ahead = first;
  batch_->ahead_end = first + 16 * line_count(node);
  draw_oldest();
  fetch(node, static_cast<uint32_t>(batch_->ahead - first) / 16);
}

// The entries of a node, as cache lines.
const uint32_t* TileDrawer::lines_of(const BlockNode& node) const {
  return lists_.short_entries().empty()
             ? lists_.entries().data + node.first_entry
             : reinterpret_cast<const uint32_t*>(lists_.short_entries().data + (node.first_entry & ~1U));
}
uint32_t TileDrawer::line_count(const BlockNode& node) const {
  const uint32_t in_line = lists_.short_entries().empty() ? 16 : 32;
  return (node.entries + in_line - 1) / in_line;
}

// Prefetches the boxes of a block, except the first `done` cache lines.
void TileDrawer::fetch(const BlockNode& node, uint32_t done) const {
  const uint32_t* const lines = lines_of(node);
  const uint32_t count = std::min(line_count(node), kMostLines);
  for (uint32_t line = done; line < count; ++line) {
    __builtin_prefetch(lines + 16 * line);
  }
}

void TileDrawer::draw_oldest() {
  const Block& block = ahead_[ahead_first_];
  ahead_first_ = (ahead_first_ + 1) % kAhead;
  --ahead_count_;
  // What lies before the block may have been drawn since it was enqueued. Small blocks look that up while they are
  // drawn.
  if (by_blocks_ && width_of(block.place.where) > kTablePx &&
      all_covered(depths_, block.place.where, full_)) {
    return;
  }
  draw_block(block, lists_.nodes()[block.node]);
}

// Makes the run of a block, without entries yet.
Run TileDrawer::run_of(const Block& block) const {
  Run run{};
  run.unit = !lists_.has_blocks();
  run.place = block.place;
  run.behind = by_blocks_;
  run.side = uint32_t{1} << block.level;
  const uint32_t cube = kCubeSide - 1;
  for (int axis = 0; axis < 3; ++axis) {
    run.corner[axis] = block.corner[axis] & ~cube;
    run.block[axis] = block.corner[axis] & cube;
  }
  return run;
}

bool TileDrawer::is_worth_sorting(const Block& block, const BlockNode& node) const {
  const float side_px = voxel_px(block);
  const float face_px = side_px * side_px * static_cast<float>(lists_.face_area(node));
  const auto are_as_large = [&](float px) { return face_px >= px * px * static_cast<float>(node.entries); };
  if (lists_.has_blocks()) {
    return are_as_large(kSortedPx);
  }
  const Rectangle& where = block.place.where;
  const auto area = static_cast<float>((where.x1 - where.x0) * (where.y1 - where.y0));
  return are_as_large(kSortedVoxelPx) ||
         (are_as_large(kSortedDeepPx) &&
          face_px >= area * (frame_.perspective ? kDeepInPerspective : kDeepInParallel));
}

void TileDrawer::draw_block(const Block& block, const BlockNode& node) {
  Run run = run_of(block);
  run.count = node.entries;
  if (lists_.short_entries().empty()) {
    run.entries = lists_.entries().data + node.first_entry;
  } else if (draw_short(block, node, run)) {
    return;
  } else {
    run.entries = widened_;
  }
  // Nothing asks for numbers of voxels of one material. Without them a list may be longer than numbers reach.
  const bool has_numbers = lists_.has_blocks() || !lists_.materials().empty();
  run.first = has_numbers ? node.first_entry : 0;
  if (block.level > kCubeLevel) {
    draw_cubes(block, node, &run);
    return;
  }
  if (by_blocks_ && run.count > 1 && run.count <= SortedRun::kMostBoxes && is_worth_sorting(block, node) &&
      !sorted_.cull_and_sort(frame_, block, depths_, batch_, &run)) {
    return;
  }
  draw_run(frame_, run, depths_, batch_);
}

// Draws a block of short entries, or widens them. Returns whether it is drawn.
bool TileDrawer::draw_short(const Block& block, const BlockNode& node, const Run& run) {
  const uint32_t corner[3] = {block.corner[0], block.corner[1], block.corner[2]};
  if (block.level > kShortLevel) {
    widen_all(corner, block.level, block.node, widened_);
    return false;
  }
  const ShortEntries from = short_entries_of(node, corner);
  if (by_blocks_ && draw_short_run(frame_, run, from, depths_, batch_)) {
    return true;
  }
  widen(from, run.count, widened_);
  return false;
}

ShortEntries TileDrawer::short_entries_of(const BlockNode& node, const uint32_t (&corner)[3]) const {
  const uint32_t cube = kCubeSide - kShortSide;
  return {lists_.short_entries().data + node.first_entry,
          packed({corner[0] & cube, corner[1] & cube, corner[2] & cube}, 0)};
}

// Widens the entries of a node above kShortLevel. Its entries stand in the order of its children.
void TileDrawer::widen_all(const uint32_t (&corner)[3], int level, uint32_t number, uint32_t* entries) const {
  const BlockNode& node = lists_.nodes()[number];
  if (level == kShortLevel) {
    widen(short_entries_of(node, corner), node.entries, entries);
    return;
  }
  uint32_t child = node.first_child;
  for (unsigned left = lists_.children(number); left != 0; left &= left - 1, ++child) {
    const unsigned octant = static_cast<unsigned>(__builtin_ctz(left));
    uint32_t at[3];
    for (unsigned axis = 0; axis < 3; ++axis) {
      at[axis] = corner[axis] + ((octant >> axis & 1U) << (level - 1));
    }
    widen_all(at, level - 1, child, entries);
    entries += lists_.nodes()[child].entries;
  }
}

// Draws a solid block of several cubes, which has an entry for each cube, in Morton order.
void TileDrawer::draw_cubes(const Block& block, const BlockNode& node, Run* run) {
  run->behind = false;
  run->count = 1;
  for (uint32_t piece = 0; piece < node.entries; ++piece) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const uint32_t place = (piece >> axis & 1U) | (piece >> (3 + axis) & 1U) << 1;
      run->corner[axis] = block.corner[axis] + (place << kCubeLevel);
    }
    draw_run(frame_, *run, depths_, batch_);
    ++run->entries;
    ++run->first;
  }
}

}  // namespace thimble::wide
