#include "wide/lit/stream.h"

#include <algorithm>

#include "thimble/light/host/optics.h"

namespace thimble::wide {
namespace {

// So many faces' slopes are kept for each pixel under way: together those of some rows.
constexpr uint32_t kSlopesASlot = 2;

constexpr EffectSet kOpaque = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                              Effect::kEmission | Effect::kSky | Effect::kEmitterLight;

uint32_t channel_of(const Rgb8& color, int channel) {
  return channel == 0 ? color.r : channel == 1 ? color.g : color.b;
}

// The whole part of a quotient of integers; the dividend is below 2^52 and the divisor below 2^21, so a double is off
// by less than what separates the quotient from the next whole number.
int64_t whole_quotient(int64_t dividend, int64_t divisor) {
  return static_cast<int64_t>(static_cast<double>(dividend) / static_cast<double>(divisor));
}

}  // namespace

void StreamParts::lay_out(const StreamShape& shape, ArrayArena* arena) {
  slots = arena->take<StreamSlot>(shape.slots);
  pending = arena->take<lit::PendingRay>(size_t{shape.slots} * shape.pending);
  lights = arena->take<lit::KnownLight>(size_t{shape.slots} * shape.lights);
  answers = arena->take<lit::Answer>(size_t{shape.slots} * shape.answers);
  waiting = arena->take<uint32_t>(shape.slots);
  uint32_t most_hits = 0;
  for (int i = 0; i < lit::kQuestions; ++i) {
    const bool names =
        i != static_cast<int>(lit::Question::kAny) && i != static_cast<int>(lit::Question::kOn);
    most_hits = names ? std::max(most_hits, shape.most[i]) : most_hits;
    questions[i].rays = arena->take<Ray>(shape.most[i]);
    questions[i].answer = arena->take<uint32_t>(shape.most[i]);
    const bool is_on = i == static_cast<int>(lit::Question::kOn);
    const bool has_point = is_on || i == static_cast<int>(lit::Question::kBefore);
    questions[i].before = has_point ? arena->take<RayPoint>(shape.most[i]) : nullptr;
    questions[i].in = is_on ? arena->take<uint16_t>(shape.most[i]) : nullptr;
  }
  slopes = arena->take<lit::AskedSlope>(shape.most_slopes);
  known_slopes = arena->take<KnownSlope>(shape.known_slopes);
  known_windows = arena->take<KnownWindow>(shape.known_slopes / 4);
  exits = arena->take<MediumExit>(shape.most[static_cast<int>(lit::Question::kOn)]);
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
  begin_ray(number);
  return true;
}

void Stream::begin_step(uint32_t number, lit::AskedFrame* frame) {
  const uint32_t first = number * shape_.answers;
  StreamSlot& slot = parts_.slots[number];
  frame->begin(parts_.answers + first, first, slot.known, &slot.ray,
               parts_.lights + size_t{number} * shape_.lights);
}

void Stream::begin_ray(uint32_t number) {
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
    frame_.note(lit::Question::kClosest, ray, {});
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

void Stream::show_face(uint32_t number) {
  lit::KnownRay& ray = parts_.slots[number].ray;
  const lit::Spot& spot = ray.spot;
  LitFace& face = lights_.faces()[face_count_];
  face.at = spot.at;
  face.pixel = number;
  face.face = static_cast<uint8_t>(2 * spot.face.axis + (spot.face.negative ? 0 : 1));
  face.face = static_cast<uint8_t>(face.face + (spot.inside ? FaceLights::kInside : 0U));
  parts_.shown[face_count_++] = {ray.weight, spot.surface};
  ray.has_spot = false;
}

bool Stream::show_beyond(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  const Hit& hit = parts_.answers[size_t{number} * shape_.answers].hit;
  if (!is_open_beyond_ || slot.known != 1 || hit.kind != HitKind::kMiss) {
    return false;
  }
  const lit::PendingRay& ray = parts_.pending[size_t{number} * shape_.pending + --slot.pending];
  lit::count_result(frame_, ray.kind, hit.kind, hit.visits);
  parts_.sky.put(beyond_count_, ray.ray.direction);
  parts_.beyond[beyond_count_++] = {ray.weight, number};
  slot.known = 0;
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
  if (!slot.ray.has_spot && !show_beyond(number) && !follow(number)) {
    return false;
  }
  if (slot.ray.has_spot) {
    if (!slot.ray.has_slope) {
      show_face(number);
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
  answer_ways(map_, parts_.questions, parts_.hits, parts_.exits, parts_.answers);
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

bool is_opaque(EffectSet effects) {
  return (effects & ~kOpaque) == 0;
}

OpaqueShape::OpaqueShape(EffectSet effects, const LitScene& scene, uint32_t slot_count)
    : slots(slot_count), lights(effects, scene, slot_count) {}

size_t OpaqueShape::bytes() const {
  return ArrayArena::bytes_of<OpaqueParts, FaceLightsParts>(*this, lights);
}

void OpaqueParts::lay_out(const OpaqueShape& shape, ArrayArena* arena) {
  const size_t slots = shape.slots;
  rays = arena->take<Ray>(slots);
  from = arena->take<RayPoint>(slots);
  hits = arena->take<Hit>(slots);
  beyond = arena->take<uint32_t>(slots);
  sky.lay_out(shape.slots, arena);
  colors = arena->take<lit::Color>(slots);
  places = arena->take<PixelSlot>(slots);
}

OpaqueStream::OpaqueStream(const lit::Frame& frame, const RayMap& map, const OpaqueShape& shape, Bytes bytes)
    : frame_(frame),
      map_(map),
      shape_(shape),
      arena_(ArrayArena::laid_out(shape, bytes.data, &parts_)),
      misses_(frame, map, parts_.sky, shape.slots),
      lights_(frame, map, shape.lights, &arena_) {
  for (uint32_t material = 0; material < 256; ++material) {
    const Surface surface = lit::surface_of(frame, static_cast<uint8_t>(material));
    const bool shines = (frame.effects & Effect::kEmission) != 0 && surface.kind == SurfaceKind::kEmit;
    for (int i = 0; i < 3; ++i) {
      paints_[material].albedo[i] = channel_of(surface.albedo, i);
      paints_[material].emission[i] =
          shines ? channel_of(surface.albedo, i) * uint32_t{surface.emission_q8} / (256 / lit::kLevel) : 0;
    }
  }
}

LitCounts OpaqueStream::counts() const {
  LitCounts all = frame_.counts;
  lit::add_counts(lights_.counts(), &all);
  return all;
}

// Does as lit::spot_of for voxels that a ray enters through one face only.
LitFace OpaqueStream::face_of_hit(uint32_t pixel) {
  const Ray& ray = parts_.rays[pixel];
  const Hit& hit = parts_.hits[pixel];
  LitFace face;
  face.pixel = pixel;
  face.material = unnamed_material(map_, hit);
  bool is_plain = hit.axis >= 0;
  if (is_plain) {
    const int axis = int{hit.axis};
    const int64_t speed = ray.direction[axis] < 0 ? -ray.direction[axis] : ray.direction[axis];
    const int64_t way = hit.t_numerator;
    const int32_t side = Q8::kOne << hit.block_level;
    face.at[axis] = Q8::from_raw(hit.voxel[axis] * Q8::kOne + (ray.direction[axis] > 0 ? 0 : side));
    face.face = static_cast<uint8_t>(2 * axis + (ray.direction[axis] > 0 ? 0 : 1));
    for (int turn = 1; turn < 3; ++turn) {
      const int other = axis + turn < 3 ? axis + turn : axis + turn - 3;
      const int64_t direction = ray.direction[other];
      const int32_t low = hit.voxel[other] * Q8::kOne;
      // The offset from the lower plane, times the speed.
      const int64_t offset = (ray.origin[other].raw - low) * speed + way * direction;
      const int64_t steps = whole_quotient(offset, speed);
      face.at[other] = Q8::from_raw(
          low + static_cast<int32_t>(std::clamp(steps, int64_t{0}, static_cast<int64_t>(side) - 1)));
      // The ray enters through a second face where it comes to that face's plane at the same t: at an offset of 0, or
      // of the side.
      is_plain = is_plain && (direction == 0 || offset != (direction > 0 ? 0 : side * speed));
    }
  }
  if (!is_plain) {
    lit::PendingRay now;
    now.ray = ray;
    lit::Meeting meeting;
    meeting.found = meeting.opaque = true;
    meeting.hit = hit;
    const lit::Spot spot = lit::spot_of(frame_, now, meeting);
    face.at = spot.at;
    face.face = static_cast<uint8_t>(2 * spot.face.axis + (spot.face.negative ? 0 : 1));
    face.face = static_cast<uint8_t>(face.face + (spot.inside ? FaceLights::kInside : 0U));
  }
  return face;
}

// lit::sky_color, or the background, of the rays that met nothing.
void OpaqueStream::show_beyond(uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    parts_.sky.put(i, parts_.rays[parts_.beyond[i]].direction);
  }
  misses_.each_color(count,
                     [&](uint32_t i, const lit::Color& color) { parts_.colors[parts_.beyond[i]] = color; });
}

void OpaqueStream::find_faces(uint32_t count) {
  constexpr int kPrimary = static_cast<int>(LitRayKind::kPrimary);
  face_count_ = 0;
  uint32_t beyond = 0;
  uint64_t visits = 0;
  for (uint32_t pixel = 0; pixel < count; ++pixel) {
    visits += parts_.hits[pixel].visits;
    if (parts_.hits[pixel].kind == HitKind::kHit) {
      lights_.faces()[face_count_++] = face_of_hit(pixel);
    } else {
      parts_.beyond[beyond++] = pixel;
    }
  }
  show_beyond(beyond);
  frame_.counts.rays[kPrimary] += count;
  frame_.counts.hits[kPrimary] += face_count_;
  frame_.counts.node_visits[kPrimary] += visits;
}

// Does as lit::lit_color and lit::add_emission.
void OpaqueStream::paint() {
  for (uint32_t i = 0; i < face_count_; ++i) {
    const LitFace& face = lights_.faces()[i];
    const lit::Color& light = lights_.light()[i];
    const Paint& paint = paints_[face.material];
    lit::Color& color = parts_.colors[face.pixel];
    for (int c = 0; c < 3; ++c) {
      constexpr uint32_t kPart = lit::kFullLight / lit::kLevel;
      const uint32_t strength = std::min<uint32_t>(light.c[c], UINT16_MAX);
      const uint32_t lit = std::min((paint.albedo[c] * strength + kPart / 2) / kPart, lit::kMaxChannel);
      color.c[c] = std::min(lit + paint.emission[c], lit::kMaxChannel);
    }
  }
}

// Finds the colours of the first `count` rays.
void OpaqueStream::light_up(uint32_t count) {
  (void)first_unnamed_hit(map_, {parts_.rays, count}, {parts_.from, count}, {parts_.hits, count});
  find_faces(count);
  lights_.shine(face_count_);
  paint();
}

void OpaqueStream::draw(PixelQueue* queue) {
  PixelReader pixels(queue);
  for (;;) {
    uint32_t count = 0;
    while (count < shape_.slots && (!pixels.row_is_done() || misses_.begin_row(&pixels, &frame_.counts))) {
      for (; count < shape_.slots && !pixels.row_is_done(); ++count) {
        pixels.take(&parts_.rays[count], &parts_.places[count]);
        parts_.from[count] = misses_.first_plane(parts_.places[count]).on(parts_.rays[count]);
      }
    }
    if (count == 0) {
      return;
    }
    light_up(count);
    for (uint32_t i = 0; i < count; ++i) {
      pixels.store(parts_.places[i], parts_.colors[i]);
    }
  }
}

}  // namespace thimble::wide
