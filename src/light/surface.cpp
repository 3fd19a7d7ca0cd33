// What a ray meets, and what a face gets without any effect.
#include "arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// Light from everywhere is not quite the same from everywhere: with these shares for the faces -x, +x, -y,
// +y, -z, +z (256 = 1) an edge is seen in the shadow too.
constexpr uint16_t kAmbientShare[6] = {222, 222, 200, 200, 160, 256};

// Where light is gathered for a hit, and by which face. A solid voxel entered through an edge counts as
// entered by the lowest of the faces there, which may be one that another voxel hides: then light would not
// reach what the eye sees. So it is the lowest that is not hidden; and where all are, in a crease, the point
// on the edge itself, from where rays go out of the crease as from both of its sides.
//
// A ray that starts in something solid (axis -1) but on a face of it, and goes in there, has come to that
// face: what is reflected within 1/256 voxel of a crease starts on the other side's face. Not on its own:
// that is behind it.
Vec3Q8 choose_face(const Frame& frame, const PendingRay& now, Hit* hit) {
  const Ray& ray = now.ray;
  const int32_t side = int32_t{1} << hit->block_level;
  Hit entered[3];  // through each of the faces crossed at that t
  int count = 0;
  Vec3Q8 edge = start_on_face(ray, *hit);
  const bool starts_inside = hit->axis < 0;
  for (int axis = starts_inside ? 0 : hit->axis; axis < 3; ++axis) {
    const int32_t direction = ray.direction[axis];
    const int32_t plane = (hit->voxel[axis] + (direction > 0 ? 0 : side)) * Q8::kOne;
    const int32_t distance = plane - ray.origin[axis].raw;
    Hit one = *hit;
    one.axis = static_cast<int8_t>(axis);
    one.t_numerator = direction > 0 ? distance : -distance;
    one.t_denominator = static_cast<int32_t>(magnitude_32(direction)) * Q8::kOne;
    if (direction != 0 &&
        (starts_inside ? distance == 0 && axis != now.axis
                       : one.t_numerator >= 0 && !is_before(point_of(one), point_of(*hit)))) {
      entered[count++] = one;
      edge[axis] = Q8::from_raw(plane);
    }
  }
  if (count == 0 || (count == 1 && !starts_inside)) {
    return edge;
  }
  for (int i = 0; i < count; ++i) {
    const int8_t axis = entered[i].axis;
    const Vec3Q8 at = start_on_face(ray, entered[i]);
    Vec3i before{at.x.floor(), at.y.floor(), at.z.floor()};
    before[axis] = hit->voxel[axis] + (ray.direction[axis] > 0 ? -1 : side);
    uint8_t material = 0;
    if (!material_at(frame.tree, before, &material) || is_clear(frame, material)) {
      *hit = entered[i];
      return at;
    }
  }
  return edge;
}

}  // namespace

void count_ray(Frame& frame, LitRayKind kind) {
  frame.counts.rays[static_cast<int>(kind)] += 1;
}

void count_result(Frame& frame, LitRayKind kind, HitKind result, uint32_t visits) {
  frame.counts.node_visits[static_cast<int>(kind)] += visits;
  frame.counts.hits[static_cast<int>(kind)] += result == HitKind::kHit ? 1U : 0U;
  frame.counts.step_limited += result == HitKind::kStepLimit ? 1U : 0U;
}

Surface surface_of(const Frame& frame, uint8_t material) {
  if (material < frame.scene.surfaces.size) {
    return frame.scene.surfaces[material];
  }
  Surface surface;
  surface.albedo =
      material < frame.shading.palette.size ? frame.shading.palette[material] : frame.shading.default_color;
  return surface;
}

void find_solid(Frame& frame, LitRayKind kind, const Ray& ray, Hit* hit) {
  if (closest_hit(frame.tree, ray, hit, {frame.options.max_visits, Width::kAuto}) != Status::kOk) {
    *hit = Hit{};
    return;
  }
  count_result(frame, kind, hit->kind, hit->visits);
}

void meet_solid(Frame& frame, const PendingRay& now, Meeting* meeting) {
  find_solid(frame, now.kind, now.ray, &meeting->hit);
  meeting->found = meeting->hit.kind == HitKind::kHit;
  meeting->opaque = meeting->found;
}

Spot spot_of(const Frame& frame, const PendingRay& now, const Meeting& meeting) {
  Hit hit = meeting.hit;
  Spot spot;
  spot.at = choose_face(frame, now, &hit);
  spot.face = face_of(hit, now.ray.direction);
  spot.inside = hit.axis < 0;
  spot.arriving = now.ray.direction;
  spot.surface = surface_of(frame, hit.material);
  return spot;
}

void plain_light(const Frame& frame, const Spot& spot, Color* light) {
  const uint32_t face = frame.shading.face_light[2 * spot.face.axis + (spot.face.negative ? 0 : 1)];
  for (uint32_t& channel : light->c) {
    channel = face * (kFullLight / 256);
  }
}

void ambient_light(const Frame& frame, const Spot& spot, Color* light) {
  const uint32_t share = kAmbientShare[2 * spot.face.axis + (spot.face.negative ? 0 : 1)];
  for (int i = 0; i < 3; ++i) {
    light->c[i] = (frame.scene.ambient_q8[i] * share * (kFullLight / 256)) >> 8;  // 16 bits by 8 by 4
  }
}

void light_on_slope(const Frame& frame, const Slope& slope, bool ambient, Color* light) {
  // Of each face as much as the square of the normal's component: the squares add up to 1.
  uint32_t share = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t component = magnitude_32(slope.normal[axis]);
    const int face = 2 * axis + (slope.normal[axis] < 0 ? 0 : 1);
    const uint32_t of_face = ambient ? kAmbientShare[face] : frame.shading.face_light[face];
    share += of_face * ((component * component + (1U << 13)) >> 14);  // 8 bits and a half by 14 and a bit
  }
  share = (share + (1U << 13)) >> 14;
  for (int i = 0; i < 3; ++i) {
    const uint32_t strength = ambient ? frame.scene.ambient_q8[i] : 256U;
    light->c[i] = (strength * share * (kFullLight / 256)) >> 8;
  }
}

Color lit_color(const Spot& spot, const Color& light) {
  Color color;
  for (int i = 0; i < 3; ++i) {
    const uint32_t strength = light.c[i] < UINT16_MAX ? light.c[i] : UINT16_MAX;
    const uint32_t channel =
        (channel_of(spot.surface.albedo, i) * strength + kFullLight / kLevel / 2) / (kFullLight / kLevel);
    color.c[i] = channel < kMaxChannel ? channel : kMaxChannel;
  }
  return color;
}

void add(const Color& color, const Weight& weight, Color* sum) {
  for (int i = 0; i < 3; ++i) {
    sum->c[i] += (color.c[i] * weight.c[i] + kFullWeight / 2) / kFullWeight;  // 2^16 by 2^15
  }
}

Color background(const Frame& frame) {
  return color_of(frame.shading.background);
}

void add_emission(const Spot& spot, Color* color) {
  if (spot.surface.kind != SurfaceKind::kEmit) {
    return;
  }
  for (int i = 0; i < 3; ++i) {
    const uint32_t channel = color->c[i] + channel_of(spot.surface.albedo, i) *
                                               uint32_t{spot.surface.emission_q8} / (256 / kLevel);
    color->c[i] = channel < kMaxChannel ? channel : kMaxChannel;
  }
}

bool spares_light(const Frame& frame, const LightRay& light, const Hit& hit) {
  if (!light.is_point) {
    return false;
  }
  if (!is_before(point_of(hit), light.place)) {
    return true;
  }
  return (frame.effects & Effect::kEmission) != 0 &&
         surface_of(frame, hit.material).kind == SurfaceKind::kEmit;
}

}  // namespace thimble::lit
