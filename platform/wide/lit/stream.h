/// @file stream.h
/// One thread's share of a lit picture: pixels under way, and the rays that they wait for.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_STREAM_H
#define THIMBLE_PLATFORM_WIDE_LIT_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/light/asked.h"
#include "wide/lit/lit_renderer.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// How much of everything a stream holds.
struct StreamShape {
  StreamShape(EffectSet effects, const LitScene& scene, uint32_t slot_count);

  size_t bytes() const;

  uint32_t slots;                  ///< pixels under way at once
  uint32_t pending;                ///< rays of one of them that wait to be followed
  uint32_t answers;                ///< to a step of one ray
  uint32_t lights;                 ///< of the scene
  uint32_t most[lit::kQuestions];  ///< questions of each kind at once
};

/// A pixel under way.
struct StreamSlot {
  lit::Color sum;
  lit::KnownRay ray;   ///< the last one of `pending`; or, when it shines, one that is not among them any more
  size_t pending = 0;  ///< rays that wait to be followed
  uint32_t known = 0;  ///< answers of the step that the ray takes
};

struct StreamParts {
  /// Cuts bytes at a multiple of 64 into arrays; null: only finds out how many bytes.
  void lay_out(const StreamShape& shape, uint8_t* at);

  StreamSlot* slots;
  lit::PendingRay* pending;
  lit::KnownLight* lights;
  lit::KnownLight* suns;
  lit::Answer* answers;
  uint32_t* waiting;
  lit::Asked questions[lit::kQuestions];
  uint8_t* any;
  Hit* hits;
  size_t bytes;
};

class Stream {
 public:
  /// `bytes` has shape.bytes(), at any address.
  Stream(const lit::Frame& frame, const RayMap& map, const StreamShape& shape, Bytes bytes);

  /// Draws rows first .. end - 1 of the band, counted from its own first. For formats whose rows share bytes,
  /// both are multiples of 8 or the band's end.
  void draw(const Band& band, size_t stride, int32_t first, int32_t end);
  /// Draws pixels of the camera, three bytes each.
  void draw_places(Span<const PixelPlace> places, Bytes rgb);
  const LitCounts& counts() const { return frame_.counts; }

 private:
  // Begins a pixel.
  void begin(uint32_t slot, const Ray& ray);
  // Follows the rays of the first `slots` pixels to their ends.
  void finish(uint32_t slots);
  // Begins the last of a pixel's pending rays.
  void begin_ray(uint32_t number);
  void begin_step(uint32_t number, lit::AskedFrame* frame);
  // Takes a pixel's steps; each returns false when the pixel waits for answers.
  bool go_on(uint32_t number);
  bool follow(uint32_t number);
  bool shine(uint32_t number);
  void answer();

  lit::AskedFrame frame_;
  lit::AskedFrame asking_;  // its counts are nobody's
  const RayMap& map_;
  StreamShape shape_;
  lit::Steps steps_;
  bool is_clear_;  // rays may begin in something clear
  bool is_wet_;
  StreamParts parts_;
};

}  // namespace thimble::wide

#endif
