/// Draws a frame with several threads.
#pragma once

#include "wide/raster/painter.h"
#include "wide/raster/renderer.h"
#include "wide/raster/tile_drawer.h"
#include "wide/raster/workspace.h"

namespace thimble::wide {

/// Draws and paints a frame: every thread (null: the calling one alone) draws one tile after another, until none is left.
/// Returns how many pixels show something. `stats` gets what all threads counted.
uint64_t draw_tiles(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                    const Workspace& workspace, Stats* stats);

}  // namespace thimble::wide
