#include "instruments/effects_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "boards/effect_flash.h"
#include "output/tables.h"
#include "scene/built_scene.h"

namespace thimble::tools {
namespace {

// "material 3 is metal", "materials 3, glow, 7 are glass"; at most four of them.
std::string materials(const LitDescription& lit, const UsedMaterials& used, SurfaceKind kind,
                      const std::string& what, const std::string& none) {
  constexpr std::size_t kMostNamed = 4;
  std::size_t count = 0;
  std::string names;
  for (std::size_t i = 0; i < lit.surfaces.size(); ++i) {
    if (!used.is[i] || lit.surfaces[i].kind != kind) {
      continue;
    }
    if (++count <= kMostNamed) {
      names += (names.empty() ? "" : ", ") + lit.name_of(static_cast<std::uint8_t>(i));
    }
  }
  if (count == 0) {
    return none;
  }
  if (count > kMostNamed) {
    names += " and " + std::to_string(count - kMostNamed) + " more";
  }
  return (count == 1 ? "material " : "materials ") + names + (count == 1 ? " is " : " are ") + what;
}

std::string lights(const LitDescription& lit) {
  const auto points = static_cast<std::size_t>(
      std::count_if(lit.lights.begin(), lit.lights.end(), [](const Light& light) { return light.is_point; }));
  const std::size_t distant = lit.lights.size() - points;
  const auto counted = [](std::size_t number, const std::string& name) {
    return number == 0 ? std::string() : std::to_string(number) + " " + name + (number == 1 ? "" : "s");
  };
  const std::string suns = counted(distant, "distant light");
  const std::string lamps = counted(points, "lamp");
  return suns + (suns.empty() || lamps.empty() ? "" : ", ") + lamps;
}

// Why the scene is drawn with `effect`, in a few words.
std::string why_effect(const LitDescription& lit, const UsedMaterials& used, EffectSet effect) {
  if ((called_for(lit, used) & effect) == 0) {
    return "asked for";
  }
  std::string named = "the scene names it";
  const LitScene& rest = lit.rest;
  switch (effect) {
    case Effect::kDirectLight:
      return lit.lights.empty() ? named : lights(lit);
    case Effect::kShadows:
      return rest.has_shadows ? "its lights cast shadows" : named;
    case Effect::kAmbientOcclusion:
      return rest.occlusion.rays == 0 ? named
                                      : std::to_string(rest.occlusion.rays) + " rays a face, " +
                                            std::to_string(rest.occlusion.reach) + " voxels far";
    case Effect::kEmission:
    case Effect::kEmitterLight:
      return materials(lit, used, SurfaceKind::kEmit, "emissive", named);
    case Effect::kMirror:
      return materials(lit, used, SurfaceKind::kMetal, "metal", named);
    case thimble::Effect::kGlass:
      return materials(lit, used, SurfaceKind::kGlass, "clear", named);
    case thimble::Effect::kMedia:
      return materials(lit, used, SurfaceKind::kMedia, "cloud", named);
    case thimble::Effect::kWater:
      return rest.has_water ? "water of " + std::to_string(rest.water.width) + " x " +
                                  std::to_string(rest.water.depth) + " columns"
                            : named;
    case Effect::kFog:
      return rest.fog.density_q16 == 0
                 ? named
                 : "air that halves light in " + fixed(65536.0 / rest.fog.density_q16, 0) + " voxels";
    case Effect::kSky:
      return rest.has_sky ? "a sky behind it" : named;
    case Effect::kDepthCue:
      return rest.has_depth_cue ? "far is darker" : named;
    default:  // smooth normals, edges and ripples
      return named;
  }
}

// Milliseconds and counts of frames with one set of effects.
struct Variant {
  LitScene scene;
  LitCounts counts;
  std::vector<double> ms;
};

class EffectsStudio {
 public:
  EffectsStudio(const SceneSource& source, const BuiltScene& built, const EffectsOptions& options,
                std::string* note)
      : built_(built),
        lit_(options.effects.lighting(source.lighting())),
        used_(used_materials(built.compact())),
        framing_(frame_scene(options.view, source, built.level(), built.bounds())),
        camera_(framing_.camera) {
    lit_.find_glow(built.compact());
    *note = framing_.note;
    shading_ = scene_shading(ShadeMode::kColor, {built.palette().data(), built.palette().size()}, camera_,
                             built.bounds());
    pixels_.resize(band_bytes(PixelFormat::kRgb888, camera_.width_px(), camera_.height_px()));
  }

  const LitDescription& lit() const { return lit_; }
  const UsedMaterials& used() const { return used_; }

  void add(EffectSet effects) { variants_[effects].scene = lit_scene_for(lit_, used_, effects); }
  const Variant& of(EffectSet effects) const { return variants_.at(effects); }

  // Every set once a round, each round beginning with another, so that what else the machine does, and what
  // the frame before left in its caches, meets all alike. The first round only warms up.
  void draw(int frames, const Progress& progress) {
    std::vector<std::pair<const EffectSet, Variant>*> order;
    for (auto& variant : variants_) {
      order.push_back(&variant);
    }
    const auto steps = static_cast<double>(order.size()) * (frames + 1);
    double done = 0;
    for (int round = 0; round <= frames; ++round) {
      for (auto* const variant : order) {
        draw_frame(variant->first, &variant->second);
        if (round == 0) {
          variant->second.ms.clear();
        }
        if (progress) {
          progress(++done / steps);
        }
      }
      std::rotate(order.begin(), order.begin() + 1, order.end());
    }
  }

 private:
  void draw_frame(EffectSet effects, Variant* variant) {
    Band band;
    band.pixels = {pixels_.data(), pixels_.size()};
    band.rows = camera_.height_px();
    variant->counts = {};
    const FrameWatch watch;
    const Status status =
        render_lit_band(effects, built_.compact(), camera_, shading_, variant->scene, band, &variant->counts);
    variant->ms.push_back(watch.ms());
    if (status != Status::kOk) {
      throw InputError("its lights or surfaces are beyond the limits of a lit picture");
    }
  }

  const BuiltScene& built_;
  LitDescription lit_;
  UsedMaterials used_;
  Framing framing_;
  const Camera& camera_;
  Shading shading_;
  std::vector<std::uint8_t> pixels_;
  std::map<EffectSet, Variant> variants_;
};

std::int64_t difference(std::uint64_t with, std::uint64_t without) {
  return static_cast<std::int64_t>(with) - static_cast<std::int64_t>(without);
}

// A set without effects that trace on: nothing but what every lit picture keeps.
constexpr std::size_t kBaseRamBytes = lit_render_bytes(Effect::kSky) - render_bytes();

void fill(const EffectsStudio& studio, EffectRow* row) {
  const Variant& with = studio.of(row->with);
  const Variant& without = studio.of(row->without);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    row->rays[static_cast<std::size_t>(kind)] = difference(with.counts.rays[kind], without.counts.rays[kind]);
    row->node_visits += difference(with.counts.node_visits[kind], without.counts.node_visits[kind]);
  }
  std::vector<double> more;
  for (std::size_t frame = 0; frame < with.ms.size(); ++frame) {
    more.push_back(with.ms[frame] - without.ms[frame]);
  }
  row->with_ms = quantile(with.ms, 0.5);
  row->without_ms = quantile(without.ms, 0.5);
  row->set_times(more);
  row->ram_bytes = lit_state_bytes(with.scene, row->with) - lit_state_bytes(without.scene, row->without) -
                   (row->without == Effect::kNone ? kBaseRamBytes : 0);
  for (const EffectFlash& flash : kEffectFlash) {
    row->flash_bytes += flash.effect == row->effect ? flash.bytes : 0;
  }
}

}  // namespace

std::int64_t EffectRow::all_rays() const {
  std::int64_t sum = 0;
  for (const std::int64_t number : rays) {
    sum += number;
  }
  return sum;
}

EffectsStudy study_effects(const SceneSource& source, const EffectsOptions& options,
                           const Progress& progress) {
  const BuiltScene built(source, {});
  EffectsStudy study;
  EffectsStudio studio(source, built, options, &study.note);
  study.effects = chosen_effects(studio.lit(), studio.used(), options.effects.choice);
  studio.add(study.effects);
  studio.add(Effect::kNone);
  for (int bit = 0; bit < Effect::kCount; ++bit) {
    EffectRow& row = study.rows[static_cast<std::size_t>(bit)];
    row.effect = EffectSet{1} << bit;
    row.called_for = (study.effects & row.effect) != 0;
    if (!row.called_for) {
      continue;
    }
    row.why = why_effect(studio.lit(), studio.used(), row.effect);
    constexpr EffectSet kNeedDirectLight = Effect::kShadows | Effect::kEmitterLight;
    row.with = row.effect == Effect::kDirectLight ? study.effects & ~kNeedDirectLight : study.effects;
    row.without = row.with & ~row.effect;
    studio.add(row.with);
    studio.add(row.without);
  }
  studio.draw(options.frames, progress);
  for (EffectRow& row : study.rows) {
    if (row.called_for) {
      fill(studio, &row);
    }
  }
  const Variant& whole = studio.of(study.effects);
  const Variant& plain = studio.of(Effect::kNone);
  study.lit = whole.counts;
  study.plain = plain.counts;
  study.lit_ms = quantile(whole.ms, 0.5);
  study.plain_ms = quantile(plain.ms, 0.5);
  study.state_bytes = lit_state_bytes(whole.scene, study.effects);
  if (study.effects != Effect::kNone) {
    study.base_ram_bytes = kBaseRamBytes;
    study.base_flash_bytes = kLitBaseFlashBytes;
  }
  return study;
}

}  // namespace thimble::tools
