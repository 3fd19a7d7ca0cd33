/// What the tests of the readers share: files of THIMBLE_DATA, literals as files, and readable outcomes.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "readers/formats.h"

namespace thimble::tools::test {

using Reader = FormatReader*;

/// Path of THIMBLE_DATA, or empty after saying on stderr that the calling test is skipped.
std::filesystem::path data_folder();

/// Contents of a file; what ends in `.gz` is inflated.
std::string contents_of(const std::filesystem::path& path);

/// All points of a cloud, having checked that a second walk gives the same.
std::vector<CloudPoint> points_of(const PointCloud& cloud);

/// What a reader makes of these bytes.
Source source_of(Reader reader, std::string text);
/// Reads text that must be points, or must be a mesh; a failed check otherwise.
std::vector<CloudPoint> read_points(Reader reader, std::string text);
TriangleMesh read_mesh(Reader reader, std::string text);
bool cloud_has_color(Reader reader, std::string text);

/// A voxel of a grid.
struct GridVoxel {
  std::int32_t x = 0, y = 0, z = 0;
  Rgb color;
  friend bool operator==(const GridVoxel&, const GridVoxel&) = default;
};
/// All voxels of bytes that must be a grid.
std::vector<GridVoxel> read_voxels(Reader reader, std::string text);

/// The error's sentence, or "" when the text is read.
std::string error_of(Reader reader, std::string text);

/// Reads any bytes: the number of points or positions, having checked every promise of source.h (finite
/// positions, indices in range, colours as many as positions); -1 when refused, with a sentence.
long long outcome_of(Reader reader, std::string bytes);

/// Reads every truncated length of `whole`; returns the lengths that were not refused.
std::vector<std::size_t> accepted_lengths(Reader reader, const std::string& whole);

/// One note of the source contains `part`.
bool notes_hold(const Source& source, std::string_view part);

inline bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

}  // namespace thimble::tools::test
