#include "wide/lit/stream.h"

#include <algorithm>

#include "thimble/light/host/optics.h"

namespace thimble::wide {
namespace {

// So many faces' slopes are kept for each pixel under way: together those of some rows.
constexpr uint32_t kSlopesASlot = 2;

}  // namespace

void StreamParts::lay_out(const StreamShape& shape, ArrayArena* arena) {
  slots = arena->take<StreamSlot>(shape.slots);
  pending = arena->take<lit::PendingRay>(size_t{shape.slots} * shape.pending);
  lights = arena->take<lit::KnownLight>(size_t{shape.slots} * shape.lights);
  answers = arena->take<lit::Answer>(size_t{shape.slots} * shape.answers);
  waiting = arena->take<uint32_t>(shape.slots);
  uint32_t most_hits = 0;
  for (int i = 0; i < lit::kQuestions; ++i) {
    most_hits = i != static_cast<int>(lit::Question::kAny) ? std::max(most_hits, shape.most[i]) : most_hits;
    questions[i].rays = arena->take<Ray>(shape.most[i]);
    questions[i].answer = arena->take<uint32_t>(shape.most[i]);
    const bool is_on = i == static_cast<int>(lit::Question::kOn);
    const bool has_point = is_on || i == static_cast<int>(lit::Question::kBefore) ||
                           i == static_cast<int>(lit::Question::kClosest);
    questions[i].before = has_point ? arena->take<RayPoint>(shape.most[i]) : nullptr;
    questions[i].in = is_on ? arena->take<uint16_t>(shape.most[i]) : nullptr;
  }
  slopes = arena->take<lit::AskedSlope>(shape.most_slopes);
  known_slopes = arena->take<KnownSlope>(shape.known_slopes);
  known_windows = arena->take<KnownWindow>(shape.known_slopes / 4);
  any = arena->take<uint8_t>(shape.most[static_cast<int>(lit::Question::kAny)]);
  hits = arena->take<Hit>(most_hits);
  shown = arena->take<ShownFace>(shape.of_faces.faces);
  done = arena->take<uint32_t>(shape.slots);
  sky.lay_out(shape.of_faces.faces, arena);
  beyond = arena->take<ShownBeyond>(shape.of_faces.faces);
}

StreamShape::StreamShape(EffectSet effects, const LitScene& scene, uint32_t slot_count)
    : slots(slot_count),
      pending(std::max(1U, static_cast<uint32_t>(lit::pending_rays(effects)))),
      answers(1),
      lights(0),
      most{},
      of_faces(effects, scene, slot_count + slot_count / 2),
      most_slopes((effects & Effect::kSmoothNormals) != 0 ? slot_count : 0),
      known_slopes(most_slopes * kSlopesASlot) {
  constexpr EffectSet kStretching = Effect::kGlass | Effect::kMedia | Effect::kWater;
  const bool clear = (effects & (Effect::kGlass | Effect::kMedia)) != 0;
  answers = (effects & kStretching) != 0 ? uint32_t{lit::kMaxLegs} : 1U;
  most[static_cast<int>(lit::Question::kClosest)] = slots;
  most[static_cast<int>(lit::Question::kOn)] = clear ? slots : 0;
  if ((effects & Effect::kSmoothNormals) == 0) {
    return;
  }
  // The rest is for the light on slopes.
  answers = static_cast<uint32_t>(lit::most_answers(effects, scene));
  lights = static_cast<uint32_t>(scene.lights.size);
  const bool shadows = (effects & Effect::kShadows) != 0;
  uint32_t suns = 0;
  for (size_t i = 0; shadows && i < scene.lights.size; ++i) {
    suns += scene.lights[i].is_point ? 0U : 1U;
  }
  const uint32_t lamps = shadows ? static_cast<uint32_t>(scene.lights.size) - suns : 0;
  const uint32_t around = (effects & Effect::kAmbientOcclusion) != 0 ? scene.occlusion.rays : 0U;
  most[static_cast<int>(lit::Question::kClosest)] = slots * (1 + (clear ? suns : 0));
  most[static_cast<int>(lit::Question::kAny)] = slots * (clear ? 0 : suns);
  most[static_cast<int>(lit::Question::kBefore)] = slots * lamps;
  most[static_cast<int>(lit::Question::kNear)] = slots * around;
  most[static_cast<int>(lit::Question::kAround)] = most_slopes * around;
  // A ray asks for a step of its own way, or for one towards each light.
  most[static_cast<int>(lit::Question::kOn)] = clear ? slots * std::max(1U, suns + lamps) : 0;
}

size_t StreamShape::bytes() const {
  return ArrayArena::bytes_of<StreamParts, FaceLightsParts>(*this, of_faces);
}

Stream::Stream(const lit::Frame& frame, const RayMap& map, const StreamShape& shape, Bytes bytes)
    : frame_(frame),
      asking_(frame),
      once_(frame),
      map_(map),
      shape_(shape),
      steps_(lit::steps_of(frame.effects)),
      is_clear_((frame.effects & (Effect::kGlass | Effect::kMedia)) != 0),
      is_wet_((frame.effects & Effect::kWater) != 0),
      is_smooth_((frame.effects & Effect::kSmoothNormals) != 0),
      is_open_beyond_((frame.effects & (Effect::kWater | Effect::kFog)) == 0),
      arena_(ArrayArena::laid_out(shape, bytes.data, &parts_)),
      misses_(frame, map, parts_.sky, shape.of_faces.faces),
      slopes_(frame, parts_.known_slopes, parts_.known_windows, shape.known_slopes),
      lights_(frame, map, shape.of_faces, &arena_) {
  frame_.questions = parts_.questions;
  asking_.questions = parts_.questions;
  frame_.slopes = parts_.slopes;
  frame_.once = &once_;
  asking_.once = &once_;
  const bool ends = (frame.effects & (Effect::kSmoothNormals | Effect::kDepthCue | Effect::kEdges)) == 0;
  for (uint32_t material = 0; material < 256; ++material) {
    const SurfaceKind kind = lit::surface_of(frame, static_cast<uint8_t>(material)).kind;
    ends_at_[material] = ends && (kind == SurfaceKind::kDiffuse || kind == SurfaceKind::kEmit);
  }
  const LitMedia media = lit_media(frame.effects, frame.scene);
  for (size_t i = 0; i < media.count; ++i) {
    is_clear_material_[media.materials[i]] = true;
  }
}

bool Stream::begin(uint32_t number, PixelReader* pixels) {
  while (pixels->row_is_done()) {
    if (!(is_open_beyond_ ? misses_.begin_row(pixels, &frame_.counts) : pixels->begin_row())) {
      return false;
    }
  }
  StreamSlot& slot = parts_.slots[number];
  lit::PendingRay first;
  pixels->take(&first.ray, &slot.at);
  slot.sum = {};
  slot.pending = 1;
  parts_.pending[size_t{number} * shape_.pending] = first;
  frame_.counts.rays[static_cast<int>(LitRayKind::kPrimary)] += 1;
  begin_ray(number, misses_.first_plane(slot.at).on(first.ray));
  return true;
}

void Stream::begin_step(uint32_t number, lit::AskedFrame* frame) {
  const uint32_t first = number * shape_.answers;
  StreamSlot& slot = parts_.slots[number];
  frame->begin(parts_.answers + first, first, slot.known, &slot.ray,
               parts_.lights + size_t{number} * shape_.lights);
}

void Stream::begin_ray(uint32_t number, const RayPoint& from) {
  StreamSlot& slot = parts_.slots[number];
  slot.ray.has_spot = false;
  slot.ray.has_lights = false;
  const Ray& ray = parts_.pending[size_t{number} * shape_.pending + slot.pending - 1].ray;
  // Finds what the ray will ask first, without asking yet; and what it begins in, which the map tells faster than the
  // tree.
  begin_step(number, &frame_);
  (void)frame_.look();
  uint8_t material = 0;
  slot.ray.has_begun = true;
  slot.ray.begins_in = {};
  if (is_clear_ && map_.material_at(starting_voxel(ray), &material) && is_clear_material_[material]) {
    slot.ray.begins_in = {lit::Medium::kSolid, material};
    frame_.note(lit::Question::kOn, ray, {}, material);
  } else {
    frame_.note(lit::Question::kClosest, ray, from);
  }
  slot.known = 1;
}

bool Stream::follow(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  lit::PendingRay* const pending = parts_.pending + size_t{number} * shape_.pending;
  // Takes the last ray first, as the core does.
  size_t count = slot.pending - 1;
  lit::Color sum;
  begin_step(number, &frame_);
  if (is_clear_ || is_wet_ || is_smooth_) {
    const LitCounts counts = frame_.counts;
    steps_.follow(frame_, pending[count], pending, &count, &sum);
    if (!frame_.is_answered()) {
      frame_.counts = counts;
      slot.known = frame_.asked;
      return false;
    }
  } else {
    steps_.follow(frame_, pending[count], pending, &count, &sum);
  }
  for (int i = 0; i < 3; ++i) {
    slot.sum.c[i] += sum.c[i];
  }
  slot.pending = count;
  slot.known = 0;
  frame_.counts.pending_high_water = std::max(frame_.counts.pending_high_water, static_cast<uint32_t>(count));
  return true;
}

bool Stream::shine(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  // What a step counts while it asks, it counts again with the answers: so asking_ takes the first counts.
  lit::AskedFrame& frame = slot.known == 0 ? asking_ : frame_;
  const bool may_wait = is_clear_ && slot.known != 0;
  const LitCounts counts = may_wait ? frame_.counts : LitCounts();
  lit::Color sum;
  begin_step(number, &frame);
  steps_.shine(frame, &sum);
  if (!frame.is_answered()) {
    if (may_wait) {
      frame_.counts = counts;
    }
    slot.known = frame.asked;
    return false;
  }
  for (int i = 0; i < 3; ++i) {
    slot.sum.c[i] += sum.c[i];
  }
  slot.ray.has_spot = false;
  return true;
}

void Stream::show_face(uint32_t number, const lit::Spot& spot, lit::Weight weight) {
  LitFace& face = lights_.faces()[face_count_];
  face.at = spot.at;
  face.pixel = number;
  face.face = static_cast<uint8_t>(2 * spot.face.axis + (spot.face.negative ? 0 : 1));
  face.face = static_cast<uint8_t>(face.face + (spot.inside ? FaceLights::kInside : 0U));
  parts_.shown[face_count_++] = {weight, spot.surface};
}

bool Stream::show_end(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  const Hit& hit = parts_.answers[size_t{number} * shape_.answers].hit;
  const bool is_hit = hit.kind == HitKind::kHit;
  if (slot.known != 1 || !is_open_beyond_ ||
      (is_hit && (!ends_at_[hit.material] || slot.ray.begins_in.kind != lit::Medium::kAir))) {
    return false;
  }
  const lit::PendingRay& ray = parts_.pending[size_t{number} * shape_.pending + --slot.pending];
  lit::count_result(frame_, ray.kind, hit.kind, hit.visits);
  slot.known = 0;
  if (is_hit) {
    lit::Meeting meeting;
    meeting.hit = hit;
    show_face(number, lit::spot_of(frame_, ray, meeting), ray.weight);
  } else {
    parts_.sky.put(beyond_count_, ray.ray.direction);
    parts_.beyond[beyond_count_++] = {ray.weight, number};
  }
  return true;
}

// Faces as lit::face_color does, the sky as lit::sky_color.
void Stream::light_up() {
  misses_.each_color(beyond_count_, [&](uint32_t i, const lit::Color& color) {
    lit::add(color, parts_.beyond[i].weight, &parts_.slots[parts_.beyond[i].pixel].sum);
  });
  beyond_count_ = 0;
  lights_.shine(face_count_);
  lit::Spot spot;
  for (uint32_t i = 0; i < face_count_; ++i) {
    const ShownFace& shown = parts_.shown[i];
    spot.surface = shown.surface;
    lit::Color color = lit::lit_color(spot, lights_.light()[i]);
    if ((frame_.effects & Effect::kEmission) != 0) {
      lit::add_emission(spot, &color);
    }
    lit::add(color, shown.weight, &parts_.slots[lights_.faces()[i].pixel].sum);
  }
  face_count_ = 0;
}

bool Stream::go_on(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  if (!slot.ray.has_spot && !show_end(number) && !follow(number)) {
    return false;
  }
  if (slot.ray.has_spot) {
    if (!slot.ray.has_slope) {
      show_face(number, slot.ray.spot, slot.ray.weight);
      slot.ray.has_spot = false;
    } else if (!shine(number)) {
      return false;
    }
  }
  if (slot.pending == 0) {
    return true;
  }
  begin_ray(number);
  return false;
}

void Stream::answer_slopes() {
  for (uint32_t i = 0; i < frame_.slope_count; ++i) {
    const lit::AskedSlope& slope = parts_.slopes[i];
    lit::Answer& answer = parts_.answers[slope.answer];
    answer.hit.visits = 0;
    answer.hit.voxel = slopes_.normal(slope.at, slope.face, slope.index_q12, &answer.hit.visits);
  }
  frame_.slope_count = 0;
}

void Stream::answer() {
  answer_slopes();
  answer_ways(map_, parts_.questions, parts_.hits, parts_.answers);
  // What is clear hides nothing. Where nothing is clear, materials do not matter.
  const Occlusion& occlusion = frame_.scene.occlusion;
  const auto find_within = [&](lit::Question question, const RayPoint& end) {
    lit::Asked& near = parts_.questions[static_cast<int>(question)];
    (void)first_hit_within(map_, {near.rays, near.count}, end, {parts_.hits, near.count}, is_clear_);
    put_hits(parts_.hits, &near, parts_.answers);
  };
  find_within(lit::Question::kNear, {occlusion.reach, kOcclusionLength});
  find_within(lit::Question::kAround, lit::slope_reach(occlusion));
  lit::Asked& any = parts_.questions[static_cast<int>(lit::Question::kAny)];
  (void)any_hit(map_, {any.rays, any.count}, {parts_.any, any.count});
  for (uint32_t i = 0; i < any.count; ++i) {
    lit::Answer& answer = parts_.answers[any.answer[i]];
    answer.hit.kind = parts_.any[i] != 0 ? HitKind::kHit : HitKind::kMiss;
    answer.hit.visits = 0;  // the call does not count these
  }
  any.count = 0;
}

LitCounts Stream::counts() const {
  LitCounts all = frame_.counts;
  lit::add_counts(once_.counts, &all);
  lit::add_counts(lights_.counts(), &all);
  return all;
}

void Stream::draw(PixelQueue* queue) {
  PixelReader pixels(queue);
  uint32_t waiting = 0;
  while (waiting < shape_.slots && begin(waiting, &pixels)) {
    parts_.waiting[waiting] = waiting;
    ++waiting;
  }
  answer();
  uint32_t done = 0;
  // The loop ends: each turn gives every waiting ray one more answer, and a pixel has a bounded number of rays.
  while (waiting != 0) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < waiting; ++i) {
      const uint32_t number = parts_.waiting[i];
      if (go_on(number)) {
        parts_.done[done++] = number;
      } else {
        parts_.waiting[left++] = number;
      }
    }
    // Light passes glass stretch by stretch: many faces at once keep the last stretches' vectors full.
    if (left == 0 || 4 * done >= 3 * shape_.slots ||
        std::max(face_count_, beyond_count_) + left > shape_.of_faces.faces) {
      light_up();
      for (uint32_t i = 0; i < done; ++i) {
        const uint32_t number = parts_.done[i];
        const StreamSlot& slot = parts_.slots[number];
        pixels.store(slot.at, slot.sum);
        if (begin(number, &pixels)) {
          parts_.waiting[left++] = number;
        }
      }
      done = 0;
    }
    answer();
    waiting = left;
  }
}

}  // namespace thimble::wide
