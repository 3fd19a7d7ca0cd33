/// @file balls.h
/// Small balls in a lit picture that are not in its tree: they fall through the air of a scene in flash.
///
/// A ball is a cube without its edges, the union of three boxes, at any place in 1/256 voxel. Each ray of a pixel
/// meets it by the rule of ray.h (a positive length, no epsilon; a ray that starts on a face and goes in has
/// entered there, at t = 0), be it the camera's, a mirror's, of water, of glass, of occlusion or towards a light. So
/// balls have shadows and lie in them, and mirrors and water show them. What a tree holds goes before a ball that is
/// entered at the same t. Edges (Effect::kEdges) and slopes (Effect::kSmoothNormals) are the tree's alone.
///
/// Where every plane is on a voxel's, the picture is that of a tree with the balls' voxels in it. A picture without
/// balls is that of render.h; whoever calls for none links nothing of this.
#ifndef THIMBLE_LIGHT_BALLS_H
#define THIMBLE_LIGHT_BALLS_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../trace/ray.h"
#include "../trace/secondary_ray.h"
#include "render.h"
#include "scene.h"

namespace thimble {

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

/// A frame with balls: what asks the tree asks them, too.
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

/// As `render_lit_band` of render.h, with balls; with Effect::kNone, where nothing is lit, without them. Errors, with
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

/// The same with a set that is known only now, as that of render.h.
Status render_lit_band(EffectSet effects, const CompactTree& tree, const DrawnBalls& drawn,
                       const Camera& camera, const Shading& shading, const LitScene& scene, const Band& band,
                       LitCounts* counts = nullptr, const LitOptions& options = {});

}  // namespace thimble

#endif
