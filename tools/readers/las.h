/// @file las.h
/// `.las` laser scans, versions 1.0 to 1.4, point formats 0 to 10.
///
/// What is read: positions, and colours of the formats that have them (2, 3, 5, 7, 8, 10). Colours have 16
/// bits, but many files hold bytes: where no component of the file is above 255, they are taken to be that;
/// where all are 0, there are none. Points marked as withheld are left out, which is what the mark is for.
/// All else (intensity, returns, classes, waves, records of variable length, the coordinate system) is passed
/// over. z is up, as it is in the file.
///
/// Not read: `.laz`, the compressed form, for which Debian has no library. It is refused by name.
///
/// Source of the format: ASPRS, "LAS Specification 1.4 - R15", and those of the versions before it.
#ifndef THIMBLE_TOOLS_READERS_LAS_H
#define THIMBLE_TOOLS_READERS_LAS_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

bool looks_like_las(std::span<const std::uint8_t> bytes);

/// Checks the whole file once; the result keeps `file` and streams from it.
/// @throws InputError  another version or format, compressed points, a count that the bytes cannot hold, a
///   record too short for its format, a position that is not finite, no point
Source read_las(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
