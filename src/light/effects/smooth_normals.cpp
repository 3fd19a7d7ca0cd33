// Smooth normals: light sees the slope of a surface instead of the faces of its voxels. What is hit, and what
// a ray then meets, is as exact as without; only where rays go out from changes, and only where the slope is
// not the face's own: from above the steps of the slope, or each of them would lie in the shadow of the next.
#include "../queries.h"
#include "boundary.h"
#include "thimble/light/host/slope.h"

namespace thimble::lit {
namespace {

// A direction of the occlusion pattern round the normal: by half a turn about the line half way between the
// normal and its largest axis.
struct Turn {
  int axis = 0;
  bool negative = false;
  Vec3i about;

  explicit Turn(const Vec3i& normal) {
    for (int i = 1; i < 3; ++i) {
      axis = magnitude_32(normal[i]) > magnitude_32(normal[axis]) ? i : axis;
    }
    negative = normal[axis] < 0;
    about = normal;
    about[axis] += negative ? -kUnitQ14 : kUnitQ14;
    about = unit_q14(about);
  }
  Vec3i direction(int index) const {
    const Vec3i from = occlusion_direction(index, axis, negative);
    constexpr int32_t kScale = kUnitQ14 / 128;
    const Vec3i turned = reflect({from.x * kScale, from.y * kScale, from.z * kScale}, about);
    return {-turned.x, -turned.y, -turned.z};
  }
};

// A place on the ray from which on `distance_q8` gives the reach and more: its length is rounded, by at most
// 2^-15 of itself, and so is the distance.
RayPoint beyond_reach(const Ray& ray, const Occlusion& occlusion) {
  return {occlusion.reach + (occlusion.reach >> 13) + 1, static_cast<int32_t>(length_of(ray.direction)) - 1};
}

template <class AnyFrame>
[[gnu::always_inline]] inline void occlude_slope(AnyFrame& frame, const Spot& spot, const Slope& slope,
                                                 Color* light) {
  const Occlusion& occlusion = frame.scene.occlusion;
  const int rays = occlusion_rays(occlusion);
  if (!slope.raised || rays == 0 || occlusion.reach == 0) {
    occlude(frame, spot, light);
    return;
  }
  const Turn turn(slope.normal);
  const uint32_t reach_q8 = uint32_t{occlusion.reach} << 8;
  uint32_t open = 0;
  for (int i = 0; i < rays; ++i) {
    const auto share_along = [&](const Vec3i& direction, const Hit& hit) {
      const uint32_t distance =
          static_cast<uint32_t>(distance_q8(direction, hit.t_numerator, hit.t_denominator));
      return distance < reach_q8 ? (distance << 4) / occlusion.reach : kOpenShare;  // 24 bits by 4
    };
    uint32_t share = kOpenShare;
    if constexpr (AnyFrame::kIsAsked) {
      // Most answers are misses, which need no direction.
      const auto aimed = [&] { return Ray{slope.start, turn.direction(i)}; };
      count_ray(frame, LitRayKind::kOcclusion);
      Hit hit;
      find_around(frame, aimed, &hit);
      share = is_opaque(frame, hit) ? share_along(aimed().direction, hit) : kOpenShare;
    } else {
      const Ray ray{slope.start, turn.direction(i)};
      count_ray(frame, LitRayKind::kOcclusion);
      Hit hit;
      find_before(
          frame, LitRayKind::kOcclusion, ray, [&] { return beyond_reach(ray, occlusion); }, &hit);
      if (is_opaque(frame, hit)) {
        share = share_along(ray.direction, hit);
      }
    }
    open += share;
  }
  darken(occlusion, open, rays, light);
}

template <class AnyFrame>
[[gnu::always_inline]] inline Slope find_slope_at(AnyFrame& frame, LitRayKind kind, const Spot& spot) {
  const Body body{frame.scene.surfaces, frame.effects, 0};
  Slope slope;
  uint32_t visits = 0;
  if constexpr (AnyFrame::kIsAsked) {
    slope.normal = surface_normal(frame, body, spot.at, spot.face, &visits);
    if (frame.is_open) {
      return slope;
    }
  } else {
    slope.normal = surface_normal(frame.tree, body, spot.at, spot.face, &visits);
  }
  frame.counts.node_visits[static_cast<int>(kind)] += visits;
  slope.bent = magnitude_32(slope.normal[spot.face.axis]) != static_cast<uint32_t>(kUnitQ14);
  slope.start = spot.at;
  if (slope.bent) {
    Vec3Q8 above = spot.at;
    for (int axis = 0; axis < 3; ++axis) {
      above[axis].raw += slope.normal[axis] * kSlopeRise / kUnitQ14;
    }
    if (!body.has(frame.tree, {above.x.floor(), above.y.floor(), above.z.floor()})) {
      slope.start = above;
      slope.raised = true;
    }
  }
  return slope;
}

}  // namespace

Slope slope_at(Frame& frame, LitRayKind kind, const Spot& spot) {
  return find_slope_at(frame, kind, spot);
}
Slope slope_at(AskedFrame& frame, LitRayKind kind, const Spot& spot) {
  return find_slope_at(frame, kind, spot);
}

bool light_ray(const Light& light, const Spot& spot, const Slope& slope, LightRay* ray) {
  if (!aim_at(light, slope.start, ray) ||
      (!slope.raised && !leaves_face(ray->ray.direction, spot.face.axis, spot.face.negative))) {
    return false;
  }
  const int32_t cosine = dot_q14(unit_q14(ray->ray.direction), slope.normal);
  if (cosine <= 0) {
    return false;
  }
  uint32_t share_q16 = UINT16_MAX;
  if (light.is_point) {
    const int32_t distance =
        distance_q8(ray->ray.direction, ray->place.t_numerator, ray->place.t_denominator);
    share_q16 = falloff_q16(static_cast<uint32_t>(distance), light.reach);
  }
  return set_brightness(light, (share_q16 * static_cast<uint32_t>(lesser(cosine, kUnitQ14))) >> 14, ray);
}

void occlude(Frame& frame, const Spot& spot, const Slope& slope, Color* light) {
  occlude_slope(frame, spot, slope, light);
}
void occlude(AskedFrame& frame, const Spot& spot, const Slope& slope, Color* light) {
  occlude_slope(frame, spot, slope, light);
}
void occlude(BallFrame& frame, const Spot& spot, const Slope& slope, Color* light) {
  occlude_slope(frame, spot, slope, light);
}

void send_mirrored(Frame& frame, PendingRay* now, const Spot& spot, const Slope& slope, PendingRay* pending,
                   size_t* count) {
  const Surface& metal = spot.surface;
  if (!is_mirror(metal) || now->bounces >= frame.scene.bounces) {
    return;
  }
  const int axis = spot.face.axis;
  const Vec3i unit = unit_q14(spot.arriving);
  const int32_t along = dot_q14(unit, slope.normal);
  // Seen from behind the slope it is grazed: straight on.
  const int32_t cosine = along < 0 ? -along : 0;
  const Vec3i mirrored = along < 0 ? shorten(reflect(unit, slope.normal)) : unit;
  Weight weight;
  divide_weight(metal, cosine, &now->weight, &weight);
  const bool rough = is_spread(metal, *now, &weight);
  for (int i = 0; i < (rough ? kRoughnessRays : 1); ++i) {
    Ray ray{slope.start, rough ? shorten(roughen(mirrored, metal.roughness, i)) : mirrored};
    if (!slope.raised) {
      ray.direction = turned_from(ray.direction, axis, !spot.face.negative);
    }
    send(frame, *now, LitRayKind::kMirrorRay, slope.raised ? -1 : axis, ray, weight, pending, count);
  }
}

}  // namespace thimble::lit
