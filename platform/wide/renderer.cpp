#include "wide/renderer.h"

#include <string.h>

#include <algorithm>
#include <atomic>
#include <new>

#include "wide/choice.h"
#include "wide/exact.h"
#include "wide/handover.h"
#include "wide/painter.h"

namespace thimble::wide {
namespace {

// Runs of more boxes than this are cut up, flat or not, so that blocks out of sight are not projected.
constexpr uint32_t kFlatBoxes = 4096;
constexpr uint32_t kBlockBoxes = 320;
// Blocks of so few pixels a side are drawn whole: what they could hide pays no cut.
constexpr int32_t kTinyPx = 16;
constexpr uint32_t kTinyBoxes = 1024;
// Of blocks that are looked up in tables; they are to be no larger than that.
constexpr uint32_t kTableBoxes = 1900;
constexpr int32_t kTablePx = 56;
constexpr float kMostBend = 0.24F;
// Boxes of at least so many pixels a side, in the mean of their faces, are drawn one behind the other.
constexpr float kSortedPx = 6.0F;
constexpr float kSortedVoxelPx = 8.0F;  // where all are single voxels
constexpr uint32_t kMostSorted = 512;
constexpr int32_t kPatchRows = 16;
// Up to so many threads draw lists of so many boxes each in a picture of its own. Fewer boxes are drawn in
// the time that it takes to put pictures together, and more pictures are more than caches hold.
constexpr int kMostCopies = 4;
constexpr size_t kCopyBoxes = 150000;
// Their pictures are put together in so many rows at a time.
constexpr int32_t kMergedRows = 32;

size_t strips_of(int32_t width_px) {
  return static_cast<size_t>(width_px + 31) / 32;
}
size_t patches_of(int32_t rows) {
  return static_cast<size_t>(rows + kPatchRows - 1) / kPatchRows;
}
// A strip more than there are, since pixels are looked up with those right of them.
size_t covered_words(int32_t width_px, int32_t rows) {
  return (strips_of(width_px) + 1) * static_cast<size_t>(rows);
}

// Whether all pixels of `where` are covered. Patches of a word by kPatchRows rows that were seen full are
// remembered in `full` (a byte each, strip by strip), so that large rectangles cost little.
bool all_covered(const Depths& depths, const Rectangle& where, uint8_t* full) {
  const int32_t first = where.x0 >> 5;
  const int32_t last = (where.x1 - 1) >> 5;
  const uint32_t head = UINT32_MAX << (where.x0 & 31);
  const uint32_t tail = UINT32_MAX >> (31 - ((where.x1 - 1) & 31));
  const auto are_full = [&](int32_t word, uint32_t wanted, int32_t y0, int32_t y1) {
    const uint32_t* at = depths.covered + depths.word(32 * word, y0);
    for (int32_t y = y0; y < y1; ++y, ++at) {
      if ((*at & wanted) != wanted) {
        return false;
      }
    }
    return true;
  };
  const int32_t y_end = where.y1 - depths.first_row;
  for (int32_t y = where.y0 - depths.first_row; y < y_end;) {
    const int32_t patch_y = y / kPatchRows;
    const int32_t next = (patch_y + 1) * kPatchRows;
    const int32_t end = next < y_end ? next : y_end;
    uint8_t* const flags = full + patch_y;
    const size_t stride = patches_of(depths.rows);
    for (int32_t word = first; word <= last; ++word) {
      uint8_t* const flag = flags + static_cast<size_t>(word) * stride;
      if (*flag != 0) {
        continue;
      }
      uint32_t wanted = UINT32_MAX;
      wanted &= word == first ? head : wanted;
      wanted &= word == last ? tail : wanted;
      if (!are_full(word, wanted, y + depths.first_row, end + depths.first_row)) {
        return false;
      }
      if (end == next &&
          are_full(word, UINT32_MAX, next - kPatchRows + depths.first_row, next + depths.first_row)) {
        *flag = 1;
      }
    }
    y = end;
  }
  return true;
}

// What one thread draws with: one tile of the picture after the other, or parts of them.
class TileDrawer {
 public:
  using Others = Handover<TileDrawer>;

  // `others`: null, or those that draw on other rows of the same depths, and take some of ours when they have
  // none left. `next_share`: null, or common to several that share the runs of a list among them, each with
  // depths of its own; not with blocks.
  TileDrawer(const VoxelLists& lists, const WideFrame& frame, const Depths& depths, uint8_t* full,
             bool by_blocks, Batch* batch, Others* others, std::atomic<uint32_t>* next_share = nullptr)
      : lists_(lists),
        frame_(frame),
        depths_(depths),
        full_(full),
        by_blocks_(by_blocks),
        batch_(batch),
        others_(others),
        next_share_(next_share),
        share_(next_share == nullptr ? 0 : (*next_share)++) {
    const Camera& camera = frame.camera;
    for (int axis = 0; axis < 3; ++axis) {
      // Rays of a parallel camera come from beyond the world.
      eye_cell_[axis] = camera.is_perspective()        ? camera.eye()[axis].raw >> 8
                        : camera.direction()[axis] < 0 ? INT32_MAX
                                                       : INT32_MIN;
    }
  }

  // Takes these rows, of the picture that it was made for.
  void start(int32_t y0, int32_t y1) {
    frame_.tile.y0 = y0;
    frame_.tile.y1 = y1;
    const CompactTree& tree = lists_.tree();
    if (!tree.empty()) {
      // The root, as the first child of a world twice as large.
      Block world{};
      world.level = static_cast<uint16_t>(tree.level() + 1);
      depth_ = find_children(frame_, world, 1, 0, 0, stack_);
    }
  }

  // Draws what was started or given, but for what is given away. Then the frame's tile is what was drawn.
  void draw() {
    const CompactTree& tree = lists_.tree();
    while (depth_ > 0) {
      if (others_ != nullptr && others_->is_wanted()) {
        split();
        if (depth_ == 0) {
          break;
        }
      }
      const Block block = stack_[--depth_];
      ++batch_->counts.nodes;
      const BlockNode& node = lists_.nodes()[block.node];
      const unsigned mask = tree.mask(block.node);
      const int32_t widest = width_of(block.place.where);
      const bool has_table = by_blocks_ && !lists_.has_blocks() && voxel_px(block) < kTableVoxelPx;
      const bool is_cut_off = touches_edge(block.place.where);
      const uint32_t small = has_table ? kTableBoxes : by_blocks_ || is_cut_off ? kBlockBoxes : kFlatBoxes;
      const bool is_few = node.entries <= (widest <= kTinyPx && small < kTinyBoxes ? kTinyBoxes : small) &&
                          block.level <= kCubeLevel;
      const bool is_large = has_table && (widest > kTablePx || !is_flat(block));
      const bool is_leaf = mask == 0 || block.level <= lists_.block_level() || (is_few && !is_large);
      if (by_blocks_ && (!has_table || widest > kTablePx) && all_covered(depths_, block.place.where, full_)) {
        continue;
      }
      if (is_leaf) {
        if (!is_ours()) {
          continue;
        }
        // Its boxes are fetched while those of the blocks before it are drawn.
        ahead_[(ahead_first_ + ahead_count_++) % kAhead] = block;
        if (ahead_count_ < kAhead) {
          fetch(node, 0);
        } else {
          const uint32_t* const first = lists_.entries().data + node.first_entry;
          batch_->ahead = first;
          batch_->ahead_end = first + node.entries;
          draw_oldest();
          fetch(node, static_cast<uint32_t>(batch_->ahead - first) / 16);
        }
        continue;
      }
      // The last pushed is the first drawn.
      Block* const children = stack_ + depth_;
      const int count = find_children(frame_, block, mask, node.first_child, nearest_octant(block), children);
      for (int child = 0; child < count; ++child) {
        __builtin_prefetch(&lists_.nodes()[children[child].node]);
      }
      depth_ += count;
    }
    while (ahead_count_ != 0) {
      batch_->ahead_end = batch_->ahead;
      draw_oldest();
    }
    finish(frame_, depths_, batch_);
  }

  const WideFrame& frame() const { return frame_; }

  // Of Handover.
  std::atomic<bool> given{false};
  TileDrawer* next_taker = nullptr;

 private:
  static constexpr uint32_t kAhead = 8;
  static constexpr uint32_t kRunsPerShare = 2;
  static constexpr uint32_t kMostLines = 64;
  // Fewer rows, and fewer boxes that remain, are not split.
  static constexpr int32_t kLeastRows = 2 * kPatchRows;
  static constexpr float kLeastWork = 4000;

  // Gives the lower rows, with all that is still to be drawn there, to a thread that waits: about half of the
  // work.
  void split() {
    const Tile& tile = frame_.tile;
    if (tile.y1 - tile.y0 < kLeastRows) {
      return;
    }
    const int32_t cut = middle_row();
    const float all = work_above(tile.y1);
    const float above = work_above(cut);
    if (all < kLeastWork || above < all / 16 || above > all * 15 / 16) {
      return;
    }
    TileDrawer* const taker = others_->take();
    if (taker == nullptr) {
      return;
    }
    // What was drawn so far is to be in the picture, whose rows are the taker's from now on.
    finish(frame_, depths_, batch_);
    std::rotate(ahead_, ahead_ + ahead_first_, ahead_ + kAhead);
    ahead_first_ = 0;
    taker->frame_.tile = {tile.x0, cut, tile.x1, tile.y1};
    taker->take_blocks(*this);
    frame_.tile.y1 = cut;
    take_blocks(*this);
    Others::give(taker);
  }

  // The blocks of `from`, which may be this one, as far as they are in our rows. Its ring begins at 0.
  void take_blocks(const TileDrawer& from) {
    const auto take = [&](const Block* blocks, uint32_t count, Block* to) {
      uint32_t taken = 0;
      for (uint32_t i = 0; i < count; ++i) {
        Block block = blocks[i];
        Rectangle& where = block.place.where;
        where.y0 = std::max(where.y0, frame_.tile.y0);
        where.y1 = std::min(where.y1, frame_.tile.y1);
        if (where.y0 < where.y1) {
          to[taken++] = block;
        }
      }
      return taken;
    };
    depth_ = static_cast<int>(take(from.stack_, static_cast<uint32_t>(from.depth_), stack_));
    ahead_count_ = take(from.ahead_, from.ahead_count_, ahead_);
    ahead_first_ = 0;
  }

  // The first row of a patch, not the tile's first, with about half of the work above it.
  int32_t middle_row() const {
    const int32_t origin = depths_.first_row;
    const float half = work_above(frame_.tile.y1) / 2;
    int32_t low = (frame_.tile.y0 - origin) / kPatchRows + 1;
    int32_t high = (frame_.tile.y1 - origin - 1) / kPatchRows;
    while (low < high) {
      const int32_t middle = (low + high) / 2;
      // Half a patch more: the cut that is nearest.
      if (work_above(origin + middle * kPatchRows + kPatchRows / 2) < half) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return origin + low * kPatchRows;
  }

  // How many of the boxes that remain are above the row, if each block has them evenly in all of its rows.
  float work_above(int32_t y) const {
    float work = 0;
    const auto add = [&](const Block& block) {
      const Rectangle& where = block.place.where;
      const float part = static_cast<float>(std::clamp(y, where.y0, where.y1) - where.y0) /
                         static_cast<float>(where.y1 - where.y0);
      work += part * static_cast<float>(lists_.nodes()[block.node].entries);
    };
    for (int i = 0; i < depth_; ++i) {
      add(stack_[i]);
    }
    for (uint32_t i = 0; i < ahead_count_; ++i) {
      add(ahead_[(ahead_first_ + i) % kAhead]);
    }
    return work;
  }

  // Whether the next run is one of ours. All come by the same runs in the same order and take the next share
  // that nobody has when their last one is done, so each is taken once.
  bool is_ours() {
    if (next_share_ == nullptr) {
      return true;
    }
    const uint32_t share = run_++ / kRunsPerShare;
    if (share > share_) {
      share_ = (*next_share_)++;
    }
    return share == share_;
  }

  // Fetches the boxes of a block, but for the first `done` lines.
  void fetch(const BlockNode& node, uint32_t done) const {
    const uint32_t* entries = lists_.entries().data + node.first_entry;
    for (uint32_t line = done; 16 * line < node.entries && line < kMostLines; ++line) {
      __builtin_prefetch(entries + 16 * line);
    }
  }

  static int32_t width_of(const Rectangle& where) {
    const int32_t x = where.x1 - where.x0;
    const int32_t y = where.y1 - where.y0;
    return x > y ? x : y;
  }

  bool touches_edge(const Rectangle& where) const {
    return where.x0 == frame_.tile.x0 || where.y0 == frame_.tile.y0 || where.x1 == frame_.tile.x1 ||
           where.y1 == frame_.tile.y1;
  }

  unsigned nearest_octant(const Block& block) const {
    const int32_t side = int32_t{1} << (block.level - 1);
    unsigned octant = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      octant |= eye_cell_[axis] >= block.corner[axis] + side ? 1U << axis : 0U;
    }
    return octant;
  }

  void draw_oldest() {
    const Block& block = ahead_[ahead_first_];
    ahead_first_ = (ahead_first_ + 1) % kAhead;
    --ahead_count_;
    // What lay before it may have been drawn since. Small ones are looked up as they are drawn.
    if (by_blocks_ && width_of(block.place.where) > kTablePx &&
        all_covered(depths_, block.place.where, full_)) {
      return;
    }
    draw_block(block, lists_.nodes()[block.node]);
  }

  void draw_block(const Block& block, const BlockNode& node) {
    Run run;
    run.entries = lists_.entries().data + node.first_entry;
    run.numbers = nullptr;
    run.count = node.entries;
    run.first = node.first_entry;
    run.unit = !lists_.has_blocks();
    run.place = block.place;
    run.behind = by_blocks_;
    run.sorted = false;
    run.voxel_px = voxel_px(block);
    run.side = uint32_t{1} << block.level;
    const uint32_t cube = (uint32_t{1} << kCubeLevel) - 1;
    if (block.level <= kCubeLevel) {
      for (int axis = 0; axis < 3; ++axis) {
        run.corner[axis] = block.corner[axis] & ~cube;
        run.block[axis] = block.corner[axis] & cube;
      }
      const float face_px = run.voxel_px * run.voxel_px * static_cast<float>(node.face_area);
      const float sorted_px = run.unit ? kSortedVoxelPx : kSortedPx;
      const bool is_large = face_px >= sorted_px * sorted_px * static_cast<float>(node.entries);
      if (by_blocks_ && run.count > 1 && run.count <= kMostSorted && is_large) {
        run.count = cull_run(frame_, run, depths_, batch_, entries_, numbers_);
        if (run.count == 0) {
          return;
        }
        sort(block, &run);
      }
      draw_run(frame_, run, depths_, batch_);
      return;
    }
    // A solid block of several cubes, an entry each, in Morton order.
    run.behind = false;
    run.count = 1;
    for (uint32_t piece = 0; piece < node.entries; ++piece) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        const uint32_t place = (piece >> axis & 1U) | (piece >> (3 + axis) & 1U) << 1;
        run.corner[axis] = block.corner[axis] + (place << kCubeLevel);
      }
      draw_run(frame_, run, depths_, batch_);
      ++run.entries;
      ++run.first;
    }
  }

  // Whether perspective bends the block so little that tables serve: by `bend` of its size, and its middle
  // by the square of that.
  bool is_flat(const Block& block) const {
    const float bend = frame_.norm_w * static_cast<float>(1 << block.level) * 0.5F * block.place.per_depth;
    return !frame_.perspective ||
           (bend <= kMostBend &&
            0.5F * static_cast<float>(width_of(block.place.where)) * bend * bend <= kMostBentPx);
  }

  // How large a voxel of the block looks, about.
  float voxel_px(const Block& block) const {
    return block.place.per_depth == 0 ? 1e9F : 2 * frame_.reach_x * block.place.per_depth;
  }

  // The `run->count` boxes of entries_ front to back. Entries of an octant stand together, in every block of
  // the tree; so the octants are taken in the order of their distance from the eye, down to single entries.
  void sort(const Block& block, Run* run) {
    struct Part {
      uint32_t begin, end;
      int32_t level;
      uint32_t corner[3];
    };
    Part stack[7 * kCubeLevel + 8];
    int depth = 0;
    uint32_t written = 0;
    stack[depth++] = {0, run->count, block.level, {block.corner[0], block.corner[1], block.corner[2]}};
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
      unsigned first = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const int32_t middle = static_cast<int32_t>(part.corner[axis] + (uint32_t{1} << level));
        first |= eye_cell_[axis] >= middle ? 1U << axis : 0U;
      }
      uint32_t begin[9] = {};
      uint32_t at = part.begin;
      for (unsigned octant = 0; octant < 8; ++octant) {
        begin[octant] = at;
        for (; at < part.end; ++at) {
          const uint32_t entry = entries_[at];
          const unsigned of = (x_of(entry) >> level & 1U) | (entry >> (10 + level) & 1U) << 1 |
                              (entry >> (20 + level) & 1U) << 2;
          if (of != octant) {
            break;
          }
        }
      }
      begin[8] = at;
      for (unsigned turn = 8; turn-- > 0;) {
        const unsigned octant = turn ^ first;
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
    run->entries = sorted_entries_;
    run->numbers = sorted_numbers_;
    run->sorted = true;
  }

  const VoxelLists& lists_;
  WideFrame frame_;
  const Depths& depths_;
  uint8_t* full_;  // see all_covered
  bool by_blocks_;
  Batch* batch_;
  Others* others_;
  std::atomic<uint32_t>* next_share_;
  uint32_t share_;
  uint32_t run_ = 0;
  int32_t eye_cell_[3];
  int depth_ = 0;  ///< of stack_
  Block stack_[7 * kMaxLevel + 8];
  Block ahead_[kAhead];  ///< blocks on their way from memory, a ring in the order of drawing
  uint32_t ahead_first_ = 0;
  uint32_t ahead_count_ = 0;
  uint32_t entries_[kMostSorted + kReadAhead];
  uint32_t numbers_[kMostSorted + kReadAhead];
  uint32_t sorted_entries_[kMostSorted + kReadAhead];
  uint32_t sorted_numbers_[kMostSorted + kReadAhead];
};

// The picture is cut into tiles of whole rows, one for each thread, of about the same work. Few, since boxes
// on a seam are looked at on both sides.
class Tiles {
 public:
  Tiles(int32_t rows, int threads, const float (&work)[Outlook::kParts]) : end_{rows} {
    if (threads == 1) {
      return;
    }
    float all = 0;
    for (const float part : work) {
      all += part;
    }
    // Rows take some time by themselves: they are cleared and painted.
    const float each = 0.03F * all / Outlook::kParts + 1e-6F;
    all += each * Outlook::kParts;
    count_ = 0;
    float done = 0;
    int part = 0;
    for (int32_t last = 0; last < rows;) {
      const float wanted = all * static_cast<float>(count_ + 1) / static_cast<float>(threads);
      while (part < Outlook::kParts && done + work[part] + each <= wanted) {
        done += work[part] + each;
        ++part;
      }
      float at = static_cast<float>(part);
      if (part < Outlook::kParts) {
        at += (wanted - done) / (work[part] + each);
      }
      // Sums that are no numbers make one tile of what is left.
      at = at >= 0 && at < Outlook::kParts ? at : Outlook::kParts;
      const int32_t row = static_cast<int32_t>(at * static_cast<float>(rows) / Outlook::kParts);
      int32_t end = (row + kPatchRows / 2) / kPatchRows * kPatchRows;
      end = end <= last ? last + kPatchRows : end;
      last = end < rows && count_ + 1 < threads ? end : rows;
      end_[count_++] = last;
    }
  }

  int count() const { return count_; }
  int32_t begin(int tile) const { return tile == 0 ? 0 : end_[tile - 1]; }
  int32_t end(int tile) const { return end_[tile]; }

 private:
  int count_ = 1;
  int32_t end_[kMaxThreads];
};

Status check(const VoxelLists& lists, const Camera& camera, const Band& band, Bytes workspace, int threads) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != lists.tree().level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  if (line_bytes > band.pixels.size ||
      static_cast<size_t>(band.rows - 1) > (band.pixels.size - line_bytes) / stride ||
      workspace.size < workspace_bytes(width, band.rows, threads)) {
    return Status::kOutOfMemory;
  }
  return lists.entries().size > size_t{1} << kEntryBits ? Status::kTooFine : Status::kOk;
}

}  // namespace

size_t workspace_bytes(int32_t width_px, int32_t rows, int threads) {
  const size_t copy = strips_of(width_px) * static_cast<size_t>(rows) * 32 * sizeof(uint64_t) +
                      covered_words(width_px, rows) * sizeof(uint32_t) + 64;
  return static_cast<size_t>(threads <= kMostCopies ? threads : 1) * copy +
         strips_of(width_px) * patches_of(rows) + static_cast<size_t>(threads) * (sizeof(Batch) + 64) + 128;
}

Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options, Stats* stats) {
  const int threads = options.threads == nullptr ? 1 : options.threads->count();
  const Status status = check(lists, camera, band, workspace, threads);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  WideFrame frame;
  if (!make_frame(camera, {0, band.first_row, camera.width_px(), band.first_row + band.rows}, &frame)) {
    return Status::kTooFine;
  }
  Stats done;
  done.order = options.order;
  Outlook outlook;
  if (done.order == Order::kAuto || threads > 1) {
    outlook = outlook_of(lists, frame, threads > 1);
  }
  if (done.order == Order::kAuto) {
    done.order = outlook.blocks_pay ? Order::kBlocks : Order::kFlat;
  }
  const bool by_blocks = done.order == Order::kBlocks;
  const Tiles tiles(band.rows, threads, by_blocks ? outlook.blocks : outlook.flat);

  Arena arena(workspace);
  const size_t strips = strips_of(camera.width_px());
  const TilePainter painter(lists, camera, shading, band);
  const auto make_depths = [&] {
    const size_t pixels = strips * static_cast<size_t>(band.rows) * 32;
    const Bytes nearest = arena.take(pixels * sizeof(uint64_t), 64);
    Depths depths;
    depths.nearest = reinterpret_cast<uint64_t*>(nearest.data);
    depths.gray_scale = painter.gray_scale();
    depths.shading = &shading;
    depths.nearest_sum = reinterpret_cast<uint16_t*>(nearest.data);
    depths.gray = nearest.data + pixels * sizeof(uint16_t);
    depths.covered = reinterpret_cast<uint32_t*>(
        arena.take(covered_words(camera.width_px(), band.rows) * sizeof(uint32_t)).data);
    depths.marks = by_blocks || depths.gray_scale == nullptr;
    depths.rows = band.rows;
    depths.first_row = band.first_row;
    return depths;
  };
  const bool copies =
      threads > 1 && threads <= kMostCopies && !by_blocks && lists.entries().size >= kCopyBoxes;
  Depths copy[kMostCopies] = {make_depths()};
  const Depths& depths = copy[0];
  for (int thread = 1; copies && thread < threads; ++thread) {
    copy[thread] = make_depths();
  }
  const Bytes patches = arena.take(strips * patches_of(band.rows), 1);
  const Bytes batches = arena.take(static_cast<size_t>(threads) * sizeof(Batch), alignof(Batch));
  const auto batch_at = [&](int thread) {
    return std::launder(reinterpret_cast<Batch*>(batches.data) + thread);
  };
  const auto batch_of = [&](int thread) {
    return new (batches.data + static_cast<size_t>(thread) * sizeof(Batch)) Batch;
  };
  const auto clear = [&](const Depths& cleared, int32_t y, int32_t rows) {
    for (size_t strip = 0; strip < strips; ++strip) {
      const size_t word = cleared.word(static_cast<int32_t>(32 * strip), y);
      if (cleared.marks) {
        memset(cleared.covered + word, 0, static_cast<size_t>(rows) * sizeof(uint32_t));
      }
      if (cleared.gray_scale != nullptr) {
        memset(cleared.gray + 32 * word, 0, static_cast<size_t>(rows) * 32);
      }
    }
  };

  // Draws tiles and parts until there are no more. Returns how many pixels hold anything.
  TileDrawer::Others others(tiles.count());
  const auto draw_all = [&](Batch* batch) {
    uint64_t hits = 0;
    TileDrawer drawer(lists, frame, depths, patches.data, by_blocks, batch, threads > 1 ? &others : nullptr);
    for (;;) {
      const int number = others.next(&drawer);
      if (number == TileDrawer::Others::kNothing) {
        return hits;
      }
      if (number != TileDrawer::Others::kGiven) {
        const int32_t first = tiles.begin(number);
        const int32_t rows = tiles.end(number) - first;
        clear(depths, band.first_row + first, rows);
        for (size_t strip = 0; strip < strips; ++strip) {
          memset(patches.data + strip * patches_of(band.rows) + first / kPatchRows, 0, patches_of(rows));
        }
        drawer.start(band.first_row + first, band.first_row + first + rows);
      }
      drawer.draw();
      hits += painter.paint_tile(drawer.frame(), depths);
      others.finish();
    }
  };
  uint64_t hits = 0;
  if (threads == 1) {
    Batch* const batch = batch_of(0);
    hits = draw_all(batch);
    done.counts = batch->counts;
  } else {
    for (int thread = 0; thread < threads; ++thread) {
      batch_of(thread);
    }
    std::atomic<uint64_t> all_hits{0};
    if (copies) {
      std::atomic<uint32_t> next_share{0};
      options.threads->each(threads, [&](int part) {
        clear(copy[part], band.first_row, band.rows);
        TileDrawer drawer(lists, frame, copy[part], nullptr, false, batch_at(part), nullptr, &next_share);
        drawer.start(frame.tile.y0, frame.tile.y1);
        drawer.draw();
      });
      options.threads->each((band.rows - 1) / kMergedRows + 1, [&](int part) {
        WideFrame merged = frame;
        merged.tile.y0 += part * kMergedRows;
        merged.tile.y1 = std::min(merged.tile.y0 + kMergedRows, frame.tile.y1);
        for (int thread = 1; thread < threads; ++thread) {
          merge_rows(copy[thread], camera.width_px(), merged.tile.y0, merged.tile.y1, depths);
        }
        all_hits += painter.paint_tile(merged, depths);
      });
    } else {
      options.threads->each(threads, [&](int part) { all_hits += draw_all(batch_at(part)); });
    }
    hits = all_hits;
    for (int thread = 0; thread < threads; ++thread) {
      done.counts.add(batch_at(thread)->counts);
    }
    done.splits = others.splits();
  }
  if (counts != nullptr) {
    counts->rays += static_cast<uint64_t>(camera.width_px()) * static_cast<uint64_t>(band.rows);
    counts->hits += hits;
    counts->node_visits += done.counts.nodes;
  }
  if (stats != nullptr) {
    *stats = done;
  }
  return Status::kOk;
}

}  // namespace thimble::wide
