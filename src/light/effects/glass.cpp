// Boundaries of clear media: reflection and refraction by Snell's law, shared out by Schlick's formula, and
// absorption between them (Beer and Lambert).
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

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

// Least component along the normal of a ray that is sent from a bent surface, of 2^14: what the bend turns
// the wrong way through the flat face runs along it.
constexpr int32_t kLeastRise = 128;

Vec3i turned_to(Vec3i direction, int axis, bool upwards) {
  if (upwards ? direction[axis] < kLeastRise : direction[axis] > -kLeastRise) {
    direction[axis] = upwards ? kLeastRise : -kLeastRise;
  }
  return direction;
}

// Where a ray that is sent from the surface of the water begins, so that it is on the side where it belongs,
// also where it begins in the next column: what is reflected by a step of the wave runs towards it, and a
// point rounded to 1/256 voxel may lie on a column's edge. It is moved up or down to that column's top.
Vec3Q8 on_its_side(const Frame& frame, const Meeting& meeting, const Vec3Q8& at, const Vec3i& direction,
                   bool in_water) {
  const WaterSurface& water = frame.scene.water;
  if (!meeting.at_surface) {
    return at;
  }
  const Vec3i voxel = starting_voxel({at, direction});
  const int32_t x = voxel.x - water.corner.x;
  const int32_t y = voxel.y - water.corner.y;
  if (x < 0 || y < 0 || x >= water.width || y >= water.depth || water.height_q16(x, y) < 0) {
    return at;
  }
  const int32_t top = water.corner.z * Q8::kOne + water.height_q8(x, y);
  Vec3Q8 moved = at;
  if (in_water ? at.z.raw > top : at.z.raw < top) {
    moved.z = Q8::from_raw(top);
  }
  return moved;
}

void send(Frame& frame, const PendingRay& from, LitRayKind kind, int8_t axis, const Vec3Q8& at,
          const Vec3i& direction, uint32_t share_q16, PendingRay* pending, size_t* count) {
  PendingRay out;
  out.ray = {at, direction};
  out.bounces = static_cast<uint8_t>(from.bounces + 1);
  out.kind = kind;
  out.axis = axis;
  for (int i = 0; i < 3; ++i) {
    out.weight.c[i] = weighed(from.weight.c[i], share_q16);
  }
  if (is_seen(out.weight)) {
    count_ray(frame, kind);
    pending[(*count)++] = out;
  }
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
  const uint32_t eta = eta_q12(here, there);
  // Which way what is reflected goes. At a step of a wave a ray may come to the surface from the wrong side;
  // it then goes straight on: into a crest where it is; out of one that it has entered from above not at all,
  // but on below the next column's top, or it would be bent twice.
  const bool upwards =
      meeting.at_surface ? leg->medium.kind != Medium::kWaterBody : now->ray.direction[axis] < 0;
  if (meeting.at_surface && upwards != (now->ray.direction[axis] < 0)) {
    go_straight(frame, now, leg, meeting);
    // Out of the water downwards: on in it.
    now->ray.origin = on_its_side(frame, meeting, at, now->ray.direction, true);
    return true;
  }
  Vec3i reflected = reflect(now->ray.direction, axis);
  Vec3i refracted;
  int32_t cosine_in = unit[axis];
  bool passes = false;
  int32_t cosine_out = 0;
  Vec3i normal;
  bool bent = false;
  if (meeting.at_surface) {
    normal = water_normal(frame.scene.water, at.x, at.y);
    // A ray that comes from behind the slope meets the flat surface.
    bent = (normal.x != 0 || normal.y != 0) && (dot_q14(unit, normal) < 0) == upwards;
  }
  if (bent) {
    normal = unit_q14(normal);
    cosine_in = dot_q14(unit, normal);
    reflected = turned_to(shorten(reflect(unit, normal)), axis, upwards);
    passes = refract(unit, normal, eta, &refracted);
    if (passes) {
      cosine_out = dot_q14(refracted, normal);
      refracted = turned_to(refracted, axis, !upwards);
    }
  } else {
    passes = refract(unit, axis, eta, &refracted);
    cosine_out = refracted[axis];
  }
  const int32_t cosine = here < there ? cosine_in : cosine_out;
  const uint32_t back = passes ? fresnel_q16(cosine, r0_q16(here, there)) : kOneQ16;
  const LitRayKind kind = meeting.at_water ? LitRayKind::kWaterRay : LitRayKind::kGlassRay;
  const bool is_wet = leg->medium.kind == Medium::kWaterBody;
  send(frame, *now, kind, meeting.hit.axis, on_its_side(frame, meeting, at, reflected, is_wet), reflected,
       back, pending, count);
  if (passes) {
    send(frame, *now, kind, meeting.hit.axis, on_its_side(frame, meeting, at, refracted, !is_wet), refracted,
         kOneQ16 - back, pending, count);
  }
  return false;
}

}  // namespace thimble::lit
