/// Draws the core's picture faster: it finds the pixels that each voxel covers, where the core finds the voxel that
/// each ray hits.
///
/// Every pixel is the core's, for every instruction set and number of threads: the core's own rule on the ray's
/// integers decides whether a ray hits a box, in floats where their error bound proves the answer and in integers
/// elsewhere (kernels/judge-inl.h). Blocks of the tree are drawn front to back, and left out when all pixels that they
/// could reach are covered.
///
/// The core does not know of this renderer. It needs the voxel lists (voxel_lists.h), 8 1/8 bytes a pixel and 32 KiB a
/// thread. Where the caller has less to give, or the camera is beyond what floats resolve, the core's own renderer is
/// to draw the frame.
#pragma once

#include "thimble/picture/render.h"
#include "wide/raster/kernels.h"
#include "wide/raster/voxel_lists.h"
#include "wide/threads.h"

namespace thimble::wide {

/// How boxes are visited. The picture is the same.
enum class Order : uint8_t {
  kAuto,    ///< chosen by what the boxes would cover; Stats::order tells which
  kFlat,    ///< in the order of the list, leaving out blocks that are out of sight
  kBlocks,  ///< small blocks front to back, leaving out those that are covered
};

struct Options {
  Threads* threads = nullptr;  ///< null: the calling thread draws alone
  Order order = Order::kAuto;
};

struct Stats {
  Counts counts;
  Order order = Order::kAuto;  ///< the order that was chosen
};

/// The bytes of workspace that `render` needs for bands of `rows` rows of this width.
size_t workspace_bytes(int32_t width_px, int32_t rows, int threads = 1);

/// Draws the band's rows. Adds to `counts` (may be null) the rays, the hits, and as node_visits the blocks that it
/// looked at. Overwrites `stats` (may be null).
/// Errors, with nothing drawn: those of render_band; kOutOfMemory for a workspace that is too small; kTooFine
/// for cameras and lists that this renderer leaves to the core.
Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options = {}, Stats* stats = nullptr);

}  // namespace thimble::wide
