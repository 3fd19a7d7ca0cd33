/// @file scene_light.h
/// Light in the pictures of a baked scene: the effects that it was baked for, and no others.
///
/// In a firmware image the set is a constant (`THIMBLE_IMAGE_EFFECTS`, which platform/firmware.cmake reads
/// off the header that `thimble bake` made): the linker leaves out the rest, and with an empty set all of it.
/// On a desktop the scene comes with the command line, so the set is looked up there, and the library's own
/// renderers draw it. Both draw the same picture.
#ifndef THIMBLE_PLATFORM_APPS_SCENE_LIGHT_H
#define THIMBLE_PLATFORM_APPS_SCENE_LIGHT_H

#include "thimble/bake/baked_scene.h"
#include "thimble/light/baked_lighting.h"
#include "thimble/light/render.h"

namespace thimble::apps {

#ifdef THIMBLE_IMAGE_EFFECTS
inline constexpr EffectSet kImageEffects = THIMBLE_IMAGE_EFFECTS;
#else
inline constexpr EffectSet kImageEffects = Effect::kAll;
#endif
/// Whether there is anything of light in this program.
inline constexpr bool kCanLight = kImageEffects != Effect::kNone;

/// Whether a scene stands before black: it was baked for a display of few greys, this is one, and it has no sky.
constexpr bool is_dark_behind(EffectSet effects, PixelFormat format) {
  return (effects & Effect::kEdges) != 0 && (effects & Effect::kSky) == 0 && is_gray(format) &&
         format != PixelFormat::kGray8;
}

#if !defined(THIMBLE_IMAGE_EFFECTS) || THIMBLE_IMAGE_EFFECTS != 0

struct SceneLight {
  BakedLighting baked;
  /// The effects that are drawn; Effect::kNone: the scene was baked for none.
  EffectSet effects() const { return baked.effects; }
};

/// Opens what `scene` has. Null when all is well, also without any light; else an English phrase.
[[gnu::noinline]] inline const char* open_light(const BakedScene& scene, SceneLight* light) {
  const ConstBytes section = scene.section(SectionKind::kLighting);
  light->baked.effects = Effect::kNone;
  if (!section.empty() && BakedLighting::open(section, scene.tree().level(), &light->baked) != Status::kOk) {
    return "the scene's lighting is damaged";
  }
#ifdef THIMBLE_IMAGE_EFFECTS
  if (light->baked.effects != kImageEffects) {
    return "the image was built for other effects than the scene's";
  }
#endif
  return nullptr;
}

/// Draws a band with the scene's effects. What `render_lit_band` returns.
/// Not inlined: its rays are not to stand on the stack beside a fast frame.
[[gnu::noinline]] inline Status draw_lit(const BakedScene& scene, const Camera& camera,
                                         const Shading& shading, const SceneLight& light, const Band& band,
                                         LitCounts* counts = nullptr) {
#ifdef THIMBLE_IMAGE_EFFECTS
  return render_lit_band<kImageEffects>(scene.tree(), camera, shading, light.baked.scene, band, counts);
#else
  return render_lit_band(light.baked.effects, scene.tree(), camera, shading, light.baked.scene, band, counts);
#endif
}

#else

struct SceneLight {
  static constexpr EffectSet effects() { return Effect::kNone; }
};
inline const char* open_light(const BakedScene& /*scene*/, SceneLight* /*light*/) {
  return nullptr;
}
[[gnu::noinline]] inline Status draw_lit(const BakedScene& scene, const Camera& camera,
                                         const Shading& shading, const SceneLight& /*light*/,
                                         const Band& band, LitCounts* /*counts*/ = nullptr) {
  return render_band(scene.tree(), camera, shading, band);
}

#endif

}  // namespace thimble::apps

#endif
