// Water: what a ray meets once the columns are looked at too.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

RayPoint point_of_water(const WaterHit& hit) {
  return {hit.t_numerator, hit.t_denominator};
}

// Whether there is water in the column beyond the side that was crossed.
bool has_water_beyond(const WaterSurface& water, const WaterHit& hit) {
  const int32_t x = hit.column_x + (hit.axis == 0 ? hit.side : 0);
  const int32_t y = hit.column_y + (hit.axis == 1 ? hit.side : 0);
  return x >= 0 && y >= 0 && x < water.width && y < water.depth && water.height_q16(x, y) >= 128;
}

// Whether a point lies in the box that no column leaves, or on its faces.
bool is_in_box(const WaterSurface& water, const Vec3Q8& at) {
  const auto within = [](Q8 value, int32_t low, int32_t size_q8) {
    const int32_t from_low = value.raw - low * Q8::kOne;
    return from_low >= 0 && from_low <= size_q8;
  };
  return within(at.x, water.corner.x, water.width * Q8::kOne) &&
         within(at.y, water.corner.y, water.depth * Q8::kOne) &&
         within(at.z, water.corner.z, water.highest_q8);
}

// Makes the meeting one with a face of the water. A side between two columns is no wall but a step of the
// wave, which the wave's own slope bends.
void meet_face(const Frame& frame, const Ray& ray, const WaterHit& hit, Medium::Kind beyond,
               Meeting* meeting) {
  const WaterSurface& water = frame.scene.water;
  const int32_t height = water.height_q8(hit.column_x, hit.column_y);
  const Vec3i low{(water.corner.x + hit.column_x) * Q8::kOne, (water.corner.y + hit.column_y) * Q8::kOne,
                  water.corner.z * Q8::kOne};
  const Vec3i high{low.x + Q8::kOne, low.y + Q8::kOne, low.z + height};
  *meeting = Meeting{};
  meeting->found = true;
  meeting->at_water = true;
  meeting->at_surface = hit.axis == 2 && hit.side > 0;
  meeting->beyond = {beyond, 0};
  meeting->hit.axis = hit.axis;
  meeting->hit.t_numerator = hit.t_numerator;
  meeting->hit.t_denominator = hit.t_denominator;
  meeting->at = start_on_plane(ray, hit.axis, hit.side < 0 ? low[hit.axis] : high[hit.axis], low, high);
  if (hit.axis != 2 && has_water_beyond(water, hit)) {
    meeting->at_surface = true;
    meeting->hit.axis = 2;
  }
}

}  // namespace

void begin_in_water(const Frame& frame, const PendingRay& now, Leg* leg) {
  if (leg->medium.kind != Medium::kSolid) {
    const bool inside = water_holds(frame.scene.water, now.ray.origin, now.ray.direction);
    leg->medium = {inside ? Medium::kWaterBody : Medium::kAir, 0};
  }
}

void meet_water(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  const WaterSurface& water = frame.scene.water;
  if (leg.medium.kind == Medium::kSolid) {
    if (meeting->found && !meeting->opaque && meeting->beyond.kind == Medium::kAir) {
      const Vec3Q8 at = start_on_face(now.ray, meeting->hit);
      // A column is looked at, and counted, wherever one may reach: also above those of now.
      frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += is_in_box(water, at) ? 1U : 0U;
      if (water_holds(water, at, now.ray.direction)) {
        meeting->beyond = {Medium::kWaterBody, 0};
      }
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
  const bool starts_in_water = water_leave(water, light->ray, &hit);
  frame.counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] += hit.visits;
  if (!starts_in_water) {
    return;
  }
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
