/// Triangles to voxels, watertight: no ray passes from outside to inside through a closed surface.
///
/// Vertices are fitted to the world and quantised once, to whole numbers of 1/256 voxel (world_fit.h); equal
/// positions stay equal, so a closed surface stays closed. From there on everything is exact: a voxel is
/// solid when its *closed* box [i,i+1] x [j,j+1] x [k,k+1] and the *closed* triangle have a point in common.
///
/// Why that does not leak. Let S be the quantised surface and p a point of S. Up to eight voxels have p in
/// their closed box (several when p lies in a face, an edge or a corner), and each of them meets the triangle
/// of p, so each is solid. The other closed boxes keep a positive distance r from p. So the ball of radius r
/// around p lies in solid voxels altogether. A ray that gets from one side of S to the other passes through
/// such a p and spends a positive length in that ball; by the tracer's rule (ray.h) it hits a solid voxel
/// there at the latest, whichever voxel owns the face, the edge or the corner that it runs through.
///
/// The same in the grid: two empty voxels that share as little as a corner are two closed boxes without a
/// point of S whose union is connected, so both are on the same side. Not even a walk with 26 neighbours gets
/// from outside to inside through empty voxels.
///
/// Conventions: meshes are y up, as most files are, and turn to z up by (x, y, z) -> (x, -z, y), which keeps
/// the hand; `z_up` leaves them as they are. Only vertices that a triangle uses count for the fit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "readers/source.h"
#include "scene/palette.h"

namespace thimble::tools {

/// A point in 1/256 voxel, 0 .. 2^20 on each axis (a world of 2^12 voxels).
using UnitPoint = std::array<std::int32_t, 3>;
using UnitTriangle = std::array<UnitPoint, 3>;

/// Whether a closed triangle and closed cubes have points in common, exactly, by separating axes: the box's
/// 3 normals, the triangle's normal and the 9 products of its edges with the axes (Tomas Akenine-Moeller,
/// "Fast 3D Triangle-Box Overlap Testing", 2001). The 9 are ordered by coordinate plane, as the projection of
/// the triangle onto the plane against that of the cube (Michael Schwarz and Hans-Peter Seidel, "Fast
/// Parallel Surface and Solid Voxelization on GPUs", 2010, section 3), so that a row of cubes shares a
/// plane's result. A triangle that is a segment or a point is tested as one: its normal and zero edges
/// separate nothing, and the axes that remain are those of the segment or point.
///
/// Bits, in a world of 2^12 voxels: coordinates and edges are below 2^20 in size (+-, one sign bit on top),
/// an edge's product with a coordinate 2^40, the sum of two 2^41. The triangle's normal has components of
/// twice the area of its projections, at most 2^40; times a distance of 2^20, three terms: 3 * 2^60 < 2^62.
/// The cube's half side adds 3 * 2^40 * 2^19 < 2^61. All fits a signed 64-bit integer.
class TriangleBoxTest {
 public:
  explicit TriangleBoxTest(const UnitTriangle& triangle);

  /// A cube by its centre and half its side, in units (voxel (i,j,k): 256 * i + 128, half 128).
  bool meets(const UnitPoint& center, std::int32_t half) const {
    return meets_bounds(center, half) && std::abs(distance(center)) <= normal_reach_ * half &&
           meets_plane(0, center, half) && meets_plane(1, center, half) && meets_plane(2, center, half);
  }
  /// Which of the 4 x 4 x 4 voxels from `voxel` on pass `meets`: bit x + 4 y + 16 z.
  std::uint64_t met_mask(const UnitPoint& voxel) const;

  const UnitPoint& low() const { return low_; }
  const UnitPoint& high() const { return high_; }

 private:
  /// The slab low <= u * (x - x0) + v * (y - y0) <= high of a plane's coordinates relative to vertex 0.
  struct Slab {
    std::int64_t u = 0, v = 0;
    std::int64_t low = 0, high = 0;
    std::int64_t reach = 0;  ///< |u| + |v|
  };
  /// The triangle's bounding box against the cube.
  bool meets_bounds(const UnitPoint& center, std::int32_t half) const;
  /// The edges' axes in the coordinate plane perpendicular to `axis`; `center[axis]` is not used.
  bool meets_plane(std::size_t axis, const UnitPoint& center, std::int32_t half) const;
  /// Of the centre from the triangle's plane, times the normal's length.
  std::int64_t distance(const UnitPoint& center) const {
    return normal_[0] * (center[0] - origin_[0]) + normal_[1] * (center[1] - origin_[1]) +
           normal_[2] * (center[2] - origin_[2]);
  }
  std::uint64_t bounds_mask(const UnitPoint& voxel) const;
  std::uint64_t slabs_mask(const UnitPoint& voxel) const;
  std::uint64_t surface_mask(const UnitPoint& voxel) const;

  UnitPoint origin_;  ///< vertex 0
  UnitPoint low_;
  UnitPoint high_;
  std::array<std::array<Slab, 3>, 3> slabs_;  ///< [axis left out][edge]
  std::array<std::int64_t, 3> normal_;
  std::int64_t normal_reach_;  ///< sum of the normal's absolute components
};

/// Takes a solid block: its lowest voxel, the log2 of its side (0 for a voxel), its material.
using BlockSink = std::function<void(const UnitPoint& voxel, int level, std::uint8_t material)>;

/// All vertices of `mesh`, turned, fitted to 2^level and quantised; a vertex that no triangle uses is
/// (0,0,0). InputError "no triangles" when there are none.
std::vector<UnitPoint> quantise_vertices(const TriangleMesh& mesh, int level, bool z_up);

/// Calls `visit` once for each voxel of the world of 2^level whose closed box meets `triangle` (coordinates
/// 1 .. 2^(level + 8) - 1). Cost: the least block of the octree that holds it is cut into eight, those that meet the
/// triangle again, and so on down to 4 x 4 x 4 voxels, so a big triangle costs in proportion to its area. No heap.
void voxelise_triangle(const UnitTriangle& triangle,
                       const std::function<void(const UnitPoint& voxel)>& visit);

/// Whether its voxels have colours of their own (below).
bool is_shaded(const TriangleMesh& mesh);
/// Streams the voxels of `mesh` in a world of 2^level voxels a side (level 1..12). `colors` may be null:
/// then, as for a mesh without colours, everything is material 0. `progress` may be empty. InputError "no
/// triangles".
///
/// Small triangles, and few of any size, come one by one. A voxel
/// then comes once for each triangle that it meets. Where there are many large ones (more than 2^24 voxels in
/// their boxes, and more than 64 a triangle), which may cover each other many times over, they go cell by cell:
/// each voxel comes once, with the material of the last triangle that meets it, and a full block as one. So time
/// follows the triangles and the surface that they have together. Memory: 12 bytes a vertex; cell by cell 44 bytes
/// a triangle more, and the lists.
///
/// A mesh with colours or pictures goes twice, so that of the triangles that meet a voxel the last one counts that its middle is
/// over, and only without one the last of all: an edge does not bleed into what is beside it. Voxels have colours of
/// their own (below), and none comes where all is clear.
void voxelise(const TriangleMesh& mesh, int level, bool z_up, const PaletteMap* colors, const BlockSink& sink,
              const Progress& progress = {});

// Triangles to voxels cell by cell, for a mesh whose triangles cover each other many times over: a voxel is
// asked for until one triangle has it, and a cell until it is full, however many triangles meet it.

/// A cube of 2^level voxels a side by its lowest voxel.
struct TriangleBlock {
  UnitPoint voxel;
  int level;
};

/// Of the 4 x 4 x 4 voxels from `corner` on that of the mask's lowest bit, x + 4 y + 16 z.
UnitPoint voxel_of(const UnitPoint& corner, std::uint64_t mask);
/// Of eight parts, bit a of `child` says the upper half of axis a.
TriangleBlock child_of(const TriangleBlock& block, int child);
bool meets_block(const TriangleBoxTest& test, const TriangleBlock& block);

/// A triangle and which of its voxels count.
struct CellTriangle {
  UnitTriangle corners;
  bool only_over = false;    ///< for a `CellShade`: only voxels whose middle is over it
  std::uint32_t number = 0;  ///< in its mesh
};

/// The material of a voxel that a triangle meets; nothing where the triangle does not count there.
using CellShade =
    std::function<std::optional<std::uint8_t>(const CellTriangle& triangle, const UnitPoint& voxel)>;

/// Calls `sink` for blocks that together hold each voxel of the world of 2^level that a triangle meets, once,
/// with material 0, or, where there is a `shade`, the material of the last such triangle that it has one of.
///
/// Time: the world is cut into eight, and so on, each part with a list of the triangles that meet it, down to
/// parts of 64 voxels a side. They are filled from the last triangle on, and what is full is left alone: its
/// cubes of 4 voxels, its cells of 16, and the triangles that are left once all of it is. Memory:
/// at most 32 bytes a triangle and level, where all of them meet everything.
void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress, const CellShade& shade = {});

/// The same for `count` triangles, `passes` times over, of which triangle_at(i) is the one numbered i % count in pass
/// i / count; one by one, or cell by cell where `voxelise` says so.
void voxelise_triangles(std::size_t count, std::size_t passes,
                        const std::function<CellTriangle(std::size_t)>& triangle_at, int level,
                        const CellShade& shade, const BlockSink& sink, const Progress& progress);

// Voxels of meshes with colours or pictures.
//
// A voxel has the colour of its triangle next to the voxel's middle: the face's, or that of the corners mixed there, times
// that of the picture, averaged as light over as much of it as a voxel covers. Where that is clear, the triangle gives no voxel; nor does its edge where the middle is
// beyond it and the picture, which continues there on a neighbour, is clear. A voxel that gives off a tenth of a screen's
// white, and more than it has of a colour, is of that light alone.

/// `voxelise` of a mesh that `is_shaded`; the material of a voxel is what `material_of` says of its colour and, where it
/// glows, its power (ColorHistogram), once or more often a voxel. Memory: 12 bytes a vertex, 19 more with a colour, and 24 a triangle that may
/// be clear; cell by cell 88 a triangle more, and the lists.
/// @throws InputError  no triangles, or so many clear ones over each other that it does not end
void voxelise_shaded(const TriangleMesh& mesh, int level, bool z_up,
                     const std::function<std::uint8_t(Rgb, std::uint32_t power_q8)>& material_of,
                     const BlockSink& sink, const Progress& progress);

/// For PaletteMap: the colours of its voxels in a world of 2^level, for which it is voxelised. Empty when it has none.
ColorHistogram mesh_colors(const TriangleMesh& mesh, int level, bool z_up);

}  // namespace thimble::tools
