/// @file stream.h
/// One thread's share of a lit picture: pixels under way, and the rays that they wait for.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_STREAM_H
#define THIMBLE_PLATFORM_WIDE_LIT_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/light/host/asked.h"
#include "wide/lit/face_lights.h"
#include "wide/lit/lit_renderer.h"
#include "wide/lit/pixel_flow.h"
#include "wide/lit/slope_table.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// How much of everything a stream holds.
struct StreamShape {
  StreamShape(EffectSet effects, const LitScene& scene, uint32_t slot_count);

  size_t bytes() const;

  uint32_t slots;                  ///< pixels under way at once
  uint32_t pending;                ///< rays of one of them that wait to be followed
  uint32_t answers;                ///< to a step of one ray
  uint32_t lights;                 ///< of the scene, that slopes ask about
  uint32_t most[lit::kQuestions];  ///< questions of each kind at once
  FaceLightsShape of_faces;
  uint32_t most_slopes;   ///< that are wanted at once
  uint32_t known_slopes;  ///< faces whose slopes are kept
};

/// A pixel under way.
struct StreamSlot {
  PixelSlot at;
  lit::Color sum;
  lit::KnownRay ray;   ///< the last one of `pending`; or, when it shines, one that is not among them any more
  size_t pending = 0;  ///< rays that wait to be followed
  uint32_t known = 0;  ///< answers of the step that the ray takes
};

/// Of a face that is to be lit, what its pixel gets of the light.
struct ShownFace {
  lit::Weight weight;
  Surface surface;
};

struct StreamParts {
  void lay_out(const StreamShape& shape, Taker* taker);

  StreamSlot* slots;
  lit::PendingRay* pending;
  lit::KnownLight* lights;
  lit::Answer* answers;
  uint32_t* waiting;
  lit::Asked questions[lit::kQuestions];
  lit::AskedSlope* slopes;
  KnownSlope* known_slopes;
  KnownWindow* known_windows;
  uint8_t* any;
  Hit* hits;
  MediumExit* exits;
  ShownFace* shown;
  uint32_t* done;  ///< slots whose pixels wait for light alone
};

class Stream {
 public:
  /// `bytes` has shape.bytes(), at any address.
  Stream(const lit::Frame& frame, const RayMap& map, const StreamShape& shape, Bytes bytes);

  /// Draws what it takes from the flow, until that ends. Pixels that are done make room for others, so that
  /// as many as there are slots are under way.
  void draw(PixelFlow* flow);
  LitCounts counts() const;

 private:
  // Begins the next pixel in a slot; false: there is none.
  bool begin(uint32_t slot, PixelReader* pixels);
  // Begins the last of a pixel's pending rays.
  void begin_ray(uint32_t number);
  void begin_step(uint32_t number, lit::AskedFrame* frame);
  // Takes a pixel's steps; each returns false when the pixel waits for answers. `shine` is for slopes; faces
  // are only noted, and lit all together.
  bool go_on(uint32_t number);
  bool follow(uint32_t number);
  bool shine(uint32_t number);
  void show_face(uint32_t number);
  void light_faces();
  void answer();
  void answer_slopes();

  lit::AskedFrame frame_;
  lit::AskedFrame asking_;  // its counts are nobody's
  lit::Frame once_;         // counts what the other two take once
  const RayMap& map_;
  StreamShape shape_;
  lit::Steps steps_;
  bool is_clear_;  // rays may begin in something clear
  bool is_wet_;
  bool is_clear_material_[256] = {};
  bool is_smooth_;
  StreamParts parts_;
  Taker taker_;
  SlopeTable slopes_;
  FaceLights lights_;
  uint32_t face_count_ = 0;
};

}  // namespace thimble::wide

#endif
