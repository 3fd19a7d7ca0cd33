/// @file pixel.h
/// The parts of render.h: one function an effect, and the loop over the rays of a pixel that calls those
/// which the set names. Not for callers; it is here because the loop is compiled with the caller's set. A
/// frame traces the tree; or, in asked.h, defers its queries; or has balls (light/render.h).
///
/// Colours are integers of kLevel to a step of 8 bits, up to four times white: a ray's sum stays below 2^32
/// since the weights of a pixel's rays never add up to more than 1.
#ifndef THIMBLE_LIGHT_DETAIL_PIXEL_H
#define THIMBLE_LIGHT_DETAIL_PIXEL_H

#include <stddef.h>
#include <stdint.h>

#include "../../base/status.h"
#include "../../picture/camera.h"
#include "../../picture/render.h"
#include "../../picture/shading.h"
#include "../../trace/ray.h"
#include "../../trace/secondary_ray.h"
#include "../../tree/compact_tree.h"
#include "../scene.h"
#include "../water.h"

namespace thimble::lit {

/// One step of 8 bits in a colour's units; kWhite is 255 of them.
inline constexpr uint32_t kLevel = 64;
inline constexpr uint32_t kWhite = 255 * kLevel;
inline constexpr uint32_t kMaxChannel = UINT16_MAX;
/// Weight of the ray that shows all of what it meets.
inline constexpr uint32_t kFullWeight = 1U << 15;
/// Rays below 1/256 in every channel are not followed.
inline constexpr uint32_t kLeastWeight = kFullWeight / 256;
/// Light of brightness 1, as a sum over lights.
inline constexpr uint32_t kFullLight = 1U << 12;
/// Stretches that a ray goes straight on through clear solids and media before it ends.
inline constexpr int kMaxLegs = 16;

/// r, g, b.
template <class T>
struct Channels {
  T c[3] = {};
};
using Weight = Channels<uint16_t>;
using Color = Channels<uint32_t>;

/// A ray still to be followed.
struct PendingRay {
  Ray ray;
  Weight weight{{kFullWeight, kFullWeight, kFullWeight}};
  uint8_t bounces = 0;  ///< before it
  LitRayKind kind = LitRayKind::kPrimary;
  int8_t axis = -1;  ///< of the face that it starts on
};

/// The most pending rays: two come out of one, so a bounce adds one; four out of the first rough
/// metal.
constexpr size_t pending_rays(EffectSet effects) {
  const size_t rough = (effects & Effect::kMirror) != 0 ? 3 : 0;
  const size_t split = (effects & (Effect::kGlass | Effect::kWater)) != 0 ? kMaxBounces : 0;
  return rough + split == 0 ? 0 : 1 + rough + split;
}

/// What all pixels of a band share.
struct Frame {
  static constexpr bool kIsAsked = false;  ///< its questions are answered at once
  static constexpr bool is_open = false;   ///< so none of them is

  const CompactTree& tree;
  const Camera& camera;
  const Shading& shading;
  const LitScene& scene;
  const LitOptions& options;
  EffectSet effects;
  LitCounts counts{};
};

/// What a point of a ray lies in: air, the clear solid of a material, water.
struct Medium {
  enum Kind : uint8_t { kAir, kSolid, kWaterBody };
  Kind kind = kAir;
  uint8_t material = 0;
  friend constexpr bool operator==(const Medium& a, const Medium& b) {
    return a.kind == b.kind && a.material == b.material;
  }
  friend constexpr bool operator!=(const Medium& a, const Medium& b) { return !(a == b); }
};

/// Where a stretch of a ray ends.
struct Meeting {
  bool found = false;       ///< false: it leaves the world
  bool opaque = false;      ///< a surface; else a boundary of clear media
  bool at_water = false;    ///< a boundary of the water: `at` is valid, of `hit` axis and t
  bool at_surface = false;  ///< its upper one, which waves bend
  Medium beyond;            ///< if not opaque
  Hit hit;                  ///< what is entered, even where that is an empty voxel
  Vec3Q8 at;
};

/// The stretch of a ray that is being followed: what it goes through, and where on the ray it began.
struct Leg {
  Medium medium;
  RayPoint from;
};

/// A lit point of a surface.
struct Spot {
  Vec3Q8 at;  ///< on the face
  Face face{0, false};
  bool inside = false;  ///< the camera is in it: nothing reaches it
  Vec3i arriving;       ///< direction of the ray that met it
  Surface surface;
};

/// How the surface lies at a spot (Effect::kSmoothNormals).
struct Slope {
  Vec3i normal;         ///< outwards, a unit in Q14
  bool bent = false;    ///< other than the face's own; else nothing below counts
  bool raised = false;  ///< `start` is above the steps of the slope; else it is the spot, on its face
  Vec3Q8 start;         ///< of the rays that go out from the spot
};

/// The ray from a spot to a light that its face is turned to.
struct LightRay {
  Ray ray;
  uint32_t brightness[3] = {};  ///< kFullLight = 1; what arrives if nothing is in the way
  bool is_point = false;
  RayPoint place;  ///< where a point light is on the ray
};

// --- the band: band.cpp ----------------------------------------------------------------------------------

Status draw_plain(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                  LitCounts* counts, const LitOptions& options);
/// The errors of `render_lit_band`; `stride` gets the bytes from row to row.
Status check_frame(const Frame& frame, const Band& band, size_t* stride);
void clear_row(const Frame& frame, const Band& band, uint8_t* line);
void store(const Frame& frame, const Band& band, uint8_t* line, int32_t x, int32_t y, const Color& color);
void add_counts(const LitCounts& from, LitCounts* to);

// --- what a ray meets, what a face gets: surface.cpp -----------------------------------------------------

void count_ray(Frame& frame, LitRayKind kind);
void count_result(Frame& frame, LitRayKind kind, HitKind result, uint32_t visits);
Surface surface_of(const Frame& frame, uint8_t material);
/// The solid voxel met first, counted.
void find_solid(Frame& frame, LitRayKind kind, const Ray& ray, Hit* hit);
/// As above; opaque whatever the material.
void meet_solid(Frame& frame, const PendingRay& now, Meeting* meeting);
Spot spot_of(const Frame& frame, const PendingRay& now, const Meeting& meeting);
/// Light of a scene without Effect::kDirectLight: `Shading::face_light`.
void plain_light(const Frame& frame, const Spot& spot, Color* light);
void ambient_light(const Frame& frame, const Spot& spot, Color* light);
Color lit_color(const Spot& spot, const Color& light);
void add(const Color& color, const Weight& weight, Color* sum);
Color background(const Frame& frame);

// --- one file an effect ----------------------------------------------------------------------------------

/// Towards a light; false when the face is turned away from it.
bool light_ray(const Light& light, const Spot& spot, LightRay* ray);
void add_light(const LightRay& ray, Color* light);
/// Whether what was hit lies behind a point light, or shines and so may hold it.
bool spares_light(const Frame& frame, const LightRay& light, const Hit& hit);
/// Whether nothing solid is between the spot and the light.
bool light_arrives(Frame& frame, const LightRay& light);
/// The same, but what is clear only takes from `brightness` what it absorbs.
bool light_arrives_through(Frame& frame, LightRay* light);
void filter_by_water(Frame& frame, LightRay* light);
void occlude(Frame& frame, const Spot& spot, Color* light);
void add_emission(const Spot& spot, Color* color);
/// Sends what a metal mirrors; the weight becomes that of the metal's own colour.
void send_mirrored(Frame& frame, PendingRay* now, const Spot& spot, PendingRay* pending, size_t* count);
/// Clear solids and media. What the ray begins in, and where it comes to something else.
void begin_leg(const Frame& frame, const PendingRay& now, Leg* leg);
void meet_clear(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting);
/// The same with water: `leg` and `meeting` have what there is without it.
/// At the start of a ray, also of one that goes straight on.
void begin_in_water(const Frame& frame, const PendingRay& now, Leg* leg);
void meet_water(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting);
/// What glass and water take from the ray on its way to the meeting.
void absorb(const Frame& frame, const PendingRay& now, const Leg& leg, const Meeting& meeting,
            Weight* weight);
/// What clouds take, and their own colour instead.
void scatter(const Frame& frame, const PendingRay& now, const Leg& leg, const Meeting& meeting,
             Weight* weight, Color* sum);
/// Past a boundary that bends nothing.
void go_straight(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting);
/// At a boundary of glass or water: straight on (true), or sends what is reflected and refracted.
bool cross(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
           size_t* count);
/// The slope at a spot; its visits count as those of the ray that met it.
Slope slope_at(Frame& frame, LitRayKind kind, const Spot& spot);
/// What a slope gets, where it is bent, instead of what its faces do.
void light_on_slope(const Frame& frame, const Slope& slope, bool ambient, Color* light);
bool light_ray(const Light& light, const Spot& spot, const Slope& slope, LightRay* ray);
void occlude(Frame& frame, const Spot& spot, const Slope& slope, Color* light);
void send_mirrored(Frame& frame, PendingRay* now, const Spot& spot, const Slope& slope, PendingRay* pending,
                   size_t* count);
bool cross_slope(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                 size_t* count);
/// At the surface of water as its ripples bend it: as `cross`.
bool cross_ripples(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                   size_t* count);
/// The suns that a ray which leaves the world looks into.
Color sun_glint(const Frame& frame, const Vec3i& direction);
Color sky_color(const Frame& frame, const Vec3i& direction);
void fade_in_fog(const Frame& frame, const Ray& ray, const Leg& leg, const Meeting& meeting, Weight* weight,
                 Color* sum);
/// Brightness by depth of what the camera sees first.
void cue_depth(const Frame& frame, const Meeting& meeting, Weight* weight);
/// Whether the next pixel, to the right or below, shows another face than `spot`, which the camera's ray met: its
/// spot is then `*beyond`. Traces a ray, counted as the camera's.
bool meets_edge(Frame& frame, const Ray& ray, const Hit& hit, const Spot& spot, bool down, Spot* beyond);
bool is_same_gray(const Color& one, const Color& other);
void darken_edge(Weight* weight);

[[gnu::always_inline]] inline bool light_ray_of(const Frame& frame, size_t number, const Spot& spot,
                                                LightRay* ray) {
  return light_ray(frame.scene.lights[number], spot, ray);
}
[[gnu::always_inline]] inline bool light_ray_of(const Frame& frame, size_t number, const Spot& spot,
                                                const Slope& slope, LightRay* ray) {
  return light_ray(frame.scene.lights[number], spot, slope, ray);
}

// --- the loops -------------------------------------------------------------------------------------------

/// Whether the effect is on, where the code has it at all.
template <EffectSet kSet, EffectSet kEffect>
bool has(const Frame& frame) {
  return (kSet & kEffect) != 0 && (frame.effects & kEffect) != 0;
}
template <EffectSet kSet>
inline constexpr bool kHasClear = (kSet & (Effect::kGlass | Effect::kMedia)) != 0;
template <EffectSet kSet>
inline constexpr bool kHasWater = (kSet & Effect::kWater) != 0;
template <EffectSet kSet>
inline constexpr bool kHasRipples = kHasWater<kSet> && (kSet & Effect::kRipples) != 0;
template <EffectSet kSet>
inline constexpr bool kBends = (kSet & (Effect::kGlass | Effect::kWater)) != 0;

/// The colour that a face shows of itself; with a slope, what the surface shows whose slope is bent there.
template <EffectSet kSet, class AnyFrame, class... AnySlope>
Color face_color(AnyFrame& frame, const Spot& spot, const AnySlope&... slope) {
  constexpr bool kIsSlope = sizeof...(AnySlope) != 0;
  const bool is_lit = has<kSet, Effect::kDirectLight>(frame);
  const bool is_outside = kIsSlope || !spot.inside;
  Color light;
  if constexpr (kIsSlope) {
    light_on_slope(frame, slope..., is_lit, &light);
  } else if (is_lit) {
    ambient_light(frame, spot, &light);
  } else {
    plain_light(frame, spot, &light);
  }
  if constexpr ((kSet & Effect::kAmbientOcclusion) != 0) {
    if (is_outside && has<kSet, Effect::kAmbientOcclusion>(frame)) {
      occlude(frame, spot, slope..., &light);
    }
  }
  if constexpr ((kSet & Effect::kDirectLight) != 0) {
    const size_t lights = is_lit && is_outside ? frame.scene.lights.size : 0;
    for (size_t i = 0; i < lights; ++i) {
      LightRay ray;
      if (!light_ray_of(frame, i, spot, slope..., &ray)) {
        continue;
      }
      if constexpr ((kSet & Effect::kShadows) != 0) {
        if constexpr (kHasClear<kSet>) {
          if (!light_arrives_through(frame, &ray)) {
            continue;
          }
        } else if (!light_arrives(frame, ray)) {
          continue;
        }
        if constexpr (kHasWater<kSet>) {
          filter_by_water(frame, &ray);
        }
      }
      add_light(ray, &light);
    }
  }
  Color color = lit_color(spot, light);
  if constexpr ((kSet & Effect::kEmission) != 0) {
    if (has<kSet, Effect::kEmission>(frame)) {
      add_emission(spot, &color);
    }
  }
  return color;
}

/// Darkens the camera's ray where two faces of the same grey meet. Their greys are those of light that nothing
/// hides.
template <EffectSet kSet>
void draw_edges(Frame& frame, const Ray& ray, const Hit& hit, const Spot& spot, Weight* weight) {
  constexpr EffectSet kOfFaces = kSet & (Effect::kDirectLight | Effect::kEmission);
  for (int side = 0; side < 2; ++side) {
    Spot beyond;
    if (meets_edge(frame, ray, hit, spot, side != 0, &beyond) &&
        is_same_gray(face_color<kOfFaces>(frame, spot), face_color<kOfFaces>(frame, beyond))) {
      darken_edge(weight);
      return;
    }
  }
}

/// A boundary of glass or water, where there are ripples.
template <EffectSet kSet, class AnyFrame>
bool cross_water(AnyFrame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                 size_t* count) {
  if (has<kSet, Effect::kRipples>(frame) && meeting.at_surface) {
    return cross_ripples(frame, now, leg, meeting, pending, count);
  }
  if constexpr ((kSet & Effect::kSmoothNormals) != 0) {
    if (has<kSet, Effect::kSmoothNormals>(frame)) {
      return cross_slope(frame, now, leg, meeting, pending, count);
    }
  }
  return cross(frame, now, leg, meeting, pending, count);
}

/// Adds what a ray shows that leaves the world.
template <EffectSet kSet>
[[gnu::always_inline]] inline void add_beyond(const Frame& frame, const PendingRay& now, Color* sum) {
  if constexpr (kHasRipples<kSet>) {
    if (has<kSet, Effect::kRipples>(frame) && now.kind == LitRayKind::kWaterRay) {
      add(sun_glint(frame, now.ray.direction), now.weight, sum);
    }
  }
  if constexpr ((kSet & Effect::kSky) != 0) {
    if (has<kSet, Effect::kSky>(frame)) {
      add(sky_color(frame, now.ray.direction), now.weight, sum);
      return;
    }
  }
  add(background(frame), now.weight, sum);
}

/// Follows one ray to its end: adds what it shows, and puts what comes out of it with the pending ones.
template <EffectSet kSet, class AnyFrame>
void follow(AnyFrame& frame, PendingRay now, PendingRay* pending, size_t* count, Color* sum) {
  constexpr bool kStretches = kHasClear<kSet> || kHasWater<kSet>;
  Leg leg;
  if constexpr (kHasClear<kSet>) {
    begin_leg(frame, now, &leg);
  }
  if constexpr (kHasWater<kSet>) {
    begin_in_water(frame, now, &leg);
  }
  for (int legs = 0; legs < (kStretches ? kMaxLegs : 1); ++legs) {
    Meeting meeting;
    if constexpr (kHasClear<kSet>) {
      meet_clear(frame, now, leg, &meeting);
    } else {
      meet_solid(frame, now, &meeting);
    }
    if (frame.is_open) {
      return;
    }
    if constexpr (kHasWater<kSet>) {
      meet_water(frame, now, leg, &meeting);
    }
    if constexpr ((kSet & Effect::kDepthCue) != 0) {
      if (has<kSet, Effect::kDepthCue>(frame) && now.kind == LitRayKind::kPrimary && legs == 0) {
        cue_depth(frame, meeting, &now.weight);
      }
    }
    if constexpr ((kSet & Effect::kFog) != 0) {
      if (has<kSet, Effect::kFog>(frame)) {
        fade_in_fog(frame, now.ray, leg, meeting, &now.weight, sum);
      }
    }
    if constexpr (kBends<kSet>) {
      absorb(frame, now, leg, meeting, &now.weight);
    }
    if constexpr ((kSet & Effect::kMedia) != 0) {
      scatter(frame, now, leg, meeting, &now.weight, sum);
    }
    if (!meeting.found) {
      return add_beyond<kSet>(frame, now, sum);
    }
    if (meeting.opaque) {
      const Spot spot = spot_of(frame, now, meeting);
      if constexpr ((kSet & Effect::kEdges) != 0) {
        if (has<kSet, Effect::kEdges>(frame) && now.kind == LitRayKind::kPrimary && legs == 0 &&
            !spot.inside) {
          draw_edges<kSet>(frame, now.ray, meeting.hit, spot, &now.weight);
        }
      }
      if constexpr ((kSet & Effect::kSmoothNormals) != 0) {
        if (has<kSet, Effect::kSmoothNormals>(frame) && !spot.inside) {
          const Slope slope = slope_at(frame, now.kind, spot);
          if (frame.is_open) {
            return;
          }
          if (slope.bent) {
            if constexpr ((kSet & Effect::kMirror) != 0) {
              send_mirrored(frame, &now, spot, slope, pending, count);
            }
            if constexpr (AnyFrame::kIsAsked) {
              frame.show(spot, &slope, now.weight);
            } else {
              add(face_color<kSet>(frame, spot, slope), now.weight, sum);
            }
            return;
          }
        }
      }
      if constexpr ((kSet & Effect::kMirror) != 0) {
        send_mirrored(frame, &now, spot, pending, count);
      }
      if constexpr (AnyFrame::kIsAsked) {
        frame.show(spot, nullptr, now.weight);
      } else {
        add(face_color<kSet>(frame, spot), now.weight, sum);
      }
      return;
    }
    if constexpr (kHasRipples<kSet>) {
      if (!cross_water<kSet>(frame, &now, &leg, meeting, pending, count)) {
        return;
      }
    } else if constexpr (kBends<kSet> && (kSet & Effect::kSmoothNormals) != 0) {
      if (!(has<kSet, Effect::kSmoothNormals>(frame) ? cross_slope(frame, &now, &leg, meeting, pending, count)
                                                     : cross(frame, &now, &leg, meeting, pending, count))) {
        return;
      }
    } else if constexpr (kBends<kSet>) {
      if (!cross(frame, &now, &leg, meeting, pending, count)) {
        return;
      }
    } else if constexpr (kStretches) {
      go_straight(frame, &now, &leg, meeting);
    }
    if constexpr (kHasWater<kSet>) {
      begin_in_water(frame, now, &leg);
    }
  }
}

/// The colour of a pixel.
template <EffectSet kSet, class AnyFrame>
Color pixel(AnyFrame& frame, const Ray& ray) {
  Color sum;
  frame.counts.rays[static_cast<int>(LitRayKind::kPrimary)] += 1;
  PendingRay first;
  first.ray = ray;
  if constexpr (pending_rays(kSet) == 0) {
    follow<kSet>(frame, first, nullptr, nullptr, &sum);
  } else {
    // The last one first, so that few are pending. It ends: every ray comes out of one with a bounce less.
    PendingRay pending[pending_rays(kSet)];
    pending[0] = first;
    size_t count = 1;
    while (count != 0 && !frame.is_open) {
      --count;
      follow<kSet>(frame, pending[count], pending, &count, &sum);
      if (count > frame.counts.pending_high_water) {
        frame.counts.pending_high_water = static_cast<uint32_t>(count);
      }
    }
  }
  return sum;
}

template <EffectSet kSet, class AnyFrame = Frame>
Status draw(AnyFrame frame, const Band& band, LitCounts* counts) {
  size_t stride = 0;
  const Status status = check_frame(frame, band, &stride);
  if (status != Status::kOk) {
    return status;
  }
  const int32_t width = frame.camera.width_px();
  for (int32_t row = 0; row < band.rows; ++row) {
    const int32_t y = band.first_row + row;
    uint8_t* line = band.pixels.data + stride * row_place(band.format, row);
    if (begins_bytes(band.format, row)) {
      clear_row(frame, band, line);
    }
    RowRays rays(frame.camera, 0, y);
    for (int32_t x = 0; x < width; ++x, rays.next()) {
      store(frame, band, line, x, y, pixel<kSet>(frame, rays.ray()));
    }
  }
  if (counts != nullptr) {
    add_counts(frame.counts, counts);
  }
  return Status::kOk;
}

}  // namespace thimble::lit

#endif
