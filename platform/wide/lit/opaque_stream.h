/// @file opaque_stream.h
/// One thread's share of a lit picture in which each ray of a pixel ends where it first meets something: nothing is
/// clear, nothing mirrors, no slope, no fog, no lamp.
///
/// Most pictures are such. Nothing is asked twice, so nothing of a pixel is kept but its place: the pixels of a
/// share go through one short loop after another, and their rays through the map in between.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_OPAQUE_STREAM_H
#define THIMBLE_PLATFORM_WIDE_LIT_OPAQUE_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/light/asked.h"
#include "wide/lit/lit_renderer.h"
#include "wide/lit/pixel_flow.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// Whether pictures with these effects of the scene are drawn so.
bool is_opaque(EffectSet effects, const LitScene& scene);

/// How much of everything a stream holds.
struct OpaqueShape {
  OpaqueShape(EffectSet effects, const LitScene& scene, uint32_t slot_count);

  size_t bytes() const;

  uint32_t slots;   ///< pixels at once
  uint32_t around;  ///< rays of occlusion a hit
};

/// What of a hit counts, or of the face that it is on.
struct LitFace {
  Vec3Q8 at;
  uint32_t pixel;
  uint8_t face;  ///< 2 * axis, and 1 more where it looks to larger coordinates; 6 more: the ray began inside
  uint8_t material;
};

struct OpaqueParts {
  /// Cuts bytes at a multiple of 64 into arrays; null: only finds out how many bytes.
  void lay_out(const OpaqueShape& shape, uint8_t* at);

  Ray* rays;  ///< of pixels, then of what they met
  Hit* hits;
  LitFace* faces;
  uint32_t*
      asking;       ///< the pixels that met nothing; the faces that a light's rays, or occlusion's, come from
  int32_t* sky[4];  ///< directions by component; shares of the sky
  uint8_t* any;
  RayPoint* met;
  PixelSlot* places;   ///< by pixel
  lit::Color* light;   ///< by face that was met
  lit::Color* colors;  ///< by pixel
  size_t bytes;
};

class OpaqueStream {
 public:
  /// `bytes` has shape.bytes(), at any address.
  OpaqueStream(const lit::Frame& frame, const RayMap& map, const OpaqueShape& shape, Bytes bytes);

  /// Draws what it takes from the flow, until that ends.
  void draw(PixelFlow* flow);
  const LitCounts& counts() const { return frame_.counts; }

 private:
  static constexpr uint32_t kInside = 6;  // the first of the faces of what a ray begins in
  static constexpr uint32_t kSides = 12;
  // What is the same for all hits on a face that looks one way.
  struct Side {
    lit::Spot spot;  // with its face alone
    lit::Color ambient;
  };
  struct Paint {
    uint32_t albedo[3];
    uint32_t emission[3];
  };

  void light_up(uint32_t count);
  void find_faces(uint32_t count);
  LitFace face_of_hit(uint32_t pixel);
  void show_sky(uint32_t count);
  void occlude();
  void add_suns();
  void add_sun(size_t number);
  void paint();

  lit::Frame frame_;
  const RayMap& map_;
  OpaqueShape shape_;
  OpaqueParts parts_;
  uint32_t face_count_ = 0;
  Side sides_[kSides];
  Paint paints_[256];
  lit::Color background_;
};

}  // namespace thimble::wide

#endif
