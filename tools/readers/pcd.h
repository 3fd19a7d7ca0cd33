/// @file pcd.h
/// `.pcd` point clouds (Point Cloud Library), as text, as binary and as compressed binary.
///
/// What is read: headers of versions .5 to .7; of the fields x, y and z, of any type, and `rgb` or `rgba`,
/// four bytes that hold a colour (as an integer, or as the float with these bytes). All other fields are
/// passed over. Points whose position is not finite mark where the sensor saw nothing and are left out.
/// Compressed data (LZF) is unpacked once and kept. z is up, as it is in the file.
///
/// Source of the format: Point Cloud Library, "The PCD (Point Cloud Data) file format"; of LZF: Marc Lehmann,
/// "LibLZF", whose stream this reads with code of its own.
#ifndef THIMBLE_TOOLS_READERS_PCD_H
#define THIMBLE_TOOLS_READERS_PCD_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// True when the first word that is no comment is one that a header begins with, or the first comment says
/// it.
bool looks_like_pcd(std::span<const std::uint8_t> bytes);

/// Checks the whole file once; the result keeps `file`, or what it unpacks to, and streams from it.
/// @throws InputError  a broken header, a field's type or size that there is not, a count that the bytes
///   cannot hold, a line with too few values, damaged LZF, no finite point
Source read_pcd(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
