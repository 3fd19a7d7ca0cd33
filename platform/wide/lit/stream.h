/// Draws one thread's share of a lit picture: keeps pixels under way, and the rays that they wait for.
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
#include "wide/lit/slope_table.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// How large a stream's arrays are.
struct StreamShape {
  StreamShape(EffectSet effects, const LitScene& scene, uint32_t slot_count);

  size_t bytes() const;

  uint32_t slots;                  ///< pixels under way at once
  uint32_t pending;                ///< rays of one pixel that wait to be followed
  uint32_t answers;                ///< answers that one step of a ray takes
  uint32_t lights;                 ///< lights of the scene that slopes ask about
  uint32_t most[lit::kQuestions];  ///< questions of each kind at once
  FaceLightsShape of_faces;
  uint32_t most_slopes;   ///< slopes that are wanted at once
  uint32_t known_slopes;  ///< faces whose slopes are kept
};

/// A pixel under way.
struct StreamSlot {
  PixelSlot at;
  lit::Color sum;
  lit::KnownRay ray;   ///< the last pending ray; when it shines it is no longer among the pending ones
  size_t pending = 0;  ///< rays that wait to be followed
  uint32_t known = 0;  ///< answers that are known to the ray's present step
};

/// How much of the light on a face its pixel gets.
struct ShownFace {
  lit::Weight weight;
  Surface surface;
};

/// How much of what a ray sees that left the world its pixel gets.
struct ShownBeyond {
  lit::Weight weight;
  uint32_t pixel;
};

struct StreamParts {
  void lay_out(const StreamShape& shape, ArrayArena* arena);

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
  ShownFace* shown;
  uint32_t* done;  ///< slots whose pixels wait only for light
  SkyColumns sky;  ///< of rays that left the world
  ShownBeyond* beyond;
};

class Stream {
 public:
  /// `bytes` has shape.bytes(), at any address.
  Stream(const lit::Frame& frame, const RayMap& map, const StreamShape& shape, Bytes bytes);

  /// Draws pixels that it takes from the queue, until the queue ends. Pixels that are done make room for others, so that
  /// every slot has a pixel under way.
  void draw(PixelQueue* queue);
  LitCounts counts() const;

 private:
  // Begins the next pixel in a slot; returns false when none is left.
  bool begin(uint32_t slot, PixelReader* pixels);
  // Begins the last of a pixel's pending rays, which meets nothing before the point.
  void begin_ray(uint32_t number, const RayPoint& from = {});
  void begin_step(uint32_t number, lit::AskedFrame* frame);
  // These take a pixel's steps, and return false when the pixel waits for answers. `shine` is for slopes; other faces
  // are only noted, and lit all together.
  bool go_on(uint32_t number);
  bool follow(uint32_t number);
  bool shine(uint32_t number);
  void show_face(uint32_t number, const lit::Spot& spot, lit::Weight weight);
  // Whether the ray, which has its first answer, ends there: in the sky or the background, which are noted then, or at a
  // face that sends no ray on.
  bool show_end(uint32_t number);
  // Gives pixels what their rays were noted to show.
  void light_up();
  void answer();
  void answer_slopes();

  lit::AskedFrame frame_;
  lit::AskedFrame asking_;  // nobody reads its counts
  lit::Frame once_;         // counts once what the other two frames do
  const RayMap& map_;
  StreamShape shape_;
  lit::Steps steps_;
  bool is_clear_;  // rays may begin in something clear
  bool is_wet_;
  bool is_clear_material_[256] = {};
  bool is_smooth_;
  bool is_open_beyond_;  // nothing is between a ray's beginning and the sky that the tree does not hold
  bool ends_at_[256];    // materials: a ray through the air ends where it meets one
  StreamParts parts_;
  ArrayArena arena_;
  MissShader misses_;
  SlopeTable slopes_;
  FaceLights lights_;
  uint32_t face_count_ = 0;
  uint32_t beyond_count_ = 0;
};

}  // namespace thimble::wide
