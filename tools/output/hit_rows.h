/// Hits as rows, the same columns wherever hits are written: lines of CSV, or a NumPy array of records.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "thimble/trace/ray.h"

namespace thimble::tools {

/// The column names: hit 0/1; voxel; t (17 significant digits; point = q-origin / 256 + t * q-direction, in
/// voxels); axis; nodes visited; q-origin in 1/256 voxel and q-direction as integers, both as traced; the voxel's index
/// in the palette; how far it is from the origin, in voxels, within 2 units of the last place.
inline constexpr const char* kHitColumns =
    "hit,vx,vy,vz,t,axis,nodes,qox,qoy,qoz,qdx,qdy,qdz,material,distance";
/// What --help says of them.
inline constexpr const char* kHitArray =
    "; a .npy holds the same columns as an array of records, -1 where a line is empty and inf for its t and "
    "distance";

/// How hits are written to one file. Voxel, t, axis, material and distance of a miss are empty, and so is the material
/// where what was traced keeps none; in an array they are -1, t and distance infinite.
class HitRows {
 public:
  /// @param path        decides: `.npy` is an array, all else lines
  /// @param has_pixels  whether px and py come first
  HitRows(const std::string& path, bool has_pixels, bool has_material);

  /// What stands before the first of `rows` rows.
  std::string beginning(std::uint64_t rows) const;
  /// Appends one row; `x_px` and `y_px` are left out where there are no pixels.
  void append(std::string* to, const Ray& ray, const Hit& hit, std::int32_t x_px = 0,
              std::int32_t y_px = 0) const;

 private:
  bool is_array_;
  bool has_pixels_;
  bool has_material_;
};

/// t as the nearest double: numerator and denominator are exact, so the division is the only rounding.
inline double hit_t(const Hit& hit) {
  return static_cast<double>(hit.t_numerator) / hit.t_denominator;
}

/// How far away it is, in voxels along the unit ray.
inline double hit_distance(const Ray& ray, const Hit& hit) {
  return hit_t(hit) * std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                 static_cast<double>(ray.direction.z));
}

/// The beginning of a NumPy array (readers/npy.cpp names the source of the format).
/// @param type   what stands behind 'descr', a quoted name or a list: "'|u1'"
/// @param shape  lengths as in Python's tuple: "3, 4" or "3,"
inline std::string npy_header(const std::string& type, const std::string& shape) {
  std::string text = "{'descr': " + type + ", 'fortran_order': False, 'shape': (" + shape + "), }";
  // The magic number, version 1.0 and the length take 10 bytes; data begin at a multiple of 64.
  text.append(63 - (10 + text.size()) % 64, ' ').append("\n");
  const std::string length{static_cast<char>(text.size() & 255), static_cast<char>(text.size() >> 8)};
  return std::string("\x93NUMPY\x01\x00", 8) + length + text;
}

}  // namespace thimble::tools
