/// @file renderer.h
/// The core's picture, faster: voxels are taken to the pixels that they cover instead of rays to the voxels
/// that they meet.
///
/// Same tree in, same picture out, pixel by pixel: every pair of a ray and a box is judged by the core's own
/// rule on the ray's integers (kernels.cpp); floating point only chooses the pairs (frame.h). Blocks of the
/// tree are taken front to back, and left out when all pixels that they could reach are covered.
///
/// The core does not know of it. It needs the voxel lists and 8 bytes a pixel; where the caller has less to
/// give, or the camera is beyond what floats resolve, the core's own renderer draws the frame.
#ifndef THIMBLE_PLATFORM_HOST_WIDE_RENDERER_H
#define THIMBLE_PLATFORM_HOST_WIDE_RENDERER_H

#include "host/wide/kernels.h"
#include "host/wide/voxel_lists.h"
#include "thimble/render.h"

namespace thimble::wide {

struct Options {
  int threads = 1;
  /// Blocks of at most so many boxes are drawn whole; 0: chosen by the scene and the camera.
  uint32_t block_boxes = 0;
};

struct Stats {
  Counts counts;
  uint32_t block_boxes = 0;
};

/// Bytes that `render` wants as workspace for pictures of this size.
size_t workspace_bytes(int32_t width_px, int32_t height_px);

/// Draws the band's rows. Errors as render_band's; kTooFine, with nothing drawn, for cameras that this
/// renderer leaves to the core.
Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options = {}, Stats* stats = nullptr);

}  // namespace thimble::wide

#endif
