/// @file ply.h
/// `.ply` files: meshes and point clouds, as text and as binary of either byte order.
///
/// What is read: any elements and properties of any scalar type (old names such as `uchar`, new ones such as
/// `uint8`) and lists anywhere; of these are used
/// - element `vertex`: x, y, z; and red, green, blue (also `diffuse_red` ..., or `r`, `g`, `b`) when all
///   three are there: integers from 0 to 255 (ushort: 0 to 65535), float and double from 0 to 1, clamped;
/// - element `face`: the list `vertex_indices` or `vertex_index`, a polygon;
/// - element `tristrips`: a list of the same name, strips separated by -1.
/// All else is passed over, colours of faces included. A file with faces or strips becomes a mesh, any other
/// a point cloud that streams from the file's bytes.
///
/// Header lines may end with LF, CRLF or CR; lines with an unknown first word are passed over like comments,
/// because exporters have written such. Values of a text file may be laid out on lines in any way, but there
/// must be exactly as many as the header declares. Bytes after the last binary element are ignored.
///
/// Source of the format: Greg Turk, "The PLY Polygon File Format", 1994.
#ifndef THIMBLE_TOOLS_READERS_PLY_H
#define THIMBLE_TOOLS_READERS_PLY_H

#include <string>

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// True when the bytes begin with the line "ply".
bool looks_like_ply(std::span<const std::uint8_t> bytes);

/// Checks the whole file; a mesh is returned as read, a point cloud keeps `file` and reads it again each
/// time.
///
/// Pictures of a mesh (`comment TextureFile`) lie beside the file; coordinates on them are those of corners (`texcoord`
/// of faces, with `texnumber` where there are several), or else those of vertices (`u v`, `s t`, `texture_u texture_v`).
/// A mesh whose picture is there has its colours alone.
///
/// Memory beyond the file: a mesh holds 24 bytes a vertex (27 with colour) and 12 a triangle, with pictures 8 more a
/// place on them and 16 a triangle; a point cloud some bytes a header line. A count of the header is held against the bytes that follow before anything is
/// allocated for it.
/// @throws InputError  a broken header; a count that the bytes cannot hold; a file that ends early; text that
///   is no number; a coordinate that is not finite; an index out of range; no vertex
Source read_ply_at(const std::string& path, const SharedBytes& file, const Progress& progress = {});
/// The same of a file that is alone.
Source read_ply(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
