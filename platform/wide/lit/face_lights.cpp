#include "wide/lit/face_lights.h"

#include <algorithm>

#include "thimble/light/host/optics.h"
#include "wide/lit/kernels.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::wide {
namespace {

constexpr uint32_t kOpen = 1U << 12;  // occlusion: nothing is in the way

// The calls of ray_map.h refuse no ray here: each begins on a face of the world, and its direction has at most 15 bits
// and is not 0. So their statuses are not looked at.

// What the material that a ray to a light enters first does to the ray; 0 where it enters nothing before the light.
enum ShadowClass : uint8_t { kBlocks = 1, kGoesOn = 2, kSpares = 3 };

uint32_t rays_around(EffectSet effects, const LitScene& scene) {
  const Occlusion& occlusion = scene.occlusion;
  const bool any = (effects & Effect::kAmbientOcclusion) != 0 && occlusion.reach != 0;
  return any ? std::min<uint32_t>(occlusion.rays, kOcclusionDirections) : 0;
}

}  // namespace

FaceLightsShape::FaceLightsShape(EffectSet effects, const LitScene& scene, uint32_t face_count)
    : faces(face_count),
      around(rays_around(effects, scene)),
      has_lamps(false),
      has_through(false),
      has_water(false) {
  if ((effects & Effect::kDirectLight) != 0 && scene.lights.size != 0) {
    has_lamps = std::any_of(scene.lights.data, scene.lights.data + scene.lights.size,
                            [](const Light& light) { return light.is_point; });
    const bool shadows = (effects & Effect::kShadows) != 0;
    has_through = shadows && lit_media(effects, scene).count != 0;
    has_water = shadows && (effects & Effect::kWater) != 0;
  }
}

void FaceLightsParts::lay_out(const FaceLightsShape& shape, ArrayArena* arena) {
  const size_t count = shape.faces;
  const size_t of_lamps = shape.has_lamps ? count + kMostLightLanes : 0;
  const size_t of_ways = shape.has_through ? count : 0;
  faces = arena->take<LitFace>(count);
  light = arena->take<lit::Color>(count);
  rays = arena->take<Ray>(count);
  asking = arena->take<uint32_t>(count);
  any = arena->take<uint8_t>(count);
  points = arena->take<RayPoint>(std::max(of_lamps, count));
  bright = arena->take<lit::Color>(count);
  order = arena->take<uint32_t>(count);
  open = arena->take<uint32_t>(shape.around != 0 ? count : 0);
  numerator = arena->take<int32_t>(of_lamps);
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = arena->take<int32_t>(of_lamps);
    direction[axis] = arena->take<int32_t>(of_lamps);
    brightness[axis] = arena->take<int32_t>(of_lamps);
  }
  in_water = arena->take<uint8_t>(shape.has_water ? count : 0);
  under_way = arena->take<uint32_t>(of_ways);
  through = arena->take<lit::LightRay>(of_ways);
  ways = arena->take<lit::LightWay>(of_ways);
  answers = arena->take<lit::Answer>(of_ways);
  for (const lit::Question question : {lit::Question::kClosest, lit::Question::kBefore, lit::Question::kOn}) {
    lit::Asked& asked = questions[static_cast<int>(question)];
    asked.rays = arena->take<Ray>(of_ways);
    asked.answer = arena->take<uint32_t>(of_ways);
    asked.before = question == lit::Question::kClosest ? nullptr : arena->take<RayPoint>(of_ways);
    asked.in = question == lit::Question::kOn ? arena->take<uint16_t>(of_ways) : nullptr;
  }
  hits = arena->take<Hit>(of_ways);
}

void put_hits(const Hit* hits, lit::Asked* asked, lit::Answer* answers) {
  for (uint32_t i = 0; i < asked->count; ++i) {
    answers[asked->answer[i]].hit = hits[i];
    answers[asked->answer[i]].into_solid = false;
  }
  asked->count = 0;
}

// Rays were checked when they were queued, so none is refused.
void answer_ways(const RayMap& map, lit::Asked (&questions)[lit::kQuestions], Hit* hits,
                 lit::Answer* answers) {
  lit::Asked& closest = questions[static_cast<int>(lit::Question::kClosest)];
  const Span<const Ray> rays{closest.rays, closest.count};
  (void)(closest.before == nullptr
             ? first_hit(map, rays, {hits, closest.count})
             : first_hit_from(map, rays, {closest.before, closest.count}, {hits, closest.count}));
  put_hits(hits, &closest, answers);
  lit::Asked& before = questions[static_cast<int>(lit::Question::kBefore)];
  (void)first_hit_before(map, {before.rays, before.count}, {before.before, before.count},
                         {hits, before.count});
  put_hits(hits, &before, answers);
  // The core follows rays through a medium; those through the air are traced together.
  lit::Asked& on = questions[static_cast<int>(lit::Question::kOn)];
  uint32_t in_air = 0;
  for (uint32_t i = 0; i < on.count; ++i) {
    if (on.in[i] != lit::kInNothing) {
      answers[on.answer[i]] = {};
      (void)leave_medium(map.tree(), on.rays[i], static_cast<uint8_t>(on.in[i]), &answers[on.answer[i]],
                         on.before[i]);
      continue;
    }
    on.rays[in_air] = on.rays[i];
    on.before[in_air] = on.before[i];
    on.answer[in_air++] = on.answer[i];
  }
  (void)first_hit_from(map, {on.rays, in_air}, {on.before, in_air}, {hits, in_air});
  for (uint32_t i = 0; i < in_air; ++i) {
    lit::Answer& answer = answers[on.answer[i]];
    answer = {};
    answer.hit = hits[i];
    answer.into_solid = hits[i].kind == HitKind::kHit;
  }
  on.count = 0;
}

FaceLights::FaceLights(const lit::Frame& frame, const RayMap& map, const FaceLightsShape& shape,
                       ArrayArena* arena)
    : frame_(frame), once_(frame), asking_(frame), map_(map), shape_(shape) {
  parts_.lay_out(shape, arena);
  asking_.questions = parts_.questions;
  asking_.once = &once_;
  const bool has_lights = (frame.effects & Effect::kDirectLight) != 0;
  for (uint32_t face = 0; face < kSides; ++face) {
    Side& side = sides_[face];
    side.spot.face = {static_cast<int>(face % kInside / 2), face % 2 == 0};
    if (has_lights) {
      lit::ambient_light(frame, side.spot, &side.ambient);
    } else {
      lit::plain_light(frame, side.spot, &side.ambient);
    }
  }
  std::fill_n(of_occlusion_, 256, uint8_t{1});
  std::fill_n(of_suns_, 256, uint8_t{kBlocks});
  std::fill_n(of_lamps_, 256, uint8_t{kBlocks});
  for (size_t i = 0; i < std::min<size_t>(frame.scene.surfaces.size, 256); ++i) {
    if ((frame.effects & Effect::kEmission) != 0 && frame.scene.surfaces[i].kind == SurfaceKind::kEmit) {
      of_lamps_[i] = kSpares;
      has_shining_ = true;
    }
  }
  const LitMedia media = lit_media(frame.effects, frame.scene);
  has_clear_ = media.count != 0;
  for (size_t i = 0; i < media.count; ++i) {
    of_occlusion_[media.materials[i]] = 0;
    of_suns_[media.materials[i]] = of_lamps_[media.materials[i]] = kGoesOn;
  }
}

LitCounts FaceLights::counts() const {
  LitCounts all = frame_.counts;
  lit::add_counts(once_.counts, &all);
  return all;
}

// What a ray of occlusion adds: 0 .. kOpen, by how far it goes.
uint32_t FaceLights::share_of(const RayPoint& met) {
  if (met.t_denominator == 0) {
    return kOpen;
  }
  ++frame_.counts.hits[static_cast<int>(LitRayKind::kOcclusion)];
  const uint32_t reach = frame_.scene.occlusion.reach;
  const uint32_t along = std::max(1U, static_cast<uint32_t>(met.t_denominator) >> 8);
  const uint32_t distance_q8 = static_cast<uint32_t>(met.t_numerator) * kOcclusionLength / along;
  return distance_q8 < reach << 8 ? (distance_q8 << 4) / reach : kOpen;
}

// lit::occlude. Rays of one direction are traced together.
void FaceLights::occlude() {
  const uint32_t around = shape_.around;
  const Occlusion& occlusion = frame_.scene.occlusion;
  uint32_t begin = 0;
  for (uint32_t face = 0; face < kInside && around != 0; ++face) {
    const uint32_t* const faces = parts_.order + begin;
    const uint32_t count = face_ends_[face] - begin;
    frame_.counts.rays[static_cast<int>(LitRayKind::kOcclusion)] += uint64_t{around} * count;
    std::fill_n(parts_.open, count, 0U);
    for (uint32_t n = 0; n < around; ++n) {
      const Vec3i direction =
          occlusion_direction(static_cast<int>(n), static_cast<int>(face) / 2, face % 2 == 0);
      for (uint32_t i = 0; i < count; ++i) {
        parts_.rays[i] = {parts_.faces[faces[i]].at, direction};
      }
      (void)first_entry_before(map_, {parts_.rays, count}, RayPoint{occlusion.reach, kOcclusionLength},
                               {parts_.points, count}, has_clear_ ? of_occlusion_ : nullptr);
      for (uint32_t i = 0; i < count; ++i) {
        parts_.open[i] += share_of(parts_.points[i]);
      }
    }
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t closed = kOpen - parts_.open[i] / around;
      const uint32_t factor = kOpen - closed * occlusion.strength / 255;
      for (uint32_t& channel : parts_.light[faces[i]].c) {
        channel = (std::min<uint32_t>(channel, UINT16_MAX) * factor) >> 12;
      }
    }
    begin = face_ends_[face];
  }
}

// Notes which faces' rays may begin in water: those of faces in, or on, the box around the columns of water.
void FaceLights::note_water() {
  const WaterSurface& water = frame_.scene.water;
  const int32_t sizes[3] = {water.width * Q8::kOne, water.depth * Q8::kOne, water.highest_q8};
  for (uint32_t i = 0; i < count_; ++i) {
    bool is_in = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t from_low = parts_.faces[i].at[axis].raw - water.corner[axis] * Q8::kOne;
      is_in = is_in && from_low >= 0 && from_low <= sizes[axis];
    }
    parts_.in_water[i] = is_in ? 1 : 0;
  }
}

void FaceLights::sort_by_face() {
  uint32_t next[kInside + 1] = {};
  for (uint32_t i = 0; i < count_; ++i) {
    next[parts_.faces[i].face < kInside ? parts_.faces[i].face + 1U : 0U] += 1;
  }
  next[0] = 0;
  for (uint32_t face = 1; face <= kInside; ++face) {
    next[face] += next[face - 1];
  }
  for (uint32_t i = 0; i < count_; ++i) {
    const LitFace& face = parts_.faces[i];
    if (face.face < kInside) {
      const uint32_t to = next[face.face]++;
      parts_.order[to] = i;
      for (int axis = 0; axis < 3 && shape_.has_lamps; ++axis) {
        parts_.at[axis][to] = face.at[axis].raw;
      }
    }
  }
  std::copy_n(next, kInside, face_ends_);
}

// Makes the rays to a lamp from the faces to which it brings light; returns how many.
uint32_t FaceLights::aim_at_lamp(const Light& light) {
  if (light.reach == 0) {
    return 0;
  }
  uint32_t begin = 0;
  uint32_t asking = 0;
  for (uint32_t face = 0; face < kInside; ++face) {
    const uint32_t end = face_ends_[face];
    LampRays lamp;
    for (int turn = 0; turn < 3; ++turn) {
      const int axis = (static_cast<int>(face) / 2 + turn) % 3;
      lamp.place[turn] = light.place[axis];
      lamp.at[turn] = parts_.at[axis] + begin;
      lamp.direction[turn] = parts_.direction[axis] + begin;
      lamp.color_q8[turn] = light.color_q8[turn];
      lamp.brightness[turn] = parts_.brightness[turn] + begin;
    }
    lamp.is_negative = face % 2 == 0;
    lamp.reach = light.reach;
    lamp.numerator = parts_.numerator + begin;
    if (end != begin) {
      aim_at(lamp, end - begin);
    }
    for (uint32_t i = begin; i < end; ++i) {
      lit::Color& bright = parts_.bright[asking];
      Ray& ray = parts_.rays[asking];
      for (int axis = 0; axis < 3; ++axis) {
        bright.c[axis] = static_cast<uint32_t>(parts_.brightness[axis][i]);
        ray.origin[axis].raw = parts_.at[axis][i];
        ray.direction[axis] = parts_.direction[axis][i];
      }
      parts_.points[asking] = {parts_.numerator[i], Q8::kOne};
      parts_.asking[asking] = parts_.order[i];
      asking += (bright.c[0] | bright.c[1] | bright.c[2]) != 0 ? 1U : 0U;
    }
    begin = end;
  }
  return asking;
}

// The same for a sun.
uint32_t FaceLights::aim_at_sun(const Light& light) {
  lit::LightRay to[kInside];
  bool shines[kInside];
  for (uint32_t face = 0; face < kInside; ++face) {
    shines[face] = lit::light_ray(light, sides_[face].spot, &to[face]);
  }
  uint32_t asking = 0;
  for (uint32_t i = 0; i < count_; ++i) {
    const LitFace& face = parts_.faces[i];
    if (face.face < kInside && shines[face.face]) {
      const lit::LightRay& sun = to[face.face];
      parts_.asking[asking] = i;
      parts_.rays[asking] = {face.at, sun.ray.direction};
      std::copy_n(sun.brightness, 3, parts_.bright[asking].c);
      ++asking;
    }
  }
  return asking;
}

void FaceLights::find_shadows(const Light& light, uint32_t asking) {
  constexpr int kKind = static_cast<int>(LitRayKind::kShadow);
  const Span<const Ray> rays{parts_.rays, asking};
  const Span<uint8_t> found{parts_.any, asking};
  if (light.is_point) {
    const Span<const RayPoint> points{parts_.points, asking};
    (void)any_hit_before(map_, rays, points, found, has_clear_ || has_shining_ ? of_lamps_ : nullptr);
  } else {
    (void)any_hit(map_, rays, found, has_clear_ ? of_suns_ : nullptr);
  }
  frame_.counts.rays[kKind] += asking;
  for (uint32_t i = 0; i < asking; ++i) {
    frame_.counts.hits[kKind] += parts_.any[i] != 0 && parts_.any[i] != kGoesOn ? 1U : 0U;
  }
}

// Makes of a ray to a light what the core keeps of it.
lit::LightRay FaceLights::ray_of(const Light& light, uint32_t number) const {
  lit::LightRay ray;
  ray.ray = parts_.rays[number];
  std::copy_n(parts_.bright[number].c, 3, ray.brightness);
  ray.is_point = light.is_point;
  ray.place = light.is_point ? parts_.points[number] : RayPoint();
  return ray;
}

// Follows the rays that enter something clear first, stretch by stretch, by the core's own function. (A ray enters
// first what it begins in.)
void FaceLights::go_through(const Light& light, uint32_t asking) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < asking; ++i) {
    if (parts_.any[i] == kGoesOn) {
      parts_.through[i] = ray_of(light, i);
      parts_.ways[i] = {};
      parts_.answers[i] = {};
      parts_.under_way[count++] = i;
    }
  }
  // The loop ends, since a ray has a bounded number of stretches.
  for (uint32_t known = 0; count != 0; known = 1) {
    uint32_t left = 0;
    for (uint32_t n = 0; n < count; ++n) {
      const uint32_t i = parts_.under_way[n];
      asking_.begin(parts_.answers + i, i, known, &known_, nullptr);
      asking_.way = &parts_.ways[i];
      lit::LightRay& ray = parts_.through[i];
      const bool arrives = lit::light_arrives_through(asking_, &ray);
      if (!asking_.is_answered()) {
        parts_.under_way[left++] = i;
        continue;
      }
      parts_.any[i] = arrives ? 0 : kBlocks;
      std::copy_n(ray.brightness, 3, parts_.bright[i].c);
    }
    count = left;
    answer_ways(map_, parts_.questions, parts_.hits, parts_.answers);
  }
}

// Adds the light that the rays to a light bring, where nothing is in the way.
void FaceLights::add_arriving(const Light& light, uint32_t asking) {
  const bool has_shadows = (frame_.effects & Effect::kShadows) != 0;
  if (has_shadows) {
    find_shadows(light, asking);
  }
  if (has_shadows && has_clear_) {
    go_through(light, asking);
  }
  for (uint32_t i = 0; i < asking; ++i) {
    const bool arrives = !has_shadows || parts_.any[i] != kBlocks;
    if (shape_.has_water && arrives && parts_.in_water[parts_.asking[i]] != 0) {
      lit::LightRay ray = ray_of(light, i);
      lit::filter_by_water(frame_, &ray);
      std::copy_n(ray.brightness, 3, parts_.bright[i].c);
    }
    const uint32_t open = arrives ? UINT32_MAX : 0;
    for (int c = 0; c < 3; ++c) {
      parts_.light[parts_.asking[i]].c[c] += parts_.bright[i].c[c] & open;
    }
  }
}

void FaceLights::shine(uint32_t count) {
  count_ = count;
  if (count == 0) {
    return;
  }
  for (uint32_t i = 0; i < count; ++i) {
    parts_.light[i] = sides_[parts_.faces[i].face].ambient;
  }
  if (shape_.around != 0 || shape_.has_lamps) {
    sort_by_face();
  }
  occlude();
  if ((frame_.effects & Effect::kDirectLight) == 0) {
    return;
  }
  if (shape_.has_water) {
    note_water();
  }
  for (const Light& light : frame_.scene.lights) {
    add_arriving(light, light.is_point ? aim_at_lamp(light) : aim_at_sun(light));
  }
}

}  // namespace thimble::wide
