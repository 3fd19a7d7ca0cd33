/// Draws the core's lit picture faster: it traces rays in streams, many at a time (rays/ray_map.h), where the core
/// traces one after another.
///
/// Every pixel is the core's, for every instruction set and number of threads: the core's own code works out what a ray
/// shows, from answers that it is given (light/host/asked.h), and each answer is the core's.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/render.h"
#include "wide/rays/ray_map.h"
#include "wide/threads.h"

namespace thimble::wide {

/// The materials that rays go through with these effects of the scene.
struct LitMedia {
  uint8_t materials[256];
  size_t count = 0;
};
LitMedia lit_media(EffectSet effects, const LitScene& scene);

/// The bytes of workspace with which each thread of `render_lit` is fast, and the least with which it works. Effects,
/// rays of occlusion and lights decide, the picture's size does not matter (README.md beside this file): 0.5 to 2.6 MB,
/// with slopes 2.5 to 9.8 MB; the least is a sixteenth of that.
size_t lit_workspace_bytes(EffectSet effects, const LitScene& scene);
size_t least_lit_workspace_bytes(EffectSet effects, const LitScene& scene);

/// Draws the band as `render_lit_band(effects, ...)` of `map.tree()`. As many of `threads` (null: the calling thread
/// alone) draw as the workspace has room for. Adds to `counts` (may be null): rays and their hits as the core
/// counts them, except for rays of occlusion and to lamps that hit only beyond their end; visits are those of the engine
/// that answered.
/// Errors, with nothing drawn: those of render_lit_band; kOutOfMemory for a workspace that is too small.
Status render_lit(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                  const LitScene& scene, const Band& band, Bytes workspace, Threads* threads = nullptr,
                  LitCounts* counts = nullptr, const LitOptions& options = {});

/// A pixel of a camera.
struct PixelPlace {
  int32_t x;
  int32_t y;
};

/// Draws single pixels anywhere on the camera's picture, for samples where edges are: `rgb` gets for each the three
/// bytes that `render_lit` stores in kRgb888. Errors, with nothing drawn: those of render_lit; kOutOfMemory for a
/// `rgb` that is too small.
Status render_lit_pixels(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                         const LitScene& scene, Span<const PixelPlace> places, Bytes rgb, Bytes workspace,
                         Threads* threads = nullptr, LitCounts* counts = nullptr,
                         const LitOptions& options = {});

}  // namespace thimble::wide
