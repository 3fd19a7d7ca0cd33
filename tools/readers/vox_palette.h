/// Colours and materials of a `.vox` file: RGBA, MATT (version 150) and MATL (version 200). Internal to the
/// `.vox` reader.
#pragma once

#include "readers/file_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// MagicaVoxel's palette for files without RGBA. Entry 0 is the unused one and stays white.
Palette vox_default_palette();

/// RGBA: 256 times r, g, b, alpha. The first is colour index 1; the last stands for index 0, the empty voxel,
/// and is ignored. Where there are fewer, the others stay as they are. Changes colours and alpha only, so that the order of RGBA and MATL does not matter.
void vox_read_rgba(ByteReader& chunk, Palette& palette);

/// MATT, obsolete since version 0.99: an id, a kind, a weight, a bit mask and one float a bit that is set.
void vox_read_matt(ByteReader& chunk, Palette& palette);

/// MATL: an id and a dictionary of texts. A value that is no number, or is NaN, leaves the default.
void vox_read_matl(ByteReader& chunk, Palette& palette);

}  // namespace thimble::tools
