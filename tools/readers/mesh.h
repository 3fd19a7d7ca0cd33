/// What the readers of meshes share: cutting polygons into triangles, and points out of a mesh without faces.
///
/// A polygon becomes a fan around its first corner, or, where it is not convex, what clipping its ears leaves: always
/// triangles with the polygon's own border, so that a closed surface stays closed.
#pragma once

#include "readers/source.h"

namespace thimble::tools {

/// Most vertices of one mesh: an index into them has 32 bits.
inline constexpr std::uint64_t kMeshVertexLimit = std::uint64_t{1} << 32;

/// Makes the triangles of polygons, one corner at a time. Nothing comes of fewer than three corners.
class Polygons {
 public:
  explicit Polygons(TriangleMesh& mesh) : mesh_(mesh) {}
  void begin() { corners_ = 0; }
  void add(std::uint32_t corner, std::uint32_t texcoord = kNoTexcoord);
  /// Once all positions are there: cuts the polygons that are not convex by their ears. Polygons of more than
  /// `kMostEarCorners` corners stay fans, and so does what has no ear, for it crosses itself.
  void cut_ears();

 private:
  TriangleMesh& mesh_;
  std::vector<bool> continues_;  ///< of a triangle: it belongs to the polygon of the one before
  std::uint64_t corners_ = 0;
  std::uint32_t first_ = 0, last_ = 0;
  std::uint32_t first_texcoord_ = 0, last_texcoord_ = 0;
};
/// Takes the texture coordinates from triangles that have some and not others, or numbers of none; and the pictures
/// from a mesh that has no coordinates or of whose pictures none is there.
void check_texcoords(TriangleMesh& mesh);
/// An ear is found among so many corners by trying all of them.
inline constexpr std::size_t kMostEarCorners = 512;

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
