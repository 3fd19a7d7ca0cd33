// Boundaries of clear solids by their slope (Effect::kSmoothNormals): what glass.cpp does by their faces. Apart
// from it, with small parts of its own, so that an image without slopes keeps its bytes.
#include "../arithmetic.h"
#include "../asking.h"
#include "slope_rays.h"
#include "thimble/light/detail/pixel.h"
#include "thimble/light/host/slope.h"

namespace thimble::lit {
namespace {

uint32_t index_of(const Frame& frame, const Medium& medium) {
  if (medium.kind == Medium::kAir) {
    return kOneQ12;
  }
  const Surface surface =
      medium.kind == Medium::kWaterBody ? frame.scene.water_material : surface_of(frame, medium.material);
  const int32_t index = surface.index_q12;
  return surface.kind == SurfaceKind::kMedia
             ? kOneQ12
             : static_cast<uint32_t>(clamped(index, kMinIndexQ12, kMaxIndexQ12));
}

// Whether a point is in what the ray is sent into.
bool is_in(const Frame& frame, const Medium& medium, const Vec3Q8& at) {
  uint8_t material = 0;
  const bool solid = material_at(frame.tree, {at.x.floor(), at.y.floor(), at.z.floor()}, &material);
  return medium.kind == Medium::kSolid ? solid && material == medium.material : !solid;
}

// Sends a ray from a slope: from above its steps, or from below them for one that goes into the body; where
// that is something else, from the face and away from it.
struct SlopeStart {
  Vec3Q8 at;
  Vec3i normal;  // towards the side where the ray arrives
  int8_t axis;
  bool upwards;  // that side of the face

  void send(Frame& frame, const PendingRay& from, const Medium& medium, const Vec3i& direction, bool back,
            uint32_t share_q16, PendingRay* pending, size_t* count) const {
    Vec3Q8 start = at;
    for (int i = 0; i < 3; ++i) {
      start[i].raw += (back ? normal[i] : -normal[i]) * kSlopeRise / kUnitQ14;
    }
    const bool raised = is_in(frame, medium, start);
    PendingRay out;
    out.ray = {raised ? start : at, raised ? direction : turned_from(direction, axis, upwards == back)};
    out.bounces = static_cast<uint8_t>(from.bounces + 1);
    out.kind = LitRayKind::kGlassRay;
    out.axis = raised ? int8_t{-1} : axis;
    for (int i = 0; i < 3; ++i) {
      out.weight.c[i] = weighed(from.weight.c[i], share_q16);
    }
    if (is_seen(out.weight)) {
      count_ray(frame, LitRayKind::kGlassRay);
      pending[(*count)++] = out;
    }
  }
};

template <class AnyFrame>
[[gnu::always_inline]] inline bool cross_bent(AnyFrame& frame, PendingRay* now, Leg* leg,
                                              const Meeting& meeting, PendingRay* pending, size_t* count) {
  const uint32_t here = index_of(frame, leg->medium);
  const uint32_t there = index_of(frame, meeting.beyond);
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
  const int32_t cosine_in = dot_q14(unit, normal);
  // From behind the slope it is grazed, and all light goes straight on.
  Vec3i reflected = unit;
  uint32_t back = kOneQ16;
  Vec3i refracted;
  if (cosine_in < 0) {
    reflected = shorten(reflect(unit, normal));
    if (refract(unit, normal, eta_q12(here, there), &refracted)) {
      back = fresnel_q16(here < there ? cosine_in : dot_q14(refracted, normal), r0_q16(here, there));
    }
  }
  const SlopeStart start{at, normal, axis, !forwards};
  start.send(frame, *now, leg->medium, reflected, true, back, pending, count);
  if (back < kOneQ16) {
    start.send(frame, *now, meeting.beyond, shorten(refracted), false, kOneQ16 - back, pending, count);
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
