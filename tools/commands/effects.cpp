// thimble effects: which effects a scene calls for, why, and what each costs.
#include <cmath>
#include <cstdio>
#include <memory>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "instruments/effects_study.h"
#include "output/plot.h"
#include "output/progress.h"
#include "output/tables.h"
#include "output/units.h"
#include "scene/lit_description.h"

namespace thimble::tools {
namespace {

struct EffectsCommand {
  SceneOptions scene;
  EffectsOptions study;
  ReportPaths files;
};

// "-1,234"
std::string signed_count(std::int64_t number) {
  return (number < 0 ? "-" : "") + grouped(static_cast<std::uint64_t>(std::abs(number)));
}

// --- rows for machines -------------------------------------------------------------------------------------

JsonRow objects(const EffectsStudy& study) {
  JsonRow rows = JsonRow::array();
  for (const EffectRow& row : study.rows) {
    JsonRow object;
    object["effect"] = effect_name(row.effect);
    object["called_for"] = row.called_for ? 1 : 0;
    object["why"] = row.why;
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      object[std::string(ray_kind_name(static_cast<LitRayKind>(kind))) + "_rays"] =
          row.rays[static_cast<std::size_t>(kind)];
    }
    object["rays"] = row.all_rays();
    object["node_visits"] = row.node_visits;
    object["ms"] = row.ms_median;
    object["q25_ms"] = row.ms_quarter;
    object["q75_ms"] = row.ms_three_quarters;
    object["with_ms"] = json_of(row.called_for ? &row.with_ms : nullptr);
    object["without_ms"] = json_of(row.called_for ? &row.without_ms : nullptr);
    object["ram_bytes"] = row.ram_bytes;
    object["flash_bytes"] = row.flash_bytes;
    rows.push_back(object);
  }
  return rows;
}

// --- tables for people -------------------------------------------------------------------------------------

std::string cost_table(const EffectsStudy& study) {
  std::vector<Cells> rows{{"effect", "rays", "nodes", "ms", "quartiles", "RAM", "flash"}};
  for (const EffectRow& row : study.rows) {
    if (!row.called_for) {
      rows.push_back({effect_name(row.effect), "0", "0", "0", "", "0", "0"});
      continue;
    }
    rows.push_back({effect_name(row.effect), signed_count(row.all_rays()), signed_count(row.node_visits),
                    fixed(row.ms_median, 2),
                    fixed(row.ms_quarter, 2) + " .. " + fixed(row.ms_three_quarters, 2),
                    grouped(row.ram_bytes), grouped(row.flash_bytes)});
  }
  return "more with the effect than without it: rays, nodes visited, milliseconds a frame, bytes of RAM\n"
         "and, on lm3s6965evb, of flash\n" +
         columns_of(rows, 1);
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
  add("frame without any", study.plain.rays);
  if (study.effects != Effect::kNone) {
    add("frame with all", study.lit.rays);
  }
  for (const EffectRow& row : study.rows) {
    if (row.called_for) {
      add(effect_name(row.effect), row.rays);
    }
  }
  return "\n" + columns_of(rows, 1);
}

std::string frame_lines(const EffectsStudy& study) {
  std::string text = "\na frame without effects takes " + fixed(study.plain_ms, 2) + " ms";
  if (study.effects != Effect::kNone) {
    text += ", with these " + fixed(study.lit_ms, 2) + " ms and " + grouped(study.state_bytes) +
            " bytes beside\ntree and band; a lit picture takes " + grouped(study.base_ram_bytes) +
            " bytes of RAM and " + grouped(study.base_flash_bytes) +
            " of flash before its first effect; what\neffects share is counted with each (flash) or with "
            "none (RAM)";
  }
  return text + "\n";
}

std::string plot(const EffectsCommand& command, const EffectsStudy& study) {
  BarChart chart;
  chart.title = "What effects cost: " + scene_title(command.scene.arguments.scene);
  chart.x_label = "milliseconds a frame of " + std::to_string(command.study.view.width_px) + " x " +
                  std::to_string(command.study.view.height_px) + ", with quartiles";
  for (const EffectRow& row : study.rows) {
    Bar bar;
    bar.name = effect_name(row.effect);
    bar.value = row.ms_median;
    bar.low = row.ms_quarter;
    bar.high = row.ms_three_quarters;
    bar.text = row.called_for ? fixed(row.ms_median, 2) + " ms, " + signed_count(row.all_rays()) + " rays"
                              : "not called for";
    chart.bars.push_back(bar);
  }
  return bar_chart_text(chart);
}

void run(const EffectsCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto source = command.scene.open();
  const EffectsStudy study = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_effects(*source, command.study, progress);
  });
  files.write(objects(study), files.wants_plot() ? plot(command, study) : "");
  if (!command.scene.quiet && !study.note.empty()) {
    std::fprintf(stderr, "note: %s\n", study.note.c_str());
  }
  files.print(printable(command.scene.arguments.scene) + "\n\n" + cost_table(study) + frame_lines(study) +
              why_table(study) + rays_table(study));
}

}  // namespace

void add_effects(CLI::App& app) {
  auto command = std::make_shared<EffectsCommand>();
  command->study.view.width_px = 320;
  command->study.view.height_px = 240;
  CLI::App* sub = add_command(
      app, "effects",
      "Which effects a scene calls for, why, and what each costs: rays, nodes visited and time of the frame "
      "with it less those of the frame without it, bytes of RAM and of flash. What the scene does not call "
      "for costs 0. Direct light is judged between two frames without shadows, which need it.");
  command->scene.add_scene(*sub);
  add_effect_options(*sub, &command->study.effects);
  add_view(*sub, &command->study.view);
  add_whole_option(*sub, "--frames", "N", 1, 99, &command->study.frames,
                   "frames timed of each set of effects, by turns")
      ->default_str("5");
  add_path_option(
      *sub, "--csv", "FILE.csv", &command->files.csv,
      "a line an effect, each that there is: effect, called_for (1 or 0), why (in words), K_rays for K of "
      "primary, shadow, occlusion, mirror, glass, media, water (rays of that kind in a frame with the effect "
      "less those in one without, so below 0 where the effect saves some), rays (of all kinds), node_visits "
      "(the same of nodes), ms (median over the frames of the time with less the time without), q25_ms, "
      "q75_ms (its quartiles), with_ms, without_ms (medians of the frames; empty where not called for), "
      "ram_bytes (state and tables of a lit picture, as render --memory counts them), flash_bytes (on "
      "lm3s6965evb, the image with this effect alone less one with none)");
  add_path_option(*sub, "--json", "FILE.json", &command->files.json,
                  "the same, an array of objects; null where the CSV is empty");
  add_path_option(*sub, "--plot", "FILE.svg", &command->files.plot, "milliseconds a frame, a bar an effect");
  add_flag(*sub, "--quiet", &command->scene.quiet, "no progress bar and no notes");
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
