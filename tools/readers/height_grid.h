/// Heights on a regular grid as a landscape of voxels.
///
/// The grid becomes 512 voxels along its longer side, or as many as it has points where these are
/// more, up to 2048; heights between points lie on the surface through the four around them. What the units
/// are, no file says reliably, so the range of heights is drawn as a sixth of the longer side, whatever it
/// is. The first row is the farthest (the greatest y, north); colours go with height, from green over brown
/// to white. Where there is no height (NaN, the file's NODATA_value) there is a hole. The landscape is a
/// shell: its surface, and walls down to the lowest height around it.
#pragma once

#include <functional>

#include "readers/source.h"

namespace thimble::tools {

/// The height at a point; NaN where there is none. Rows count from the farthest.
using HeightAt = std::function<double(std::uint64_t column, std::uint64_t row)>;

/// The landscape. `height` is called twice for some points, and not kept. Memory: 2 bytes a column of voxels.
/// @throws InputError  fewer than 2 x 2 points, no height at all
Source height_landscape(std::uint64_t columns, std::uint64_t rows, const HeightAt& height);

}  // namespace thimble::tools
