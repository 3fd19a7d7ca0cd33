/// @file npy.h
/// NumPy arrays: `.npy`, and of an `.npz` the member with the most numbers among those of two dimensions and
/// more.
///
/// What an array is, its shape says:
/// - N x 3 to N x 9 numbers: points, unless `ArrayAs::kHeights`. Of 6, 7 or 9 columns the last three, of 8 the fourth
///   to sixth are a colour where all of them are from 0 to 1 or whole numbers up to 255. Points that are not finite
///   are left out.
/// - H x W numbers: heights, the first row the farthest (height_grid.h).
/// - X x Y x Z: voxels, solid where a number is not 0 (a float: 0.5 or more).
/// - X x Y x Z x 3 bytes: colours, black is empty; x 4: empty where the fourth is 0.
/// Numbers are booleans, integers or floats of 2, 4 or 8 bytes, of either byte order, in C or Fortran order. In
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
///   takes, a side of voxels over `kGridSideLimit`, no point that is finite, nothing solid
///   an array that is not what `as` says
Source read_npy_as(ArrayAs as, const SharedBytes& file, const Progress& progress = {});
Source read_npy(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
