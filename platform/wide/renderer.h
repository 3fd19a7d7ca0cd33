/// @file renderer.h
/// Draws the core's picture faster: it takes voxels to the pixels that they cover, where the core takes
/// rays to the voxels that they hit.
///
/// Every pixel is the core's, for every instruction set and number of threads: whether a ray hits a box is
/// decided by the core's own rule on the ray's integers, in floats where their error bound proves the
/// answer and in integers elsewhere (kernels/judge-inl.h). Blocks of the tree are drawn front to back, and
/// left out when all pixels that they could reach are covered.
///
/// The core does not know of it. It needs the voxel lists (voxel_lists.h), 8 1/8 bytes a pixel, as much again
/// for each of two to four threads beyond the first, and 32 KiB a thread; where the caller has less to give,
/// or the camera is beyond what floats resolve, the core's own renderer draws the frame.
#ifndef THIMBLE_PLATFORM_WIDE_RENDERER_H
#define THIMBLE_PLATFORM_WIDE_RENDERER_H

#include "thimble/picture/render.h"
#include "wide/kernels.h"
#include "wide/threads.h"
#include "wide/voxel_lists.h"

namespace thimble::wide {

/// How boxes are visited. The picture is the same.
enum class Order : uint8_t {
  kAuto,    ///< chosen by what the boxes would cover; Stats::order tells which
  kFlat,    ///< the list as it stands, without blocks that are out of sight
  kBlocks,  ///< small blocks front to back, without those that are covered
};

/// Which list is drawn, where one of boxes stands beside that of the surface. The picture is the same.
enum class List : uint8_t {
  kAuto,     ///< chosen by what is expected; Stats::has_boxes tells which
  kSurface,  ///< the voxels of the surface
  kBoxes,    ///< the boxes, where there are any beside
};

struct Options {
  Threads* threads = nullptr;  ///< null: the calling one alone
  Order order = Order::kAuto;
  List list = List::kAuto;
};

struct Stats {
  Counts counts;
  Order order = Order::kAuto;  ///< the one chosen
  uint32_t splits = 0;         ///< how often a thread gave some of its rows to one that had none left
  bool has_boxes = false;      ///< whether the list of boxes was drawn that stands beside that of the surface
};

/// The bytes of workspace that `render` needs for bands of `rows` rows of this width.
size_t workspace_bytes(int32_t width_px, int32_t rows, int threads = 1);

/// Draws the band's rows. `counts` (may be null) is added to: rays, hits, and as node_visits the blocks
/// looked at. `stats` (may be null) is overwritten.
/// Errors, with nothing drawn: those of render_band; kOutOfMemory for a workspace that is too small; kTooFine
/// for cameras and lists that this renderer leaves to the core.
Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options = {}, Stats* stats = nullptr);

}  // namespace thimble::wide

#endif
