/// @file obj.h
/// `.obj` meshes (Wavefront), parsed by tinyobjloader.
///
/// What is read: vertices `v x y z`, with colours `v x y z r g b` (0 to 1) when every vertex has one, and
/// faces `f` of any number of corners, whose indices count from 1 or, negative, back from the last vertex.
/// Where vertices have none, faces have the colour `Kd` of their material in the `.mtl` files beside this one, and
/// where a material has a picture and faces have texture coordinates, the picture's (obj_materials.h). A line may
/// continue after a backslash; a # that begins a word begins a comment. All other statements are ignored: normals,
/// groups, lines and curves play no part. Faces of fewer than three corners make no triangle. A file without faces
/// becomes a point cloud.
///
/// tinyobjloader reads what is no number as 0, so each line is checked here before it gets there; and the
/// parser is used through its callbacks, which hold one statement at a time, and given only `v` and `f`
/// statements, because some of the others allocate whatever a number in them says.
#ifndef THIMBLE_TOOLS_READERS_OBJ_H
#define THIMBLE_TOOLS_READERS_OBJ_H

#include <string>

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Reads all of `file`, which is at `path`, and keeps none of it.
///
/// Memory: 24 bytes a vertex (27 with colour), 8 a texture coordinate, 12 a triangle (19 with materials, 35 with
/// pictures), at most three times the triangles' while they
/// grow, which only polygons make them, and the longest line twice.
/// @throws InputError  naming the line: a coordinate that is missing or no finite number, an index that is
///   zero, no integer or no vertex of the file
Source read_obj_at(const std::string& path, const SharedBytes& file, const Progress& progress = {});
/// The same of a file that is alone.
Source read_obj(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
