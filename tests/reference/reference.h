/// The exact reference: what a ray hits, worked out the plain way, to judge every engine by. It shares no
/// code with the core and includes none of its headers.
///
/// Definitions (the law the engines are held to):
///  - A ray is the set of points origin_q8 / 256 + t * direction, t >= 0, in voxels; all six numbers are
///    integers.
///  - Voxel (i,j,k) is the half-open box [i,i+1) x [j,j+1) x [k,k+1).
///  - A ray hits a voxel when it spends a positive length inside it. Touching it in one point is no hit, and
///  a ray
///    that runs within a face or an edge belongs to the box that owns that face or edge.
///  - The answer is the solid voxel entered first. When the ray spends a positive length in it from t = 0 on,
///    t = 0 and axis = -1; otherwise axis is that of the face entered, the lowest axis when it enters through
///    several at the same t.
///
/// There is one answer. Two different voxels are disjoint boxes, so the two intervals of t that a ray spends
/// in them are disjoint as well; two intervals of positive length that began at the same t would share the
/// beginning. So no two voxels are entered first, and nothing needs a rule for that case.
///
/// There are two judges. `brute_force` looks at every voxel and follows the definitions word for word, in
/// 128-bit integers. `walk` visits the cells along the ray in order; it is held to `brute_force` by the tests
/// and is fast enough for worlds of 4096 voxels a side. `judge_blocks` is `brute_force` for trees that have
/// been coarsened into larger cubes.
///
/// None of them rounds, and none of them uses floating point (only `Hit::t` turns the exact answer into a
/// double).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace thimble::reference {

/// Indices of a voxel.
using Voxel = std::array<int, 3>;

/// Largest side of a `BitGrid`, and one above the largest voxel index, in voxels.
inline constexpr int kMaxSide = 4096;
/// Largest magnitude of a direction component.
inline constexpr std::int64_t kMaxDirection = (std::int64_t{1} << 20) - 1;
/// Largest magnitude of an origin component, in 1/256 voxel. The products of `walk` stay below 2^54 with it;
/// the engines accept much less (5 * 2^20).
inline constexpr std::int64_t kMaxOriginQ8 = std::int64_t{1} << 31;

/// A quantised ray.
struct Ray {
  std::array<std::int64_t, 3> origin_q8{};  ///< in 1/256 voxel, -kMaxOriginQ8 .. kMaxOriginQ8
  std::array<std::int64_t, 3> direction{};  ///< -kMaxDirection .. kMaxDirection, not all zero

  friend bool operator==(const Ray&, const Ray&) = default;
};

/// What a ray hits. For a miss (`hit` false) the other fields mean nothing.
struct Hit {
  bool hit = false;
  Voxel voxel{};
  /// t = t_numerator / t_denominator exactly, t_denominator > 0; not reduced.
  std::int64_t t_numerator = 0;
  std::int64_t t_denominator = 1;
  /// Axis of the face entered, or -1 when the ray starts inside.
  int axis = -1;

  /// The double nearest to t: both terms are below 2^53, so the one division is the one rounding.
  double t() const;
};

/// Whether two hits have exactly the same t, whatever fractions they are written as.
bool same_t(const Hit& a, const Hit& b);
/// Whether both miss, or both hit the same voxel at the same t through the same axis.
bool same_answer(const Hit& a, const Hit& b);

/// One line for a failure message: "origin_q8 (x, y, z) direction (x, y, z)".
std::string describe(const Ray& ray);
/// One line for a failure message: "miss" or "voxel (i, j, k) t n/d axis a".
std::string describe(const Hit& hit);

/// Throws `std::invalid_argument` when the ray is outside the limits above or its direction is zero. Every
/// judge does this first.
void check_ray(const Ray& ray);

/// The first of `voxels` that the ray hits; a voxel may be listed more than once. Cost: O(voxels).
Hit brute_force(const std::vector<Voxel>& voxels, const Ray& ray);

/// A solid cube of 2^log2_side voxels a side, aligned to its side.
struct Block {
  Voxel lowest{};     ///< lowest corner: multiples of the side
  int log2_side = 0;  ///< 0 .. 12
};

/// The first of `blocks` that the ray hits; `voxel` is the block's lowest corner. The blocks are the boxes
/// that count: t and axis are those of the block's faces, also where the ray enters it next to another block.
/// Blocks must not overlap (`std::logic_error` where that leaves the answer open, `std::invalid_argument` for
/// a block that is not aligned). Cost: O(blocks).
Hit judge_blocks(const std::vector<Block>& blocks, const Ray& ray);

/// One bit a voxel in a grid of any size up to 4096 a side, as three levels:
///
///     cells of 64^3 voxels  ->  8^3 bricks each  ->  8^3 bits each
///     4 bytes a cell            2 KiB where any      64 bytes where any
///                               voxel was set        voxel was set
///
/// So an empty 4096^3 grid takes 1 MiB, a full 1024^3 one 136 MiB.
class BitGrid {
 public:
  /// An empty grid of `size` voxels. Throws `std::invalid_argument` for a side outside 1 .. kMaxSide.
  explicit BitGrid(const Voxel& size);
  /// A grid with `voxels` set.
  BitGrid(const Voxel& size, const std::vector<Voxel>& voxels);

  const Voxel& size() const { return size_; }
  /// Number of voxels set.
  std::int64_t count() const { return count_; }

  /// Sets or clears a voxel. Throws `std::out_of_range` for one outside the grid.
  void set(const Voxel& voxel, bool solid = true);
  /// Whether a voxel is set; false outside the grid.
  bool test(const Voxel& voxel) const;
  bool contains(const Voxel& voxel) const;

  /// Log2 of the side of an aligned empty cube around `voxel`, which must be within the grid: 6 or 3 where
  /// nothing was ever set in the cell or the brick, 0 for an empty voxel; -1 when the voxel is solid. The
  /// cube may reach beyond the grid.
  int empty_log2_side(const Voxel& voxel) const;

 private:
  using Cell = std::array<std::int32_t, 512>;  // index of each brick, kNone where there is none
  using Brick = std::array<std::uint64_t, 8>;  // word z, bit 8 * y + x
  static constexpr std::int32_t kNone = -1;

  std::size_t cell_index(const Voxel& voxel) const;

  Voxel size_;
  Voxel cells_;  // size in cells
  std::int64_t count_ = 0;
  std::vector<std::int32_t> cell_of_;  // index into cell_table_, kNone where there is none
  std::vector<Cell> cell_table_;
  std::vector<Brick> bricks_;
};

/// What the rays given to `walk` met, added up over calls; to show that a test exercised the hard cases. A
/// crossing is tied when the ray passes through two or three lattice planes at the same t > 0: an edge or a
/// corner. Crossings inside blocks that `walk` skips as empty are not seen, and neither are those after the
/// hit.
struct Statistics {
  std::int64_t rays = 0;
  std::int64_t hits = 0;
  std::int64_t starts_inside = 0;     ///< hits with axis -1
  std::int64_t steps = 0;             ///< cells and empty blocks left behind
  std::int64_t tied_crossings = 0;    ///< through an edge or a corner
  std::int64_t corner_crossings = 0;  ///< of these, through a corner
  std::int64_t tied_rays = 0;         ///< rays with at least one tied crossing
  std::int64_t tied_hits = 0;         ///< hits whose voxel was entered through an edge or a corner

  Statistics& operator+=(const Statistics& other);
};

/// One line: "rays 10, hits 4, ...".
std::string describe(const Statistics& statistics);

enum class EmptyBlocks {
  kSkip,  ///< pass cells and bricks without voxels in one exact step
  kWalk,  ///< visit every voxel on the way
};

/// The first voxel of `grid` that the ray hits, by walking the cells along it in order. Cost: O(W + H + D)
/// steps. `statistics`, when given, is added to.
Hit walk(const BitGrid& grid, const Ray& ray, Statistics* statistics = nullptr,
         EmptyBlocks empty_blocks = EmptyBlocks::kSkip);

/// Side of the cubes of `mark_path`, in voxels.
inline constexpr int kPathCubeSide = 8;

/// Sets in `cubes`, a bit for each cube of kPathCubeSide^3 voxels of a world of `size`, those that the ray passes until it
/// comes into the cube of `answer`, or all of them for a miss. Whether that is the right answer `walk` then finds by a grid
/// of the voxels in these cubes alone, since it leaves no other cube before the answer. Cost: O(W + H + D) steps.
void mark_path(const Ray& ray, const Voxel& size, const Hit& answer, BitGrid* cubes);

}  // namespace thimble::reference
