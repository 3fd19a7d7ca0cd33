/// @file lit_renderer.h
/// Draws the core's lit picture faster: its rays in streams, many at a time (rays/ray_map.h), where the core
/// traces one after another.
///
/// Every pixel is the core's, for every instruction set and number of threads: what a ray shows is worked out
/// by the core's own code, which is told the answers (light/host/asked.h), and each answer is the core's.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_LIT_RENDERER_H
#define THIMBLE_PLATFORM_WIDE_LIT_LIT_RENDERER_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/render.h"
#include "wide/rays/ray_map.h"
#include "wide/threads.h"

namespace thimble::wide {

/// The materials that rays go through with these effects of the scene: what `RayMap::make` wants to know, so
/// that ways out of them are found in vectors.
struct LitMedia {
  uint8_t materials[256];
  size_t count = 0;
  Span<const uint8_t> span() const { return {materials, count}; }
};
LitMedia lit_media(EffectSet effects, const LitScene& scene);

/// The bytes of workspace that each thread of `render_lit` needs to be fast, and the least that it does with.
/// A picture's size does not matter, the effects, rays of occlusion and lights do (README.md beside this file):
/// 0.4 to 1.9 MB, with slopes 2.4 to 8.8; the least is a sixteenth of that.
size_t lit_workspace_bytes(EffectSet effects, const LitScene& scene);
size_t least_lit_workspace_bytes(EffectSet effects, const LitScene& scene);

/// Draws the band as `render_lit_band(effects, ...)` of `map.tree()`. As many of `threads` (null: the calling
/// one alone) draw as the workspace has room for. `counts` (may be null) is added to: rays and their hits are
/// the core's, but for rays of occlusion and to lamps that hit only beyond their end; visits are those of the
/// engine that answered.
/// Errors, with nothing drawn: those of render_lit_band; kOutOfMemory for a workspace that is too small.
Status render_lit(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                  const LitScene& scene, const Band& band, Bytes workspace, Threads* threads = nullptr,
                  LitCounts* counts = nullptr, const LitOptions& options = {});

/// A pixel of a camera.
struct PixelPlace {
  int32_t x;
  int32_t y;
};

/// The same pixels one by one, wherever they are: `rgb` gets three bytes each, what `render_lit` stores in
/// kRgb888. Places lie on the camera's picture. For samples where edges are. Errors, with nothing drawn:
/// those of render_lit; kOutOfMemory for a `rgb` that is too small.
Status render_lit_pixels(EffectSet effects, const RayMap& map, const Camera& camera, const Shading& shading,
                         const LitScene& scene, Span<const PixelPlace> places, Bytes rgb, Bytes workspace,
                         Threads* threads = nullptr, LitCounts* counts = nullptr,
                         const LitOptions& options = {});

}  // namespace thimble::wide

#endif
