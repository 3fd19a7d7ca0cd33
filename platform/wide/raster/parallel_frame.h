/// Draws a frame with several threads.
#pragma once

#include "wide/raster/painter.h"
#include "wide/raster/renderer.h"
#include "wide/raster/tile_drawer.h"
#include "wide/raster/workspace.h"

namespace thimble::wide {

/// Draws and paints a frame: every thread (null: the calling one alone) draws a tile of as many rows as others, then parts of
/// other threads' tiles, until none are left. Tiles are few, since both sides of a seam look at the boxes on it. Returns how many pixels show something. `stats` gets what all threads counted, and how many
/// parts changed hands.
uint64_t draw_tiles(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                    const Workspace& workspace, Stats* stats);

}  // namespace thimble::wide
