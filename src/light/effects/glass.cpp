// Boundaries of clear media, by their faces or (Effect::kSmoothNormals) by their slopes: reflection and refraction by
// Snell's law, shared out by Schlick's formula, and absorption between them (Beer and Lambert).
#include "../queries.h"
#include "boundary.h"
#include "thimble/light/host/slope.h"

namespace thimble::lit {
namespace {

const Surface& surface_in(const Frame& frame, const Medium& medium, Surface* room) {
  if (medium.kind == Medium::kWaterBody) {
    return frame.scene.water_material;
  }
  *room = surface_of(frame, medium.material);
  return *room;
}

uint32_t index_q12(const Frame& frame, const Medium& medium) {
  if (medium.kind == Medium::kAir) {
    return kOneQ12;
  }
  Surface room;
  const Surface& surface = surface_in(frame, medium, &room);
  if (surface.kind == SurfaceKind::kMedia) {
    return kOneQ12;
  }
  const uint32_t index = surface.index_q12;
  return index < kMinIndexQ12 ? kMinIndexQ12 : index > kMaxIndexQ12 ? kMaxIndexQ12 : index;
}

}  // namespace

void absorb(const Frame& frame, const PendingRay& now, const Leg& leg, const Meeting& meeting,
            Weight* weight) {
  if (leg.medium.kind == Medium::kAir || !meeting.found) {
    return;
  }
  Surface room;
  const Surface& surface = surface_in(frame, leg.medium, &room);
  if (surface.kind == SurfaceKind::kMedia) {
    return;
  }
  const uint32_t length = stretch_q8(now.ray, leg, meeting);
  for (int i = 0; i < 3; ++i) {
    weight->c[i] = weighed(weight->c[i], left_q16(surface, i, length));
  }
}

bool cross(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
           size_t* count) {
  const uint32_t here = index_q12(frame, leg->medium);
  const uint32_t there = index_q12(frame, meeting.beyond);
  const int8_t axis = meeting.hit.axis;
  if (here == there || axis < 0 || now->bounces >= frame.scene.bounces) {
    go_straight(frame, now, leg, meeting);
    return true;
  }
  const Vec3Q8 at = meeting.at_water ? meeting.at : start_on_face(now->ray, meeting.hit);
  const Vec3i unit = unit_q14(now->ray.direction);
  // Which way what is reflected goes. At a step of a wave a ray may come to the surface from the wrong side;
  // it then goes straight on: into a crest where it is; out of one that it has entered from above not at all,
  // but on below the next column's top, or it would be bent twice.
  const bool upwards =
      meeting.at_surface ? leg->medium.kind != Medium::kWaterBody : now->ray.direction[axis] < 0;
  if (meeting.at_surface && upwards != (now->ray.direction[axis] < 0)) {
    go_straight(frame, now, leg, meeting);
    // Out of the water downwards: on in it.
    now->ray.origin = beside_surface(frame.scene.water, at, now->ray.direction, true);
    return true;
  }
  Vec3i normal;
  bool bent = false;
  if (meeting.at_surface) {
    normal = water_normal(frame.scene.water, at.x, at.y);
    // A ray that comes from behind the slope meets the flat surface.
    bent = (normal.x != 0 || normal.y != 0) && (dot_q14(unit, normal) < 0) == upwards;
  }
  Split split;
  if (bent) {
    split = split_at(unit, unit_q14(normal), here, there);
    split.reflected = turned_from(split.reflected, axis, upwards);
    split.refracted = turned_from(split.refracted, axis, !upwards);
  } else {
    split.reflected = reflect(now->ray.direction, axis);
    if (refract(unit, axis, eta_q12(here, there), &split.refracted)) {
      split.back = fresnel_q16(here < there ? unit[axis] : split.refracted[axis], r0_q16(here, there));
    }
  }
  const LitRayKind kind = meeting.at_water ? LitRayKind::kWaterRay : LitRayKind::kGlassRay;
  const bool is_wet = leg->medium.kind == Medium::kWaterBody;
  for (int part = 0; part < (split.back == kOneQ16 ? 1 : 2); ++part) {
    const Vec3i& direction = part == 0 ? split.reflected : split.refracted;
    const Vec3Q8 start =
        meeting.at_surface ? beside_surface(frame.scene.water, at, direction, is_wet == (part == 0)) : at;
    send_share(frame, *now, kind, axis, {start, direction}, part == 0 ? split.back : kOneQ16 - split.back,
               pending, count);
  }
  return false;
}

namespace {

// Whether a point is in what the ray is sent into.
bool is_in(const Frame& frame, const Medium& medium, const Vec3Q8& at) {
  uint8_t material = 0;
  const bool solid = material_at(frame.tree, {at.x.floor(), at.y.floor(), at.z.floor()}, &material);
  return medium.kind == Medium::kSolid ? solid && material == medium.material : !solid;
}

template <class AnyFrame>
[[gnu::always_inline]] inline bool cross_bent(AnyFrame& frame, PendingRay* now, Leg* leg,
                                              const Meeting& meeting, PendingRay* pending, size_t* count) {
  const uint32_t here = index_q12(frame, leg->medium);
  const uint32_t there = index_q12(frame, meeting.beyond);
  const int8_t axis = meeting.hit.axis;
  if (meeting.at_water || here == there || axis < 0 || now->bounces >= frame.scene.bounces) {
    return cross(frame, now, leg, meeting, pending, count);
  }
  // The slope is that of the solid it goes into or, where there is none or one that bends less, out of.
  const bool entering =
      meeting.beyond.kind == Medium::kSolid && (leg->medium.kind != Medium::kSolid || there > here);
  const bool forwards = now->ray.direction[axis] > 0;
  const Body body{frame.scene.surfaces, frame.effects, static_cast<uint16_t>(entering ? there : here)};
  const Vec3Q8 at = start_on_face(now->ray, meeting.hit);
  uint32_t visits = 0;
  Vec3i normal = surface_normal(source_of_slopes(frame), body, at, {axis, forwards == entering}, &visits);
  if constexpr (AnyFrame::kIsAsked) {
    if (frame.is_open) {
      return false;
    }
  }
  frame.counts.node_visits[static_cast<int>(now->kind)] += visits;
  if (magnitude_32(normal[axis]) == static_cast<uint32_t>(kUnitQ14)) {
    return cross(frame, now, leg, meeting, pending, count);
  }
  if (!entering) {
    normal = {-normal.x, -normal.y, -normal.z};
  }
  const Vec3i unit = unit_q14(now->ray.direction);
  // From behind the slope it is grazed, and all light goes straight on.
  Split split;
  split.reflected = unit;
  if (dot_q14(unit, normal) < 0) {
    split = split_at(unit, normal, here, there);
  }
  // Rays start above the steps of the slope, or below them where they go into the body; where that is something else, on
  // the face and away from it.
  for (int part = 0; part < (split.back == kOneQ16 ? 1 : 2); ++part) {
    const bool back = part == 0;
    const Vec3i direction = back ? split.reflected : shorten(split.refracted);
    Vec3Q8 start = at;
    for (int i = 0; i < 3; ++i) {
      start[i].raw += (back ? normal[i] : -normal[i]) * kSlopeRise / kUnitQ14;
    }
    const bool raised = is_in(frame, back ? leg->medium : meeting.beyond, start);
    const Ray out{raised ? start : at, raised ? direction : turned_from(direction, axis, forwards != back)};
    send_share(frame, *now, LitRayKind::kGlassRay, raised ? int8_t{-1} : axis, out,
               back ? split.back : kOneQ16 - split.back, pending, count);
  }
  return false;
}

}  // namespace

bool cross_slope(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                 size_t* count) {
  return cross_bent(frame, now, leg, meeting, pending, count);
}
bool cross_slope(AskedFrame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                 size_t* count) {
  return cross_bent(frame, now, leg, meeting, pending, count);
}

}  // namespace thimble::lit
