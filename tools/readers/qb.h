/// @file qb.h
/// `.qb` models (Qubicle Binary), version 1.1.0.0, packed or not.
///
/// What is read: all matrices at their positions, colours as RGBA or BGRA; a voxel whose alpha (or mask of
/// visible sides) is 0 is empty. In the file y is up and z to the left or to the right; here z is up,
/// (x, y, z) -> (x, -z, y), and the lowest corner of all matrices is 0,0,0.
///
/// From the specification alone: no file of another program was at hand. Source of the format: Minddesk,
/// "Qubicle Binary File Format".
#ifndef THIMBLE_TOOLS_READERS_QB_H
#define THIMBLE_TOOLS_READERS_QB_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Checks the whole file; the result keeps `file` and streams from it.
/// @throws InputError  another version, a code that there is not, matrices or slices that the bytes do not
///   hold, a scene over `kGridSideLimit` on a side, no voxel
Source read_qb(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
