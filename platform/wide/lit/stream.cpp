#include "wide/lit/stream.h"

#include <algorithm>

#include "thimble/light/optics.h"
#include "wide/lit/taker.h"

namespace thimble::wide {

void StreamParts::lay_out(const StreamShape& shape, uint8_t* at) {
  Taker taker(at);
  slots = taker.take<StreamSlot>(shape.slots);
  pending = taker.take<lit::PendingRay>(size_t{shape.slots} * shape.pending);
  lights = taker.take<lit::KnownLight>(size_t{shape.slots} * shape.lights);
  suns = taker.take<lit::KnownLight>(size_t{6} * shape.lights);
  answers = taker.take<lit::Answer>(size_t{shape.slots} * shape.answers);
  waiting = taker.take<uint32_t>(shape.slots);
  uint32_t most_hits = 0;
  for (int i = 0; i < lit::kQuestions; ++i) {
    const bool names =
        i != static_cast<int>(lit::Question::kAny) && i != static_cast<int>(lit::Question::kOn);
    most_hits = names ? std::max(most_hits, shape.most[i]) : most_hits;
    questions[i].rays = taker.take<Ray>(shape.most[i]);
    questions[i].answer = taker.take<uint32_t>(shape.most[i]);
    const bool is_on = i == static_cast<int>(lit::Question::kOn);
    const bool has_point = is_on || i == static_cast<int>(lit::Question::kBefore);
    questions[i].before = has_point ? taker.take<RayPoint>(shape.most[i]) : nullptr;
    questions[i].in = is_on ? taker.take<uint16_t>(shape.most[i]) : nullptr;
  }
  exits = taker.take<MediumExit>(shape.most[static_cast<int>(lit::Question::kOn)]);
  any = taker.take<uint8_t>(shape.most[static_cast<int>(lit::Question::kAny)]);
  hits = taker.take<Hit>(most_hits);
  bytes = taker.used();
}

StreamShape::StreamShape(EffectSet effects, const LitScene& scene, uint32_t slot_count)
    : slots(slot_count),
      pending(std::max(1U, static_cast<uint32_t>(lit::pending_rays(effects)))),
      answers(static_cast<uint32_t>(lit::most_answers(effects, scene))),
      lights(static_cast<uint32_t>(scene.lights.size)),
      most{} {
  const bool clear = (effects & (Effect::kGlass | Effect::kMedia)) != 0;
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
  // A step of its own way, or one of each light's.
  most[static_cast<int>(lit::Question::kOn)] = clear ? slots * std::max(1U, suns + lamps) : 0;
}

size_t StreamShape::bytes() const {
  StreamParts parts;
  parts.lay_out(*this, nullptr);
  return parts.bytes + Taker::kAlignment;
}

Stream::Stream(const lit::Frame& frame, const RayMap& map, const StreamShape& shape, Bytes bytes)
    : frame_(frame),
      asking_(frame),
      once_(frame),
      map_(map),
      shape_(shape),
      steps_(lit::steps_of(frame.effects)),
      is_clear_((frame.effects & (Effect::kGlass | Effect::kMedia)) != 0),
      is_wet_((frame.effects & Effect::kWater) != 0) {
  parts_.lay_out(shape, Taker::aligned(bytes.data));
  frame_.questions = parts_.questions;
  asking_.questions = parts_.questions;
  frame_.once = &once_;
  asking_.once = &once_;
  frame_.suns = parts_.suns;
  asking_.suns = parts_.suns;
}

bool Stream::begin(uint32_t number, PixelReader* pixels) {
  StreamSlot& slot = parts_.slots[number];
  lit::PendingRay first;
  if (!pixels->next(&first.ray, &slot.at)) {
    return false;
  }
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
  slot.ray.has_begun = false;
  slot.known = 0;
  if (!is_clear_) {
    // What it will ask first, without going there.
    begin_step(number, &frame_);
    (void)frame_.look();
    frame_.note(lit::Question::kClosest,
                parts_.pending[size_t{number} * shape_.pending + slot.pending - 1].ray, {});
    slot.known = 1;
  }
}

bool Stream::follow(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  lit::PendingRay* const pending = parts_.pending + size_t{number} * shape_.pending;
  // The last one first, as the core does.
  size_t count = slot.pending - 1;
  lit::Color sum;
  begin_step(number, &frame_);
  if (is_clear_ || is_wet_) {
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
  // What is counted while it asks is counted again with the answers.
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

bool Stream::go_on(uint32_t number) {
  StreamSlot& slot = parts_.slots[number];
  for (;;) {
    if (slot.ray.has_spot) {
      if (!shine(number)) {
        return false;
      }
    } else {
      if (!follow(number)) {
        return false;
      }
      if (slot.ray.has_spot) {
        continue;
      }
    }
    if (slot.pending == 0) {
      return true;
    }
    begin_ray(number);
    if (slot.known != 0) {
      return false;
    }
  }
}

void Stream::answer() {
  const auto asked = [&](lit::Question question) -> lit::Asked& {
    return parts_.questions[static_cast<int>(question)];
  };
  const auto put = [&](uint32_t number, const Hit& hit) {
    lit::Answer& answer = parts_.answers[number];
    answer.hit = hit;
    answer.into_solid = false;
  };
  // Rays were checked when they were asked, so none is refused.
  lit::Asked& closest = asked(lit::Question::kClosest);
  (void)first_hit(map_, {closest.rays, closest.count}, {parts_.hits, closest.count});
  for (uint32_t i = 0; i < closest.count; ++i) {
    put(closest.answer[i], parts_.hits[i]);
  }
  lit::Asked& before = asked(lit::Question::kBefore);
  (void)first_hit_before(map_, {before.rays, before.count}, {before.before, before.count},
                         {parts_.hits, before.count});
  for (uint32_t i = 0; i < before.count; ++i) {
    put(before.answer[i], parts_.hits[i]);
  }
  // What is clear hides nothing; where nothing is, the material does not matter.
  lit::Asked& near = asked(lit::Question::kNear);
  const Occlusion& occlusion = frame_.scene.occlusion;
  (void)first_hit_within(map_, {near.rays, near.count}, {occlusion.reach, kOcclusionLength},
                         {parts_.hits, near.count}, is_clear_);
  for (uint32_t i = 0; i < near.count; ++i) {
    put(near.answer[i], parts_.hits[i]);
  }
  static_assert(lit::kInNothing == kInAir);
  lit::Asked& on = asked(lit::Question::kOn);
  (void)first_change(map_, {on.rays, on.count}, {on.before, on.count}, {on.in, on.count},
                     {parts_.exits, on.count});
  for (uint32_t i = 0; i < on.count; ++i) {
    parts_.answers[on.answer[i]] = parts_.exits[i];
  }
  lit::Asked& any = asked(lit::Question::kAny);
  (void)any_hit(map_, {any.rays, any.count}, {parts_.any, any.count});
  for (uint32_t i = 0; i < any.count; ++i) {
    lit::Answer& answer = parts_.answers[any.answer[i]];
    answer.hit.kind = parts_.any[i] != 0 ? HitKind::kHit : HitKind::kMiss;
    answer.hit.visits = 0;  // which it does not tell
  }
  for (lit::Asked& one : parts_.questions) {
    one.count = 0;
  }
}

LitCounts Stream::counts() const {
  LitCounts all = frame_.counts;
  lit::add_counts(once_.counts, &all);
  return all;
}

void Stream::draw(PixelFlow* flow) {
  PixelReader pixels(flow);
  uint32_t waiting = 0;
  while (waiting < shape_.slots && begin(waiting, &pixels)) {
    parts_.waiting[waiting] = waiting;
    ++waiting;
  }
  answer();
  // It ends: each turn gives every ray that waits an answer more, and a pixel has a bounded number of rays.
  while (waiting != 0) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < waiting; ++i) {
      const uint32_t number = parts_.waiting[i];
      const StreamSlot& slot = parts_.slots[number];
      bool is_begun = true;
      while (is_begun && go_on(number)) {
        pixels.store(slot.at, slot.sum);
        is_begun = begin(number, &pixels);
        if (slot.known != 0) {
          break;
        }
      }
      if (is_begun) {
        parts_.waiting[left++] = number;
      }
    }
    answer();
    waiting = left;
  }
}

}  // namespace thimble::wide
