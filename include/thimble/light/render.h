/// @file render.h
/// Lit pictures: light, shadows, mirrors, glass, water, air. Only what the set of effects names is in the
/// code, in the state of a ray, and in the time.
///
/// The set is a constant when compiling. `render_lit_band<Effect::kDirectLight | Effect::kShadows>` is a
/// renderer that has never heard of glass: the linker finds nothing of it to keep. With `Effect::kNone` it is
/// `render_band`. A program that learns of its scene only when it runs calls the function with the set as an
/// argument, which picks one of the renderers that the library holds (dispatch.cpp: 32, by the effects that
/// trace rays; a firmware image that does not call it has none of them).
///
/// A pixel is a function of tree, camera, shading, scene and set alone, in integers: bands of any height, in
/// any order, on any machine give the same picture. `Shading::mode` is not looked at (a lit picture shows
/// colours); its palette serves materials that `LitScene::surfaces` does not reach, its `face_light` scenes
/// without Effect::kDirectLight, its near and far planes Effect::kDepthCue.
///
/// What is computed
///   - a face has  albedo * (ambient * occlusion + sum of the lights that reach it) + emission;
///   - a secondary ray starts on the face (secondary_ray.h) and is traced by the law of ray.h: shadows have
///     no acne and no leaks, and the reference of the tests traces the same rays;
///   - a mirror or a clear boundary splits the ray in at most two, four at the first rough metal; what weighs
///     less than 1/256 is dropped; after `LitScene::bounces` a metal shows its plain lit colour, and a clear
///     boundary lets the ray go straight on;
///   - what is clear on both sides with one index, and all media, are passed by the very same ray; where
///     there is water, by one that begins anew on the face, to 1/256 voxel.
#ifndef THIMBLE_LIGHT_RENDER_H
#define THIMBLE_LIGHT_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../picture/camera.h"
#include "../picture/render.h"
#include "../picture/shading.h"
#include "../trace/ray.h"
#include "../trace/secondary_ray.h"
#include "../tree/compact_tree.h"
#include "detail/pixel.h"
#include "scene.h"

namespace thimble {

/// What a renderer for `effects` keeps: scene, camera, shading, counters, and the rays of a pixel that are
/// still to be followed, which are on the stack. No effect, no byte for it.
constexpr size_t lit_render_bytes(EffectSet effects) {
  if (effects == Effect::kNone) {
    return render_bytes();
  }
  return sizeof(Camera) + sizeof(Shading) + sizeof(LitScene) + sizeof(LitCounts) +
         lit::pending_rays(effects) * sizeof(lit::PendingRay);
}

/// Draws the band with exactly the effects of the set. `counts` (may be null) is added to.
/// Errors, with nothing drawn: those of `render_band`; kOutOfRange for more than kMaxLights lights or
/// kMaxSurfaces surfaces.
/// Inlined always: with Effect::kNone and no counts it is the call of `render_band`, to the byte.
template <EffectSet kEffects>
[[gnu::always_inline]] inline Status render_lit_band(const CompactTree& tree, const Camera& camera,
                                                     const Shading& shading, const LitScene& scene,
                                                     const Band& band, LitCounts* counts = nullptr,
                                                     const LitOptions& options = {}) {
  if constexpr (kEffects == Effect::kNone) {
    if (counts == nullptr) {
      return render_band(tree, camera, shading, band, nullptr, {options.max_visits, Width::kAuto});
    }
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  } else {
    return lit::draw<kEffects>({tree, camera, shading, scene, options, kEffects}, band, counts);
  }
}

/// The same with a set that is known only now: code with exactly these effects where they trace rays
/// (Effect::kMedia counts as Effect::kGlass there); Effect::kDirectLight, Effect::kEmission, Effect::kFog,
/// Effect::kSky and Effect::kDepthCue cost one test each a ray where the set does not name them.
Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band,
                       LitCounts* counts = nullptr, const LitOptions& options = {});

// A set that is known only when the program runs, by one renderer for all sets within another: for a program that is
// there before its scene, in a flash that does not hold the renderers of the function above.

/// Whether the renderers for `most` draw `effects` exactly: nothing beyond `most`, and shadows where there is direct light.
/// Scenes with metals want Effect::kMirror, too, if `most` has it.
constexpr bool lies_within(EffectSet effects, EffectSet most) {
  const bool has_hard_light = (effects & (Effect::kDirectLight | Effect::kShadows)) == Effect::kDirectLight;
  return (effects & ~most) == 0 && !(has_hard_light && (most & Effect::kShadows) != 0);
}

/// As `render_lit_band(effects, ...)`, for a set that `lies_within` kMost: kBadArgument for any other.
template <EffectSet kMost>
inline Status render_lit_band_within(EffectSet effects, const CompactTree& tree, const Camera& camera,
                                     const Shading& shading, const LitScene& scene, const Band& band,
                                     LitCounts* counts = nullptr) {
  if (effects == Effect::kNone) {
    return render_band(tree, camera, shading, band);
  }
  const LitOptions options;
  return lies_within(effects, kMost)
             ? lit::draw<kMost>(lit::Frame{tree, camera, shading, scene, options, effects}, band, counts)
             : Status::kBadArgument;
}

// Small balls in a lit picture that are not in its tree: they fall through the air of a scene in flash.
//
// A ball is a cube without its edges, the union of three boxes, at any place in 1/256 voxel. Each ray of a pixel
// meets it by the rule of ray.h (a positive length, no epsilon; a ray that starts on a face and goes in has
// entered there, at t = 0), be it the camera's, a mirror's, of water, of glass, of occlusion or towards a light. So
// balls have shadows and lie in them, and mirrors and water show them. What a tree holds goes before a ball that is
// entered at the same t. Edges (Effect::kEdges) and slopes (Effect::kSmoothNormals) are the tree's alone.
//
// Where every plane is on a voxel's, the picture is that of a tree with the balls' voxels in it. A picture without
// balls is the one above; whoever calls for none links nothing of this.

/// A box in the air, in 1/256 voxel, half-open.
struct BoxQ8 {
  Vec3i low;
  Vec3i high;
};

/// Where a ray enters something: `axis` of the face, the lowest where several are entered at once; -1 and t = 0 where
/// it starts inside.
struct BoxHit {
  RayPoint at;
  int axis = -1;
};

/// Whether the ray spends a positive length in the box, and where it enters it. The box lies where a ray may start
/// (`check_ray`).
bool enter_box(const Ray& ray, const BoxQ8& box, BoxHit* hit);

inline constexpr size_t kMaxDrawnBalls = 32;

struct Ball {
  Vec3i center;         ///< 1/256 voxel; the ball lies where a ray may start
  int32_t half_q8 = 0;  ///< half its side, a multiple of 2; 0: it is not there
  /// Heights that its box keeps between as it falls, for `DrawnBalls::passed`.
  int32_t bottom_q8 = 0;
  int32_t top_q8 = 0;
  Surface surface;  ///< diffuse, metal or of kEmit
};

/// Whether the ray spends a positive length in the ball; `hit` gets where it enters, `entered` (may be null) which box.
bool enter_ball(const Ray& ray, const Ball& ball, BoxHit* hit, BoxQ8* entered = nullptr);

/// The balls of a picture.
struct DrawnBalls {
  Span<const Ball> balls;  ///< at most kMaxDrawnBalls
  /// May be null. Gets a bit for each ball (1 << index) that some ray of the band may meet on its fall, where it is or
  /// anywhere between `bottom_q8` and `top_q8`: as long as nothing else changes, no other band's pixels do.
  uint32_t* passed = nullptr;
};

namespace lit {

/// A frame with balls: each query of the tree is one of the balls, too.
struct BallFrame : Frame {
  BallFrame(const Frame& frame, const DrawnBalls& all) : Frame(frame), drawn(all) {}
  DrawnBalls drawn;
  const Ball* met = nullptr;  ///< what the last ray met, if it was a ball
  BoxQ8 entered;              ///< then its box
};

/// Finds the ball that the ray enters first, before `end` (null: anywhere): sets `met`, `entered` and `hit`.
bool meet_ball(BallFrame& frame, const Ray& ray, const RayPoint* end, BoxHit* hit);

// The parts of detail/pixel.h that ask.
void meet_solid(BallFrame& frame, const PendingRay& now, Meeting* meeting);
void meet_clear(BallFrame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting);
Spot spot_of(const BallFrame& frame, const PendingRay& now, const Meeting& meeting);
bool light_arrives(BallFrame& frame, const LightRay& light);
bool light_arrives_through(BallFrame& frame, LightRay* light);
void occlude(BallFrame& frame, const Spot& spot, Color* light);
void occlude(BallFrame& frame, const Spot& spot, const Slope& slope, Color* light);
Slope slope_at(BallFrame& frame, LitRayKind kind, const Spot& spot);

template <EffectSet kSet>
void draw_edges(BallFrame& frame, const Ray& ray, const Hit& hit, const Spot& spot, Weight* weight) {
  if (frame.met == nullptr) {
    draw_edges<kSet>(static_cast<Frame&>(frame), ray, hit, spot, weight);
  }
}

/// The errors of `render_lit_band`.
Status check_balls(const DrawnBalls& drawn, int level);

}  // namespace lit

/// As `render_lit_band` above, with balls; with Effect::kNone, where nothing is lit, without them. Errors, with
/// nothing drawn: those of `render_lit_band`; kOutOfRange for more than kMaxDrawnBalls balls or one that is not where
/// a ray may start; kBadArgument for a side that is no multiple of 4.
template <EffectSet kEffects>
[[gnu::always_inline]] inline Status render_lit_band(const CompactTree& tree, const DrawnBalls& drawn,
                                                     const Camera& camera, const Shading& shading,
                                                     const LitScene& scene, const Band& band,
                                                     LitCounts* counts = nullptr,
                                                     const LitOptions& options = {}) {
  if constexpr (kEffects == Effect::kNone) {
    return render_lit_band<kEffects>(tree, camera, shading, scene, band, counts, options);
  } else {
    const Status status = lit::check_balls(drawn, tree.level());
    if (status != Status::kOk) {
      return status;
    }
    return lit::draw<kEffects>(lit::BallFrame({tree, camera, shading, scene, options, kEffects}, drawn), band,
                               counts);
  }
}

/// The same with a set that is known only now, as that above.
Status render_lit_band(EffectSet effects, const CompactTree& tree, const DrawnBalls& drawn,
                       const Camera& camera, const Shading& shading, const LitScene& scene, const Band& band,
                       LitCounts* counts = nullptr, const LitOptions& options = {});

/// The same for a set that `lies_within` kMost; kBadArgument for any other, and for none.
template <EffectSet kMost>
inline Status render_lit_band_within(EffectSet effects, const CompactTree& tree, const DrawnBalls& drawn,
                                     const Camera& camera, const Shading& shading, const LitScene& scene,
                                     const Band& band, LitCounts* counts = nullptr) {
  const LitOptions options;
  const Status status = effects == Effect::kNone || !lies_within(effects, kMost)
                            ? Status::kBadArgument
                            : lit::check_balls(drawn, tree.level());
  return status != Status::kOk
             ? status
             : lit::draw<kMost>(lit::BallFrame({tree, camera, shading, scene, options, effects}, drawn), band,
                                counts);
}

}  // namespace thimble

#endif
