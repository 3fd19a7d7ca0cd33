#include "wide/lit/opaque_stream.h"

#include <algorithm>

namespace thimble::wide {
namespace {

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
  (void)first_unnamed_hit(map_, {parts_.rays, count}, {parts_.hits, count});
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
