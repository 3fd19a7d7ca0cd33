/// Draws the boxes of one tile of the picture: walks the tree, skips blocks that cannot be seen, and hands
/// runs of boxes to the kernels.
#pragma once

#include "wide/raster/hidden_voxels.h"
#include "wide/raster/kernels.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::wide {

/// The entries of a run that cull_run() kept, and the same entries from front to back.
class SortedRun {
 public:
  static constexpr uint32_t kMostBoxes = 512;

  /// Culls the run of a block, which has at most kMostBoxes boxes, and sorts those that are left; `run` then reads them
  /// from here. Returns whether any are left.
  bool cull_and_sort(const WideFrame& frame, const Block& block, const Depths& depths, Batch* batch,
                     Run* run);

 private:
  void sort(const WideFrame& frame, const Block& block, uint32_t count);

  uint32_t entries_[kMostBoxes + kReadAhead];
  uint32_t numbers_[kMostBoxes + kReadAhead];
  uint32_t sorted_entries_[kMostBoxes + kReadAhead];
  uint32_t sorted_numbers_[kMostBoxes + kReadAhead];
};

/// Draws for one thread, one tile after the other.
class TileDrawer {
 public:
  /// What all threads of a frame share.
  struct Task {
    const VoxelLists& lists;
    const WideFrame& frame;
    bool by_blocks;
    const SolidStarts* starts;  ///< null where the lists leave nothing out
  };

  /// `full`: see all_covered().
  TileDrawer(const Task& task, const Depths& depths, uint8_t* full, Batch* batch);

  /// Draws rows y0 .. y1 - 1 of the picture, which frame().tile is then.
  void draw(int32_t y0, int32_t y1);

  const WideFrame& frame() const { return frame_; }

 private:
  static constexpr uint32_t kAhead = 8;

  bool is_leaf(const Block& block, const BlockNode& node, unsigned mask, bool is_tabled) const;
  bool faces_eye(const Block& block, const BlockNode& node) const;
  bool is_hidden(const Block& block) const;
  bool has_table(const Block& block) const;
  bool is_flat(const Block& block) const;
  float voxel_px(const Block& block) const;
  // Whether the boxes of a block are drawn from front to back.
  bool is_worth_sorting(const Block& block, const BlockNode& node) const;

  void push_children(const Block& block, const BlockNode& node, unsigned mask);
  void enqueue(const Block& block, const BlockNode& node);
  const uint32_t* lines_of(const BlockNode& node) const;
  uint32_t line_count(const BlockNode& node) const;
  void fetch(const BlockNode& node, uint32_t done) const;
  void draw_oldest();
  void start();
  void draw_starts();
  Run run_of(const Block& block) const;
  void draw_block(const Block& block, const BlockNode& node);
  ShortEntries short_entries_of(const BlockNode& node, const uint32_t (&corner)[3]) const;
  bool draw_short(const Block& block, const BlockNode& node, const Run& run);
  void widen_all(const uint32_t (&corner)[3], int level, uint32_t node, uint32_t* entries) const;
  void draw_cubes(const Block& block, const BlockNode& node, Run* run);

  const VoxelLists& lists_;
  WideFrame frame_;
  const SolidStarts* starts_;
  const Depths& depths_;
  uint8_t* full_;
  bool by_blocks_;
  Batch* batch_;
  int depth_ = 0;  ///< blocks on stack_
  Block stack_[7 * kMaxLevel + 8];
  Block ahead_[kAhead];  ///< a ring of blocks whose boxes are being fetched, in the order of drawing
  uint32_t ahead_first_ = 0;
  uint32_t ahead_count_ = 0;
  SortedRun sorted_;
  uint32_t
      widened_[kMostShortEntries + 2 * kReadAhead];  ///< the entries of a block whose list has short ones
};

}  // namespace thimble::wide
