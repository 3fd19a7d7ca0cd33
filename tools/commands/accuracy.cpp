// thimble accuracy: what each knob that trades a picture's error for time gives, and what a given time or
// error calls for.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "instruments/accuracy_study.h"
#include "instruments/hard_cases.h"
#include "instruments/simulation_study.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/built_scene.h"
#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

// Of each operation, however few --rays there are.
constexpr std::uint64_t kLeastCases = 1000;

struct AccuracyCommand {
  SceneOptions scene;
  AccuracyOptions study;
  std::optional<SimulationWorld> simulation;
  bool hard_cases = false;
  std::uint64_t hard_rays = 1000000;
  std::uint64_t seed = 1;
  std::optional<double> for_ms;
  std::optional<double> for_error;
  ReportPaths files;
};

void run_scene(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto source = command.scene.open();
  BuiltScene built = command.scene.build(*source);
  const AccuracyStudy study = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_accuracy(*source, &built, command.study, progress);
  });
  // Before anything is written: no answer is an error.
  const std::string answer = command.for_ms      ? answer_for_ms(study, *command.for_ms)
                             : command.for_error ? answer_for_error(study, *command.for_error)
                                                 : std::string();
  const std::string& scene = command.scene.arguments.scene;
  files.write(accuracy_objects(study),
              files.wants_plot() ? accuracy_plot(study, command.study.axis, scene) : "");
  if (!command.scene.quiet) {
    for (const std::string& note : study.notes) {
      std::fprintf(stderr, "note: %s\n", note.c_str());
    }
  }
  files.print(printable(scene) + "\n" + std::to_string(command.study.view.width_px) + "x" +
              std::to_string(command.study.view.height_px) + ", median of " +
              std::to_string(command.study.rounds) + " frames each, by turns\n" +
              accuracy_tables(study, command.study.axis) + answer);
}

void run_hard(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const HardCaseStudy study = with_progress("tracing", command.scene.quiet, [&](const Progress& progress) {
    return HardCaseStudy{
        run_hard_cases(command.hard_rays, command.seed, [&](double done) { progress(0.8 * done); }),
        sweep_operations(std::max(command.hard_rays / 5, kLeastCases), command.seed,
                         [&](double done) { progress(0.8 + 0.2 * done); })};
  });
  files.write(hard_case_objects(study), "");
  files.print(hard_case_tables(study));
  if (const std::string fault = hard_case_fault(study); !fault.empty()) {
    throw InputError(fault);
  }
}

void run_simulation(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto rows = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_simulation(*command.simulation, command.study.rounds, progress);
  });
  files.write(simulation_objects(*command.simulation, rows), simulation_plot(*command.simulation, rows));
  files.print(simulation_table(*command.simulation, rows));
}

// Options that say what is measured go with few of the others.
void check_alone(const CLI::App& sub, const std::string& what, const std::vector<std::string>& allowed) {
  for (const std::string& name : options_given(sub)) {
    if (name != what && std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
      refuse_usage(what, "takes no " + (name == "scene" ? "SCENE" : name));
    }
  }
}

void run(const AccuracyCommand& command, const CLI::App& sub) {
  if (command.hard_cases) {
    check_alone(sub, "--hard-cases", {"--rays", "--seed", "--csv", "--json", "--quiet"});
    run_hard(command);
    return;
  }
  for (const char* name : {"--rays", "--seed"}) {
    if (is_given(sub, name)) {
      refuse_usage(name, "goes with --hard-cases only");
    }
  }
  if (command.simulation) {
    check_alone(sub, "--simulation", {"--rounds", "--csv", "--json", "--plot", "--quiet"});
    run_simulation(command);
    return;
  }
  if (command.scene.arguments.scene.empty()) {
    refuse_usage("SCENE is required");
  }
  run_scene(command);
}

void add_positive(CLI::App& app, const std::string& name, const std::string& type_name, double least,
                  std::optional<double>* value, const std::string& help) {
  add_text_option(
      app, name, type_name,
      [value, least](const std::string& text) -> std::string {
        const auto number = parse_real(text);
        if (!number || *number < least || *number > 1e9) {
          return least > 0 ? "is not a number above 0" : "is not a number from 0 on";
        }
        *value = number;
        return {};
      },
      help);
}

void add_file_options(CLI::App& sub, ReportPaths* paths) {
  add_path_option(
      sub, "--csv", "FILE.csv", &paths->csv,
      "a line a setting: row (setting; anytime: a frame of the defaults stopped early; light: a lit "
      "picture), group (default, the knob turned alone, together, best: the reference itself, anytime), "
      "options (of thimble render), front (1: nothing nearer to the reference is as cheap, times within 3 "
      "per cent being equal), max_depth (0: all), cutoff_px, direction_bits (0: automatic), samples; against "
      "the reference: wrong_px (of another colour), visible_px (a channel off by more than 8 of 255), "
      "rms_error (of 255), psnr_db (empty: equal); ms_median, ms_quarter, ms_three_quarters; rays, hits, "
      "node_visits; silhouette_px (centre's ray hits in one only), depth_error_mean_voxels, "
      "depth_error_max_voxels (of centres' rays that hit in both); lm3s6965evb_instructions (an estimate, "
      "off by 5 per cent on average on the demonstration); anytime: visits_given, inexact_px, "
      "error_bound_grays (of the mean absolute difference from the finished frame), mean_error_grays; light: "
      "occlusion_rays, roughness_rays, bounces (errors against the best of these). With --hard-cases: row "
      "(rays, operation), case (or all), level (of the world), tracer, traversal, arithmetic, "
      "epsilon_voxels, rays, hits, wrong (another voxel, a miss or a hit too many), wrong_face (of the "
      "others), operation, bound_name, unit, error (the largest), bound, cases. With --simulation: row "
      "(particles, water), substeps, subpixel_bits, columns (a side), wave_speed_q6 (columns a step), steps, "
      "work (displacements made, or columns worked out), ms_median, ms_quarter, ms_three_quarters (of all "
      "steps), unit (of the errors), error_rms, error_median, error_most, front");
  add_path_option(sub, "--json", "FILE.json", &paths->json,
                  "the same, an array of objects; null where the CSV is empty");
  add_path_option(sub, "--plot", "FILE.svg", &paths->plot,
                  "PSNR against what --against says, the front marked and named");
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto command = std::make_shared<AccuracyCommand>();
  command->study.view.width_px = 200;
  command->study.view.height_px = 150;
  CLI::App* sub = add_command(
      app, "accuracy",
      "Time against error: one view of a scene with every knob that trades them turned alone and together "
      "(depth, cut-off, bits of a ray's direction, samples a pixel), and frames stopped early, each compared "
      "with a reference that has all knobs at their best.");
  command->scene.add_scene(*sub, false);
  add_flag(*sub, "--hard-cases", &command->hard_cases,
           "instead of a scene: near-degenerate rays through this tracer and through textbook traversals in "
           "floating point, and every fixed-point operation against exact arithmetic; the exit status is "
           "1 when this tracer gets one wrong");
  add_choice_option(
      *sub, "--simulation", {{"particles", SimulationWorld::kParticles}, {"water", SimulationWorld::kWater}},
      &command->simulation,
      "instead of a scene: substeps and bits of positions of the particle world, or columns and steps of a "
      "basin of water, against the finest");
  add_whole_option(*sub, "--rays", "N", 1, 1000000000, &command->hard_rays,
                   "--hard-cases: rays, shared among the cases; a fifth as many cases of each operation")
      ->default_str("1000000");
  add_whole_option(*sub, "--seed", "S", 0, INT64_MAX / 2000003, &command->seed,
                   "--hard-cases: of the random rays")
      ->default_str("1");
  add_positive(*sub, "--for-ms", "T", 1e-9, &command->for_ms,
               "answer with the options that come nearest to the reference in T milliseconds of the "
               "processor a frame, median on this machine at this --size");
  add_positive(*sub, "--for-error", "E", 0, &command->for_error,
               "answer with the fastest options whose picture is off by at most E: the root mean square of "
               "all channels' differences from the reference, in steps of 1/255 (column rms_error; 0: equal; "
               "PSNR is 20 log10(255/E) dB)");
  sub->get_option("--for-ms")->excludes(sub->get_option("--for-error"));
  add_whole_option(*sub, "--rounds", "N", 1, 999, &command->study.rounds,
                   "frames timed of each setting, by turns, one of each a round")
      ->default_str("5");
  add_choice_option(
      *sub, "--against",
      {{"time", CostAxis::kTime}, {"visits", CostAxis::kVisits}, {"instructions", CostAxis::kInstructions}},
      &command->study.axis,
      "what the front and the plot weigh errors against: milliseconds here, or what is the same on every "
      "machine: nodes visited, or an estimate of instructions on lm3s6965evb")
      ->default_str("time");
  add_view(*sub, &command->study.view, false);
  add_shade(
      *sub, &command->study.shade,
      "what is compared: brightness by distance, by the face's direction, palette colours, or hit or not");
  add_effect_list(
      *sub, &command->study.effects,
      "light whose knobs are turned too (rays of occlusion, rays of rough metal, bounces): auto (what the "
      "scene's materials and lights call for), none, or effects with commas between them: " +
          effect_names());
  add_file_options(*sub, &command->files);
  add_flag(*sub, "--quiet", &command->scene.quiet, "no progress bar and no notes");
  when_chosen(*sub, [command, sub] { run(*command, *sub); });
}

}  // namespace thimble::tools
