/// @file binvox.h
/// `.binvox` grids: one bit a voxel, run by run.
///
/// What is read: the line `#binvox 1`, the lines `dim`, `translate` and `scale` in any order (the last two
/// are held to nothing and not used), `data`, and pairs of bytes, a value (0 or 1) and how often it comes (1
/// to 255). Y comes fastest, then z, then x.
///
/// The axes are those of the mesh that the grid was made from, and the file does not say which of them is up;
/// z is taken to be.
///
/// Source of the format: Patrick Min, "BINVOX voxel file format specification".
#ifndef THIMBLE_TOOLS_READERS_BINVOX_H
#define THIMBLE_TOOLS_READERS_BINVOX_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

bool looks_like_binvox(std::span<const std::uint8_t> bytes);

/// Checks the whole file; the result keeps `file` and streams from it.
/// @throws InputError  another version; no `dim` before `data`, a side of 0 or over `kGridSideLimit`; a value
///   other than 0 and 1, runs that end before or after the grid does; no solid voxel
Source read_binvox(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
