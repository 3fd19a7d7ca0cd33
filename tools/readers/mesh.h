/// @file mesh.h
/// What the readers of meshes share: cutting polygons into triangles, and points out of a mesh without faces.
///
/// Polygons become fans around their first corner. A fan has the polygon's border whatever the polygon's
/// shape, so a closed surface stays closed; ear clipping, which gives up on polygons that are not flat or not
/// simple, leaves holes there. For a polygon that is not convex, some triangles of the fan lie outside of it.
#ifndef THIMBLE_TOOLS_READERS_MESH_H
#define THIMBLE_TOOLS_READERS_MESH_H

#include <cstddef>
#include <cstdint>

#include "readers/source.h"

namespace thimble::tools {

/// Most vertices of one mesh: an index into them has 32 bits.
inline constexpr std::uint64_t kMeshVertexLimit = std::uint64_t{1} << 32;

/// Makes a polygon's triangles from its corners, one corner at a time. Nothing comes of fewer than three.
class PolygonFan {
 public:
  explicit PolygonFan(TriangleMesh& mesh) : mesh_(mesh) {}
  void add(std::uint32_t corner) {
    if (corners_ >= 2) {
      mesh_.triangles.push_back({first_, last_, corner});
    }
    if (corners_ == 0) {
      first_ = corner;
    }
    last_ = corner;
    ++corners_;
  }

 private:
  TriangleMesh& mesh_;
  std::uint64_t corners_ = 0;
  std::uint32_t first_ = 0, last_ = 0;
};

/// Makes the triangles of a strip; every other one is turned, so that all face the same way. Triangles with a
/// repeated corner, which stitch strips together, are left out.
class TriangleStrip {
 public:
  explicit TriangleStrip(TriangleMesh& mesh) : mesh_(mesh) {}
  void add(std::uint32_t corner);
  void restart() { corners_ = 0; }

 private:
  TriangleMesh& mesh_;
  std::uint64_t corners_ = 0;
  std::uint32_t older_ = 0, last_ = 0;
};

/// `mesh` itself, or its vertices as a point cloud when the file has no faces at all.
/// @param face_count  faces in the file, those that made no triangle included
/// @throws InputError when there is no vertex
Source mesh_or_points(TriangleMesh mesh, std::uint64_t face_count);

/// A colour component from 0 to 1 as a byte, rounded; what lies outside is clamped, NaN is 0.
std::uint8_t unit_to_byte(double component);

}  // namespace thimble::tools

#endif
