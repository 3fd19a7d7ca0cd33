// thimble effects: which effects a scene calls for, why, and what each costs: the frame with it beside the frame
// without it.
//
// An effect's figures are those of the scene's whole set of effects less those of the set without it. Since shadows need
// direct light, direct light is judged between two frames without shadows. What a scene does not call for is not drawn
// with, and costs 0.
#include <cmath>
#include <map>
#include <numeric>

#include "boards/effect_flash.h"
#include "commands/commands.h"
#include "instruments/timed_frames.h"
#include "output/plot.h"

namespace thimble::tools {
namespace {

struct EffectsCommand {
  SceneOptions scene;
  ViewWishes view;
  EffectWishes effects;
  int frames = 5;  ///< of each set of effects, by turns; at least 1
  ReportPaths files;
};

struct EffectRow : MedianTime {  ///< times: of the differences, frame by frame
  EffectSet effect = Effect::kNone;
  bool called_for = false;  ///< if not, all below is 0 and empty
  std::string why;          ///< in words: which material, light or line of the scene
  EffectSet with = Effect::kNone;
  EffectSet without = Effect::kNone;
  std::array<std::int64_t, kLitRayKinds> rays{};  ///< more with it than without, by kind
  std::int64_t node_visits = 0;                   ///< the same, of all kinds
  double with_ms = 0;                             ///< medians of the frames
  double without_ms = 0;
  /// State and tables (lit_state_bytes), without kBaseRamBytes, which the first effect brings along.
  std::uint64_t ram_bytes = 0;
  /// On lm3s6965evb, without kLitBaseFlashBytes (platform/boards/effect_flash.h).
  std::uint64_t flash_bytes = 0;

  std::int64_t all_rays() const { return std::accumulate(rays.begin(), rays.end(), std::int64_t{0}); }
};

// Milliseconds and counts of frames with one set of effects.
struct Variant {
  LitScene scene;
  LitCounts counts;
  std::vector<double> ms;

  double median_ms() const { return quantile(ms, 0.5); }
};

struct EffectsStudy {
  EffectSet effects = Effect::kNone;
  std::array<EffectRow, Effect::kCount> rows;  ///< in the order of the bits
  Variant lit;                                 ///< the whole frame
  Variant plain;                               ///< the frame without effects
  std::uint64_t state_bytes = 0;               ///< all of it, as --memory counts it
  std::string note;
};

// "material 3 is metal", "materials 3, glow, 7 are glass"; at most four of them.
std::string materials(const LitDescription& lit, const UsedMaterials& used, SurfaceKind kind,
                      const std::string& what, const std::string& none) {
  constexpr std::size_t kMostNamed = 4;
  std::size_t count = 0;
  std::vector<std::string> named;
  for (std::size_t i = 0; i < lit.surfaces.size(); ++i) {
    if (used.is[i] && lit.surfaces[i].kind == kind && ++count <= kMostNamed) {
      named.push_back(lit.name_of(static_cast<std::uint8_t>(i)));
    }
  }
  return count == 0 ? none
                    : concat(count == 1 ? "material " : "materials ", joined(named, ", "),
                             count > kMostNamed ? concat(" and ", count - kMostNamed, " more") : "",
                             count == 1 ? " is " : " are ", what);
}

std::string lights(const LitDescription& lit) {
  const auto points = static_cast<std::size_t>(
      std::count_if(lit.lights.begin(), lit.lights.end(), [](const Light& light) { return light.is_point; }));
  const std::size_t distant = lit.lights.size() - points;
  const std::string suns = distant == 0 ? "" : counted(distant, "distant light");
  const std::string lamps = points == 0 ? "" : counted(points, "lamp");
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
      return rest.occlusion.rays == 0
                 ? named
                 : concat(rest.occlusion.rays, " rays a face, ", rest.occlusion.reach, " voxels far");
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
      return rest.has_water ? concat("water of ", rest.water.width, " x ", rest.water.depth, " columns")
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

class EffectsStudio {
 public:
  EffectsStudio(const SceneSource& source, const BuiltScene& built, const EffectsCommand& options,
                std::string* note)
      : built_(built),
        lit_(options.effects.lighting(source.lighting())),
        used_(used_materials(built.compact())),
        framing_(frame_scene(options.view, source, {built.level(), built.bounds()})),
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
        progress(++done / steps);
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
    check_lit_limits(status);
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
  row->with_ms = with.median_ms();
  row->without_ms = without.median_ms();
  row->set_times(more);
  row->ram_bytes = lit_state_bytes(with.scene, row->with) - lit_state_bytes(without.scene, row->without) -
                   (row->without == Effect::kNone ? kBaseRamBytes : 0);
  for (const EffectFlash& flash : kEffectFlash) {
    row->flash_bytes += flash.effect == row->effect ? flash.bytes : 0;
  }
}

/// Builds the scene, draws and measures. Throws InputError.
EffectsStudy study_effects(const SceneSource& source, const EffectsCommand& options,
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
  study.lit = studio.of(study.effects);
  study.plain = studio.of(Effect::kNone);
  study.state_bytes = lit_state_bytes(study.lit.scene, study.effects);
  return study;
}

// "-1,234"
std::string signed_count(std::int64_t number) {
  return (number < 0 ? "-" : "") + grouped(static_cast<std::uint64_t>(std::abs(number)));
}

// --- rows for machines -------------------------------------------------------------------------------------

JsonRow effect_object(const EffectRow& row) {
  JsonRow object;
  put_all(&object, "effect", effect_name(row.effect), "called_for", row.called_for ? 1 : 0, "why", row.why);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    object[std::string(ray_kind_name(static_cast<LitRayKind>(kind))) + "_rays"] =
        row.rays[static_cast<std::size_t>(kind)];
  }
  put_all(&object, "rays", row.all_rays(), "node_visits", row.node_visits, "ms", row.ms_median, "q25_ms",
          row.ms_quarter, "q75_ms", row.ms_three_quarters, "with_ms",
          json_of(row.called_for ? &row.with_ms : nullptr), "without_ms",
          json_of(row.called_for ? &row.without_ms : nullptr), "ram_bytes", row.ram_bytes, "flash_bytes",
          row.flash_bytes);
  return object;
}

// --- tables for people -------------------------------------------------------------------------------------

std::string cost_table(const EffectsStudy& study) {
  const auto cells = [](const EffectRow& row) {
    return cells_of(effect_name(row.effect), signed_count(row.all_rays()), signed_count(row.node_visits),
                    row.called_for ? fixed(row.ms_median, 2) : "0",
                    row.called_for ? fixed(row.ms_quarter, 2) + " .. " + fixed(row.ms_three_quarters, 2) : "",
                    grouped(row.ram_bytes), grouped(row.flash_bytes));
  };
  return "more with the effect than without it: rays, nodes visited, milliseconds a frame, bytes of RAM\n"
         "and, on lm3s6965evb, of flash\n" +
         table_of({"effect", "rays", "nodes", "ms", "quartiles", "RAM", "flash"}, 1, study.rows, cells);
}

std::string why_table(const EffectsStudy& study) {
  std::vector<Cells> rows;
  for (const EffectRow& row : study.rows) {
    if (row.called_for) {
      rows.push_back({effect_name(row.effect), printable(row.why)});
    }
  }
  return rows.empty() ? "\nit calls for no effects\n"
                      : "\nwhy the scene is drawn with it\n" + columns_of(rows, 2);
}

std::string rays_table(const EffectsStudy& study) {
  Cells head{"rays of each kind"};
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    head.push_back(ray_kind_name(static_cast<LitRayKind>(kind)));
  }
  std::vector<Cells> rows{head};
  const auto add = [&](const char* name, const auto& rays) {
    rows.push_back({name});
    for (const auto number : rays) {
      rows.back().push_back(signed_count(static_cast<std::int64_t>(number)));
    }
  };
  add("frame without any", study.plain.counts.rays);
  if (study.effects != Effect::kNone) {
    add("frame with all", study.lit.counts.rays);
  }
  for (const EffectRow& row : study.rows) {
    if (row.called_for) {
      add(effect_name(row.effect), row.rays);
    }
  }
  return "\n" + columns_of(rows, 1);
}

std::string frame_lines(const EffectsStudy& study) {
  std::string text = "\na frame without effects takes " + fixed(study.plain.median_ms(), 2) + " ms";
  if (study.effects != Effect::kNone) {
    text += ", with these " + fixed(study.lit.median_ms(), 2) + " ms and " + grouped(study.state_bytes) +
            " bytes beside\ntree and band; a lit picture takes " + grouped(kBaseRamBytes) +
            " bytes of RAM and " + grouped(kLitBaseFlashBytes) +
            " of flash before its first effect; what\neffects share is counted with each (flash) or with "
            "none (RAM)";
  }
  return text + "\n";
}

std::string plot(const EffectsCommand& command, const EffectsStudy& study) {
  BarChart chart;
  chart.title = "What effects cost: " + scene_title(command.scene.arguments.scene);
  chart.x_label = concat("milliseconds a frame of ", command.view.width_px, " x ", command.view.height_px,
                         ", with quartiles");
  for (const EffectRow& row : study.rows) {
    chart.bars.push_back({effect_name(row.effect), row.ms_median, row.ms_quarter, row.ms_three_quarters,
                          row.called_for
                              ? fixed(row.ms_median, 2) + " ms, " + signed_count(row.all_rays()) + " rays"
                              : "not called for"});
  }
  return bar_chart_text(chart);
}

void run(const EffectsCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto source = command.scene.open();
  const EffectsStudy study = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_effects(*source, command, progress);
  });
  files.write(objects_of(study.rows, effect_object), files.wants_plot() ? plot(command, study) : "");
  print_notes({study.note}, command.scene.quiet);
  files.print(printable(command.scene.arguments.scene) + "\n\n" + cost_table(study) + frame_lines(study) +
              why_table(study) + rays_table(study));
}

}  // namespace

void add_effects(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "effects",
      "Which effects a scene calls for, why, and what each costs: rays, nodes visited and time of the frame "
      "with it less those of the frame without it, bytes of RAM and of flash. What the scene does not call "
      "for costs 0. Direct light is judged between two frames without shadows, which need it.");
  EffectsCommand* const command = options_for<EffectsCommand>(*sub, run);
  command->view.width_px = 320;
  command->view.height_px = 240;
  command->scene.add_scene(*sub);
  add_effect_options(*sub, &command->effects);
  add_view(*sub, &command->view);
  add_whole_option(*sub, "--frames", "N", 1, 99, &command->frames,
                   "frames timed of each set of effects, by turns");
  add_report(
      *sub, &command->files, &command->scene.quiet,
      "a line an effect, each that there is: effect, called_for (1 or 0), why (in words), K_rays for K of "
      "primary, shadow, occlusion, mirror, glass, media, water (rays of that kind in a frame with the effect "
      "less those in one without, so below 0 where the effect saves some), rays (of all kinds), node_visits "
      "(the same of nodes), ms (median over the frames of the time with less the time without), q25_ms, "
      "q75_ms (its quartiles), with_ms, without_ms (medians of the frames; empty where not called for), "
      "ram_bytes (state and tables of a lit picture, as render --memory counts them), flash_bytes (on "
      "lm3s6965evb, the image with this effect alone less one with none)",
      "milliseconds a frame, a bar an effect");
}

}  // namespace thimble::tools
