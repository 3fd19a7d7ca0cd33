#include "host/wide/renderer.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <string.h>

#include <atomic>
#include <new>

#include "host/wide/choice.h"
#include "host/wide/exact.h"
#include "host/wide/painter.h"

namespace thimble::wide {
namespace {

// Runs of more boxes than this are cut up, flat or not, so that blocks out of sight are not projected.
constexpr uint32_t kFlatBoxes = 4096;
constexpr uint32_t kBlockBoxes = 320;
// Blocks of so few pixels a side are drawn whole: what they could hide pays no cut.
constexpr int32_t kTinyPx = 16;
constexpr uint32_t kTinyBoxes = 1024;
// Of blocks that are looked up in tables; they are to be no larger than that.
constexpr uint32_t kTableBoxes = 700;
constexpr int32_t kTablePx = 28;
// Boxes of at least so many pixels a side, in the mean of their faces, are drawn one behind the other.
constexpr float kSortedPx = 6.0F;
constexpr uint32_t kMostSorted = 512;
constexpr int32_t kPatchRows = 16;
// Up to so many threads draw lists of so many boxes each in a picture of its own. Fewer boxes are drawn in
// the time that it takes to put pictures together, and more pictures are more than caches hold.
constexpr int kMostCopies = 4;
constexpr size_t kCopyBoxes = 150000;

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

struct Block {
  uint32_t node;
  int level;
  uint32_t corner[3];
  Place place;
};

// One tile of the picture, by one thread.
class TileDrawer {
 public:
  // `next_share`: null, or common to several that share the runs of a list among them, each with depths of
  // its own; not with blocks.
  TileDrawer(const VoxelLists& lists, const Frame& frame, const Depths& depths, uint8_t* full, bool by_blocks,
             Batch* batch, std::atomic<uint32_t>* next_share = nullptr)
      : lists_(lists),
        frame_(frame),
        depths_(depths),
        full_(full),
        by_blocks_(by_blocks),
        batch_(batch),
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

  void draw() {
    const CompactTree& tree = lists_.tree();
    if (tree.empty()) {
      return;
    }
    Block stack[7 * kMaxLevel + 8];
    int depth = 0;
    const float zeros[8] = {};
    Place places[8];
    find_places(frame_, zeros, zeros, zeros, static_cast<float>(1 << tree.level()), places);
    if (places[0].where.x0 < places[0].where.x1) {
      stack[depth++] = {0, tree.level(), {0, 0, 0}, places[0]};
    }
    while (depth > 0) {
      const Block block = stack[--depth];
      ++batch_->counts.nodes;
      const BlockNode& node = lists_.nodes()[block.node];
      const unsigned mask = tree.mask(block.node);
      const int32_t widest = width_of(block.place.where);
      const bool has_table = by_blocks_ && !lists_.has_blocks() && voxel_px(block) < kTableVoxelPx;
      const bool is_cut_off = touches_edge(block.place.where);
      const uint32_t small = has_table ? kTableBoxes : by_blocks_ || is_cut_off ? kBlockBoxes : kFlatBoxes;
      const bool is_few = node.entries <= (widest <= kTinyPx && small < kTinyBoxes ? kTinyBoxes : small) &&
                          block.level <= kCubeLevel;
      const bool is_leaf =
          mask == 0 || block.level <= lists_.block_level() || (is_few && !(has_table && widest > kTablePx));
      const bool is_family = !is_leaf && has_table && is_few && widest <= 2 * kTablePx;
      if (by_blocks_ && (!has_table || widest > 2 * kTablePx) &&
          all_covered(depths_, block.place.where, full_)) {
        continue;
      }
      if (is_leaf || is_family) {
        if (!is_ours()) {
          continue;
        }
        // Its boxes are fetched while those of the blocks before it are drawn.
        const uint32_t* entries = lists_.entries().data + node.first_entry;
        for (uint32_t line = 0; 16 * line < node.entries && line < kMostLines; ++line) {
          __builtin_prefetch(entries + 16 * line);
        }
        if (ahead_count_ == kAhead) {
          draw_oldest();
        }
        ahead_[(ahead_first_ + ahead_count_++) % kAhead] = {block, is_family ? mask : 0};
        continue;
      }
      Block children[8];
      for (unsigned child = children_of(block, node, mask, children); child-- > 0;) {
        __builtin_prefetch(&lists_.nodes()[children[child].node]);
        stack[depth++] = children[child];  // the last pushed is the first drawn
      }
    }
    while (ahead_count_ != 0) {
      draw_oldest();
    }
    finish(frame_, depths_, batch_);
  }

 private:
  static constexpr uint32_t kAhead = 4;
  static constexpr uint32_t kRunsPerShare = 2;
  static constexpr uint32_t kMostLines = 64;
  struct Waiting {
    Block block;
    unsigned mask;  ///< not 0: its children are drawn, one after the other
  };

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

  static int32_t width_of(const Rectangle& where) {
    const int32_t x = where.x1 - where.x0;
    const int32_t y = where.y1 - where.y0;
    return x > y ? x : y;
  }

  bool touches_edge(const Rectangle& where) const {
    return where.x0 == frame_.tile.x0 || where.y0 == frame_.tile.y0 || where.x1 == frame_.tile.x1 ||
           where.y1 == frame_.tile.y1;
  }

  // The children that may be seen, front to back. Returns how many.
  unsigned children_of(const Block& block, const BlockNode& node, unsigned mask, Block* children) const {
    const uint32_t side = uint32_t{1} << (block.level - 1);
    float x[8];
    float y[8];
    float z[8];
    unsigned first = 0;  // the octant nearest to the eye
    for (unsigned octant = 0; octant < 8; ++octant) {
      x[octant] = static_cast<float>(block.corner[0] + ((octant & 1U) != 0 ? side : 0));
      y[octant] = static_cast<float>(block.corner[1] + ((octant & 2U) != 0 ? side : 0));
      z[octant] = static_cast<float>(block.corner[2] + ((octant & 4U) != 0 ? side : 0));
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
      first |= eye_cell_[axis] >= static_cast<int32_t>(block.corner[axis] + side) ? 1U << axis : 0U;
    }
    Place places[8];
    find_places(frame_, x, y, z, static_cast<float>(side), places);
    unsigned count = 0;
    for (unsigned turn = 0; turn < 8; ++turn) {
      const unsigned octant = turn ^ first;
      if ((mask >> octant & 1U) == 0 || places[octant].where.x0 >= places[octant].where.x1) {
        continue;
      }
      const uint32_t number = static_cast<uint32_t>(__builtin_popcount(mask & ((1U << octant) - 1)));
      children[count++] = {node.first_child + number,
                           block.level - 1,
                           {block.corner[0] + ((octant & 1U) != 0 ? side : 0),
                            block.corner[1] + ((octant & 2U) != 0 ? side : 0),
                            block.corner[2] + ((octant & 4U) != 0 ? side : 0)},
                           places[octant]};
    }
    return count;
  }

  void draw_oldest() {
    const Waiting& oldest = ahead_[ahead_first_];
    ahead_first_ = (ahead_first_ + 1) % kAhead;
    --ahead_count_;
    const Block& block = oldest.block;
    // What lay before it may have been drawn since. Small ones are looked up as they are drawn.
    if (by_blocks_ && width_of(block.place.where) > kTablePx &&
        all_covered(depths_, block.place.where, full_)) {
      return;
    }
    const BlockNode& node = lists_.nodes()[block.node];
    if (oldest.mask == 0) {
      draw_block(block, node);
      return;
    }
    Block children[8];
    const unsigned count = children_of(block, node, oldest.mask, children);
    batch_->counts.nodes += count;
    const uint32_t within = (uint32_t{1} << kCubeLevel) - 1;
    const uint32_t corner[3] = {block.corner[0] & within, block.corner[1] & within, block.corner[2] & within};
    Linear linear;
    find_linear(frame_, corner, uint32_t{1} << block.level, block.place, &linear);
    for (unsigned child = 0; child < count; ++child) {
      draw_block(children[child], lists_.nodes()[children[child].node], linear.is_sound ? &linear : nullptr);
    }
  }

  void draw_block(const Block& block, const BlockNode& node, const Linear* linear = nullptr) {
    Run run;
    run.linear = linear;
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
      const bool is_large = face_px >= kSortedPx * kSortedPx * static_cast<float>(node.entries);
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
  const Frame& frame_;
  const Depths& depths_;
  uint8_t* full_;  // see all_covered
  bool by_blocks_;
  Batch* batch_;
  std::atomic<uint32_t>* next_share_;
  uint32_t share_;
  uint32_t run_ = 0;
  int32_t eye_cell_[3];
  Waiting ahead_[kAhead];  ///< blocks on their way from memory, a ring in the order of drawing
  uint32_t ahead_first_ = 0;
  uint32_t ahead_count_ = 0;
  uint32_t entries_[kMostSorted + kReadAhead];
  uint32_t numbers_[kMostSorted + kReadAhead];
  uint32_t sorted_entries_[kMostSorted + kReadAhead];
  uint32_t sorted_numbers_[kMostSorted + kReadAhead];
};

// The picture is cut into tiles of whole rows, so that as many threads are busy to the end: first a large one
// for each, then a small one for each that is done. Few, since boxes on a seam are looked at on both
// sides.
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
    float wanted = 0;
    int part = 0;
    for (int32_t last = 0; last < rows;) {
      const bool is_large = count_ < threads;
      wanted += all * (is_large ? 1 - kSmallShare : kSmallShare) / static_cast<float>(threads);
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
      last = end < rows && count_ + 1 < kMost ? end : rows;
      end_[count_++] = last;
    }
  }

  int count() const { return count_; }
  int32_t begin(int tile) const { return tile == 0 ? 0 : end_[tile - 1]; }
  int32_t end(int tile) const { return end_[tile]; }

 private:
  static constexpr float kSmallShare = 0.28F;
  static constexpr int kMost = kMaxPicturePx / kPatchRows;
  int count_ = 1;
  int32_t end_[kMost];
};

Status check(const VoxelLists& lists, const Camera& camera, const Band& band, Bytes workspace,
             const Options& options) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != lists.tree().level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row || options.threads < 1 ||
      options.threads > kMaxThreads) {
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
      workspace.size < workspace_bytes(width, band.rows, options.threads)) {
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
  const Status status = check(lists, camera, band, workspace, options);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  Frame frame;
  if (!make_frame(camera, {0, band.first_row, camera.width_px(), band.first_row + band.rows}, &frame)) {
    return Status::kTooFine;
  }
  Stats done;
  done.order = options.order;
  Outlook outlook;
  if (done.order == Order::kAuto || options.threads > 1) {
    outlook = outlook_of(lists, frame);
  }
  if (done.order == Order::kAuto) {
    done.order = outlook.blocks_pay ? Order::kBlocks : Order::kFlat;
  }
  const bool by_blocks = done.order == Order::kBlocks;
  const Tiles tiles(band.rows, options.threads, by_blocks ? outlook.blocks : outlook.flat);
  const auto make_tile = [&](int tile, Frame* made) {
    return make_frame(
        camera, {0, band.first_row + tiles.begin(tile), camera.width_px(), band.first_row + tiles.end(tile)},
        made);
  };
  for (int tile = 0; tile < tiles.count(); ++tile) {
    Frame part;
    if (!make_tile(tile, &part)) {
      return Status::kTooFine;
    }
  }

  Arena arena(workspace);
  const size_t strips = strips_of(camera.width_px());
  const Painter painter(lists, camera, shading, band);
  const auto make_depths = [&] {
    const size_t pixels = strips * static_cast<size_t>(band.rows) * 32;
    const Bytes nearest = arena.take(pixels * sizeof(uint64_t), 64);
    Depths depths;
    depths.nearest = reinterpret_cast<uint64_t*>(nearest.data);
    depths.gray_scale = painter.gray_scale();
    depths.shading = &shading;
    depths.nearest_key = reinterpret_cast<uint32_t*>(nearest.data);
    depths.gray = nearest.data + pixels * sizeof(uint32_t);
    depths.covered = reinterpret_cast<uint32_t*>(
        arena.take(covered_words(camera.width_px(), band.rows) * sizeof(uint32_t)).data);
    depths.marks = by_blocks || depths.gray_scale == nullptr;
    depths.rows = band.rows;
    depths.first_row = band.first_row;
    return depths;
  };
  const bool copies = options.threads > 1 && options.threads <= kMostCopies && !by_blocks &&
                      lists.entries().size >= kCopyBoxes;
  Depths copy[kMostCopies] = {make_depths()};
  const Depths& depths = copy[0];
  for (int thread = 1; copies && thread < options.threads; ++thread) {
    copy[thread] = make_depths();
  }
  const Bytes patches = arena.take(strips * patches_of(band.rows), 1);
  const Bytes batches = arena.take(static_cast<size_t>(options.threads) * sizeof(Batch), alignof(Batch));
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

  const auto draw_tile = [&](int number, Batch* batch) {
    Frame tile;
    (void)make_tile(number, &tile);
    const int32_t rows = tile.tile.y1 - tile.tile.y0;
    clear(depths, tile.tile.y0, rows);
    for (size_t strip = 0; strip < strips; ++strip) {
      memset(patches.data + strip * patches_of(band.rows) + tiles.begin(number) / kPatchRows, 0,
             patches_of(rows));
    }
    TileDrawer(lists, tile, depths, patches.data, by_blocks, batch).draw();
    return painter.paint_tile(tile, depths);
  };
  uint64_t hits = 0;
  if (options.threads == 1) {
    Batch* const batch = batch_of(0);
    hits = draw_tile(0, batch);
    done.counts = batch->counts;
  } else {
    // More threads than processors are no gain, but what was asked for.
    const oneapi::tbb::global_control allowed(oneapi::tbb::global_control::max_allowed_parallelism,
                                              static_cast<size_t>(options.threads));
    oneapi::tbb::task_arena workers(options.threads);
    for (int thread = 0; thread < options.threads; ++thread) {
      batch_of(thread);
    }
    std::atomic<uint64_t> all_hits{0};
    std::atomic<int> next{0};
    if (copies) {
      std::atomic<uint32_t> next_share{0};
      workers.execute([&] {
        oneapi::tbb::parallel_for(0, options.threads, [&](int part) {
          clear(copy[part], band.first_row, band.rows);
          TileDrawer(lists, frame, copy[part], nullptr, false, batch_at(part), &next_share).draw();
        });
        oneapi::tbb::parallel_for(0, tiles.count(), [&](int number) {
          Frame tile;
          (void)make_tile(number, &tile);
          for (int part = 1; part < options.threads; ++part) {
            merge_rows(copy[part], camera.width_px(), tile.tile.y0, tile.tile.y1, depths);
          }
          all_hits += painter.paint_tile(tile, depths);
        });
      });
    } else {
      workers.execute([&] {
        oneapi::tbb::parallel_for(0, options.threads, [&](int part) {
          for (int tile = next++; tile < tiles.count(); tile = next++) {
            all_hits += draw_tile(tile, batch_at(part));
          }
        });
      });
    }
    hits = all_hits;
    for (int thread = 0; thread < options.threads; ++thread) {
      done.counts.add(batch_at(thread)->counts);
    }
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
