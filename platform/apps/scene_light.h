/// Light in the pictures of a baked scene: the effects that it was baked for, and no others.
///
/// In a firmware image the set is a constant (`THIMBLE_IMAGE_EFFECTS`, which platform/firmware.cmake reads
/// off the header that `thimble bake` made): the linker leaves out the rest, and with an empty set all of it. An image that
/// is there before its scene (`THIMBLE_SCENE_IN_FLASH`, platform/images) draws every set within that constant.
/// On a desktop the scene comes with the command line, so the set is looked up there, and the library's own
/// renderers draw it. Both draw the same picture. Where the effects allow it and there is a brick map, frames are fast
/// enough to move in (map_render.h).
#pragma once

#include "apps/shown_scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/light/map_render.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"

namespace thimble::apps {

/// The most effects that this program draws, and whether lamps go through the brick map.
#ifdef THIMBLE_IMAGE_EFFECTS
inline constexpr EffectSet kImageEffects = THIMBLE_IMAGE_EFFECTS;
inline constexpr bool kImageLamps = THIMBLE_IMAGE_LAMPS != 0;
#else
inline constexpr EffectSet kImageEffects = Effect::kAll;
inline constexpr bool kImageLamps = true;
#endif
/// Whether the set is the scene's, within `kImageEffects`.
#if !defined(THIMBLE_IMAGE_EFFECTS) || defined(THIMBLE_SCENE_IN_FLASH)
inline constexpr bool kIsOpen = true;
#else
inline constexpr bool kIsOpen = false;
#endif
/// Whether there is anything of light in this program.
inline constexpr bool kCanLight = kImageEffects != Effect::kNone;
/// Whether this program draws a scene that was baked for `effects`; on a desktop any.
constexpr bool is_for([[maybe_unused]] EffectSet effects) {
#if !defined(THIMBLE_IMAGE_EFFECTS)
  return true;
#elif defined(THIMBLE_SCENE_IN_FLASH)
  return lies_within(effects, kImageEffects);
#else
  return effects == kImageEffects;
#endif
}
/// The effects of frames while the camera moves, where these are fast: all but what asks the tree for each pixel.
constexpr EffectSet moving_effects(EffectSet effects) {
  return effects & ~Effect::kEdges;
}
/// Whether its lit frames may go through the brick map. THIMBLE_WATER_BY_TREE: those with water do not
/// (platform/frames.cmake).
#if defined(THIMBLE_WATER_BY_TREE)
inline constexpr bool kWaterByMap = false;
#else
inline constexpr bool kWaterByMap = true;
#endif
inline constexpr bool kLightsFast = kIsOpen || (is_flat(moving_effects(kImageEffects)) &&
                                                (kWaterByMap || (kImageEffects & Effect::kWater) == 0));

/// Whether a scene stands before black: it was baked for a display of few greys, this is one, and it has no sky.
constexpr bool is_dark_behind(EffectSet effects, PixelFormat format) {
  return (effects & Effect::kEdges) != 0 && (effects & Effect::kSky) == 0 && is_gray(format) &&
         format != PixelFormat::kGray8;
}

#if !defined(THIMBLE_IMAGE_EFFECTS) || THIMBLE_IMAGE_EFFECTS != 0

struct SceneLight {
  BakedLighting baked;
  SunBricks suns[kLightsFast ? kMaxFlatSuns : 1];
  bool is_fast = false;  ///< `draw_lit_scene` draws moving frames by the map
  /// The effects that are drawn; Effect::kNone: the scene was baked for none.
  EffectSet effects() const { return baked.effects; }
  /// Frames that move have all of the effects.
  bool moves_whole() const { return is_fast && moving_effects(baked.effects) == baked.effects; }
};

/// Opens what `scene` has. Null when all is well, also without any light; else an English phrase.
[[gnu::noinline]] inline const char* open_light(const BakedScene& scene, SceneLight* light) {
  const ConstBytes section = scene.section(SectionKind::kLighting);
  light->baked.effects = Effect::kNone;
  if (!section.empty() && BakedLighting::open(section, scene.tree().level(), &light->baked) != Status::kOk) {
    return "the scene's lighting is damaged";
  }
  if (!is_for(light->baked.effects)) {
    return "the image was built for other effects than the scene's";
  }
  return nullptr;
}

/// Draws a band with the scene's effects. What `render_lit_band` returns.
/// Not inlined: its rays are not to stand on the stack beside a fast frame.
[[gnu::noinline]] inline Status draw_lit(const BakedScene& scene, const Camera& camera,
                                         const Shading& shading, const SceneLight& light, const Band& band) {
#if defined(THIMBLE_SCENE_IN_FLASH)
  return render_lit_band_within<kImageEffects>(light.baked.effects, scene.tree(), camera, shading,
                                               light.baked.scene, band);
#elif defined(THIMBLE_IMAGE_EFFECTS)
  return render_lit_band<kImageEffects>(scene.tree(), camera, shading, light.baked.scene, band);
#else
  return render_lit_band(light.baked.effects, scene.tree(), camera, shading, light.baked.scene, band);
#endif
}

/// Looks whether frames go through the map, and proves in bytes of the arena which bricks its lights reach freely, as
/// far as these hold that: without it frames are slower, and the same.
[[gnu::noinline]] inline void prove_light(const ShownScene& shown, Arena* arena, SceneLight* light) {
  if constexpr (kLightsFast) {
    const Span<const Light>& lights = light->baked.scene.lights;
    // Those of an image are its scene's, or `open_light` refuses that.
    const EffectSet effects = kIsOpen ? light->effects() : kImageEffects;
    const bool has_shadows = (effects & Effect::kShadows) != 0;
    const bool has_way_to_lamps = kImageLamps && takes_lamps(effects);
    size_t suns = 0;
    light->is_fast = shown.has_map && is_flat(moving_effects(effects)) &&
                     (!kIsOpen || kWaterByMap || (effects & Effect::kWater) == 0);
    for (const Light& one : lights) {
      light->is_fast = light->is_fast && (one.is_point ? has_way_to_lamps : ++suns <= kMaxFlatSuns);
    }
    suns = 0;
    for (const Light& one : lights) {
      if (light->is_fast && has_shadows && !one.is_point) {
        const Bytes room = arena->take(SunBricks::bytes(shown.map));
        SunBricks& sun = light->suns[suns++];
        if (SunBricks::make(shown.map, one.place, room, &sun) == Status::kOk) {
          sun.prove();
        }
      }
    }
  }
}

/// As `draw_lit`, by the map where that is faster; `moves`: with `moving_effects` alone where that is.
[[gnu::noinline]] inline Status draw_lit_scene(const ShownScene& shown, const Camera& camera,
                                               const Shading& shading, const SceneLight& light,
                                               const Band& band, bool moves) {
  if constexpr (kLightsFast) {
    if (light.is_fast && (moves || light.moves_whole())) {
#if defined(THIMBLE_SCENE_IN_FLASH)
      constexpr bool kHasWater = kWaterByMap && (kImageEffects & Effect::kWater) != 0;
      return render_lit_band_within<kImageEffects, kHasWater>(
          moving_effects(light.baked.effects), shown.scene.tree(), shown.map, camera, shading,
          light.baked.scene, {light.suns, kMaxFlatSuns}, band);
#elif defined(THIMBLE_IMAGE_EFFECTS)
      return render_lit_band<moving_effects(kImageEffects), kImageLamps>(shown.scene.tree(), shown.map,
                                                                         camera, shading, light.baked.scene,
                                                                         {light.suns, kMaxFlatSuns}, band);
#elif !defined(THIMBLE_NO_MAP_LIGHT)
      return render_lit_band(moving_effects(light.effects()), shown.scene.tree(), shown.map, camera, shading,
                             light.baked.scene, {light.suns, kMaxFlatSuns}, band);
#else  // a port for which so many more renderers are too much: the same pixels, ray by ray
      return render_lit_band(moving_effects(light.effects()), shown.scene.tree(), camera, shading,
                             light.baked.scene, band);
#endif
    }
  }
  return draw_lit(shown.scene, camera, shading, light, band);
}

#else

struct SceneLight {
  static constexpr bool is_fast = false;
  static constexpr bool moves_whole() { return false; }
  static constexpr EffectSet effects() { return Effect::kNone; }
};
inline const char* open_light(const BakedScene& /*scene*/, SceneLight* /*light*/) {
  return nullptr;
}
[[gnu::noinline]] inline Status draw_lit(const BakedScene& scene, const Camera& camera,
                                         const Shading& shading, const SceneLight& /*light*/,
                                         const Band& band) {
  return render_band(scene.tree(), camera, shading, band);
}
inline void prove_light(const ShownScene& /*shown*/, Arena* /*arena*/, SceneLight* /*light*/) {}
inline Status draw_lit_scene(const ShownScene& shown, const Camera& camera, const Shading& shading,
                             const SceneLight& light, const Band& band, bool /*moves*/) {
  return draw_lit(shown.scene, camera, shading, light, band);
}

#endif

}  // namespace thimble::apps
