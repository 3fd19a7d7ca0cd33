// How far a band is drawn, and the deferred pixels of a tile: ties for the tree, notes for secondary rays in water. These and
// those through it: the loop of the tree's own pixels (pixel.h), traced through the map. Internal to src/.
#pragma once

#include "../../picture/bricks/sight.h"
#include "mirror_rays.h"
#include "point_lighting.h"
#include "still_water.h"

namespace thimble::lit {
namespace {

using namespace bricks;

constexpr int kAskedWords = kTileAcrossPx * kTileDownPx / 32;
static_assert(kAskedWords == 4);

// How far a band is drawn: the next tile, and the ties of the tile before it, which are left to the tree.
struct FlatProgress {
  int32_t x;
  int32_t y;
  uint32_t asked[kAskedWords];
};

// What the camera's ray of a pixel meets that may come to water: the face's voxel in the box, and from bit 24 on its side
// and 1; kNothing, or 0 where nothing is noted.
constexpr int kNoteBits = kMaxBrickMapLevel;
constexpr uint32_t kNothing = 7U << 3 * kNoteBits;
inline uint32_t note_of(const FacePoint& point) {
  uint32_t note = side_of(point) + 1;
  for (int i = 2; i >= 0; --i) {
    note = note << kNoteBits | static_cast<uint32_t>(point.voxel[i]);
  }
  return note;
}
struct WetNotes {
  bool any = false;
  uint32_t of[kTileAcrossPx * kTileDownPx] = {};
};

// The same with the notes of the tile.
struct WetProgress : FlatProgress {
  WetNotes* notes;
};
template <EffectSet kSet>
using ProgressOf = Choose<kIsWet<kSet>, WetProgress, FlatProgress>;

// A frame whose rays the map traces. It is open after a tie, which is left to the tree. A Sink has the map_, from(), where
// secondary rays start, and point_color(frame, spot, point) of what is seen.
template <class Sink>
struct MapFrame {
  static constexpr bool kIsAsked = true;

  MapFrame(Frame& of, Sink& seen_by) : frame(of), counts(of.counts), scene(of.scene), sink(seen_by) {
    const WaterSurface& water = scene.water;
    top = water.corner.z * Q8::kOne + water.highest_q8;
    is_still = still.set(water, frame.tree.level());
  }
  void show(const Spot& spot, const Slope* /*slope*/, const Weight& weight) {
    add(sink.point_color(*this, spot, point), weight, &sum);
  }
  operator Frame&() { return frame; }
  auto& from() { return sink.from(); }
  int32_t low(int axis) const { return sink.from().low(axis); }
  uint8_t material() const {
    uint32_t seen = voxel;
    if (is_noted) {
      const BrickMap& map = sink.map_;
      int32_t cell = 0;
      seen = 0;
      for (int i = 2; i >= 0; --i) {
        cell = cell * (map.box().high[i] - map.box().low[i]) + (point.voxel[i] >> 2);
        seen = seen << 2 | (static_cast<uint32_t>(point.voxel[i]) & 3U);
      }
      seen |= uint32_t{half_at(map.directory(), 2 * cell)} << 6;
    }
    return sink.map_.material(frame.tree, seen >> 6, seen & 63U);
  }
  // Takes what was noted for what the next ray meets.
  void know(uint32_t note) {
    is_next = true;
    found = note != kNothing;
    const uint32_t side = (note >> 3 * kNoteBits) - 1;
    point.axis = static_cast<int>(side >> 1);
    point.faces_up = (side & 1U) != 0;
    for (int i = 0; i < 3; ++i) {
      point.voxel[i] = static_cast<int32_t>(note >> kNoteBits * i & ((1U << kNoteBits) - 1));
    }
  }
  // Whether a ray from there is above all water and stays there.
  bool is_above(const Ray& ray) const {
    return ray.origin.z.raw >= top && (ray.origin.z.raw > top || ray.direction.z >= 0);
  }
  // As `water_holds`.
  bool is_in_water(const Ray& ray) const {
    return is_still ? still.holds(ray)
                    : !is_above(ray) && water_holds(scene.water, ray.origin, ray.direction);
  }
  static RayPoint place_of(const StillWater::Face& face) {
    return {static_cast<int32_t>(face.way), static_cast<int32_t>(face.speed) * Q8::kOne};
  }

  Frame& frame;
  LitCounts& counts;
  const LitScene& scene;
  Sink& sink;
  int32_t top;       // no surface is higher, in 1/256 voxel
  StillWater still;  // if it is
  bool is_still;
  bool is_open = false;
  bool is_noted = false;  // what the ray meets: `voxel` and where in it the point lies are not known
  bool is_next = false;   // it is what the next ray meets
  bool found = false;
  FacePoint point;  // where the last ray ended, in `voxel` (as Landing's)
  uint32_t voxel = 0;
  Color sum;  // of what was shown
};

// Where what is solid is met first, by the map.
template <class Sink>
void meet_solid(MapFrame<Sink>& frame, const PendingRay& now, Meeting* meeting) {
  FacePoint& point = frame.point;
  frame.is_noted = frame.is_next;
  frame.is_next = false;
  if (!frame.is_noted) {
    const int32_t answer = frame.from().go_on_from(now.ray.origin, now.ray.direction, &frame.voxel, &point);
    frame.is_open = answer == kAsk;
    frame.found = answer == kShadowed;
  }
  meeting->found = frame.found;
  meeting->opaque = frame.found;
  Hit& hit = meeting->hit;
  if (frame.found) {
    const int axis = point.axis;
    for (int i = 0; i < 3; ++i) {
      hit.voxel[i] = point.voxel[i] + frame.low(i) / Q8::kOne;
    }
    const int32_t plane = Q8::kOne * (hit.voxel[axis] + (point.faces_up ? 1 : 0));
    hit.kind = HitKind::kHit;
    hit.axis = static_cast<int8_t>(axis);
    hit.t_numerator = static_cast<int32_t>(magnitude_32(plane - now.ray.origin[axis].raw));
    hit.t_denominator = static_cast<int32_t>(magnitude_32(now.ray.direction[axis])) * Q8::kOne;
  }
  count_result(frame, now.kind, hit.kind, 0);
}

template <class Sink>
Spot spot_of(MapFrame<Sink>& frame, const PendingRay& now, const Meeting& meeting) {
  Spot spot;
  FacePoint& point = frame.point;
  if (frame.is_noted) {
    spot.at = start_on_face(now.ray, meeting.hit);
    for (int i = 0; i < 3; ++i) {
      point.within[i] = i == point.axis ? 0 : spot.at[i].raw - Q8::kOne * meeting.hit.voxel[i];
    }
  } else {
    for (int i = 0; i < 3; ++i) {
      spot.at[i] = Q8::from_raw(Q8::kOne * meeting.hit.voxel[i] + point.within[i]);
    }
    spot.at[point.axis].raw += point.faces_up ? Q8::kOne : 0;
  }
  spot.face = face_of(point);
  spot.arriving = now.ray.direction;
  spot.surface = surface_of(frame, frame.material());
  return spot;
}

template <class Sink>
void begin_in_water(const MapFrame<Sink>& frame, const PendingRay& now, Leg* leg) {
  leg->medium = {frame.is_in_water(now.ray) ? Medium::kWaterBody : Medium::kAir, 0};
}

template <class Sink>
void meet_water(MapFrame<Sink>& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  const bool is_wet = leg.medium.kind == Medium::kWaterBody;
  if (!is_wet && frame.is_above(now.ray) && now.ray.direction.z >= 0) {
    return;
  }
  StillWater::Face face;
  if (frame.is_still && is_wet) {
    face = frame.still.leave(now.ray);
  } else if (frame.is_still && !frame.still.enter(now.ray, &face)) {
    return;
  }
  Vec3Q8 at;
  if (!frame.is_still || !frame.still.find_point(now.ray, face, !is_wet, &at)) {
    meet_water(static_cast<Frame&>(frame), now, leg, meeting);
    return;
  }
  frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += 1;
  const RayPoint place = frame.place_of(face);
  if (meeting->found && !is_before(place, point_of(meeting->hit))) {
    return;
  }
  *meeting = Meeting{};
  meeting->found = true;
  meeting->at_water = true;
  meeting->at_surface = face.axis == 2 && (now.ray.direction.z < 0) != is_wet;
  meeting->beyond = {is_wet ? Medium::kAir : Medium::kWaterBody, 0};
  meeting->hit.axis = static_cast<int8_t>(face.axis);
  meeting->hit.t_numerator = place.t_numerator;
  meeting->hit.t_denominator = place.t_denominator;
  meeting->at = at;
}

template <class Sink>
void filter_by_water(MapFrame<Sink>& frame, LightRay* light) {
  if (!frame.is_in_water(light->ray)) {
    return;
  }
  StillWater::Face face;
  if (frame.is_still) {
    face = frame.still.leave(light->ray);
  }
  if (!frame.is_still || frame.still.is_on_edge(light->ray, face)) {
    filter_by_water(static_cast<Frame&>(frame), light);
    return;
  }
  frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += 1;
  const RayPoint end = frame.place_of(face);
  const auto length =
      static_cast<uint32_t>(distance_q8(light->ray.direction, end.t_numerator, end.t_denominator));
  for (int i = 0; i < 3; ++i) {
    light->brightness[i] = weighed_32(light->brightness[i], left_q16(frame.scene.water_material, i, length));
  }
}

// Empty: this set has no water.
template <EffectSet kSet, class Sink, bool kSecondary, bool = kIsWet<kSet>>
class WaterRays {
 public:
  WaterRays(const Frame& /*frame*/, const Sink& /*sink*/) {}
};

// Part of the sink that takes primary hits: it defers the pixels whose rays may come to water, as notes for a second sink
// that draws them when the first has left the stack.
template <EffectSet kSet, class Sink>
class WaterRays<kSet, Sink, false, true> {
 public:
  WaterRays(const Frame& frame, const Sink& /*sink*/) {
    const WaterSurface& water = frame.scene.water;
    bool goes_down = false;
    for (const Light& light : frame.scene.lights) {
      goes_down = goes_down || light.place.z < 0;
    }
    top_ = water.corner.z * Q8::kOne + water.highest_q8;
    least_ = top_ + (goes_down ? 1 : 0);
    is_eye_above_ = frame.camera.eye().z.raw >= top_;
  }

  // Whether no ray of the camera to this face comes through water, nor any of light from there; `low` is the box's lowest
  // coordinate. A way between two points that are not below the surface is not, either.
  bool is_dry(const FacePoint& face, int32_t low) const {
    const bool is_floor = face.axis == 2 && face.faces_up;
    return is_eye_above_ &&
           low + Q8::kOne * (face.voxel[2] + (is_floor ? 1 : 0)) >= (is_floor ? top_ : least_);
  }
  // Whether a ray of the camera into this direction never comes to water.
  bool is_dry(const Vec3i& direction) const { return is_eye_above_ && direction.z >= 0; }

  void set_notes(WetNotes* notes) { notes_ = notes; }
  void note(uint32_t pixel, uint32_t what) {
    notes_->of[pixel] = what;
    notes_->any = true;
  }

 private:
  WetNotes* notes_ = nullptr;
  bool is_eye_above_;
  int32_t top_;    // no surface is higher
  int32_t least_;  // faces that look sideways or down from there on are dry
};

// Part of the second sink, which draws the notes.
template <EffectSet kSet, class Sink>
class WaterRays<kSet, Sink, true, true> {
 public:
  WaterRays(Frame& frame, Sink& sink) : wet_(frame, sink) {}

  // The colour of a primary ray whose hit is the note. False: a tie, left to the tree.
  [[gnu::noinline]] bool find_wet(const Ray& ray, uint32_t note, Color* color) {
    wet_.counts = {};
    wet_.is_open = false;
    wet_.sum = {};
    wet_.know(note);
    *color = pixel<kSet>(wet_, ray);
    for (int i = 0; i < 3; ++i) {
      color->c[i] += wet_.sum.c[i];
    }
    return !wet_.is_open;
  }
  const LitCounts& wet_counts() const { return wet_.counts; }

 private:
  MapFrame<Sink> wet_;
};

}  // namespace
}  // namespace thimble::lit
