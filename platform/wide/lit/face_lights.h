/// Finds the light on many faces at once: ambient light, occlusion, suns and lamps, with shadows, also through what
/// is clear and under water. It is what lit::face_color finds for one face; slopes are not handled here.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/host/asked.h"
#include "wide/lit/array_arena.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// A lit point of a face.
struct LitFace {
  Vec3Q8 at;
  uint32_t pixel;  ///< for the caller's use
  uint8_t face;  ///< 2 * axis, and 1 more where it looks to larger coordinates; 6 more: the ray began inside
};

/// How large the arrays for so many faces are.
struct FaceLightsShape {
  FaceLightsShape(EffectSet effects, const LitScene& scene, uint32_t face_count);

  uint32_t faces;
  uint32_t around;   ///< rays of occlusion for each face
  bool has_lamps;    ///< some lights are points
  bool has_through;  ///< shadows through what is clear
  bool has_water;    ///< shadows under water
};

struct FaceLightsParts {
  void lay_out(const FaceLightsShape& shape, ArrayArena* arena);

  LitFace* faces;
  lit::Color* light;   ///< by face
  Ray* rays;           ///< rays to a light, or of occlusion
  uint32_t* asking;    ///< the faces that the rays come from
  uint8_t* any;        ///< what the rays meet: 0, or a class of face_lights.cpp
  RayPoint* points;    ///< where on the rays the lamp is; where rays of occlusion enter something
  lit::Color* bright;  ///< the light that the rays bring if nothing is in the way
  uint32_t* order;     ///< faces that look the same way stand side by side
  uint32_t* open;      ///< of faces that look the same way, for occlusion
  // For lamps, in that order.
  int32_t* at[3];
  int32_t* direction[3];
  int32_t* numerator;
  int32_t* brightness[3];
  uint8_t* in_water;  ///< by face: its rays may begin in water
  // For shadows through what is clear.
  uint32_t* under_way;
  lit::LightRay* through;
  lit::LightWay* ways;
  lit::Answer* answers;
  lit::Asked questions[lit::kQuestions];
  Hit* hits;
};

/// Answers questions of one kind by the hits of their rays; then none is left of these.
void put_hits(const Hit* hits, lit::Asked* asked, lit::Answer* answers);

/// Answers the questions of rays' ways, which are of the kinds kClosest, kBefore and kOn; then none is left of these.
/// `hits` has room for as many as there are questions of a kind.
void answer_ways(const RayMap& map, lit::Asked (&questions)[lit::kQuestions], Hit* hits,
                 lit::Answer* answers);

class FaceLights {
 public:
  static constexpr uint32_t kInside = 6;  ///< the first face number of voxels in which a ray begins
  static constexpr uint32_t kSides = 12;

  FaceLights(const lit::Frame& frame, const RayMap& map, const FaceLightsShape& shape, ArrayArena* arena);
  // asking_ points to once_.
  FaceLights(const FaceLights&) = delete;
  FaceLights& operator=(const FaceLights&) = delete;

  /// The caller fills these; then `shine` finds the light of the first `count`.
  LitFace* faces() const { return parts_.faces; }
  void shine(uint32_t count);
  const lit::Color* light() const { return parts_.light; }
  LitCounts counts() const;

 private:
  // What all faces share that look the same way.
  struct Side {
    lit::Spot spot;  // only its face is set
    lit::Color ambient;
  };

  uint32_t share_of(const RayPoint& met);
  void occlude();
  void note_water();
  void sort_by_face();
  uint32_t aim_at_sun(const Light& light);
  uint32_t aim_at_lamp(const Light& light);
  void add_arriving(const Light& light, uint32_t asking);
  void find_shadows(const Light& light, uint32_t asking);
  void go_through(const Light& light, uint32_t asking);
  lit::LightRay ray_of(const Light& light, uint32_t number) const;

  lit::Frame frame_;
  lit::Frame once_;         // counts the stretches of rays through what is clear
  lit::AskedFrame asking_;  // nobody reads its counts
  lit::KnownRay known_;
  const RayMap& map_;
  FaceLightsShape shape_;
  FaceLightsParts parts_;
  uint32_t count_ = 0;
  uint32_t face_ends_[kInside] = {};  // in `order`
  Side sides_[kSides];
  // What a material does to a ray.
  uint8_t of_suns_[256];
  uint8_t of_lamps_[256];
  uint8_t of_occlusion_[256];
  bool has_clear_ = false;
  bool has_shining_ = false;
};

}  // namespace thimble::wide
