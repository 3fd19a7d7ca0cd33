/// @file stl.h
/// `.stl` meshes, as text and as binary.
///
/// A file is binary when it does not begin with the word `solid`, or holds a zero byte in its first
/// `kFirstLookBytes`: exporters have written binary files that begin so. Of a text all `vertex` lines count, three a
/// facet, of any number of solids; of a binary file bytes behind the last triangle are noted, and colours are ignored, which programs write in ways that contradict each other. Normals are not
/// used. Corners are not joined: each triangle has three positions of its own.
///
/// z is up, as the programs have it that make such files.
///
/// Source of the format: 3D Systems, "StereoLithography Interface Specification", 1989.
#ifndef THIMBLE_TOOLS_READERS_STL_H
#define THIMBLE_TOOLS_READERS_STL_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Recognises the text form; a binary file does not say what it is.
bool looks_like_stl(std::span<const std::uint8_t> bytes);

/// Reads all of `file` and keeps none of it. Memory: 84 bytes a triangle, which takes at least 50 in the
/// file.
/// @throws InputError  a count that the bytes cannot hold, a facet that has not three corners, a coordinate
///   that is no finite number, no triangle
Source read_stl(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
