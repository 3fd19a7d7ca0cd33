// Ripples: the surface of the water is bent by waves that are too small for its columns, and shows the sun.
#include "../../base/integers.h"
#include "boundary.h"

namespace thimble::lit {
namespace {

// sin(2 pi i / 64) * 127, a quarter.
constexpr int8_t kQuarterWave[17] = {0,  12,  25,  37,  49,  60,  71,  81, 90,
                                     98, 106, 112, 117, 122, 125, 126, 127};

// cos(turn / 256 of a turn) * 127, straight between the table's places.
int32_t cosine_127(uint32_t turn) {
  const uint32_t shifted = (turn + 64U) & 255U;
  const uint32_t half = shifted & 127U;
  const uint32_t place = half <= 64U ? half : 128U - half;
  // The numbers of a table, not letters. NOLINTNEXTLINE(bugprone-signed-char-misuse)
  const int32_t low = kQuarterWave[place >> 2];
  // NOLINTNEXTLINE(bugprone-signed-char-misuse)
  const int32_t high = kQuarterWave[place < 64U ? (place >> 2) + 1 : 16];
  const int32_t value = low + (high - low) * static_cast<int32_t>(place & 3U) / 4;
  return shifted >= 128U ? -value : value;
}

// A wave runs along (x, y) and has a crest every 64 / |(x, y)| voxels: 3 to 14. `runs` of them pass while the phase
// comes round. At its steepest its slope is 127 * steep * |(x, y)| / 8, in 2^-14: 1.5 to 2.5 degrees.
struct Ripple {
  int8_t x;
  int8_t y;
  int8_t runs;
  uint8_t steep;
};
constexpr Ripple kRipples[] = {{4, 2, 1, 9}, {-6, 9, -3, 4}, {5, -14, 4, 3}, {16, 12, -5, 2}};

// The normal of the surface with its ripples, not of unit length.
Vec3i rippled_normal(const Frame& frame, const Vec3Q8& at) {
  Vec3i normal = water_normal(frame.scene.water, at.x, at.y);
  int32_t before = 0;  // each wave shifts the next by up to half a turn, so that no crest is straight
  for (const Ripple& ripple : kRipples) {
    const int32_t along = (ripple.x * at.x.raw + ripple.y * at.y.raw) >> 6;  // 5 bits by 21
    const uint32_t turn =
        static_cast<uint32_t>(along) + static_cast<uint32_t>(int32_t{ripple.runs} * frame.scene.ripple_phase);
    const int32_t wave = cosine_127(turn + static_cast<uint32_t>(before));
    before = wave;
    const int32_t slope = wave * ripple.steep;  // below 2^11
    normal.x -= slope * ripple.x / 8;
    normal.y -= slope * ripple.y / 8;
  }
  return normal;
}

uint32_t water_index(const Frame& frame) {
  return static_cast<uint32_t>(
      clamped(int32_t{frame.scene.water_material.index_q12}, kMinIndexQ12, kMaxIndexQ12));
}

}  // namespace

bool cross_ripples(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                   size_t* count) {
  const bool is_wet = leg->medium.kind == Medium::kWaterBody;
  const uint32_t index = water_index(frame);
  const Vec3i unit = unit_q14(now->ray.direction);
  const Vec3i normal = unit_q14(rippled_normal(frame, meeting.at));
  const int32_t along = dot_q14(unit, normal);
  // What comes to the surface or to a ripple from behind meets the water as it
  // is without ripples.
  if (meeting.hit.axis != 2 || index == kOneQ12 || now->bounces >= frame.scene.bounces ||
      (now->ray.direction.z < 0) == is_wet || (along < 0) == is_wet) {
    return cross(frame, now, leg, meeting, pending, count);
  }
  const uint32_t here = is_wet ? index : kOneQ12;
  const uint32_t there = is_wet ? kOneQ12 : index;
  const Split split = split_at(unit, normal, here, there);
  for (int part = 0; part < (split.back == kOneQ16 ? 1 : 2); ++part) {
    const bool back = part == 0;
    const Vec3i direction =
        back ? turned_from(split.reflected, 2, !is_wet) : turned_from(split.refracted, 2, is_wet);
    const Vec3Q8 start = beside_surface(frame.scene.water, meeting.at, direction, is_wet == back);
    send_share(frame, *now, LitRayKind::kWaterRay, 2, {start, direction},
               back ? split.back : kOneQ16 - split.back, pending, count);
  }
  return false;
}

Color sun_glint(const Frame& frame, const Vec3i& direction) {
  constexpr int32_t kRim = 16260;   // 7 degrees from its middle
  constexpr uint32_t kGlare = 16;   // as many times as bright as what it lights
  constexpr uint32_t kMost = 1024;  // 256 = 1
  const Vec3i unit = unit_q14(direction);
  Color glint;
  for (const Light& light : frame.scene.lights) {
    const int32_t within = light.is_point ? 0 : dot_q14(unit, unit_q14(light.place)) - kRim;
    if (within <= 0) {
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const uint32_t strength = light.color_q8[i];
      glint.c[i] += (strength < kMost ? strength : kMost) * kGlare * static_cast<uint32_t>(within) / 2;
    }
  }
  for (uint32_t& channel : glint.c) {
    channel = channel < kMaxChannel ? channel : kMaxChannel;
  }
  return glint;
}

}  // namespace thimble::lit
