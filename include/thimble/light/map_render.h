/// @file map_render.h
/// The pictures of render.h for chips that draw frames: a compact tree with a brick map beside it.
///
/// The pixels are those of `render_lit_band` for the tree, bit for bit, whatever the set, camera, scene and band.
/// Where the light of a pixel is a function of the face that it shows, of the lights that reach it and of what
/// occludes it, or a sum of such by way of mirrors or water (a set that `is_flat`, at most kMaxFlatSuns distant lights,
/// a camera that `draws_fast`, no water in worlds above level 8, no limit of visits), all rays go through the map; everything
/// else is drawn by the tree. An image has the first way only when its set allows it, and lamps there only when it says that it
/// has any.
///
/// Cost of the fast way: platform/README.md, "Light on a chip". Stack: tests/budgets/stack.csv.
#ifndef THIMBLE_LIGHT_MAP_RENDER_H
#define THIMBLE_LIGHT_MAP_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../picture/render.h"
#include "../tree/brick_map.h"
#include "render.h"

namespace thimble {

class EditedWorld;

/// The bricks of a map from which nothing is in the way to a distant light, a bit each, so that most shadow rays end
/// after a few voxels. Above level 8 a byte for each cell of a plane across the light's rays, as wide as a brick: behind which
/// layer of bricks they meet nothing. The bytes and the map outlive it.
///
///     SunBricks sun;
///     const Bytes bytes = arena.take(SunBricks::bytes(map));
///     SunBricks::make(map, scene.lights[0].place, bytes, &sun); sun.prove();
///
/// In a world that is edited, each frame:
///
///     world.edit(...); sun.follow(world, 4096); world.forget_changes();
class SunBricks {
 public:
  SunBricks() = default;

  /// Bytes that `make` takes: a bit a brick of the map's box, 512 for a full world of 64; above level 8 the product of two
  /// sides in bricks, each with a third one and 1: 66,049 for a full world of 512, 263,169 for one of 1,024.
  static size_t bytes(const BrickMap& map);

  /// Makes bits of which none is proven yet, which is never wrong. `towards` is as `Light::place` of a distant light.
  /// Errors, `*sun` as it was: kOutOfMemory; kBadArgument for no direction or no map.
  static Status make(const BrickMap& map, const Vec3i& towards, Bytes room, SunBricks* sun);

  /// Proves for up to `bricks` more bricks whether anything solid lies behind them towards the light: for all at
  /// once, or for a few at a time where a light moves. Returns whether any are left. Cost: some ten instructions for
  /// each brick that lies behind another, up to the first that is not empty; some millions in a world of 64. Above level 8
  /// it is a byte in place of a brick, some thousand instructions each; 300 millions in an edited world of 1,024.
  bool prove(uint32_t bricks = UINT32_MAX);

  /// Withdraws what the edits since it was made or last followed may have made wrong, then proves up to `bricks` more
  /// bricks, those that were not proven yet and those behind an edit. Returns whether any are left. Until it is called an
  /// edited world's bits belong to no map, so that a frame does without them. Withdrawing clears at most each bit once:
  /// some ten instructions a brick behind what `world.changed()` holds; above level 8 it raises a byte for each brick's side
  /// that the light sees of that. Bits that are behind by more than that, or those of another world, are withdrawn altogether, or
  /// left alone.
  bool follow(const EditedWorld& world, uint32_t bricks);

  /// Whether these bits are those of this map as it is now, which has not been opened anew, and of a distant light there.
  bool belongs_to(const BrickMap& map, const Vec3i& towards) const {
    return bits_ != nullptr && directory_ == map.directory() && stamp_ == map.stamp() && towards_ == towards;
  }
  /// A bit a brick, in the directory's order, the lowest of a byte first; above level 8 a byte as above.
  const uint8_t* bits() const { return bits_; }

 private:
  struct Way;

  bool is_free(const Vec3i& brick) const;
  void prove_cell(uint32_t cell);
  void set_deep();
  void lower(uint32_t cell);
  template <class Each>
  void each_in_row(const Way& way, const VoxelBox& box, int32_t row, uint32_t first, const Each& each) const;
  template <class Each>
  void each_behind(const Way& way, const VoxelBox& box, int32_t layer, uint32_t first,
                   const Each& each) const;

  uint8_t* bits_ = nullptr;
  const uint8_t* directory_ = nullptr;
  Vec3i towards_;
  Vec3i side_;
  uint32_t done_ = 0;
  uint32_t cells_ = 0;
  uint32_t stamp_ = 0;
  VoxelBox edited_;           // bricks, behind which some have to be proven again
  uint32_t layers_left_ = 0;  // of these, the one that was begun, and how many of its bricks are done
  int32_t layer_ = 0;
  uint32_t in_layer_ = 0;
  bool is_deep_ = false;  // of level 9 and 10 layers are rows of the plane
};

/// Whether a set has the fast way: direct light alone, or with shadows and any of emission, sky, and either occlusion and
/// mirrors or water and its ripples.
constexpr bool is_flat(EffectSet effects) {
  constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;
  constexpr EffectSet kMore = Effect::kAmbientOcclusion | Effect::kEmission | Effect::kMirror | Effect::kSky;
  constexpr EffectSet kWet = Effect::kEmission | Effect::kSky | Effect::kRipples;
  effects &= ~Effect::kEmitterLight;
  return effects == Effect::kDirectLight || (effects & ~kMore) == kSun ||
         (effects & ~kWet) == (kSun | Effect::kWater);
}
/// Whether the fast way of such a set takes lamps: else the tree draws scenes that have any.
constexpr bool takes_lamps(EffectSet effects) {
  return (effects & Effect::kShadows) != 0 && (effects & Effect::kWater) == 0;
}
/// Distant lights that the fast way takes.
inline constexpr size_t kMaxFlatSuns = 2;

namespace lit {

/// In a set of the fast way: lamps, too. The bit is that of the effect that calls for them and has no code of its own.
inline constexpr EffectSet kLamps = Effect::kEmitterLight;

/// The specialisations of `draw_flat`, in src/light/flat; those of suns alone send no rays but to them.
#define THIMBLE_FLAT_SUNS(DO) DO(0x001) DO(0x003) DO(0x20B)
#define THIMBLE_FLAT_SETS(DO) \
  THIMBLE_FLAT_SUNS(DO)       \
  DO(0x20F) DO(0x120B) DO(0x120F) DO(0x013) DO(0x21F) DO(0x121F) DO(0x28B) DO(0x428B)

/// The specialisation that draws a set which `is_flat`. Emission and the sky cost a test where a set leaves them out, as
/// does occlusion beside mirrors; the sun alone, and the sun with mirrors, have none of their code.
constexpr EffectSet flat_specialisation(EffectSet set) {
  if ((set & ~(Effect::kShadows | Effect::kMirror)) == Effect::kDirectLight) {
    return set;
  }
  return set | Effect::kEmission | Effect::kSky |
         ((set & Effect::kMirror) != 0 ? Effect::kAmbientOcclusion : Effect::kNone);
}

/// The specialisation that draws every set within kMost which `is_flat` and is dry; kMost has kDirectLight and kShadows.
template <EffectSet kMost>
inline constexpr EffectSet kFlatWithin =
    flat_specialisation(kMost&(Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                               Effect::kEmission | Effect::kMirror | Effect::kSky));

/// Whether the fast way takes the frame, whose set `is_flat`.
bool draws_flat(const Frame& frame, const BrickMap& map);
/// Draws the band where `draws_flat`; kSet is the specialisation of the frame's set. `suns` has what is proven of the
/// distant lights, in their order; it may be empty. An entry that does not belong to its light is not looked at. The
/// frame's counts are 0, and are so again at the end.
template <EffectSet kSet>
Status draw_flat(Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                 LitCounts* counts);

}  // namespace lit

/// As `render_lit_band` (render.h) with `map`, which belongs to `tree`. `suns` (may be empty) has what is proven of
/// each distant light of the scene, in their order. `kHasLamps`: lamps go through the map, too; without it a scene with
/// any is drawn by the tree. The counters of nodes stay as they are for rays that read none; rays to lamps and of
/// occlusion hit nothing that is more than a voxel behind the lamp or beyond the reach; no ray of a mirror is pending; a metal
/// all of whose light is mirrored sends no rays to lights and none of occlusion; and of water only columns are counted that
/// a ray may come to.
/// Errors, with nothing drawn: those of render.h, and kDamaged when the map is another tree's.
template <EffectSet kEffects, bool kHasLamps = (kEffects & Effect::kEmitterLight) != 0>
[[gnu::always_inline]] inline Status render_lit_band(const CompactTree& tree, const BrickMap& map,
                                                     const Camera& camera, const Shading& shading,
                                                     const LitScene& scene, Span<const SunBricks> suns,
                                                     const Band& band, LitCounts* counts = nullptr,
                                                     const LitOptions& options = {}) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  if constexpr (is_flat(kEffects)) {
    constexpr bool kTakesLamps = kHasLamps && takes_lamps(kEffects);
    constexpr EffectSet kSet =
        (kEffects & ~Effect::kEmitterLight) | (kTakesLamps ? lit::kLamps : Effect::kNone);
    lit::Frame frame{tree, camera, shading, scene, options, kSet};
    if (lit::draws_flat(frame, map)) {
      return lit::draw_flat<lit::flat_specialisation(kSet)>(frame, map, suns, band, counts);
    }
  }
  return render_lit_band<kEffects>(tree, camera, shading, scene, band, counts, options);
}

/// The same for a set that `lies_within` kMost (render.h); lamps go through the map where the scene has any. `kHasWater`:
/// water does, too.
template <EffectSet kMost, bool kHasWater>
inline Status render_lit_band_within(EffectSet effects, const CompactTree& tree, const BrickMap& map,
                                     const Camera& camera, const Shading& shading, const LitScene& scene,
                                     Span<const SunBricks> suns, const Band& band,
                                     LitCounts* counts = nullptr) {
  constexpr EffectSet kDry = lit::kFlatWithin<kMost>;
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  const bool is_wet = (effects & Effect::kWater) != 0;
  if (lies_within(effects, kMost) && is_flat(effects) && (kHasWater || !is_wet)) {
    bool has_lamps = false;
    for (const Light& light : scene.lights) {
      has_lamps = has_lamps || (light.is_point && takes_lamps(effects));
    }
    const LitOptions options;
    const EffectSet set = (effects & ~lit::kLamps) | (has_lamps ? lit::kLamps : Effect::kNone);
    lit::Frame frame{tree, camera, shading, scene, options, set};
    if (lit::draws_flat(frame, map)) {
      if constexpr (kHasWater) {
        if (is_wet) {
          return lit::draw_flat<0x428B>(frame, map, suns, band, counts);
        }
      }
      return has_lamps ? lit::draw_flat<kDry | lit::kLamps>(frame, map, suns, band, counts)
                       : lit::draw_flat<kDry>(frame, map, suns, band, counts);
    }
  }
  return render_lit_band_within<kMost>(effects, tree, camera, shading, scene, band, counts);
}

/// The same with a set that is known only now, as that of render.h; an image that does not call it holds nothing of it.
Status render_lit_band(EffectSet effects, const CompactTree& tree, const BrickMap& map, const Camera& camera,
                       const Shading& shading, const LitScene& scene, Span<const SunBricks> suns,
                       const Band& band, LitCounts* counts = nullptr, const LitOptions& options = {});

}  // namespace thimble

#endif
