/// One thread's share of a lit picture in which each ray of a pixel ends where it first meets something:
/// nothing is clear, nothing mirrors, and there is no water, slope, fog, depth cue, edge or ripple.
///
/// Most pictures are like this. No pixel asks twice, so only its place is kept: the pixels of a share go through one
/// short loop after another, and their rays through the map in between.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/light/host/asked.h"
#include "wide/lit/array_arena.h"
#include "wide/lit/face_lights.h"
#include "wide/lit/lit_renderer.h"
#include "wide/lit/miss_shader.h"
#include "wide/lit/pixel_queue.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// Whether this stream draws pictures with these effects.
bool is_opaque(EffectSet effects);

/// How large a stream's arrays are.
struct OpaqueShape {
  OpaqueShape(EffectSet effects, const LitScene& scene, uint32_t slot_count);

  size_t bytes() const;

  uint32_t slots;  ///< pixels that are drawn at once
  FaceLightsShape lights;
};

struct OpaqueParts {
  void lay_out(const OpaqueShape& shape, ArrayArena* arena);

  Ray* rays;  ///< the pixels' rays
  Hit* hits;
  uint32_t* beyond;    ///< the pixels that met nothing
  SkyColumns sky;      ///< of these
  PixelSlot* places;   ///< by pixel
  lit::Color* colors;  ///< by pixel
};

class OpaqueStream {
 public:
  /// `bytes` has shape.bytes(), at any address.
  OpaqueStream(const lit::Frame& frame, const RayMap& map, const OpaqueShape& shape, Bytes bytes);

  /// Draws pixels that it takes from the queue, until the queue ends.
  void draw(PixelQueue* queue);
  LitCounts counts() const;

 private:
  struct Paint {
    uint32_t albedo[3];
    uint32_t emission[3];
  };

  void light_up(uint32_t count);
  void find_faces(uint32_t count);
  LitFace face_of_hit(uint32_t pixel);
  void show_beyond(uint32_t count);
  void paint();

  lit::Frame frame_;
  const RayMap& map_;
  OpaqueShape shape_;
  OpaqueParts parts_;
  ArrayArena arena_;
  MissShader misses_;
  FaceLights lights_;
  uint32_t face_count_ = 0;
  Paint paints_[256];
};

}  // namespace thimble::wide
