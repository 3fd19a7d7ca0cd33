/// @file kvx.h
/// `.kvx` models (Ken Silverman's Build engine).
///
/// What is read: the first, finest of the models in the file, and the palette of six bits a channel at its
/// end. The file holds the visible voxels only, so the model is hollow. In the file z is down; here it is up,
/// and y turns with it, which keeps the hand.
///
/// From the specification alone: no file of another program was at hand. Source of the format: Ken Silverman,
/// "SLAB6.TXT".
#ifndef THIMBLE_TOOLS_READERS_KVX_H
#define THIMBLE_TOOLS_READERS_KVX_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Checks the whole model; the result keeps `file` and streams from it.
/// @throws InputError  a size of 0 or over `kGridSideLimit`, columns or slabs that leave their place, no
///   palette, no voxel
Source read_kvx(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
