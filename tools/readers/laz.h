/// `.laz`: the points of a `.las` file, compressed as LASzip does it. What is unpacked is what `las.cpp` reads.
#pragma once

#include "readers/file_bytes.h"
#include "readers/progress.h"

namespace thimble::tools {

/// What a LAS header says of its points.
struct LasPoints {
  std::uint64_t first_offset = 0;  ///< of the first record in the file
  std::uint64_t count = 0;
  std::uint64_t record_bytes = 0;
};

/// A record of what is unpacked: x, y, z, three bytes that mean nothing, and the byte 15 of the point's format, which
/// has the mark "withheld"; with colours then r, g, b of 16 bits. All little endian, as in LAS.
inline constexpr std::uint64_t kPlainPointBytes = 16;
inline constexpr std::uint64_t kColoredPointBytes = 22;

/// Unpacks the points that `points` describes, one record each.
///
/// Time: some 100 to 300 ns a point. Memory: the records and 4 MB. Believed are 2,000,000 points, and 5 for
/// each byte of the file.
///
/// Source: M. Isenburg, "LASzip: lossless compression of LiDAR data" (2013) and the specification of LASzip's native
/// extension for LAS 1.4; A. Said, "Introduction to Arithmetic Coding" (HPL-2004-76).
///
/// @throws InputError  a compressor, item or version that is not read (waveforms among the old formats, LASzip before
///   2.0), bytes that end too soon or are damaged, a count that they are not believed to hold
SharedBytes unpack_laz(const SharedBytes& file, const LasPoints& points, bool has_color,
                       const Progress& progress);

}  // namespace thimble::tools
