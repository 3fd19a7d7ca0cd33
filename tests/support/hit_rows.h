/// The lines of `thimble trace` and `thimble render --hits`, read back by a parser of the tests' own and
/// judged by the exact reference.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reference/reference.h"

namespace thimble::tests {

inline constexpr const char* kHitHeader =
    "hit,vx,vy,vz,t,axis,nodes,qox,qoy,qoz,qdx,qdy,qdz,material,distance";

struct HitRow {
  int px = -1, py = -1;  ///< only with `--hits`
  bool hit = false;
  reference::Voxel voxel{};
  std::string t;  ///< as written
  int axis = -1;
  long nodes = 0;
  reference::Ray ray;
  int material = -1;     ///< -1: the structure keeps none
  double distance = -1;  ///< voxels
};

/// All rows after the header. Throws `std::runtime_error` naming the line when the header or a row is not as
/// the contract says: columns, whole numbers without blanks or plus signs, empty ones in a miss.
std::vector<HitRow> parse_hits(std::string_view csv, bool with_pixels);

/// What is wrong with the row, judged by `grid`: voxel, axis, t to the last of its 17 digits, and the
/// distance; empty when it is right.
std::string judge(const reference::BitGrid& grid, const HitRow& row);

/// `voxels` as a point file of voxel indices.
std::string as_xyz(const std::vector<reference::Voxel>& voxels);

}  // namespace thimble::tests
