// The light of a point by secondary rays through the map: occlusion, and lamps with their shadows. Internal to src/.
#pragma once

#include "../../picture/bricks/near.h"
#include "../arithmetic.h"
#include "thimble/light/map_render.h"

namespace thimble::lit {
namespace {

using namespace bricks;

template <EffectSet kSet>
constexpr bool kGathersLight = (kSet & (Effect::kAmbientOcclusion | kLamps)) != 0;
template <EffectSet kSet>
constexpr bool kMirrors = (kSet & Effect::kMirror) != 0;
template <EffectSet kSet>
constexpr bool kIsWet = (kSet & Effect::kWater) != 0;

// What rays leave from.
template <EffectSet kSet, bool kDeep, bool kSecondary>
using PointOf = Choose<kSecondary, MirrorPoint<(kSet & kLamps) != 0, kDeep>,
                       NearPoint<NearRay<(kSet & kLamps) != 0, kDeep>>>;

// Directions to the distant lights. Empty: no water filters their rays.
template <bool kKept>
struct SunDirections {};
template <>
struct SunDirections<true> {
  Vec3i towards[kMaxFlatSuns];
};

// Empty: this set keeps no state per point.
template <EffectSet kSet, bool kDeep, bool kSecondary, bool = kGathersLight<kSet> || kSecondary>
class PointLighting {
 public:
  static constexpr bool kKeepsSuns = false;
};

// Keeps what the suns give each face, since the light of points is not looked up by their face.
template <EffectSet kSet, bool kDeep, bool kSecondary>
class PointLighting<kSet, kDeep, kSecondary, true> : protected SunDirections<kIsWet<kSet>> {
 public:
  static constexpr bool kKeepsSuns = true;
  // Rays to lamps and of occlusion, and those of them that meet something.
  struct Counted {
    uint32_t lamp_rays = 0;
    uint32_t lamp_hits = 0;
    uint32_t occlusion_rays = 0;
    uint32_t occlusion_hits = 0;
  };

  void begin(const Frame& frame, const BrickMap& map) {
    from_.set_map(map);
    const Occlusion& occlusion = frame.scene.occlusion;
    rays_ =
        has<kSet, Effect::kAmbientOcclusion>(frame) && occlusion.reach != 0 ? occlusion_rays(occlusion) : 0;
    // Along any direction of the pattern a ray leaves the box within two sides of the largest world.
    constexpr uint32_t kMost = 2U << (kDeep ? kMaxDeepMapLevel : kMaxBrickMapLevel);
    const uint32_t reach = occlusion.reach < kMost ? occlusion.reach : kMost;
    reach_q12_ = ((reach << 20) + kOcclusionLength - 1) / kOcclusionLength;
  }
  // Sets what sun `number` gives a face that it reaches.
  void set_sun(size_t number, unsigned face, const LightRay& ray) {
    add_light(ray, &suns_[face][number]);
    if constexpr (kIsWet<kSet>) {
      this->towards[number] = ray.ray.direction;
    }
  }

  // The light of a face, without lamps, where nothing is hidden but the suns that are not in `lights`.
  void light_of_face(const Frame& frame, const Spot& spot, unsigned lights, Color* light) const {
    ambient_light(frame, spot, light);
    if (rays_ != 0) {
      darken(frame.scene.occlusion, kOpenShare, 1, light);
    }
    add_suns(spot, lights, light);
  }

  // Adds what comes to a spot from the suns of `lights`, through water where there is any.
  template <class AnyFrame>
  void add_suns_in_water(AnyFrame& frame, const Spot& spot, unsigned lights, Color* light) const {
    const Color(&suns)[kMaxFlatSuns] = suns_[number_of(spot.face)];
    for (size_t i = 0; i < kMaxFlatSuns; ++i) {
      if ((lights >> i & 1U) != 0) {
        LightRay ray;
        ray.ray = {spot.at, this->towards[i]};
        for (int channel = 0; channel < 3; ++channel) {
          ray.brightness[channel] = suns[i].c[channel];
        }
        filter_by_water(frame, &ray);
        add_light(ray, light);
      }
    }
  }

  // Gathers the light of a point; `at` holds its face. Returns false when the point has just the light of its face.
  bool gather(const Frame& frame, const BrickMap& map, const FacePoint& point, unsigned lights, Spot* at,
              Color* light) {
    Spot& spot = *at;
    if constexpr (kGathersLight<kSet>) {
      from_.set(point);
    }
    bool own = false;
    ambient_light(frame, spot, light);
    if constexpr (kOccludes) {
      if (rays_ != 0) {
        const uint32_t open = open_of(frame.scene.occlusion, spot.face);
        own = open != kOpenShare * static_cast<uint32_t>(rays_);
        darken(frame.scene.occlusion, open, rays_, light);
      }
    }
    add_suns(spot, lights, light);
    if constexpr (kHasLamps) {
      own = add_lamps(frame, map, &spot, light) || own;
    }
    return own;
  }

  void add_counts(LitCounts* counts) const {
    constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
    constexpr int kOcclusion = static_cast<int>(LitRayKind::kOcclusion);
    counts->rays[kShadow] += counted_.lamp_rays;
    counts->hits[kShadow] += counted_.lamp_hits;
    counts->rays[kOcclusion] += counted_.occlusion_rays;
    counts->hits[kOcclusion] += counted_.occlusion_hits;
  }
  PointOf<kSet, kDeep, kSecondary>& from() { return from_; }
  const Counted& counted() const { return counted_; }
  void set_counted(const Counted& counted) { counted_ = counted; }

 private:
  static constexpr bool kOccludes = (kSet & Effect::kAmbientOcclusion) != 0;
  static constexpr bool kHasLamps = (kSet & kLamps) != 0;
  static unsigned number_of(const Face& face) {
    return 2 * static_cast<unsigned>(face.axis) + (face.negative ? 0U : 1U);
  }

  void add_suns(const Spot& spot, unsigned lights, Color* light) const {
    const Color(&suns)[kMaxFlatSuns] = suns_[number_of(spot.face)];
    for (size_t i = 0; i < kMaxFlatSuns; ++i) {
      for (int channel = 0; (lights >> i & 1U) != 0 && channel < 3; ++channel) {
        light->c[channel] += suns[i].c[channel];
      }
    }
  }

  // How much of the point's surroundings is open. The pattern's directions take four quadrants in turn; within one of
  // them all have the same signs.
  uint32_t open_of(const Occlusion& occlusion, const Face& face) {
    const int along_x = face.axis == 2 ? 0 : face.axis + 1;
    const int along_y = face.axis == 0 ? 2 : face.axis - 1;
    const unsigned up = face.negative ? 1U << face.axis : 0U;
    uint32_t open = 0;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const bool left = quadrant == 1 || quadrant == 2;
      const bool back = quadrant >= 2;
      const bool in_box = from_.begin(up | (left ? 1U << along_x : 0U) | (back ? 1U << along_y : 0U));
      for (int i = quadrant; i < rays_; i += 4) {
        const PatternDirection& direction = kOcclusionPattern[i];
        uint32_t d[3];
        d[along_x] = static_cast<uint32_t>(left ? -direction.x : direction.x);
        d[along_y] = static_cast<uint32_t>(back ? -direction.y : direction.y);
        d[face.axis] = static_cast<uint8_t>(direction.z);
        int c = d[along_x] > d[along_y] ? along_x : along_y;
        c = d[face.axis] > d[c] ? face.axis : c;
        NearHit hit;
        if (in_box && from_.trace(d, c, (d[c] * reach_q12_ >> 12) + 1, &hit)) {
          open += share_of_way(occlusion, hit.way, d[hit.axis]);
          ++counted_.occlusion_hits;
        } else {
          open += kOpenShare;
        }
      }
    }
    counted_.occlusion_rays += static_cast<uint32_t>(rays_);
    return open;
  }

  // Adds the light of the lamps that reach a point; returns whether any does.
  bool add_lamps(const Frame& frame, const BrickMap& map, Spot* spot, Color* light) {
    for (int i = 0; i < 3; ++i) {
      spot->at[i] = Q8::from_raw(from_.place(i));
    }
    bool any = false;
    for (const Light& lamp : frame.scene.lights) {
      if (lamp.is_point && light_ray(lamp, *spot, &ray_) && lamp_arrives(frame, map, ray_)) {
        add_light(ray_, light);
        any = true;
      }
    }
    return any;
  }

  bool lamp_arrives(const Frame& frame, const BrickMap& map, const LightRay& ray) {
    uint32_t d[3];
    unsigned mirrored = 0;
    int c = 0;
    for (int axis = 0; axis < 3; ++axis) {
      d[axis] = magnitude_32(ray.ray.direction[axis]);
      mirrored |= ray.ray.direction[axis] < 0 ? 1U << axis : 0U;
      c = d[axis] > d[c] ? axis : c;
    }
    ++counted_.lamp_rays;
    // The lamp is at t = numerator / 256, where the ray has gone numerator * d along an axis.
    const auto lamp_at = static_cast<uint32_t>(ray.place.t_numerator);
    NearHit hit;
    if (!from_.begin(mirrored) || !from_.trace(d, c, lamp_at * d[c], &hit)) {
      return true;
    }
    ++counted_.lamp_hits;
    if (hit.way >= lamp_at * d[hit.axis]) {
      return true;
    }
    if (has<kSet, Effect::kEmission>(frame)) {
      return surface_of(frame, map.material(frame.tree, hit.voxel >> 6, hit.voxel & 63U)).kind ==
             SurfaceKind::kEmit;
    }
    return false;
  }

  PointOf<kSet, kDeep, kSecondary> from_;
  LightRay ray_;            // to a lamp
  int rays_ = 0;            // of occlusion, a point
  uint32_t reach_q12_ = 0;  // of occlusion: 1/256 voxel for each unit of a direction, in 1/2^12
  Color suns_[6][kMaxFlatSuns];
  Counted counted_;
};

}  // namespace
}  // namespace thimble::lit
