#include "wide/raster/cost_model.h"

#include <math.h>
#include <string.h>

#include "wide/raster/hidden_voxels.h"

namespace thimble::wide {
namespace {

// With so few boxes it does not pay to leave any out.
constexpr uint32_t kFewBoxes = 64;
// The choice may take a hundredth of the frame's time; so much work of the frame allows a look at one cell.
constexpr float kWorkPerCell = 12000;
// Costs in units of one test of a pixel in flat order, about 0.8 ns. They were fitted to the times of 1,199 views, so
// that wrong choices cost as little time as possible. kBox: a box in flat order. kLargeTest: a test of a box that is
// drawn row by row, in either order. The others hold for blocks: a test by a table, a block with a table (its boxes
// cost nothing more), a box of another block (a large box costs only its tests), and using blocks at all.
constexpr float kBox = 0.1F;
constexpr float kLargeTest = 0.42F;
constexpr float kTableTest = 0.67F;
constexpr float kTableBlock = 62;
constexpr float kBoxInBlock = 0.24F;
constexpr float kBlocks = 110;
// Boxes of more than about so many pixels are drawn row by row: a mean of both orders (kernels/boxes.cpp).
constexpr float kLargePx = 40;
// The mean number of boxes in a block, and the mean side of a block in pixels (tile_drawer.cpp has the limits:
// kTableBoxes, kBlockBoxes, kTablePx).
constexpr float kMeanTableBoxes = 800;
constexpr float kMeanBlockBoxes = 120;
constexpr float kMeanTablePx = 40;
// Sides are halved until they are below a limit; on average they end at this share of it.
constexpr float kMeanOfMost = 0.7F;

// Finds the logarithm of a normal number above 0 within a hundredth, in a few steps: enough for a guess.
float log2_about(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof(bits));
  const float exponent = static_cast<float>(static_cast<int32_t>(bits >> 23) - 127);
  bits = (bits & 0x7FFFFFU) | 0x3F800000U;
  float part;  // 1 to 2
  memcpy(&part, &bits, sizeof(part));
  return exponent + (2 - part / 3) * part - 5.0F / 3;
}
float exp2_about(float x) {
  const float whole = floorf(fminf(fmaxf(x, -120), 120));
  const float part = fminf(fmaxf(x, -120), 120) - whole;
  const uint32_t bits = static_cast<uint32_t>(static_cast<int32_t>(whole) + 127) << 23;
  float power;
  memcpy(&power, &bits, sizeof(power));
  return power * (1 + part * (0.6565F + 0.3435F * part));
}
float power_about(float base, float exponent) {
  return exp2_about(exponent * log2_about(base));
}

// Cuts the tree into cells, level by level, and drops those that are out of sight. Lays the others front to back on a
// raster over the part of the picture that they take: each is a haze as dense as the faces of its boxes. It estimates
// what is hidden as if all that stands in front were strewn at random.
class Haze {
 public:
  Haze(const VoxelLists& lists, const WideFrame& frame) : lists_(lists), frame_(frame) {
    // A block's bend is its pixels times this (TileDrawer::is_flat).
    const float bend_per_px = frame.perspective ? frame.norm_w / (4 * frame.reach_x) : 0;
    table_px_ =
        fminf(kMeanTablePx, kMeanOfMost * cbrtf(2 * kMostBentPx / fmaxf(bend_per_px * bend_per_px, 1e-9F)));
    cut();
    lay();
  }

  bool blocks_pay() const { return count_ != 0 && blocks_ + kBlocks <= flat_; }

 private:
  static constexpr int kMostCells = 64;
  static constexpr int kRaster = 8;

  struct Cell {
    uint32_t node;
    int level;
    uint32_t corner[3];
    float x0, y0, x1, y1;  // in the picture
    float side_px;         // the longer side of the whole cell
    float voxel_px;        // area of a voxel in the cell's middle
    float slack_px;        // pixels that are tested besides
    float share;           // how much of the cell's rectangle is in the picture
  };

  // Finds the cell's rectangle; returns false where the cell is out of sight.
  bool place(Cell* cell) const {
    const float side = static_cast<float>(1 << cell->level);
    float x = frame_.u[3];
    float y = frame_.v[3];
    float depth = frame_.perspective ? frame_.w[3] : 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float middle = static_cast<float>(cell->corner[axis]) + side / 2;
      x += frame_.u[axis] * middle;
      y += frame_.v[axis] * middle;
      depth += frame_.perspective ? frame_.w[axis] * middle : 0;
    }
    if (frame_.perspective) {
      const float half = frame_.half_w * side;
      if (depth <= -half) {
        return false;
      }
      depth = fmaxf(depth, half / 2);
    }
    const float per_depth = 1 / depth;
    x *= per_depth;
    y *= per_depth;
    // How far a voxel reaches (frame.h) at that place, not at the worst place of the picture.
    float half_x = 0;
    float half_y = 0;
    for (int axis = 0; axis < 3; ++axis) {
      half_x += fabsf(frame_.u[axis] - (frame_.perspective ? x * frame_.w[axis] : 0)) * per_depth / 2;
      half_y += fabsf(frame_.v[axis] - (frame_.perspective ? y * frame_.w[axis] : 0)) * per_depth / 2;
    }
    cell->voxel_px = 4 * half_x * half_y;
    cell->slack_px = 4 * (half_x + frame_.slack_x) * (half_y + frame_.slack_y) - cell->voxel_px;
    half_x *= side;
    half_y *= side;
    cell->side_px = 2 * fmaxf(half_x, half_y);
    cell->x0 = fmaxf(x - half_x, static_cast<float>(frame_.tile.x0));
    cell->x1 = fminf(x + half_x, static_cast<float>(frame_.tile.x1));
    cell->y0 = fmaxf(y - half_y, static_cast<float>(frame_.tile.y0));
    cell->y1 = fminf(y + half_y, static_cast<float>(frame_.tile.y1));
    if (!(cell->x0 < cell->x1 && cell->y0 < cell->y1)) {
      return false;
    }
    cell->share = (cell->x1 - cell->x0) * (cell->y1 - cell->y0) / (4 * half_x * half_y);
    return true;
  }

  float boxes_of(const Cell& cell) const {
    return static_cast<float>(lists_.nodes()[cell.node].entries) * cell.share;
  }
  // The area of the faces of the cell's boxes, in pixels.
  float faces_of(const Cell& cell, float area) const { return cell.voxel_px * area * cell.share; }

  bool is_cut(const Cell& cell) const {
    return lists_.children(cell.node) != 0 && cell.level > lists_.block_level() &&
           lists_.nodes()[cell.node].entries > kFewBoxes;
  }

  // Appends the cell's children that are in sight, front to back. Returns how many children the cell has.
  int split(const Cell& cell) {
    const unsigned mask = lists_.children(cell.node);
    const uint32_t side = uint32_t{1} << (cell.level - 1);
    const unsigned first = frame_.nearest_octant(cell.corner, cell.level);
    for (unsigned turn = 0; turn < 8; ++turn) {
      const unsigned octant = turn ^ first;
      if ((mask >> octant & 1U) == 0) {
        continue;
      }
      Cell child{};
      child.node = lists_.nodes()[cell.node].first_child +
                   static_cast<uint32_t>(__builtin_popcount(mask & ((1U << octant) - 1)));
      child.level = cell.level - 1;
      for (unsigned axis = 0; axis < 3; ++axis) {
        child.corner[axis] = cell.corner[axis] + ((octant >> axis & 1U) != 0 ? side : 0);
      }
      const unsigned ways = ways_to(frame_.eye_cell, child.corner, uint32_t{1} << child.level);
      if ((lists_.facing(lists_.nodes()[child.node]) & ways) != 0 && place(&child)) {
        cells_[count_++] = child;
      }
    }
    return __builtin_popcount(mask);
  }

  void cut() {
    const CompactTree& tree = lists_.tree();
    Cell root{};
    root.level = tree.level();
    if (tree.empty() || !place(&root)) {
      return;
    }
    cells_[0] = root;
    count_ = 1;
    for (int looked = 1;;) {
      int cuts = 0;
      float work = 0;  // what the cells in sight are known to take
      for (int i = 0; i < count_; ++i) {
        const Cell& cell = cells_[i];
        cuts += is_cut(cell) ? 1 : 0;
        work += boxes_of(cell) +
                6 * faces_of(cell, static_cast<float>(lists_.face_area(lists_.nodes()[cell.node])));
      }
      const int most = 1 + static_cast<int>(fminf(work / kWorkPerCell, kMostCells));
      // About half of the children are in sight.
      if (cuts == 0 || looked + 4 * cuts > most) {
        return;
      }
      Cell* const from = cells_ + kRoom - count_;
      memmove(from, cells_, static_cast<size_t>(count_) * sizeof(Cell));
      const int before = count_;
      count_ = 0;
      for (int i = 0; i < before; ++i) {
        const Cell cell = from[i];
        if (is_cut(cell)) {
          looked += split(cell);
        } else {
          cells_[count_++] = cell;
        }
      }
    }
  }

  void lay() {
    float x0 = 1e9F;
    float x1 = -1e9F;
    float y0 = 1e9F;
    float y1 = -1e9F;
    for (int i = 0; i < count_; ++i) {
      x0 = fminf(x0, cells_[i].x0);
      x1 = fmaxf(x1, cells_[i].x1);
      y0 = fminf(y0, cells_[i].y0);
      y1 = fmaxf(y1, cells_[i].y1);
    }
    float open[kRaster][kRaster];
    for (auto& row : open) {
      for (float& part : row) {
        part = 1;
      }
    }
    const float per_x = kRaster / (x1 - x0);
    const float per_y = kRaster / (y1 - y0);
    for (int i = 0; i < count_; ++i) {
      const Cell& cell = cells_[i];
      const BlockNode& node = lists_.nodes()[cell.node];
      const float faces_px = faces_of(cell, static_cast<float>(lists_.face_area(node)));
      const float rectangle = (cell.x1 - cell.x0) * (cell.y1 - cell.y0);
      const float density = fminf(faces_px / rectangle, 50);
      const float left = exp2_about(-1.4427F * density);
      const float left_x = (cell.x0 - x0) * per_x;
      const float right_x = (cell.x1 - x0) * per_x;
      const float upper_y = (cell.y0 - y0) * per_y;
      const float lower_y = (cell.y1 - y0) * per_y;
      float area = 0;
      float open_area = 0;
      for (int y = static_cast<int>(upper_y); y < kRaster && static_cast<float>(y) < lower_y; ++y) {
        const float high = fminf(lower_y, static_cast<float>(y + 1)) - fmaxf(upper_y, static_cast<float>(y));
        for (int x = static_cast<int>(left_x); x < kRaster && static_cast<float>(x) < right_x; ++x) {
          const float part =
              high * (fminf(right_x, static_cast<float>(x + 1)) - fmaxf(left_x, static_cast<float>(x)));
          area += part;
          open_area += part * open[y][x];
          open[y][x] *= 1 - part * (1 - left);
        }
      }
      const float before = area > 0 ? open_area / area : 1;
      // How much of what the cell's boxes would cover is still open when they are drawn. (A block is left out when all
      // of its pixels are covered.)
      const float seen = fminf(density > 1e-6F ? before * (1 - left) / density : before, 1);
      const float entries = static_cast<float>(node.entries);
      // A block that is partly in the picture is looked at as a whole.
      const float small_px = cell.side_px * power_about(fmaxf(entries / kMeanBlockBoxes, 1), -1.0F / 3);
      const float whole = (1 + small_px / (cell.x1 - cell.x0)) * (1 + small_px / (cell.y1 - cell.y0));
      const float boxes = entries * fminf(cell.share * whole, 1);
      const bool is_large = cell.voxel_px >= kLargePx;
      const bool has_table = !lists_.has_blocks() && cell.voxel_px < kTableVoxelPx * kTableVoxelPx;
      const float blocks = entries / (has_table ? kMeanTableBoxes : kMeanBlockBoxes);
      const float block_px = blocks > 1 ? rectangle * power_about(blocks, -2.0F / 3) : rectangle;
      const float looked_at = boxes * (1 - power_about(fmaxf(1 - seen, 1e-6F), fmaxf(block_px, 1)));
      const float tests = (faces_px + boxes * cell.slack_px) * (is_large ? kLargeTest : 1);
      const float flat = tests + kBox * boxes;
      float work = tests * seen;
      if (has_table) {
        work *= kTableTest;
        // How many blocks a cell of that size has, if each is cut like the cell: into eight, or into four on a surface.
        const float across = fmaxf(cell.side_px / table_px_, 1);
        const float parts = static_cast<float>(__builtin_popcount(lists_.children(cell.node)));
        const float table_blocks = parts > 1 ? power_about(across, log2_about(parts)) : 1;
        const float per_box = fmaxf(fminf(table_blocks / entries, 1), 1 / kMeanTableBoxes);
        work += kTableBlock * per_box * looked_at;
      } else if (!is_large) {
        work += kBoxInBlock * looked_at;
      }
      blocks_ += work;
      flat_ += flat;
    }
  }

  // Room for the children, at most eight for each of kMostCells / 4 cells, and behind them for the cells that are cut.
  static constexpr int kRoom = 4 * kMostCells;
  const VoxelLists& lists_;
  const WideFrame& frame_;
  float table_px_;  // mean side of blocks that are drawn by tables
  Cell cells_[kRoom];
  int count_ = 0;
  float flat_ = 0;  // work in the order of the list
  float blocks_ = 0;
};

}  // namespace

bool blocks_pay(const VoxelLists& lists, const WideFrame& frame) {
  return lists.size() > kFewBoxes && Haze(lists, frame).blocks_pay();
}

}  // namespace thimble::wide
