// Water: what a ray meets once the columns are looked at too.
#include "lit_arithmetic.h"
#include "thimble/lit_pixel.h"

namespace thimble::lit {
namespace {

RayPoint point_of_water(const WaterHit& hit) {
  return {hit.t_numerator, hit.t_denominator};
}

// Makes the meeting one with a face of the water.
void meet_face(const Frame& frame, const Ray& ray, const WaterHit& hit, Medium::Kind beyond,
               Meeting* meeting) {
  const WaterSurface& water = frame.scene.water;
  const Vec3i low{(water.corner.x + hit.column_x) * Q8::kOne, (water.corner.y + hit.column_y) * Q8::kOne,
                  water.corner.z * Q8::kOne};
  const Vec3i high{low.x + Q8::kOne, low.y + Q8::kOne, low.z + water.height_q8(hit.column_x, hit.column_y)};
  *meeting = Meeting{};
  meeting->found = true;
  meeting->at_water = true;
  meeting->water_side = hit.side;
  meeting->beyond = {beyond, 0};
  meeting->hit.axis = hit.axis;
  meeting->hit.t_numerator = hit.t_numerator;
  meeting->hit.t_denominator = hit.t_denominator;
  meeting->at = start_on_plane(ray, hit.axis, hit.side < 0 ? low[hit.axis] : high[hit.axis], low, high);
}

}  // namespace

void begin_in_water(const Frame& frame, const PendingRay& now, Leg* leg) {
  if (leg->medium.kind == Medium::kAir && water_holds(frame.scene.water, now.ray.origin, now.ray.direction)) {
    leg->medium = {Medium::kWaterBody, 0};
  }
}

void meet_water(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  const WaterSurface& water = frame.scene.water;
  if (leg.medium.kind == Medium::kSolid) {
    if (meeting->found && !meeting->opaque && meeting->beyond.kind == Medium::kAir &&
        water_holds(water, start_on_face(now.ray, meeting->hit), now.ray.direction)) {
      meeting->beyond = {Medium::kWaterBody, 0};
    }
    return;
  }
  WaterHit hit;
  const bool inside = leg.medium.kind == Medium::kWaterBody;
  const bool found = inside ? water_leave(water, now.ray, &hit) : water_enter(water, now.ray, &hit);
  frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += hit.visits;
  // What is solid goes before water: on a common face too.
  if (found && hit.axis >= 0 && (!meeting->found || is_before(point_of_water(hit), point_of(meeting->hit)))) {
    meet_face(frame, now.ray, hit, inside ? Medium::kAir : Medium::kWaterBody, meeting);
  }
}

void filter_by_water(Frame& frame, LightRay* light) {
  const WaterSurface& water = frame.scene.water;
  WaterHit hit;
  if (!water_leave(water, light->ray, &hit)) {
    return;
  }
  frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += hit.visits;
  RayPoint end = point_of_water(hit);
  if (light->is_point && is_before(light->place, end)) {
    end = light->place;
  }
  const uint32_t length =
      static_cast<uint32_t>(distance_q8(light->ray.direction, end.t_numerator, end.t_denominator));
  for (int i = 0; i < 3; ++i) {
    light->brightness[i] = weighed_32(light->brightness[i], left_q16(frame.scene.water_material, i, length));
  }
}

}  // namespace thimble::lit
