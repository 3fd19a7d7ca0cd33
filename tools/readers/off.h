/// @file off.h
/// `.off` meshes (Geomview's Object File Format, the text form).
///
/// What is read: the keyword `OFF` with any of the prefixes `ST`, `C` and `N` in that order (texture
/// coordinates, colours, normals); the counts of vertices, faces and edges after it or on a later line;
/// comments from # to the end of the line. A vertex is three coordinates, then a normal, a colour and texture
/// coordinates as the keyword says; only the colour is used. A face is a count of corners and as many
/// indices, then an optional colour, which is ignored; faces of fewer than three corners make no triangle.
/// A file without faces becomes a point cloud.
///
/// Where there are as many lines as vertices and faces, what else stands on the last line of one is passed
/// over. In a file of fewer lines (several on one, all on one) the words alone count: a vertex is as many
/// numbers as the keyword says, with C three of a colour, and a face has no colour.
///
/// Colours (keyword with C): three or four numbers, the fourth ignored. In a file where all of them are
/// whole numbers and one is above 1, they go from 0 to 255; otherwise from 0 to 1. What lies outside is
/// clamped.
///
/// Not read: `OFF BINARY` and the forms of other dimensions (`4OFF`, `nOFF`); both are refused by name.
///
/// Source of the format: Geomview manual, chapter "OFF Files".
#ifndef THIMBLE_TOOLS_READERS_OFF_H
#define THIMBLE_TOOLS_READERS_OFF_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// True when the first word is a keyword that `read_off` accepts.
bool looks_like_off(std::span<const std::uint8_t> bytes);

/// Reads all of `file` and keeps none of it.
///
/// Memory: 24 bytes a vertex, 15 more with colour (12 of them only while reading), 12 a triangle. The counts
/// are held against the bytes that follow before anything is allocated.
/// @throws InputError  naming the line: no keyword, a count that the bytes cannot hold, a file that ends
///   early, a word that is no finite number, an index that is no vertex
Source read_off(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
