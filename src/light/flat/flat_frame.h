// Draws lit frames by bricks: a pixel's light is that of its face and of the distant lights that reach it. Rays of the
// camera and to the lights go through the map; colours are looked up. Where a set has occlusion or lamps, each point
// gathers its light by rays of its own (point_lighting.h). ../README.md derives what is used. For flat.cpp alone.
#pragma once

#include "../arithmetic.h"
#include "thimble/light/map_render.h"

// As in brick_render.cpp.
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#pragma GCC optimize("O2", "rename-registers", "no-tree-loop-distribute-patterns")
#endif

#include "../../picture/bricks/face_light.h"
#include "../../picture/bricks/sight.h"
#include "mirror_rays.h"
#include "point_lighting.h"
#include "stored_colors.h"
#include "water_rays.h"

namespace thimble::lit {
namespace {

using namespace bricks;

// Few colours are kept where most points have a light of their own.
template <EffectSet kSet>
constexpr uint32_t kInks = kGathersLight<kSet> || kIsWet<kSet> ? 8
                           : kMirrors<kSet>                    ? 16
                                                               : 32;
// Voxels whose material is kept.
template <EffectSet kSet>
constexpr uint32_t kVoxels = kIsWet<kSet> || kSlots != 0 ? 32 : 64;
constexpr uint16_t kNoKey = UINT16_MAX;

// Shades and stores what SightPainter finds. kSecondary: rays leave its points, as they do from mirrors; in water a second
// sink sends them, for the pixels that the first has noted.
template <EffectSet kSet, bool kIsDeep = false, bool kSecondary = kMirrors<kSet>>
class FlatSink : StoredPixels,
                 PointLighting<kSet, kIsDeep, kSecondary>,
                 MirrorRays<kSet, FlatSink<kSet, kIsDeep, kSecondary>>,
                 WaterRays<kSet, FlatSink<kSet, kIsDeep, kSecondary>, kSecondary> {
  friend class MirrorRays<kSet, FlatSink<kSet, kIsDeep, kSecondary>>;
  friend struct MapFrame<FlatSink>;

 public:
  static constexpr bool kDeep = kIsDeep;

  FlatSink(Frame& frame, const BrickMap& map, const Band& band, size_t stride, bool counts)
      : StoredPixels(frame, band, stride),
        WaterRays<kSet, FlatSink<kSet, kDeep, kSecondary>, kSecondary>(frame, *this),
        map_(map),
        counts_(counts) {
    for (FlatInk& ink : inks_) {
      ink.key = kNoKey;
    }
    for (Seen& seen : seen_) {
      seen = ~Seen{0};
    }
    if (!has_sky()) {
      make_ink(background(frame), &sky_);
    }
  }

  void set_lights(Span<const SunBricks> suns) {
    if constexpr (kKeepsSuns) {
      this->begin(frame_, map_);
    }
    Spot spot;
    for (unsigned face = 0; face < 6; ++face) {
      lights_of_[face] = 0;
      spot.face = {static_cast<int>(face >> 1), (face & 1U) == 0};
      size_t lamps = 0;
      for (size_t number = 0; number < frame_.scene.lights.size; ++number) {
        const Light& light = frame_.scene.lights[number];
        if constexpr (kHasLamps) {
          if (light.is_point) {
            ++lamps;
            continue;
          }
        }
        const size_t i = number - lamps;
        LightRay ray;
        if (light_ray(light, spot, &ray)) {
          lights_of_[face] = static_cast<uint8_t>(lights_of_[face] | 1U << i);
          if constexpr (kKeepsSuns) {
            this->set_sun(i, face, ray);
          }
          if constexpr (kHasShadows) {
            const bool known = i < suns.size && suns[i].belongs_to(map_, light.place);
            suns_[i].set(map_, ray.ray.direction, known ? suns[i].bits() : nullptr);
          }
        }
      }
    }
  }

  void hit(int32_t x, int32_t y, const SightCourse<kDeep>& course, const Vec3<uint32_t>& d) {
    const unsigned face = course.face[course.landing.axis];
    unsigned lights = lights_of_[face];
    if constexpr (kIsWet<kSet>) {
      FacePoint point;
      find_face(course, &point);
      if (!this->is_dry(point, floor_q8())) {
        this->note(pixel_at(x, y), note_of(point));
        return;
      }
    }
    if constexpr (kMirrors<kSet>) {
      const uint8_t material = material_of(course.landing.voxel);
      if (mirrors(material)) {
        FacePoint point;
        find_point(course, d, &point);
        show_mirrored(x, y, course, d, point, material);
        return;
      }
    }
    if constexpr (kHasShadows) {
      FacePoint point;
      if constexpr (kGathers) {
        find_point(course, d, &point);
        lights = suns_at(lights, point);
        ++hits_;
        show_gathered(x, y, point, material_of(course.landing.voxel), face, lights);
        return;
      } else if (lights != 0) {
        find_place(course, d, &point);
        lights = suns_at(lights, course, point);
      }
    }
    ++hits_;
    store(x, y, ink_of_face(material_of(course.landing.voxel), face, lights));
  }

  // Not inlined, as ask: the loop over pixels has no registers for what few of them take.
  [[gnu::noinline]] void miss(int32_t x, int32_t y) {
    if constexpr (kIsWet<kSet>) {
      if (!this->is_dry(frame_.camera.ray(x, y).direction)) {
        this->note(pixel_at(x, y), kNothing);
        return;
      }
    }
    ++misses_;
    if (has_sky()) {
      lit::store(frame_, band_, line_of(y), x, y, beyond(frame_.camera.ray(x, y).direction));
    } else {
      store(x, y, sky_);
    }
  }

  // Draws the pixels of a tile that show a face.
  void face(const SeenPixels& seen, SeenFace& face) {
    const unsigned side = seen.course.face[face.point.axis];
    if constexpr (kIsWet<kSet>) {
      if (!this->is_dry(face.point, floor_q8())) {
        for_each(seen.place, seen.pixels,
                 [&](int32_t x, int32_t y, uint32_t) { this->note(pixel_at(x, y), note_of(face.point)); });
        return;
      }
    }
    const uint8_t material = material_of(face.voxel);
    if constexpr (kMirrors<kSet>) {
      if (mirrors(material)) {
        for_each(seen.place, seen.pixels, [&](int32_t x, int32_t y, uint32_t pixel) {
          const Vec3<uint32_t> d = seen.direction(pixel);
          find_point(seen.course, d, &face);
          show_mirrored(x, y, seen.course, d, face.point, material);
        });
        return;
      }
    }
    unsigned lights = lights_of_[side];
    unsigned open = 0;  // lights that may reach a part of it
    if constexpr (kHasShadows) {
      // A few points are sooner traced than the face.
      const uint32_t columns = seen.pixels.columns();
      const uint32_t others = columns & (columns - 1);
      const bool is_small = (others & (others - 1)) == 0;
      for (size_t i = 0; i < kMaxFlatSuns; ++i) {
        if ((lights >> i & 1U) != 0) {
          Blockers<kDeep>& blockers = blockers_[kSlots != 0 ? i : 0];
          blockers.count = Blockers<kDeep>::kMost + 1;
          const FaceLight light =
              is_small ? FaceLight::kMixed : light_of_face(suns_[i], face.point, &blockers);
          lights &= ~(light == FaceLight::kDark ? 1U << i : 0U);
          open |= light == FaceLight::kMixed ? 1U << i : 0U;
          if (counts_ && light != FaceLight::kMixed) {
            const uint32_t rays = count_of(seen.pixels);
            shadow_rays_ += rays;
            shadows_ += light == FaceLight::kDark ? rays : 0;
          }
        }
      }
    }
    if (counts_) {
      hits_ += count_of(seen.pixels);
    }
    if (!kGathers && open == 0) {
      store(seen.place, seen.pixels, ink_of_face(material, side, lights));
    } else {
      store_points(seen, face, material, lights, open);
    }
  }

  void miss(const TilePlace& place, const Pixels& pixels) {
    if (!kIsWet<kSet> && !has_sky()) {
      misses_ += counts_ ? count_of(pixels) : 0;
      store(place, pixels, sky_);
    } else {
      for_each(place, pixels, [&](int32_t x, int32_t y, uint32_t) { miss(x, y); });
    }
  }

  [[gnu::noinline]] void ask(int32_t x, int32_t y) {
    const uint32_t pixel = pixel_at(x, y);
    asked_[pixel >> 5] |= 1U << (pixel & 31U);
  }

  void set_asked(const uint32_t (&asked)[kAskedWords]) {
    for (int i = 0; i < kAskedWords; ++i) {
      asked_[i] = asked[i];
    }
  }
  // Hands over the ties of a tile; returns whether there are any.
  bool take_asked(uint32_t (*asked)[kAskedWords]) {
    uint32_t any = 0;
    for (int i = 0; i < kAskedWords; ++i) {
      (*asked)[i] = asked_[i];
      any |= asked_[i];
      asked_[i] = 0;
    }
    return any != 0;
  }

  void count(LitCounts* counts) const {
    constexpr int kPrimary = static_cast<int>(LitRayKind::kPrimary);
    constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
    counts->rays[kPrimary] += hits_ + misses_;
    counts->hits[kPrimary] += hits_;
    counts->rays[kShadow] += shadow_rays_;
    counts->hits[kShadow] += shadows_;
    if constexpr (kKeepsSuns) {
      this->add_counts(counts);
    }
    if constexpr (kMirrors<kSet>) {
      this->add_mirror_counts(counts);
    }
  }

  // Sets where notes are made.
  template <class Progress>
  void note_in(Progress* progress) {
    if constexpr (kIsWet<kSet>) {
      this->set_notes(progress->notes);
    }
  }
  // Draws the notes of the tile at (x0, y0); defers ties.
  void draw_noted(int32_t x0, int32_t y0, const WetNotes& notes, LitCounts* counts) {
    for (int32_t pixel = 0; pixel < kTileAcrossPx * kTileDownPx; ++pixel) {
      const uint32_t note = notes.of[pixel];
      if (note == 0) {
        continue;
      }
      const int32_t x = x0 + pixel % kTileAcrossPx;
      const int32_t y = y0 + pixel / kTileAcrossPx;
      const uint32_t shadow_rays = shadow_rays_;
      const uint32_t shadows = shadows_;
      Color color;
      if (this->find_wet(frame_.camera.ray(x, y), note, &color)) {
        if (counts != nullptr) {
          lit::add_counts(this->wet_counts(), counts);
        }
        lit::store(frame_, band_, line_of(y), x, y, color);
      } else {
        shadow_rays_ = shadow_rays;
        shadows_ = shadows;
        ask(x, y);
      }
    }
  }

 private:
  static constexpr bool kHasShadows = (kSet & Effect::kShadows) != 0;
  static constexpr bool kHasLamps = (kSet & kLamps) != 0;
  static constexpr bool kGathers = kGathersLight<kSet>;
  static constexpr bool kKeepsSuns = PointLighting<kSet, kDeep, kSecondary>::kKeepsSuns;

  // The suns of `lights` that reach a point, ray by ray; `point` is what is_shadowed takes.
  template <class... Point>
  [[gnu::always_inline]] unsigned suns_at(unsigned lights, const Point&... point) {
#pragma GCC unroll 1
    for (size_t i = 0; i < kMaxFlatSuns; ++i) {
      if ((lights >> i & 1U) != 0) {
        ++shadow_rays_;
        if (is_shadowed(suns_[i], point...)) {
          lights &= ~(1U << i);
          ++shadows_;
        }
      }
    }
    return lights;
  }

  // Draws the points of a face; the lights in `open` may reach some. Those that the same lights reach are stored together.
  [[gnu::noinline]] void store_points(const SeenPixels& seen, SeenFace& face, uint8_t material,
                                      unsigned lights, unsigned open) {
    const unsigned side = seen.course.face[face.point.axis];
    Pixels reached[kGathers ? 1 : 1 << kMaxFlatSuns] = {};
    for_each(seen.place, seen.pixels, [&](int32_t x, int32_t y, uint32_t pixel) {
      find_point(seen.course, seen.direction(pixel), &face);
      unsigned reach = lights;
      for (size_t i = 0; i < kMaxFlatSuns; ++i) {
        if ((open >> i & 1U) != 0) {
          ++shadow_rays_;
          const size_t sun = kHasShadows && kSlots != 0 ? i : 0;
          if (blockers_[sun].count <= Blockers<kDeep>::kMost
                  ? is_blocked(suns_[sun], blockers_[sun], face.point)
                  : is_shadowed(suns_[sun], face.point)) {
            reach &= ~(1U << i);
            ++shadows_;
          }
        }
      }
      if constexpr (kGathers) {
        show_gathered(x, y, face.point, material, side, reach);
      } else {
        reached[reach].word[pixel >> 5] |= 1U << (pixel & 31U);
      }
    });
    for (unsigned reach = 0; !kGathers && reach <= lights; ++reach) {
      if (reached[reach].columns() != 0) {
        store(seen.place, reached[reach], ink_of_face(material, side, reach));
      }
    }
  }

  // Stores a point lit by secondary rays; the suns of `reach` shine on it.
  [[gnu::noinline]] void show_gathered(int32_t x, int32_t y, const FacePoint& point, uint8_t material,
                                       unsigned side, unsigned reach) {
    Spot spot;
    spot.face = {static_cast<int>(side >> 1), (side & 1U) == 0};
    Color light;
    if (!this->gather(frame_, map_, point, reach, &spot, &light)) {
      store(x, y, ink_of_face(material, side, reach));
      return;
    }
    spot.surface = surface_of(frame_, material);
    FlatInk ink;
    make_ink(shown_by(spot, light), &ink);
    store(x, y, ink);
  }

  bool mirrors(uint8_t material) const {
    const Span<const Surface>& surfaces = frame_.scene.surfaces;
    return material < surfaces.size && is_mirror(surfaces[material]) && frame_.scene.bounces != 0;
  }

  // The direction of a ray of the camera that is `d` mirrored.
  static Vec3i direction_of(const Course& course, const Vec3<uint32_t>& d) {
    Vec3i direction;
    for (int i = 0; i < 3; ++i) {
      const auto size = static_cast<int32_t>(d[i]);
      direction[i] = course.flip[i] != 0 ? -size : size;
    }
    return direction;
  }
  static uint32_t pixel_at(int32_t x, int32_t y) {
    return static_cast<uint32_t>(kTileAcrossPx * (y % kTileDownPx) + x % kTileAcrossPx);
  }
  // Where the box begins along z, in 1/256 voxel.
  int32_t floor_q8() const {
    return 4 * Q8::kOne * map_.box().low.z;
  }

  // For MapFrame.
  template <class WetFrame>
  [[gnu::noinline]] Color point_color(WetFrame& frame, const Spot& spot, const FacePoint& point) {
    Color light;
    ambient_light(frame_, spot, &light);
    this->add_suns_in_water(frame, spot, suns_at(lights_of_[side_of(point)], point), &light);
    return shown_by(spot, light);
  }

  // Stores a point of a metal, which the ray of direction `d` meets.
  [[gnu::noinline]] void show_mirrored(int32_t x, int32_t y, const Course& course, const Vec3<uint32_t>& d,
                                       const FacePoint& point, uint8_t material) {
    const Vec3i arriving = direction_of(course, d);
    const auto counted = this->counted();
    const uint32_t shadow_rays = shadow_rays_;
    const uint32_t shadows = shadows_;
    Color sum;
    if (!this->add_mirrored(frame_, point, material, arriving, &sum)) {
      this->set_counted(counted);
      shadow_rays_ = shadow_rays;
      shadows_ = shadows;
      ask(x, y);
      return;
    }
    ++hits_;
    FlatInk ink;
    make_ink(sum, &ink);
    store(x, y, ink);
  }

  // For MirrorRays.
  [[gnu::noinline]] Color point_color(const FacePoint& point, const Surface& surface) {
    Spot spot;
    spot.face = face_of(point);
    Color light;
    this->gather(frame_, map_, point, suns_at(lights_of_[side_of(point)], point), &spot, &light);
    spot.surface = surface;
    return shown_by(spot, light);
  }
  Color beyond(const Vec3i& direction) const {
    if constexpr ((kSet & Effect::kSky) != 0) {
      if (has_sky()) {
        return sky_color(frame_, direction);
      }
    }
    return background(frame_);
  }
  bool has_sky() const {
    return has<kSet, Effect::kSky>(frame_);
  }

  // A voxel has 22 bits, of level 9 and 10 29: its place in the table says the lower ones, the entry keeps the others beside
  // the material.
  using Seen = Choose<kDeep, uint64_t, uint32_t>;
  static_assert(kMaxDeepBricks <= uint32_t{1} << 23);
  [[gnu::always_inline]] uint8_t material_of(uint32_t voxel) {
    const Seen rest = voxel / kVoxels<kSet>;
    Seen& seen = seen_[(voxel ^ rest) % kVoxels<kSet>];
    if (seen >> 8 != rest) {
      seen = rest << 8 | map_.material(frame_.tree, voxel >> 6, voxel & 63U);
    }
    return static_cast<uint8_t>(seen);
  }
  [[gnu::always_inline]] const FlatInk& ink_of_face(uint8_t material, unsigned face, unsigned lights) {
    const uint32_t key = uint32_t{material} << 5 | face << 2 | lights;
    FlatInk& ink = inks_[(key ^ key >> 5) % kInks<kSet>];
    if (seldom(ink.key != key)) {
      look_up(material, face, lights, &ink);
      ink.key = static_cast<uint16_t>(key);
    }
    return ink;
  }
  [[gnu::noinline]] void look_up(uint8_t material, unsigned face, unsigned lights, FlatInk* ink) {
    make_ink(face_color(material, face, lights), ink);
  }

  // The colour of a face of a material in the light of `lights`.
  Color face_color(uint8_t material, unsigned face, unsigned lights) const {
    Spot spot;
    spot.face = {static_cast<int>(face >> 1), (face & 1U) == 0};
    spot.surface = surface_of(frame_, material);
    Color light;
    if constexpr (kKeepsSuns) {
      this->light_of_face(frame_, spot, lights, &light);
    } else {
      add_lights(spot, lights, &light);
    }
    return shown_by(spot, light);
  }
  [[gnu::always_inline]] Color shown_by(const Spot& spot, const Color& light) const {
    Color color = lit_color(spot, light);
    if constexpr ((kSet & Effect::kEmission) != 0) {
      if (has<kSet, Effect::kEmission>(frame_)) {
        add_emission(spot, &color);
      }
    }
    return color;
  }
  void add_lights(const Spot& spot, unsigned lights, Color* light) const {
    ambient_light(frame_, spot, light);
    for (size_t i = 0; i < frame_.scene.lights.size; ++i) {
      LightRay ray;
      if ((lights >> i & 1U) != 0 && light_ray(frame_.scene.lights[i], spot, &ray)) {
        add_light(ray, light);
      }
    }
  }

  const BrickMap& map_;
  bool counts_;  // counts the rays of faces that are drawn as a whole, too
  uint8_t lights_of_[6];
  // A camera that draws_fast has less than 2^23 pixels, each of at most 32 rays of occlusion, or of 100 to lights.
  uint32_t hits_ = 0;
  uint32_t misses_ = 0;
  uint32_t shadow_rays_ = 0;
  uint32_t shadows_ = 0;
  uint32_t asked_[kAskedWords] = {};
  FlatInk sky_;
  static constexpr bool kFindsFaces = !(kSecondary && kIsWet<kSet>);
  FlatInk inks_[kFindsFaces ? kInks<kSet> : 1];
  Seen seen_[kFindsFaces ? kVoxels<kSet> : 1];
  ShadowCourse<kDeep> suns_[kHasShadows ? kMaxFlatSuns : 1];
  // Of the face that is being drawn.
  Blockers<kDeep> blockers_[kHasShadows && kSlots != 0 && kFindsFaces ? kMaxFlatSuns : 1];
};

bool shares_bytes(PixelFormat format) {
  return format == PixelFormat::kMono1 || format == PixelFormat::kGray4 || format > PixelFormat::kRgb888;
}

// Draws tiles up to the first with deferred pixels. Not inlined, so that its frame has left the stack when the tree
// traces them.
template <EffectSet kSet, bool kDeep>
[[gnu::noinline]] void draw_tiles(Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                                  const Band& band, size_t stride, ProgressOf<kSet>* progress,
                                  LitCounts* counts) {
  FlatSink<kSet, kDeep> sink(frame, map, band, stride, counts != nullptr);
  sink.note_in(progress);
  sink.set_lights(suns);
  const BrickFrame sights = brick_frame<kDeep>(frame.tree, map, frame.camera, frame.shading, band.format);
  Sweep sweep;
  sweep.begin(map);
  const bool swept = kSlots != 0 && set_steps(frame.camera, &sweep) && !touches_solid<kDeep>(sights);
  SightPainter<FlatSink<kSet, kDeep>> painter(sights, swept ? &sweep : nullptr, sink);
  const int32_t width = frame.camera.width_px();
  const int32_t end = band.first_row + band.rows;
  for (bool open = false; progress->y < end && !open;) {
    const int32_t x = progress->x;
    const int32_t y = progress->y;
    const int32_t tile_end = (y / kTileDownPx + 1) * kTileDownPx;
    const bool last = x + kTileAcrossPx >= width;
    painter.draw_tile({x, last ? width : x + kTileAcrossPx, y, tile_end < end ? tile_end : end});
    progress->x = last ? 0 : x + kTileAcrossPx;
    progress->y = last ? tile_end : y;
    open = sink.take_asked(&progress->asked);
    if constexpr (kIsWet<kSet>) {
      open = open || progress->notes->any;
    }
  }
  if (counts != nullptr) {
    sink.count(counts);
  }
}

// Draws the notes of the tile before.
template <EffectSet kSet>
[[gnu::noinline]] void draw_noted(Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                                  const Band& band, size_t stride, WetProgress* progress, LitCounts* counts) {
  FlatSink<kSet, false, true> sink(frame, map, band, stride, counts != nullptr);
  sink.set_lights(suns);
  sink.set_asked(progress->asked);
  const bool first = progress->x == 0;
  const int32_t y = first ? progress->y - 1 : progress->y;
  const int32_t x = (first ? frame.camera.width_px() - 1 : progress->x - 1) / kTileAcrossPx * kTileAcrossPx;
  sink.draw_noted(x, y - y % kTileDownPx, *progress->notes, counts);
  sink.take_asked(&progress->asked);
  frame.counts = {};  // they were those of single pixels
  if (counts != nullptr) {
    sink.count(counts);
  }
}

// Draws tiles up to the first with deferred pixels, those of rays that come to water included. Not inlined, so that its
// notes have left the stack when the tree traces ties.
template <EffectSet kSet>
[[gnu::noinline]] void draw_wet_tiles(Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                                      const Band& band, size_t stride, WetProgress* progress,
                                      LitCounts* counts) {
  WetNotes notes;
  progress->notes = &notes;
  draw_tiles<kSet, false>(frame, map, suns, band, stride, progress, counts);
  if (notes.any) {
    draw_noted<kSet>(frame, map, suns, band, stride, progress, counts);
  }
}

// Draws the ties of the tile at (x, y) by the tree.
template <EffectSet kSet>
[[gnu::noinline]] void draw_asked(const Frame& of, const Band& band, size_t stride, int32_t x, int32_t y,
                                  const FlatProgress& progress, LitCounts* counts) {
  Frame frame = of;
  for (int32_t pixel = 0; pixel < kTileAcrossPx * kTileDownPx; ++pixel) {
    if ((progress.asked[pixel >> 5] >> (pixel & 31) & 1U) != 0) {
      const int32_t px = x + pixel % kTileAcrossPx;
      const int32_t py = y - y % kTileDownPx + pixel / kTileAcrossPx;
      store(frame, band, line_of(band, stride, py), px, py,
            lit::pixel<kSet & ~kLamps>(frame, frame.camera.ray(px, py)));
    }
  }
  if (counts != nullptr) {
    add_counts(frame.counts, counts);
  }
}

}  // namespace

template <EffectSet kSet>
Status draw_flat(Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                 LitCounts* counts) {
  size_t stride = 0;
  const Status status = check_frame(frame, band, &stride);
  if (status != Status::kOk) {
    return status;
  }
  const int32_t end = band.first_row + band.rows;
  for (int32_t y = band.first_row; y < end && shares_bytes(band.format); ++y) {
    if (begins_bytes(band.format, y - band.first_row)) {
      clear_row(frame, band, line_of(band, stride, y));
    }
  }
  ProgressOf<kSet> progress{};
  progress.y = band.first_row;
  while (progress.y < end) {
    if constexpr (kIsWet<kSet>) {
      draw_wet_tiles<kSet>(frame, map, suns, band, stride, &progress, counts);
    } else if (DeepMap::is_deep(map.level())) {
      draw_tiles<kSet, kDeepWorlds>(frame, map, suns, band, stride, &progress, counts);
    } else {
      draw_tiles<kSet, false>(frame, map, suns, band, stride, &progress, counts);
    }
    if ((progress.asked[0] | progress.asked[1] | progress.asked[2] | progress.asked[3]) == 0) {
      continue;
    }
    const int32_t width = frame.camera.width_px();
    const bool first = progress.x == 0;
    draw_asked<kSet>(frame, band, stride,
                     first ? (width - 1) / kTileAcrossPx * kTileAcrossPx : progress.x - kTileAcrossPx,
                     first ? progress.y - 1 : progress.y, progress, counts);
  }
  return Status::kOk;
}

}  // namespace thimble::lit
