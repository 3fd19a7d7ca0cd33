/// @file painting.h
/// A whole picture by a painter, band by band.
#ifndef THIMBLE_TOOLS_SCENE_PAINTING_H
#define THIMBLE_TOOLS_SCENE_PAINTING_H

#include <cstdint>
#include <string>

#include "output/image.h"
#include "readers/source.h"
#include "scene/painter.h"

namespace thimble::tools {

struct Painting {
  Image image;
  PaintCounts counts;
  double seconds = 0;              ///< of drawing alone
  double preparation_seconds = 0;  ///< of what its painter wanted made first; counts as building
  std::string engine;
  int threads = 1;
};

/// Draws these rows of a picture from top to bottom into `painting`, whatever it held. The painter's first
/// error ends it.
Status paint(BandPainter& painter, std::int32_t width_px, const RowRange& rows, PixelFormat format,
             const Progress& progress, Painting* painting);

}  // namespace thimble::tools

#endif
