/// @file npy.h
/// NumPy arrays: `.npy`, and of an `.npz` the member with the most numbers among those of two dimensions and
/// more.
///
/// What an array is, its shape says:
/// - N x 3 or N x 6 floats: points; columns 4 to 6 are a colour where all are whole numbers from 0 to 255.
/// - H x W numbers: heights, the first row the farthest (height_grid.h).
/// - X x Y x Z: voxels, solid where a number is not 0 (a float: 0.5 or more).
/// - X x Y x Z x 3 bytes: colours, black is empty; x 4: empty where the fourth is 0.
/// Numbers are booleans, integers or floats of 4 or 8 bytes, of either byte order, in C or Fortran order. In
/// arrays of voxels z is up.
///
/// Source of the format: NumPy, "NEP 1 - A Simple File Format for NumPy Arrays".
#ifndef THIMBLE_TOOLS_READERS_NPY_H
#define THIMBLE_TOOLS_READERS_NPY_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// True for a `.npy` and for a `.zip` whose first member's name ends so.
bool looks_like_npy(std::span<const std::uint8_t> bytes);

/// Checks the whole array; the result keeps `file`, or the member unpacked, and streams from it.
/// @throws InputError  a broken header, a type or a shape that is none of these, fewer bytes than the shape
///   takes, a side of voxels over `kGridSideLimit`, a point that is not finite, nothing solid
Source read_npy(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
